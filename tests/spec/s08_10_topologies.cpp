// D3D11.3 8.10 lists, strips (and the fans of Vulkan), 8.12 restart, 8.13 partial primitives, 8.14 leading vertex, 8.16 to 8.18
// ids: which vertices make up a primitive and which of them it takes its flat values from.
#include "tests/oracle/lines.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <optional>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Point;
using oracle::Random;

namespace {

constexpr std::uint32_t kRestart = 0xffffffffu;

/// A primitive as the tables of 8.10 and of Vulkan 1.3 20.1 list it: its vertices in winding order, and which of them leads
/// where the first or the last vertex does.
struct Expected {
    std::vector<std::uint32_t> vertices;
    std::uint32_t first, last;
};

/// Primitives of one run without restarts.
std::vector<Expected> primitives_of_run(Topology topology, const std::vector<std::uint32_t>& v) {
    std::vector<Expected> out;
    const std::size_t n = v.size();
    switch (topology) {
        case Topology::PointList:
            for (const std::uint32_t i : v) out.push_back({{i}, i, i});
            break;
        case Topology::LineList:
            for (std::size_t i = 1; i < n; i += 2) out.push_back({{v[i - 1], v[i]}, v[i - 1], v[i]});
            break;
        case Topology::LineStrip:
            for (std::size_t i = 1; i < n; ++i) out.push_back({{v[i - 1], v[i]}, v[i - 1], v[i]});
            break;
        case Topology::TriangleList:
            for (std::size_t i = 2; i < n; i += 3) out.push_back({{v[i - 2], v[i - 1], v[i]}, v[i - 2], v[i]});
            break;
        case Topology::TriangleStrip:
            for (std::size_t i = 2; i < n; ++i) {
                if (i % 2 == 0) out.push_back({{v[i - 2], v[i - 1], v[i]}, v[i - 2], v[i]});
                if (i % 2 == 1) out.push_back({{v[i - 1], v[i - 2], v[i]}, v[i - 2], v[i]});
            }
            break;
        case Topology::TriangleFan:
            for (std::size_t i = 2; i < n; ++i) out.push_back({{v[0], v[i - 1], v[i]}, v[i - 1], v[i]});
            break;
    }
    return out;
}

std::vector<Expected> primitives(Topology topology, const std::vector<std::uint32_t>& indices, bool restart) {
    std::vector<Expected> out;
    std::vector<std::uint32_t> run;
    const auto flush = [&] {
        for (Expected& e : primitives_of_run(topology, run)) out.push_back(std::move(e));
        run.clear();
    };
    for (const std::uint32_t i : indices) {
        if (restart && i == kRestart) {
            flush();
        } else {
            run.push_back(i);
        }
    }
    flush();
    return out;
}

/// The case at hand; vertices lie on the grid of a 32 x 32 target.
struct Scene {
    std::vector<Point> points;
    std::vector<std::uint32_t> indices{};   // empty: vertices in order
    std::optional<IndexType> index_type{};  // nothing: no indices
    Topology topology = Topology::TriangleList;
    ProvokingVertex provoking = ProvokingVertex::First;
    bool restart = false;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    std::int32_t base_vertex = 0;
};

bool covers(const std::vector<Point>& corners, int x, int y) {
    if (corners.size() == 3) return oracle::covers_pixel({corners[0], corners[1], corners[2]}, x, y);
    if (corners.size() == 2) return oracle::line_draws(corners[0], corners[1], {x, y});
    const auto square = oracle::point_square(corners[0]);
    return oracle::covers_pixel({square[0], square[1], square[2]}, x, y) ||
           oracle::covers_pixel({square[0], square[2], square[3]}, x, y);
}

void set_indices(Canvas& canvas, Draw& draw, const std::vector<std::uint32_t>& indices, IndexType type) {
    std::vector<std::uint16_t> narrow(indices.begin(), indices.end());
    draw.indices = canvas.device().create_buffer(
        "indices", type == IndexType::Uint16 ? std::as_bytes(std::span(narrow)) : std::as_bytes(std::span(indices)));
    draw.index_type = type;
}

/// Draws the scene and compares, pixel by pixel, who is on top. Returns how many pixels were drawn.
std::uint64_t check_scene(const Scene& scene, const std::string& what) {
    Canvas canvas(identify_program(), Profile{}, {.width = 32, .height = 32});
    std::vector<RasterVertex> vertices;
    for (std::size_t i = 0; i < scene.points.size(); ++i)
        vertices.push_back(vertex_at(scene.points[i], canvas.rect(), 1000.0f + static_cast<float>(i)));
    Draw draw = canvas.draw_of(vertices);
    if (scene.index_type) set_indices(canvas, draw, scene.indices, *scene.index_type);
    draw.topology = scene.topology;
    draw.raster.provoking = scene.provoking;
    draw.raster.front_counter_clockwise = false;
    draw.primitive_restart = scene.restart;
    draw.first = scene.first;
    draw.count = scene.count;
    draw.base_vertex = scene.base_vertex;
    canvas.device().enable_counters(true);
    canvas.execute(draw);

    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < scene.count; ++i)
        numbers.push_back(scene.index_type ? scene.indices[scene.first + i] : scene.first + i);
    const auto expected = primitives(scene.topology, numbers, scene.restart && scene.index_type);
    if (canvas.device().take_counters().primitives_in != expected.size()) FAIL(what << ": number of primitives");

