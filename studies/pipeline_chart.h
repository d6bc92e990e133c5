// One picture of what the pipeline draws: antialiasing, wireframes, lines, a shadow volume, blending, derivative provenance.
// docs/architecture.md shows it.
#pragma once

#include "sim/profile.h"
#include "studies/images.h"

namespace gnomon::studies {

inline constexpr int kPanelSide = 192;  // pixels of each panel; eight of them in two rows with a margin around each
inline constexpr int kPanelMargin = 6;
inline constexpr int kPanelColumns = 4;
inline constexpr int kPanelRows = 2;

/// Draws the panels under a profile. Throws Error where it lacks four samples per pixel.
ByteImage pipeline_chart(const Profile& profile, int threads);

}  // namespace gnomon::studies
