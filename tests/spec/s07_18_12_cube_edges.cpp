// D3D11.3 7.18.12: bilinear filters spill over the edges of a cube's faces; corners have three texels.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/record.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

struct Point {
    double x, y, z;
};
Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Point operator*(const Point& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
double squared_distance(const Point& a, const Point& b) {
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z);
}

/// Out of the cube, to the right and down of each face. D3D11.3 5.3.8
struct Face {
    Point out, right, down;
};
constexpr std::array<Face, 6> kFaces{{{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                      {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                      {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                      {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                      {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},
                                      {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}}};

/// A point on the plane of a face; right and down are in [-1, 1] on the face itself.
Point on_face(int face, double right, double down) {
    const Face& axes = kFaces[static_cast<std::size_t>(face)];
    return axes.out + axes.right * right + axes.down * down;
}

struct Texel {
    int face, x, y;
    bool operator==(const Texel&) const = default;
};
Point center(const Texel& t, int size) { return on_face(t.face, (2.0 * t.x + 1) / size - 1, (2.0 * t.y + 1) / size - 1); }

/// The texel of another face whose centre is nearest to that of a texel just over an edge: one step across and round the
/// corner.
Texel nearest_over_edge(const Texel& over, int size) {
    const Point at = center(over, size);
    Texel best{-1, 0, 0};
    double shortest = HUGE_VAL;
    double second = HUGE_VAL;
    for (int face = 0; face < 6; ++face) {
        if (face == over.face) continue;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const double distance = squared_distance(at, center({face, x, y}, size));
                if (distance < shortest) {
                    second = shortest;
                    shortest = distance;
                    best = {face, x, y};
                } else {
                    second = std::min(second, distance);
                }
            }
    }
    REQUIRE(second > shortest + 1e-9);
    return best;
}

bool inside(int i, int size) { return i >= 0 && i < size; }

float number_of(const Texel& t, int size) { return static_cast<float>((t.face * size + t.y) * size + t.x + 1); }

/// Texel values by `value(texel)`.
template <class Value>
Texture cube_of(int size, const Value& value) {
    Texture texture({.format = Format::R32Float,
                     .width = size,
                     .height = size,
                     .levels = 1,
                     .kind = TextureKind::Cube,
                     .layers = kCubeFaces});
    for (int face = 0; face < kCubeFaces; ++face) {
        std::vector<float> values;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) values.push_back(value(Texel{face, x, y}));
        texture.set_level_bytes(0, std::as_bytes(std::span(values)).data(), values.size() * 4, face);
    }
    return texture;
}
Texture numbered_cube(int size) {
    return cube_of(size, [&](const Texel& t) { return number_of(t, size); });
}

SampleRequest towards(const Point& d) { return {.coordinate = {d.x, d.y, d.z}}; }

constexpr std::array kSizes{1, 2, 3, 8};

/// Nearest 1/256, ties to even.
int fixed(double scaled) {
    const double steps = scaled * 256.0;
    double whole = std::floor(steps);
    const double rest = steps - whole;
    if (rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) != 0)) whole += 1;
    return static_cast<int>(whole);
}

}  // namespace

TEST_CASE("the texel over each of the 24 edges is the adjacent one", "[7.18.12]") {
    for (const Profile& preset : {load_profile("d3d11"), load_profile("ideal")})
        for (const int size : kSizes) {
            const Texture texture = numbered_cube(size);
            for (int face = 0; face < 6; ++face)
                for (int edge = 0; edge < 4; ++edge)
                    for (int i = 0; i < size; ++i) {
                        // A texel's centre along the edge, just inside the face across it.
                        const double middle = (2.0 * i + 1) / size - 1;
                        const double rim = (edge & 1) != 0 ? 1 - 0x1p-10 : -1 + 0x1p-10;
                        const int beyond = (edge & 1) != 0 ? size : -1;
                        const bool across_x = edge < 2;
                        const Point d = across_x ? on_face(face, rim, middle) : on_face(face, middle, rim);
                        const Texel over = across_x ? Texel{face, beyond, i} : Texel{face, i, beyond};
                        const Texel inner =
                            across_x ? Texel{face, beyond < 0 ? 0 : size - 1, i} : Texel{face, i, beyond < 0 ? 0 : size - 1};
                        const Texel expected = nearest_over_edge(over, size);

                        const SampleRecord record = record_sample(TextureView(texture), Sampler{}, preset, towards(d));
                        double weight_over = 0;
                        double weight_inner = 0;
                        double total = 0;
                        for (const TapRecord& tap : record.probes[0].levels[0].taps) {
                            total += tap.weight;
                            const bool is_over = tap.value[0] == static_cast<double>(number_of(expected, size));
                            const bool is_inner = tap.value[0] == static_cast<double>(number_of(inner, size));
                            if (is_over && !tap.corner) weight_over += tap.weight;
                            if (is_inner && !tap.corner) weight_inner += tap.weight;
                            if (is_over && !tap.corner && !(Texel{tap.layer, tap.x, tap.y} == expected))
                                FAIL(fmt::format("{} size {}: the record calls face {} ({}, {}) face {} ({}, {})", preset.name,
                                                 size, expected.face, expected.x, expected.y, tap.layer, tap.x, tap.y));
                        }
                        // Nearly half and half; thirds of sizes leave one step of 1/256 along the edge.
                        if (!(std::fabs(total - 1) < 1e-12 && std::fabs(weight_over - 0.5) < 0.02 &&
                              std::fabs(weight_inner - 0.5) < 0.02))
                            FAIL(fmt::format("{} size {} face {} edge {} texel {}: weight {} of face {} ({}, {}), {} inside",
                                             preset.name, size, face, edge, i, weight_over, expected.face, expected.x,
                                             expected.y, weight_inner));
                    }
        }
}

