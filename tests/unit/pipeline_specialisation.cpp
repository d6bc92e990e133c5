// A draw runs only the stages that its state needs, as the counters say; and what it holds on to between calls is bounded.
#include "pipeline/draw.h"
#include "tests/unit/output_programs.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// Counters that are not 0, by name.
std::vector<std::string_view> busy(const Counters& counters) {
    std::vector<std::string_view> names;
    for_each_field(counters, [&](std::string_view name, std::uint64_t count) {
        if (count != 0) names.push_back(name);
    });
    return names;
}

Counters count(Canvas& canvas, const Draw& draw) {
    canvas.device.enable_counters(true);
    canvas.device.execute(draw);
    return canvas.device.take_counters();
}

using Names = std::vector<std::string_view>;

}  // namespace

TEST_CASE("a depth-only pass shades, interpolates, blends and writes no colour", "[specialisation][counters]") {
    for (const int samples : {1, 4}) {
        Canvas canvas(load_profile("d3d11"), 32, 32, samples);
        const TextureId depth = canvas.target(Format::D32Float);
        canvas.device.execute(ClearDepth{depth, 1.0f});
        // The program has varyings; nobody asks for them.
        Draw draw = canvas.everything(depth_only_program(), 0.5f);
        draw.depth = depth;
        CHECK(busy(count(canvas, draw)) == Names{"vertices", "primitives_in", "primitives_drawn", "tiles", "quads_covered",
                                                 "samples_covered", "samples_depth_tested", "samples_passed", "bytes_read",
                                                 "bytes_written"});
        // The same with a colour target that the state masks off.
        Draw masked = canvas.everything(image_program(1), 0.25f,
                                        {canvas.image(Image(canvas.pixels())), canvas.image(Image(canvas.pixels()))});
        masked.color[0] = canvas.target(Format::Rgba8Unorm);
        masked.output.blend[0] = {.enable = true, .write_mask = 0};
        masked.depth = depth;
        const Counters counters = count(canvas, masked);
        CHECK(counters.samples_written == 0);
        CHECK(counters.samples_blended == 0);
        CHECK(counters.quads_shaded > 0);
    }
}

TEST_CASE("a pass without depth, stencil, blending and several samples runs none of them", "[specialisation][counters]") {
    Canvas canvas(load_profile("d3d11"), 32, 32);
    Draw draw = canvas.everything(id_program(), 0.5f);
    draw.pixel_constants = pixel_constants(id_program());
    draw.color[0] = canvas.target(Format::R32Float);
    // States of stages that are off say nothing.
    draw.stencil.front.pass = StencilOp::Increment;
    const Counters counters = count(canvas, draw);
    CHECK(busy(counters) == Names{"vertices", "primitives_in", "primitives_drawn", "tiles", "quads_covered", "samples_covered",
                                  "samples_passed", "quads_shaded", "values_interpolated", "lanes_shaded", "lanes_helper",
                                  "samples_written", "bytes_read", "bytes_written"});
    CHECK(counters.samples_covered == 32 * 32);
    CHECK(counters.samples_written == 32 * 32);
    // A depth buffer that is bound and not used is not read.
    draw.depth = canvas.target(Format::D24UnormS8);
    draw.depth_state.test = false;
    canvas.device.enable_counters(true);
    canvas.device.execute(draw);
    const Tally tally = canvas.device.take_tally();
    CHECK(tally.counters.samples_depth_tested == 0);
    CHECK(tally.counters.samples_stencil_tested == 0);
    CHECK(tally.of(draw.depth.texture) == Bytes{});
}

