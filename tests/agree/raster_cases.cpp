// Random triangles, states and colours.
#include "tests/agree/raster_cases.h"

#include <bit>
#include <cmath>

namespace gnomon::agree {
namespace {

struct Pixel {
    float x, y;
};

// To clip space, with a depth and a w.
ClipVertex vertex_at(const Pixel& p, int width, int height, oracle::Random& random, float w = 1) {
    const float x = p.x / static_cast<float>(width) * 2 - 1;
    const float y = p.y / static_cast<float>(height) * 2 - 1;
    const float z = random.unit();
    ClipVertex vertex{.clip = {x * w, y * w, z * w, w}};
    for (float& channel : vertex.color) channel = random.in(-1, 1);
    return vertex;
}

// A place where a sample or a corner is, for one sample or four.
Pixel on_grid(oracle::Random& random, int width, int height) {
    constexpr std::array<std::array<int, 2>, 6> kEighths{{{0, 0}, {4, 4}, {3, 1}, {7, 3}, {1, 5}, {5, 7}}};
    const auto& [x, y] = kEighths[static_cast<std::size_t>(random.integer(0, 5))];
    return {static_cast<float>(random.integer(0, width - 1)) + static_cast<float>(x) / 8,
            static_cast<float>(random.integer(0, height - 1)) + static_cast<float>(y) / 8};
}

float any_unit(oracle::Random& random) {
    const int pick = random.integer(0, 9);
    if (pick == 0) return 0;
    if (pick == 1) return 1;
    if (pick == 2) return static_cast<float>(random.integer(0, 510)) / 510.0f;  // halfway between codes, too
    return random.unit();
}

float scaled(oracle::Random& random, int lowest_exponent, int highest_exponent) {
    const float x = random.in(-1, 1);
    return std::ldexp(x, random.integer(lowest_exponent, highest_exponent));
}

float any_value(oracle::Random& random, ColorFormat format) {
    const bool is_float = format == ColorFormat::Rgba16f || format == ColorFormat::Rgba32f;
    const int pick = random.integer(0, 19);
    if (pick == 0) return random.in(-2, 3);
    if (!is_float || pick > 5) return any_unit(random);
    if (pick == 1) return random.any_float();
    if (pick == 2) return scaled(random, -30, 18);
    if (pick == 3) return random.in(-70000, 70000);
    if (pick == 4) return scaled(random, -149, -120);
    return random.in(-1, 1);
}

std::uint32_t any_code(oracle::Random& random, ColorFormat format) {
    switch (format) {
        case ColorFormat::Rgba8: return random.bits() >> 24;
        case ColorFormat::Rgba16Unorm: return random.chance(8) ? 0xffff : random.bits() >> 16;
        case ColorFormat::Rgba16f: {
            if (random.chance(4)) return random.bits() >> 16;
            return 0x3000u + (random.bits() >> 20);  // from 1/8 to 2
        }
        case ColorFormat::Rgba32f: return std::bit_cast<std::uint32_t>(any_value(random, format));
    }
    return 0;
}

}  // namespace

std::string_view name_of(TriangleKind kind) {
    switch (kind) {
        case TriangleKind::Any: return "any";
        case TriangleKind::SubPixel: return "sub-pixel";
        case TriangleKind::Sliver: return "sliver";
        case TriangleKind::OnSamples: return "on samples";
        case TriangleKind::Shared: return "shared edges";
        case TriangleKind::Large: return "large";
        case TriangleKind::Perspective: return "perspective";
        case TriangleKind::Behind: return "behind";
    }
    return "?";
}

std::vector<ClipTriangle> random_triangles(TriangleKind kind, std::size_t count, int width, int height, std::uint64_t seed) {
    const auto w = static_cast<float>(width);
    const auto h = static_cast<float>(height);
    std::vector<ClipTriangle> triangles;
    std::array<Pixel, 4> quad{};
    for (std::size_t i = 0; i < count; ++i) {
        oracle::Random random(seed * 1'000'003u + i);
        const auto anywhere = [&](float margin) {
            const float x = random.in(-margin * w, (1 + margin) * w);
            const float y = random.in(-margin * h, (1 + margin) * h);
            return Pixel{x, y};
        };
        std::array<Pixel, 3> p{anywhere(0), anywhere(0), anywhere(0)};
        std::array<float, 3> over{1, 1, 1};
        switch (kind) {
            case TriangleKind::Any: break;
            case TriangleKind::SubPixel:
                for (std::size_t k = 1; k < 3; ++k) {
                    p[k].x = std::min(std::max(p[0].x + random.in(-1, 1), 0.0f), w);
                    p[k].y = std::min(std::max(p[0].y + random.in(-1, 1), 0.0f), h);
                }
                break;
            case TriangleKind::Sliver: {
                const float t = random.unit();
                const float off = random.in(-0.02f, 0.02f);
                p[2] = {p[0].x + t * (p[1].x - p[0].x) + off, p[0].y + t * (p[1].y - p[0].y)};
                p[2].x = std::min(std::max(p[2].x, 0.0f), w);
                break;
            }
            case TriangleKind::OnSamples:
                for (Pixel& pixel : p) pixel = on_grid(random, width, height);
                break;
            case TriangleKind::Shared:
                if (i % 2 == 0) {
                    quad = {p[0], p[1], p[2], anywhere(0)};
                } else {
                    p = {quad[2], quad[1], quad[3]};
                }
                break;
            case TriangleKind::Large:
                for (Pixel& pixel : p) pixel = anywhere(random.chance(4) ? 30.0f : 2.0f);
                break;
            case TriangleKind::Perspective:
                for (Pixel& pixel : p) pixel = anywhere(0.5f);
                for (float& scale : over) scale = std::exp2(random.in(-3, 3));
                break;
            case TriangleKind::Behind:
                for (Pixel& pixel : p) pixel = anywhere(0.5f);
                for (float& scale : over) scale = random.in(-1, 2);
                break;
        }
        ClipTriangle& triangle = triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) triangle[k] = vertex_at(p[k], width, height, random, over[k]);
        if (kind == TriangleKind::Behind)
            for (ClipVertex& vertex : triangle) {
                if (random.chance(3)) vertex.clip[2] += random.in(-1, 1);
                if (random.chance(20)) vertex.clip[3] = 0;
            }
    }
    return triangles;
}

