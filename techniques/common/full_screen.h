// Passes over every pixel of a target: one triangle that covers it.
#pragma once

#include "pipeline/device.h"
#include "pipeline/fragment.h"
#include "pipeline/vertex_stage.h"

namespace gnomon::techniques {

/// From positions in clip space.
struct FullScreenVertex {
    template <class Real>
    struct Input {
        Real x, y;
    };
    template <class Real>
    using Varyings = NoVaryings<Real>;

    float depth = 0.0f;

    static constexpr auto fields() { return std::tuple{Field{"depth", &FullScreenVertex::depth}}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return VertexOutput{Vec4<Real>{v.in.x, v.in.y, Real(depth), Real(1.0f)}, NoVaryings<Real>{}};
    }
};

/// The pixel that a fragment is in, as whole numbers.
template <class F>
Vec2<Int> pixel_of(const F& f) {
    return {bounded_truncate_to_int(f.position.x), bounded_truncate_to_int(f.position.y)};
}

/// Runs full-screen programs (a FullScreenVertex and a pixel functor) on a device.
class FullScreen {
public:
    explicit FullScreen(Device& device);

    template <class Pixel>
    void run(std::string_view label, const Program& program, const Pixel& pixel, std::span<const TargetView> colors) const {
        draw(label, program, constants_of(pixel), {.colors = colors});
    }
    /// Into the pixels of a rectangle alone.
    template <class Pixel>
    void run_inside(std::string_view label, const Program& program, const Pixel& pixel, TargetView color,
                    const ScissorRect& rectangle) const {
        draw(label, program, constants_of(pixel), {.colors = {&color, 1}, .scissors = {&rectangle, 1}});
    }
    /// Into a depth texture: the functor's depth output replaces what is there.
    template <class Pixel>
    void run_depth(std::string_view label, const Program& program, const Pixel& pixel, TargetView depth) const {
        draw(label, program, constants_of(pixel), {.depth = depth});
    }

private:
    struct Targets {
        std::span<const TargetView> colors{};
        TargetView depth{};
        std::span<const ScissorRect> scissors{};
    };
    void draw(std::string_view label, const Program& program, std::span<const std::byte> constants,
              const Targets& targets) const;

    Device& device_;
    BufferId triangle_;
};

}  // namespace gnomon::techniques
