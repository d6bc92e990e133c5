// The depth test against a per-pixel oracle: hierarchy and early test never show. D3D11.3 17.9 to 17.11
#include "tests/oracle/random.h"
#include "tests/oracle/raster.h"
#include "tests/unit/pipeline_programs.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Point;
using oracle::Random;

namespace {

std::uint32_t depth_code_of(Format format, float z) {
    if (format == Format::D16) return oracle::unorm_code(z, 16);
    if (format == Format::D24) return oracle::unorm_code(z, 24);
    const float limited = z > 0.0f ? (z < 1.0f ? z : 1.0f) : 0.0f;
    // Operands below the normal range count as 0 under the d3d11 profile. D3D11.3 3.1.3.2
    return limited < 0x1p-126f ? 0u : std::bit_cast<std::uint32_t>(limited);
}

bool passes(CompareOp op, std::uint32_t incoming, std::uint32_t stored) {
    switch (op) {
        case CompareOp::Never: return false;
        case CompareOp::Less: return incoming < stored;
        case CompareOp::Equal: return incoming == stored;
        case CompareOp::LessEqual: return incoming <= stored;
        case CompareOp::Greater: return incoming > stored;
        case CompareOp::NotEqual: return incoming != stored;
        case CompareOp::GreaterEqual: return incoming >= stored;
        case CompareOp::Always: return true;
    }
    return false;
}

struct DepthTriangle {
    std::array<TestVertex, 3> vertices;
    std::array<Point, 3> points;
    std::array<float, 3> z;
};

constexpr int kWidth = 96;  // not a multiple of the tile
constexpr int kHeight = 80;

DepthTriangle random_triangle(Random& random, float id) {
    DepthTriangle t;
    const int kind = random.integer(0, 5);
    const Point base{random.between(0, kWidth * 256), random.between(0, kHeight * 256)};
    for (std::size_t i = 0; i < 3; ++i) {
        std::int64_t reach = kind == 0 ? 40 * 256 : kind == 1 ? 8 * 256 : kind == 2 ? 512 : kind == 3 ? 20000 * 256 : 120 * 256;
        Point p{base.x + random.between(-reach, reach), base.y + random.between(-reach, reach)};
        if (random.chance(4)) p = {p.x / 128 * 128, p.y / 128 * 128};
        const float x = static_cast<float>(static_cast<double>(p.x) / 256.0 * 2.0 / kWidth - 1.0);
        const float y = static_cast<float>(static_cast<double>(p.y) / 256.0 * 2.0 / kHeight - 1.0);
        float z = random.unit();
        if (kind == 4) z = static_cast<float>(random.integer(0, 8)) / 8.0f;                         // equal depths
        if (kind == 5 && i > 0) z = t.z[0] + static_cast<float>(random.integer(-2, 2)) * 0x1p-24f;  // nearly flat
        t.z[i] = std::clamp(z, 0.0f, 1.0f);
        t.vertices[i] = {x, -y, t.z[i], 1.0f, id, 0.0f};
        t.points[i] = {oracle::snap(x, 0, kWidth, 8), oracle::snap(y, 0, kHeight, 8)};
    }
    return t;
}

struct OracleTarget {
    std::vector<std::uint32_t> codes;
    std::vector<float> ids;

    void draw(const DepthTriangle& t, Format format, const DepthState& state) {
        if (oracle::turn(t.points[0], t.points[1], t.points[2]) == 0) return;
        const oracle::DepthPlane plane(t.points, t.z);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                if (!oracle::covers_pixel(t.points, x, y)) continue;
                const auto i = static_cast<std::size_t>(y * kWidth + x);
                const std::uint32_t code = depth_code_of(format, plane.at(x, y));
                if (!passes(state.compare, code, codes[i])) continue;
                if (state.write) codes[i] = code;
                ids[i] = t.vertices[0].a;
            }
    }
};

}  // namespace

