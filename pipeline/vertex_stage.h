// Vertices through the vertex functor, a wave at a time. D3D11.3 chapter 9
#pragma once

#include "pipeline/primitives.h"
#include "sim/denormals.h"
#include "sim/double_lanes.h"
#include "sim/vec.h"

#include <algorithm>
#include <array>
#include <bit>

namespace gnomon {

/// What a vertex functor sees.
template <class RealType, class Input>
struct VertexContext {
    using Real = RealType;
    Input in;
};

/// What it returns.
template <class Real, class Varyings>
struct VertexOutput {
    Vec4<Real> position;  // clip space
    Varyings varyings;
};
template <class Real, class Varyings>
VertexOutput(Vec4<Real>, Varyings) -> VertexOutput<Real, Varyings>;

/// Varyings of a depth-only program: none.
template <class Real>
struct NoVaryings {};

/// Number of Reals in a struct of Reals.
template <class Struct, class Real>
inline constexpr std::size_t kRealCount = std::is_empty_v<Struct> ? 0 : sizeof(Struct) / sizeof(Real);

/// Runs the functor over vertices [first, first + count) of an interleaved buffer of floats.
template <class Real, class VertexFunctor>
void shade_vertices(const VertexFunctor& functor, std::span<const float> buffer, std::uint32_t first, std::uint32_t count,
                    Workers& workers, bool flush_denormals, VertexBlock<typename Real::Scalar>& out) {
    using Scalar = typename Real::Scalar;
    using Input = typename VertexFunctor::template Input<Real>;
    using Varyings = typename VertexFunctor::template Varyings<Real>;
    constexpr std::size_t kInputs = kRealCount<Input, Real>;
    constexpr std::size_t kVaryings = kRealCount<Varyings, Real>;
    constexpr std::uint32_t kPiece = 512;
    static_assert(kInputs > 0, "a vertex functor reads at least one number per vertex");
    static_assert(sizeof(Input) == kInputs * sizeof(Real));

    out.stride = kPositionScalars + static_cast<int>(kVaryings);
    out.scalars.resize(static_cast<std::size_t>(count) * static_cast<std::size_t>(out.stride));

    const auto shade_wave = [&](std::uint32_t begin) {
        // Fetch: one vertex per lane; lanes behind the end repeat the last vertex.
        std::array<std::array<Scalar, kLanes>, kInputs> fetched;
        for (std::uint32_t i = 0; i < kLanes; ++i) {
            const std::uint32_t vertex = first + std::min(begin + i, count - 1);
            const float* source = buffer.data() + static_cast<std::size_t>(vertex) * kInputs;
            for (std::size_t k = 0; k < kInputs; ++k) fetched[k][i] = static_cast<Scalar>(source[k]);
        }
        std::array<Real, kInputs> inputs;
        for (std::size_t k = 0; k < kInputs; ++k) inputs[k] = Real::load(fetched[k].data());

        const VertexContext<Real, Input> context{std::bit_cast<Input>(inputs)};
        const VertexOutput<Real, Varyings> result = functor(context);

        // Store one record per vertex.
        std::array<std::array<Scalar, kLanes>, std::size_t{kPositionScalars} + kVaryings> columns;
        result.position.x.store(columns[0].data());
        result.position.y.store(columns[1].data());
        result.position.z.store(columns[2].data());
        result.position.w.store(columns[3].data());
        if constexpr (kVaryings > 0) {
            const auto values = std::bit_cast<std::array<Real, kVaryings>>(result.varyings);
            for (std::size_t k = 0; k < kVaryings; ++k) values[k].store(columns[kPositionScalars + k].data());
        }
        for (std::uint32_t i = 0; i < std::min<std::uint32_t>(kLanes, count - begin); ++i) {
            Scalar* record = out.scalars.data() + static_cast<std::size_t>(begin + i) * columns.size();
            for (std::size_t k = 0; k < columns.size(); ++k) record[k] = columns[k][i];
        }
    };

    workers.for_each((count + kPiece - 1) / kPiece, [&](std::size_t piece) {
        const DenormalScope denormals(flush_denormals);
        const auto begin = static_cast<std::uint32_t>(piece) * kPiece;
        for (std::uint32_t v = begin; v < std::min(count, begin + kPiece); v += kLanes) shade_wave(v);
    });
}

}  // namespace gnomon