BlendState random_blend_state(oracle::Random& random, ColorFormat format) {
    const auto equation = [&random] {
        const int source = random.integer(0, kBlendFactorCount - 1);
        const int destination = random.chance(5) ? source : random.integer(0, kBlendFactorCount - 1);
        const int operation = random.integer(0, kBlendOperationCount - 1);
        return BlendEquation{static_cast<BlendFactor>(source), static_cast<BlendFactor>(destination),
                             static_cast<BlendOperation>(operation)};
    };
    BlendState state;
    state.color = equation();
    state.alpha = random.chance(3) ? state.color : equation();
    for (float& channel : state.constant) {
        channel = any_value(random, format);
        if (!std::isfinite(channel)) channel = 0.5f;
    }
    return state;
}

std::vector<BlendCase> random_blend_cases(oracle::Random& random, ColorFormat format, std::size_t count) {
    std::vector<BlendCase> cases(count);
    for (BlendCase& one : cases) {
        for (float& channel : one.source) channel = any_value(random, format);
        for (std::uint32_t& code : one.destination) code = any_code(random, format);
    }
    return cases;
}

std::vector<SampleCodes> random_samples(oracle::Random& random, ColorFormat format, std::size_t count) {
    std::vector<SampleCodes> pixels(count);
    for (SampleCodes& samples : pixels)
        for (Codes& codes : samples)
            for (std::uint32_t& code : codes) code = any_code(random, format);
    return pixels;
}

}  // namespace gnomon::agree
