// Filter charts as one HTML page: inline style, no scripts, relative links.
#include "studies/filter_charts.h"

#include <algorithm>
#include <vector>

namespace gnomon::studies {

namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --bg: #f6f6f4; --fg: #1d1f21; --dim: #6a6d70; }
@media (prefers-color-scheme: dark) { :root { --bg: #17191b; --fg: #e6e6e3; --dim: #9a9da0; } }
body { margin: 0; padding: 1.5rem 2rem 3rem; background: var(--bg); color: var(--fg);
       font: 14px/1.45 system-ui, -apple-system, "Segoe UI", Roboto, sans-serif; }
h1 { font-size: 1.5rem; margin: 0 0 .25rem; }
h2 { font-size: 1.1rem; margin: 2rem 0 .6rem; }
p { margin: .25rem 0; color: var(--dim); max-width: 72em; }
table { border-collapse: collapse; }
th { font-weight: 600; padding: .2rem .6rem; text-align: left; }
td { padding: .2rem; }
td img { display: block; width: 256px; image-rendering: auto; }
td img.small { display: inline-block; width: 126px; }
i { display: inline-block; width: 1.4em; height: 1em; vertical-align: -.15em; margin: 0 .3em 0 .8em; border: 1px solid #8888; }
)";

std::string swatch(const Rgb& color, std::string_view text) {
    return fmt::format("<i style=\"background:rgb({},{},{})\"></i>{}", color[0], color[1], color[2], text);
}

std::string legends(bool any_elliptical) {
    std::string html = "<p>Level of detail (left), after clamp and fixed point: " + swatch(kMagnified, "magnified");
    for (std::size_t level = 0; level < kLevelColors.size(); ++level)
        html += swatch(kLevelColors[level], std::to_string(level));
    html += "; the tunnel's levels have the same colours.</p>\n<p>Probes (right):";
    for (int step = 0; step < kAmountSteps; ++step) html += swatch(amount_color(step), std::to_string(step + 1));
    html += "</p>\n";
    if (!any_elliptical) return html;
    html += "<p>Texels (right) where the filter is elliptical, at most:";
    for (int step = 0; step < kAmountSteps - 1; ++step) html += swatch(amount_color(step), std::to_string(texel_limit(step)));
    return html + swatch(amount_color(kAmountSteps - 1), "more") + "</p>\n";
}

std::string cell(const ChartEntry& entry) {
    const auto image = [&](std::string_view suffix, std::string_view style) {
        const std::string file = chart_file(entry, suffix);
        return fmt::format("<a href=\"{0}\"><img{1} loading=\"lazy\" src=\"{0}\" alt=\"{0}\"></a>", file, style);
    };
    return "<td>" + image(kPictureSuffix, "") + image(kLodSuffix, " class=\"small\"") +
           image(kProbesSuffix, " class=\"small\"") + "</td>";
}

/// The values of one member, in the order of their first entry.
std::vector<std::string> values_of(std::span<const ChartEntry> entries, std::string ChartEntry::* member) {
    std::vector<std::string> values;
    for (const ChartEntry& entry : entries)
        if (std::ranges::find(values, entry.*member) == values.end()) values.push_back(entry.*member);
    return values;
}

std::string scene_table(std::span<const ChartEntry> entries, const std::string& scene) {
    const std::vector<std::string> profiles = values_of(entries, &ChartEntry::profile);
    std::string html = fmt::format("<h2>{}</h2>\n<table>\n<tr><th></th>", scene);
    for (const std::string& profile : profiles) html += fmt::format("<th>{}</th>", profile);
    html += "</tr>\n";
    for (const std::string& filter : values_of(entries, &ChartEntry::filter)) {
        html += fmt::format("<tr><th>{}</th>", filter);
        for (const std::string& profile : profiles)
            for (const ChartEntry& entry : entries)
                if (entry.scene == scene && entry.filter == filter && entry.profile == profile) html += cell(entry);
        html += "</tr>\n";
    }
    return html + "</table>\n";
}

}  // namespace

std::string chart_file(const ChartEntry& entry, std::string_view suffix) {
    return fmt::format("{}_{}_{}{}.png", entry.scene, entry.profile, entry.filter, suffix);
}

std::string charts_html(std::span<const ChartEntry> entries, std::string_view note) {
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>Gnomon filter charts</title>\n"
        "<style>{}</style>\n</head>\n<body>\n<h1>Gnomon filter charts</h1>\n<p>{}</p>\n",
        kStyle, note);
    html += legends(std::ranges::any_of(entries, &ChartEntry::elliptical));
    for (const std::string& scene : values_of(entries, &ChartEntry::scene)) html += scene_table(entries, scene);
    return html + "</body>\n</html>\n";
}

}  // namespace gnomon::studies
