// gnomon_probe: a profile of the GPU in this machine, from measurements through Vulkan.
#include "sim/error.h"
#include "tests/agree/capture.h"
#include "tests/agree/fit.h"
#include "tests/agree/names.h"
#include "tests/agree/profile_source.h"
#include "tests/agree/sampling.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace gnomon::agree {
namespace {

constexpr int kNoDriver = 4;

struct Options {
    std::string device;
    std::string profile;
    std::string out;
    std::string record;
    bool list = false;
};

// The first usable device of that index, or with that in its name or its driver's.
peer::PeerDevice chosen_device(const std::vector<peer::PeerDevice>& devices, const std::string& wanted) {
    std::uint32_t index = 0;
    const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
    const bool by_index = !wanted.empty() && error == std::errc() && end == wanted.data() + wanted.size();
    for (const peer::PeerDevice& device : devices) {
        if (by_index && device.index == index) return device;
        const bool is_named = device.name.find(wanted) != std::string::npos || device.driver.find(wanted) != std::string::npos;
        if (!by_index && is_named && device.unusable.empty()) return device;
    }
    fail("--device '{}': no usable Vulkan device among {} matches", wanted, devices.size());
}

void write_file(const std::string& path, const std::string& text) {
    std::ofstream file(path);
    file << text;
    file.close();
    if (!file) fail("{}: cannot be written", path);
}

std::string_view basis_text(Basis basis) {
    switch (basis) {
        case Basis::Measured: return "measured";
        case Basis::Reported: return "reported";
        case Basis::Assumed: return "not determined";
    }
    return "";
}

// Largest distance of a texel's boundary from its place, texels, for sizes that are powers of two or not.
double largest_offset(const BoundaryMeasurement& measured, bool power_of_two) {
    double largest = 0;
    for (const TexelBoundary& boundary : measured.boundaries)
        if (((boundary.size & (boundary.size - 1)) == 0) == power_of_two)
            largest = std::abs(boundary.offset_texels) > std::abs(largest) ? boundary.offset_texels : largest;
    return largest;
}

// What no field of a profile says.
void print_rest(const Measurements& seen) {
    fmt::print("\n");
    for (const BoundaryMeasurement& measured : seen.boundaries)
        fmt::print("nearest texels of {} begin within {:+.6f} texels of their place, of other sizes than 2^n {:+.6f}{}\n",
                   name_of(measured.format), largest_offset(measured, true), largest_offset(measured, false), measured.refused);
    fmt::print("limits of the level of detail apply {}\n",
               seen.mips.clamps_after_bias ? "after the bias" : "otherwise than after the bias");
    const StepRule compared = step_rule(seen.compare.ramp);
    fmt::print("comparisons of d32f {} to the ulp; filtered they give {} values, {}{}\n",
               seen.compare.is_strict ? "are exact" : "are not exact", seen.compare.ramp.distinct,
               compared.is_exact ? "unrounded"
               : compared.bits   ? fmt::format("{} bits", *compared.bits)
                                 : "by no rule",
               seen.compare.ramp.refused);
    for (const ProbeLine& line : seen.aniso.beyond)
        fmt::print("at a ratio of {:g} {}\n", line.ratio,
                   line.is_smooth ? "there are no separate probes" : fmt::format("there are {} probes", line.positions.size()));
    if (!seen.aniso.refused.empty()) fmt::print("anisotropy: {}\n", seen.aniso.refused);
}

// How far the profile's own samples have the numbers that were measured.
void print_prediction(const Measurements& seen, const Profile& profile) {
    const Measurements own = measure_all(profile_source(profile));
    int same = 0;
    int all = 0;
    const auto count = [&](bool is_same) { same += is_same, ++all; };
    for (std::size_t i = 0; i < seen.weights.size(); ++i) count(seen.weights[i].ramp == own.weights[i].ramp);
    for (std::size_t i = 0; i < seen.boundaries.size(); ++i)
        for (std::size_t k = 0; k < seen.boundaries[i].boundaries.size() && k < own.boundaries[i].boundaries.size(); ++k)
            count(seen.boundaries[i].boundaries[k].coordinate == own.boundaries[i].boundaries[k].coordinate);
    count(seen.mips.ramp == own.mips.ramp);
    for (std::size_t i = 0; i < seen.lod.isotropic.size(); ++i) count(seen.lod.isotropic[i].lod == own.lod.isotropic[i].lod);
    for (std::size_t i = 0; i < seen.lod.oblique.size(); ++i) count(seen.lod.oblique[i].lod == own.lod.oblique[i].lod);
    for (std::size_t i = 0; i < seen.aniso.straight.size(); ++i) count(seen.aniso.straight[i].lod == own.aniso.straight[i].lod);
    for (std::size_t i = 0; i < seen.aniso.oblique.size(); ++i) count(seen.aniso.oblique[i].lod == own.aniso.oblique[i].lod);
    fmt::print("\nThe profile gives {} of {} tables, boundaries and levels to the bit.\n", same, all);
}

int run(const Options& options) {
    Measurements seen;
    std::string driver = "Gnomon";
    if (!options.profile.empty()) {
        const Profile profile = load_profile(options.profile);
        seen = measure_all(profile_source(profile));
        seen.device = profile.name + " (measured)";
    } else {
        peer::expose_drivers();
        const std::vector<peer::PeerDevice> devices = peer::list_devices();
        if (devices.empty()) {
            fmt::print(stderr, "gnomon_probe: this machine has no Vulkan driver\n");
            return kNoDriver;
        }
        if (options.list) {
            for (const peer::PeerDevice& device : devices)
                fmt::print("{}: {} ({}, {}){}{}\n", device.index, device.name, device.driver, device.driver_info,
                           device.unusable.empty() ? "" : "; unusable: ", device.unusable);
            return 0;
        }
        const peer::PeerDevice device = chosen_device(devices, options.device);
        SamplingPeer machine(device);
        seen =
            measure_all([&](const Levels& texture, const SamplerState& sampler, Instruction instruction,
                            std::span<const Point> points) { return machine.sample(texture, sampler, instruction, points); });
        seen.device = device.name;
        driver = fmt::format("{}, {}, Vulkan {}", device.driver, device.driver_info, device.api_version);
        seen.reported_subpixel_bits = static_cast<int>(device.limits.sub_pixel_bits);
    }

    const FittedProfile fitted = fit_profile(seen);
    fmt::print("{}\n\n", seen.device);
    std::size_t field = 0;
    for_each_field(fitted.profile, [&](std::string_view name, const auto& value) {
        if (name == "name" || name == "summary") return;
        const FieldEvidence& evidence = fitted.evidence[field++];
        fmt::print("{:<21} {:<12} {:<15} {}\n", name, field_text(value), basis_text(evidence.basis), evidence.text);
    });
    print_rest(seen);
    print_prediction(seen, fitted.profile);
    if (!options.out.empty()) write_file(options.out, profile_to_json(fitted.profile) + '\n');
    if (!options.record.empty()) write_file(options.record, fmt::format("driver: {}\n", driver) + capture_text(seen));
    return 0;
}

}  // namespace
}  // namespace gnomon::agree

int main(int argc, char** argv) {
    using namespace gnomon;
    agree::Options options;
    CLI::App app{"Measures the texture unit of a Vulkan device and writes its profile."};
    auto* device = app.add_option("--device", options.device,
                                  "a device's index, or part of its or its driver's name; the first"
                                  " without it");
    app.add_option("--profile", options.profile, "measure this profile of ours, a preset or a file, instead of a device")
        ->excludes(device);
    app.add_option("--out", options.out, "the profile, as JSON");
    app.add_option("--record", options.record, "the measurements themselves, as text");
    app.add_flag("--list", options.list, "list the devices");
    try {
        app.parse(argc, argv);
        return agree::run(options);
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        fmt::print(stderr, "gnomon_probe: {}\n", error.what());
    } catch (const Error& error) {
        fmt::print(stderr, "gnomon_probe: {}\n", error.what());
    }
    return 2;
}
