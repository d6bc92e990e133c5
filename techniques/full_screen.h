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
        draw(label, program, constants_of(pixel), colors, {});
    }
    /// Into a depth texture: the functor's depth output replaces what is there.
    template <class Pixel>
    void run_depth(std::string_view label, const Program& program, const Pixel& pixel, TargetView depth) const {
        draw(label, program, constants_of(pixel), {}, depth);
    }

private:
    void draw(std::string_view label, const Program& program, std::span<const std::byte> constants,
              std::span<const TargetView> colors, TargetView depth) const;

    Device& device_;
    BufferId triangle_;
};

}  // namespace gnomon::techniques
