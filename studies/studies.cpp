// The table of studies.
#include "studies/study.h"

namespace gnomon::studies {

namespace {

using techniques::MapFilter;
using techniques::ParameterTexts;
using techniques::TechniqueRequest;

constexpr int kMap = 512;

StudyCase in_group(std::string group, std::string label, std::string technique, TechniqueRequest request) {
    return {
        .group = std::move(group), .label = std::move(label), .technique = std::move(technique), .request = std::move(request)};
}

/// Figure 4.5 of the thesis and beyond: what a texel of 4, 8, 16 or 32 bytes buys.
Study equal_storage() {
    Study study{.name = "equal-storage",
                .summary = "convolution, layered, exponential and moment maps with as many bytes per texel",
                .source = "[Lauritzen08] 4.1.4, Figures 4.5 and 4.7",
                .scenes = {"bench", "windmill", "overlap"},
                .cases = {}};
    const auto add = [&](int bytes, std::string label, std::string technique, Format format, ParameterTexts set = {}) {
        study.cases.push_back(in_group(fmt::format("{} bytes", bytes), std::move(label), std::move(technique),
                                       {.map_size = kMap, .format = format, .set = std::move(set)}));
    };
    struct Row {
        int bytes;
        const char* technique;
        Format format;
    };
    constexpr std::array kRows{
        Row{4, "vsm", Format::Rg16Unorm},   Row{4, "esm", Format::R32Float},       Row{4, "evsm2", Format::Rg16Float},
        Row{8, "vsm", Format::Rg32Float},   Row{8, "evsm2", Format::Rg32Float},    Row{8, "evsm4", Format::Rgba16Float},
        Row{8, "msm", Format::Rgba16Unorm}, Row{16, "evsm4", Format::Rgba32Float}, Row{16, "msm", Format::Rgba32Float}};
    for (const int layers : {1, 2, 4, 8}) {
        const int bytes = 4 * layers;  // two components of 16 bits per layer, two of 8 bits per term
        for (const Row& row : kRows)
            if (row.bytes == bytes)
                add(bytes, fmt::format("{} {}", row.technique, name_of(row.format)), row.technique, row.format);
        add(bytes, fmt::format("csm {} terms", 2 * layers), "csm", Format::Rgba8Unorm,
            {{"terms", std::to_string(2 * layers)}, {"attenuation", layers <= 2 ? "0" : "0.5"}});  // as each leaks least
        const std::string count = std::to_string(layers);
        add(bytes, "lvsm " + count + " uniform", "lvsm", Format::Rgba16Unorm, {{"layers", count}});
        if (layers > 1)
            add(bytes, "lvsm " + count + " lloyd", "lvsm", Format::Rgba16Unorm, {{"layers", count}, {"placement", "lloyd"}});
    }
    return study;
}

/// What a format does to the moments of depth: no floor under the variance, so that nothing hides it.
Study formats() {
    Study study{.name = "formats",
                .summary = "moments in every format, without a least variance: where they cancel",
                .source = "[Donnelly06] 5.3",
                .scenes = {"car", "bench"},
                .cases = {}};
    for (const char* variance : {"0", "1e-6", "1e-5", "1e-4"})
        for (const Format format :
             {Format::Rg32Float, Format::Rgba16Float, Format::Rg16Float, Format::Rg16Unorm, Format::Rg8Unorm})
            for (const MapFilter filter : {MapFilter::Bilinear, MapFilter::Trilinear})
                study.cases.push_back(
                    in_group(fmt::format("least {}", variance), fmt::format("{} {}", name_of(format), name_of(filter)), "vsm",
                             {.map_size = kMap, .format = format, .filter = filter, .set = {{"min-variance", variance}}}));
    return study;
}

/// Exponents around what the format holds, with and without the clamp, where stores saturate and where they overflow.
Study exponents() {
    Study study{.name = "exponents",
                .summary = "exponential variance maps around the exponent that their format can hold",
                .source = "[Lauritzen08] 4.2",
                .scenes = {"bench"},
                .cases = {}};
    const auto add = [&](Format format, const std::string& c, const std::string& profile) {
        study.cases.push_back(
            {.group = std::string(name_of(format)),
             .label = fmt::format("c {} {}", c, profile),
             .technique = "evsm4",
             .request = {.map_size = kMap, .format = format, .set = {{"positive", c}, {"negative", c}, {"clamp", "off"}}},
             .profile = profile});
    };
    for (const char* profile : {"d3d11", "g80"}) {
        for (const char* c : {"2", "4", "5", "5.5", "5.54", "5.56", "5.6", "6", "8", "10"})
            add(Format::Rgba16Float, c, profile);
        for (const char* c : {"10", "20", "30", "40", "42", "44", "44.3", "44.4", "45", "50"})
            add(Format::Rgba32Float, c, profile);
    }
    return study;
}

/// Frames of relaxation, from uniform splits on.
Study relaxation() {
    Study study{.name = "relaxation",
                .summary = "layered maps while Lloyd's relaxation moves their splits",
                .source = "[Lauritzen08] 4.1.2, 4.1.3",
                .scenes = {"bench", "windmill", "overlap"},
                .cases = {}};
    const auto add = [&](const std::string& label, ParameterTexts set) {
        set.insert(set.begin(), {"layers", "4"});
        study.cases.push_back(in_group("4 layers", label, "lvsm", {.map_size = kMap, .set = std::move(set)}));
    };
    add("uniform", {});
    for (const char* frames : {"1", "2", "4", "8", "15", "30", "60", "120"})
        add(fmt::format("lloyd {} frames", frames), {{"placement", "lloyd"}, {"frames", frames}});
    add("lloyd 60, all splits", {{"placement", "lloyd"}, {"updates", "all"}});
    add("lloyd 60, latency 3", {{"placement", "lloyd"}, {"latency", "3"}});
    add("lloyd 60, no teleport", {{"placement", "lloyd"}, {"teleport", "off"}});
    return study;
}

/// Summed-area tables of growing maps, in every number format, with a floor too low to hide what sums lose.
Study tables() {
    Study study{.name = "tables",
                .summary = "summed-area tables by size and format: what long sums lose",
                .source = "[Lauritzen07] 8.5",
                .scenes = {"car"},
                .cases = {}};
    struct Kind {
        const char* label;
        Format format;
        const char* centre;
    };
    constexpr std::array kKinds{Kind{"rg32f", Format::Rg32Float, "none"}, Kind{"rg32f centred", Format::Rg32Float, "half"},
                                Kind{"rgba32f split", Format::Rgba32Float, "half"}, Kind{"rg32ui", Format::Rg32Uint, "none"}};
    for (const int size : {128, 256, 512, 1024, 2048, 4096})
        for (const Kind& kind : kKinds)
            study.cases.push_back(in_group(
                fmt::format("map {}", size), kind.label, "savsm",
                {.map_size = size, .format = kind.format, .set = {{"centre", kind.centre}, {"min-variance", "1e-6"}}}));
    return study;
}

/// The poster's four pictures with as many texels, then what splits depend on.
Study splits() {
    Study study{.name = "splits",
                .summary = "one map and four, nearest and filtered, with as many texels; then split schemes, counts and cures",
                .source = "[PSVSM]; [Zhang06], [Lauritzen10]",
                .scenes = {"city"},
                .cases = {}};
    // A variance of depth that hides shadows of things less than a metre above the ground is too large for a scene this deep.
    const auto add = [&](std::string group, std::string label, const std::string& technique, int cascades, ParameterTexts set) {
        TechniqueRequest request{.map_size = cascades == 0 ? 1024 : 512, .cascades = cascades, .set = std::move(set)};
        const bool filters = technique != "shadow-map" && technique != "pssm" && technique != "pcf";
        if (filters) request.anisotropy = 16;
        if (technique == "vsm" || technique == "psvsm") request.set.emplace_back("min-variance", "1e-7");
        study.cases.push_back(in_group(std::move(group), std::move(label), technique, std::move(request)));
    };
    const std::string filtered = "psvsm";
    add("poster", "shadow map 1024", "shadow-map", 0, {});
    add("poster", "variance 1024", "vsm", 0, {});
    add("poster", "parallel-split 4 x 512", "pssm", 4, {{"lambda", "0.8"}});
    add("poster", "parallel-split variance", filtered, 4, {{"lambda", "0.8"}, {"cure", "quad-min"}});
    for (const char* lambda : {"0", "0.25", "0.5", "0.75", "0.9", "0.95", "1"})
        add("lambda", fmt::format("lambda {}", lambda), filtered, 4, {{"lambda", lambda}, {"cure", "quad-min"}});
    for (int count = 1; count <= 8; ++count)
        add("count", fmt::format("{} x 512", count), filtered, count, {{"lambda", "0.8"}, {"cure", "quad-min"}});
    for (const char* placement : {"practical", "minmax", "histogram"})
        add("placement", placement, filtered, 4, {{"lambda", "0.8"}, {"cure", "quad-min"}, {"splits", placement}});
    for (const auto& cure : kEnumNames<techniques::SeamCure>)
        add("cure", std::string(cure.name), filtered, 4, {{"lambda", "0.8"}, {"cure", std::string(cure.name)}});
    for (const char* fade : {"0.1", "0.3"})
        add("fade", fmt::format("fade {}", fade), filtered, 4, {{"lambda", "0.8"}, {"cure", "quad-min"}, {"fade", fade}});
    add("snap", "snapped", filtered, 4, {{"lambda", "0.8"}, {"cure", "quad-min"}, {"snap", "on"}});
    for (const char* technique : {"esm", "evsm4", "lvsm", "msm", "csm", "savsm", "pcf", "pcf-footprint"})
        add("technique", technique, technique, 4, {{"lambda", "0.8"}, {"cure", "quad-min"}});
    return study;
}

}  // namespace

std::span<const Study> all_studies() {
    static const std::array studies{equal_storage(), formats(), exponents(), relaxation(), tables(), splits()};
    return studies;
}

}  // namespace gnomon::studies
