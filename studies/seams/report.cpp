// Seams as a table.
#include "studies/seams/report.h"

#include "studies/configuration.h"
#include "studies/report.h"

namespace gnomon::studies {

std::string seam_header() {
    return fmt::format("{:<24} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>9} {:>9} {:>9} {:>8} {:>11} {:>11} {:>11} {:>8}\n",
                       "cure", "disagree", "bad quads", "bad px", "share", "LOD err", "worst", "exact err", "value err",
                       "changed", "outside", "derivatives", "inactive", "samples", "ms");
}

std::string seam_line(const SeamRun& run) {
    const SeamMeasures& m = run.measures;
    const double share = m.pixels > 0 ? static_cast<double>(m.bad_pixels) / static_cast<double>(m.pixels) : 0.0;
    return fmt::format(
        "{:<24} {:>9} {:>9} {:>9} {:>7.3f}% {:>8.3f} {:>8.3f} {:>9.4f} {:>9.5f} {:>9} {:>8} {:>11} {:>11} {:>11} {:>8.2f}\n",
        run.cure, m.disagreeing_quads, m.bad_quads, m.bad_pixels, 100.0 * share, m.mean_lod_error, m.worst_lod_error,
        m.crossing_lod_error, m.mean_value_error, m.changed_pixels, m.outside_pixels, run.image.counters.derivatives,
        run.image.counters.derivatives_inactive, run.image.counters.texture_instructions, run.image.milliseconds);
}

std::string seam_json(const traces::Json& configuration, std::span<const SeamRun> runs) {
    traces::Json json;
    json["gnomon"] = version();
    json["configuration"] = configuration;
    json["cures"] = traces::Json::array();
    for (const SeamRun& run : runs)
        json["cures"].push_back({{"cure", run.cure},
                                 {"seam", fields_json(run.measures)},
                                 {"counters", fields_json(run.image.counters)},
                                 {"milliseconds", run.image.milliseconds}});
    return file_text(json);
}

}  // namespace gnomon::studies
