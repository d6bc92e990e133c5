// Studies: many techniques, settings and scenes under one question, as one table. `gnomon study`
#pragma once

#include "studies/experiment.h"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gnomon::studies {

/// One row of a study per scene.
struct StudyCase {
    std::string group;  // cases that are compared with each other, as "8 bytes"
    std::string label;  // of the technique and its settings, as "lvsm 2 lloyd"
    std::string technique;
    techniques::TechniqueRequest request;
    std::string profile = "d3d11";
};

struct Study {
    std::string_view name;
    std::string_view summary;  // one line
    std::string_view source;   // paper and section
    std::vector<std::string> scenes;
    std::vector<StudyCase> cases;
};

/// All of them, in the order of `gnomon list studies`.
std::span<const Study> all_studies();
/// Throws Error that lists the names.
const Study& find_study(std::string_view name);

struct StudyOptions {
    std::vector<std::string> scenes;  // instead of the study's own; empty: those
    int width = 640;                  // pixels
    int height = 480;
    Truth truth = Truth::Area;
    int threads = 0;  // changes no result
};

struct StudyRow {
    std::string scene;
    StudyCase what;
    double bytes_per_texel = 0;
    std::optional<Metrics> metrics;  // none: no pixel could be judged
    MapStatistics map;
    double map_ms = 0;  // every pass but the camera's: once, on this machine
    double camera_ms = 0;
};

/// Runs every case on every scene; `on_row` sees each row as soon as it is there. Throws Error, for names and settings before
/// the first row, and Stopped through `progress`.
void run_study(const Study& study, const StudyOptions& options, const Progress& progress,
               const std::function<void(const StudyRow&)>& on_row);

/// The table in words, and as JSON.
std::string study_header();
std::string study_line(const StudyRow& row);
std::string study_json(const Study& study, const StudyOptions& options, std::span<const StudyRow> rows);

}  // namespace gnomon::studies