TEST_CASE("filters near edges and corners weight the virtual grid", "[7.18.12]") {
    for (const CubeCorner rule : {CubeCorner::ThreeTexels, CubeCorner::TwoAdjacent})
        for (const int size : kSizes) {
            oracle::Random random(static_cast<std::uint64_t>(size));
            std::vector<float> values(static_cast<std::size_t>(6 * size * size));
            for (float& value : values) value = random.in(-1.0f, 1.0f);
            const auto value_of = [&](const Texel& t) {
                return values[static_cast<std::size_t>((t.face * size + t.y) * size + t.x)];
            };
            const Texture texture = cube_of(size, value_of);
            Profile profile;
            profile.cube_corner = rule;
            int corners = 0;
            int edges = 0;
            for (int round = 0; round < 4000; ++round) {
                const int face = random.integer(0, 5);
                // Multiples of 2^-10 on the face: nothing before the fixed point rounds. Half of the positions near a corner.
                const auto position = [&] {
                    const int steps = random.integer(0, 1 + 1022 / (random.chance(2) ? 1 : 2 * size));
                    return (random.chance(2) ? 1 : -1) * (1023 - steps) / 1024.0;
                };
                const double right = position();
                const double down = position();
                const int u = fixed((right * 0.5 + 0.5) * size - 0.5);
                const int v = fixed((down * 0.5 + 0.5) * size - 0.5);
                const int x = static_cast<int>(std::floor(u / 256.0));
                const int y = static_cast<int>(std::floor(v / 256.0));
                const double wu = (u - 256 * x) / 256.0;
                const double wv = (v - 256 * y) / 256.0;

                // The virtual grid of four texels: on the face, over an edge, or missing.
                double sum = 0;
                double missing = 0;
                std::array<double, 4> known{};
                std::array<bool, 4> is_known{};
                for (std::size_t tap = 0; tap < 4; ++tap) {
                    const Texel t{face, x + static_cast<int>(tap & 1), y + static_cast<int>(tap >> 1)};
                    const double weight = ((tap & 1) != 0 ? wu : 1 - wu) * ((tap & 2) != 0 ? wv : 1 - wv);
                    const bool in_x = inside(t.x, size);
                    const bool in_y = inside(t.y, size);
                    if (!in_x && !in_y) {
                        missing = weight;
                        continue;
                    }
                    edges += in_x != in_y;
                    known[tap] = static_cast<double>(value_of(in_x && in_y ? t : nearest_over_edge(t, size)));
                    is_known[tap] = true;
                    sum += weight * known[tap];
                }
                // "divide the weight for the missing texel evenly amongst the 3 other texels" or "just split the weight ...
                // across the 2 adjacent texels": the two that share a side with it.
                for (std::size_t tap = 0; tap < 4; ++tap) {
                    if (is_known[tap]) continue;
                    ++corners;
                    sum += rule == CubeCorner::ThreeTexels ? missing * (known[tap ^ 1] + known[tap ^ 2] + known[tap ^ 3]) / 3.0
                                                           : missing * (known[tap ^ 1] + known[tap ^ 2]) / 2.0;
                }
                const Point d = on_face(face, right, down);
                const Vec4<Float> color = sample(
                    TextureView(texture), Sampler{}, profile,
                    Vec3<Float>{Float(static_cast<float>(d.x)), Float(static_cast<float>(d.y)), Float(static_cast<float>(d.z))},
                    LevelOfDetail<Float>(Float(0.0f)));
                // Three lerps of values up to 1, and the four roundings of a mean.
                if (std::fabs(static_cast<double>(lane(color.x, 0)) - sum) > 16 * 0x1p-23)
                    FAIL(fmt::format("{} size {} round {} face {} at ({:a}, {:a}): {:a}, expected {:a}", name_of(rule), size,
                                     round, face, right, down, lane(color.x, 0), sum));
            }
            CHECK(corners > 200);
            CHECK(edges > 500);
        }
}

