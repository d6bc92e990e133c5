// D3D11.3 3.2.3: normalised, sRGB and unsigned integers to floats and back, every code and both sides of every boundary.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/codec.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <limits>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

constexpr Sampler kNearest{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest};

/// The numbers of 256 (8-bit formats) or 65536 texels, component c of texel i holding the code (i + 37 c) modulo their count.
template <class Real>
struct EveryCode {
    int bits;
    std::vector<std::uint32_t> codes;
    std::vector<std::array<typename Real::Scalar, 4>> colors;

    EveryCode(Format format, const Profile& profile) : bits(format_info(format).bits_per_component) {
        const int height = bits == 8 ? 1 : 256;
        const auto components = static_cast<std::uint32_t>(format_info(format).components);
        const std::uint32_t mask = (1u << bits) - 1u;
        std::vector<Coordinate> coordinates;
        for (std::uint32_t i = 0; i <= mask; ++i) {
            for (std::uint32_t c = 0; c < components; ++c) codes.push_back((i + 37 * c) & mask);
            coordinates.push_back({(static_cast<float>(i % 256) + 0.5f) / 256.0f,
                                   (static_cast<float>(i / 256) + 0.5f) / static_cast<float>(height)});
        }
        colors = sample_all<Real>(texture_of(format, 256, height, codes), kNearest, profile, coordinates);
    }
};

/// The integer that a normalised code stands for: numerator over 2^n - 1, or 2^(n-1) - 1 for SNORM. 3.2.3.3, 3.2.3.5
int numerator(bool is_signed, int bits, std::uint32_t code) {
    if (!is_signed) return static_cast<int>(code);
    const int value = code >= 1u << (bits - 1) ? static_cast<int>(code) - (1 << bits) : static_cast<int>(code);
    return std::max(value, -((1 << (bits - 1)) - 1));
}
int denominator(bool is_signed, int bits) { return (1 << (is_signed ? bits - 1 : bits)) - 1; }

/// Whether no float is nearer to p / q: |x q - p| is exact in double, as x q has at most 40 bits and lies next to p.
bool is_nearest(float x, int p, int q) {
    const auto distance = [&](float y) { return std::fabs(static_cast<double>(y) * q - p); };
    return distance(x) <= distance(std::nextafter(x, -8.0f)) && distance(x) <= distance(std::nextafter(x, 8.0f));
}

bool is_signed(ComponentType type) { return type == ComponentType::Snorm8 || type == ComponentType::Snorm16; }

/// 3.2.3.8 up to the rounding to integer, in units of codes.
long double srgb_scale(long double c) {
    const long double limited = c > 0 ? (c < 1 ? c : 1) : 0;
    return 255 * (limited <= 0.0031308L ? 12.92L * limited : 1.055L * std::pow(limited, 1 / 2.4L) - 0.055L);
}

/// floor(|x| n + 1/2) for |x| clamped to 1, NaN as 0: on integers, exact for every double. 3.2.3.4, 3.2.3.6
std::int64_t rounded_code(double x, int n) {
    const double magnitude = std::fabs(x);
    if (!(magnitude > 0)) return 0;
    if (magnitude >= 1) return n;
    int exponent = 0;
    const double fraction = std::frexp(magnitude, &exponent);  // [1/2, 1)
    const auto mantissa = static_cast<unsigned __int128>(std::ldexp(fraction, 53));
    const int shift = 53 - exponent;
    if (shift > 120) return 0;
    const auto twice = mantissa * static_cast<unsigned>(n) * 2u + (static_cast<unsigned __int128>(1) << shift);
    return static_cast<std::int64_t>(twice >> (shift + 1));
}

