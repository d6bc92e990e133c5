// The table of a seam under all its cures, as text and JSON.
#pragma once

#include "studies/seams/splits.h"

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::studies {

/// What was looked at, in words: "scene" "city", "technique" "psvsm", ...
using SeamConfiguration = std::vector<std::pair<std::string, std::string>>;

/// A column per number, a row per cure. Differences of values are against `reference`.
std::string seam_header();
std::string seam_line(const SeamRun& run);
std::string seam_json(const SeamConfiguration& configuration, std::span<const SeamRun> runs);

}  // namespace gnomon::studies
