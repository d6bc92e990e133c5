// D3D11.3 7.18.7: point sampling takes the integer part of the 16.8 coordinate.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

TEST_CASE("point sampling picks the texel of the rounded coordinate", "[7.18.7]") {
    oracle::Random random(2);
    for (const auto& [width, height] :
         {std::pair{16, 4}, std::pair{5, 3}, std::pair{1, 1}, std::pair{257, 2}, std::pair{1000, 7}}) {
        std::vector<std::uint32_t> codes(static_cast<std::size_t>(width * height));
        for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = std::bit_cast<std::uint32_t>(static_cast<float>(i + 1));
        const Texture texture = texture_of(Format::R32Float, width, height, codes);
        for (const AddressMode mode_u : {AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp, AddressMode::Border})
            for (const AddressMode mode_v : {AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp, AddressMode::Border}) {
                const Sampler sampler{.min = TexelFilter::Nearest,
                                      .mag = TexelFilter::Nearest,
                                      .address_u = mode_u,
                                      .address_v = mode_v,
                                      .border = glm::vec4(-5.0f)};
                std::vector<Coordinate> coordinates;
                for (int i = 0; i < 600; ++i) {
                    // Around texel boundaries: k - 1/512, the tie of the fixed-point rounding, and its neighbours.
                    const auto near = [&](int size) {
                        float u = (static_cast<float>(random.integer(-2 * size, 3 * size)) +
                                   static_cast<float>(random.integer(-2, 2)) / 512.0f) /
                                  static_cast<float>(size);
                        for (int k = random.integer(-2, 2); k != 0; k += k > 0 ? -1 : 1)
                            u = std::nextafter(u, k > 0 ? 100.0f : -100.0f);
                        return random.chance(3) ? random.in(-3.0f, 4.0f) : u;
                    };
                    coordinates.push_back({near(width), near(height)});
                }
                const auto got = sample_all(texture, sampler, Profile{}, coordinates);
                for (std::size_t i = 0; i < got.size(); ++i) {
                    const auto u = oracle::point_axis(coordinates[i].u, width, oracle_mode(mode_u)).texel[0];
                    const auto v = oracle::point_axis(coordinates[i].v, height, oracle_mode(mode_v)).texel[0];
                    const float expected = u < 0 || v < 0 ? -5.0f : static_cast<float>(v * width + u + 1);
                    if (got[i][0] != expected)
                        FAIL(fmt::format("{}x{} {} {} uv ({:a}, {:a}): value {}, expected {}", width, height, name_of(mode_u),
                                         name_of(mode_v), coordinates[i].u, coordinates[i].v, got[i][0], expected));
                }
            }
    }
}

TEST_CASE("coordinates that are no numbers read a texel and nothing else", "[7.18.7][3.2.4.1]") {
    std::vector<std::uint32_t> codes(16);
    for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = std::bit_cast<std::uint32_t>(static_cast<float>(i + 1));
    const Texture texture = texture_of(Format::R32Float, 4, 4, codes);
    const float inf = HUGE_VALF;
    const float nan = std::nanf("");
    for (const TexelFilter filter : {TexelFilter::Nearest, TexelFilter::Linear})
        for (const AddressMode mode : {AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp, AddressMode::Border}) {
            const Sampler sampler{
                .min = filter, .mag = filter, .address_u = mode, .address_v = mode, .border = glm::vec4(2.5f)};
            const std::vector<Coordinate> coordinates{{nan, nan},      {inf, inf},   {-inf, -inf},     {nan, inf},
                                                      {1e38f, -1e38f}, {-nan, 0.5f}, {-1e-38f, 1e-38f}};
            for (const auto& color : sample_all(texture, sampler, Profile{}, coordinates)) {
                INFO(name_of(filter) << " " << name_of(mode) << " " << color[0]);
                CHECK((color[0] >= 1.0f && color[0] <= 16.0f));
            }
            // NaN is 0 after the conversion to fixed point; infinity clamps where the mode clamps.
            if (filter == TexelFilter::Nearest) {
                CHECK(sample_all(texture, sampler, Profile{}, std::vector<Coordinate>{{nan, nan}})[0][0] == 1.0f);
                if (mode == AddressMode::Clamp)
                    CHECK(sample_all(texture, sampler, Profile{}, std::vector<Coordinate>{{inf, inf}})[0][0] == 16.0f);
                if (mode == AddressMode::Border)
                    CHECK(sample_all(texture, sampler, Profile{}, std::vector<Coordinate>{{-inf, 0.5f}})[0][0] == 2.5f);
            }
        }
}