/// The code a codec gives for each value.
template <class AnyCodec, class Real>
std::vector<std::int32_t> encoded(const std::vector<typename Real::Scalar>& values, std::size_t component = 0) {
    std::vector<std::int32_t> codes;
    for (std::size_t i = 0; i < values.size(); i += kLanes) {
        std::array<typename Real::Scalar, kLanes> wave{};
        for (std::size_t l = 0; l < wave.size(); ++l) wave[l] = values[std::min(i + l, values.size() - 1)];
        const auto lanes = AnyCodec::template code_of<Real>(Real::load(wave.data()), component, Narrowing::TowardZero).lanes();
        for (std::size_t l = 0; l < wave.size() && i + l < values.size(); ++l) codes.push_back(lanes[l]);
    }
    return codes;
}

/// x and its neighbours up to two floats away, with both signs.
void add_around(std::vector<float>& values, double x) {
    float below = static_cast<float>(x);
    float above = below;
    values.push_back(below);
    for (int ulp = 0; ulp < 2; ++ulp) {
        below = std::nextafter(below, -HUGE_VALF);
        above = std::nextafter(above, HUGE_VALF);
        values.push_back(below);
        values.push_back(above);
    }
    for (std::size_t i = values.size() - 5, end = values.size(); i < end; ++i) values.push_back(-values[i]);
}

std::vector<float> special_floats() {
    return {std::nanf(""), -std::nanf(""), HUGE_VALF, -HUGE_VALF, 3e38f,   -3e38f,    1e-40f,
            -1e-40f,       0.0f,           -0.0f,     1.0f,       -1.0f,   0x1p-149f, std::nextafter(1.0f, 0.0f),
            1.0000001f,    -1.0000001f,    0x1p-126f, 0.5f,       -0x1p-9f};
}

template <ComponentType kType>
void check_narrowing(int bits) {
    using AnyCodec = Codec<kType, 1>;
    const bool with_sign = is_signed(kType);
    const int n = denominator(with_sign, bits);
    std::vector<float> values = special_floats();
    for (int k = 0; k <= n; ++k) {
        add_around(values, k / static_cast<double>(n));
        add_around(values, (k + 0.5) / n);
    }
    const auto expect = [&](double x) {
        const std::int64_t magnitude = !with_sign && x < 0 ? 0 : rounded_code(x, n);
        return x < 0 ? -magnitude : magnitude;
    };
    const auto number = [&](std::int32_t code) { return with_sign && code > n ? code - (1 << bits) : code; };
    const auto codes = encoded<AnyCodec, Float>(values);
    for (std::size_t i = 0; i < values.size(); ++i)
        if (number(codes[i]) != expect(static_cast<double>(values[i])))
            FAIL(fmt::format("{} bits{}: {:a} became {}, expected {}", bits, with_sign ? " signed" : "", values[i],
                             number(codes[i]), expect(static_cast<double>(values[i]))));

    // Doubles: the boundary itself may go either way within 2^-40 of a code, of the 0.6 that 3.2.3.6 allows.
    std::vector<double> wide;
    for (int k = 0; k <= n; ++k)
        for (const double delta : {-0x1p-39, 0.0, 0x1p-39})
            for (const double sign : {1.0, -1.0}) wide.push_back(sign * (k + 0.5 + delta) / n);
    for (const double x : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300, -1e300, 1e-310, 0.0, -0.0}) wide.push_back(x);
    const auto wide_codes = encoded<AnyCodec, Double>(wide);
    for (std::size_t i = 0; i < wide.size(); ++i) {
        const double tie = std::fabs(std::fabs(wide[i]) * n - std::floor(std::fabs(wide[i]) * n) - 0.5);
        const std::int64_t slack = tie < 0x1p-40 ? 1 : 0;
        if (std::abs(number(wide_codes[i]) - expect(wide[i])) > slack)
            FAIL(fmt::format("{} bits{}: double {:a} became {}, expected {}", bits, with_sign ? " signed" : "", wide[i],
                             number(wide_codes[i]), expect(wide[i])));
    }
}

}  // namespace

