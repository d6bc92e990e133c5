// gnomon sample: the texture unit at given coordinates, for scripts and for other people's oracles.
#include "commands.h"

#include "number_lines.h"
#include "parse.h"
#include "sim/error.h"
#include "sim/parallel.h"
#include "studies/image_io.h"
#include "texunit/aniso.h"
#include "texunit/mipmap.h"
#include "texunit/record.h"
#include "texunit/upload.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <limits>

namespace gnomon::cli {

namespace {

using Json = nlohmann::ordered_json;

struct SampleOptions {
    std::string image;
    std::string checker;
    std::string ramp;
    std::string levels_from;
    std::string format = "rgba32f";
    bool mips = false;
    std::string filter = "bilinear";
    std::string max_aniso;
    std::string address = "clamp";
    std::string border = "0,0,0,0";
    std::string reduction = "average";
    std::string compare;
    std::string lod_bias = "0";
    std::string offset = "0,0";
    std::string profile = "d3d11";
    bool footprint = false;
};

/// Texel (x, y) of a checkerboard is white where x + y is even.
studies::ColorImage checker_image(int width, int height) {
    studies::ColorImage image{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float value = (x + y) % 2 == 0 ? 1.0f : 0.0f;
            image.values.emplace_back(value, value, value, 1.0f);
        }
    return image;
}

/// Red rises from 0 to 1 along x, green along y, blue over all texels in rows; alpha is 1.
studies::ColorImage ramp_image(int width, int height) {
    studies::ColorImage image{width, height, {}};
    const auto share = [](int i, int count) {
        return count > 1 ? static_cast<float>(i) / static_cast<float>(count - 1) : 0.0f;
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.values.emplace_back(share(x, width), share(y, height), share(y * width + x, width * height), 1.0f);
    return image;
}

/// 0.exr, 1.exr, ... as far as they go, each half the one before.
std::vector<studies::ColorImage> read_levels(const std::string& folder) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) fail("--levels-from {}: not a folder", folder);
    std::vector<studies::ColorImage> levels;
    for (int i = 0; i < kMaxLevels; ++i) {
        const fs::path path = fs::path(folder) / fmt::format("{}.exr", i);
        if (!fs::exists(path, ignored)) {
            // The chain ends here; a level after a gap is a mistake.
            for (int later = i + 1; later < kMaxLevels; ++later)
                if (fs::exists(fs::path(folder) / fmt::format("{}.exr", later), ignored))
                    fail("--levels-from {}: has {}.exr but no {}.exr", folder, later, i);
            break;
        }
        levels.push_back(studies::read_image(path));
        const studies::ColorImage& first = levels.front();
        const int width = level_size(first.width, i);
        const int height = level_size(first.height, i);
        if (i >= full_level_count(first.width, first.height))
            fail("{}: a texture of {}x{} texels has no level {}", path.string(), first.width, first.height, i);
        if (levels.back().width != width || levels.back().height != height)
            fail("{}: {}x{} pixels, expected {}x{}", path.string(), levels.back().width, levels.back().height, width, height);
    }
    if (levels.empty()) fail("--levels-from {}: no 0.exr in it", folder);
    return levels;
}

std::vector<studies::ColorImage> source_levels(const SampleOptions& options) {
    const int sources =
        !options.image.empty() + !options.checker.empty() + !options.ramp.empty() + !options.levels_from.empty();
    if (sources != 1) fail("sample: expected one of --image, --checker, --ramp and --levels-from");
    if (!options.levels_from.empty()) {
        if (options.mips) fail("--mips: --levels-from brings its own levels");
        return read_levels(options.levels_from);
    }
    if (!options.image.empty()) return {studies::read_image(options.image)};
    const bool checker = !options.checker.empty();
    const auto [width, height] = parse_size(checker ? options.checker : options.ramp, checker ? "--checker" : "--ramp");
    return {checker ? checker_image(width, height) : ramp_image(width, height)};
}

Texture make_texture(const SampleOptions& options, const Profile& profile) {
    const auto format = enum_from_name<Format>(options.format, "--format");
    for (const auto& [size, option] : {std::pair{options.checker, "--checker"}, std::pair{options.ramp, "--ramp"}}) {
        if (size.empty()) continue;
        const auto [width, height] = parse_size(size, option);  // before a picture of that size is made
        if (std::int64_t{width} * height * format_info(format).bytes_per_texel > std::numeric_limits<std::int32_t>::max())
            fail("{} {}: larger than 2 GiB in {}", option, size, options.format);
    }
    const std::vector<studies::ColorImage> levels = source_levels(options);
    const int width = levels.front().width;
    const int height = levels.front().height;
    const int count = options.mips ? full_level_count(width, height) : static_cast<int>(levels.size());
    Texture texture({.format = format, .width = width, .height = height, .levels = count});
    for (std::size_t i = 0; i < levels.size(); ++i)
        set_level_colors(texture, static_cast<int>(i), levels[i].values, profile.float_narrowing);
    if (options.mips) {
        Workers workers(1);
        generate_mips(texture, profile, workers);
    }
    return texture;
}

Sampler make_sampler(const SampleOptions& options) {
    Sampler sampler;
    if (options.filter == "nearest" || options.filter == "bilinear") {
        sampler.min = sampler.mag = options.filter == "nearest" ? TexelFilter::Nearest : TexelFilter::Linear;
        sampler.mip = options.filter == "nearest" ? MipFilter::Nearest : MipFilter::Base;
    } else if (options.filter == "trilinear" || options.filter == "aniso") {
        sampler.mip = MipFilter::Linear;
        if (options.filter == "aniso") sampler.max_anisotropy = 16;
    } else {
        fail("--filter {}: expected nearest, bilinear, trilinear or aniso", options.filter);
    }
    if (!options.max_aniso.empty()) {
        if (options.filter != "aniso") fail("--max-aniso {}: needs --filter aniso", options.max_aniso);
        sampler.max_anisotropy = parse_int(options.max_aniso, "--max-aniso", 1, 16);
    }
    sampler.address_u = sampler.address_v = enum_from_name<AddressMode>(options.address, "--address");
    sampler.reduction = enum_from_name<Reduction>(options.reduction, "--reduction");
    const std::vector<float> border = parse_numbers(options.border, "--border", 4);
    sampler.border = {border[0], border[1], border[2], border[3]};
    sampler.lod_bias = parse_number(options.lod_bias, "--lod-bias");
    if (sampler.lod_bias < -16.0f || sampler.lod_bias > 15.99f)
        fail("--lod-bias {}: expected a number from -16 to 15.99", options.lod_bias);
    if (!options.compare.empty()) sampler.compare = enum_from_name<CompareOp>(options.compare, "--compare");
    return sampler;
}

/// `u v`, `u v dudx dvdx dudy dvdy`, and in front of neither but after both the reference of a comparison.
SampleRequest request_of(const InputLine& line, bool compares) {
    const std::size_t given = line.words.size();
    const std::size_t extra = compares ? 1 : 0;
    if (given != 2 + extra && given != 6 + extra)
        fail(
            "stdin line {}: {} numbers, expected {}", line.number, given,
            compares ? "3 (u v reference) or 7 (u v dudx dvdx dudy dvdy reference)" : "2 (u v) or 6 (u v dudx dvdx dudy dvdy)");
    std::vector<double> numbers;
    for (const std::string& word : line.words) {
        const auto value = number_of(word);
        if (!value) fail("stdin line {}: '{}' is not a decimal or hexadecimal number", line.number, word);
        numbers.push_back(*value);
    }
    SampleRequest request{.coordinate = {numbers[0], numbers[1], 0.0}};
    if (given >= 6)
        request.gradient = SampleRequest::Gradient{.dx = {numbers[2], numbers[3], 0.0}, .dy = {numbers[4], numbers[5], 0.0}};
    if (compares) request.reference = numbers.back();
    return request;
}

/// A C hexadecimal float; which sign a NaN has is the processor's choice.
std::string text_of(double value) { return value == value ? fmt::format("{:a}", value) : "nan"; }

/// JSON has no infinities and no NaN: they go as text.
Json json_of(double value) {
    if (std::isfinite(value)) return value;
    return value != value ? "nan" : value > 0 ? "inf" : "-inf";
}
template <std::size_t kSize>
Json json_of(const std::array<double, kSize>& values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(json_of(value));
    return list;
}
Json json_of(const TapRecord& tap) {
    Json json{{"x", tap.x}, {"y", tap.y}};
    if (tap.border) json = Json{{"border", true}};
    json["raw"] = tap.raw;
    json["value"] = json_of(tap.value);
    json["weight"] = json_of(tap.weight);
    return json;
}
Json json_of(const SampleRecord& record) {
    Json probes = Json::array();
    for (const ProbeRecord& probe : record.probes) {
        Json levels = Json::array();
        for (const LevelRecord& level : probe.levels) {
            Json taps = Json::array();
            for (const TapRecord& tap : level.taps) taps.push_back(json_of(tap));
            levels.push_back({{"level", level.level},
                              {"weight", json_of(level.weight)},
                              {"taps", std::move(taps)},
                              {"sum", json_of(level.sum)}});
        }
        probes.push_back({{"u", json_of(probe.u)},
                          {"v", json_of(probe.v)},
                          {"weight", json_of(probe.weight)},
                          {"levels", std::move(levels)},
                          {"sum", json_of(probe.sum)}});
    }
    return {{"lod", json_of(record.lod)},      {"clamped_lod", json_of(record.clamped_lod)},
            {"magnified", record.magnified},   {"ratio", json_of(record.ratio)},
            {"probes", std::move(probes)},     {"scale", record.scale},
            {"result", json_of(record.result)}};
}

void sample(const SampleOptions& options) {
    const Profile profile = load_profile(options.profile);
    const Sampler sampler = make_sampler(options);
    const std::vector<float> offset = parse_numbers(options.offset, "--offset", 2);
    const auto is_offset = [](float x) { return x >= -8.0f && x <= 7.0f && x == std::floor(x); };
    if (!is_offset(offset[0]) || !is_offset(offset[1]))
        fail("--offset {}: expected two whole numbers from -8 to 7", options.offset);
    const glm::ivec2 texels(static_cast<int>(offset[0]), static_cast<int>(offset[1]));
    const Texture texture = make_texture(options, profile);
    if (sampler.filters() && !filters_format(texture.info(), profile))
        fail("--filter {}: profile {} does not filter {}; expected nearest", options.filter, profile.name, texture.info().name);

    // Every line first: bad input leaves nothing half written.
    std::vector<SampleRequest> requests;
    for (const InputLine& line : read_lines()) {
        requests.push_back(request_of(line, !options.compare.empty()));
        requests.back().offset = texels;
    }
    if (options.footprint) {
        for (const SampleRequest& request : requests)
            fmt::print("{}\n", json_of(record_sample(texture, sampler, profile, request)).dump());
        return;
    }
    constexpr std::size_t kBatch = 65536;
    for (std::size_t first = 0; first < requests.size(); first += kBatch) {
        const auto batch = std::span(requests).subspan(first, std::min(kBatch, requests.size() - first));
        std::string out;
        for (const SampleResult& result : sample_all(texture, sampler, profile, batch))
            out += fmt::format("{} {} {} {} {}\n", text_of(result.lod), text_of(result.color[0]), text_of(result.color[1]),
                               text_of(result.color[2]), text_of(result.color[3]));
        fmt::print("{}", out);
    }
}

}  // namespace

