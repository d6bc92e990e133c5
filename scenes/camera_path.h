// Paths along which a scene's own camera moves, for sequences of frames.
#pragma once

#include "scenes/scene.h"

#include <glm/mat4x4.hpp>

#include <span>
#include <string_view>

namespace gnomon::scenes {

/// A movement relative to where a scene's camera stands. Lengths are relative to its focus distance.
struct CameraPath {
    std::string_view name;
    std::string_view summary;  // one line: what moves, how far at time 1

    /// World from camera at a time, in double: `start` moved, with the focus `focus_m` before it.
    glm::dmat4 (*moved)(const glm::dmat4& start, double focus_m, double time);

    /// The camera at `time` in [0, 1), where `start` is the camera of time 0, kept bit for bit there. Only the rigid matrix
    /// changes, computed in double and rounded once; every movement is uniform in time.
    [[nodiscard]] Camera at(const Camera& start, const Bounds& scene, double time) const;
};

/// All of them, in the order of the documentation.
std::span<const CameraPath> camera_paths();

/// The path of this name; an Error that lists the names if there is none.
const CameraPath& find_camera_path(std::string_view name);

/// The distance from a camera along its view axis to the middle of the scene's depth, which is the depth of the middle of its
/// bounds: the point that paths take as looked at. Not nearer than a sixteenth of the bounds' diagonal (a camera in the midst
/// of a scene or turned away from it), not beyond the far plane. Metres, > 0.
double focus_distance(const Camera& camera, const Bounds& scene);

}  // namespace gnomon::scenes
