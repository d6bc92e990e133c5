// What a pixel covers of a map: the parallelogram, its limit of anisotropy, the rectangle that holds it. D3D11.3 7.18.11
#include "techniques/common/pixel_footprint.h"

#include "tests/oracle/random.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

using namespace gnomon;
using namespace gnomon::techniques;

TEST_CASE("a pixel's rectangle holds its parallelogram, whose axes differ by the limit at most", "[techniques][footprint]") {
    oracle::Random random(1);
    int widened = 0;
    for (int i = 0; i < 20000; ++i) {
        const float scale = std::ldexp(1.0f, random.integer(-6, 8));
        const auto vector = [&] { return Vec2<Float>{random.in(-scale, scale), random.in(-scale, scale)}; };
        PixelFootprint<Float> before{vector(), vector()};
        if (i % 5 == 0) before.dy = Vec2<Float>{before.dx.x * Float(0.01f), before.dx.y * Float(0.01f)};  // no area
        if (i % 7 == 0) before.dx = Vec2<Float>{0.0f, 0.0f};
        const float limit = static_cast<float>(random.integer(1, 16));
        const auto after = with_anisotropy_limit(before, limit);
        const auto lengths = [](const PixelFootprint<Float>& f) {
            const auto length = [](const Vec2<Float>& v) { return std::hypot(lane(v.x, 0), lane(v.y, 0)); };
            const float x = length(f.dx);
            const float y = length(f.dy);
            return std::pair{std::min(x, y), std::max(x, y)};
        };
        const auto [short_before, long_before] = lengths(before);
        const auto [short_after, long_after] = lengths(after);
        REQUIRE(long_after >= long_before);
        REQUIRE(long_after <= long_before * (1 + 1e-6f));
        REQUIRE(short_after >= long_after / limit * (1 - 1e-6f));
        if (short_before > long_before / limit * (1 + 1e-6f)) {
            REQUIRE(short_after == short_before);
        } else {
            ++widened;
            REQUIRE(short_after <= long_after / limit * (1 + 1e-6f));
        }
        const Vec2<Float> centre{random.in(0.0f, 64.0f), random.in(0.0f, 64.0f)};
        const SideLimits limits{.least = 1.0f, .most = 4096.0f};
        const auto box = bounding_rectangle(after, centre, limits);
        for (const auto& footprint : {before, after})
            for (const float a : {-0.5f, 0.5f})
                for (const float b : {-0.5f, 0.5f}) {
                    const float slack = 1e-5f * (scale + 64.0f);
                    const float x = lane(centre.x + footprint.dx.x * Float(a) + footprint.dy.x * Float(b), 0);
                    const float y = lane(centre.y + footprint.dx.y * Float(a) + footprint.dy.y * Float(b), 0);
                    REQUIRE((x >= lane(box.low.x, 0) - slack && x <= lane(box.high.x, 0) + slack));
                    REQUIRE((y >= lane(box.low.y, 0) - slack && y <= lane(box.high.y, 0) + slack));
                }
        REQUIRE(lane(box.high.x - box.low.x, 0) >= 1.0f - 1e-5f);
        REQUIRE(lane(box.high.y - box.low.y, 0) >= 1.0f - 1e-5f);
        const auto inside = clamped_to(box, {64, 64});
        REQUIRE((lane(inside.low.x, 0) >= 0.0f && lane(inside.high.x, 0) <= 64.0f));
        REQUIRE((lane(inside.low.y, 0) >= 0.0f && lane(inside.high.y, 0) <= 64.0f));
        REQUIRE(lane(area(inside), 0) >= 0.25f - 1e-5f);
    }
    CHECK(widened > 1000);
}

TEST_CASE("rectangles of what is not a number are finite and inside the map", "[techniques][footprint]") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const std::array values{nan, infinity, -infinity, 0.0f, 1e38f, -3.0f};
    for (const float a : values)
        for (const float b : values)
            for (const float c : values) {
                const PixelFootprint<Float> footprint{{a, b}, {c, a}};
                const auto limited = with_anisotropy_limit(footprint, 4.0f);
                const auto box = clamped_to(bounding_rectangle(limited, Vec2<Float>{b, c}, {}), {5, 3});
                REQUIRE((lane(box.low.x, 0) >= 0.0f && lane(box.high.x, 0) <= 5.0f));
                REQUIRE((lane(box.low.y, 0) >= 0.0f && lane(box.high.y, 0) <= 3.0f));
                REQUIRE(lane(box.high.x - box.low.x, 0) >= 0.5f);
                REQUIRE(lane(box.high.y - box.low.y, 0) >= 0.5f);
            }
}
