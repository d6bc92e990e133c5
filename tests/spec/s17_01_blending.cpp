// D3D11.3 17.1 to 17.6: blending against a scalar model, for every factor and operation and every kind of format.
#include "tests/oracle/output_merger.h"
#include "tests/oracle/random.h"
#include "tests/oracle/texel.h"
#include "tests/unit/output_programs.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <limits>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

namespace {

constexpr int kSize = 8;
constexpr std::size_t kPixels = kSize * kSize;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Numbers inside and outside of every format's range. None is below the normal range: what flushes is not at issue here.
float any_color(Random& random) {
    switch (random.integer(0, 9)) {
        case 0: return std::array{0.0f, -0.0f, 1.0f, -1.0f, 0.5f}[static_cast<std::size_t>(random.integer(0, 4))];
        case 1: return std::array{kInfinity, -kInfinity, kNan, 3e38f, -3e38f}[static_cast<std::size_t>(random.integer(0, 4))];
        case 2: return random.in(-3.0f, 3.0f);
        case 3: return random.in(-70000.0f, 70000.0f);
        case 4: return static_cast<float>(random.integer(0, 255)) / 255.0f;
        default: return random.in(0.0f, 1.0f);
    }
}

/// Any code of a component; of 32-bit floats one of the numbers above.
std::uint32_t any_code(Random& random, Format format, const Profile& profile, int c) {
    if (format_info(format).type == ComponentType::Float32)
        return oracle::component_code(format, profile, static_cast<double>(any_color(random)), c);
    return random.bits();
}

/// One target, the images that are blended into it, and the model beside it.
struct BlendBench {
    Format format;
    int components;
    Canvas canvas;
    TextureId target;
    ImageConstants images{};
    std::vector<std::byte> stored;  // what the target begins with
    Image src, src1;
    glm::vec4 constant{};
    BufferId corners;
    std::size_t changed = 0;  // components that differ from what was stored: a test whose targets stay is none

    BlendBench(Format target_format, const Profile& profile, std::uint64_t seed)
        : format(target_format),
          components(format_info(target_format).components),
          canvas(profile, kSize, kSize),
          target(canvas.target(target_format)) {
        Random random(seed);
        const auto bytes = static_cast<std::size_t>(format_info(format).bytes_per_texel);
        stored.resize(kPixels * bytes);
        for (std::size_t i = 0; i < kPixels; ++i) {
            for (int c = 0; c < components; ++c)
                oracle::store_code(format, &stored[i * bytes], c, any_code(random, format, profile, c));
            src.push_back(color(random));
            src1.push_back(color(random));
        }
        constant = color(random);
        Image both = src;
        both.insert(both.end(), src1.begin(), src1.end());
        images = {canvas.image(both), canvas.image(Image(kPixels))};
        corners = upload(canvas.device, canvas.corners({0, 0, kSize, kSize}, 0.5f));
    }
    static glm::vec4 color(Random& random) {
        glm::vec4 result;
        for (int c = 0; c < 4; ++c) result[c] = any_color(random);
        return result;
    }

    static oracle::Color wide(const glm::vec4& v) {
        return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z), static_cast<double>(v.w)};
    }
    [[nodiscard]] std::uint32_t stored_code(std::size_t pixel, int c) const {
        const auto bytes = static_cast<std::size_t>(format_info(format).bytes_per_texel);
        return oracle::stored_code(format, &stored[pixel * bytes], c);
    }

    /// Draws with the state and compares every component of every pixel.
    void check(const BlendState& state, std::string_view what) {
        canvas.device.execute(WriteTexture{target, 0, stored});
        Draw draw = make_draw(image_program(2), corners, 0, 6);
        draw.pixel_constants = constants_of(images);
        draw.color[0] = target;
        draw.output.blend[0] = state;
        draw.output.blend_constant = constant;
        canvas.device.execute(draw);

        const Profile& profile = canvas.device.profile();
        for (std::size_t i = 0; i < kPixels; ++i) {
            oracle::Color before{0, 0, 0, 1};
            for (int c = 0; c < components; ++c)
                before[static_cast<std::size_t>(c)] = oracle::texel_value(format, profile, stored_code(i, c), c);
            const oracle::Color after =
                oracle::blend({wide(src[i]), wide(src1[i]), wide(constant)}, before, state, format, profile);
            for (int c = 0; c < components; ++c) {
                const bool written = (state.write_mask >> c & 1) != 0;
                const std::uint32_t expected =
                    written ? oracle::component_code(format, profile, after[static_cast<std::size_t>(c)], c)
                            : stored_code(i, c);
                const std::uint32_t found = canvas.code(target, i, c);
                changed += found != stored_code(i, c) ? 1u : 0u;
                if (found == expected) continue;
                const auto k = static_cast<std::size_t>(c);
                FAIL(
                    fmt::format("{} {}, profile {}, pixel {}, component {}: {:#x}, expected {:#x} ({:a}); src {:a}, src1 "
                                "{:a}, stored {:a}, alphas {:a} {:a} {:a}, color {} {} {}, alpha {} {} {}",
                                what, format_info(format).name, profile.name, i, c, found, expected, after[k], wide(src[i])[k],
                                wide(src1[i])[k], before[k], wide(src[i])[3], wide(src1[i])[3], before[3], name_of(state.src),
                                name_of(state.op), name_of(state.dst), name_of(state.src_alpha), name_of(state.op_alpha),
                                name_of(state.dst_alpha)));
            }
        }
    }
};

