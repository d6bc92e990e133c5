// gnomon coverage: the rasteriser on given triangles, for scripts and for other people's oracles.
#include "commands.h"

#include "number_lines.h"
#include "parse.h"
#include "pipeline/coverage_query.h"
#include "sim/error.h"
#include "texunit/texture.h"

#include <bit>
#include <cstdio>
#include <iterator>

namespace gnomon::cli {

namespace {

struct CoverageOptions {
    std::string size;
    std::string samples = "1";
    std::string profile = "d3d11";
};

std::array<glm::vec2, 3> triangle_of(const InputLine& line) {
    if (line.words.size() != 6)
        fail("stdin line {}: {} numbers, expected 6 (x0 y0 x1 y1 x2 y2)", line.number, line.words.size());
    std::array<float, 6> numbers;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto value = float_of(line.words[i]);
        if (!value) fail("stdin line {}: '{}' is not a decimal or hexadecimal number", line.number, line.words[i]);
        if (!(*value >= -kMaxPosition && *value <= kMaxPosition))
            fail("stdin line {}: {}: expected positions from -{} to {} pixels", line.number, line.words[i], kMaxPosition,
                 kMaxPosition);
        numbers[i] = *value;
    }
    return {glm::vec2{numbers[0], numbers[1]}, glm::vec2{numbers[2], numbers[3]}, glm::vec2{numbers[4], numbers[5]}};
}

void coverage(const CoverageOptions& options) {
    const Profile profile = load_profile(options.profile);
    const auto [width, height] = parse_size(options.size, "--size");
    const int samples = parse_int(options.samples, "--samples", 1, kMaxSamples);
    if (!std::has_single_bit(static_cast<unsigned>(samples))) fail("--samples {}: expected 1, 2, 4, 8 or 16", samples);
    if (samples > profile.max_samples)
        fail("--samples {}: profile {} has at most {}", samples, profile.name, profile.max_samples);

    // Every line first: bad input leaves nothing half written.
    std::vector<std::array<glm::vec2, 3>> triangles;
    for (const InputLine& line : read_lines()) triangles.push_back(triangle_of(line));
    std::string out;
    const auto flush_from = [&](std::size_t size) {
        if (out.size() < size) return;
        fmt::print("{}", out);
        out.clear();
    };
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        visit_covered_pixels(triangles[i], {width, height, samples}, profile, [&](std::span<const CoveredPixel> pixels) {
            for (const CoveredPixel& pixel : pixels)
                fmt::format_to(std::back_inserter(out), "{} {} {} {:x}\n", i, pixel.x, pixel.y, pixel.mask);
            flush_from(1u << 20);
        });
    }
    flush_from(0);
}

}  // namespace

void add_coverage(CLI::App& app) {
    CLI::App* command = app.add_subcommand("coverage", "Samples that the triangles on stdin cover, to the bit");
    const auto options = std::make_shared<CoverageOptions>();
    command->add_option("--size", options->size, "Target in pixels")->type_name("WxH")->required();
    command->add_option("--samples", options->samples, "Samples per pixel: 1, 2, 4, 8 or 16")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--profile", options->profile, "Hardware profile, preset or JSON file")->capture_default_str();
    command->footer(
        "Reads lines `x0 y0 x1 y1 x2 y2`, pixels with y down, decimal or C hexadecimal; '#' starts a comment. Prints\n"
        "`triangle x y mask` per covered pixel: triangles from 0, the mask in hexadecimal with bit s for sample s.\n"
        "Positions are snapped to the profile's grid; llvmpipe and swiftshader clip and transform them as they do in a draw.\n"
        "  echo '1 1 9 1 1 9' | gnomon coverage --size 16x16 --samples 4");
    command->callback([options] { coverage(*options); });
}

}  // namespace gnomon::cli