void add_sample(CLI::App& app) {
    CLI::App* command = app.add_subcommand("sample", "Sample a texture at the coordinates on stdin, to the bit");
    const auto options = std::make_shared<SampleOptions>();
    command->add_option("--image", options->image, "Texture from an image file; codes of 8-bit files are not linearised")
        ->type_name("FILE");
    command->add_option("--checker", options->checker, "Texture of 1 and 0 in turn, 1 at the top left")->type_name("WxH");
    command->add_option("--ramp", options->ramp, "Texture rising from 0 to 1: red along x, green along y, blue along both")
        ->type_name("WxH");
    command->add_option("--levels-from", options->levels_from, "Mip chain from 0.exr, 1.exr, ... in a folder")
        ->type_name("DIR");
    command->add_option("--format", options->format, "Texel format (gnomon list formats)")->capture_default_str();
    command->add_flag("--mips", options->mips, "Generate the whole mip chain by the profile's rule");
    command->add_option("--filter", options->filter, "nearest (and nearest mip), bilinear (finest level), trilinear or aniso")
        ->capture_default_str();
    command->add_option("--max-aniso", options->max_aniso, "Limit of anisotropy, 1 to 16 (16)")->type_name("N");
    command->add_option("--address", options->address, "Address mode: " + names_of<AddressMode>())->capture_default_str();
    command->add_option("--border", options->border, "Border colour r,g,b,a")->capture_default_str();
    command->add_option("--reduction", options->reduction, "What becomes of the texels: " + names_of<Reduction>())
        ->capture_default_str();
    command->add_option("--compare", options->compare, "Compare a reference with red: " + names_of<CompareOp>())
        ->type_name("OP");
    command->add_option("--lod-bias", options->lod_bias, "Added to the level of detail")->capture_default_str();
    command->add_option("--offset", options->offset, "Texel offset x,y of the instruction, -8 to 7")->capture_default_str();
    command->add_option("--profile", options->profile, "Hardware profile, preset or JSON file")->capture_default_str();
    command->add_flag("--footprint", options->footprint, "Print every probe, level, tap and weight, one JSON object per line");
    command->footer(
        "Reads lines `u v` (level of detail 0) or `u v dudx dvdx dudy dvdy` (per pixel, normalised coordinates), decimal or\n"
        "C hexadecimal, with --compare followed by the reference; '#' starts a comment. Prints `lod r g b a` per line as C\n"
        "hexadecimal floats, the level of detail before bias and clamp.\n"
        "  echo '0.3 0.6' | gnomon sample --ramp 4x4 --format rg16f --profile d3d11");
    command->callback([options] { sample(*options); });
}

}  // namespace gnomon::cli
