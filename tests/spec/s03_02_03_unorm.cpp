// D3D11.3 3.2.3, 19.1.2: what is fetched unmodified and written in the same format keeps every code.
#include "pipeline/program.h"
#include "sim/fixed.h"
#include "tests/unit/pipeline_programs.h"
#include "tests/unit/texunit_calls.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cstring>

using namespace gnomon;
using namespace gnomon::testing;
using namespace gnomon::testing;

namespace {

struct CopyVertex {
    template <class Real>
    struct Input {
        Real x, y;
    };
    template <class Real>
    using Varyings = NoVaryings<Real>;
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return VertexOutput{Vec4<Real>{v.in.x, v.in.y, Real(0.0f), Real(1.0f)}, NoVaryings<Real>{}};
    }
};

struct CopyTexel {
    TextureId source = TextureId::None;
    Sampler sampler{};
    static constexpr auto fields() {
        return std::tuple{Field{"source", &CopyTexel::source}, Field{"sampler", &CopyTexel::sampler}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        return f.sample(source, sampler, {f.position.x * Real(1.0f / 256.0f), f.position.y * Real(1.0f / 256.0f)});
    }
};

}  // namespace

TEST_CASE("a full-screen copy keeps every code of every colour format", "[3.2.3][19.1.2]") {
    static const Program program = make_program<CopyVertex, CopyTexel>("test.copy");
    for (const std::string profile : {"d3d11", "ideal"})
        for (const FormatInfo& info : kFormats) {
            if (info.is_depth || info.is_integer()) continue;  // integers have no float to come through
            Device device(load_profile(profile), 2);
            const TextureDesc desc{.format = info.format, .width = 256, .height = 256};
            const TextureId source = device.create_texture("source", desc);
            const TextureId target = device.create_texture("target", desc);
            // Component k of texel i is i with another multiplier, so that channels differ and all 16-bit codes occur.
            std::vector<std::uint32_t> codes(65536 * static_cast<std::size_t>(info.components));
            for (std::uint32_t i = 0; i < 65536; ++i)
                for (std::uint32_t c = 0; c < static_cast<std::uint32_t>(info.components); ++c) {
                    std::uint32_t code = i * (2 * c + 1);
                    if (info.bits_per_component == 32) code = i * 65537u + c * 77u;
                    // NaNs become the one that is stored (codec.h); floats below the normal range may be flushed (22.4.15);
                    // of the two codes of -1 the higher comes back.
                    const auto bits = static_cast<unsigned>(code_bits(info, static_cast<int>(c)));
                    if (bits < 32) code &= (1u << bits) - 1u;
                    if (info.type == ComponentType::Float16 && (code & 0x7c00u) == 0x7c00u && (code & 0x3ffu) != 0)
                        code = 0x7e00u;
                    if (info.type == ComponentType::Float11) {
                        const std::uint32_t infinity = 31u << (bits - 5);
                        if (code > infinity) code = infinity | 1u << (bits - 6);
                    }
                    if (info.type == ComponentType::Float32 && (code & 0x7f800000u) == 0x7f800000u) code &= 0xff800000u;
                    if (info.type == ComponentType::Float32 && (code & 0x7f800000u) == 0) code &= 0x80000000u;
                    if (info.type == ComponentType::Snorm8 && code == 0x80u) code = 0x81u;
                    if (info.type == ComponentType::Snorm16 && code == 0x8000u) code = 0x8001u;
                    codes[i * static_cast<std::size_t>(info.components) + c] = code;
                }
            const std::vector<std::byte> bytes = packed(info.format, codes);
            device.execute(WriteTexture{source, 0, bytes});
            for (const TexelFilter filter : {TexelFilter::Nearest, TexelFilter::Linear}) {
                if (filter == TexelFilter::Linear &&
                    (info.type == ComponentType::Float16 || info.type == ComponentType::Float32 ||
                     info.type == ComponentType::Float11))
                    continue;  // NaN and signed zeros of neighbours
                const std::array<float, 6> corners{-1, 1, 3, 1, -1, -3};
                const CopyVertex vertex;
                const CopyTexel pixel{.source = source, .sampler = {.min = filter, .mag = filter}};
                Draw draw{.label = "copy",
                          .program = &program,
                          .vertex_constants = constants_of(vertex),
                          .pixel_constants = constants_of(pixel),
                          .vertices = device.create_buffer("v", std::as_bytes(std::span(corners))),
                          .count = 3,
                          .raster = {},
                          .depth_state = {},
                          .viewport = {},
                          .color = {}};
                draw.color[0] = target;
                device.execute(ClearColor{target, glm::vec4(0.1f)});
                device.enable_counters(true);
                device.execute(draw);
                const Counters counters = device.take_counters();
                REQUIRE(counters.texture_instructions == 65536);
                REQUIRE(counters.texels_fetched == (filter == TexelFilter::Linear ? 4u : 1u) * 65536);
                REQUIRE(counters.lanes_helper == 0);
                const auto copied = device.texture(target).level_bytes(0);
                for (std::size_t i = 0; i < bytes.size(); ++i)
                    if (copied[i] != bytes[i])
                        FAIL(fmt::format("{} {} {} texel {} byte {}: {:#04x}, expected {:#04x}", profile, info.name,
                                         name_of(filter), i / static_cast<std::size_t>(info.bytes_per_texel),
                                         i % static_cast<std::size_t>(info.bytes_per_texel), static_cast<int>(copied[i]),
                                         static_cast<int>(bytes[i])));
            }
        }
}

TEST_CASE("codes of 8 and 16 bits for every float in [0, 1]", "[.][sweep][3.2.3.6]") {
    constexpr std::int32_t kOne = 0x3f800000;
    for (const int bits : {8, 16}) {
        std::uint64_t wrong = 0;
        for (std::int32_t first = 0; first <= kOne; first += kLanes) {
            const Float x = float_of_bits(Int(first) + lane_index());
            const auto codes = unorm_from_float(x, bits).lanes();
            const auto numbers = x.lanes();
            for (std::size_t i = 0; i < numbers.size(); ++i)
                if (static_cast<std::uint32_t>(codes[i]) != unorm_from_float(numbers[i], bits)) ++wrong;
        }
        INFO(bits << " bits");
        CHECK(wrong == 0);
    }
}
