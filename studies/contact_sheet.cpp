// Gathering results from a folder.
#include "studies/contact_sheet.h"

#include "sim/error.h"
#include "sim/warn.h"
#include "studies/result_files.h"
#include "techniques/technique.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace gnomon::studies {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A value of a report, in words; reports are files and so hold anything.
std::string text_at(const Json& report, const std::string& pointer) {
    const Json& value = report.at(Json::json_pointer(pointer));
    return value.is_string() ? value.get<std::string>() : value.dump();
}

double number_at(const Json& report, const char* pointer) { return report.at(Json::json_pointer(pointer)).get<double>(); }

std::string settings_line(const Json& report) {
    std::string text = fmt::format("map {}, {}, {}", text_at(report, "/configuration/map"),
                                   text_at(report, "/configuration/format"), text_at(report, "/configuration/filter"));
    const Json::json_pointer parameters("/configuration/parameters");
    if (!report.contains(parameters) || !report.at(parameters).is_object()) return text;
    for (const auto& [name, value] : report.at(parameters).items())
        text += fmt::format(", {} {}", name, text_at(report, "/configuration/parameters/" + name));
    return text;
}

std::vector<std::string> pictures_in(const fs::path& folder) {
    std::vector<std::string> found;
    std::error_code ignored;
    for (const std::string& name : result_file_names())
        if (name.ends_with(".png") && fs::is_regular_file(folder / name, ignored)) found.push_back(name);
    return found;
}

/// Throws nlohmann's exceptions for whatever is missing or has another type.
SheetEntry read_entry(const fs::path& report_path, const fs::path& root) {
    std::ifstream file(report_path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    const Json report = Json::parse(text);
    SheetEntry entry{
        .scene = text_at(report, "/configuration/scene"),
        .technique = text_at(report, "/configuration/technique"),
        .folder = report_path.parent_path().lexically_relative(root).generic_string(),
        .settings = settings_line(report),
        .image = fmt::format("{}x{}, profile {}", text_at(report, "/configuration/size/0"),
                             text_at(report, "/configuration/size/1"), text_at(report, "/configuration/profile/name")),
        .metrics = {},
        .frame_ms = number_at(report, "/timings_ms/frame"),
        .hash = text_at(report, "/hashes/visibility"),
        .pictures = pictures_in(report_path.parent_path())};
    if (!report.at("metrics").is_null())
        entry.metrics = {number_at(report, "/metrics/rmse"), number_at(report, "/metrics/mae"),
                         number_at(report, "/metrics/p99"), number_at(report, "/metrics/leak"),
                         number_at(report, "/metrics/acne")};
    return entry;
}

/// Paths of the reports, in the order of their names.
std::vector<fs::path> find_reports(const fs::path& folder) {
    std::error_code error;
    fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error);
    if (error) fail("{}: {}", folder.string(), error.message());
    std::vector<fs::path> reports;
    for (; at != fs::recursive_directory_iterator(); at.increment(error)) {
        if (error) fail("{}: {}", folder.string(), error.message());
        const std::string name = at->path().filename().string();
        std::error_code ignored;
        if (name.starts_with(".") && at->is_directory(ignored)) at.disable_recursion_pending();
        if (name == "report.json" && at->is_regular_file(ignored)) reports.push_back(at->path());
    }
    std::ranges::sort(reports);
    return reports;
}

/// Position in `gnomon list techniques`; unknown names come after.
std::size_t technique_order(const std::string& name) {
    const auto all = techniques::all_techniques();
    return static_cast<std::size_t>(
        std::ranges::find_if(all, [&](const techniques::Technique& technique) { return technique.name == name; }) -
        all.begin());
}

bool technique_before(const std::string& a, const std::string& b) {
    return std::pair(technique_order(a), a) < std::pair(technique_order(b), b);
}

}  // namespace

ContactSheet read_contact_sheet(const fs::path& folder) {
    std::error_code error;
    if (!fs::is_directory(folder, error)) fail("{}: not a folder", folder.string());
    ContactSheet sheet;
    for (const fs::path& report : find_reports(folder)) {
        try {
            SheetEntry entry = read_entry(report, folder);
            if (std::ranges::find(sheet.techniques, entry.technique) == sheet.techniques.end())
                sheet.techniques.push_back(entry.technique);
            // Results of one scene whose folders lie side by side share a row.
            const std::string row_folder = fs::path(entry.folder).parent_path().generic_string();
            auto row = std::ranges::find_if(
                sheet.rows, [&](const SheetRow& other) { return other.scene == entry.scene && other.folder == row_folder; });
            if (row == sheet.rows.end()) row = sheet.rows.insert(row, {entry.scene, row_folder, {}});
            row->entries.push_back(std::move(entry));
        } catch (const Json::exception&) {
            warn_once(fmt::format("{}: not a report of 'gnomon render'; left out", report.string()));
        }
    }
    if (sheet.rows.empty()) fail("{}: no report.json of 'gnomon render' in it or below", folder.string());
    std::ranges::sort(sheet.techniques, technique_before);
    return sheet;
}

}  // namespace gnomon::studies
