// The table of a seam under all its cures, as text and JSON.
#pragma once

#include "studies/seams/splits.h"
#include "traces/json_values.h"

#include <span>
#include <string>

namespace gnomon::studies {

/// A column per number, a row per cure. Differences of values are against `reference`.
std::string seam_header();
std::string seam_line(const SeamRun& run);
/// `configuration`: what it takes to draw it again.
std::string seam_json(const traces::Json& configuration, std::span<const SeamRun> runs);

}  // namespace gnomon::studies
