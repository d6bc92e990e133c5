// D3D11.3 3.5.5: where centroid values are evaluated, with every sample count and sample mask.
#include "tests/oracle/interpolation.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Point;
using oracle::Random;
using oracle::SnappedTriangle;

TEST_CASE("centroid values are those of the first covered sample, or of the centre", "[raster][msaa][3.5.5]") {
    std::uint64_t at_centre = 0;
    std::uint64_t at_sample = 0;
    std::uint64_t masked_centre = 0;
    for (const int samples : oracle::kSampleCounts) {
        const oracle::TriangleTarget target{.pattern = oracle::standard_pattern(samples)};
        Canvas canvas(interpolation_program(), Profile{}, {.samples = samples});
        for (std::uint64_t seed = 0; seed < 160; ++seed) {
            Random random(seed);
            const std::uint32_t mask = random.chance(3) ? 0xffffffffu : random.bits();
            const SnappedTriangle t = oracle::random_triangle(random, oracle::kTriangleKinds[seed % 3], target);
            if (oracle::turn(t[0], t[1], t[2]) == 0) continue;
            // Attributes are the position in pixels: what comes out says where it was evaluated.
            std::vector<RasterVertex> vertices;
            std::array<float, 3> a;
            std::array<float, 3> b;
            for (std::size_t i = 0; i < 3; ++i) {
                RasterVertex v = vertex_at(t[i], target.rect());
                v.a = a[i] = static_cast<float>(t[i].x) / 256.0f;
                v.b = b[i] = static_cast<float>(t[i].y) / 256.0f;
                vertices.push_back(v);
            }
            canvas.clear(-1000.0f);
            Draw draw = canvas.draw_of(vertices);
            draw.output.sample_mask = mask;
            canvas.execute(draw);
            for (const auto& pixel : oracle::covered_pixels(oracle::coverage(t, target.rect(), target.pattern))) {
                const std::uint32_t left = pixel.mask & mask;
                if (left == 0) continue;
                const SampleAt at{.x = pixel.x, .y = pixel.y, .sample = std::countr_zero(left)};
                const Point p = oracle::centroid_point(pixel.x, pixel.y, pixel.mask, mask, target.pattern);
                const bool centre = p == oracle::pixel_center(pixel.x, pixel.y);
                ++(centre ? at_centre : at_sample);
                masked_centre += centre && left != pixel.mask;
                const std::array<float, 3> w{1, 1, 1};
                const auto check = [&](std::string_view what, const oracle::Rounded& bound, float got) {
                    if (!bound.allows(got))
                        FAIL(fmt::format(
                            "{} samples, mask {:#x}, seed {}, pixel ({}, {}) covered {:#x}: {} {:a}, expected {} +- {}",
                            samples, mask, seed, pixel.x, pixel.y, pixel.mask, what, got, static_cast<double>(bound.value),
                            static_cast<double>(bound.error)));
                };
                check("linear x", oracle::linear_bound(t, a, p), canvas.value(3, 1, at));
                check("linear y", oracle::linear_bound(t, b, p), canvas.value(3, 3, at));
                check("perspective x", oracle::perspective_bound(t, a, w, p), canvas.value(3, 0, at));
                check("perspective y", oracle::perspective_bound(t, b, w, p), canvas.value(3, 2, at));
            }
        }
    }
    CHECK(at_centre > 5000);
    CHECK(at_sample > 2000);
    CHECK(masked_centre > 500);
}
