// [Annen07] The shadow test as a Fourier series: the series itself, what storage in few bits costs it, what filters make of it,
// and where it fails.
#include "scenes/procedural.h"
#include "sim/fixed.h"
#include "techniques/csm.h"
#include "techniques/frame.h"
#include "tests/oracle/random.h"
#include "tests/oracle/texture.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <cstring>

using namespace gnomon;
using namespace gnomon::techniques;

namespace {

constexpr double kPi = 3.141592653589793;

/// The cut series without attenuation: 1/2 + integral from 0 to t of 2 sum cos(c_k u) du, whose integrand is
/// sin(2 pi M u) / sin(pi u). Simpson's rule.
double closed_form(int terms, double t) {
    const auto slope = [&](double u) { return u == 0 ? 2.0 * terms : std::sin(2 * kPi * terms * u) / std::sin(kPi * u); };
    const int steps = 2000;
    const double h = t / steps;
    double sum = slope(0) + slope(t);
    for (int i = 1; i < steps; ++i) sum += slope(i * h) * (i % 2 == 1 ? 4 : 2);
    return 0.5 + sum * h / 3;
}

/// The series over frequencies as fp32 has them.
double series_of(const FourierSeries& series, double d, double z) {
    double sum = 0.5;
    for (int k = 1; k <= series.terms; ++k)
        sum += static_cast<double>(series.weights[static_cast<std::size_t>(k - 1)]) *
               std::sin(static_cast<double>(static_cast<float>(kPi * (2 * k - 1))) * (z - d));
    return sum;
}

/// What the shaders make of one receiver and one occluder whose pairs `store` has been through.
template <class Real, class Store>
double product_form(const FourierSeries& series, const Real& d, const Real& z, const Store& store) {
    Real sum(0.5f);
    for (int k = 1; k <= series.terms; ++k) {
        const auto stored = store_pair(fourier_pair(k, z));
        sum = sum + series.term(k, fourier_pair(k, d), restore_pair(store(stored.sin), store(stored.cos)));
    }
    return static_cast<double>(lane(sum, 0));
}
constexpr auto kAsIs = [](const auto& x) { return x; };

double sum_of_weights(const FourierSeries& series) {
    double sum = 0;
    for (const float w : series.weights) sum += static_cast<double>(w);
    return sum;
}

/// What fp32 adds: each c_k times a depth rounds to a relative 2^-24, each sine and cosine errs by 2^-23, storing and restoring
/// rounds to 2^-24 twice and the products and sums once each.
double arithmetic_error(const FourierSeries& series) {
    double sum = 0;
    for (int k = 1; k <= series.terms; ++k)
        sum += static_cast<double>(series.weights[static_cast<std::size_t>(k - 1)]) * (2 * kPi * (2 * k - 1) + 16) * 0x1p-24;
    return sum + 2 * series.terms * 0x1p-24;
}

struct StoredFormat {
    Format format;
    double error;  // of a number in [0, 1]
};
/// Half a step; fp16 toward zero loses less than the step of [1/2, 1).
constexpr std::array kStored{StoredFormat{Format::Rgba8Unorm, 0.5 / 255}, StoredFormat{Format::Rgba16Unorm, 0.5 / 65535},
                             StoredFormat{Format::Rgba16Float, 0x1p-11}, StoredFormat{Format::Rgba32Float, 0}};

std::uint32_t code_of(Format format, float x) {
    switch (format_info(format).type) {
        case ComponentType::Unorm8: return unorm_from_float(x, 8);
        case ComponentType::Unorm16: return unorm_from_float(x, 16);
        case ComponentType::Float16: return half_from_float(x, Profile{}.float_narrowing).bits;
        default: return std::bit_cast<std::uint32_t>(x);
    }
}
double value_of(Format format, std::uint32_t code) {
    switch (format_info(format).type) {
        case ComponentType::Unorm8: return code / 255.0;
        case ComponentType::Unorm16: return code / 65535.0;
        case ComponentType::Float16: return oracle::half_value(code);
        default: return static_cast<double>(std::bit_cast<float>(code));
    }
}

}  // namespace

TEST_CASE("[Annen07] the cut series is the integral of its kernel", "[annen07]") {
    for (int terms = 1; terms <= kMaxFourierTerms; ++terms) {
        const FourierSeries series = fourier_series(terms, 0);
        for (int i = -40; i <= 40; ++i) {
            const double t = i / 41.0;
            // Weights are fp32: each errs by 2^-25 of at most 2/pi.
            if (!(std::fabs(series.at(t) - closed_form(terms, t)) <= terms * 0x1p-25 + 1e-9))
                FAIL(fmt::format("M {} t {}: {} is not {}", terms, t, series.at(t), closed_form(terms, t)));
        }
    }
}

