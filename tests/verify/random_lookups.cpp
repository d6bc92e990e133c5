// Codes and their numbers, coordinates and gradients.
#include "tests/verify/random_lookups.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>

namespace verify {

using namespace gnomon;
using oracle::Random;

namespace {

/// One component as stored, and the number that it stands for.
struct Component {
    std::uint32_t code = 0;
    double value = 0;
};

double half_value(std::uint32_t code) {
    const int exponent = static_cast<int>(code >> 10 & 31);
    const auto mantissa = static_cast<double>(code & 1023);
    const double magnitude = exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
    return (code & 0x8000) != 0 ? -magnitude : magnitude;
}

Component random_component(Random& random, ComponentType type) {
    switch (type) {
        case ComponentType::Unorm8: {
            const std::uint32_t code = random.bits() & 255;
            return {code, code / 255.0};
        }
        case ComponentType::Unorm16:
        case ComponentType::Depth16: {
            // Few depths, so that references meet equal ones.
            const std::uint32_t code = type == ComponentType::Depth16 ? random.bits() % 16 * 4369 : random.bits() & 65535;
            return {code, code / 65535.0};
        }
        case ComponentType::Float16: {
            // Normal numbers from 2^-6 to 2^4.
            const std::uint32_t code = (random.bits() & 0x83ff) | static_cast<std::uint32_t>(random.integer(9, 18)) << 10;
            return {code, half_value(code)};
        }
        case ComponentType::Float32: {
            const float value = random.in(-16.0f, 16.0f);
            return {std::bit_cast<std::uint32_t>(value), value};
        }
        case ComponentType::Depth32: {
            const float value = static_cast<float>(random.integer(0, 15)) / 15.0f;
            return {std::bit_cast<std::uint32_t>(value), value};
        }
        case ComponentType::Snorm8:
        case ComponentType::Srgb8:
        case ComponentType::Snorm16:
        case ComponentType::Uint32:
        case ComponentType::Float11:
        case ComponentType::Depth24: break;
    }
    throw std::invalid_argument("format without a decoder");
}

float inside(Random& random, int size) {
    switch (random.integer(0, 5)) {
        case 0: return random.in(-0.2f, 1.2f);
        case 1: return random.in(-3.0f, 3.0f);
        case 2:  // a multiple of half a texel
            return static_cast<float>(random.integer(-size, 3 * size)) / (2.0f * static_cast<float>(size));
        case 3:  // about where 8-bit weights round
            return static_cast<float>(random.integer(-256 * size, 512 * size)) / (512.0f * static_cast<float>(size));
        case 4: return random.chance(4) ? random.in(-60.0f, 60.0f) : random.unit();
        default: return random.unit();
    }
}

/// The pair of vectors of an ellipse with given axes, turned by a random phase: not orthogonal for most.
SampleRequest::Gradient random_gradient(Random& random, const Image& image) {
    constexpr float kTurn = 6.2831853f;
    const float levels = static_cast<float>(image.levels.size());
    const float major = std::exp2(random.in(-1.5f, levels + 1.0f));
    const float minor = major / std::exp2(random.in(0.0f, 4.6f));
    const float direction = random.chance(3) ? static_cast<float>(random.integer(0, 3)) * kTurn / 4 : random.in(0, kTurn);
    const float phase = random.chance(3) ? 0.0f : random.in(0, kTurn);
    const float c = std::cos(direction);
    const float s = std::sin(direction);
    const float xa = major * std::cos(phase);
    const float xb = minor * std::sin(phase);
    const float ya = -major * std::sin(phase);
    const float yb = minor * std::cos(phase);
    const auto width = static_cast<float>(image.levels[0].width);
    const auto height = static_cast<float>(image.levels[0].height);
    SampleRequest::Gradient gradient;
    gradient.dx = {(xa * c - xb * s) / width, (xa * s + xb * c) / height, 0};
    gradient.dy = {(ya * c - yb * s) / width, (ya * s + yb * c) / height, 0};
    if (random.chance(16)) gradient.dy = {gradient.dx[0] / 2, gradient.dx[1] / 2, 0};
    if (random.chance(16)) gradient.dy = {};
    // Rounded so that every arithmetic starts from the same numbers.
    for (std::size_t i = 0; i < 2; ++i) {
        gradient.dx[i] = static_cast<float>(gradient.dx[i]);
        gradient.dy[i] = static_cast<float>(gradient.dy[i]);
    }
    return gradient;
}

AddressMode random_address(Random& random) { return static_cast<AddressMode>(random.integer(0, 4)); }

std::string hex(const char* name, std::initializer_list<double> values) {
    std::string text = std::string(" ") + name;
    for (const double value : values) {
        std::array<char, 40> buffer{};
        std::snprintf(buffer.data(), buffer.size(), " %a", value);
        text += buffer.data();
    }
    return text;
}

}  // namespace

TexturePair random_texture(Random& random, Format format, int width, int height) {
    const FormatInfo& info = format_info(format);
    const int levels = full_level_count(width, height);
    TexturePair pair{Texture(TextureDesc{.format = format, .width = width, .height = height, .levels = levels}), {}};
    Image& image = pair.image;
    image.components = info.components;
    image.unit_range = info.is_depth || info.type == ComponentType::Unorm8 || info.type == ComponentType::Unorm16;
    image.depth_codes = info.type == ComponentType::Depth16 ? 65535 : 0;
    const auto bytes_per_component = static_cast<std::size_t>(info.bytes_per_texel / info.components);
    for (int l = 0; l < levels; ++l) {
        Image::Level level{.width = pair.texture.width(l), .height = pair.texture.height(l), .texels = {}};
        std::vector<std::byte> bytes;
        for (int i = 0; i < level.width * level.height; ++i) {
            Color color{0, 0, 0, 1};
            for (int c = 0; c < info.components; ++c) {
                const Component component = random_component(random, info.type);
                std::array<std::byte, 4> little_endian{};
                std::memcpy(little_endian.data(), &component.code, 4);
                bytes.insert(bytes.end(), little_endian.begin(),
                             little_endian.begin() + static_cast<std::ptrdiff_t>(bytes_per_component));
                color[static_cast<std::size_t>(c)] = component.value;
                image.largest_texel = std::max(image.largest_texel, std::abs(component.value));
            }
            level.texels.push_back(color);
        }
        pair.texture.set_level_bytes(l, bytes.data(), bytes.size());
        image.levels.push_back(std::move(level));
    }
    return pair;
}

Sampler random_sampler(Random& random, int levels) {
    Sampler sampler;
    sampler.min = random.chance(4) ? TexelFilter::Nearest : TexelFilter::Linear;
    sampler.mag = random.chance(4) ? TexelFilter::Nearest : TexelFilter::Linear;
    sampler.mip = random.chance(2) ? MipFilter::Linear : random.chance(3) ? MipFilter::Base : MipFilter::Nearest;
    sampler.address_u = random_address(random);
    sampler.address_v = random_address(random);
    if (random.chance(4)) {
        sampler.min = sampler.mag = TexelFilter::Linear;
        sampler.max_anisotropy = random.integer(2, 16);
    }
    sampler.compare =
        random.chance(8) ? static_cast<CompareOp>(random.integer(0, 7)) : static_cast<CompareOp>(random.integer(1, 6));
    if (random.chance(6)) sampler.reduction = random.chance(2) ? Reduction::Minimum : Reduction::Maximum;
    if (random.chance(3)) sampler.lod_bias = random.in(-1.5f, 1.5f);
    if (random.chance(5)) sampler.min_lod = random.in(0.0f, static_cast<float>(levels));
    if (random.chance(5)) sampler.max_lod = random.in(0.0f, static_cast<float>(levels));
    for (int c = 0; c < 4; ++c) sampler.border[c] = static_cast<float>(random.integer(0, 4)) / 4.0f;
    return sampler;
}

SampleRequest random_request(Random& random, const Image& image, bool compares) {
    SampleRequest request;
    request.coordinate = {inside(random, image.levels[0].width), inside(random, image.levels[0].height), 0};
    if (random.chance(2)) {
        request.gradient = random_gradient(random, image);
    } else {
        request.lod = random.in(-1.0f, static_cast<float>(image.levels.size()));
        if (random.chance(4)) request.lod = std::round(request.lod * 2) / 2;
    }
    if (random.chance(4)) request.lod_bias = random.in(-1.0f, 1.0f);
    if (compares)
        request.reference = random.chance(3) ? random.in(-0.1f, 1.1f) : static_cast<float>(random.integer(0, 15)) / 15.0f;
    if (random.chance(3)) request.offset = {random.integer(-8, 7), random.integer(-8, 7)};
    return request;
}

std::string description(const Sampler& s, const SampleRequest& r, const Color& result) {
    std::string text = std::string("min ") + std::string(name_of(s.min)) + " mag " + std::string(name_of(s.mag)) + " mip " +
                       std::string(name_of(s.mip)) + " address " + std::string(name_of(s.address_u)) + " " +
                       std::string(name_of(s.address_v)) + " anisotropy " + std::to_string(s.max_anisotropy) + " " +
                       std::string(name_of(s.reduction)) + " compare " + std::string(name_of(s.compare));
    text += hex("bias", {s.lod_bias, r.lod_bias}) + hex("lod limits", {s.min_lod, s.max_lod});
    text += hex("border", {s.border[0], s.border[1], s.border[2], s.border[3]});
    text += hex("at", {r.coordinate[0], r.coordinate[1]});
    if (r.gradient)
        text += hex("gradient", {r.gradient->dx[0], r.gradient->dx[1], r.gradient->dy[0], r.gradient->dy[1]});
    else
        text += hex("lod", {r.lod});
    if (r.reference) text += hex("reference", {*r.reference});
    text += " offset " + std::to_string(r.offset.x) + " " + std::to_string(r.offset.y);
    return text + hex("result", {result[0], result[1], result[2], result[3]});
}

}  // namespace verify
