// Vertices through the vertex functor, a wave at a time. D3D11.3 chapter 9
#pragma once

#include "pipeline/assembly.h"
#include "pipeline/clip.h"
#include "sim/denormals.h"
#include "sim/double_lanes.h"
#include "sim/parallel.h"
#include "sim/vec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <vector>

namespace gnomon {

/// What a vertex functor sees.
template <class RealType, class Input, class InstanceInput>
struct VertexContext {
    using Real = RealType;
    Input in;                // per vertex
    InstanceInput instance;  // per instance
    Int vertex_id;           // the index, or the number of the vertex in the draw. D3D11.3 8.16
    Int instance_id;         // from 0. D3D11.3 8.18
};

/// What it returns.
template <class Real, class Varyings>
struct VertexOutput {
    Vec4<Real> position;  // clip space
    Varyings varyings;
};
template <class Real, class Varyings>
VertexOutput(Vec4<Real>, Varyings) -> VertexOutput<Real, Varyings>;

/// The same, where vertices choose the array slice and the viewport of the primitives they provoke. What is out of range counts
/// as 0. D3D11.3 15.8.1, 15.15
template <class Real, class Varyings>
struct LayeredVertexOutput {
    Vec4<Real> position;
    Varyings varyings;
    Int layer;
    Int viewport;
};
template <class Real, class Varyings>
LayeredVertexOutput(Vec4<Real>, Varyings, Int, Int) -> LayeredVertexOutput<Real, Varyings>;

/// Varyings of a depth-only program: none.
template <class Real>
struct NoVaryings {};

/// Instance inputs of a functor that has none.
struct NoInstanceInput {};

/// Number of Reals in a struct of Reals.
template <class Struct, class Real>
inline constexpr std::size_t kRealCount = std::is_empty_v<Struct> ? 0 : sizeof(Struct) / sizeof(Real);

template <class VertexFunctor, class Real>
struct InstanceInputOf {
    using type = NoInstanceInput;
};
template <class VertexFunctor, class Real>
    requires requires { typename VertexFunctor::template Instance<Real>; }
struct InstanceInputOf<VertexFunctor, Real> {
    using type = typename VertexFunctor::template Instance<Real>;
};

/// Which vertices of which instances to shade.
struct VertexFetch {
    std::span<const float> vertices;         // interleaved
    std::span<const float> instances;        // interleaved
    const VertexNumbers* corners = nullptr;  // not null: every corner is shaded for itself
    std::uint32_t first = 0;                 // corners, or else numbers, first, first + 1, ...
    std::int32_t base_vertex = 0;            // added to numbers
    std::uint32_t vertex_id_base = 0;        // taken off numbers
    std::uint32_t count = 0;                 // vertices of one instance
    std::uint32_t first_instance = 0;        // of the buffer
    std::uint32_t instance_begin = 0;        // of the draw
    std::uint32_t instance_count = 1;
};

/// Vertices after the vertex functor, `stride` scalars each: clip x, y, z, w, varyings, and layer and viewport where there are
/// such. Vertex v of instance i is number i * (vertices per instance) + v.
template <class Scalar>
struct VertexBlock {
    int stride = kPositionScalars;
    std::vector<Scalar> scalars;
};

template <class Result>
inline constexpr bool kIsLayered = requires(const Result& result) { result.layer; };

template <class Real, class VertexFunctor>
void shade_vertices(const VertexFunctor& functor, const VertexFetch& fetch, Workers& workers, bool flush_denormals,
                    VertexBlock<typename Real::Scalar>& out) {
    using Scalar = typename Real::Scalar;
    using Input = typename VertexFunctor::template Input<Real>;
    using InstanceInput = typename InstanceInputOf<VertexFunctor, Real>::type;
    using Varyings = typename VertexFunctor::template Varyings<Real>;
    using Result = decltype(functor(std::declval<const VertexContext<Real, Input, InstanceInput>&>()));
    constexpr std::size_t kInputs = kRealCount<Input, Real>;
    constexpr std::size_t kInstanceInputs = kRealCount<InstanceInput, Real>;
    constexpr std::size_t kVaryings = kRealCount<Varyings, Real>;
    constexpr std::size_t kExtra = kIsLayered<Result> ? 2 : 0;
    constexpr std::size_t kColumns = std::size_t{kPositionScalars} + kVaryings + kExtra;
    constexpr std::uint32_t kPiece = 512;
    static_assert(kInputs > 0, "a vertex functor reads at least one number per vertex");
    static_assert(sizeof(Input) == kInputs * sizeof(Real));

    const std::uint32_t total = fetch.count * fetch.instance_count;
    out.stride = static_cast<int>(kColumns);
    out.scalars.resize(static_cast<std::size_t>(total) * kColumns);
    const auto last_vertex = static_cast<std::int64_t>(fetch.vertices.size() / kInputs) - 1;

    const auto shade_wave = [&](std::uint32_t begin) {
        // Fetch: one vertex per lane; lanes behind the end repeat the last vertex.
        std::array<std::array<Scalar, kLanes>, kInputs> fetched;
        std::array<std::array<Scalar, kLanes>, kInstanceInputs> fetched_instance;
        std::array<std::int32_t, kLanes> vertex_id;
        std::array<std::int32_t, kLanes> instance_id;
        for (std::uint32_t i = 0; i < kLanes; ++i) {
            const std::uint32_t position = std::min(begin + i, total - 1);
            const std::uint32_t instance = fetch.instance_count == 1 ? 0 : position / fetch.count;
            const std::uint32_t v = position - instance * fetch.count;
            const std::uint32_t number = fetch.corners != nullptr ? (*fetch.corners)[fetch.first + v] : fetch.first + v;
            // The number that restarts names no vertex; whatever it becomes is not used.
            const std::int64_t vertex = std::clamp(std::int64_t{number} + fetch.base_vertex, std::int64_t{0}, last_vertex);
            const float* source = fetch.vertices.data() + static_cast<std::size_t>(vertex) * kInputs;
            for (std::size_t k = 0; k < kInputs; ++k) fetched[k][i] = static_cast<Scalar>(source[k]);
            const std::size_t from = std::size_t{fetch.first_instance} + fetch.instance_begin + instance;
            for (std::size_t k = 0; k < kInstanceInputs; ++k)
                fetched_instance[k][i] = static_cast<Scalar>(fetch.instances[from * kInstanceInputs + k]);
            vertex_id[i] = static_cast<std::int32_t>(number - fetch.vertex_id_base);
            instance_id[i] = static_cast<std::int32_t>(fetch.instance_begin + instance);
        }
        std::array<Real, kInputs> inputs;
        for (std::size_t k = 0; k < kInputs; ++k) inputs[k] = Real::load(fetched[k].data());
        VertexContext<Real, Input, InstanceInput> context{
            std::bit_cast<Input>(inputs), {}, Int::load(vertex_id.data()), Int::load(instance_id.data())};
        if constexpr (kInstanceInputs > 0) {
            std::array<Real, kInstanceInputs> instance;
            for (std::size_t k = 0; k < kInstanceInputs; ++k) instance[k] = Real::load(fetched_instance[k].data());
            context.instance = std::bit_cast<InstanceInput>(instance);
        }
        const Result result = functor(context);

        // Store one record per vertex.
        std::array<std::array<Scalar, kLanes>, kColumns> columns;
        result.position.x.store(columns[0].data());
        result.position.y.store(columns[1].data());
        result.position.z.store(columns[2].data());
        result.position.w.store(columns[3].data());
        if constexpr (kVaryings > 0) {
            const auto values = std::bit_cast<std::array<Real, kVaryings>>(result.varyings);
            for (std::size_t k = 0; k < kVaryings; ++k) values[k].store(columns[kPositionScalars + k].data());
        }
        if constexpr (kIsLayered<Result>) {
            const auto small = [](Int index) { return Real(clamp(index, Int(-1), Int(1 << 20))); };
            small(result.layer).store(columns[kColumns - 2].data());
            small(result.viewport).store(columns[kColumns - 1].data());
        }
        for (std::uint32_t i = 0; i < std::min<std::uint32_t>(kLanes, total - begin); ++i) {
            Scalar* record = out.scalars.data() + static_cast<std::size_t>(begin + i) * kColumns;
            for (std::size_t k = 0; k < kColumns; ++k) record[k] = columns[k][i];
        }
    };

    workers.for_each((total + kPiece - 1) / kPiece, [&](std::size_t piece) {
        const DenormalScope denormals(flush_denormals);
        const auto begin = static_cast<std::uint32_t>(piece) * kPiece;
        for (std::uint32_t v = begin; v < std::min(total, begin + kPiece); v += kLanes) shade_wave(v);
    });
}

}  // namespace gnomon
