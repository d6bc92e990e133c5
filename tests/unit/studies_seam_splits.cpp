// The quad that straddles two splits, on scenes: what is wrong without a cure, and what each cure leaves.
// [Lauritzen06] "Texture coordinate derivatives"
#include "scenes/procedural.h"
#include "studies/seam_splits.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <map>

using namespace gnomon;
using namespace gnomon::studies;

TEST_CASE("explore", "[.explore]") {
    RenderRequest request{.scene = "fence", .technique = "psvsm", .choices = {}, .width = 640, .height = 480};
    request.choices.map_size = 512;
    for (const int n : {2, 4, 8}) {
        request.choices.cascades = n;
        const scenes::Scene scene = find_scene(request.scene, {});
        const Profile profile;
        const auto plan = plan_runs(request, profile).front();
        std::map<std::string, SeamImage> images;
        for (const auto cure : split_cures()) images[std::string(cure)] = draw_split_seams(scene, profile, request, plan, cure);
        for (const auto cure : split_cures()) {
            const SeamImage& image = images[std::string(cure)];
            const SeamMeasures m = measure_seam(image, images["none"], images["explicit-gradients"]);
            fmt::print("{} {:<24}", n, cure);
            for_each_field(m, [&](std::string_view name, const auto& v) { fmt::print(" {}={:.4g}", name, static_cast<double>(v)); });
            fmt::print(" ms {:.2f} tex {} der {} inv {}\n", image.milliseconds, image.counters.texture_instructions,
                       image.counters.derivatives, image.counters.derivatives_inactive);
        }
    }
}
