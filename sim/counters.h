// What a draw did, counted exactly. Off unless asked for. No count depends on the number of threads or on the SIMD width.
#pragma once

#include "sim/fields.h"

#include <cstdint>

namespace gnomon {

struct Counters {
    // Geometry.
    // Distinct vertices that the primitives of a draw refer to, once per instance: what the vertex functor runs for behind a
    // cache of results without limit. Counts nothing of the windows in which Gnomon shades them.
    std::uint64_t vertices = 0;
    std::uint64_t primitives_in = 0;       // points, lines and triangles assembled
    std::uint64_t primitives_clipped = 0;  // of these, those that clipping cut
    std::uint64_t primitives_culled = 0;   // outside, facing away, without area, or between all samples
    std::uint64_t primitives_drawn = 0;    // reached the rasteriser
    // Rasteriser.
    std::uint64_t tiles = 0;            // (piece of a primitive, tile) pairs visited
    std::uint64_t blocks_rejected = 0;  // (piece, 8x8 block) pairs that hierarchical depth drops; the rest is as if it did not
    std::uint64_t quads_covered = 0;    // with at least one sample inside
    std::uint64_t samples_covered = 0;  // inside a primitive, after scissor and sample mask
    // Depth and stencil.
    std::uint64_t samples_depth_tested = 0;
    std::uint64_t samples_stencil_tested = 0;
    std::uint64_t samples_passed = 0;      // were written, or would be if there were a target
    std::uint64_t quads_early_killed = 0;  // dropped before the pixel functor as no sample of theirs passed
    // Pixel functor.
    std::uint64_t quads_shaded = 0;          // ran the pixel functor; once per sample where it runs for each
    std::uint64_t values_interpolated = 0;   // varyings, per quad and run
    std::uint64_t lanes_shaded = 0;          // of these quads, lanes that count
    std::uint64_t lanes_helper = 0;          // and lanes that only feed derivatives
    std::uint64_t lanes_discarded = 0;       // lanes that counted until the functor discarded them
    std::uint64_t texture_instructions = 0;  // per lane that counts
    std::uint64_t texture_probes = 0;        // per lane that counts: filtered positions, 1 unless anisotropic
    std::uint64_t texels_fetched = 0;        // per lane that counts
    // Derivatives, explicit ones and those of implicit levels of detail, per lane that counts. derivatives.h
    std::uint64_t derivatives = 0;
    std::uint64_t derivatives_helper = 0;    // of these, that read a lane outside the primitive (or the sample at hand)
    std::uint64_t derivatives_killed = 0;    // that read a lane that was discarded before
    std::uint64_t derivatives_inactive = 0;  // that read a lane outside the branch
    std::uint64_t invalid_derivatives = 0;   // with any of the three
    // Output merger.
    std::uint64_t samples_blended = 0;  // read, blended and written, per target
    std::uint64_t samples_written = 0;  // colours, per target
    std::uint64_t samples_resolved = 0;
    // Memory: what the stages ask for, before any cache. traffic.h has it by resource.
    std::uint64_t bytes_read = 0;
    std::uint64_t bytes_written = 0;

    // Compute.
    std::uint64_t compute_groups = 0;   // groups of dispatches that ran
    std::uint64_t compute_threads = 0;  // threads of these groups, idle ones in a narrower block included

    static constexpr auto fields() {
        using C = Counters;
        return std::tuple{Field{"vertices", &C::vertices},
                          Field{"primitives_in", &C::primitives_in},
                          Field{"primitives_clipped", &C::primitives_clipped},
                          Field{"primitives_culled", &C::primitives_culled},
                          Field{"primitives_drawn", &C::primitives_drawn},
                          Field{"tiles", &C::tiles},
                          Field{"blocks_rejected", &C::blocks_rejected},
                          Field{"quads_covered", &C::quads_covered},
                          Field{"samples_covered", &C::samples_covered},
                          Field{"samples_depth_tested", &C::samples_depth_tested},
                          Field{"samples_stencil_tested", &C::samples_stencil_tested},
                          Field{"samples_passed", &C::samples_passed},
                          Field{"quads_early_killed", &C::quads_early_killed},
                          Field{"quads_shaded", &C::quads_shaded},
                          Field{"values_interpolated", &C::values_interpolated},
                          Field{"lanes_shaded", &C::lanes_shaded},
                          Field{"lanes_helper", &C::lanes_helper},
                          Field{"lanes_discarded", &C::lanes_discarded},
                          Field{"texture_instructions", &C::texture_instructions},
                          Field{"texture_probes", &C::texture_probes},
                          Field{"texels_fetched", &C::texels_fetched},
                          Field{"derivatives", &C::derivatives},
                          Field{"derivatives_helper", &C::derivatives_helper},
                          Field{"derivatives_killed", &C::derivatives_killed},
                          Field{"derivatives_inactive", &C::derivatives_inactive},
                          Field{"invalid_derivatives", &C::invalid_derivatives},
                          Field{"samples_blended", &C::samples_blended},
                          Field{"samples_written", &C::samples_written},
                          Field{"samples_resolved", &C::samples_resolved},
                          Field{"bytes_read", &C::bytes_read},
                          Field{"bytes_written", &C::bytes_written},
                          Field{"compute_groups", &C::compute_groups},
                          Field{"compute_threads", &C::compute_threads}};
    }

    Counters& operator+=(const Counters& other) {
        std::apply([&](const auto&... field) { ((this->*field.member += other.*field.member), ...); }, fields());
        return *this;
    }
    bool operator==(const Counters&) const = default;
};

}  // namespace gnomon