TEMPLATE_TEST_CASE("every normalised code is the correctly rounded quotient", "[3.2.3.2][3.2.3.3][3.2.3.5]", Float, Double) {
    for (const FormatInfo& info : kFormats) {
        const bool with_sign = is_signed(info.type);
        if (!with_sign && info.type != ComponentType::Unorm8 && info.type != ComponentType::Unorm16 &&
            info.type != ComponentType::Depth16)
            continue;
        const EveryCode<TestType> all(info.format, Profile{});
        const int q = denominator(with_sign, all.bits);
        const auto components = static_cast<std::size_t>(info.components);
        for (std::size_t i = 0; i < all.colors.size(); ++i)
            for (std::size_t c = 0; c < components; ++c) {
                const std::uint32_t code = all.codes[i * components + c];
                const int p = numerator(with_sign, all.bits, code);
                const auto got = all.colors[i][c];
                bool right = false;
                if constexpr (std::is_same_v<TestType, Float>) {
                    right = is_nearest(got, p, q);
                } else {
                    right = got == static_cast<double>(p) / q;  // the division of IEEE 754 is the rounded quotient
                }
                if (!right) FAIL(fmt::format("{} code {:#x} component {}: {:a}, not {} / {}", info.name, code, c, got, p, q));
            }
    }
}

TEST_CASE("24-bit depths are correctly rounded quotients", "[3.2.3.5]") {
    std::vector<std::uint32_t> codes;
    oracle::Random random(24);
    for (std::uint32_t i = 0; i < 65536; ++i)
        codes.push_back(i < 300 ? i : i < 600 ? 0xffffffu - (i - 300) : random.bits() >> 8);
    std::vector<Coordinate> coordinates;
    for (int i = 0; i < 65536; ++i)
        coordinates.push_back({(static_cast<float>(i % 256) + 0.5f) / 256.0f, (static_cast<float>(i / 256) + 0.5f) / 256.0f});
    const Texture texture = texture_of(Format::D24, 256, 256, codes);
    const auto got = sample_all(texture, kNearest, Profile{}, coordinates);
    for (std::size_t i = 0; i < got.size(); ++i) {
        const auto distance = [&](float x) {
            return std::fabs(static_cast<long double>(x) * 16777215.0L - static_cast<long double>(codes[i]));
        };
        if (distance(got[i][0]) > distance(std::nextafter(got[i][0], -8.0f)) ||
            distance(got[i][0]) > distance(std::nextafter(got[i][0], 8.0f)))
            FAIL(fmt::format("code {:#x}: {:a}", codes[i], got[i][0]));
    }
}

TEST_CASE("every sRGB code is the rounded value of the ideal conversion", "[3.2.3.7]") {
    const EveryCode<Float> narrow(Format::Rgba8Srgb, Profile{});
    const EveryCode<Double> wide(Format::Rgba8Srgb, Profile{});
    long double worst = 0;
    for (std::size_t i = 0; i < narrow.colors.size(); ++i)
        for (std::size_t component = 0; component < 4; ++component) {
            const std::uint32_t code = narrow.codes[4 * i + component];
            const float got = narrow.colors[i][component];
            const long double c = static_cast<long double>(code) / 255;
            const long double ideal = component == 3 ? c : c <= 0.04045L ? c / 12.92L : std::pow((c + 0.055L) / 1.055L, 2.4L);
            // "there are a couple of exceptions to this tolerance ...: 0.0f and 1.0f (the ends) must be exactly achievable"
            if ((code == 0 && got != 0.0f) || (code == 255 && got != 1.0f)) FAIL(fmt::format("code {}: {:a}", code, got));
            if (got != static_cast<float>(ideal) ||
                std::fabs(static_cast<long double>(wide.colors[i][component]) - ideal) > 1e-15L)
                FAIL(fmt::format("code {} component {}: {:a} and {:a}, expected {:a}", code, component, got,
                                 wide.colors[i][component], static_cast<double>(ideal)));
            // The procedure of 3.2.3.7: back without the rounding to integer, the difference in codes.
            if (component < 3) worst = std::max(worst, std::fabs(srgb_scale(static_cast<long double>(got)) - code));
        }
    // Allowed is 0.5; correctly rounded values leave half an ULP of binary32 times the slope, 1.055 / 2.4 of the value in
    // codes.
    CHECK(static_cast<double>(worst) > 0);
    CHECK(static_cast<double>(worst) <= 0x1p-24 * 255 * 1.055 / 2.4);
}

