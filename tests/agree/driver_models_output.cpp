// Blending and resolve of llvmpipe 22.3 and SwiftShader.
//
// llvmpipe blends unorm targets on integers, after the source and the constant have become codes; float targets in fp32, with
// two shortcuts that other infinities, NaN and roundings come from. Halves are cut off, and fp32 flushes denormals.
// SwiftShader blends everything in fp32, flushes denormals and rounds to the nearest code. Its halves have no infinities and
// no NaN: the codes above 65504 are read as the numbers 65536 to 131008, and everything that large is stored as 0x7fff.
#include "tests/agree/driver_model_parts.h"

namespace gnomon::agree {
namespace {

bool is_unorm(ColorFormat format) { return format == ColorFormat::Rgba8 || format == ColorFormat::Rgba16Unorm; }
int unorm_bits(ColorFormat format) { return format == ColorFormat::Rgba8 ? 8 : 16; }

const BlendEquation& equation(const BlendState& state, std::size_t channel) { return channel == 3 ? state.alpha : state.color; }

bool ignores_factors(BlendOperation operation) { return operation == BlendOperation::Min || operation == BlendOperation::Max; }

// The value of a factor in one channel, over any kind of number.
template <class T>
struct FactorInputs {
    std::array<T, 4> source, destination, constant;
    T zero, one;
};
template <class T, class Invert, class Least>
T factor_value(BlendFactor factor, std::size_t channel, const FactorInputs<T>& in, const Invert& invert, const Least& least) {
    switch (factor) {
        case BlendFactor::Zero: return in.zero;
        case BlendFactor::One: return in.one;
        case BlendFactor::SourceColor: return in.source[channel];
        case BlendFactor::InverseSourceColor: return invert(in.source[channel]);
        case BlendFactor::DestinationColor: return in.destination[channel];
        case BlendFactor::InverseDestinationColor: return invert(in.destination[channel]);
        case BlendFactor::SourceAlpha: return in.source[3];
        case BlendFactor::InverseSourceAlpha: return invert(in.source[3]);
        case BlendFactor::DestinationAlpha: return in.destination[3];
        case BlendFactor::InverseDestinationAlpha: return invert(in.destination[3]);
        case BlendFactor::ConstantColor: return in.constant[channel];
        case BlendFactor::InverseConstantColor: return invert(in.constant[channel]);
        case BlendFactor::ConstantAlpha: return in.constant[3];
        case BlendFactor::InverseConstantAlpha: return invert(in.constant[3]);
        case BlendFactor::SourceAlphaSaturate: return channel == 3 ? in.one : least(in.source[3], invert(in.destination[3]));
    }
    return in.zero;
}

// ---- llvmpipe ----

std::uint32_t half_toward_zero(float x) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
    const std::uint32_t sign = bits >> 16 & 0x8000u;
    const std::uint32_t magnitude = bits & 0x7fffffffu;
    if (magnitude > 0x7f800000u) return sign | 0x7e00u | (magnitude >> 13 & 0x3ffu);
    if (magnitude == 0x7f800000u) return sign | 0x7c00u;
    if (magnitude >= 0x47800000u) return sign | 0x7bffu;  // from 65536
    if (magnitude >= 0x38800000u) return sign | ((magnitude - 0x38000000u) >> 13);
    const auto steps = static_cast<std::uint32_t>(std::trunc(std::ldexp(std::bit_cast<float>(magnitude), 24)));
    return sign | steps;
}

float half_value(std::uint32_t code) {
    const int exponent = static_cast<int>(code >> 10 & 31u);
    const auto mantissa = static_cast<float>(code & 0x3ffu);
    float value = 0;
    if (exponent == 31)
        value = (code & 0x3ffu) != 0 ? std::numeric_limits<float>::quiet_NaN() : std::numeric_limits<float>::infinity();
    else
        value = exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
    return (code & 0x8000u) != 0 ? -value : value;
}

// What a fragment's channel becomes.
std::uint32_t llvmpipe_code(ColorFormat format, float x) {
    switch (format) {
        case ColorFormat::Rgba8: return static_cast<std::uint32_t>(std::max(round_to_int(min_ps(1.0f, x) * 255.0f), 0));
        case ColorFormat::Rgba16Unorm: {
            const float scaled = min_ps(max_ps(x, 0.0f), 1.0f) * (65535.0f / 65536.0f);
            return std::bit_cast<std::uint32_t>(scaled + 128.0f) & 0xffffu;
        }
        case ColorFormat::Rgba16f: return half_toward_zero(x);
        case ColorFormat::Rgba32f: return std::bit_cast<std::uint32_t>(x);
    }
    return 0;
}

Codes llvmpipe_blend_unorm(ColorFormat format, const BlendState& state, const BlendCase& blended) {
    const int bits = unorm_bits(format);
    const std::uint64_t one = (1u << bits) - 1u;
    FactorInputs<std::uint64_t> in{.source = {}, .destination = {}, .constant = {}, .zero = 0, .one = one};
    for (std::size_t c = 0; c < 4; ++c) {
        in.source[c] = llvmpipe_code(format, blended.source[c]);
        in.destination[c] = blended.destination[c];
        in.constant[c] = llvmpipe_code(format, state.constant[c]);
    }
    const auto times = [bits](std::uint64_t a, std::uint64_t b) {
        const std::uint64_t product = a * b;
        return (product + (product >> bits) + (1u << (bits - 1))) >> bits;
    };
    const auto invert = [one](std::uint64_t x) { return one - x; };
    const auto least = [](std::uint64_t a, std::uint64_t b) { return std::min(a, b); };
    Codes result{};
    for (std::size_t c = 0; c < 4; ++c) {
        const BlendEquation& e = equation(state, c);
        std::uint64_t s = in.source[c];
        std::uint64_t d = in.destination[c];
        if (!ignores_factors(e.operation)) {
            s = times(s, factor_value(e.source, c, in, invert, least));
            d = times(d, factor_value(e.destination, c, in, invert, least));
        }
        std::uint64_t value = 0;
        switch (e.operation) {
            case BlendOperation::Add: value = std::min(s + d, one); break;
            case BlendOperation::Subtract: value = s > d ? s - d : 0; break;
            case BlendOperation::ReverseSubtract: value = d > s ? d - s : 0; break;
            case BlendOperation::Min: value = std::min(s, d); break;
            case BlendOperation::Max: value = std::max(s, d); break;
        }
        result[c] = static_cast<std::uint32_t>(value);
    }
    return result;
}

// A factor as all four channels have it: pure where it is the same constant in each, which the driver then leaves out.
struct VectorFactor {
    BlendFactor color, alpha;

