// The quad that straddles two splits of the view frustum, on a scene and under a technique: [PSVSM], looked at.
#pragma once

#include "sim/progress.h"
#include "studies/experiment.h"
#include "studies/seams/seam.h"

#include <string_view>
#include <vector>

namespace gnomon::studies {

/// One cure of a seam: its picture and what it comes to.
struct SeamRun {
    std::string cure;
    SeamImage image;
    SeamMeasures measures;
};

/// The names of the cures, "none" first.
std::vector<std::string_view> split_cures();

/// What the camera pass of a technique with cascades does under one cure; `settings` as resolve_settings leaves them, its cure
/// is replaced. Draws with a device of its own. Throws Stopped through `progress`.
SeamImage draw_split_seams(const scenes::Scene& scene, const Profile& profile, const RenderRequest& request,
                           const PlannedRun& plan, std::string_view cure, const Progress& progress = {});

}  // namespace gnomon::studies
