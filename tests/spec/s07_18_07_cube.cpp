// D3D11.3 7.18.7, 5.3.8: which face and texel of a cube a direction selects.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

using Direction = std::array<double, 3>;

/// The axes of each face: out, right and down, each an index of x, y, z with a sign. D3D11.3 5.3.8
struct Axis {
    std::size_t index;
    int sign;
};
struct Face {
    Axis out, right, down;
};
constexpr std::array<Face, 6> kFaces{{{{0, 1}, {2, -1}, {1, -1}},
                                      {{0, -1}, {2, 1}, {1, -1}},
                                      {{1, 1}, {0, 1}, {2, 1}},
                                      {{1, -1}, {0, 1}, {2, -1}},
                                      {{2, 1}, {0, 1}, {1, -1}},
                                      {{2, -1}, {0, -1}, {1, -1}}}};

/// "Choose the largest magnitude component ... In the case of a tie, the following precedence should occur: Z, Y, X."
int face_of_direction(const Direction& d) {
    std::size_t major = 2;
    for (const std::size_t axis : {std::size_t{1}, std::size_t{0}})
        if (std::fabs(d[axis]) > std::fabs(d[major])) major = axis;
    return static_cast<int>(2 * major + (d[major] < 0 ? 1 : 0));
}

Texture numbered_cube(int size) {
    Texture texture({.format = Format::R32Float,
                     .width = size,
                     .height = size,
                     .levels = 1,
                     .kind = TextureKind::Cube,
                     .layers = kCubeFaces});
    for (int face = 0; face < kCubeFaces; ++face) {
        std::vector<float> values;
        for (int i = 0; i < size * size; ++i) values.push_back(static_cast<float>(face * size * size + i));
        texture.set_level_bytes(0, std::as_bytes(std::span(values)).data(), values.size() * 4, face);
    }
    return texture;
}

template <class Real>
std::vector<typename Real::Scalar> sample_directions(const Texture& texture, const Sampler& sampler, const Profile& profile,
                                                     const std::vector<Direction>& directions) {
    std::vector<typename Real::Scalar> out;
    for (std::size_t first = 0; first < directions.size(); first += kLanes) {
        const auto field = [&](std::size_t axis) {
            std::array<typename Real::Scalar, kLanes> values;
            for (std::size_t l = 0; l < values.size(); ++l)
                values[l] = static_cast<typename Real::Scalar>(directions[std::min(first + l, directions.size() - 1)][axis]);
            return Real::load(values.data());
        };
        const Vec4<Real> color = sample(TextureView(texture), sampler, profile, Vec3<Real>{field(0), field(1), field(2)},
                                        LevelOfDetail<Real>(Real(0.0f)));
        for (int l = 0; l < kLanes && first + static_cast<std::size_t>(l) < directions.size(); ++l)
            out.push_back(lane(color.x, l));
    }
    return out;
}

constexpr Sampler kNearest{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest};

}  // namespace

TEMPLATE_TEST_CASE("the largest component selects the face, ties in the order z, y, x", "[7.18.7][5.3.8]", Float, Double) {
    const Texture texture = numbered_cube(1);
    std::vector<Direction> directions;
    // Every combination of magnitudes 0, 1, 2 and signs: all ties there are.
    for (int x = -2; x <= 2; ++x)
        for (int y = -2; y <= 2; ++y)
            for (int z = -2; z <= 2; ++z)
                for (const double scale : {1.0, 0x1p-100, 0x1p100, 3.0}) {
                    if (x == 0 && y == 0 && z == 0) continue;
                    directions.push_back({x * scale, y * scale, z * scale});
                    directions.push_back({x == 0 ? -0.0 : x * scale, y == 0 ? -0.0 : y * scale, z == 0 ? -0.0 : z * scale});
                }
    // One float away from ties.
    for (int axis = 0; axis < 3; ++axis)
        for (int bits = 0; bits < 8; ++bits) {
            Direction d{(bits & 1) != 0 ? -1.0 : 1.0, (bits & 2) != 0 ? -1.0 : 1.0, (bits & 4) != 0 ? -1.0 : 1.0};
            for (const double factor : {1.0 + 0x1p-23, 1.0 - 0x1p-24}) {
                Direction near = d;
                near[static_cast<std::size_t>(axis)] *= factor;
                directions.push_back(near);
            }
        }
    oracle::Random random(1);
    for (int i = 0; i < 20000; ++i) {
        const auto component = [&] { return static_cast<double>(random.in(-1.0f, 1.0f)); };
        directions.push_back({component(), component(), component()});
    }
    const auto got = sample_directions<TestType>(texture, kNearest, Profile{}, directions);
    std::array<int, 6> seen{};
    for (std::size_t i = 0; i < got.size(); ++i) {
        const int expected = face_of_direction(directions[i]);
        ++seen[static_cast<std::size_t>(expected)];
        if (got[i] != static_cast<typename TestType::Scalar>(expected))
            FAIL(fmt::format("({:a}, {:a}, {:a}): face {}, expected {}", directions[i][0], directions[i][1], directions[i][2],
                             got[i], expected));
    }
    for (const int count : seen) CHECK(count > 1000);
}