    std::uint64_t drawn = 0;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
            std::array<float, 5> want{kUntouched, kUntouched, kUntouched, kUntouched, kUntouched};
            for (std::size_t p = expected.size(); p-- > 0;) {
                std::vector<Point> corners;
                for (const std::uint32_t v : expected[p].vertices)
                    corners.push_back(scene.points[static_cast<std::size_t>(std::int64_t{v} + scene.base_vertex)]);
                if (!covers(corners, x, y)) continue;
                const std::uint32_t lead = scene.provoking == ProvokingVertex::First ? expected[p].first : expected[p].last;
                const bool front =
                    corners.size() < 3 || oracle::facing({corners[0], corners[1], corners[2]}) == oracle::Facing::Front;
                // Vertex ids are indices without the base vertex, or count from 0 in the draw. D3D11.3 8.16
                const std::uint32_t id = scene.index_type ? lead : lead - scene.first;
                want = {1000.0f + static_cast<float>(std::int64_t{lead} + scene.base_vertex), static_cast<float>(id), 0.0f,
                        static_cast<float>(p), front ? 1.0f : 0.0f};
                ++drawn;
                break;
            }
            for (int c = 0; c < 5; ++c) {
                const float got = canvas.value(c < 4 ? 0 : 1, c % 4, {.x = x, .y = y});
                if (got != want[static_cast<std::size_t>(c)])
                    FAIL(
                        fmt::format("{}: pixel ({}, {}), component {} (lead, vertex id, instance id, primitive id, front): {}, "
                                    "expected {}",
                                    what, x, y, c, got, want[static_cast<std::size_t>(c)]));
            }
        }
    return drawn;
}

std::vector<Point> random_points(Random& random, int count) {
    std::vector<Point> points;
    for (int i = 0; i < count; ++i) {
        const std::int64_t x = random.between(-256, 33 * 256);
        const std::int64_t y = random.between(-256, 33 * 256);
        points.push_back({x, y});
    }
    return points;
}

constexpr std::array kTopologies{Topology::PointList,    Topology::LineList,      Topology::LineStrip,
                                 Topology::TriangleList, Topology::TriangleStrip, Topology::TriangleFan};

}  // namespace

TEST_CASE("every topology, in order and by indices, with either leading vertex", "[raster][8.10][8.13][8.14][8.16][8.17]") {
    std::uint64_t seed = 0;
    for (const Topology topology : kTopologies)
        for (const ProvokingVertex provoking : {ProvokingVertex::First, ProvokingVertex::Last})
            for (const int kind : {0, 1, 2}) {
                std::uint64_t drawn = 0;
                // Counts of 0 to 14: whole and partial primitives.
                for (std::uint32_t count = 0; count < 15; ++count) {
                    Random random(++seed);
                    Scene scene{.points = random_points(random, 24), .topology = topology, .provoking = provoking};
                    scene.first = static_cast<std::uint32_t>(random.integer(0, 9));
                    scene.count = count;
                    if (kind > 0) {
                        scene.index_type = kind == 1 ? IndexType::Uint16 : IndexType::Uint32;
                        scene.base_vertex = random.integer(0, 2) * 5 - 5;
                        for (int i = 0; i < 24; ++i) scene.indices.push_back(static_cast<std::uint32_t>(random.integer(5, 18)));
                    }
                    drawn += check_scene(
                        scene, fmt::format("{}, seed {}, count {}, kind {}", gnomon::name_of(topology), seed, count, kind));
                }
                CHECK(drawn > 20);
            }
}

