// D3D11.3 7.18.11, 7.18.13: derivatives of directions become derivatives on a cube's face.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/record.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

using Vector = std::array<long double, 3>;

/// Position on the face of `d`, where the direction is `at`: minor axes over the major, halved. 7.18.7, 5.3.8
std::array<long double, 2> on_face(const Vector& d, const Vector& at) {
    std::size_t major = 2;
    for (const std::size_t axis : {std::size_t{1}, std::size_t{0}})
        if (std::fabs(d[axis]) > std::fabs(d[major])) major = axis;
    const long double sign = d[major] < 0 ? -1 : 1;
    const long double right = major == 0 ? -sign * at[2] : major == 1 ? at[0] : sign * at[0];
    const long double down = major == 1 ? sign * at[2] : -at[1];
    const long double axis = sign * at[major];
    return {right / axis * 0.5L + 0.5L, down / axis * 0.5L + 0.5L};
}

/// Its derivative along `change`, by central differences: the error is below step^2 times the third derivative.
std::array<long double, 2> slope(const Vector& d, const Vector& change, long double step) {
    Vector ahead = d;
    Vector behind = d;
    for (std::size_t i = 0; i < 3; ++i) {
        ahead[i] += step * change[i];
        behind[i] -= step * change[i];
    }
    const auto a = on_face(d, ahead);
    const auto b = on_face(d, behind);
    return {(a[0] - b[0]) / (2 * step), (a[1] - b[1]) / (2 * step)};
}

Vector random_vector(oracle::Random& random, float size) {
    const auto component = [&] { return static_cast<long double>(random.in(-size, size)); };
    return {component(), component(), component()};
}

template <class Real>
Vec3<Real> lanes_of(const Vector& v) {
    using Scalar = typename Real::Scalar;
    return {Real(static_cast<Scalar>(v[0])), Real(static_cast<Scalar>(v[1])), Real(static_cast<Scalar>(v[2]))};
}

}  // namespace

TEMPLATE_TEST_CASE("cube derivatives are the slopes of the position on the face", "[7.18.11]", Float, Double) {
    oracle::Random random(1);
    const double step = std::is_same_v<TestType, Float> ? 0x1p-24 : 1e-12;  // differences are good for less than double
    std::array<int, 3> axes{};
    for (int round = 0; round < 20000; ++round) {
        const Vector d = random_vector(random, 2.0f);
        Vector dx = random_vector(random, 0.25f);
        const Vector dy = random_vector(random, 0.25f);
        if (round % 5 == 0) dx = {0, 0, 0};
        const long double major = std::max({std::fabs(d[0]), std::fabs(d[1]), std::fabs(d[2])});
        if (major < 0.1L) continue;
        for (std::size_t i = 0; i < 3; ++i) axes[i] += std::fabs(d[i]) == major;
        const Gradients<TestType> got = cube_gradients(lanes_of<TestType>(d), lanes_of<TestType>(dx), lanes_of<TestType>(dy));
        const auto check = [&](const TestType& value, long double expected, const Vector& change) {
            // Two products of at most |d| |change| cancel, over the square of the major axis.
            const long double size = (std::fabs(change[0]) + std::fabs(change[1]) + std::fabs(change[2])) / major;
            const auto number = static_cast<long double>(lane(value, 0));
            if (std::fabs(number - expected) > size * 8 * static_cast<long double>(step))
                FAIL(fmt::format("round {} direction ({:a}, {:a}, {:a}) change ({:a}, {:a}, {:a}): {:a}, expected {:a}", round,
                                 static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2]),
                                 static_cast<double>(change[0]), static_cast<double>(change[1]), static_cast<double>(change[2]),
                                 static_cast<double>(number), static_cast<double>(expected)));
        };
        const auto along_x = slope(d, dx, 0x1p-20L);
        const auto along_y = slope(d, dy, 0x1p-20L);
        check(got.dx.x, along_x[0], dx);
        check(got.dx.y, along_x[1], dx);
        check(got.dy.x, along_y[0], dy);
        check(got.dy.y, along_y[1], dy);
    }
    for (const int count : axes) CHECK(count > 1000);
}

TEST_CASE("a cube's level of detail is log2 of the longer slope in texels, isotropic for every sampler", "[7.18.11][7.18.13]") {
    for (const int size : {16, 64, 100}) {
        const Texture texture({.format = Format::R32Float,
                               .width = size,
                               .height = size,
                               .levels = 5,
                               .kind = TextureKind::Cube,
                               .layers = kCubeFaces});
        oracle::Random random(static_cast<std::uint64_t>(size));
        for (int round = 0; round < 3000; ++round) {
            const Vector d = random_vector(random, 1.0f);
            const Vector dx = random_vector(random, 0.125f);
            const Vector dy = random_vector(random, 0.125f);
            const long double major = std::max({std::fabs(d[0]), std::fabs(d[1]), std::fabs(d[2])});
            if (major < 0.1L) continue;
            const auto narrow = [](const Vector& v) {
                return std::array{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
            };
            const int base = random.integer(0, 2);
            const SampleRecord record = record_sample(
                TextureView(texture, base, 5 - base),
                Sampler{.mip = MipFilter::Linear, .max_anisotropy = random.chance(2) ? 16 : 1}, Profile{},
                SampleRequest{.coordinate = narrow(d), .gradient = SampleRequest::Gradient{narrow(dx), narrow(dy)}});
            const auto x = slope(d, dx, 0x1p-20L);
            const auto y = slope(d, dy, 0x1p-20L);
            const long double longest = std::max(std::hypot(x[0], x[1]), std::hypot(y[0], y[1])) * (size >> base);
            const long double expected = std::log2(longest);
            // The slope's error relative to its own length, which cancellation can make small.
            const long double change = (std::fabs(dx[0]) + std::fabs(dx[1]) + std::fabs(dx[2]) + std::fabs(dy[0]) +
                                        std::fabs(dy[1]) + std::fabs(dy[2])) /
                                       major * (size >> base);
            const long double bound = 16 * 0x1p-24L * change / longest / std::log(2.0L) + 0x1p-21L;
            if (std::fabs(static_cast<long double>(record.lod) - expected) > bound)
                FAIL(fmt::format("size {} round {}: {:a}, expected {:a}", size, round, record.lod,
                                 static_cast<double>(expected)));
            REQUIRE(record.probes.size() == 1);
            REQUIRE(record.ratio == 1.0);
        }
    }
}
