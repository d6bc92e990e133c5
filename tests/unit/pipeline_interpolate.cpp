// Attributes, derivatives and targets. D3D11.3 15.5, 15.16.2, 22.5, 17.1
#include "tests/oracle/random.h"
#include "tests/oracle/raster.h"
#include "tests/unit/pipeline_programs.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Point;
using oracle::Random;

namespace {

struct Inspected {
    int width, height;
    std::array<std::vector<float>, 3> targets;  // rgba32f each
    Counters counters;

    [[nodiscard]] const float* at(std::size_t target, int x, int y) const {
        return targets[target].data() + 4 * static_cast<std::size_t>(y * width + x);
    }
};

constexpr float kUntouched = -77.0f;

Inspected inspect(const std::vector<TestVertex>& vertices, int width, int height, const Profile& profile = {}) {
    Device device(profile, 1);
    Draw draw = make_draw(inspect_program(), upload(device, vertices), 0, static_cast<std::uint32_t>(vertices.size()));
    for (std::size_t i = 0; i < 3; ++i) {
        draw.color[i] = device.create_texture("target", {.format = Format::Rgba32Float, .width = width, .height = height});
        device.execute(ClearColor{draw.color[i].texture, glm::vec4(kUntouched)});
    }
    device.enable_counters(true);
    device.execute(draw);
    Inspected out{width, height, {}, device.take_counters()};
    for (std::size_t i = 0; i < 3; ++i) out.targets[i] = floats_of(device.texture(draw.color[i].texture));
    return out;
}

}  // namespace

TEST_CASE("a linear attribute has the same derivative in every pixel, edges included", "[raster][22.5]") {
    // a = x/64 and b = y/32 on the screen: every step of the interpolation is exact, so the derivative is exact everywhere,
    // also where three of the four lanes of a quad are helpers outside the triangle.
    const auto vertex = [](float px, float py) {
        return TestVertex{px / 32.0f - 1.0f, 1.0f - py / 32.0f, 0.5f, 1.0f, px / 64.0f, py / 32.0f};
    };
    const std::vector<std::array<std::array<float, 2>, 3>> triangles{
        {{{0, 0}, {64, 0}, {0, 64}}},     {{{64, 64}, {0, 64}, {64, 0}}}, {{{3, 5}, {35, 5}, {3, 21}}},
        {{{10, 10}, {12, 10}, {10, 12}}}, {{{1, 1}, {3, 1}, {1, 33}}},    {{{5, 7}, {37, 7}, {21, 23}}}};
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        std::vector<TestVertex> v;
        for (const auto& p : triangles[t]) v.push_back(vertex(p[0], p[1]));
        const Inspected out = inspect(v, 64, 64);
        int covered = 0;
        int lonely = 0;  // covered pixels whose quad has helpers
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                const float* c = out.at(1, x, y);
                if (c[0] == kUntouched) continue;
                ++covered;
                for (const auto& [nx, ny] : {std::pair{x ^ 1, y}, std::pair{x, y ^ 1}})
                    lonely += out.at(1, nx, ny)[0] == kUntouched;
                const float* fine = out.at(2, x, y);
                INFO("triangle " << t << " pixel (" << x << ", " << y << ")");
                REQUIRE(c[0] == (static_cast<float>(x) + 0.5f) / 64.0f);
                REQUIRE(c[1] == (static_cast<float>(y) + 0.5f) / 32.0f);
                REQUIRE(c[2] == 1.0f / 64.0f);  // ddx(a)
                REQUIRE(c[3] == 0.0f);          // ddy(a)
                REQUIRE(fine[0] == 1.0f / 64.0f);
                REQUIRE(fine[1] == 0.0f);
                const float* position = out.at(0, x, y);
                REQUIRE(position[0] == static_cast<float>(x) + 0.5f);
                REQUIRE(position[1] == static_cast<float>(y) + 0.5f);
                REQUIRE(position[2] == 0.5f);
                REQUIRE(position[3] == 1.0f);
            }
        CHECK(covered > 0);
        CHECK(lonely > 0);
    }
}