TEST_CASE("[Annen07] more terms, less error away from the step", "[annen07]") {
    double before = 1;
    for (int terms = 1; terms <= kMaxFourierTerms; ++terms) {
        const FourierSeries series = fourier_series(terms, 0);
        double squares = 0;
        for (int i = 1; i < 1000; ++i) {
            const double t = i / 1000.0;
            // Abel's bound on what is cut off: sines of odd multiples add up to at most 1 / sin(pi t).
            const double bound = 2.0 / (kPi * (2 * terms + 1) * std::sin(kPi * t)) + 1e-6;
            for (const double side : {-1.0, 1.0}) {
                const double error = std::fabs(series.at(side * t) - (side > 0 ? 1 : 0));
                if (!(error <= bound)) FAIL(fmt::format("M {} t {}: error {}, bound {}", terms, side * t, error, bound));
                if (t > 0.1 && t < 0.9) squares += error * error;
            }
        }
        INFO("M " << terms << ": sum of squares " << squares << ", one term fewer " << before);
        if (terms > 1) CHECK(squares < before);
        before = squares;
        CHECK(series.at(0) == 0.5);
    }
}

TEST_CASE("[Annen07] ringing: 8.95 % of the step, less with attenuation", "[annen07]") {
    const auto overshoot = [](int terms, double attenuation) {
        const FourierSeries series = fourier_series(terms, attenuation);
        double most = 0;
        for (int i = 0; i <= 4000; ++i) most = std::max(most, series.at(i / 4000.0));
        return most - 1;
    };
    // The integral of the kernel up to its first zero at 1/(2M) nears Si(pi) / pi.
    const double limit = 0.0894899;
    double before = 1;
    for (const int terms : {1, 2, 4, 8, 16}) {
        const double plain = overshoot(terms, 0);
        INFO("M " << terms << " overshoots by " << plain << "; alpha 1: " << overshoot(terms, 1));
        CHECK(plain > limit);
        CHECK(plain < before);
        CHECK(std::fabs(plain - (fourier_series(terms, 0).at(0.5 / terms) - 1)) < 1e-6);
        for (const double attenuation : {0.25, 0.5, 1.0, 2.0})
            CHECK(overshoot(terms, attenuation) < overshoot(terms, attenuation / 2));
        before = plain;
    }
    CHECK(std::fabs(before - limit) < 3e-4);  // 8.97 % at M = 16
    CHECK(overshoot(16, 0.5) < 0.05);
    CHECK(overshoot(16, 1) < 0.015);
    CHECK(overshoot(16, 2) < 0);
}

TEST_CASE("[Annen07] the products of one depth each are the sine of the difference", "[annen07]") {
    oracle::Random random(1);
    double worst = 0;
    for (int i = 0; i < 4000; ++i) {
        const int terms = random.integer(1, kMaxFourierTerms);
        const float d = random.unit();
        const float z = random.unit();
        const FourierSeries series = fourier_series(terms, static_cast<double>(random.in(0, 2)));
        const double exact = series_of(series, static_cast<double>(d), static_cast<double>(z));
        REQUIRE(std::fabs(product_form(series, Double(d), Double(z), kAsIs) - exact) <= 1e-12);
        const double error = std::fabs(product_form(series, Float(d), Float(z), kAsIs) - exact);
        worst = std::max(worst, error / arithmetic_error(series));
        if (!(error <= arithmetic_error(series)))
            FAIL(fmt::format("case {}: M {} d {:a} z {:a}: error {}, allowed {}", i, terms, d, z, error,
                             arithmetic_error(series)));
    }
    INFO("worst share of the bound " << worst);
    CHECK(worst > 0.02);
}

