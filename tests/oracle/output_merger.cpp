#include "tests/oracle/output_merger.h"

#include "tests/oracle/texel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace oracle {

using gnomon::BlendFactor;
using gnomon::BlendOp;
using gnomon::ComponentType;
using gnomon::Format;
using gnomon::Narrowing;
using gnomon::Profile;
using gnomon::StencilOp;

namespace {

/// Where component c lies in a texel of up to 128 bits.
struct BitField {
    int first, count;
};
BitField bits_of(Format format, int c) {
    const gnomon::FormatInfo& info = gnomon::format_info(format);
    if (info.type == ComponentType::Float11) return {11 * c, c == 2 ? 10 : 11};
    const int bits = info.bytes_per_texel * 8 / info.components;
    return {bits * c, bits};
}

/// Towards 0 or to nearest even; what is not finite stays, what is too large to be rounded towards 0 is the largest number.
std::uint32_t small_float_code(double x, int mantissa_bits, bool has_sign, Narrowing narrowing) {
    const std::uint32_t infinity = 31u << mantissa_bits;
    if (std::isnan(x)) return infinity | 1u << (mantissa_bits - 1);
    const std::uint32_t sign = has_sign && std::signbit(x) ? 0x8000u : 0u;
    if (!has_sign && x <= 0) return 0;
    const double magnitude = std::fabs(x);
    if (std::isinf(magnitude)) return sign | infinity;
    // Codes count steps of the last place: 2^mantissa_bits of them per power of two.
    const int exponent = magnitude > 0 ? std::max(std::ilogb(magnitude), -14) : -14;
    const double steps = std::ldexp(magnitude, mantissa_bits - exponent);
    const double whole = narrowing == Narrowing::TowardZero ? std::floor(steps) : std::nearbyint(steps);
    const double code = whole + std::ldexp(static_cast<double>(exponent + 14), mantissa_bits);
    if (code >= infinity) return sign | (narrowing == Narrowing::TowardZero ? infinity - 1u : infinity);
    return sign | static_cast<std::uint32_t>(code);
}

double clamp(double x, double low, double high) {
    if (std::isnan(x)) return 0;
    return std::fmin(std::fmax(x, low), high);
}

std::uint32_t unorm(double x, double scale) { return static_cast<std::uint32_t>(std::floor(clamp(x, 0, 1) * scale + 0.5)); }

std::uint32_t snorm(double x, int bits) {
    const double scaled = clamp(x, -1, 1) * (std::ldexp(1.0, bits - 1) - 1);
    const auto code = static_cast<std::int32_t>(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
    return static_cast<std::uint32_t>(code) & ((1u << bits) - 1u);
}

std::uint32_t srgb(double x) {
    const double linear = clamp(x, 0, 1);
    return unorm(linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055, 255);
}

}  // namespace

std::uint32_t stored_code(Format format, const std::byte* texel, int component) {
    const BitField field = bits_of(format, component);
    std::uint64_t window = 0;
    const int byte = field.first / 8;
    std::memcpy(&window, texel + byte,
                static_cast<std::size_t>(std::min(8, gnomon::format_info(format).bytes_per_texel - byte)));
    return static_cast<std::uint32_t>(window >> (field.first % 8) & ((std::uint64_t{1} << field.count) - 1u));
}

void store_code(Format format, std::byte* texel, int component, std::uint32_t code) {
    const BitField field = bits_of(format, component);
    for (int i = 0; i < field.count; ++i) {
        const int at = field.first + i;
        const auto bit = std::byte{1} << (at % 8);
        std::byte& byte = texel[at / 8];
        byte = (code >> i & 1u) != 0 ? byte | bit : byte & ~bit;
    }
}

std::uint32_t component_code(Format format, const Profile& profile, double value, int component) {
    const Narrowing narrowing = profile.float_narrowing;
    switch (gnomon::format_info(format).type) {
        case ComponentType::Unorm8: return unorm(value, 255);
        case ComponentType::Srgb8: return component == 3 ? unorm(value, 255) : srgb(value);
        case ComponentType::Unorm16: return unorm(value, 65535);
        case ComponentType::Snorm8: return snorm(value, 8);
        case ComponentType::Snorm16: return snorm(value, 16);
        case ComponentType::Float16: return small_float_code(value, 10, true, narrowing);
        case ComponentType::Float11: return small_float_code(value, component == 2 ? 5 : 6, false, narrowing);
        case ComponentType::Float32:
            return std::isnan(value) ? 0x7fc00000u : std::bit_cast<std::uint32_t>(static_cast<float>(value));
        case ComponentType::Uint32: return static_cast<std::uint32_t>(clamp(value, 0, 4294967295.0));
        case ComponentType::Depth16:
        case ComponentType::Depth24:
        case ComponentType::Depth32: break;
    }
    return 0;
}

namespace {

/// D3D11.3 17.5: values that enter the blender are clamped to the range of the target.
Color clamped(Color color, ComponentType type) {
    const bool is_unorm = type == ComponentType::Unorm8 || type == ComponentType::Unorm16 || type == ComponentType::Srgb8;
    const bool is_snorm = type == ComponentType::Snorm8 || type == ComponentType::Snorm16;
    for (double& x : color)
        if (is_unorm || is_snorm) x = clamp(x, is_snorm ? -1 : 0, 1);
    return color;
}

/// Min and max of the shader instructions: the other operand where one is NaN. D3D11.3 22.10.10, 22.10.11
double lesser(double a, double b) { return std::isnan(b) || a < b ? a : b; }
double greater(double a, double b) { return std::isnan(b) || a > b ? a : b; }

}  // namespace

Color blend(const BlendSources& sources, const Color& stored, const gnomon::BlendState& state, Format format,
            const Profile& profile) {
    const ComponentType type = gnomon::format_info(format).type;
    const Arithmetic arithmetic(profile);
    const auto r = [&](double x) { return arithmetic.round(x); };
    const Color src = clamped(sources.src, type);
    const Color src1 = clamped(sources.src1, type);
    const Color constant = clamped(sources.constant, type);

    const auto factor = [&](BlendFactor which, std::size_t c) {
        switch (which) {
            case BlendFactor::Zero: return 0.0;
            case BlendFactor::One: return 1.0;
            case BlendFactor::SrcColor: return src[c];
            case BlendFactor::InvSrcColor: return r(1 - src[c]);
            case BlendFactor::SrcAlpha: return src[3];
            case BlendFactor::InvSrcAlpha: return r(1 - src[3]);
            case BlendFactor::DstAlpha: return stored[3];
            case BlendFactor::InvDstAlpha: return r(1 - stored[3]);
            case BlendFactor::DstColor: return stored[c];
            case BlendFactor::InvDstColor: return r(1 - stored[c]);
            case BlendFactor::SrcAlphaSaturate: return c == 3 ? 1.0 : lesser(r(1 - stored[3]), src[3]);
            case BlendFactor::Constant: return constant[c];
            case BlendFactor::InvConstant: return r(1 - constant[c]);
            case BlendFactor::Src1Color: return src1[c];
            case BlendFactor::InvSrc1Color: return r(1 - src1[c]);
            case BlendFactor::Src1Alpha: return src1[3];
            case BlendFactor::InvSrc1Alpha: return r(1 - src1[3]);
        }
        return 0.0;
    };

    Color result{};
    for (std::size_t c = 0; c < 4; ++c) {
        const BlendOp op = c == 3 ? state.op_alpha : state.op;
        const double s = r(src[c] * factor(c == 3 ? state.src_alpha : state.src, c));
        const double d = r(stored[c] * factor(c == 3 ? state.dst_alpha : state.dst, c));
        switch (op) {
            case BlendOp::Add: result[c] = r(s + d); break;
            case BlendOp::Subtract: result[c] = r(s - d); break;
            case BlendOp::ReverseSubtract: result[c] = r(d - s); break;
            case BlendOp::Min: result[c] = lesser(src[c], stored[c]); break;
            case BlendOp::Max: result[c] = greater(src[c], stored[c]); break;
        }
    }
    return result;
}

StencilOutcome stencil(const gnomon::StencilState& state, bool front, bool depth_passes, int stored) {
    const gnomon::StencilFace& face = front ? state.front : state.back;
    const bool stencil_passes = passes(face.compare, state.reference & state.read_mask, stored & state.read_mask);
    const StencilOp op = !stencil_passes ? face.fail : !depth_passes ? face.depth_fail : face.pass;
    int result = stored;
    switch (op) {
        case StencilOp::Keep: break;
        case StencilOp::Zero: result = 0; break;
        case StencilOp::Replace: result = state.reference; break;
        case StencilOp::IncrementSaturate: result = std::min(stored + 1, 255); break;
        case StencilOp::DecrementSaturate: result = std::max(stored - 1, 0); break;
        case StencilOp::Invert: result = 255 - stored; break;
        case StencilOp::Increment: result = (stored + 1) % 256; break;
        case StencilOp::Decrement: result = (stored + 255) % 256; break;
    }
    // The write mask lets single bits through.
    int kept = 0;
    for (int bit = 1; bit < 256; bit *= 2) kept += ((state.write_mask & bit) != 0 ? result : stored) & bit;
    return {stencil_passes && depth_passes, kept};
}

}  // namespace oracle
