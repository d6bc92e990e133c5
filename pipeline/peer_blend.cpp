#include "pipeline/peer_blend.h"

#include "sim/denormals.h"

namespace gnomon {

namespace {

bool ignores_factors(BlendOp op) { return op == BlendOp::Min || op == BlendOp::Max; }

struct Equation {
    BlendFactor src;
    BlendFactor dst;
    BlendOp op;
};
Equation color_of(const BlendState& state) { return {state.src, state.dst, state.op}; }
Equation alpha_of(const BlendState& state) { return {state.src_alpha, state.dst_alpha, state.op_alpha}; }

/// Codes or numbers.
template <class T>
struct Inputs {
    std::array<T, 4> src, src1, dst, constant;
    T one;
};

/// A factor in one channel. `least` takes source alpha and what destination alpha leaves of one.
template <class T, class Least>
T factor(BlendFactor which, std::size_t c, const Inputs<T>& in, const Least& least) {
    switch (which) {
        case BlendFactor::Zero: return T(0);
        case BlendFactor::One: return in.one;
        case BlendFactor::SrcColor: return in.src[c];
        case BlendFactor::InvSrcColor: return in.one - in.src[c];
        case BlendFactor::SrcAlpha: return in.src[3];
        case BlendFactor::InvSrcAlpha: return in.one - in.src[3];
        case BlendFactor::DstAlpha: return in.dst[3];
        case BlendFactor::InvDstAlpha: return in.one - in.dst[3];
        case BlendFactor::DstColor: return in.dst[c];
        case BlendFactor::InvDstColor: return in.one - in.dst[c];
        case BlendFactor::SrcAlphaSaturate: return c == 3 ? in.one : least(in.src[3], in.one - in.dst[3]);
        case BlendFactor::Constant: return in.constant[c];
        case BlendFactor::InvConstant: return in.one - in.constant[c];
        case BlendFactor::Src1Color: return in.src1[c];
        case BlendFactor::InvSrc1Color: return in.one - in.src1[c];
        case BlendFactor::Src1Alpha: return in.src1[3];
        case BlendFactor::InvSrc1Alpha: return in.one - in.src1[3];
    }
    __builtin_unreachable();
}

std::array<Float, 4> channels(const Vec4<Float>& v) { return {v.x, v.y, v.z, v.w}; }
Inputs<Float> inputs_of(const BlendInput<Float>& in) {
    return {channels(in.src), channels(in.src1), channels(in.dst), channels(in.constant), Float(1.0f)};
}

/// What minps and maxps see of a denormal where they are zero.
Float flushed(Float x) {
    const Int bits = bits_of(x);
    const Mask tiny = (bits & Int(0x7fffffff)) < Int(0x00800000);
    return float_of_bits(select(tiny, bits & Int(std::numeric_limits<std::int32_t>::min()), bits));
}
/// Equal or unordered, the second.
Float min_ps(Float a, Float b) { return select(a < b, a, b); }
Float max_ps(Float a, Float b) { return select(a > b, a, b); }

/// A factor as all four channels have it: one or zero only where it is in each, and then llvmpipe leaves it out.
struct VectorFactor {
    BlendFactor color;
    BlendFactor alpha;

    [[nodiscard]] bool is(BlendFactor constant) const {
        const bool is_one = alpha == BlendFactor::SrcAlphaSaturate && constant == BlendFactor::One;
        return color == constant && (alpha == constant || is_one);
    }
};

class LlvmpipeFloat {
public:
    LlvmpipeFloat(const BlendInput<Float>& in, const BlendState& state, bool flush)
        : in_(inputs_of(in)), color_(effective(color_of(state))), alpha_(effective(alpha_of(state))), flush_(flush) {}

    [[nodiscard]] Float channel(std::size_t c) const {
        const Equation& e = c == 3 ? alpha_ : color_;
        const VectorFactor src{color_.src, alpha_.src};
        const VectorFactor dst{color_.dst, alpha_.dst};
        const bool one_factor = color_.src == color_.dst && alpha_.src == alpha_.dst;
        if (one_factor && !ignores_factors(e.op)) return times(combine(e.op, in_.src[c], in_.dst[c], false, false), src, c);
        return combine(e.op, times(in_.src[c], src, c), times(in_.dst[c], dst, c), src.is(BlendFactor::Zero),
                       dst.is(BlendFactor::Zero));
    }

private:
    static Equation effective(const Equation& e) {
        return ignores_factors(e.op) ? Equation{BlendFactor::One, BlendFactor::One, e.op} : e;
    }
    [[nodiscard]] Float seen(Float x) const { return flush_ ? flushed(x) : x; }

