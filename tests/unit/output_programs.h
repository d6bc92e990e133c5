// Programs whose outputs are read from images, texel by texel, and a canvas to run them on: for the tests of everything behind
// the pixel functor.
#pragma once

#include "tests/unit/pipeline_programs.h"

#include <glm/vec4.hpp>

#include <cstdint>
#include <vector>

namespace gnomon::testing {

enum OutputFeature : unsigned {
    kDiscards = 1,   // where control.x > 0
    kDepth = 2,      // writes depth control.y
    kCoverage = 4,   // writes coverage control.z
    kEarly = 8,      // forces early tests
    kPerSample = 16  // runs for each sample
};

/// Constants of all of these programs. Texel (x, y) of slice sample * targets + i of `colors` goes to target i; slice `sample`
/// of `control` says the rest. Both read as 0 beyond their sides.
struct ImageConstants {
    TextureId colors = TextureId::None;
    TextureId control = TextureId::None;
};

/// The program with 1, 2 or 8 targets and those features; fails for combinations that no test asks for.
const Program& image_program(int targets, unsigned features = 0);
/// One target; attributes a and b of the provoking vertex are array slice and viewport.
const Program& layered_program();
/// The same without a pixel functor.
const Program& layered_depth_program();

/// Depth only; two floats per instance move it.
const Program& per_instance_program();

using Image = std::vector<glm::vec4>;

/// A rectangle of pixels at one depth.
struct Box {
    float x0, y0, x1, y1;
};

struct Canvas {
    Device device;
    int width;
    int height;
    int samples;
    std::vector<ImageConstants> constants;  // of the draws made here; they must outlive them

    Canvas(const Profile& profile, int canvas_width, int canvas_height, int canvas_samples = 1, int threads = 1)
        : device(profile, threads), width(canvas_width), height(canvas_height), samples(canvas_samples) {
        constants.reserve(16384);
    }

    [[nodiscard]] std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
    TextureId target(Format format, int layers = 1);
    /// An rgba32f array of slices of the canvas' size.
    TextureId image(const Image& texels);
    [[nodiscard]] std::vector<TestVertex> corners(const Box& box, float z, float a = 0.0f, float b = 0.0f) const;
    /// Two triangles; clockwise on the screen.
    Draw rectangle(const Program& program, const Box& box, float z, const ImageConstants& images = {});
    Draw everything(const Program& program, float z, const ImageConstants& images = {}) {
        return rectangle(program, {0, 0, static_cast<float>(width), static_cast<float>(height)}, z, images);
    }
    /// Code of component c at pixel i, counted row by row.
    [[nodiscard]] std::uint32_t code(TextureId id, std::size_t pixel, int c = 0, int layer = 0, int sample = 0) const;
    [[nodiscard]] float value(TextureId id, std::size_t pixel, int c = 0, int layer = 0, int sample = 0) const {
        return std::bit_cast<float>(code(id, pixel, c, layer, sample));
    }
    [[nodiscard]] int stencil(TextureId id, std::size_t pixel, int layer = 0, int sample = 0) const;
};

}  // namespace gnomon::testing
