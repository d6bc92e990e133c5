// The texture unit from the specification, one lane at a time: exact weights, exact sums in double (24-bit texels times 16-bit
// weights fit 53 bits), texel values from integers. D3D11.3 3.2.3, 3.2.4.1, 7.18.5 to 7.18.10
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace oracle {

enum class Address { Wrap, Mirror, Clamp, Border, MirrorOnce };

/// 16.8 fixed point from a float: nearest, ties to even; NaN gives 0. D3D11.3 3.2.4.1
inline std::int64_t fixed8(float x) {
    if (x != x) return 0;
    const double scaled = static_cast<double>(x) * 256.0;
    double whole = std::floor(scaled);
    const double rest = scaled - whole;
    if (rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) != 0)) whole += 1;
    return static_cast<std::int64_t>(whole);
}

/// ReduceRange as the specification spells it. D3D11.3 7.18.6
inline float reduce_range(float u, Address mode) {
    switch (mode) {
        case Address::Wrap: return u - std::floor(u);
        case Address::Mirror: return (u / 2 - std::trunc(u / 2)) * 2;
        case Address::Clamp:
        case Address::MirrorOnce:
        case Address::Border: return u <= -10 ? -10.0f : u >= 10 ? 10.0f : u;
    }
    return 0;
}

/// The texel a (possibly outside) index stands for, or -1 for the border colour. D3D11.3 7.18.9
inline std::int64_t address(std::int64_t t, std::int64_t n, Address mode) {
    if (t >= 0 && t <= n - 1) return t;
    switch (mode) {
        case Address::Wrap: {
            const std::int64_t r = t % n;
            return r < 0 ? r + n : r;
        }
        case Address::Mirror: {
            if (t < 0) t = -t - 1;
            const bool flip = (t / n) % 2 != 0;
            t %= n;
            return flip ? n - t - 1 : t;
        }
        case Address::Clamp: return t < 0 ? 0 : n - 1;
        case Address::MirrorOnce: {
            if (t < 0) t = -t - 1;
            return t > n - 1 ? n - 1 : t;
        }
        case Address::Border: return -1;
    }
    return 0;
}

/// Texels along one axis and the weight of the second, in 1/256.
struct Axis {
    std::array<std::int64_t, 2> texel;  // -1: border
    std::int64_t weight = 0;
};

inline Axis linear_axis(float u, int size, Address mode) {
    const float scaled = reduce_range(u, mode) * static_cast<float>(size) - 0.5f;
    const std::int64_t fixed = fixed8(scaled);
    const std::int64_t floor = fixed >= 0 ? fixed / 256 : -((-fixed + 255) / 256);
    return {{address(floor, size, mode), address(floor + 1, size, mode)}, fixed - floor * 256};
}

inline Axis point_axis(float u, int size, Address mode) {
    const std::int64_t fixed = fixed8(reduce_range(u, mode) * static_cast<float>(size));
    const std::int64_t floor = fixed >= 0 ? fixed / 256 : -((-fixed + 255) / 256);
    return {{address(floor, size, mode), -1}, 0};
}

/// A single-channel image of exact values.
struct Image {
    int width, height;
    std::vector<double> texels;
    double border = 0;

    [[nodiscard]] double at(std::int64_t x, std::int64_t y) const {
        return x < 0 || y < 0 ? border : texels[static_cast<std::size_t>(y * width + x)];
    }
    /// The four texels in the order (floor, floor), (ceil, floor), (floor, ceil), (ceil, ceil).
    [[nodiscard]] std::array<double, 4> taps(const Axis& u, const Axis& v) const {
        return {at(u.texel[0], v.texel[0]), at(u.texel[1], v.texel[0]), at(u.texel[0], v.texel[1]), at(u.texel[1], v.texel[1])};
    }
};

/// The reference sum of D3D11.3 7.18.8, exact for texels of up to 37 bits.
inline double bilinear(const std::array<double, 4>& t, std::int64_t wu, std::int64_t wv) {
    const auto w = [](std::int64_t a, std::int64_t b) { return static_cast<double>(a * b) * 0x1p-16; };
    return t[0] * w(256 - wu, 256 - wv) + t[2] * w(256 - wu, wv) + t[1] * w(wu, 256 - wv) + t[3] * w(wu, wv);
}

/// The form the profile calls "lerp", in fp32: u first, then v.
inline float lerp_form(const std::array<double, 4>& t, std::int64_t wu, std::int64_t wv) {
    const auto mix = [](float a, float b, float w) { return a + w * (b - a); };
    const float u = static_cast<float>(wu) / 256.0f;
    const float v = static_cast<float>(wv) / 256.0f;
    const float top = mix(static_cast<float>(t[0]), static_cast<float>(t[1]), u);
    const float bottom = mix(static_cast<float>(t[2]), static_cast<float>(t[3]), u);
    return mix(top, bottom, v);
}

/// A half as a number, from its definition. D3D11.3 3.1.5
inline double half_value(std::uint32_t bits) {
    const double sign = (bits & 0x8000u) != 0 ? -1.0 : 1.0;
    const int exponent = static_cast<int>(bits >> 10 & 31u);
    const int mantissa = static_cast<int>(bits & 1023u);
    if (exponent == 31) return mantissa != 0 ? std::numeric_limits<double>::quiet_NaN() : sign * HUGE_VAL;
    if (exponent == 0) return sign * std::ldexp(mantissa, -24);
    return sign * std::ldexp(1024 + mantissa, exponent - 25);
}

}  // namespace oracle
