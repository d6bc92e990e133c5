// The tables that `gnomon render` prints.
#include "studies/configuration.h"
#include "studies/report.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

namespace gnomon::studies {

namespace {

/// A row per name, a column per pass; rows of zeros are left out, and with them a table without rows.
void append_table(std::string& text, std::string_view title, const std::vector<PassResult>& passes,
                  const std::vector<std::pair<std::string, std::vector<std::uint64_t>>>& rows) {
    const auto is_shown = [](const auto& row) {
        return std::ranges::any_of(row.second, [](auto value) { return value != 0; });
    };
    if (std::ranges::none_of(rows, is_shown)) return;
    std::size_t first = title.size();
    for (const auto& row : rows)
        if (is_shown(row)) first = std::max(first, row.first.size());
    const auto width = [](const PassResult& pass) { return std::max<std::size_t>(14, pass.name.size() + 2); };

    auto out = std::back_inserter(text);
    if (!text.empty()) text += '\n';
    fmt::format_to(out, "{:<{}}", title, first);
    for (const PassResult& pass : passes) fmt::format_to(out, "{:>{}}", pass.name, width(pass));
    text += '\n';
    for (const auto& [name, values] : rows) {
        if (std::ranges::none_of(values, [](auto value) { return value != 0; })) continue;
        fmt::format_to(out, "{:<{}}", name, first);
        for (std::size_t i = 0; i < passes.size(); ++i) fmt::format_to(out, "{:>{}}", grouped(values[i]), width(passes[i]));
        text += '\n';
    }
}

}  // namespace

std::string report_text(const RenderResult& result) {
    const RenderRequest& request = result.request;
    std::string text;
    auto out = std::back_inserter(text);
    fmt::format_to(out, "scene       {}{}, {} triangles\n", request.scene,
                   request.file_options.ground ? " on a ground plane" : "", grouped(result.scene.triangles));
    fmt::format_to(out, "technique   {}\n", settings_text(request.technique, result.settings));
    fmt::format_to(out, "image       {}x{}, profile {}, {} thread{}\n", request.width, request.height, result.profile.name,
                   result.host.threads, result.host.threads == 1 ? "" : "s");
    if (result.metrics) {
        const Metrics& m = *result.metrics;
        fmt::format_to(out, "reference   {}, {} pixels judged: {} fully shadowed, {} fully lit\n", name_of(request.truth),
                       grouped(m.pixels), grouped(m.shadowed_pixels), grouped(m.lit_pixels));
        fmt::format_to(out, "metrics     rmse {:.6f}   mae {:.6f}   p99 {:.6f}   leak {:.6f}   acne {:.6f}\n", m.rmse, m.mae,
                       m.p99, m.leak, m.acne);
        if (m.not_finite > 0) fmt::format_to(out, "            {} pixels are NaN or infinite\n", grouped(m.not_finite));
    }
    const MapStatistics& map = result.map;
    fmt::format_to(out, "map         {:g} bytes per texel\n", result.bytes_per_texel);
    if (map.saturated + map.infinite + map.nan > 0)
        fmt::format_to(out, "            of {} texels {} are saturated, {} infinite, {} not a number\n", grouped(map.texels),
                       grouped(map.saturated), grouped(map.infinite), grouped(map.nan));
    fmt::format_to(out, "timings ms ");
    for (const PassResult& pass : result.passes) fmt::format_to(out, " {} {:.2f}  ", pass.name, pass.milliseconds);
    fmt::format_to(out, " frame {:.2f}\n", result.frame_ms);
    fmt::format_to(
        out, "hashes      visibility {}\n            depth      {}\n            color      {}\n            map        {}\n",
        result.hashes.visibility, result.hashes.depth, result.hashes.color, result.hashes.map);
    return text;
}

std::string counters_text(const RenderResult& result) {
    std::vector<std::pair<std::string, std::vector<std::uint64_t>>> counters;
    std::apply(
        [&](const auto&... field) {
            const auto add = [&](const auto& one) {
                auto& values = counters.emplace_back(one.name, std::vector<std::uint64_t>{}).second;
                for (const PassResult& pass : result.passes) values.push_back(pass.counters.*one.member);
            };
            (add(field), ...);
        },
        Counters::fields());

    // Resources in the order in which passes first touch them.
    std::vector<std::pair<std::string, std::vector<std::uint64_t>>> read;
    std::vector<std::pair<std::string, std::vector<std::uint64_t>>> written;
    for (std::size_t pass = 0; pass < result.passes.size(); ++pass) {
        for (const ResourceTraffic& resource : result.passes[pass].traffic) {
            auto at = std::ranges::find(read, resource.label, [](const auto& row) { return row.first; });
            if (at == read.end()) {
                const std::vector<std::uint64_t> zeros(result.passes.size());
                written.emplace_back(resource.label, zeros);
                at = read.insert(read.end(), {resource.label, zeros});
            }
            at->second[pass] = resource.bytes.read;
            written[static_cast<std::size_t>(at - read.begin())].second[pass] = resource.bytes.written;
        }
    }

    std::string text;
    append_table(text, "counters", result.passes, counters);
    append_table(text, "bytes read", result.passes, read);
    append_table(text, "bytes written", result.passes, written);
    return text;
}

std::string comparison_text(std::span<const RenderResult> results) {
    std::string text = fmt::format("{:<16}{:>9}{:>9}{:>9}{:>9}{:>9}{:>10}  {}\n", "technique", "rmse", "mae", "p99", "leak",
                                   "acne", "frame ms", "visibility");
    auto out = std::back_inserter(text);
    for (const RenderResult& result : results) {
        fmt::format_to(out, "{:<16}", result.request.technique);
        if (result.metrics) {
            const Metrics& m = *result.metrics;
            fmt::format_to(out, "{:>9.5f}{:>9.5f}{:>9.5f}{:>9.5f}{:>9.5f}", m.rmse, m.mae, m.p99, m.leak, m.acne);
        } else {
            fmt::format_to(out, "{:>9}{:>9}{:>9}{:>9}{:>9}", "-", "-", "-", "-", "-");
        }
        fmt::format_to(out, "{:>10.2f}  {}\n", result.frame_ms, result.hashes.visibility);
    }
    return text;
}

}  // namespace gnomon::studies