TEMPLATE_TEST_CASE("directions project to the texel under them", "[7.18.7]", Float, Double) {
    // Components on the face are multiples of 2^-9 and the others powers of two: nothing before the fixed point rounds.
    for (const int size : {1, 2, 3, 5, 8, 64}) {
        const Texture texture = numbered_cube(size);
        std::vector<Direction> directions;
        std::vector<int> expected;
        for (int face = 0; face < 6; ++face)
            for (int down = -511; down < 512; down += 7)
                for (int right = -511; right < 512; right += 5) {
                    const Face& axes = kFaces[static_cast<std::size_t>(face)];
                    const double major = std::ldexp(1.0, (right + down) % 5);
                    Direction d{};
                    d[axes.out.index] = axes.out.sign * major;
                    d[axes.right.index] = axes.right.sign * major * right / 512.0;
                    d[axes.down.index] = axes.down.sign * major * down / 512.0;
                    directions.push_back(d);
                    // Position * 0.5 + 0.5, then fixed point as for a 2D texture: nearest 1/256, ties to even, floor.
                    const auto texel = [&](int position) {
                        const double scaled = (position / 512.0 * 0.5 + 0.5) * size * 256.0;
                        double whole = std::floor(scaled);
                        const double rest = scaled - whole;
                        if (rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) != 0)) whole += 1;
                        return std::min(static_cast<int>(std::floor(whole / 256.0)), size - 1);
                    };
                    expected.push_back(face * size * size + texel(down) * size + texel(right));
                }
        const auto got = sample_directions<TestType>(texture, kNearest, Profile{}, directions);
        for (std::size_t i = 0; i < got.size(); ++i)
            if (got[i] != static_cast<typename TestType::Scalar>(expected[i]))
                FAIL(fmt::format("size {} ({:a}, {:a}, {:a}): texel {}, expected {}", size, directions[i][0], directions[i][1],
                                 directions[i][2], got[i], expected[i]));
    }
}

TEST_CASE("only the direction counts, not its length", "[7.18.7]") {
    const Texture texture = numbered_cube(16);
    oracle::Random random(2);
    std::vector<Direction> directions;
    std::vector<Direction> scaled;
    for (int i = 0; i < 5000; ++i) {
        const auto component = [&] { return static_cast<double>(random.in(-1.0f, 1.0f)); };
        const Direction d{component(), component(), component()};
        const double scale = std::ldexp(1.0, random.integer(-60, 60));
        directions.push_back(d);
        scaled.push_back({d[0] * scale, d[1] * scale, d[2] * scale});
    }
    const auto a = sample_directions<Float>(texture, Sampler{}, Profile{}, directions);
    const auto b = sample_directions<Float>(texture, Sampler{}, Profile{}, scaled);
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i] != b[i])
            FAIL(fmt::format("({:a}, {:a}, {:a}): {:a}, longer or shorter {:a}", directions[i][0], directions[i][1],
                             directions[i][2], a[i], b[i]));
    CHECK(a.front() != a.back());
}

TEMPLATE_TEST_CASE("directions that point nowhere still read a texel", "[7.18.7]", Float, Double) {
    const Texture texture = numbered_cube(4);
    const double nan = std::nan("");
    std::vector<Direction> directions;
    const std::array values{0.0, -0.0, 1.0, -1.0, HUGE_VAL, -HUGE_VAL, nan, 1e-45, 3e38};
    for (const double x : values)
        for (const double y : values)
            for (const double z : values) directions.push_back({x, y, z});
    for (const auto& sampler : {kNearest, Sampler{}})
        for (const auto value : sample_directions<TestType>(texture, sampler, Profile{}, directions))
            if (!(value >= 0 && value <= 6 * 16 - 1)) FAIL(fmt::format("{:a} is no texel of the cube", value));
}