TEST_CASE("attributes are perspective correct within a bound", "[raster][15.5]") {
    // u = 2^-24. The offsets dx, dy are exact. Each product and sum below rounds once; with L = |dx l_dx| + |dy l_dy| over both
    // barycentrics, a linear barycentric errs by 3uL (coefficient, product, sum) and the plane coefficients by u each, so 1/w
    // errs by about 8u L max(1/w) and the attribute by its share of that, times its range. 16 leaves room for second order and
    // for 1/w at the vertices; clip-space positions are exact here.
    std::uint64_t pixels = 0;
    double worst = 0;
    for (const std::string name : {"d3d11", "ideal"}) {
        const Profile profile = load_profile(name);
        const long double unit = name == "ideal" ? 0x1p-53L : 0x1p-24L;
        for (std::uint64_t seed = 0; seed < 1500; ++seed) {
            Random random(seed);
            constexpr int kSize = 32;
            std::array<Point, 3> p;
            std::vector<TestVertex> v;
            for (auto& point : p) {
                const std::int64_t reach = seed % 3 == 0 ? 200 : 8;
                point = {random.between(-reach * 256, (kSize + reach) * 256),
                         random.between(-reach * 256, (kSize + reach) * 256)};
                const float w = std::ldexp(1.0f + static_cast<float>(random.integer(0, 255)) / 256.0f, random.integer(-3, 3));
                const float x = static_cast<float>(point.x) / 4096.0f - 1.0f;
                const float y = 1.0f - static_cast<float>(point.y) / 4096.0f;
                v.push_back({x * w, y * w, 0.5f * w, w, random.in(-1.0f, 1.0f), random.in(0.0f, 100.0f)});
                // w has 9 bits and x at most 24 - so x * w may round; accept only exact cases.
                if (static_cast<double>(x) * static_cast<double>(w) != static_cast<double>(x * w) ||
                    static_cast<double>(y) * static_cast<double>(w) != static_cast<double>(y * w))
                    v.back().w = -1.0f;
            }
            if (v[0].w < 0 || v[1].w < 0 || v[2].w < 0) continue;
            const auto area = static_cast<long double>(oracle::turn(p[0], p[1], p[2]));
            if (area == 0) continue;
            const Inspected out = inspect(v, kSize, kSize, profile);
            for (int y = 0; y < kSize; ++y)
                for (int x = 0; x < kSize; ++x) {
                    const bool covered = oracle::covers_pixel(p, x, y);
                    const float* c = out.at(1, x, y);
                    if (covered != (c[0] != kUntouched))
                        FAIL(fmt::format("{} seed {} pixel ({}, {}): coverage", name, seed, x, y));
                    if (!covered) continue;
                    ++pixels;
                    const Point s{x * 256 + 128, y * 256 + 128};
                    const std::array<long double, 3> l{static_cast<long double>(oracle::turn(p[1], p[2], s)) / area,
                                                       static_cast<long double>(oracle::turn(p[2], p[0], s)) / area,
                                                       static_cast<long double>(oracle::turn(p[0], p[1], s)) / area};
                    long double inv_w = 0, a = 0, b = 0, max_inv_w = 0;
                    for (std::size_t i = 0; i < 3; ++i) {
                        const long double share = l[i] / static_cast<long double>(v[i].w);
                        inv_w += share;
                        a += share * static_cast<long double>(v[i].a);
                        b += share * static_cast<long double>(v[i].b);
                        max_inv_w = std::max(max_inv_w, 1 / static_cast<long double>(v[i].w));
                    }
                    // L, from the offset to vertex 0 and the gradients of the barycentrics.
                    const long double dx = std::fabs(static_cast<long double>(s.x - p[0].x));
                    const long double dy = std::fabs(static_cast<long double>(s.y - p[0].y));
                    const auto size = [&](const Point& q, const Point& r) {
                        return (dx * std::fabs(static_cast<long double>(q.y - r.y)) +
                                dy * std::fabs(static_cast<long double>(q.x - r.x))) /
                               std::fabs(area);
                    };
                    const long double sum = 1 + size(p[2], p[0]) + size(p[0], p[1]);
                    const long double relative = 16 * unit * sum * max_inv_w / inv_w;
                    const auto check = [&](float got, long double exact, long double scale, const char* what) {
                        // fp32 targets add half a unit of their own.
                        const long double bound = relative * scale + std::fabs(exact) * 0x1p-24L;
                        const long double error = std::fabs(static_cast<long double>(got) - exact);
                        if (name == "d3d11") worst = std::max(worst, static_cast<double>(error / bound));
                        if (!(error <= bound))
                            FAIL(fmt::format("{} seed {} pixel ({}, {}) {}: {:a}, exact {:a}, error {:.3g} above {:.3g}", name,
                                             seed, x, y, what, got, static_cast<double>(exact), static_cast<double>(error),
                                             static_cast<double>(bound)));
                    };
                    check(c[0], a / inv_w, 2, "a");
                    check(c[1], b / inv_w, 100, "b");
                    check(out.at(0, x, y)[3], 1 / inv_w, 1 / inv_w, "w");
                }
        }
    }
    CHECK(pixels > 20000);
    CHECK(worst > 0.001);  // the bound says something
    INFO("worst share of the bound: " << worst);
    SUCCEED();
}

