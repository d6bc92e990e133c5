// Coverage of random triangles against exact integers, pixel for pixel; meshes cover every pixel once. D3D11.3 3.4.1, 3.4.2.1
#include "tests/oracle/random.h"
#include "tests/oracle/raster.h"
#include "tests/unit/pipeline_programs.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <map>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Point;
using oracle::Random;

namespace {

/// Whole pixels.
struct Area {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
};

struct Canvas {
    int width, height;
    Area viewport{};  // width 0: the whole target
};

/// Clip-space vertices whose snapped positions are computed by the oracle, not assumed.
struct Case {
    std::array<TestVertex, 3> vertices;
    std::array<Point, 3> points;
};

std::string describe(const Case& c) {
    std::string text;
    for (std::size_t i = 0; i < 3; ++i)
        text += fmt::format("  v{}: clip ({:a}, {:a}, {:a}, {:a}) -> snapped ({}, {})/256\n", i, c.vertices[i].x,
                            c.vertices[i].y, c.vertices[i].z, c.vertices[i].w, c.points[i].x, c.points[i].y);
    return text;
}

/// Wanted positions in 1/256 pixel, one kind of triangle after the other.
std::array<Point, 3> random_points(Random& random, int kind, int width, int height) {
    const auto anywhere = [&](std::int64_t margin) {
        return Point{random.between(-margin, width * 256 + margin), random.between(-margin, height * 256 + margin)};
    };
    switch (kind) {
        case 0: return {anywhere(512), anywhere(512), anywhere(512)};
        case 1: {  // sub-pixel
            const Point p = anywhere(256);
            const auto near = [&] { return Point{p.x + random.between(-300, 300), p.y + random.between(-300, 300)}; };
            return {near(), near(), near()};
        }
        case 2: {  // slivers: the third vertex is close to the line through the others
            const Point p = anywhere(4096);
            const Point q = anywhere(4096);
            const std::int64_t t = random.between(-1024, 2048);
            return {p, q,
                    Point{p.x + (q.x - p.x) * t / 1024 + random.between(-2, 2),
                          p.y + (q.y - p.y) * t / 1024 + random.between(-2, 2)}};
        }
        case 3: {  // huge, as far as the guard band lets
            const auto far = [&] {
                return Point{random.between(-32760 * 256, 32760 * 256), random.between(-32760 * 256, 32760 * 256)};
            };
            return {far(), random.chance(2) ? far() : anywhere(512), random.chance(3) ? far() : anywhere(64)};
        }
        case 4: {  // on pixel centres and corners: edges through sample points
            const auto centre = [&] {
                return Point{random.between(-2, width * 2 + 2) * 128, random.between(-2, height * 2 + 2) * 128};
            };
            return {centre(), centre(), centre()};
        }
        case 5: {  // axis-aligned right triangles, edges often through centres
            const Point p{random.between(-2, width * 2 + 2) * 128, random.between(-2, height * 2 + 2) * 128};
            const Point q{random.between(-2, width * 2 + 2) * 128, p.y};
            const Point r{random.chance(2) ? p.x : q.x, random.between(-2, height * 2 + 2) * 128};
            return {p, q, r};
        }
        default: {  // without area
            const Point p = anywhere(512);
            const Point q = random.chance(3) ? p : anywhere(512);
            const std::int64_t t = random.between(-3, 3);
            return {p, q, Point{p.x + (q.x - p.x) * t, p.y + (q.y - p.y) * t}};
        }
    }
}

/// The clip-space vertex for a wanted position, and where the specification's own arithmetic puts it.
Case make_case(Random& random, const std::array<Point, 3>& wanted, const Canvas& canvas, int bits, float id) {
    const Area& v = canvas.viewport;
    const int x0 = v.width == 0 ? 0 : v.x;
    const int y0 = v.width == 0 ? 0 : v.y;
    const int width = v.width == 0 ? canvas.width : v.width;
    const int height = v.width == 0 ? canvas.height : v.height;
    Case c;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto ndc = [](std::int64_t p, int origin, int size) {
            return static_cast<float>((static_cast<double>(p) / 256.0 - origin) * 2.0 / size - 1.0);
        };
        // Powers of two for w leave x/w exact.
        const float w = random.chance(4) ? std::ldexp(1.0f, random.integer(-3, 3)) : 1.0f;
        const float x = ndc(wanted[i].x, x0, width);
        const float y = ndc(wanted[i].y, y0, height);
        c.vertices[i] = {x * w, -y * w, 0.5f * w, w, id, 0.0f};
        c.points[i] = {oracle::snap(x, x0, width, bits), oracle::snap(y, y0, height, bits)};
    }
    if (random.chance(2)) {
        std::swap(c.vertices[1], c.vertices[2]);
        std::swap(c.points[1], c.points[2]);
    }
    return c;
}

