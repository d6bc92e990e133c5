// The contact sheet as one HTML page: inline style, no scripts, relative links.
#include "studies/contact_sheet.h"
#include "studies/false_color.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace gnomon::studies {

namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --bg: #f6f6f4; --fg: #1d1f21; --dim: #6a6d70; --card: #ffffff; --line: #d9d9d4; }
@media (prefers-color-scheme: dark) {
  :root { --bg: #17191b; --fg: #e6e6e3; --dim: #9a9da0; --card: #202325; --line: #34383b; }
}
body { margin: 0; padding: 1.5rem 2rem 3rem; background: var(--bg); color: var(--fg);
       font: 14px/1.45 system-ui, -apple-system, "Segoe UI", Roboto, sans-serif; }
h1 { font-size: 1.5rem; font-weight: 650; margin: 0 0 .25rem; }
h2 { font-size: 1.1rem; font-weight: 650; margin: 2rem 0 .6rem; }
h2 small { font-weight: 400; color: var(--dim); margin-left: .6em; }
p { margin: .25rem 0; color: var(--dim); max-width: 72em; }
.row { display: grid; grid-auto-flow: column; grid-auto-columns: 300px; gap: 14px; overflow-x: auto; padding-bottom: 8px; }
.cell { background: var(--card); border: 1px solid var(--line); border-radius: 8px; overflow: hidden; }
.cell h3 { font-size: .95rem; margin: 0; padding: .55rem .75rem .1rem; }
.cell .how { font-size: .78rem; color: var(--dim); padding: 0 .75rem .5rem; min-height: 2.3em; }
.cell figure { margin: 0; }
.cell img { display: block; width: 100%; height: auto; background: #8883; }
.cell figcaption { font-size: .72rem; color: var(--dim); padding: .15rem .75rem .35rem; }
.cell .none { padding: .5rem .75rem 1rem; color: var(--dim); font-size: .8rem; }
table { border-collapse: collapse; width: 100%; font-size: .82rem; font-variant-numeric: tabular-nums; }
th, td { padding: .1rem .75rem; text-align: left; font-weight: 400; }
th { color: var(--dim); }
td { text-align: right; }
td.best { font-weight: 700; }
code { display: block; padding: .3rem .75rem .6rem; font-size: .68rem; color: var(--dim); overflow-wrap: anywhere; }
.legend { display: flex; align-items: center; gap: .6em; margin: .8rem 0 0; font-size: .82rem; color: var(--dim); }
.legend i { display: inline-block; width: 200px; height: 12px; border-radius: 6px; border: 1px solid var(--line); }
.legend b { display: inline-block; width: 12px; height: 12px; border-radius: 3px; margin-left: 1em; }
)";

/// Text in HTML, in attributes too.
std::string escaped(std::string_view text) {
    std::string safe;
    for (const char c : text) {
        switch (c) {
            case '&': safe += "&amp;"; break;
            case '<': safe += "&lt;"; break;
            case '>': safe += "&gt;"; break;
            case '"': safe += "&quot;"; break;
            case '\'': safe += "&#39;"; break;
            default: safe += c;
        }
    }
    return safe;
}

/// A relative path as a link. RFC 3986 section 2.3: all but the unreserved characters are written as bytes.
std::string link_to(const std::string& folder, const std::string& file) {
    std::string link;
    for (const char c : folder.empty() || folder == "." ? file : folder + "/" + file) {
        const bool unreserved = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                                std::string_view("-._~/").find(c) != std::string_view::npos;
        link += unreserved ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return link;
}

std::string css(const Rgb& color) { return fmt::format("rgb({},{},{})", color[0], color[1], color[2]); }

/// The ramp of false_color.h; its stops are the errors -1, -1/4, 0, 1/4, 1.
std::string legend_html() {
    return fmt::format(
        "<div class=\"legend\">too dark (error -1) <i style=\"background:linear-gradient(90deg,{},{},{})\"></i> too bright "
        "(error +1) <b style=\"background:{}\"></b> not judged <b style=\"background:{}\"></b> not a number. Saturation is the "
        "square root of the error.</div>\n",
        css(kTooDark), css(kRight), css(kTooBright), css(kNotJudged), css(kNotFinite));
}

bool has_picture(const SheetEntry& entry, std::string_view name) {
    return std::ranges::find(entry.pictures, name) != entry.pictures.end();
}

std::string figure_html(const SheetEntry& entry, const std::string& name, std::string_view caption) {
    if (!has_picture(entry, name)) return {};
    const std::string link = link_to(entry.folder, name);
    return fmt::format(
        "<figure><a href=\"{0}\"><img loading=\"lazy\" src=\"{0}\" alt=\"{1}: {2}, {3}\"></a><figcaption>{1}"
        "</figcaption></figure>\n",
        link, caption, escaped(entry.scene), escaped(entry.technique));
}

/// The smallest of a number among the results of a row, to set in bold; -1 when fewer than two have it.
double best_of(const SheetRow& row, double SheetEntry::Numbers::* number) {
    double best = -1;
    int count = 0;
    for (const SheetEntry& entry : row.entries) {
        if (!entry.metrics) continue;
        const double value = (*entry.metrics).*number;
        best = count++ == 0 ? value : std::min(best, value);
    }
    return count < 2 ? -1 : best;
}

std::string numbers_html(const SheetRow& row, const SheetEntry& entry) {
    std::string html = "<table>\n";
    auto out = std::back_inserter(html);
    if (entry.metrics) {
        using N = SheetEntry::Numbers;
        constexpr std::array<std::pair<const char*, double N::*>, 5> kNumbers{
            {{"rmse", &N::rmse}, {"mae", &N::mae}, {"p99", &N::p99}, {"leak", &N::leak}, {"acne", &N::acne}}};
        for (const auto& [name, member] : kNumbers) {
            const double value = (*entry.metrics).*member;
            fmt::format_to(out, "<tr><th>{}</th><td{}>{:.5f}</td></tr>\n", name,
                           value == best_of(row, member) ? " class=\"best\"" : "", value);
        }
    }
    fmt::format_to(out, "<tr><th>frame</th><td>{:.1f} ms</td></tr>\n</table>\n", entry.frame_ms);
    fmt::format_to(out, "<code title=\"xxh3-128 of the visibility\">{}</code>\n", escaped(entry.hash));
    return html;
}

std::string entry_html(const SheetRow& row, const SheetEntry& entry) {
    std::string html =
        fmt::format("<div class=\"cell\"><h3>{}</h3><div class=\"how\">{}<br><a href=\"{}\">report.json</a></div>\n",
                    escaped(entry.technique), escaped(entry.settings), link_to(entry.folder, "report.json"));
    html += figure_html(entry, "color.png", "colour");
    html += figure_html(entry, "visibility.png", "visibility");
    html += figure_html(entry, "difference.png", "visibility - reference");
    return html + numbers_html(row, entry) + "</div>\n";
}

/// The truth of a row: every result carries the same one.
std::string reference_html(const SheetRow& row) {
    const auto with_truth =
        std::ranges::find_if(row.entries, [](const SheetEntry& entry) { return has_picture(entry, "reference.png"); });
    std::string html = "<div class=\"cell\"><h3>reference</h3><div class=\"how\">ray traced</div>\n";
    if (with_truth == row.entries.end()) return html + "<div class=\"none\">none was traced</div></div>\n";
    return html + figure_html(*with_truth, "reference.png", "visibility") + "</div>\n";
}

std::string row_html(const ContactSheet& sheet, const SheetRow& row) {
    std::string html = fmt::format("<h2>{}<small>{}</small></h2>\n<div class=\"row\">\n", escaped(row.scene),
                                   escaped(row.entries.front().image));
    for (const std::string& technique : sheet.techniques) {
        bool any = false;
        for (const SheetEntry& entry : row.entries) {
            if (entry.technique != technique) continue;
            html += entry_html(row, entry);
            any = true;
        }
        if (!any)
            html += fmt::format("<div class=\"cell\"><h3>{}</h3><div class=\"none\">not rendered</div></div>\n",
                                escaped(technique));
    }
    return html + reference_html(row) + "</div>\n";
}

}  // namespace

std::string contact_sheet_html(const ContactSheet& sheet) {
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>Gnomon contact sheet</title>\n"
        "<style>{}</style>\n</head>\n<body>\n<h1>Gnomon contact sheet</h1>\n"
        "<p>Shadows as the simulated GPU renders them, against ray-traced truth. Numbers are over the judged pixels; the best "
        "of "
        "a row is bold. Click a picture for its full size.</p>\n",
        kStyle);
    html += legend_html();
    for (const SheetRow& row : sheet.rows) html += row_html(sheet, row);
    return html + "</body>\n</html>\n";
}

}  // namespace gnomon::studies