TEST_CASE("floats become the nearest UNORM code, halves up, at every boundary", "[3.2.3.6]") {
    check_narrowing<ComponentType::Unorm8>(8);
    check_narrowing<ComponentType::Unorm16>(16);
}

TEST_CASE("floats become the nearest SNORM code, halves away from zero, at every boundary", "[3.2.3.4]") {
    check_narrowing<ComponentType::Snorm8>(8);
    check_narrowing<ComponentType::Snorm16>(16);
}

TEMPLATE_TEST_CASE("floats become the nearest sRGB code at every boundary", "[3.2.3.8]", Float, Double) {
    std::vector<float> values = special_floats();
    for (int k = 0; k < 255; ++k) {
        // Where the ideal conversion passes k + 1/2, by bisection of what it says.
        long double low = 0;
        long double high = 1;
        for (int step = 0; step < 80; ++step) {
            const long double middle = (low + high) / 2;
            (srgb_scale(middle) < k + 0.5L ? low : high) = middle;
        }
        add_around(values, static_cast<double>(low));
        add_around(values, static_cast<double>(std::pow((static_cast<long double>(k) / 255 + 0.055L) / 1.055L, 2.4L)));
    }
    oracle::Random random(8);
    for (int i = 0; i < 100000; ++i) values.push_back(random.unit());
    std::vector<typename TestType::Scalar> inputs(values.begin(), values.end());
    const auto codes = encoded<Codec<ComponentType::Srgb8, 4>, TestType>(inputs);
    int between = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const long double scaled = srgb_scale(static_cast<long double>(values[i]));
        if (std::fabs(scaled - std::floor(scaled) - 0.5L) < 1e-13L) continue;  // what long double cannot decide
        ++between;
        if (codes[i] != static_cast<std::int32_t>(std::floor(scaled + 0.5L)))
            FAIL(fmt::format("{:a} became {}, ideally {}", values[i], codes[i], static_cast<double>(scaled)));
    }
    CHECK(static_cast<std::size_t>(between) + 10 > values.size());
    // Alpha is UNORM.
    CHECK(encoded<Codec<ComponentType::Srgb8, 4>, TestType>({typename TestType::Scalar(0.5f)}, 3)[0] == 128);
}

TEST_CASE("every code survives the way to float and back, of the two codes of -1 the higher", "[3.2.3][19.1.2]") {
    const auto check = [&]<class AnyCodec, class Real>(AnyCodec, Real, Format format) {
        const EveryCode<Real> all(format, Profile{});
        std::vector<typename Real::Scalar> values;
        for (const auto& color : all.colors) values.push_back(color[0]);
        const auto codes = encoded<AnyCodec, Real>(values);
        const bool with_sign = is_signed(format_info(format).type);
        const auto components = static_cast<std::size_t>(format_info(format).components);
        for (std::size_t i = 0; i < codes.size(); ++i) {
            std::uint32_t expected = all.codes[i * components];
            if (with_sign && expected == 1u << (all.bits - 1)) ++expected;
            if (static_cast<std::uint32_t>(codes[i]) != expected)
                FAIL(fmt::format("{} code {:#x} came back as {:#x} from {:a}", format_info(format).name, expected, codes[i],
                                 values[i]));
        }
    };
    const auto both = [&]<class AnyCodec>(AnyCodec codec, Format format) {
        check(codec, Float(), format);
        check(codec, Double(), format);
    };
    both(Codec<ComponentType::Unorm8, 1>{}, Format::R8Unorm);
    both(Codec<ComponentType::Snorm8, 1>{}, Format::R8Snorm);
    both(Codec<ComponentType::Srgb8, 4>{}, Format::Rgba8Srgb);
    both(Codec<ComponentType::Unorm16, 1>{}, Format::R16Unorm);
    both(Codec<ComponentType::Snorm16, 1>{}, Format::R16Snorm);
}