/// Draws every case alone and compares every pixel with the oracle. Returns the pixels covered in all.
std::uint64_t check_cases(const Profile& profile, const Canvas& canvas, std::uint64_t seed, int count, int kind) {
    Device device(profile, 1);
    const TextureId target =
        device.create_texture("ids", {.format = Format::R32Float, .width = canvas.width, .height = canvas.height});
    device.execute(ClearColor{target, glm::vec4(-1.0f)});
    Random random(seed);
    std::vector<Case> cases;
    std::vector<TestVertex> vertices;
    for (int i = 0; i < count; ++i) {
        const auto points = random_points(random, kind, canvas.width, canvas.height);
        cases.push_back(make_case(random, points, canvas, profile.raster_subpixel_bits, static_cast<float>(i)));
        vertices.insert(vertices.end(), cases.back().vertices.begin(), cases.back().vertices.end());
    }
    const BufferId buffer = upload(device, vertices);
    Draw draw = make_draw(id_program(), buffer, 0, 3);
    draw.color[0] = target;
    draw.viewport = {static_cast<float>(canvas.viewport.x), static_cast<float>(canvas.viewport.y),
                     static_cast<float>(canvas.viewport.width), static_cast<float>(canvas.viewport.height)};
    const Area& v = canvas.viewport;
    std::uint64_t covered = 0;
    for (int i = 0; i < count; ++i) {
        draw.first = static_cast<std::uint32_t>(3 * i);
        device.execute(draw);
        const Case& c = cases[static_cast<std::size_t>(i)];
        const Texture& texture = device.texture(target);
        for (int y = 0; y < canvas.height; ++y) {
            const auto* row = reinterpret_cast<const float*>(texture.row(0, y));
            for (int x = 0; x < canvas.width; ++x) {
                const bool visible = v.width == 0 || (x >= v.x && y >= v.y && x < v.x + v.width && y < v.y + v.height);
                const bool expected = visible && oracle::covers_pixel(c.points, x, y);
                const bool drawn = row[x] == static_cast<float>(i);
                covered += expected;
                if (expected != drawn)
                    FAIL(fmt::format("seed {} kind {} triangle {}, target {}x{}, pixel ({}, {}): {}\n{}", seed, kind, i,
                                     canvas.width, canvas.height, x, y, expected ? "missed" : "covered, but is outside",
                                     describe(c)));
            }
        }
    }
    return covered;
}

Profile with_bits(int bits) {
    Profile profile;
    profile.raster_subpixel_bits = bits;
    return profile;
}

}  // namespace

TEST_CASE("coverage of random triangles is exact", "[raster][3.4.2]") {
    // 7 kinds x 6 targets x 10000 = 420000 triangles.
    const std::array<Canvas, 6> canvases{Canvas{16, 16}, Canvas{32, 16}, Canvas{1, 1},
                                         Canvas{3, 5},   Canvas{13, 7},  Canvas{8, 24}};
    for (int kind = 0; kind < 7; ++kind) {
        std::uint64_t covered = 0;
        for (std::size_t c = 0; c < canvases.size(); ++c)
            covered += check_cases(Profile{}, canvases[c], 100 * c + static_cast<std::uint64_t>(kind), 10000, kind);
        INFO("kind " << kind);
        if (kind < 6)
            CHECK(covered > 400);
        else
            CHECK(covered == 0);
    }
}

