#include "pipeline/blend.h"

namespace gnomon {

namespace {

template <class Real>
Vec4<Real> limited(const Vec4<Real>& c, BlendRange range) {
    const auto each = [&](const auto& limit) { return Vec4<Real>{limit(c.x), limit(c.y), limit(c.z), limit(c.w)}; };
    switch (range) {
        case BlendRange::Unorm: return each([](const Real& x) { return saturate(x); });
        case BlendRange::Snorm:
            return each([](const Real& x) { return select(is_nan(x), Real(0.0f), clamp(x, Real(-1.0f), Real(1.0f))); });
        case BlendRange::Float: return c;
    }
    __builtin_unreachable();
}

/// A factor for colour and alpha together; each equation takes its part.
template <class Real>
Vec4<Real> factor(BlendFactor which, const BlendInput<Real>& in) {
    const Real one(1.0f);
    const auto splat4 = [](const Real& x) { return Vec4<Real>{x, x, x, x}; };
    const auto inverse = [&](const Vec4<Real>& c) { return Vec4<Real>{one - c.x, one - c.y, one - c.z, one - c.w}; };
    switch (which) {
        case BlendFactor::Zero: return splat4(Real(0.0f));
        case BlendFactor::One: return splat4(one);
        case BlendFactor::SrcColor: return in.src;
        case BlendFactor::InvSrcColor: return inverse(in.src);
        case BlendFactor::SrcAlpha: return splat4(in.src.w);
        case BlendFactor::InvSrcAlpha: return splat4(one - in.src.w);
        case BlendFactor::DstAlpha: return splat4(in.dst.w);
        case BlendFactor::InvDstAlpha: return splat4(one - in.dst.w);
        case BlendFactor::DstColor: return in.dst;
        case BlendFactor::InvDstColor: return inverse(in.dst);
        case BlendFactor::SrcAlphaSaturate: {
            const Real f = min(one - in.dst.w, in.src.w);
            return {f, f, f, one};
        }
        case BlendFactor::Constant: return in.constant;
        case BlendFactor::InvConstant: return inverse(in.constant);
        case BlendFactor::Src1Color: return in.src1;
        case BlendFactor::InvSrc1Color: return inverse(in.src1);
        case BlendFactor::Src1Alpha: return splat4(in.src1.w);
        case BlendFactor::InvSrc1Alpha: return splat4(one - in.src1.w);
    }
    __builtin_unreachable();
}

template <class Real>
Real combine(BlendOp op, const Real& src, const Real& src_factor, const Real& dst, const Real& dst_factor) {
    switch (op) {
        case BlendOp::Add: return src * src_factor + dst * dst_factor;
        case BlendOp::Subtract: return src * src_factor - dst * dst_factor;
        case BlendOp::ReverseSubtract: return dst * dst_factor - src * src_factor;
        case BlendOp::Min: return min(src, dst);
        case BlendOp::Max: return max(src, dst);
    }
    __builtin_unreachable();
}

bool is_second(BlendFactor factor) {
    return factor == BlendFactor::Src1Color || factor == BlendFactor::InvSrc1Color || factor == BlendFactor::Src1Alpha ||
           factor == BlendFactor::InvSrc1Alpha;
}

}  // namespace

BlendRange blend_range(ComponentType type) {
    switch (type) {
        case ComponentType::Unorm8:
        case ComponentType::Srgb8:
        case ComponentType::Unorm16: return BlendRange::Unorm;
        case ComponentType::Snorm8:
        case ComponentType::Snorm16: return BlendRange::Snorm;
        case ComponentType::Float16:
        case ComponentType::Float32:
        case ComponentType::Uint32:
        case ComponentType::Float11:
        case ComponentType::Depth16:
        case ComponentType::Depth24:
        case ComponentType::Depth32: return BlendRange::Float;
    }
    __builtin_unreachable();
}

bool uses_second_color(const BlendState& state) {
    return state.enable &&
           (is_second(state.src) || is_second(state.dst) || is_second(state.src_alpha) || is_second(state.dst_alpha));
}

template <class Real>
Vec4<Real> blend(const BlendInput<Real>& input, const BlendState& state, BlendRange range) {
    const BlendInput<Real> in{limited(input.src, range), limited(input.src1, range), input.dst, limited(input.constant, range)};
    const Vec4<Real> s = factor(state.src, in);
    const Vec4<Real> d = factor(state.dst, in);
    const Vec4<Real> sa = factor(state.src_alpha, in);
    const Vec4<Real> da = factor(state.dst_alpha, in);
    return {combine(state.op, in.src.x, s.x, in.dst.x, d.x), combine(state.op, in.src.y, s.y, in.dst.y, d.y),
            combine(state.op, in.src.z, s.z, in.dst.z, d.z), combine(state.op_alpha, in.src.w, sa.w, in.dst.w, da.w)};
}

template Vec4<Float> blend(const BlendInput<Float>&, const BlendState&, BlendRange);
template Vec4<Double> blend(const BlendInput<Double>&, const BlendState&, BlendRange);

}  // namespace gnomon
