#include "tests/unit/raster_programs.h"

namespace gnomon::testing {

namespace {

/// Attribute a where the provoking vertex has it.
struct MarkVertex {
    template <class Real>
    struct Input {
        Vec4<Real> position;
        Real a, b, layer, viewport;
    };
    template <class Real>
    struct Varyings {
        Real a;
        static constexpr std::array interpolation{Interpolation::Flat};
    };
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        return LayeredVertexOutput{v.in.position, Varyings<typename V::Real>{v.in.a}, truncate_to_int(v.in.layer),
                                   truncate_to_int(v.in.viewport)};
    }
};

struct Mark {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        return Vec4<Real>{f.in.a, Real(0.0f), Real(0.0f), Real(1.0f)};
    }
};

template <class Real>
struct Numbers {
    Real a, vertex, instance;
    static constexpr std::array interpolation{Interpolation::Flat, Interpolation::Flat, Interpolation::Flat};
};

struct IdentifyVertex {
    template <class Real>
    using Input = MarkVertex::Input<Real>;
    template <class Real>
    using Varyings = Numbers<Real>;
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return LayeredVertexOutput{v.in.position, Varyings<Real>{v.in.a, Real(v.vertex_id), Real(v.instance_id)},
                                   truncate_to_int(v.in.layer), truncate_to_int(v.in.viewport)};
    }
};

struct InstancedVertex {
    template <class Real>
    using Input = MarkVertex::Input<Real>;
    template <class Real>
    struct Instance {
        Real x, y;
    };
    template <class Real>
    using Varyings = Numbers<Real>;
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        const Vec4<Real> position{v.in.position.x + v.instance.x, v.in.position.y + v.instance.y, v.in.position.z,
                                  v.in.position.w};
        return LayeredVertexOutput{position, Varyings<Real>{v.in.a, Real(v.vertex_id), Real(v.instance_id)},
                                   truncate_to_int(v.in.layer), truncate_to_int(v.in.viewport)};
    }
};

template <class Real, class F>
Real facing(const F& f) {
    return Real(f.front_facing() ? 1.0f : 0.0f);
}

struct Identify {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const auto number = [](std::uint32_t n) { return Real(static_cast<float>(n)); };
        return std::array<Vec4<Real>, 2>{
            Vec4<Real>{f.in.a, f.in.vertex, f.in.instance, number(f.primitive_id())},
            Vec4<Real>{facing<Real>(f), Real(f.coverage()), number(f.layer()), number(f.viewport())}};
    }
};

template <class Real>
struct PixelModes {
    Real a, b, linear_a, linear_b, flat_a, flat_b, centroid_a, centroid_b, linear_centroid_a, linear_centroid_b;
    static constexpr std::array interpolation{Interpolation::Perspective,
                                              Interpolation::Perspective,
                                              Interpolation::Linear,
                                              Interpolation::Linear,
                                              Interpolation::Flat,
                                              Interpolation::Flat,
                                              Interpolation::PerspectiveCentroid,
                                              Interpolation::PerspectiveCentroid,
                                              Interpolation::LinearCentroid,
                                              Interpolation::LinearCentroid};
};
template <class Real>
struct SampleModes {
    Real a, b, linear_a, linear_b, flat_a, flat_b, centroid_a, centroid_b, linear_centroid_a, linear_centroid_b;
    Real sample_a, sample_b, linear_sample_a;
    static constexpr std::array interpolation{Interpolation::Perspective,
                                              Interpolation::Perspective,
                                              Interpolation::Linear,
                                              Interpolation::Linear,
                                              Interpolation::Flat,
                                              Interpolation::Flat,
                                              Interpolation::PerspectiveCentroid,
                                              Interpolation::PerspectiveCentroid,
                                              Interpolation::LinearCentroid,
                                              Interpolation::LinearCentroid,
                                              Interpolation::PerspectiveSample,
                                              Interpolation::PerspectiveSample,
                                              Interpolation::LinearSample};
};

struct InterpolationVertex {
    template <class Real>
    using Input = MarkVertex::Input<Real>;
    template <class Real>
    using Varyings = PixelModes<Real>;
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        const auto& [a, b] = std::pair{v.in.a, v.in.b};
        return LayeredVertexOutput{v.in.position, Varyings<typename V::Real>{a, b, a, b, a, b, a, b, a, b},
                                   truncate_to_int(v.in.layer), truncate_to_int(v.in.viewport)};
    }
};
struct SampleVertex {
    template <class Real>
    using Input = MarkVertex::Input<Real>;
    template <class Real>
    using Varyings = SampleModes<Real>;
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        const auto& [a, b] = std::pair{v.in.a, v.in.b};
        return LayeredVertexOutput{v.in.position, Varyings<typename V::Real>{a, b, a, b, a, b, a, b, a, b, a, b, a},
                                   truncate_to_int(v.in.layer), truncate_to_int(v.in.viewport)};
    }
};

template <class Real, class F>
std::array<Vec4<Real>, 5> pixel_outputs(const F& f) {
    const auto& in = f.in;
    return {f.position, Vec4<Real>{in.a, in.linear_a, in.flat_a, Real(f.coverage())},
            Vec4<Real>{in.b, in.linear_b, in.flat_b, facing<Real>(f)},
            Vec4<Real>{in.centroid_a, in.linear_centroid_a, in.centroid_b, in.linear_centroid_b},
            Vec4<Real>{f.ddx(in.a), f.ddy(in.a), Real(0.0f), Real(0.0f)}};
}

struct ShowPixel {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        return pixel_outputs<typename F::Real>(f);
    }
};
struct ShowSample {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const auto outputs = pixel_outputs<Real>(f);
        return std::array<Vec4<Real>, 6>{
            outputs[0],
            outputs[1],
            outputs[2],
            outputs[3],
            outputs[4],
            Vec4<Real>{f.in.sample_a, f.in.linear_sample_a, f.in.sample_b, Real(static_cast<float>(f.sample_index()))}};
    }
};

}  // namespace

const Program& mark_program() {
    static const Program program = make_program<MarkVertex, Mark>("test.mark");
    return program;
}
const Program& identify_program() {
    static const Program program = make_program<IdentifyVertex, Identify>("test.identify");
    return program;
}
const Program& instanced_program() {
    static const Program program = make_program<InstancedVertex, Identify>("test.instanced");
    return program;
}
const Program& interpolation_program() {
    static const Program program = make_program<InterpolationVertex, ShowPixel>("test.interpolation");
    return program;
}
const Program& sample_program() {
    static const Program program = make_program<SampleVertex, ShowSample>("test.sample");
    return program;
}
const Program& depth_program() {
    static const Program program = make_program<MarkVertex>("test.depth");
    return program;
}

// All functors are empty: one zero byte.
std::span<const std::byte> raster_vertex_constants(const Program& program) {
    static const std::byte zero{};
    return {&zero, program.vertex_constants_size};
}
std::span<const std::byte> raster_pixel_constants(const Program& program) {
    static const std::byte zero{};
    return {&zero, program.pixel_constants_size};
}

}  // namespace gnomon::testing