TEST_CASE("coverage is exact at the borders of tiles and blocks", "[raster][3.4.2]") {
    const std::array<Canvas, 4> canvases{Canvas{65, 63}, Canvas{64, 64}, Canvas{130, 70}, Canvas{127, 129}};
    for (std::size_t c = 0; c < canvases.size(); ++c)
        for (int kind = 0; kind < 6; ++kind) CHECK(check_cases(Profile{}, canvases[c], 1000 + 10 * c, 1000, kind) > 0);
}

TEST_CASE("coverage is exact inside viewports that do not fill the target", "[raster][15.6][15.7]") {
    const std::array<Canvas, 5> canvases{Canvas{20, 20, {3, 5, 9, 7}}, Canvas{20, 20, {19, 19, 1, 1}},
                                         Canvas{33, 17, {1, 0, 32, 16}}, Canvas{80, 72, {60, 62, 9, 5}},
                                         Canvas{40, 30, {7, 1, 16, 29}}};
    for (int kind = 0; kind < 6; ++kind) {
        std::uint64_t covered = 0;
        for (std::size_t c = 0; c < canvases.size(); ++c) covered += check_cases(Profile{}, canvases[c], 2000 + c, 2000, kind);
        CHECK(covered > 0);
    }
}

TEST_CASE("coarser snapping and double arithmetic cover exactly too", "[raster][3.4.1]") {
    for (const int bits : {1, 4, 7})
        for (int kind = 0; kind < 6; ++kind)
            (void)check_cases(with_bits(bits), {16, 16}, 3000 + static_cast<std::uint64_t>(bits), 2000, kind);
    // Powers of two make the viewport transform exact in either arithmetic.
    for (int kind = 0; kind < 6; ++kind) CHECK(check_cases(load_profile("ideal"), {16, 16}, 4000, 4000, kind) > 0);
}

namespace {

/// A tessellation of a square that is larger than the target: a jittered grid, every quad split so that no triangle turns over.
struct Tessellation {
    std::vector<Point> points;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

Tessellation tessellate(Random& random, int cells, int extent_px, std::int64_t quantum) {
    Tessellation mesh;
    const std::int64_t step = std::int64_t{extent_px + 2} * 256 / cells;
    const int side = cells + 1;
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
            const auto jitter = [&](int k) { return k == 0 || k == cells ? 0 : random.between(-step * 2 / 5, step * 2 / 5); };
            Point p{-256 + i * step + jitter(i), -256 + j * step + jitter(j)};
            if (i == cells) p.x = (extent_px + 1) * 256;
            if (j == cells) p.y = (extent_px + 1) * 256;
            // Many vertices on sample positions.
            p.x = p.x / quantum * quantum;
            p.y = p.y / quantum * quantum;
            mesh.points.push_back(p);
        }
    const auto area = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        return turn(mesh.points[a], mesh.points[b], mesh.points[c]);
    };
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
            const auto a = static_cast<std::uint32_t>(j * side + i);
            const std::uint32_t b = a + 1;
            const std::uint32_t c = a + static_cast<std::uint32_t>(side) + 1;
            const std::uint32_t d = c - 1;
            const bool first = area(a, b, c) >= 0 && area(a, c, d) >= 0;
            const bool second = area(a, b, d) >= 0 && area(b, c, d) >= 0;
            if (!first && !second) return {};  // folded: the caller takes the next seed
            if (first && (!second || random.chance(2))) {
                mesh.triangles.push_back({a, b, c});
                mesh.triangles.push_back({a, c, d});
            } else {
                mesh.triangles.push_back({a, b, d});
                mesh.triangles.push_back({b, c, d});
            }
        }
    return mesh;
}

}  // namespace

