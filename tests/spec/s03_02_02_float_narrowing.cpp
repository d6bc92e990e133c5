// D3D11.3 3.2.2: floats become narrower floats toward zero where they meet a 16-bit target; the profile can say otherwise.
#include "sim/half.h"
#include "tests/oracle/random.h"
#include "tests/oracle/texture.h"
#include "tests/unit/pipeline_programs.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// The half a draw of the constant x stores, through ClearColor and through the output merger.
std::vector<std::uint16_t> stored(const Profile& profile, const std::vector<float>& values) {
    Device device(profile, 1);
    const TextureId target = device.create_texture("h", {.format = Format::R16Float, .width = 2, .height = 2});
    std::vector<TestVertex> vertices;
    for (const float a : values) {
        vertices.push_back({-1, 1, 0, 1, a, 0});
        vertices.push_back({3, 1, 0, 1, a, 0});
        vertices.push_back({-1, -3, 0, 1, a, 0});
    }
    Draw draw = make_draw(id_program(), upload(device, vertices), 0, 3);
    draw.color[0] = target;
    std::vector<std::uint16_t> halves;
    for (std::size_t i = 0; i < values.size(); ++i) {
        draw.first = static_cast<std::uint32_t>(3 * i);
        device.execute(draw);
        std::uint16_t drawn = 0;
        std::memcpy(&drawn, device.texture(target).row(0, 1) + 2, 2);
        device.execute(ClearColor{target, glm::vec4(values[i])});
        std::uint16_t cleared = 0;
        std::memcpy(&cleared, device.texture(target).row(0, 0), 2);
        if (drawn != cleared) FAIL(fmt::format("{:a}: drawn {:#06x}, cleared {:#06x}", values[i], drawn, cleared));
        halves.push_back(drawn);
    }
    return halves;
}

}  // namespace

TEST_CASE("narrowing toward zero never grows a value and leaves less than one unit", "[3.2.2]") {
    oracle::Random random(1);
    std::vector<float> values{65504.0f, 65519.0f, 65520.0f,   1e10f,    -1e10f,       1.0f,
                              -1.0f,    0x1p-24f, 0x1.8p-24f, 0x1p-25f, 0x1.ffcp-15f, 0x1.ffep-15f};
    for (int i = 0; i < 3000; ++i) values.push_back(std::ldexp(random.in(-2.0f, 2.0f), random.integer(-26, 15)));
    const auto halves = stored(Profile{}, values);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double x = std::fabs(static_cast<double>(values[i]));
        const double h = std::fabs(oracle::half_value(halves[i]));
        const double next = (halves[i] & 0x7fffu) == 0x7bffu ? HUGE_VAL : oracle::half_value((halves[i] & 0x7fffu) + 1u);
        if (!(h <= x && x < next) || (values[i] != 0 && std::signbit(values[i]) != ((halves[i] & 0x8000u) != 0)))
            FAIL(fmt::format("{:a} stored as {:#06x} = {:a}", values[i], halves[i], h));
    }
}

TEST_CASE("finite values stay finite, infinities and NaN stay what they are", "[3.2.2]") {
    CHECK(half_from_float(3e38f, Narrowing::TowardZero).bits == 0x7bff);
    CHECK(half_from_float(-3e38f, Narrowing::TowardZero).bits == 0xfbff);
    CHECK(half_from_float(HUGE_VALF, Narrowing::TowardZero).bits == 0x7c00);
    CHECK((half_from_float(std::nanf(""), Narrowing::TowardZero).bits & 0x7fffu) > 0x7c00u);
}

TEST_CASE("a profile that rounds to nearest stores the nearest half", "[3.2.2]") {
    Profile nearest;
    nearest.float_narrowing = Narrowing::NearestEven;
    oracle::Random random(2);
    std::vector<float> values;
    for (int i = 0; i < 3000; ++i) values.push_back(std::ldexp(random.in(-2.0f, 2.0f), random.integer(-26, 14)));
    const auto halves = stored(nearest, values);
    int up = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double x = std::fabs(static_cast<double>(values[i]));
        const std::uint32_t code = halves[i] & 0x7fffu;
        const double error = std::fabs(oracle::half_value(code) - x);
        const double below = code == 0 ? HUGE_VAL : std::fabs(oracle::half_value(code - 1) - x);
        const double above = std::fabs(oracle::half_value(code + 1) - x);
        if (error > below || error > above) FAIL(fmt::format("{:a} stored as {:#06x}", values[i], halves[i]));
        up += oracle::half_value(code) > x;
    }
    CHECK(up > 1000);
}