TEST_CASE("formats of unsigned integers give their codes to the bit", "[22.4.15][19.1.4]") {
    oracle::Random random(32);
    for (const Format format : {Format::R32Uint, Format::Rg32Uint, Format::Rgba32Uint}) {
        const auto components = static_cast<std::size_t>(format_info(format).components);
        std::vector<std::uint32_t> codes(64 * 64 * components);
        const std::array<std::uint32_t, 10> edges{0,           1,           0x007fffffu, 0x00800000u, 0x7f800001u,
                                                  0x7fffffffu, 0x80000000u, 0x80000001u, 0xff800001u, 0xffffffffu};
        for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = i < edges.size() ? edges[i] : random.bits();
        const Texture texture = texture_of(format, 64, 64, codes);
        for (const bool flush : {true, false}) {
            Profile profile;
            profile.flush_denormals = flush;
            const DenormalScope denormals(flush);
            for (int first = 0; first < 64 * 64; first += kLanes) {
                const Float at(lane_index() + Int(first % 64));
                const Vec3<Float> coordinate{(at + Float(0.5f)) * Float(1.0f / 64.0f),
                                             Float((static_cast<float>(first / 64) + 0.5f) / 64.0f), Float(0.0f)};
                const Vec4<Int> got =
                    sample_codes(TextureView(texture), Sampler{}, profile, coordinate, LevelOfDetail<Float>(Float(0.0f)));
                const std::array<std::array<std::int32_t, kLanes>, 4> lanes{got.x.lanes(), got.y.lanes(), got.z.lanes(),
                                                                            got.w.lanes()};
                for (std::size_t l = 0; l < kLanes; ++l)
                    for (std::size_t c = 0; c < 4; ++c) {
                        const std::uint32_t expected = c < components
                                                           ? codes[(static_cast<std::size_t>(first) + l) * components + c]
                                                       : c == 3 ? 1u
                                                                : 0u;
                        if (static_cast<std::uint32_t>(lanes[c][l]) != expected)
                            FAIL(fmt::format("{} texel {} component {}: {:#x}, expected {:#x}", format_info(format).name,
                                             static_cast<std::size_t>(first) + l, c, lanes[c][l], expected));
                    }
            }
        }
    }
}

TEMPLATE_TEST_CASE("floats become unsigned integers toward zero, within their range", "[22.13.4]", Float, Double) {
    using Scalar = typename TestType::Scalar;
    std::vector<Scalar> values{Scalar(std::nanf("")), Scalar(HUGE_VALF), -Scalar(HUGE_VALF), Scalar(-1),
                               Scalar(-0.5),          Scalar(0)};
    for (int e = -3; e <= 40; ++e)
        for (const Scalar base : {std::ldexp(Scalar(1), e), std::ldexp(Scalar(1.5), e), std::ldexp(Scalar(1.9999), e)}) {
            values.push_back(base);
            values.push_back(std::nextafter(base, Scalar(0)));
            values.push_back(std::nextafter(base, Scalar(HUGE_VALF)));
            values.push_back(-base);
        }
    values.push_back(Scalar(4294967295.0));
    values.push_back(Scalar(4294967294.5));
    const auto codes = encoded<Codec<ComponentType::Uint32, 1>, TestType>(values);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto x = static_cast<long double>(values[i]);
        const std::uint32_t expected = !(x > 0)             ? 0u
                                       : x >= 4294967295.0L ? 0xffffffffu
                                                            : static_cast<std::uint32_t>(static_cast<std::uint64_t>(x));
        if (static_cast<std::uint32_t>(codes[i]) != expected)
            FAIL(fmt::format("{:a} became {}, expected {}", values[i], static_cast<std::uint32_t>(codes[i]), expected));
    }
}