TEST_CASE("a shader without derivatives takes none, and one run per pixel is one run", "[specialisation][counters][msaa]") {
    for (const int samples : {1, 2, 4, 8, 16}) {
        Canvas canvas(load_profile("d3d11"), 32, 32, samples);
        const ImageConstants images{canvas.image(Image(canvas.pixels())), canvas.image(Image(canvas.pixels()))};
        Draw draw = canvas.everything(image_program(1), 0.5f, images);
        draw.color[0] = canvas.target(Format::R32Float);
        const Counters by_pixel = count(canvas, draw);
        CHECK(by_pixel.derivatives == 0);
        CHECK(by_pixel.invalid_derivatives == 0);
        CHECK(by_pixel.samples_written == 1024u * static_cast<unsigned>(samples));
        draw.program = &image_program(1, kPerSample);
        const Counters by_sample = count(canvas, draw);
        CHECK(by_sample.lanes_shaded == 1024u * static_cast<unsigned>(samples));
        CHECK(by_sample.samples_written == by_pixel.samples_written);
        // Pixels along the diagonal are shaded for both triangles, no others twice.
        CHECK(by_pixel.lanes_shaded >= 1024);
        CHECK(by_pixel.lanes_shaded <= 1024 + 32);
    }
}

TEST_CASE("a functor that discards is tested before it runs, and each sample once", "[specialisation][counters][16.12]") {
    Canvas canvas(load_profile("d3d11"), 32, 32);
    const TextureId depth = canvas.target(Format::D32Float);
    canvas.device.execute(ClearDepth{depth, 1.0f});
    Draw near = canvas.rectangle(depth_only_program(), {0, 0, 16, 32}, 0.25f);
    near.depth = depth;
    canvas.device.execute(near);
    Image control(canvas.pixels());
    for (std::size_t i = 0; i < control.size(); ++i) control[i].x = i % 4 == 3 ? 1.0f : 0.0f;
    Draw draw =
        canvas.everything(image_program(1, kDiscards), 0.5f, {canvas.image(Image(canvas.pixels())), canvas.image(control)});
    draw.color[0] = canvas.target(Format::R32Float);
    draw.depth = depth;
    canvas.device.enable_counters(true);
    canvas.device.execute(draw);
    const Tally tally = canvas.device.take_tally();
    // The left half is dropped block by block, the right half is tested, shaded, and written where it stays.
    CHECK(tally.counters.blocks_rejected > 0);
    CHECK(tally.counters.samples_depth_tested == tally.counters.samples_covered);
    CHECK(tally.counters.lanes_shaded == 512);
    CHECK(tally.counters.lanes_discarded == 128);
    CHECK(tally.counters.samples_passed == 384);
    CHECK(tally.of(depth).written == 384 * 4);
    CHECK(tally.of(depth).read == tally.counters.samples_depth_tested * 4);
}

