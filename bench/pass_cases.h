// The passes that the pipeline benchmarks draw: a scene, very many small triangles, a few large ones.
#pragma once

#include "scenes/scene.h"
#include "tests/peer/raw_pass.h"

#include <string>

namespace gnomon::bench {

/// Every object of the scene as its camera sees it.
peer::RawMesh scene_mesh(const scenes::Scene& scene, int width, int height);

/// Sheets of cells of two triangles of about `area_px` pixels each, the farthest first, so that nothing hides anything:
/// `count` triangles or a few more.
peer::RawMesh small_triangles(int count, float area_px, int width, int height);

/// Triangles that each cover the whole target. Their corners lie at random depths, or each lies before the last.
enum class LargeOrder { Random, BackToFront };
peer::RawMesh large_triangles(int count, LargeOrder order);

}  // namespace gnomon::bench