TEST_CASE("depth test equals the per-pixel oracle for every comparison and format", "[depth][17.10][17.11]") {
    const std::array formats{Format::D16, Format::D24, Format::D32Float};
    const std::array ops{CompareOp::Less,     CompareOp::LessEqual, CompareOp::Greater, CompareOp::GreaterEqual,
                         CompareOp::NotEqual, CompareOp::Equal,     CompareOp::Always,  CompareOp::Never};
    for (std::uint64_t seed = 0; seed < 48; ++seed) {
        Random random(seed);
        const Format format = formats[seed % 3];
        Device device(Profile{}, seed % 2 == 0 ? 1 : 3);
        const TextureId ids = device.create_texture("ids", {.format = Format::R32Float, .width = kWidth, .height = kHeight});
        const TextureId depth = device.create_texture("depth", {.format = format, .width = kWidth, .height = kHeight});

        // Start from a clear or from arbitrary stored codes.
        OracleTarget expected{std::vector<std::uint32_t>(kWidth * kHeight), std::vector<float>(kWidth * kHeight, -1.0f)};
        const float clear = std::array{1.0f, 0.5f, 0.0f, 0.75f}[seed / 3 % 4];
        device.execute(ClearColor{ids, glm::vec4(-1.0f)});
        if (seed % 5 == 4) {
            for (auto& code : expected.codes) code = depth_code_of(format, random.unit());
            device.execute(WriteTexture{depth, 0, std::as_bytes(std::span(expected.codes))});
        } else {
            std::fill(expected.codes.begin(), expected.codes.end(), depth_code_of(format, clear));
            device.execute(ClearDepth{depth, clear});
        }

        // Several draws with different states over the same target.
        for (int d = 0; d < 6; ++d) {
            std::vector<DepthTriangle> triangles;
            std::vector<TestVertex> vertices;
            for (int k = 0; k < 40; ++k) {
                triangles.push_back(random_triangle(random, static_cast<float>(d * 100 + k)));
                vertices.insert(vertices.end(), triangles.back().vertices.begin(), triangles.back().vertices.end());
            }
            Draw draw = make_draw(id_program(), upload(device, vertices), 0, static_cast<std::uint32_t>(vertices.size()));
            draw.color[0] = ids;
            draw.depth = depth;
            draw.depth_state.compare = d < 3 ? ops[(seed / 3) % 8] : ops[static_cast<std::size_t>(random.integer(0, 7))];
            draw.depth_state.write = !random.chance(4);
            device.execute(draw);
            for (const auto& t : triangles) expected.draw(t, format, draw.depth_state);

            const auto drawn_ids = floats_of(device.texture(ids));
            const auto drawn_codes = codes_of(device.texture(depth));
            for (std::size_t i = 0; i < drawn_ids.size(); ++i)
                if (drawn_ids[i] != expected.ids[i] || drawn_codes[i] != expected.codes[i])
                    FAIL(
                        fmt::format("seed {} draw {} format {} compare {} write {} pixel ({}, {}): id {} code {:#x}, expected "
                                    "id {} code {:#x}",
                                    seed, d, name_of(format), name_of(draw.depth_state.compare), draw.depth_state.write,
                                    i % kWidth, i / kWidth, drawn_ids[i], drawn_codes[i], expected.ids[i], expected.codes[i]));
        }
    }
}

TEST_CASE("hierarchical depth rejects blocks behind, and only those", "[depth]") {
    // Front to back: the hierarchy must fire; the picture is the front's.
    Device device(Profile{}, 1);
    const TextureId ids = device.create_texture("ids", {.format = Format::R32Float, .width = 64, .height = 64});
    const TextureId depth = device.create_texture("depth", {.format = Format::D32Float, .width = 64, .height = 64});
    std::vector<TestVertex> vertices;
    for (const float z : {0.25f, 0.5f, 0.25f}) {
        const auto id = static_cast<float>(vertices.size() / 3);
        vertices.push_back({-1, 1, z, 1, id, 0});
        vertices.push_back({3, 1, z, 1, id, 0});
        vertices.push_back({-1, -3, z, 1, id, 0});
    }
    device.execute(ClearDepth{depth, 1.0f});
    device.execute(ClearColor{ids, glm::vec4(-1.0f)});
    Draw draw = make_draw(id_program(), upload(device, vertices), 0, 9);
    draw.color[0] = ids;
    draw.depth = depth;
    device.enable_counters(true);
    device.execute(draw);
    const Counters less = device.take_counters();
    CHECK(less.blocks_rejected == 128);  // both later triangles, 64 blocks each
    CHECK(less.samples_passed == 4096);
    for (const float id : floats_of(device.texture(ids))) REQUIRE(id == 0.0f);

    // LessEqual lets the equal one through.
    draw.depth_state.compare = CompareOp::LessEqual;
    device.execute(draw);
    const Counters less_equal = device.take_counters();
    CHECK(less_equal.blocks_rejected == 64);
    for (const float id : floats_of(device.texture(ids))) REQUIRE(id == 2.0f);
}
