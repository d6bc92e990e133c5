// What [Lauritzen08] 4.1.4 and 4.2 say of techniques at equal storage, on smaller pictures than docs/studies.md shows.
#include "sim/error.h"
#include "studies/study.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace gnomon;
using namespace gnomon::studies;

namespace {

struct Rows {
    std::vector<StudyRow> all;

    [[nodiscard]] const StudyRow& of(const std::string& scene, const std::string& label) const {
        const auto at =
            std::ranges::find_if(all, [&](const StudyRow& row) { return row.scene == scene && row.what.label == label; });
        if (at == all.end()) fail("no row {} of {}", label, scene);
        return *at;
    }
};

}  // namespace

TEST_CASE("[Lauritzen08] 4.1.4, 4.2: at equal storage layers leak less than Fourier series, exponentials less than both",
          "[lauritzen08][studies]") {
    const Study& study = find_study("equal-storage");
    Rows rows;
    run_study(study, {.scenes = {}, .width = 200, .height = 150}, {}, [&](const StudyRow& row) { rows.all.push_back(row); });
    CHECK(rows.all.size() == study.scenes.size() * study.cases.size());
    for (const StudyRow& row : rows.all) {
        INFO(row.scene << " " << row.what.label);
        REQUIRE(row.metrics);
        CHECK(row.what.group == fmt::format("{:g} bytes", row.bytes_per_texel));  // equal storage it is
    }
    // The error scene by scene where the storage is small, the leak over all scenes, as pictures of this size leave little of
    // each.
    const auto leak = [&](const std::string& label) {
        double sum = 0;
        for (const std::string& scene : study.scenes) sum += rows.of(scene, label).metrics->leak;
        return sum / static_cast<double>(study.scenes.size());
    };
    for (const int layers : {1, 2, 4, 8}) {
        const std::string layered = fmt::format("lvsm {} uniform", layers);
        const std::string series = fmt::format("csm {} terms", 2 * layers);
        INFO(layers << " layers: " << leak(layered) << ", as many bytes of series: " << leak(series));
        CHECK(leak(layered) < leak(series));
        if (layers > 2) continue;
        for (const std::string& scene : study.scenes)
            CHECK(rows.of(scene, layered).metrics->rmse < rows.of(scene, series).metrics->rmse);
    }
    for (const char* label : {"lvsm 4 uniform", "lvsm 4 lloyd", "lvsm 8 uniform", "lvsm 8 lloyd", "csm 16 terms"}) {
        INFO(label << ": " << leak(label) << ", evsm4: " << leak("evsm4 rgba32f"));
        CHECK(leak("evsm4 rgba32f") < leak(label));  // in half of the storage of the larger ones
    }
    // More storage, less light: of every family.
    CHECK(leak("lvsm 8 uniform") < leak("lvsm 1 uniform"));
    CHECK(leak("csm 16 terms") < leak("csm 2 terms"));
    CHECK(leak("evsm4 rgba32f") < leak("evsm4 rgba16f"));
}
