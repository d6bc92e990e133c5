// gnomon_agree_sample: what a Vulkan driver returns at the points on standard input, as hexadecimal floats or as a time.
#include "sim/error.h"
#include "tests/agree/generated_texture.h"
#include "tests/agree/names.h"
#include "tests/agree/sampling.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace gnomon::agree {
namespace {

struct Options {
    std::string device;
    std::string format = "rg32f";
    std::string size = "8x8";
    int levels = 1;
    std::uint64_t seed = 1;
    std::string filter = "nearest";
    std::string mag;  // as filter where empty
    std::string mip = "base";
    std::string address = "wrap";
    std::string address_v;  // as address where empty
    std::string compare = "none";
    std::string instruction = "gradient";
    SamplerState sampler{};  // what the names above leave
    int threads = 0;
    int repeats = 0;
    bool quads = false;
    bool validate = false;
};

// All of `text`, or nothing: false where it is no whole number.
bool parse_int(std::string_view text, int& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

Levels chosen_texture(const Options& options) {
    int width = 0;
    int height = 0;
    const std::string_view size = options.size;
    const std::size_t x = std::min(size.find('x'), size.size());
    if (x == size.size() || !parse_int(size.substr(0, x), width) || !parse_int(size.substr(x + 1), height))
        fail("--size '{}'; expected something like 8x8", size);
    constexpr int kMaxSize = 16384;
    if (width > kMaxSize || height > kMaxSize) fail("--size {}; expected at most {}x{}", size, kMaxSize, kMaxSize);
    const auto format = enum_from_name<TexelFormat>(options.format, "--format");
    return random_levels(format, width, height, options.levels, options.seed);
}

SamplerState chosen_sampler(const Options& options) {
    SamplerState sampler = options.sampler;
    sampler.min = enum_from_name<Filter>(options.filter, "--filter");
    sampler.mag = options.mag.empty() ? sampler.min : enum_from_name<Filter>(options.mag, "--mag");
    sampler.mip = enum_from_name<Mip>(options.mip, "--mip");
    sampler.address_u = enum_from_name<Address>(options.address, "--address");
    sampler.address_v =
        options.address_v.empty() ? sampler.address_u : enum_from_name<Address>(options.address_v, "--address-v");
    sampler.compare = enum_from_name<Compare>(options.compare, "--compare");
    return sampler;
}

// The first usable device of that index, or with that in its name or its driver's.
peer::PeerDevice chosen_device(const std::string& wanted) {
    const std::vector<peer::PeerDevice> devices = peer::list_devices();
    int index = -1;
    const bool by_index = parse_int(wanted, index);
    for (const peer::PeerDevice& device : devices) {
        if (by_index && device.index == static_cast<std::uint32_t>(index)) return device;
        const bool is_named = device.name.find(wanted) != std::string::npos || device.driver.find(wanted) != std::string::npos;
        if (!by_index && is_named && device.unusable.empty()) return device;
    }
    fail("no usable Vulkan device among {} matches '{}'", devices.size(), wanted);
}

float parse_float(const std::string& word, int line_number) {
    char* end = nullptr;
    const float value = std::strtof(word.c_str(), &end);
    if (end != word.c_str() + word.size()) fail("standard input, line {}: '{}' is not a number", line_number, word);
    return value;
}

// Lines of `u v dudx dvdx dudy dvdy lod reference`; what is left out is 0. Empty lines and # comments are passed over.
std::vector<Point> read_points(std::istream& input) {
    std::vector<Point> points;
    std::string line;
    for (int line_number = 1; std::getline(input, line); ++line_number) {
        std::istringstream words(line);
        std::vector<float> numbers;
        for (std::string word; words >> word && word.front() != '#';) numbers.push_back(parse_float(word, line_number));
        if (numbers.empty()) continue;
        if (numbers.size() < 2 || numbers.size() > 8)
            fail("standard input, line {}: numbers of a point: {}; expected u v [dudx dvdx dudy dvdy [lod [reference]]]",
                 line_number, numbers.size());
        numbers.resize(8);
        points.push_back({.u = numbers[0],
                          .v = numbers[1],
                          .dudx = numbers[2],
                          .dvdx = numbers[3],
                          .dudy = numbers[4],
                          .dvdy = numbers[5],
                          .lod = numbers[6],
                          .reference = numbers[7]});
    }
    if (points.empty()) fail("standard input: no points");
    return points;
}

void print_timing(const SampleTiming& timing, std::size_t points) {
    const auto fastest_ms = [](const std::vector<double>& ns) { return *std::min_element(ns.begin(), ns.end()) * 1e-6; };
    fmt::print("{:.2f} ns per sample: the median of {} over {} points; sampling min {:.2f} ms, reading min {:.2f} ms\n",
               timing.ns_per_sample, timing.sampling_ns.size(), points, fastest_ms(timing.sampling_ns),
               fastest_ms(timing.reading_ns));
}

int run(const Options& options) {
    if (options.threads < 0) fail("--threads {}; expected at least one", options.threads);
    if (options.repeats < 0) fail("--time {}; expected at least one", options.repeats);
    const Levels texture = chosen_texture(options);
    const SamplerState sampler = chosen_sampler(options);
    const auto instruction = enum_from_name<Instruction>(options.instruction, "--instruction");
    std::vector<Point> points = read_points(std::cin);
    if (options.quads) points = as_quads(points);

    if (options.threads > 0) peer::limit_threads(options.threads);
    peer::expose_drivers();
    SamplingPeer machine(chosen_device(options.device), {.validate = options.validate});
    if (options.repeats > 0) {
        const SampleTiming timing = machine.time_samples(texture, sampler, instruction, points, options.repeats);
        fmt::print("# {}\n", machine.description().name);
        print_timing(timing, points.size());
    } else {
        const std::vector<Sample> samples = machine.sample(texture, sampler, instruction, points);
        fmt::print("# {}\n", machine.description().name);
        for (std::size_t i = 0; i < samples.size(); i += options.quads ? 4 : 1) {
            const Sample& s = samples[i];
            fmt::print("{:a} {:a} {:a} {:a}\n", s[0], s[1], s[2], s[3]);
        }
    }
    for (const std::string& message : machine.validation_messages()) fmt::print(stderr, "validation: {}\n", message);
    return 0;
}

}  // namespace
}  // namespace gnomon::agree