    [[nodiscard]] Float times(Float x, const VectorFactor& which, std::size_t c) const {
        if (which.is(BlendFactor::One)) return x;
        if (which.is(BlendFactor::Zero)) return Float(0.0f);
        const auto least = [this](Float a, Float b) { return min_ps(seen(a), seen(b)); };
        return x * factor(c == 3 ? which.alpha : which.color, c, in_, least);
    }
    /// With one term left out, the other is not touched.
    [[nodiscard]] Float combine(BlendOp op, Float s, Float d, bool no_s, bool no_d) const {
        switch (op) {
            case BlendOp::Add: return no_s ? d : no_d ? s : s + d;
            case BlendOp::Subtract: return no_d ? s : s - d;
            case BlendOp::ReverseSubtract: return no_s ? d : d - s;
            case BlendOp::Min: return min_ps(seen(s), seen(d));
            case BlendOp::Max: return max_ps(seen(s), seen(d));
        }
        __builtin_unreachable();
    }

    Inputs<Float> in_;
    Equation color_;
    Equation alpha_;
    bool flush_;
};

/// Equations that SwiftShader does not compute.
enum class Shortcut { None, Zero, Source, Destination };
Shortcut shortcut_of(const Equation& e) {
    if (ignores_factors(e.op)) return Shortcut::None;
    const bool no_source = e.src == BlendFactor::Zero;
    const bool no_destination = e.dst == BlendFactor::Zero;
    if (no_source && no_destination) return Shortcut::Zero;
    if (e.op != BlendOp::ReverseSubtract && e.src == BlendFactor::One && no_destination) return Shortcut::Source;
    if (e.op != BlendOp::Subtract && no_source && e.dst == BlendFactor::One) return Shortcut::Destination;
    return Shortcut::None;
}

Float swiftshader_channel(const Equation& e, std::size_t c, const Inputs<Float>& in) {
    switch (shortcut_of(e)) {
        case Shortcut::None: break;
        case Shortcut::Zero: return Float(0.0f);
        case Shortcut::Source: return in.src[c];
        case Shortcut::Destination: return in.dst[c];
    }
    const auto least = [](Float alpha, Float rest) { return min_ps(flushed(rest), flushed(alpha)); };
    const auto source = [&] { return in.src[c] * factor(e.src, c, in, least); };
    const auto destination = [&] { return in.dst[c] * factor(e.dst, c, in, least); };
    switch (e.op) {
        case BlendOp::Add: return source() + destination();
        case BlendOp::Subtract: return source() - destination();
        case BlendOp::ReverseSubtract: return destination() - source();
        case BlendOp::Min: return min_ps(flushed(in.src[c]), flushed(in.dst[c]));
        case BlendOp::Max: return max_ps(flushed(in.src[c]), flushed(in.dst[c]));
    }
    __builtin_unreachable();
}

/// Apart, so that nothing of it is computed outside of a change of the denormal mode.
[[gnu::noinline]] Vec4<Float> llvmpipe_float(const BlendInput<Float>& in, const BlendState& state, bool flush) {
    const LlvmpipeFloat blend(in, state, flush);
    return {blend.channel(0), blend.channel(1), blend.channel(2), blend.channel(3)};
}

}  // namespace

std::array<Int, 4> blend_codes(const BlendCodes& in, const BlendState& state, int bits) {
    const Int one((1 << bits) - 1);
    const Int half(1 << (bits - 1));
    const Inputs<Int> inputs{in.src, in.src1, in.dst, in.constant, one};
    // a b / (2^n - 1), rounded; the product of two 16-bit codes fills 32 bits.
    const auto times = [&](Int a, Int b) {
        const Int product = a * b;
        return shift_right_logical(product + shift_right_logical(product, Int(bits)) + half, Int(bits));
    };
    const auto least = [](Int a, Int b) { return min(a, b); };
    std::array<Int, 4> result;
    for (std::size_t c = 0; c < 4; ++c) {
        const Equation e = c == 3 ? alpha_of(state) : color_of(state);
        Int s = in.src[c];
        Int d = in.dst[c];
        if (!ignores_factors(e.op)) {
            s = times(s, factor(e.src, c, inputs, least));
            d = times(d, factor(e.dst, c, inputs, least));
        }
        switch (e.op) {
            case BlendOp::Add: result[c] = min(s + d, one); break;
            case BlendOp::Subtract: result[c] = max(s - d, Int(0)); break;
            case BlendOp::ReverseSubtract: result[c] = max(d - s, Int(0)); break;
            case BlendOp::Min: result[c] = min(s, d); break;
            case BlendOp::Max: result[c] = max(s, d); break;
        }
    }
    return result;
}

Vec4<Float> blend_as_llvmpipe(const BlendInput<Float>& in, const BlendState& state, bool flush_denormals) {
    const DenormalScope denormals(flush_denormals);
    return llvmpipe_float(in, state, flush_denormals);
}

Vec4<Float> blend_as_swiftshader(const BlendInput<Float>& in, const BlendState& state) {
    const Inputs<Float> inputs = inputs_of(in);
    const Equation color = color_of(state);
    return {swiftshader_channel(color, 0, inputs), swiftshader_channel(color, 1, inputs), swiftshader_channel(color, 2, inputs),
            swiftshader_channel(alpha_of(state), 3, inputs)};
}

bool leaves_target(const BlendState& state) {
    return shortcut_of(color_of(state)) == Shortcut::Destination && shortcut_of(alpha_of(state)) == Shortcut::Destination;
}

}  // namespace gnomon