TEST_CASE("a closed tessellation covers every pixel exactly once", "[raster][3.4.2]") {
    int meshes = 0;
    for (std::uint64_t seed = 0; seed < 120; ++seed) {
        Random random(seed);
        const int size = std::array{16, 64, 32, 128}[seed % 4];
        const int cells = random.integer(1, 12);
        const std::int64_t quantum = std::array<std::int64_t, 4>{1, 128, 64, 1}[seed / 4 % 4];
        const Tessellation mesh = tessellate(random, cells, size, quantum);
        if (mesh.triangles.empty()) continue;
        ++meshes;

        // Random corner to start from and random winding must not matter.
        std::vector<TestVertex> vertices;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            std::array<std::uint32_t, 3> corners = mesh.triangles[t];
            std::rotate(corners.begin(), corners.begin() + random.integer(0, 2), corners.end());
            if (random.chance(2)) std::swap(corners[0], corners[1]);
            for (const std::uint32_t corner : corners) {
                const Point& p = mesh.points[corner];
                const float half = static_cast<float>(size) * 0.5f;
                vertices.push_back({(static_cast<float>(p.x) / 256.0f - half) / half,
                                    (half - static_cast<float>(p.y) / 256.0f) / half, 0.5f, 1.0f, static_cast<float>(t), 0.0f});
            }
        }
        Device device(Profile{}, 1);
        const TextureId target = device.create_texture("ids", {.format = Format::R32Float, .width = size, .height = size});
        const BufferId buffer = upload(device, vertices);
        Draw draw = make_draw(id_program(), buffer, 0, static_cast<std::uint32_t>(vertices.size()));
        draw.color[0] = target;

        // All at once.
        device.execute(ClearColor{target, glm::vec4(-1.0f)});
        device.enable_counters(true);
        device.execute(draw);
        const Counters counters = device.take_counters();
        device.enable_counters(false);
        const auto together = floats_of(device.texture(target));

        // One at a time: how often each pixel is drawn, and by whom.
        std::vector<int> times(static_cast<std::size_t>(size * size), 0);
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            device.execute(ClearColor{target, glm::vec4(-1.0f)});
            draw.first = static_cast<std::uint32_t>(3 * t);
            draw.count = 3;
            device.execute(draw);
            const auto alone = floats_of(device.texture(target));
            for (std::size_t i = 0; i < alone.size(); ++i)
                if (alone[i] == static_cast<float>(t)) {
                    ++times[i];
                    if (together[i] != static_cast<float>(t))
                        FAIL(fmt::format("seed {} pixel ({}, {}): triangle {} alone, {} together", seed,
                                         i % static_cast<std::size_t>(size), i / static_cast<std::size_t>(size), t,
                                         together[i]));
                }
        }
        for (std::size_t i = 0; i < times.size(); ++i)
            if (times[i] != 1)
                FAIL(fmt::format("seed {} size {} cells {} pixel ({}, {}): covered {} times", seed, size, cells,
                                 i % static_cast<std::size_t>(size), i / static_cast<std::size_t>(size), times[i]));
        if (counters.samples_covered != static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size))
            FAIL(fmt::format("seed {}: {} samples covered of {}", seed, counters.samples_covered, size * size));
    }
    CHECK(meshes > 60);
}