TEST_CASE("a ground plane under the camera keeps its attributes after the near clip", "[raster][15.5][15.4]") {
    // A plane 1 m below the eye that starts behind it and reaches to 500 m: what is left of it has vertices on the near plane
    // at 0.1 m. w of every pixel is known from its row: w = 1 / |ndc_y| for a vertical field of view of 90 degrees.
    constexpr float kNear = 0.1f;
    constexpr float kFar = 1000.0f;
    const auto vertex = [&](float x, float distance) {
        return TestVertex{x, -1.0f, (distance - kNear) * kFar / (kFar - kNear), distance, x, distance};
    };
    const std::array<TestVertex, 4> c{vertex(-300, -500), vertex(300, -500), vertex(300, 500), vertex(-300, 500)};
    const Inspected out = inspect({c[0], c[1], c[2], c[0], c[2], c[3]}, 128, 128);
    double worst_w = 0;
    double worst_distance = 0;
    int pixels = 0;
    for (int y = 66; y < 128; ++y)
        for (int x = 0; x < 128; ++x) {
            const float* attributes = out.at(1, x, y);
            if (attributes[0] == kUntouched) continue;
            ++pixels;
            const double exact = 1.0 / ((y + 0.5) / 64 - 1);
            worst_w = std::max(worst_w, std::fabs(static_cast<double>(out.at(0, x, y)[3]) / exact - 1));
            worst_distance = std::max(worst_distance, std::fabs(static_cast<double>(attributes[1]) / exact - 1));
        }
    INFO("worst relative errors: w " << worst_w << ", distance " << worst_distance);
    CHECK(pixels == 62 * 128);
    // Snapping moves vertices by 1/512 pixel, far away: (1/512) / 2.5 rows at most here, 8e-4; rounding should stay below that.
    CHECK(worst_w < 1e-3);
    CHECK(worst_distance < 1e-3);
}

TEST_CASE("rounding of 1/w stays small behind the near plane", "[raster][15.5][15.4]") {
    // The same plane under both arithmetics: snapping is common to both, so the difference is rounding alone. Inside a
    // triangle 1/w is a mean of the vertices' with weights >= 0: nothing needs to cancel, and a relative error of some tens of
    // units (2^-24) is all there should be. Clipped vertices may land one grid step apart: 1/256 of the 2.5 rows that the
    // farthest pixels here lie below the horizon, times the share of the far end: 1e-4 leaves room for both.
    const auto vertex = [&](float x, float distance) {
        return TestVertex{x, -1.0f, (distance - 0.1f) * 1000.0f / 999.9f, distance, x, distance};
    };
    const std::array<TestVertex, 4> c{vertex(-300, -500), vertex(300, -500), vertex(300, 500), vertex(-300, 500)};
    for (int turn = 0; turn < 4; ++turn) {
        std::vector<TestVertex> v;
        for (const int i : {0, 1, 2, 0, 2, 3}) v.push_back(c[static_cast<std::size_t>((i + turn) % 4)]);
        const Inspected fp32 = inspect(v, 256, 256);
        const Inspected fp64 = inspect(v, 256, 256, load_profile("ideal"));
        double worst = 0;
        int row = 0;
        for (int y = 130; y < 256; ++y)
            for (int x = 0; x < 256; ++x) {
                if (fp32.at(1, x, y)[0] == kUntouched || fp64.at(1, x, y)[0] == kUntouched) continue;
                const double error =
                    std::fabs(static_cast<double>(fp32.at(0, x, y)[3]) / static_cast<double>(fp64.at(0, x, y)[3]) - 1);
                if (!(error <= worst)) {
                    worst = error;
                    row = y;
                }
            }
        INFO("turn " << turn << ": w is off by " << worst << " in row " << row);
        CHECK(worst > 0);
        CHECK(worst < 1e-4);
    }
}