TEST_CASE("what draws hold on to does not grow with triangles, resolution or samples beyond a bound",
          "[specialisation][memory]") {
    // Many triangles of about four pixels, strewn by their number.
    const auto scratch = [](std::uint32_t triangles, int size, int samples) {
        Canvas canvas(load_profile("d3d11"), size, size, samples, 2);
        std::vector<TestVertex> v;
        v.reserve(std::size_t{triangles} * 3);
        for (std::uint32_t i = 0; i < triangles; ++i) {
            const float x = static_cast<float>(i * 7919u % 8191u) / 4096.0f - 1.0f;
            const float y = static_cast<float>(i * 104729u % 8191u) / 4096.0f - 1.0f;
            const float side = 5.0f / static_cast<float>(size);
            v.push_back({x, y, 0.5f, 1, 0, 0});
            v.push_back({x + side, y, 0.5f, 1, 0, 0});
            v.push_back({x, y + side, 0.5f, 1, 0, 0});
        }
        Draw draw = make_draw(depth_only_program(), upload(canvas.device, v), 0, triangles * 3);
        draw.depth = canvas.target(Format::D32Float);
        const std::size_t before = canvas.device.scratch_bytes();
        canvas.device.execute(draw);
        CHECK(before < 4096);
        return canvas.device.scratch_bytes();
    };
    const std::size_t few = scratch(10'000, 256, 1);
    const std::size_t full = scratch(70'000, 256, 1);
    const std::size_t many = scratch(400'000, 256, 1);
    INFO(few << " bytes for 10k triangles, " << full << " for 70k, " << many << " for 400k");
    CHECK(few > 10'000 * sizeof(Primitive<float>));
    // Vertices are held for one window of primitives: at most 2^18, 6 floats and where they lie on the screen. Pieces are held
    // for one batch of 2^15. Both vectors may have grown to twice what they hold.
    const std::size_t per_vertex = 6 * sizeof(float) + sizeof(ScreenVertex<float>) + sizeof(std::uint32_t);
    const std::size_t per_piece = sizeof(Primitive<float>) + 4 * sizeof(std::uint64_t);
    const std::size_t bound = 2 * ((1u << 18u) * per_vertex + (1u << 15u) * per_piece);
    CHECK(full < bound);
    CHECK(many < bound);
    CHECK(many < few * 4);
    // Resolution and samples: lists per tile, nothing per pixel.
    const std::size_t small = scratch(10'000, 64, 1);
    const std::size_t large = scratch(10'000, 2048, 1);
    const std::size_t sampled = scratch(10'000, 256, 16);
    INFO(small << " bytes at 64x64, " << large << " at 2048x2048, " << sampled << " with 16 samples");
    CHECK(large < small * 2);
    CHECK(sampled < few * 2);
}

TEST_CASE("indices, restarts and clipping hold on to no more for a long draw than for a short one",
          "[specialisation][memory]") {
    // Strips of a few triangles over strewn vertices, all of them cut by the near plane, solid and in wireframe.
    const auto scratch = [](std::uint32_t triangles, FillMode fill) {
        Canvas canvas(load_profile("d3d11"), 512, 512, 1, 2);
        constexpr std::uint32_t kVertices = 5000;
        std::vector<TestVertex> v;
        for (std::uint32_t i = 0; i < kVertices; ++i) {
            const float x = static_cast<float>(i * 7919u % 8191u) / 4096.0f - 1.0f;
            const float y = static_cast<float>(i * 104729u % 8191u) / 4096.0f - 1.0f;
            v.push_back({x * 0.1f, y * 0.1f, i % 2 == 0 ? -0.25f : 0.5f, 1, 0, 0});
        }
        std::vector<std::uint32_t> indices;
        for (std::uint32_t made = 0; made < triangles; made += 4) {
            for (std::uint32_t i = 0; i < 6; ++i) indices.push_back((made * 31u + i) % kVertices);
            indices.push_back(0xffffffffu);
        }
        Draw draw = make_draw(depth_only_program(), upload(canvas.device, v), 0, static_cast<std::uint32_t>(indices.size()));
        draw.indices = canvas.device.create_buffer("indices", std::as_bytes(std::span(indices)));
        draw.topology = Topology::TriangleStrip;
        draw.primitive_restart = true;
        draw.raster.fill = fill;
        draw.depth = canvas.target(Format::D32Float);
        canvas.device.enable_counters(true);
        canvas.device.execute(draw);
        const Counters counters = canvas.device.take_counters();
        CHECK(counters.primitives_in == triangles);
        CHECK(counters.primitives_clipped == triangles);
        return std::pair{canvas.device.scratch_bytes(), counters.primitives_drawn};
    };
    for (const FillMode fill : {FillMode::Solid, FillMode::Wireframe}) {
        // Both end with a whole batch.
        const auto [some, drawn] = scratch(1u << 15u, fill);
        const auto [many, drawn_of_many] = scratch(20u << 15u, fill);
        INFO(some << " bytes for one batch, " << many << " for twenty");
        // What clipping made is part of it: three vertices or more, of six floats.
        CHECK(drawn > 1u << 14u);
        CHECK(drawn_of_many > drawn);
        CHECK(some > drawn * (sizeof(Primitive<float>) + 3 * 6 * sizeof(float)));
        // Vectors may have grown for a batch with more to keep; 8 bytes per primitive would be 5 MB.
        CHECK(many < some + some / 4);
    }
}
