// D3D11.3 7.18.9: each texel index is wrapped on its own; border colour where any axis is out. 7.18.9.1
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/address.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

constexpr std::array kModes{AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp, AddressMode::Border};

}  // namespace

TEST_CASE("texel indices wrap as the specification's pseudocode", "[7.18.9]") {
    for (const int size : {1, 2, 3, 5, 8, 17, 1024, 16384})
        for (const AddressMode mode : kModes) {
            // Wrap coordinates are within [-1, size]; mirror ones within [-2 size - 1, 2 size].
            const int low = mode == AddressMode::Wrap ? -1 : mode == AddressMode::Mirror ? -2 * size - 1 : -10 * size - 1;
            const int high = mode == AddressMode::Wrap ? size : mode == AddressMode::Mirror ? 2 * size : 10 * size + 1;
            for (int t = low; t <= high; ++t) {
                const std::int64_t expected = oracle::address(t, size, oracle_mode(mode));
                const int got = lane(apply_address_mode(Int(t), Int(size), mode), 0);
                const bool border = (outside(Int(t), Int(size), mode).bits() & 1u) != 0;
                if (border != (expected < 0) || (expected >= 0 && got != expected) || got < 0 || got >= size)
                    FAIL(fmt::format("{} of {} in {}: {} border {}, expected {}", name_of(mode), t, size, got, border,
                                     expected));
            }
        }
}

TEST_CASE("linear samples across every edge take the texels the modes say", "[7.18.9][7.18.8]") {
    for (const auto& [width, height] : {std::pair{1, 1}, std::pair{2, 3}, std::pair{5, 4}, std::pair{8, 1}}) {
        std::vector<std::uint32_t> codes(static_cast<std::size_t>(width * height));
        for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = std::bit_cast<std::uint32_t>(static_cast<float>(1 << i % 20));
        const Texture texture = texture_of(Format::R32Float, width, height, codes);
        oracle::Image image{width, height, {}, 3.0};
        for (const std::uint32_t code : codes) image.texels.push_back(static_cast<double>(std::bit_cast<float>(code)));
        for (const AddressMode mode_u : kModes)
            for (const AddressMode mode_v : kModes) {
                const Sampler sampler{.address_u = mode_u, .address_v = mode_v, .border = glm::vec4(3.0f)};
                std::vector<Coordinate> coordinates;
                for (int y = -3 * height; y <= 4 * height; ++y)
                    for (int x = -3 * width; x <= 4 * width; ++x)
                        for (const float f : {0.0f, 0.25f, 0.5f, 0.7f})
                            coordinates.push_back({(static_cast<float>(x) + f) / static_cast<float>(width),
                                                   (static_cast<float>(y) + 0.5f * f) / static_cast<float>(height)});
                const auto got = sample_all(texture, sampler, Profile{}, coordinates);
                for (std::size_t i = 0; i < got.size(); ++i) {
                    const auto u = oracle::linear_axis(coordinates[i].u, width, oracle_mode(mode_u));
                    const auto v = oracle::linear_axis(coordinates[i].v, height, oracle_mode(mode_v));
                    const double exact = oracle::bilinear(image.taps(u, v), u.weight, v.weight);
                    // Three lerps of differences up to the largest texel, three roundings each, the inner two averaged.
                    if (std::fabs(static_cast<double>(got[i][0]) - exact) > std::ranges::max(image.taps(u, v)) * 0x1p-21)
                        FAIL(fmt::format("{}x{} {} {} uv ({:a}, {:a}): {:a}, exact {:a}", width, height, name_of(mode_u),
                                         name_of(mode_v), coordinates[i].u, coordinates[i].v, got[i][0], exact));
                }
            }
    }
}

TEST_CASE("the border colour is clamped to the format's range", "[7.18.9.1]") {
    for (const FormatInfo& info : kFormats) {
        const std::vector<std::uint32_t> codes(static_cast<std::size_t>(info.components), 0);
        const Texture texture = texture_of(info.format, 1, 1, codes);
        const Sampler sampler{.min = TexelFilter::Nearest,
                              .mag = TexelFilter::Nearest,
                              .address_u = AddressMode::Border,
                              .address_v = AddressMode::Border,
                              .border = {2.0f, -1.0f, 0.25f, 9.0f}};
        const bool is_signed = info.type == ComponentType::Snorm8 || info.type == ComponentType::Snorm16;
        const bool limited = info.is_depth || info.type == ComponentType::Unorm8 || info.type == ComponentType::Unorm16 ||
                             info.type == ComponentType::Srgb8;
        const bool positive = limited || info.is_integer() || info.type == ComponentType::Float11;
        // Outside in u only, in v only, in both.
        for (const auto& color :
             sample_all(texture, sampler, Profile{}, std::vector<Coordinate>{{1.5f, 0.5f}, {0.5f, -0.7f}, {-3.0f, 3.0f}})) {
            INFO(info.name);
            CHECK(color[0] == (limited || is_signed ? 1.0f : 2.0f));
            CHECK(color[1] == (info.components < 2 || positive ? 0.0f : -1.0f));
            if (info.components < 4) {
                CHECK(color[2] == (info.components == 3 ? 0.25f : 0.0f));
                CHECK(color[3] == 1.0f);
            } else {
                CHECK(std::fabs(color[2] - 0.25f) <= 1.0f / 512.0f);  // snapped at most to the format's precision
                CHECK(color[3] == (limited || is_signed ? 1.0f : 9.0f));
            }
        }
        CHECK(sample_all(texture, sampler, Profile{}, std::vector<Coordinate>{{0.5f, 0.5f}})[0][0] == 0.0f);
    }
}

TEST_CASE("texels outside a level load as zero", "[22.4.6]") {
    const std::vector<std::uint32_t> codes(15, std::bit_cast<std::uint32_t>(4.0f));
    const Texture texture = texture_of(Format::R32Float, 5, 3, codes);
    for (const auto& [x, y] : {std::pair{-1, 0}, std::pair{0, -1}, std::pair{5, 0}, std::pair{0, 3},
                               std::pair{INT32_MAX, INT32_MAX}, std::pair{INT32_MIN, 1}}) {
        const Vec4<Float> color = load_texel<Float>(texture, Int(x), Int(y), 0);
        CHECK(lane(color.x, 0) == 0.0f);
        CHECK(lane(color.w, 0) == 1.0f);  // the default of a missing component
    }
    CHECK(lane(load_texel<Float>(texture, Int(4), Int(2), 0).x, 0) == 4.0f);
    CHECK(lane(load_texel<Float>(texture, Int(4), Int(2), 0).w, 0) == 1.0f);
}
