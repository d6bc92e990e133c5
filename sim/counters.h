// What a draw did, counted exactly. Off unless asked for.
#pragma once

#include "sim/fields.h"

#include <cstdint>

namespace gnomon {

struct Counters {
    std::uint64_t vertices = 0;              // vertex functor results (padding lanes not counted)
    std::uint64_t primitives_in = 0;         // triangles assembled
    std::uint64_t primitives_clipped = 0;    // of these, triangles that clipping cut
    std::uint64_t primitives_culled = 0;     // outside, facing away, or without area
    std::uint64_t triangles_set_up = 0;      // reached the rasteriser (after clipping)
    std::uint64_t tiles = 0;                 // (triangle, tile) pairs visited
    std::uint64_t blocks_rejected = 0;       // (triangle, 8x8 block) pairs that hierarchical depth dropped
    std::uint64_t samples_covered = 0;       // inside a triangle
    std::uint64_t samples_passed = 0;        // and passed the depth test
    std::uint64_t quads_early_killed = 0;    // all covered pixels failed early depth
    std::uint64_t quads_shaded = 0;          // ran the pixel functor
    std::uint64_t lanes_shaded = 0;          // of these quads, lanes that count
    std::uint64_t lanes_helper = 0;          // and lanes that only feed derivatives
    std::uint64_t texture_instructions = 0;  // per lane that counts
    std::uint64_t texture_probes = 0;        // per lane that counts: filtered positions, 1 unless anisotropic
    std::uint64_t texels_fetched = 0;        // per lane that counts
    std::uint64_t invalid_derivatives = 0;   // derivatives, per lane that counts, taken in a quad with a helper lane

    std::uint64_t compute_groups = 0;        // groups of dispatches that ran
    std::uint64_t compute_threads = 0;       // threads of these groups, idle ones in a narrower block included
    std::uint64_t buffer_bytes_read = 0;     // by compute threads that are active, inside the buffer; an atomic
    std::uint64_t buffer_bytes_written = 0;  // operation reads and writes its word
    std::uint64_t image_bytes_read = 0;      // likewise, inside the level
    std::uint64_t image_bytes_written = 0;

    static constexpr auto fields() {
        using C = Counters;
        return std::tuple{Field{"vertices", &C::vertices},
                          Field{"primitives_in", &C::primitives_in},
                          Field{"primitives_clipped", &C::primitives_clipped},
                          Field{"primitives_culled", &C::primitives_culled},
                          Field{"triangles_set_up", &C::triangles_set_up},
                          Field{"tiles", &C::tiles},
                          Field{"blocks_rejected", &C::blocks_rejected},
                          Field{"samples_covered", &C::samples_covered},
                          Field{"samples_passed", &C::samples_passed},
                          Field{"quads_early_killed", &C::quads_early_killed},
                          Field{"quads_shaded", &C::quads_shaded},
                          Field{"lanes_shaded", &C::lanes_shaded},
                          Field{"lanes_helper", &C::lanes_helper},
                          Field{"texture_instructions", &C::texture_instructions},
                          Field{"texture_probes", &C::texture_probes},
                          Field{"texels_fetched", &C::texels_fetched},
                          Field{"invalid_derivatives", &C::invalid_derivatives},
                          Field{"compute_groups", &C::compute_groups},
                          Field{"compute_threads", &C::compute_threads},
                          Field{"buffer_bytes_read", &C::buffer_bytes_read},
                          Field{"buffer_bytes_written", &C::buffer_bytes_written},
                          Field{"image_bytes_read", &C::image_bytes_read},
                          Field{"image_bytes_written", &C::image_bytes_written}};
    }

    Counters& operator+=(const Counters& other) {
        std::apply([&](const auto&... field) { ((this->*field.member += other.*field.member), ...); }, fields());
        return *this;
    }
    bool operator==(const Counters&) const = default;
};

}  // namespace gnomon