TEST_CASE("faces that are filtered on their own repeat their edge texels", "[7.18.12]") {
    Profile profile;
    profile.cube_edges = CubeEdges::PerFace;
    for (const int size : kSizes) {
        const Texture texture = numbered_cube(size);
        oracle::Random random(static_cast<std::uint64_t>(size) + 50);
        for (int round = 0; round < 2000; ++round) {
            const int face = random.integer(0, 5);
            const double right = random.integer(-1023, 1023) / 1024.0;
            const double down = random.integer(-1023, 1023) / 1024.0;
            const int u = fixed((right * 0.5 + 0.5) * size - 0.5);
            const int v = fixed((down * 0.5 + 0.5) * size - 0.5);
            const int x = static_cast<int>(std::floor(u / 256.0));
            const int y = static_cast<int>(std::floor(v / 256.0));
            double sum = 0;
            for (int tap = 0; tap < 4; ++tap) {
                const Texel t{face, std::clamp(x + (tap & 1), 0, size - 1), std::clamp(y + (tap >> 1), 0, size - 1)};
                const double wu = (u - 256 * x) / 256.0;
                const double wv = (v - 256 * y) / 256.0;
                sum +=
                    ((tap & 1) != 0 ? wu : 1 - wu) * ((tap & 2) != 0 ? wv : 1 - wv) * static_cast<double>(number_of(t, size));
            }
            const SampleRecord record =
                record_sample(TextureView(texture), Sampler{}, profile, towards(on_face(face, right, down)));
            for (const TapRecord& tap : record.probes[0].levels[0].taps)
                if (tap.layer != face || tap.corner) FAIL(fmt::format("face {}: a tap on face {}", face, tap.layer));
            if (std::fabs(record.result[0] - sum) > 6 * size * size * 8 * 0x1p-23)
                FAIL(fmt::format("size {} round {} face {}: {:a}, expected {:a}", size, round, face, record.result[0], sum));
        }
    }
}

TEST_CASE("a seam is invisible: both sides of an edge give the same colour", "[7.18.12]") {
    for (const int size : kSizes) {
        oracle::Random random(static_cast<std::uint64_t>(size) + 70);
        const Texture texture = cube_of(size, [&](const Texel&) { return random.unit(); });
        for (int round = 0; round < 3000; ++round) {
            // A point of the edge between two faces, and next to it on either; corners need the reference rule.
            const int face = random.integer(0, 5);
            const double along = random.integer(-1000, 1000) / 1024.0;
            const double side = random.chance(2) ? 1 : -1;
            const bool across_x = random.chance(2);
            const Point edge = across_x ? on_face(face, side, along) : on_face(face, along, side);
            const Point out = kFaces[static_cast<std::size_t>(face)].out;
            const SampleRecord here = record_sample(TextureView(texture), Sampler{}, Profile{}, towards(edge + out * 0x1p-14));
            const SampleRecord there =
                record_sample(TextureView(texture), Sampler{}, Profile{}, towards(edge + out * -0x1p-14));
            // Positions differ by less than a step of 1/256 in each axis, and so do weights; texels by at most 1.
            if (std::fabs(here.result[0] - there.result[0]) > 4.0 / 256.0)
                FAIL(fmt::format("size {} round {}: {:a} and {:a} on the sides of ({:a}, {:a}, {:a})", size, round,
                                 here.result[0], there.result[0], edge.x, edge.y, edge.z));
        }
    }
}

TEST_CASE("constant cubes stay constant to the bit", "[7.18.12][7.18.16]") {
    for (const float constant : {1.0f / 3.0f, 1e30f, -0.1f, 65504.0f, 3.0f})
        for (const int size : kSizes) {
            const Texture texture = cube_of(size, [&](const Texel&) { return constant; });
            for (const CubeCorner rule : {CubeCorner::ThreeTexels, CubeCorner::TwoAdjacent}) {
                Profile profile;
                profile.cube_corner = rule;
                oracle::Random random(9);
                for (int round = 0; round < 500; ++round) {
                    const auto component = [&] {
                        return (random.chance(2) ? 1 : -1) * (1.0 - random.integer(0, 300) / 1024.0);
                    };
                    const Point d{component(), component(), component()};
                    const double got = record_sample(TextureView(texture), Sampler{}, profile, towards(d)).result[0];
                    if (got != static_cast<double>(constant))
                        FAIL(fmt::format("{} size {} ({:a}, {:a}, {:a}): {:a}, not {:a}", name_of(rule), size, d.x, d.y, d.z,
                                         got, constant));
                }
            }
        }
}

TEST_CASE("point samples never leave the face", "[7.18.12]") {
    const Texture texture = numbered_cube(4);
    const Sampler nearest{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest};
    for (int face = 0; face < 6; ++face)
        for (const double right : {-1 + 0x1p-20, -0.3, 1 - 0x1p-20})
            for (const double down : {-1 + 0x1p-20, 0.2, 1 - 0x1p-20}) {
                const SampleRecord record =
                    record_sample(TextureView(texture), nearest, Profile{}, towards(on_face(face, right, down)));
                REQUIRE(record.probes[0].levels[0].taps.size() == 1);
                CHECK(record.probes[0].levels[0].taps[0].layer == face);
            }
}
