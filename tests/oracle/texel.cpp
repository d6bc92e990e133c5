#include "tests/oracle/texel.h"

#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <limits>

namespace oracle {

using gnomon::ComponentType;
using gnomon::Format;
using gnomon::Profile;

double Arithmetic::round(double x) const {
    if (!fp32) return x;
    // What rounds to less than 2^-126 with an unbounded exponent is flushed, with its sign. D3D11.3 3.1.3.2
    if (flush && std::fabs(x) < 0x1.ffffffp-127) return std::copysign(0.0, x);
    return static_cast<double>(static_cast<float>(x));
}

double Arithmetic::largest() const { return fp32 ? static_cast<double>(FLT_MAX) : DBL_MAX; }

double Arithmetic::tiny() const {
    if (!fp32) return flush ? 0x1p-1022 : 0x1p-1074;
    return flush ? 0x1p-126 : 0x1p-149;
}

namespace {

/// 5 exponent bits over `mantissa_bits`, from the definition. D3D11.3 3.1.5, 3.1.6
double small_float(std::uint32_t code, int mantissa_bits) {
    const auto one = std::uint32_t{1} << mantissa_bits;
    const int exponent = static_cast<int>(code >> mantissa_bits & 31u);
    const double mantissa = code & (one - 1u);
    if (exponent == 31) return mantissa != 0 ? std::numeric_limits<double>::quiet_NaN() : HUGE_VAL;
    if (exponent == 0) return std::ldexp(mantissa, -14 - mantissa_bits);
    return std::ldexp(one + mantissa, exponent - 15 - mantissa_bits);
}

double srgb_to_linear(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

/// Bits of the unsigned normalised integers, 0 for other types.
int unorm_bits(ComponentType type) {
    switch (type) {
        case ComponentType::Unorm8:
        case ComponentType::Srgb8: return 8;
        case ComponentType::Unorm16:
        case ComponentType::Depth16: return 16;
        case ComponentType::Depth24: return 24;
        case ComponentType::Snorm8:
        case ComponentType::Snorm16:
        case ComponentType::Float16:
        case ComponentType::Float32:
        case ComponentType::Uint32:
        case ComponentType::Float11:
        case ComponentType::Depth32: return 0;
    }
    return 0;
}

double last_code(int bits) { return static_cast<double>((std::uint32_t{1} << bits) - 1u); }

/// c / (2^n - 1), or c times the binary32 reciprocal. D3D11.3 3.2.3.5
double unorm_value(std::uint32_t code, int bits, const Profile& profile) {
    const Arithmetic arithmetic(profile);
    if (profile.unorm_decode == gnomon::UnormDecode::Divide) return arithmetic.round(code / last_code(bits));
    return arithmetic.round(code * static_cast<double>(static_cast<float>(1.0 / last_code(bits))));
}

/// D3D11.3 3.2.3.3
double snorm_value(std::uint32_t code, int bits, const Profile& profile) {
    const std::int64_t half = std::int64_t{1} << (bits - 1);
    const std::int64_t value = code >= half ? code - 2 * half : code;
    const double scale = static_cast<double>(half - 1);
    return Arithmetic(profile).round(std::fmax(-1.0, static_cast<double>(value) / scale));
}

double clamp(double x, double low, double high) { return x < low ? low : x > high ? high : x; }

/// FLOAT -> UNORM, exactly. D3D11.3 3.2.3.6
double unorm_code(double x, int bits) {
    if (std::isnan(x)) return 0;
    return std::floor(clamp(x, 0.0, 1.0) * last_code(bits) + 0.5);
}

}  // namespace

double texel_value(Format format, const Profile& profile, std::uint32_t code, int component) {
    const ComponentType type = gnomon::format_info(format).type;
    switch (type) {
        case ComponentType::Unorm8:
        case ComponentType::Unorm16:
        case ComponentType::Depth16:
        case ComponentType::Depth24: return unorm_value(code, unorm_bits(type), profile);
        case ComponentType::Snorm8: return snorm_value(code, 8, profile);
        case ComponentType::Snorm16: return snorm_value(code, 16, profile);
        case ComponentType::Srgb8:
            if (component == 3) return unorm_value(code, 8, profile);
            return Arithmetic(profile).round(srgb_to_linear(code / 255.0));
        case ComponentType::Float16: {
            const double magnitude = small_float(code & 0x7fffu, 10);
            return (code & 0x8000u) != 0 ? -magnitude : magnitude;
        }
        case ComponentType::Float11: return small_float(code, component == 2 ? 5 : 6);
        case ComponentType::Float32:
        case ComponentType::Depth32: return static_cast<double>(std::bit_cast<float>(code));
        case ComponentType::Uint32: return code;
    }
    return 0;
}

double texel_error(Format format, const Profile& profile) {
    const bool fp64 = profile.arithmetic == gnomon::Arithmetic::Fp64;
    return fp64 && gnomon::format_info(format).type == ComponentType::Srgb8 ? 0x1p-46 : 0;
}

namespace {

/// The least and the greatest number of a format. D3D11.3 7.18.9.1
std::array<double, 2> range_of(ComponentType type, int component) {
    switch (type) {
        case ComponentType::Unorm8:
        case ComponentType::Unorm16:
        case ComponentType::Srgb8:
        case ComponentType::Depth16:
        case ComponentType::Depth24:
        case ComponentType::Depth32: return {0.0, 1.0};
        case ComponentType::Snorm8:
        case ComponentType::Snorm16: return {-1.0, 1.0};
        case ComponentType::Float16: return {-65504.0, 65504.0};
        case ComponentType::Float11: return {0.0, component == 2 ? 64512.0 : 65024.0};
        case ComponentType::Float32:
        case ComponentType::Uint32: return {-HUGE_VAL, HUGE_VAL};
    }
    return {0.0, 0.0};
}

}  // namespace

double border_value(Format format, const Profile& profile, float border) {
    double value = static_cast<double>(border);
    if (profile.border_precision == gnomon::BorderPrecision::Unorm8)
        value = Arithmetic(profile).round(unorm_code(value, 8) / 255.0);
    // Ranges of the components of R11G11B10 differ above 64512 only, where the tests have no border.
    const auto [low, high] = range_of(gnomon::format_info(format).type, 0);
    return clamp(value, low, high);
}

double compared_texel(Format format, const Profile& profile, std::uint32_t code) {
    const int bits = unorm_bits(gnomon::format_info(format).type);
    if (bits != 0 && profile.compare_reference == gnomon::CompareReference::Quantised) return code;
    return Arithmetic(profile).round(texel_value(format, profile, code, 0));
}

double compared_reference(Format format, const Profile& profile, double reference) {
    const ComponentType type = gnomon::format_info(format).type;
    const int bits = unorm_bits(type);
    if (bits != 0 && profile.compare_reference == gnomon::CompareReference::Quantised) return unorm_code(reference, bits);
    const auto [low, high] = range_of(type, 0);
    return Arithmetic(profile).round(clamp(reference, low, high));
}

bool passes(gnomon::CompareOp op, double reference, double texel) {
    switch (op) {
        case gnomon::CompareOp::Never: return false;
        case gnomon::CompareOp::Less: return reference < texel;
        case gnomon::CompareOp::Equal: return reference == texel;
        case gnomon::CompareOp::LessEqual: return reference <= texel;
        case gnomon::CompareOp::Greater: return reference > texel;
        case gnomon::CompareOp::NotEqual: return reference != texel;
        case gnomon::CompareOp::GreaterEqual: return reference >= texel;
        case gnomon::CompareOp::Always: return true;
    }
    return false;
}

}  // namespace oracle