TEST_CASE("[Annen07] what a format loses stays within sqrt(2) times its step times the weights", "[annen07]") {
    // Each of 2M numbers errs by e as stored, 2 e in [-1, 1]; the receiver's cosine and sine add up to at most sqrt(2).
    for (const auto& [format, error] : kStored) {
        double worst = 0;
        for (int i = 0; i < 4000; ++i) {
            oracle::Random random(static_cast<std::uint64_t>(i));
            const FourierSeries series =
                fourier_series(random.integer(1, kMaxFourierTerms), static_cast<double>(random.in(0, 2)));
            const float d = random.unit();
            const float z = random.unit();
            const auto store = [&, f = format](const Float& x) {
                return Float(static_cast<float>(value_of(f, code_of(f, lane(x, 0)))));
            };
            const double exact = series_of(series, static_cast<double>(d), static_cast<double>(z));
            const double lost = std::fabs(product_form(series, Float(d), Float(z), store) - exact);
            const double bound = std::sqrt(2.0) * 2 * error * sum_of_weights(series);
            if (!(lost <= bound + arithmetic_error(series)))
                FAIL(fmt::format("{} case {}: M {} d {:a} z {:a}: lost {}, bound {}", name_of(format), i, series.terms, d, z,
                                 lost, bound));
            worst = std::max(worst, lost);
        }
        const double most = std::sqrt(2.0) * 2 * error * sum_of_weights(fourier_series(kMaxFourierTerms, 0));
        INFO(name_of(format) << ": worst " << worst << ", most allowed " << most);
        CHECK(worst > 0);
        if (error > 0) CHECK(worst > 0.2 * most);
    }
}

TEST_CASE("[Annen07] the filtered map gives the mean of the series", "[annen07]") {
    // 8x8 random depths, 8 slices, averaged by the machine's own mips: three levels, each rounded to the format.
    constexpr int kSize = 8;
    const FourierSeries series = fourier_series(kMaxFourierTerms, 1);
    for (const auto& [format, error] : kStored) {
        Device device(Profile{}, 1);
        const TextureId map = device.create_texture(
            "map",
            {.format = format, .width = kSize, .height = kSize, .levels = 4, .kind = TextureKind::Array, .layers = kSize});
        oracle::Random random(7);
        std::vector<float> depths(kSize * kSize);
        for (float& z : depths) z = random.chance(2) ? random.in(0.1f, 0.3f) : random.in(0.5f, 0.9f);
        const std::size_t bytes_each = static_cast<std::size_t>(format_info(format).bits_per_component) / 8;
        for (int slice = 0; slice < kSize; ++slice) {
            std::vector<std::byte> level;
            for (const float z : depths) {
                const Vec4<Float> texel = store_two_pairs(1 + 2 * slice, Float(z));
                for (const Float& x : {texel.x, texel.y, texel.z, texel.w}) {
                    const std::uint32_t code = code_of(format, lane(x, 0));
                    const auto* first = reinterpret_cast<const std::byte*>(&code);
                    level.insert(level.end(), first, first + bytes_each);
                }
            }
            device.execute(WriteTexture{.id = map, .data = level, .layer = slice});
        }
        device.execute(GenerateMips{map});

        double worst = 0;
        for (int i = 0; i <= 100; ++i) {
            const double d = i / 100.0;
            double mean = 0;
            for (const float z : depths) mean += series_of(series, d, static_cast<double>(z)) / (kSize * kSize);
            Float sum(0.5f);
            for (int k = 1; k <= series.terms; ++k) {
                const auto texel = device.texture(map).level_bytes(3, (k - 1) / 2);
                const auto stored = [&](int component) {
                    std::uint32_t code = 0;
                    std::memcpy(&code, texel.data() + static_cast<std::size_t>(component) * bytes_each, bytes_each);
                    return Float(static_cast<float>(value_of(format, code)));
                };
                const int first = k % 2 == 1 ? 0 : 2;
                sum = sum + series.term(k, fourier_pair(k, Float(static_cast<float>(d))),
                                        restore_pair(stored(first), stored(first + 1)));
            }
            const double off = std::fabs(static_cast<double>(lane(sum, 0)) - mean);
            const double bound = std::sqrt(2.0) * 2 * (4 * error + 6 * 0x1p-24) * sum_of_weights(series);
            if (!(off <= bound + 2 * arithmetic_error(series)))
                FAIL(fmt::format("{} d {}: off by {}, bound {}", name_of(format), d, off, bound));
            worst = std::max(worst, off);
        }
        INFO(name_of(format) << ": worst " << worst);
        CHECK(worst > 0);
        if (format == Format::Rgba8Unorm) CHECK(worst > 1e-3);
        if (format == Format::Rgba32Float) CHECK(worst < 1e-5);
    }
}