TEST_CASE("a fan around a vertex covers every pixel exactly once", "[raster][3.4.2]") {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Random random(seed);
        const int size = 32;
        const bool on_centre = seed % 2 == 0;
        const Point hub{random.between(4, 27) * 256 + (on_centre ? 128 : random.between(0, 255)),
                        random.between(4, 27) * 256 + (on_centre ? 128 : random.between(0, 255))};
        // Rim around the target, in order; corners included so that the target lies inside.
        std::vector<Point> rim;
        const std::int64_t low = -256;
        const std::int64_t high = (size + 1) * 256;
        const int per_side = random.integer(1, 40);
        const auto side = [&](Point from, Point to) {
            std::vector<std::int64_t> at{0};
            for (int k = 1; k < per_side; ++k) at.push_back(random.between(0, 8704));
            std::sort(at.begin(), at.end());
            for (const std::int64_t t : at)
                rim.push_back({from.x + (to.x - from.x) * t / 8704, from.y + (to.y - from.y) * t / 8704});
        };
        side({low, low}, {high, low});
        side({high, low}, {high, high});
        side({high, high}, {low, high});
        side({low, high}, {low, low});
        std::vector<TestVertex> vertices;
        const auto vertex = [&](const Point& p, std::size_t id) {
            vertices.push_back({static_cast<float>(p.x) / 4096.0f - 1.0f, 1.0f - static_cast<float>(p.y) / 4096.0f, 0.0f, 1.0f,
                                static_cast<float>(id), 0.0f});
        };
        for (std::size_t k = 0; k < rim.size(); ++k) {
            vertex(hub, k);
            vertex(rim[k], k);
            vertex(rim[(k + 1) % rim.size()], k);
        }
        Device device(Profile{}, 1);
        const TextureId target = device.create_texture("ids", {.format = Format::R32Float, .width = size, .height = size});
        device.execute(ClearColor{target, glm::vec4(-1.0f)});
        Draw draw = make_draw(id_program(), upload(device, vertices), 0, static_cast<std::uint32_t>(vertices.size()));
        draw.color[0] = target;
        device.enable_counters(true);
        device.execute(draw);
        const auto ids = floats_of(device.texture(target));
        for (std::size_t i = 0; i < ids.size(); ++i)
            if (ids[i] < 0) FAIL(fmt::format("seed {}: pixel ({}, {}) missed", seed, i % 32, i / 32));
        const auto covered = device.take_counters().samples_covered;
        if (covered != 32u * 32u) FAIL(fmt::format("seed {}: {} samples covered, expected 1024", seed, covered));
    }
}

TEST_CASE("triangles that share an edge keep primitive order, whatever the number of threads", "[raster][order]") {
    constexpr int kWidth = 200;
    constexpr int kHeight = 150;
    constexpr int kTriangles = 2600;  // several chunks
    std::map<int, std::vector<std::uint32_t>> pictures;
    std::vector<std::array<Point, 3>> points;
    std::vector<TestVertex> vertices;
    Random random(7);
    for (int t = 0; t < kTriangles; ++t) {
        auto wanted = random_points(random, t % 5 == 3 ? 1 : t % 5, kWidth, kHeight);
        const Case c = make_case(random, wanted, {kWidth, kHeight}, 8, static_cast<float>(t));
        points.push_back(c.points);
        vertices.insert(vertices.end(), c.vertices.begin(), c.vertices.end());
    }
    for (const int threads : {1, 2, 8}) {
        Device device(Profile{}, threads);
        const TextureId target = device.create_texture("ids", {.format = Format::R32Float, .width = kWidth, .height = kHeight});
        device.execute(ClearColor{target, glm::vec4(-1.0f)});
        Draw draw = make_draw(id_program(), upload(device, vertices), 0, kTriangles * 3);
        draw.color[0] = target;
        device.execute(draw);
        pictures[threads] = codes_of(device.texture(target));
    }
    CHECK(pictures[1] == pictures[2]);
    CHECK(pictures[1] == pictures[8]);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            float last = -1.0f;
            for (int t = kTriangles - 1; t >= 0 && last < 0; --t)
                if (oracle::covers_pixel(points[static_cast<std::size_t>(t)], x, y)) last = static_cast<float>(t);
            const float drawn = std::bit_cast<float>(pictures[1][static_cast<std::size_t>(y * kWidth + x)]);
            if (drawn != last) FAIL(fmt::format("pixel ({}, {}): triangle {} on top, expected {}", x, y, drawn, last));
        }
}