    [[nodiscard]] static BlendFactor plain(BlendFactor f, bool is_alpha) {
        return is_alpha && f == BlendFactor::SourceAlphaSaturate ? BlendFactor::One : f;
    }
    [[nodiscard]] bool is(BlendFactor constant) const { return color == constant && plain(alpha, true) == constant; }
};

Codes llvmpipe_blend_float(ColorFormat format, const BlendState& state, const BlendCase& blended) {
    const Flushing fp{format == ColorFormat::Rgba32f};  // conversions of halves need denormals, and so all of it has them
    FactorInputs<float> in{.source = blended.source, .destination = {}, .constant = state.constant, .zero = 0, .one = 1};
    for (std::size_t c = 0; c < 4; ++c)
        in.destination[c] =
            format == ColorFormat::Rgba16f ? half_value(blended.destination[c]) : std::bit_cast<float>(blended.destination[c]);
    const auto invert = [fp](float x) { return fp.sub(1.0f, x); };
    const auto least = [fp](float a, float b) { return min_ps(fp(a), fp(b)); };

    // Min and max have factors of one.
    const auto effective = [](const BlendEquation& e) {
        return ignores_factors(e.operation) ? BlendEquation{BlendFactor::One, BlendFactor::One, e.operation} : e;
    };
    const BlendEquation color = effective(state.color);
    const BlendEquation alpha = effective(state.alpha);
    const VectorFactor source_factor{color.source, alpha.source};
    const VectorFactor destination_factor{color.destination, alpha.destination};
    const bool factors_first = !(color.source == color.destination && alpha.source == alpha.destination);

    const auto times = [&](float x, const VectorFactor& factor, std::size_t c) {
        if (factor.is(BlendFactor::One)) return x;
        if (factor.is(BlendFactor::Zero)) return 0.0f;
        return fp.mul(x, factor_value(c == 3 ? factor.alpha : factor.color, c, in, invert, least));
    };
    // With one term left out altogether, the other is not touched.
    const auto combined = [&](BlendOperation operation, float s, float d, bool no_s, bool no_d) {
        switch (operation) {
            case BlendOperation::Add: return no_s ? d : no_d ? s : fp.add(s, d);
            case BlendOperation::Subtract: return no_d ? s : fp.sub(s, d);
            case BlendOperation::ReverseSubtract: return no_s ? d : fp.sub(d, s);
            case BlendOperation::Min: return min_ps(fp(s), fp(d));
            case BlendOperation::Max: return max_ps(fp(s), fp(d));
        }
        return 0.0f;
    };
    Codes result{};
    for (std::size_t c = 0; c < 4; ++c) {
        const BlendEquation& e = c == 3 ? alpha : color;
        float value = 0;
        if (!factors_first && !ignores_factors(e.operation)) {
            value = times(combined(e.operation, in.source[c], in.destination[c], false, false), source_factor, c);
        } else {
            const float s = times(in.source[c], source_factor, c);
            const float d = times(in.destination[c], destination_factor, c);
            value = combined(e.operation, s, d, source_factor.is(BlendFactor::Zero), destination_factor.is(BlendFactor::Zero));
        }
        result[c] = llvmpipe_code(format, value);
    }
    return result;
}

// ---- SwiftShader ----

std::uint32_t swiftshader_half(float x) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
    const std::uint32_t sign = bits >> 16 & 0x8000u;
    std::uint32_t magnitude = bits & 0x7fffffffu;
    if (magnitude > 0x47ffefffu) return sign | 0x7fffu;
    if (magnitude < 0x38800000u) {
        // What is shifted out here does not take part in the rounding.
        const std::uint32_t shift = 113 - (magnitude >> 23);
        magnitude = shift < 24 ? ((magnitude & 0x7fffffu) | 0x800000u) >> shift : 0;
    } else {
        magnitude -= 0x38000000u;
    }
    return sign | (magnitude + 0xfffu + (magnitude >> 13 & 1u)) >> 13;
}

