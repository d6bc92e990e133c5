// What a run has to say, for machines (report.json) and for people (tables). docs/report.md explains every entry.
#pragma once

#include "studies/experiment.h"

#include <span>
#include <string>

namespace gnomon::studies {

/// The version of this program.
std::string version();

/// report.json: configuration, metrics, counters, traffic, timings, hashes, host.
std::string report_json(const RenderResult& result);

/// The same as a block of text.
std::string report_text(const RenderResult& result);

/// Counters per pass, then bytes read and bytes written per resource and pass, as tables without rows of zeros.
std::string counters_text(const RenderResult& result);

/// One line per result under a heading: how techniques compare.
std::string comparison_text(std::span<const RenderResult> results);

}  // namespace gnomon::studies