int main(int argc, char** argv) {
    using namespace gnomon;
    agree::Options options;
    CLI::App app{
        "Samples a random texture on other people's GPUs at points from standard input, one per line:\n"
        "u v [dudx dvdx dudy dvdy [lod [reference]]]"};
    app.add_option("--device", options.device, "a device's index, or part of its or its driver's name; the first without it");
    app.add_option("--format", options.format, names_of<agree::TexelFormat>());
    app.add_option("--size", options.size, "texels of level 0, as 8x8");
    app.add_option("--levels", options.levels, "levels of the texture");
    app.add_option("--seed", options.seed, "of the texels");
    app.add_option("--filter", options.filter, names_of<agree::Filter>());
    app.add_option("--mag", options.mag, "the filter for magnification, where it is another");
    app.add_option("--mip", options.mip, names_of<agree::Mip>());
    app.add_option("--address", options.address, names_of<agree::Address>());
    app.add_option("--address-v", options.address_v, "the addressing mode of v, where it is another");
    app.add_option("--border", options.sampler.border, "0: transparent black, 1: opaque black, 2: opaque white");
    app.add_option("--lod-bias", options.sampler.lod_bias, "added to the LOD");
    app.add_option("--min-lod", options.sampler.min_lod, "least LOD");
    app.add_option("--max-lod", options.sampler.max_lod, "greatest LOD");
    app.add_option("--aniso", options.sampler.max_anisotropy, "greatest anisotropy; 1: off");
    app.add_option("--compare", options.compare, names_of<agree::Compare>() + "; for d32f");
    app.add_option("--instruction", options.instruction, names_of<agree::Instruction>());
    app.add_option("--threads", options.threads, "threads of the software devices");
    app.add_option("--time", options.repeats, "print the time per sample instead, over so many repeats");
    app.add_flag("--quads", options.quads, "a quad of pixels for each point, as llvmpipe's anisotropy needs");
    app.add_flag("--validate", options.validate, "with the validation layer");
    try {
        app.parse(argc, argv);
        return agree::run(options);
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        fmt::print(stderr, "gnomon_agree_sample: {}\n", error.what());
    } catch (const Error& error) {
        fmt::print(stderr, "gnomon_agree_sample: {}\n", error.what());
    }
    return 2;
}