float swiftshader_half_value(std::uint32_t code) {
    if ((code >> 10 & 31u) != 31) return half_value(code);
    const float value = std::ldexp(1024 + static_cast<float>(code & 0x3ffu), 6);
    return (code & 0x8000u) != 0 ? -value : value;
}

std::uint32_t swiftshader_code(ColorFormat format, float x) {
    switch (format) {
        case ColorFormat::Rgba8: return static_cast<std::uint32_t>(round_to_int(min_ps(max_ps(x, 0.0f), 1.0f) * 255.0f));
        case ColorFormat::Rgba16Unorm:
            return static_cast<std::uint32_t>(round_to_int(min_ps(max_ps(x, 0.0f), 1.0f) * 65535.0f));
        case ColorFormat::Rgba16f: return swiftshader_half(x);
        case ColorFormat::Rgba32f: return std::bit_cast<std::uint32_t>(x);
    }
    return 0;
}

float swiftshader_value(ColorFormat format, std::uint32_t code) {
    switch (format) {
        case ColorFormat::Rgba8: return static_cast<float>(code * 257u) * (1.0f / 65535.0f);
        case ColorFormat::Rgba16Unorm: return static_cast<float>(code) * (1.0f / 65535.0f);
        case ColorFormat::Rgba16f: return swiftshader_half_value(code);
        case ColorFormat::Rgba32f: return std::bit_cast<float>(code);
    }
    return 0;
}

// Equations with these factors are not computed.
enum class Shortcut { None, Zero, Source, Destination };
Shortcut shortcut_of(const BlendEquation& e) {
    if (ignores_factors(e.operation)) return Shortcut::None;
    const bool no_source = e.source == BlendFactor::Zero;
    const bool no_destination = e.destination == BlendFactor::Zero;
    if (no_source && no_destination) return Shortcut::Zero;
    if (e.operation != BlendOperation::ReverseSubtract && e.source == BlendFactor::One && no_destination)
        return Shortcut::Source;
    if (e.operation != BlendOperation::Subtract && no_source && e.destination == BlendFactor::One) return Shortcut::Destination;
    return Shortcut::None;
}

