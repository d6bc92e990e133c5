// D3D11.3 3.4.1: vertex positions snap to 1/256 pixel, nearest even, after the viewport and before culling.
#include "tests/oracle/raster.h"
#include "tests/unit/pipeline_programs.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// Whether pixel (0, 0) of a 2x2 target is covered by the half-plane right of x_px (a left edge through x_px, vertical).
bool covered_right_of(float x_px, const Profile& profile) {
    Device device(profile, 1);
    const TextureId target = device.create_texture("ids", {.format = Format::R32Float, .width = 2, .height = 2});
    device.execute(ClearColor{target, glm::vec4(0.0f)});
    const float x = x_px - 1.0f;  // width 2: ndc = px - 1, exact
    const std::vector<TestVertex> v{{x, 9, 0, 1, 1, 0}, {x + 16, 9, 0, 1, 1, 0}, {x, -9, 0, 1, 1, 0}};
    Draw draw = make_draw(id_program(), upload(device, v), 0, 3);
    draw.color[0] = target;
    device.execute(draw);
    return floats_of(device.texture(target))[0] == 1.0f;
}

}  // namespace

TEST_CASE("positions snap to the nearest 1/256, ties to even", "[3.4.1]") {
    const Profile d3d11;
    // The centre is at 128/256; a vertical left edge on it still covers.
    for (int k = 120 * 16; k <= 136 * 16; ++k) {
        const float x = static_cast<float>(k) / 4096.0f;
        int snapped = k / 16;
        const int rest = k % 16;
        if (rest > 8 || (rest == 8 && snapped % 2 != 0)) ++snapped;
        INFO("x = " << k << "/4096 snaps to " << snapped << "/256");
        REQUIRE(covered_right_of(x, d3d11) == (snapped <= 128));
    }
    // 128.5/256 ties to 128 (covered), 127.5 to 128.
    CHECK(covered_right_of(128.5f / 256.0f, d3d11));
    CHECK_FALSE(covered_right_of(128.5f / 256.0f + 0x1p-20f, d3d11));
}

TEST_CASE("a profile with fewer sub-pixel bits snaps to its coarser grid", "[3.4.1]") {
    for (const int bits : {1, 2, 4}) {
        Profile profile;
        profile.raster_subpixel_bits = bits;
        const int steps = 1 << bits;
        for (int k = 0; k <= 64; ++k) {
            const float x = static_cast<float>(k) / 64.0f;
            const double scaled = static_cast<double>(x) * steps;
            double snapped = std::floor(scaled);
            if (scaled - snapped > 0.5 || (scaled - snapped == 0.5 && std::fmod(snapped, 2.0) != 0)) snapped += 1;
            INFO(bits << " bits, x " << x);
            REQUIRE(covered_right_of(x, profile) == (snapped / steps <= 0.5));
        }
    }
}

TEST_CASE("a triangle that snaps to nothing is culled, one that snaps open is drawn", "[3.4.1][15.11]") {
    Device device(Profile{}, 1);
    const TextureId target = device.create_texture("ids", {.format = Format::R32Float, .width = 2, .height = 2});
    const auto count = [&](const std::vector<TestVertex>& v) {
        Draw draw = make_draw(id_program(), upload(device, v), 0, 3);
        draw.color[0] = target;
        device.enable_counters(true);
        device.execute(draw);
        return device.take_counters();
    };
    // Left edges run through the centres of pixels (0, 0) and (0, 1), so that only the area can be the reason to drop one.
    // Less than half a step wide: no area after the snap.
    CHECK(count({{-0.5f, 0.9f, 0, 1, 1, 0}, {-0.499f, 0.9f, 0, 1, 1, 0}, {-0.5f, -0.9f, 0, 1, 1, 0}}).primitives_culled == 1);
    CHECK(count({{-0.5f, 0.9f, 0, 1, 1, 0}, {-0.501f, 0, 0, 1, 1, 0}, {-0.5f, -0.9f, 0, 1, 1, 0}}).primitives_culled == 1);
    // Three quarters of a step become one.
    const Counters open = count({{-0.5f, 0.9f, 0, 1, 1, 0}, {-0.497f, 0.9f, 0, 1, 1, 0}, {-0.5f, -0.9f, 0, 1, 1, 0}});
    CHECK(open.primitives_drawn == 1);
    CHECK(open.samples_covered == 2);
}
