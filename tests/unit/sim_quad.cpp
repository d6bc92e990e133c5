// Derivatives on all patterns of four lanes. D3D11.3 22.5
#include "sim/quad.h"
#include "tests/oracle/random.h"

#include <catch2/catch.hpp>

using namespace gnomon;

namespace {

template <class Real>
void check_derivatives() {
    using Scalar = typename Real::Scalar;
    constexpr std::array<float, 5> kValues{0.0f, 1.0f, -2.5f, 1e10f, 0.1f};
    oracle::Random random(1);
    for (int pattern = 0; pattern < 625; ++pattern) {
        std::array<Scalar, kLanes> x;
        for (std::size_t i = 0; i < kLanes; ++i) x[i] = static_cast<Scalar>(random.in(-10.0f, 10.0f));
        // The pattern in each quad in turn; other quads hold noise that must not leak in.
        const std::size_t quad = 4 * (static_cast<std::size_t>(pattern) % kQuadsPerWave);
        for (int i = 0, rest = pattern; i < 4; ++i, rest /= 5)
            x[quad + static_cast<std::size_t>(i)] = static_cast<Scalar>(kValues[static_cast<std::size_t>(rest % 5)]);
        const Real v = Real::load(x.data());
        const auto dx = ddx_coarse(v).lanes();
        const auto dy = ddy_coarse(v).lanes();
        const auto fx = ddx_fine(v).lanes();
        const auto fy = ddy_fine(v).lanes();
        const auto b3 = quad_broadcast<3>(v).lanes();
        for (std::size_t i = 0; i < kLanes; ++i) {
            const std::size_t q = i / 4 * 4;
            REQUIRE(dx[i] == x[q + 1] - x[q]);
            REQUIRE(dy[i] == x[q + 2] - x[q]);
            REQUIRE(fx[i] == (i % 4 < 2 ? x[q + 1] - x[q] : x[q + 3] - x[q + 2]));
            REQUIRE(fy[i] == (i % 2 == 0 ? x[q + 2] - x[q] : x[q + 3] - x[q + 1]));
            REQUIRE(b3[i] == x[q + 3]);
        }
    }
}

}  // namespace

TEST_CASE("coarse and fine derivatives in Float", "[quad][22.5.2][22.5.4]") { check_derivatives<Float>(); }
TEST_CASE("coarse and fine derivatives in Double", "[quad][22.5.2][22.5.4]") { check_derivatives<Double>(); }

TEST_CASE("readers of a lane are those whose difference changes with it", "[quad][22.5.2][22.5.4]") {
    std::array<float, kLanes> before;
    for (std::size_t i = 0; i < kLanes; ++i) before[i] = static_cast<float>(i * i);
    const auto check = [&](const auto& difference, const auto& readers) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            std::array<float, kLanes> after = before;
            after[lane] += 1000.0f;
            const Mask changed = difference(Float::load(before.data())) != difference(Float::load(after.data()));
            REQUIRE((readers(1u << lane) & kAllLanes) == changed.bits());
        }
        // Of several lanes: those of each.
        for (std::uint32_t bits = 0; bits <= kAllLanes; bits += 1 + bits / 37) {
            std::uint32_t expected = 0;
            for (std::size_t lane = 0; lane < kLanes; ++lane)
                if ((bits >> lane & 1u) != 0) expected |= readers(1u << lane);
            REQUIRE(readers(bits) == expected);
        }
    };
    check([](Float x) { return ddx_fine(x); }, ddx_fine_readers);
    check([](Float x) { return ddy_fine(x); }, ddy_fine_readers);
    for (const auto& [corner, name] : kEnumNames<DerivativeCorner>) {
        INFO(name);
        check([&](Float x) { return ddx_coarse(x, corner); },
              [&](std::uint32_t bits) { return ddx_coarse_readers(bits, corner); });
        check([&](Float x) { return ddy_coarse(x, corner); },
              [&](std::uint32_t bits) { return ddy_coarse_readers(bits, corner); });
    }
}

TEST_CASE("quad_any spreads a lane over its quad", "[quad]") {
    for (std::uint32_t bits = 0; bits <= kAllLanes; ++bits) {
        std::uint32_t expected = 0;
        for (int q = 0; q < kQuadsPerWave; ++q)
            if ((bits >> (4 * q) & 0xfu) != 0) expected |= 0xfu << (4 * q);
        REQUIRE(quad_any(bits) == expected);
    }
}