float swiftshader_blended(const BlendEquation& e, std::size_t channel, const FactorInputs<float>& in) {
    const float source = in.source[channel];
    const float destination = in.destination[channel];
    switch (shortcut_of(e)) {
        case Shortcut::None: break;
        case Shortcut::Zero: return 0;
        case Shortcut::Source: return source;
        case Shortcut::Destination: return destination;
    }
    const Flushing fp{true};
    const auto invert = [fp](float x) { return fp.sub(1.0f, x); };
    const auto least = [fp](float source_alpha, float inverse) { return min_ps(fp(inverse), fp(source_alpha)); };
    const float s = fp.mul(source, factor_value(e.source, channel, in, invert, least));
    const float d = fp.mul(destination, factor_value(e.destination, channel, in, invert, least));
    switch (e.operation) {
        case BlendOperation::Add: return fp.add(s, d);
        case BlendOperation::Subtract: return fp.sub(s, d);
        case BlendOperation::ReverseSubtract: return fp.sub(d, s);
        case BlendOperation::Min: return min_ps(fp(source), fp(destination));
        case BlendOperation::Max: return max_ps(fp(source), fp(destination));
    }
    return 0;
}

}  // namespace

Codes llvmpipe_blend(ColorFormat format, const BlendState& state, const BlendCase& blended) {
    if (!state.enabled) {
        Codes written{};
        for (std::size_t c = 0; c < 4; ++c) written[c] = llvmpipe_code(format, blended.source[c]);
        return written;
    }
    return is_unorm(format) ? llvmpipe_blend_unorm(format, state, blended) : llvmpipe_blend_float(format, state, blended);
}

Codes llvmpipe_resolve(ColorFormat format, const SampleCodes& samples) {
    // Texels are decoded as for sampling, and the mean is written as a fragment's colour.
    const Flushing fp{true};
    const auto value_of = [format](std::uint32_t code) {
        switch (format) {
            case ColorFormat::Rgba8: return static_cast<float>(code) * (1.0f / 255.0f);
            case ColorFormat::Rgba16Unorm: return static_cast<float>(code) * (1.0f / 65535.0f);
            case ColorFormat::Rgba16f: return half_value(code);
            case ColorFormat::Rgba32f: return std::bit_cast<float>(code);
        }
        return 0.0f;
    };
    Codes resolved{};
    for (std::size_t c = 0; c < 4; ++c) {
        float sum = 0;
        for (const Codes& sample : samples) sum = fp.add(sum, value_of(sample[c]));
        resolved[c] = llvmpipe_code(format, fp.mul(sum, 0.25f));
    }
    return resolved;
}

Codes swiftshader_blend(ColorFormat format, const BlendState& state, const BlendCase& blended) {
    if (state.enabled && shortcut_of(state.color) == Shortcut::Destination && shortcut_of(state.alpha) == Shortcut::Destination)
        return blended.destination;
    FactorInputs<float> in{.source = blended.source, .destination = {}, .constant = state.constant, .zero = 0, .one = 1};
    for (std::size_t c = 0; c < 4; ++c) {
        in.destination[c] = swiftshader_value(format, blended.destination[c]);
        if (!is_unorm(format)) continue;
        in.source[c] = min_ps(max_ps(in.source[c], 0.0f), 1.0f);
        in.constant[c] = std::clamp(in.constant[c], 0.0f, 1.0f);
    }
    Codes result{};
    for (std::size_t c = 0; c < 4; ++c) {
        const float value = state.enabled ? swiftshader_blended(equation(state, c), c, in) : in.source[c];
        result[c] = swiftshader_code(format, value);
    }
    return result;
}

Codes swiftshader_resolve(ColorFormat format, const SampleCodes& samples) {
    Codes resolved{};
    for (std::size_t c = 0; c < 4; ++c) {
        const auto upper_mean = [](std::uint32_t a, std::uint32_t b) { return (a + b + 1) >> 1; };
        const std::array<std::uint32_t, 4> codes{samples[0][c], samples[1][c], samples[2][c], samples[3][c]};
        if (format == ColorFormat::Rgba8) {
            resolved[c] = upper_mean(upper_mean(codes[0], codes[1]), upper_mean(codes[2], codes[3]));
        } else if (format == ColorFormat::Rgba16Unorm) {
            const auto sum = static_cast<float>(codes[0] + codes[1] + codes[2] + codes[3]);
            resolved[c] = static_cast<std::uint32_t>(round_to_int(sum * 0.25f));
        } else {
            // The samples have been written by fragments: a half that is not finite has become 0x7fff.
            const auto value_of = [format](std::uint32_t code) {
                if (format == ColorFormat::Rgba16f) code = swiftshader_half(half_value(code));
                return swiftshader_value(format, code);
            };
            float sum = value_of(codes[0]);
            for (std::size_t s = 1; s < 4; ++s) sum += value_of(codes[s]);
            resolved[c] = swiftshader_code(format, sum * 0.25f);
        }
    }
    return resolved;
}

}  // namespace gnomon::agree
