// The capture program gets back what made the samples: the fields of our own profiles, and what is known of the drivers here.
// With no device the device tests are left out, and the exit code 4 says so to CTest.
#include "tests/agree/capture.h"
#include "tests/agree/fit.h"
#include "tests/agree/made_texture.h"
#include "tests/agree/profile_source.h"
#include "tests/peer/device_tests.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdio>
#include <map>
#include <set>

namespace gnomon::agree {
namespace {

std::map<std::string, std::string> fields_of(const Profile& profile) {
    std::map<std::string, std::string> fields;
    for_each_field(profile, [&](std::string_view name, const auto& value) { fields[std::string(name)] = field_text(value); });
    return fields;
}

// What every profile's measurements must determine; other fields only where something depends on them.
const std::set<std::string> kAlways{"address_arithmetic",
                                    "texel_fraction_bits",
                                    "bilinear_form",
                                    "unorm_decode",
                                    "unorm_filter",
                                    "filters_float32",
                                    "lod_rule",
                                    "log2_model",
                                    "lod_fraction_bits",
                                    "mip_tie",
                                    "aniso_rule",
                                    "ellipse_transform",
                                    "aniso_clamps_to_top",
                                    "probe_placement",
                                    "arithmetic"};

std::set<std::string> determined(const Profile& profile) {
    std::set<std::string> fields = kAlways;
    const bool rounds = profile.texel_fraction_bits != kExactBits;
    if (rounds || profile.unorm_filter == UnormFilter::Llvmpipe) fields.insert("texel_rounding");
    if (rounds && profile.texel_rounding == FixedRounding::NearestEven) fields.insert("texel_carry");
    if (profile.lod_fraction_bits != kExactBits) fields.insert("lod_rounding");
    if (profile.filters_float32) fields.insert("flush_denormals");
    if (profile.probe_placement != ProbePlacement::Ewa) fields.insert({"probe_count", "aniso_limits"});
    return fields;
}

// Measures the profile; what is measured must be its own, and enough must be measured.
void check_recovered(const Profile& profile) {
    const FittedProfile fitted = fit_profile(measure_all(profile_source(profile)));
    const auto expected = fields_of(profile);
    const auto found = fields_of(fitted.profile);
    std::set<std::string> measured;
    for (const FieldEvidence& evidence : fitted.evidence) {
        if (evidence.basis == Basis::Measured) measured.insert(evidence.field);
        if (evidence.basis != Basis::Measured || expected.at(evidence.field) == found.at(evidence.field)) continue;
        FAIL_CHECK(fmt::format("{}: {} is {}, measured {}: {}", profile.name, evidence.field, expected.at(evidence.field),
                               found.at(evidence.field), evidence.text));
    }
    for (const FieldEvidence& evidence : fitted.evidence)
        if (!measured.contains(evidence.field) && determined(profile).contains(evidence.field))
            FAIL_CHECK(fmt::format("{}: {} is not determined: {}; {}", profile.name, evidence.field, evidence.text,
                                   profile_to_json(profile)));
}

Profile preset(std::string_view name) { return load_profile(std::string(name)); }

template <class E>
E any_of(Sequence& random, std::initializer_list<E> values) {
    return *(values.begin() + static_cast<std::size_t>(random.next() * static_cast<double>(values.size())));
}

// A profile that no preset is.
Profile random_profile(Sequence& random) {
    Profile p = preset("d3d11");
    p.flush_denormals = any_of(random, {false, true});
    p.texel_fraction_bits = any_of(random, {4, 5, 6, 7, 8, 8});
    p.texel_rounding = any_of(random, {FixedRounding::NearestEven, FixedRounding::Truncate});
    p.texel_carry = any_of(random, {TexelCarry::Texel, TexelCarry::Weight});
    p.bilinear_form =
        any_of(random, {BilinearForm::Lerp, BilinearForm::Products, BilinearForm::PlainLerp, BilinearForm::FusedLerp});
    p.unorm_decode = any_of(random, {UnormDecode::Divide, UnormDecode::Reciprocal, UnormDecode::Late});
    p.unorm_filter = any_of(random, {UnormFilter::Float, UnormFilter::Float, UnormFilter::Llvmpipe});
    p.lod_rule = any_of(random, {LodRule::Longest, LodRule::Box, LodRule::Area});
    p.log2_model = any_of(random, {Log2Model::Exact, Log2Model::Linear2, Log2Model::Linear4});
    p.lod_fraction_bits = any_of(random, {5, 6, 7, 8, kExactBits});
    p.lod_rounding = any_of(random, {FixedRounding::NearestEven, FixedRounding::Truncate});
    p.mip_tie = any_of(random, {MipTie::Up, MipTie::Down, MipTie::Even});
    p.aniso_rule = any_of(random, {AnisoRule::D3d11, AnisoRule::OpenGl, AnisoRule::Vulkan});
    p.ellipse_transform = any_of(random, {false, true});
    p.aniso_clamps_to_top = any_of(random, {false, true});
    p.probe_count = any_of(random, {ProbeCount::Ceil, ProbeCount::Round, ProbeCount::Steps});
    p.probe_placement = any_of(random, {ProbePlacement::Interior, ProbePlacement::Centred});
    p.aniso_limits = any_of(random, {AnisoLimits::Any, AnisoLimits::Steps});
    return p;
}

FittedProfile measured(const std::string& driver, Measurements& seen) {
    for (const peer::PeerDevice& device : peer::usable_devices()) {
        if (device.driver.find(driver) == std::string::npos) continue;
        SamplingPeer machine(device, {.validate = true});
        seen =
            measure_all([&](const Levels& texture, const SamplerState& sampler, Instruction instruction,
                            std::span<const Point> points) { return machine.sample(texture, sampler, instruction, points); });
        seen.device = device.name;
        for (const std::string& message : machine.validation_messages()) FAIL_CHECK(message);
        return fit_profile(seen);
    }
    return {};
}

// Every field that is measured is the preset's, but for those named.
void check_is_preset(const FittedProfile& fitted, std::string_view name, const std::set<std::string>& but) {
    const Profile known = preset(name);
    const auto expected = fields_of(known);
    const auto found = fields_of(fitted.profile);
    std::set<std::string> seen;
    for (const FieldEvidence& evidence : fitted.evidence) {
        if (evidence.basis != Basis::Measured) continue;
        seen.insert(evidence.field);
        INFO(evidence.field << ": " << evidence.text);
        if (!but.contains(evidence.field)) CHECK(found.at(evidence.field) == expected.at(evidence.field));
    }
    for (const std::string& field : determined(known)) {
        INFO(field << " is not determined");
        CHECK(seen.contains(field));
    }
}

}  // namespace

TEST_CASE("the measurements get our presets back", "[agree][probe]") {
    for (const char* name : {"d3d11", "d3d10", "g80", "nv40", "llvmpipe", "swiftshader"}) check_recovered(preset(name));
}

TEST_CASE("the measurements get profiles back that are no preset", "[agree][probe]") {
    Sequence random;
    for (int i = 0; i < 40; ++i) {
        Profile profile = random_profile(random);
        profile.name = fmt::format("profile {}", i);
        check_recovered(profile);
    }
}

TEST_CASE("steps and their ties", "[agree][probe]") {
    const auto table = [](auto&& rounded) {
        std::vector<float> values;
        for (int i = 0; i <= 4096; ++i) values.push_back(static_cast<float>(rounded(i / 64.0)) / 64);
        return step_table(values);
    };
    const auto rounding = [&](auto&& rounded) {
        const StepRule rule = step_rule(table(rounded));
        CHECK(rule.bits == 6);
        return rule.rounding;
    };
    CHECK(rounding([](double x) { return std::nearbyint(x); }) == StepRounding::NearestEven);
    CHECK(rounding([](double x) { return std::floor(x + 0.5); }) == StepRounding::NearestUp);
    CHECK(rounding([](double x) { return std::ceil(x - 0.5); }) == StepRounding::NearestDown);
    CHECK(rounding([](double x) { return std::floor(x); }) == StepRounding::Truncate);
    CHECK(step_rule(table([](double x) { return x; })).is_exact);
    // Neither: steps of unequal length.
    CHECK_FALSE(step_rule(table([](double x) { return std::floor(x * x / 64); })).bits.has_value());
}

TEST_CASE("a fitted profile is a profile file", "[agree][probe]") {
    Measurements seen = measure_all(profile_source(preset("g80")));
    seen.device = "Some GPU (1.2)";
    const FittedProfile fitted = fit_profile(seen);
    CHECK(fitted.profile.name == "Some GPU (1.2)");
    CHECK(profile_from_json(profile_to_json(fitted.profile), "test") == fitted.profile);
    CHECK(fitted.evidence.size() == fields_of(fitted.profile).size() - 2);
    for (const FieldEvidence& evidence : fitted.evidence) {
        CHECK_FALSE(evidence.text.empty());
        CHECK(evidence.text.find('\n') == std::string::npos);
    }
    CHECK(capture_text(seen).find("weights r32f: 257 values at 65537 positions; 0=0 129=0.00390625") != std::string::npos);
}

TEST_CASE("what a source refuses is not determined", "[agree][probe]") {
    const FittedProfile fitted = fit_profile(measure_all(
        [](const Levels&, const SamplerState&, Instruction, std::span<const Point>) -> std::vector<Sample> { fail("no"); }));
    for (const FieldEvidence& evidence : fitted.evidence) {
        INFO(evidence.field);
        CHECK((evidence.basis == Basis::Assumed || evidence.field == "filters_float32"));
    }
}

TEST_CASE("lavapipe's parameters", "[agree][probe][device]") {
    Measurements seen;
    const FittedProfile fitted = measured("llvmpipe", seen);
    if (fitted.evidence.empty()) return;
    // Compute shaders keep denormals, which the preset of its rasteriser flushes.
    check_is_preset(fitted, "llvmpipe", {"flush_denormals"});
    CHECK_FALSE(fitted.profile.flush_denormals);
    CHECK(seen.aniso.ratios.size() == 61);
    CHECK(seen.mips.clamps_after_bias);
    CHECK(seen.compare.is_strict);
}

TEST_CASE("SwiftShader's parameters", "[agree][probe][device]") {
    Measurements seen;
    const FittedProfile fitted = measured("SwiftShader", seen);
    if (fitted.evidence.empty()) return;
    check_is_preset(fitted, "swiftshader", {});
    CHECK_FALSE(seen.denormals.nearest_flushes);
    // Halves to even: 2 probes at a ratio of 2.5, 4 at 3.5.
    for (const ProbeLine& line : seen.aniso.ratios)
        if (line.ratio == 2.5f || line.ratio == 3.5f) CHECK(line.positions.size() == (line.ratio == 2.5f ? 2 : 4));
    CHECK(seen.mips.clamps_after_bias);
    CHECK(seen.compare.is_strict);
}

}  // namespace gnomon::agree
