// D3D11.3 17.17: the sample mask takes samples off the coverage of every primitive, with one sample per pixel as well.
#include "tests/oracle/coverage.h"
#include "tests/unit/output_programs.h"

#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

TEST_CASE("the sample mask lets through exactly its samples, in colour, depth and stencil", "[17.17][msaa]") {
    const std::vector<TestVertex> v{
        {-0.75f, 0.5f, 0.5f, 1, 1, 0}, {0.875f, 0.25f, 0.5f, 1, 1, 0}, {-0.25f, -0.875f, 0.5f, 1, 1, 0}};
    for (const int samples : {1, 2, 4, 8, 16}) {
        for (const std::uint32_t mask : {0u, 1u, 2u, 0x5555u, 0xaaaau, 0xffff0000u, 0xfffffffeu, 0x80008000u, 0xffffffffu}) {
            std::array<std::size_t, 2> drawn{};
            std::array<std::vector<bool>, 2> covered;
            for (const bool masked : {false, true}) {
                Canvas canvas(load_profile("d3d11"), 16, 16, samples);
                Draw draw = make_draw(id_program(), upload(canvas.device, v), 0, 3);
                draw.color[0] = canvas.target(Format::R32Float);
                draw.depth = canvas.target(Format::D32FloatS8);
                canvas.device.execute(ClearDepth{draw.depth, 1.0f});
                draw.stencil.test = true;
                draw.stencil.front.pass = draw.stencil.back.pass = StencilOp::Increment;
                if (masked) draw.output.sample_mask = mask;
                canvas.device.execute(draw);
                for (int s = 0; s < samples; ++s) {
                    for (std::size_t i = 0; i < canvas.pixels(); ++i) {
                        const bool is = canvas.value(draw.color[0].texture, i, 0, 0, s) == 1.0f;
                        REQUIRE(canvas.value(draw.depth.texture, i, 0, 0, s) == (is ? 0.5f : 1.0f));
                        REQUIRE(canvas.stencil(draw.depth.texture, i, 0, s) == (is ? 1 : 0));
                        const std::size_t at = static_cast<std::size_t>(s) * canvas.pixels() + i;
                        if (masked) REQUIRE(is == (covered[0][at] && (mask >> s & 1u) != 0));
                        covered[masked ? 1 : 0].push_back(is);
                        drawn[masked ? 1 : 0] += is ? 1u : 0u;
                    }
                }
            }
            CHECK(drawn[0] > 40 * static_cast<std::size_t>(samples));
        }
    }
}
