// Many results on one page: what `gnomon contact-sheet` gathers from a folder of report.json files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gnomon::studies {

/// One result, as its report tells it. Paths are relative to the folder of the sheet, with / between parts.
struct SheetEntry {
    std::string scene;
    std::string technique;
    std::string folder;
    std::string settings;  // one line
    std::string image;     // size and profile
    struct Numbers {
        double rmse = 0;
        double mae = 0;
        double p99 = 0;
        double leak = 0;
        double acne = 0;
    };
    std::optional<Numbers> metrics;
    double frame_ms = 0;
    std::string hash;                   // of the visibility
    std::vector<std::string> pictures;  // names of the PNG files that are there
};

/// One scene in one folder; the techniques that were run on it.
struct SheetRow {
    std::string scene;
    std::string folder;
    std::vector<SheetEntry> entries;
};

/// Rows by folder and scene, techniques in the order of `gnomon list techniques`, others after them by name.
struct ContactSheet {
    std::vector<std::string> techniques;
    std::vector<SheetRow> rows;
};

/// Reads every report.json below `folder`; those that are not reports of `gnomon render` are left out with a warning. Throws
/// Error when the folder cannot be read or holds no report.
ContactSheet read_contact_sheet(const std::filesystem::path& folder);

/// A page that needs nothing but the pictures beside it.
std::string contact_sheet_html(const ContactSheet& sheet);

}  // namespace gnomon::studies