TEST_CASE("equal attributes at the vertices stay equal in every pixel", "[raster]") {
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        Random random(seed);
        const float a = random.in(-1000.0f, 1000.0f);
        std::vector<TestVertex> v;
        for (int i = 0; i < 3; ++i) {
            const float w = random.in(0.1f, 10.0f);
            v.push_back({random.in(-2.0f, 2.0f) * w, random.in(-2.0f, 2.0f) * w, 0.3f * w, w, a, -a});
        }
        const Inspected out = inspect(v, 16, 16);
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                const float* c = out.at(1, x, y);
                if (c[0] == kUntouched) continue;
                if (c[0] != a || c[1] != -a || c[2] != 0.0f || c[3] != 0.0f)
                    FAIL(fmt::format("seed {} pixel ({}, {}): {:a} {:a} {:a} {:a}, attribute {:a}", seed, x, y, c[0], c[1],
                                     c[2], c[3], a));
            }
    }
}

TEST_CASE("several targets of different formats take the same colours", "[output][17.1]") {
    // Three targets at once must hold what each format holds alone: the oracle is the conversion of the rgba32f target.
    const std::vector<TestVertex> v{
        {-1, 1, 0.25f, 1, 0.0f, 1.0f}, {3, 1, 0.25f, 1, 2.0f, 1.0f}, {-1, -3, 0.25f, 1, 0.0f, 0.0f}};
    const Inspected reference = inspect(v, 9, 5);
    for (const auto& [first, second] :
         {std::pair{Format::R32Float, Format::Rgba16Unorm}, std::pair{Format::Rgba8Unorm, Format::Rg16Unorm},
          std::pair{Format::R16Unorm, Format::R8Unorm}}) {
        Device device(Profile{}, 1);
        Draw draw = make_draw(inspect_program(), upload(device, v), 0, 3);
        const std::array formats{Format::Rgba32Float, first, second};
        for (std::size_t i = 0; i < 3; ++i)
            draw.color[i] = device.create_texture("t", {.format = formats[i], .width = 9, .height = 5});
        device.execute(draw);
        for (std::size_t i = 0; i < 3; ++i) {
            const Texture& texture = device.texture(draw.color[i].texture);
            const FormatInfo& info = texture.info();
            const auto bytes = texture.level_bytes(0);
            for (int y = 0; y < 5; ++y)
                for (int x = 0; x < 9; ++x)
                    for (int c = 0; c < info.components; ++c) {
                        const float value = reference.at(i, x, y)[c];
                        const auto pixel = static_cast<std::size_t>(y * 9 + x);
                        const std::size_t size = static_cast<std::size_t>(info.bits_per_component) / 8;
                        std::uint32_t code = 0;
                        std::memcpy(
                            &code,
                            bytes.data() +
                                (pixel * static_cast<std::size_t>(info.components) + static_cast<std::size_t>(c)) * size,
                            size);
                        const std::uint32_t expected = info.bits_per_component == 32
                                                           ? std::bit_cast<std::uint32_t>(value)
                                                           : oracle::unorm_code(value, info.bits_per_component);
                        if (code != expected)
                            FAIL(fmt::format("target {} {} pixel ({}, {}) channel {}: code {:#x}, expected {:#x} of {:a}", i,
                                             info.name, x, y, c, code, expected, value));
                    }
        }
    }
}