constexpr int kFactors = 17;
BlendFactor any_factor(Random& random) { return static_cast<BlendFactor>(random.integer(0, kFactors - 1)); }
constexpr std::array kPlainOps{BlendOp::Add, BlendOp::Subtract, BlendOp::ReverseSubtract};

}  // namespace

TEST_CASE("every pair of blend factors under every operation", "[17.1][17.5][17.6][blend]") {
    // The alpha equation takes its own factors from the case's number.
    for (const Format format : {Format::Rgba8Unorm, Format::Rgba32Float}) {
        BlendBench bench(format, load_profile("d3d11"), 1);
        Random random(2);
        for (int pair = 0; pair < kFactors * kFactors; ++pair) {
            for (const BlendOp op : kPlainOps) {
                const BlendState state{.enable = true,
                                       .src = static_cast<BlendFactor>(pair % kFactors),
                                       .dst = static_cast<BlendFactor>(pair / kFactors),
                                       .op = op,
                                       .src_alpha = any_factor(random),
                                       .dst_alpha = any_factor(random),
                                       .op_alpha = kPlainOps[static_cast<std::size_t>(random.integer(0, 2))]};
                bench.check(state, fmt::format("pair {}", pair));
            }
        }
        CHECK(bench.changed > std::size_t{kFactors * kFactors} * 3 * kPixels);
    }
}

TEST_CASE("blending in every format that blends", "[17.1][17.5][17.4][blend]") {
    std::uint64_t seed = 100;
    for (const char* profile : {"d3d11", "ideal"}) {
        for (const FormatInfo& format : kFormats) {
            if (format.is_depth || format.is_integer()) continue;
            BlendBench bench(format.format, load_profile(profile), ++seed);
            Random random(seed);
            for (int i = 0; i < 24; ++i) {
                BlendState state{.enable = true,
                                 .src = any_factor(random),
                                 .dst = any_factor(random),
                                 .op = static_cast<BlendOp>(random.integer(0, 4)),
                                 .src_alpha = any_factor(random),
                                 .dst_alpha = any_factor(random),
                                 .op_alpha = static_cast<BlendOp>(random.integer(0, 4)),
                                 .write_mask = random.chance(4) ? random.integer(0, 15) : 15};
                const bool plain = state.op <= BlendOp::ReverseSubtract && state.op_alpha <= BlendOp::ReverseSubtract;
                const auto second = [](BlendFactor f) { return f >= BlendFactor::Src1Color; };
                // A second colour goes with sums and differences only. D3D11.3 17.6
                if (!plain && (second(state.src) || second(state.dst) || second(state.src_alpha) || second(state.dst_alpha)))
                    continue;
                bench.check(state, fmt::format("seed {}, case {}", seed, i));
            }
            CHECK(bench.changed > kPixels);
        }
    }
}

TEST_CASE("min and max ignore the factors", "[17.1][blend]") {
    for (const Format format : {Format::Rgba8Unorm, Format::Rgba8Snorm, Format::Rgba16Float, Format::Rgba32Float}) {
        BlendBench bench(format, load_profile("d3d11"), 7);
        for (int f = 0; f < static_cast<int>(BlendFactor::Src1Color); ++f) {
            const auto factor = static_cast<BlendFactor>(f);
            for (const BlendOp op : {BlendOp::Min, BlendOp::Max})
                bench.check({.enable = true,
                             .src = factor,
                             .dst = BlendFactor::Zero,
                             .op = op,
                             .src_alpha = BlendFactor::Zero,
                             .dst_alpha = factor,
                             .op_alpha = op == BlendOp::Min ? BlendOp::Max : BlendOp::Min},
                            "min and max");
        }
        CHECK(bench.changed > 0);
    }
}