TEST_CASE("csm: parameters become series and reconstruction", "[annen07]") {
    const auto setup = [](const ParameterTexts& texts) {
        return csm_setup(ParameterValues(kCsm.name, kCsm.parameters, texts));
    };
    for (const int terms : {1, 3, 8, 16}) {
        const CsmSetup plain = setup({{"terms", std::to_string(terms)}});
        CHECK(plain.series.terms == terms);
        CHECK(plain.reconstruction.scale == 2.0f);
        CHECK(plain.reconstruction.range == 1.0f - 0.5f / static_cast<float>(terms));
    }
    // A surface in its own light is just lit whatever the offset; the farthest receiver of the nearest occluder stays dark.
    for (const char* offset : {"0", "0.01", "0.03", "0.1"}) {
        const auto [series, r] = setup({{"offset", offset}, {"terms", "8"}});
        const double moved = static_cast<double>(r.range) * static_cast<double>(r.offset);
        CHECK(std::fabs(static_cast<double>(r.scale) * series.at(moved) - 1) < 1e-6);
        CHECK(static_cast<double>(r.scale) * series.at(moved - static_cast<double>(r.range)) < 0.15);
    }
    // Where depths take the whole half period, the far end of it is as near to a step as the near end.
    const auto [series, r] = setup({{"range", "1"}});
    CHECK(std::fabs(static_cast<double>(r.scale) * series.at(-1) - 1) < 1e-6);
    CHECK(setup({{"sharpness", "3"}}).reconstruction.scale == 6.0f);
}

TEST_CASE("csm: storage is two bytes per term in eight bits", "[annen07]") {
    for (const auto& [terms, bytes] : {std::pair{1, 4}, {2, 4}, {3, 8}, {4, 8}, {8, 16}, {9, 32}, {16, 32}})
        for (const auto& [format, factor] :
             {std::pair{Format::Rgba8Unorm, 1}, {Format::Rgba16Unorm, 2}, {Format::Rgba16Float, 2}, {Format::Rgba32Float, 4}}) {
            const TechniqueRequest request{.map_size = 16, .format = format, .set = {{"terms", std::to_string(terms)}}};
            CHECK(storage_per_texel(kCsm, resolve_settings(kCsm, request)) == bytes * factor);
        }
}

namespace {

/// Visibility of every pixel.
std::vector<float> visibility(std::string_view scene_name, std::string_view technique, const TechniqueRequest& request) {
    scenes::Scene scene;
    for (const auto& s : scenes::procedural_scenes())
        if (s.name == scene_name) scene = s.make();
    Device device(load_profile("d3d11"), 2);
    const Technique& t = find_technique(technique);
    Frame frame(device, scene, {.width = 160, .height = 120, .technique = t, .settings = resolve_settings(t, request)});
    PassTimer timer(device);
    frame.render(timer);
    const auto bytes = device.texture(frame.visibility()).level_bytes(0);
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

TechniqueRequest csm_request(int terms, Format format = Format::Rgba8Unorm) {
    return {.map_size = 128, .format = format, .filter = MapFilter::Bilinear, .set = {{"terms", std::to_string(terms)}}};
}

/// Depth of the receiver of `planes` less that of its occluder, whose height is that of its vertices.
double planes_distance() {
    const scenes::Scene scene = scenes::procedural_scenes()[0].make();
    REQUIRE(scene.name == "planes");
    Device device(Profile{}, 1);
    const Technique& t = find_technique("shadow-map");
    const Frame frame(device, scene,
                      {.width = 4, .height = 4, .technique = t, .settings = resolve_settings(t, {.map_size = 4})});
    return static_cast<double>(scene.meshes[1].vertices[0].position.y) /
           static_cast<double>(frame.light().zfar - frame.light().znear);
}

/// Root of the mean squared difference where there is a surface.
double rms_difference(const std::vector<float>& a, const std::vector<float>& b) {
    REQUIRE(a.size() == b.size());
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i] == Frame::kNoSurface) continue;
        const double difference = static_cast<double>(a[i]) - static_cast<double>(b[i]);
        sum += difference * difference;
        ++count;
    }
    REQUIRE(count > 1000);
    return std::sqrt(sum / count);
}

/// Mean visibility in `seen` where `truth` is dark.
double light_in_shadow(const std::vector<float>& seen, const std::vector<float>& truth) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (truth[i] != 0.0f) continue;
        sum += static_cast<double>(seen[i]);
        ++count;
    }
    REQUIRE(count > 200);
    return sum / count;
}

}  // namespace

