// Meshes without holes for watertightness tests: subdivisions of the plane on the snapped grid, closed solids, solids seen by a
// camera.
//
// What must hold, sample by sample:
// - a subdivision covers every sample of its rectangle exactly once, as its triangles all face front on the grid itself;
// - a closed solid in front of the camera, however its vertices are snapped, covers every sample by as many front faces as back
//   faces: the top-left rule moves all samples the same way off the edges, and a closed surface is entered as often as it is
//   left;
// - of a convex solid at most one front face covers a sample, unless snapping turns a face over;
// - cut by the near plane, a solid is open there: samples that see into it count one back face more. ClippedTriangle knows.
#pragma once

#include "tests/oracle/clipping.h"
#include "tests/oracle/random.h"
#include "tests/oracle/triangles.h"

#include <array>
#include <cstdint>
#include <vector>

namespace oracle {

using Corners = std::array<std::uint32_t, 3>;

/// Every directed edge occurs once, and so does its reverse.
bool is_closed(const std::vector<Corners>& triangles);

/// A mesh on the snapped grid.
struct SnappedMesh {
    std::vector<Point> vertices;
    std::vector<Corners> triangles;

    [[nodiscard]] SnappedTriangle triangle(std::size_t i) const {
        const Corners& c = triangles[i];
        return {vertices[c[0]], vertices[c[1]], vertices[c[2]]};
    }
};

/// The rectangle between two grid points, divided into triangles that meet edge to edge, all front facing (clockwise): `steps`
/// times a point is put into a triangle or on an edge, or an edge is flipped. Many points lie on samples of the target's
/// pattern and edges pass through them; triangles get as thin as the grid lets them.
SnappedMesh random_subdivision(Random& random, const Point& top_left, const Point& bottom_right, int steps,
                               const SamplePattern& pattern);

/// A closed surface on integer coordinates within about +-2^10; (b - a) x (c - a) points outwards.
struct Solid {
    struct Position {
        std::int64_t x, y, z;

        bool operator==(const Position&) const = default;
    };
    std::vector<Position> vertices;
    std::vector<Corners> triangles;
};

/// The regular solid of 4, 8 or 20 triangles, each divided into four `levels` times, pushed out to radius 1000.
Solid sphere(int faces, int levels);
/// A sphere whose radius varies from vertex to vertex by up to `amount` of it: closed, not convex.
Solid displaced(Random& random, Solid solid, float amount);
/// The convex hull of random points in a ball. At least 4 points; 30 take about a millisecond.
Solid random_hull(Random& random, int points);
/// One of the above.
Solid random_solid(Random& random);

/// A mesh in clip space, fit for ClippedTriangle; clip_float() makes fp32 components.
struct ClipMesh {
    std::vector<ClipVertex> vertices;
    std::vector<Corners> triangles;

    [[nodiscard]] std::array<ClipVertex, 3> triangle(std::size_t i) const {
        const Corners& c = triangles[i];
        return {vertices[c[0]], vertices[c[1]], vertices[c[2]]};
    }
};

enum class ViewKind {
    InFront,   // between the near and the far plane, partly outside the viewport
    NearCuts,  // through the near plane and the plane of the eye
    FarCuts,   // through the far plane
    Inside,    // the eye is inside the solid
};
inline constexpr std::array<ViewKind, 4> kViewKinds{ViewKind::InFront, ViewKind::NearCuts, ViewKind::FarCuts, ViewKind::Inside};

/// The solid, randomly turned, seen by a random camera with z from 0 at the near to w at the far plane. Vertices are rounded to
/// the unit once, so that triangles that share one agree about it.
ClipMesh random_view(Random& random, const Solid& solid, ViewKind kind);

enum class ClipKind {
    InFront,   // w > 0 and within the depth range
    AnyW,      // corners before and behind the eye
    OnPlanes,  // corners on the near plane, the far plane or the plane of the eye
    Wide,      // x and y far outside the viewport
    Anything,  // components of any size, independently
};
inline constexpr std::array<ClipKind, 5> kClipKinds{ClipKind::InFront, ClipKind::AnyW, ClipKind::OnPlanes, ClipKind::Wide,
                                                    ClipKind::Anything};

/// A single clip-space triangle of the kind.
std::array<ClipVertex, 3> random_clip_triangle(Random& random, ClipKind kind);

}  // namespace oracle