TEST_CASE("fixed-point targets clamp what enters and what leaves the blender", "[17.5][blend]") {
    // Unclamped, the constant would give 0.25 * 3, and the alpha of 7 a factor of -6.
    const auto result = [](Format format, const glm::vec4& src, const glm::vec4& constant, const BlendState& state) {
        Canvas canvas(load_profile("d3d11"), 2, 2);
        const TextureId target = canvas.target(format);
        canvas.device.execute(ClearColor{target, glm::vec4(0.2f)});
        Draw draw = canvas.everything(image_program(1), 0.5f, {canvas.image(Image(4, src)), canvas.image(Image(4))});
        draw.color[0] = target;
        draw.output.blend[0] = state;
        draw.output.blend_constant = constant;
        canvas.device.execute(draw);
        return canvas.code(target, 3);
    };
    const BlendState times_constant{.enable = true, .src = BlendFactor::Constant};
    CHECK(result(Format::Rgba8Unorm, glm::vec4(0.25f), glm::vec4(3.0f), times_constant) == 64);
    CHECK(result(Format::Rgba8Unorm, glm::vec4(0.25f), glm::vec4(-3.0f), times_constant) == 0);
    CHECK(result(Format::Rgba16Unorm, glm::vec4(9.0f), glm::vec4(0.5f), times_constant) == 0x8000);
    CHECK(std::bit_cast<float>(result(Format::R32Float, glm::vec4(0.25f), glm::vec4(3.0f), times_constant)) == 0.75f);
    const BlendState keeps{.enable = true, .src = BlendFactor::Zero, .dst = BlendFactor::InvSrcAlpha};
    CHECK(result(Format::Rgba8Unorm, glm::vec4(7.0f), {}, keeps) == 0);
    // SNORM inputs are clamped to [-1, 1], but 1 - x in between is not: 1 - -1 = 2. D3D11.3 17.5
    const BlendState inverse{.enable = true, .src = BlendFactor::Zero, .dst = BlendFactor::InvSrcColor};
    CHECK(result(Format::Rgba8Snorm, glm::vec4(-5.0f), {}, inverse) == 50);  // 25 / 127 twice
    // NaN becomes 0 in fixed point and stays in floats, even at a weight of 0.
    const BlendState ignores{.enable = true, .src = BlendFactor::Zero, .dst = BlendFactor::One};
    CHECK(result(Format::Rgba8Unorm, glm::vec4(kNan), {}, ignores) == 51);
    CHECK(result(Format::R32Float, glm::vec4(kNan), {}, ignores) == 0x7fc00000u);
    CHECK(result(Format::R16Float, glm::vec4(kInfinity), {}, ignores) == 0x7e00u);
    // A product of -0 keeps its sign: 0.2 * 0 - 0.2 * 0 is +0, and -0 alone is -0.
    CHECK(result(Format::R32Float, glm::vec4(-0.0f), {},
                 {.enable = true, .src = BlendFactor::One, .dst = BlendFactor::Zero, .op = BlendOp::Subtract}) == 0x80000000u);
    CHECK(result(Format::R32Float, glm::vec4(-0.0f), {}, {.enable = true}) == 0u);
}

TEST_CASE("blending in sRGB targets is linear", "[17.4][blend]") {
    // Half of white over black is 0.5 in linear light, code 188; in gamma it would be 128. Alpha is not encoded.
    Canvas canvas(load_profile("d3d11"), 2, 2);
    const TextureId target = canvas.target(Format::Rgba8Srgb);
    canvas.device.execute(ClearColor{target, glm::vec4(0.0f)});
    Draw draw = canvas.everything(image_program(1), 0.5f,
                                  {canvas.image(Image(4, glm::vec4(1.0f, 1.0f, 1.0f, 0.5f))), canvas.image(Image(4))});
    draw.color[0] = target;
    draw.output.blend[0] = {.enable = true, .src = BlendFactor::SrcAlpha, .dst = BlendFactor::InvSrcAlpha};
    canvas.device.execute(draw);
    CHECK(canvas.code(target, 0, 0) == 188);
    CHECK(canvas.code(target, 0, 3) == 128);
}

TEST_CASE("each target blends by its own state and clamps to its own range", "[17.3][17.5][blend]") {
    Canvas canvas(load_profile("d3d11"), 2, 2);
    Draw draw =
        canvas.everything(image_program(8), 0.5f, {canvas.image(Image(4 * 8, glm::vec4(2.0f))), canvas.image(Image(4))});
    for (std::size_t i = 0; i < 8; ++i) {
        draw.color[i] = canvas.target(i % 2 == 0 ? Format::R8Unorm : Format::R32Float);
        canvas.device.execute(ClearColor{draw.color[i], glm::vec4(0.5f)});
        draw.output.blend[i] = {.enable = i < 6,
                                .src = i < 2 ? BlendFactor::One : BlendFactor::Constant,
                                .dst = i < 4 ? BlendFactor::Zero : BlendFactor::One};
    }
    draw.output.blend_constant = glm::vec4(0.25f);
    canvas.device.execute(draw);
    CHECK(canvas.code(draw.color[0].texture, 0) == 255);
    CHECK(canvas.value(draw.color[1].texture, 0) == 2.0f);
    CHECK(canvas.code(draw.color[2].texture, 0) == 64);  // 1 * 0.25
    CHECK(canvas.value(draw.color[3].texture, 0) == 0.5f);
    CHECK(canvas.code(draw.color[4].texture, 0) == 192);  // 128 / 255 + 0.25
    CHECK(canvas.value(draw.color[5].texture, 0) == 1.0f);
    CHECK(canvas.code(draw.color[6].texture, 0) == 255);
    CHECK(canvas.value(draw.color[7].texture, 0) == 2.0f);
}