TEST_CASE("[Annen07] on `planes` more terms come closer to percentage closer filtering", "[annen07]") {
    // Several ranges, since ringing makes a single distance better or worse by chance.
    const auto truth = visibility("planes", "pcf-hw", {.map_size = 128});
    double before = 1;
    for (const int terms : {1, 2, 4, 8, 16}) {
        double squares = 0;
        for (const char* range : {"0.2", "0.3", "0.4", "0.5", "0.6", "0.7"}) {
            TechniqueRequest request = csm_request(terms);
            request.set.insert(request.set.end(), {{"range", range}, {"attenuation", "0"}});
            const double difference = rms_difference(visibility("planes", "csm", request), truth);
            // The scale 2 times what Abel's bound leaves of the series and what 8 bits do.
            const double t = std::atof(range) * planes_distance();
            const double stored = std::sqrt(2.0) / 255 * sum_of_weights(fourier_series(terms, 0));
            const double bound = 2 * (2 / (kPi * (2 * terms + 1) * std::sin(kPi * t)) + stored);
            INFO("M " << terms << " range " << range << ": rms difference " << difference << ", bound " << bound);
            CHECK(difference > 0);
            CHECK(difference < bound);
            squares += difference * difference / 6;
        }
        INFO("M " << terms << ": rms difference " << std::sqrt(squares) << ", before " << before);
        CHECK(std::sqrt(squares) < before);
        before = std::sqrt(squares);
    }
    CHECK(before < 0.02);
}

TEST_CASE("csm: the shader's own bilinear filter is the texture unit's but for its weights", "[annen07]") {
    for (const int terms : {2, 16}) {
        TechniqueRequest request = csm_request(terms);
        const auto unit = visibility("planes", "csm", request);
        request.filter = MapFilter::ShaderBilinear;
        const auto shader = visibility("planes", "csm", request);
        const double difference = rms_difference(unit, shader);
        INFO("M " << terms << ": rms difference " << difference);
        CHECK(difference > 0);  // 8 bits of weight against 24
        CHECK(difference < 1e-3);
        request.filter = MapFilter::Nearest;
        CHECK(rms_difference(unit, visibility("planes", "csm", request)) > 10 * difference);
    }
}

TEST_CASE("[Lauritzen08] 4.5: light behind every occluder, one alone included", "[annen07]") {
    // `planes` has one occluder, for which Chebyshev's bound is exact wherever it is; a small range is an occluder close to the
    // receiver, as bias and scale of the depths would make it.
    const auto truth = visibility("planes", "pcf-hw", {.map_size = 128});
    const double vsm = light_in_shadow(visibility("planes", "vsm", {.map_size = 128, .filter = MapFilter::Bilinear}), truth);
    CHECK(vsm < 1e-4);
    for (const int terms : {2, 4, 8, 16}) {
        const FourierSeries series = fourier_series(terms, 0);
        for (const double share : {0.125, 0.25, 0.375}) {
            const auto range = static_cast<float>(share / (terms * planes_distance()));
            TechniqueRequest request = csm_request(terms);
            request.set.insert(request.set.end(), {{"range", fmt::format("{}", range)}, {"attenuation", "0"}});
            const double light = light_in_shadow(visibility("planes", "csm", request), truth);
            const double expected = std::max(0.0, 2 * series.at(-share / terms));
            INFO("M " << terms << ", " << share << "/M behind the occluder: light " << light << ", expected " << expected);
            CHECK(std::fabs(light - expected) < 2 * std::sqrt(2.0) / 255 * sum_of_weights(series));
            if (share == 0.125) CHECK(light > 0.5);
            if (share == 0.375) CHECK(light < 0.03);
        }
    }
}

TEST_CASE("csm: on `bench`, whose occluders are near their receivers, light in shadow falls with M", "[annen07]") {
    const auto truth = visibility("bench", "pcf-hw", {.map_size = 128});
    double before = 1;
    for (const int terms : {2, 4, 8, 16}) {
        const double light = light_in_shadow(visibility("bench", "csm", csm_request(terms)), truth);
        INFO("M " << terms << ": " << light);
        CHECK(light > 0.003);
        CHECK(light < 0.6 * before);
        before = light;
    }
}

TEST_CASE("csm: where depths take the whole half period, the nearest occluder casts no shadow on the farthest receiver",
          "[annen07]") {
    const auto truth = visibility("planes", "pcf-hw", {.map_size = 128});
    TechniqueRequest request = csm_request(4);
    const double clear = light_in_shadow(visibility("planes", "csm", request), truth);
    request.set.emplace_back("range", "1");
    const double whole = light_in_shadow(visibility("planes", "csm", request), truth);
    INFO("light in the shadow: " << clear << ", with range 1 " << whole);
    CHECK(clear < 0.05);
    CHECK(whole > 0.3);
}