TEST_CASE("restart ends strips, fans and unfinished primitives", "[raster][8.12][8.13][8.17]") {
    std::uint64_t seed = 5000;
    for (const Topology topology : kTopologies)
        for (const IndexType type : {IndexType::Uint16, IndexType::Uint32})
            for (const bool restart : {true, false}) {
                std::uint64_t drawn = 0;
                for (int round = 0; round < 12; ++round) {
                    Random random(++seed);
                    Scene scene{.points = random_points(random, 20),
                                .index_type = type,
                                .topology = topology,
                                .provoking = random.chance(2) ? ProvokingVertex::First : ProvokingVertex::Last,
                                .restart = restart};
                    scene.count = static_cast<std::uint32_t>(random.integer(5, 24));
                    scene.first = static_cast<std::uint32_t>(random.integer(0, 3));
                    scene.base_vertex = random.integer(0, 3);
                    for (int i = 0; i < 30; ++i)
                        scene.indices.push_back(
                            restart && random.chance(5) ? kRestart : static_cast<std::uint32_t>(random.integer(0, 16)));
                    drawn +=
                        check_scene(scene, fmt::format("{}, seed {}, restart {}", gnomon::name_of(topology), seed, restart));
                }
                CHECK(drawn > 20);
            }
}

TEST_CASE("an index with all bits set is a vertex where nothing restarts, and in 32 bits 0xffff always is", "[raster][8.12]") {
    for (const IndexType type : {IndexType::Uint16, IndexType::Uint32}) {
        Scene scene{.points = std::vector<Point>(65536, Point{0, 0}), .index_type = type, .topology = Topology::TriangleStrip};
        scene.points[1] = {0, 8000};
        scene.points[65535] = {8000, 0};
        scene.points[2] = {7000, 7000};
        scene.indices = {0, 65535, 1, 2};
        scene.count = 4;
        scene.restart = type == IndexType::Uint32;
        CHECK(check_scene(scene, "65535") > 400);
    }
}

TEST_CASE("instances count from 0, primitives anew in each, and read their own numbers", "[raster][8.17][8.18]") {
    Canvas canvas(instanced_program(), Profile{}, {.width = 32, .height = 32});
    // Two triangles of 4 x 4 pixels; ndc steps of 1/4 are 4 pixels.
    std::vector<RasterVertex> vertices;
    for (const Point& p : {Point{0, 0}, Point{1024, 0}, Point{0, 1024}, Point{1024, 0}, Point{1024, 1024}, Point{0, 1024}})
        vertices.push_back(vertex_at(p, canvas.rect(), static_cast<float>(vertices.size())));
    std::vector<float> offsets;
    for (int i = 0; i < 12; ++i) {
        offsets.push_back(static_cast<float>(i % 4) * 0.5f);
        offsets.push_back(static_cast<float>(i / 4) * -0.5f);
    }
    for (const std::uint32_t first_instance : {0u, 3u}) {
        canvas.clear();
        Draw draw = canvas.draw_of(vertices);
        draw.instances = canvas.device().create_buffer("instances", std::as_bytes(std::span(offsets)));
        draw.first_instance = first_instance;
        draw.instance_count = 7;
        canvas.execute(draw);
        std::uint32_t covered = 0;
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x) {
                // Which instance's 4 x 4 pixels these are.
                const int cell = x / 8 + y / 8 * 4;
                const bool inside = x % 8 < 4 && y % 8 < 4 && cell >= static_cast<int>(first_instance) &&
                                    cell < static_cast<int>(first_instance) + 7;
                const bool second = (x % 8) + (y % 8) >= 3;  // centres on the diagonal belong to the triangle on their right
                const std::array<float, 4> want =
                    !inside ? std::array{kUntouched, kUntouched, kUntouched, kUntouched}
                            : std::array{second ? 3.0f : 0.0f, second ? 3.0f : 0.0f,
                                         static_cast<float>(cell) - static_cast<float>(first_instance), second ? 1.0f : 0.0f};
                covered += inside;
                for (int c = 0; c < 4; ++c) {
                    INFO("first instance " << first_instance << ", pixel (" << x << ", " << y << "), component " << c);
                    REQUIRE(canvas.value(0, c, {.x = x, .y = y}) == want[static_cast<std::size_t>(c)]);
                }
            }
        CHECK(covered == 7 * 16);
    }
}
