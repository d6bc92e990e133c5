// Textures of small cases, and their passes.
#include "studies/seams/draw.h"

#include "sim/error.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

namespace gnomon::studies {

namespace {

/// Mixes the bits of a cell's number. Finalizer of MurmurHash3
std::uint32_t mixed(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x85ebca6bu;
    x ^= x >> 13;
    x *= 0xc2b2ae35u;
    return x ^ x >> 16;
}

}  // namespace

float seam_noise(double u, double v, int octaves, unsigned seed) {
    double sum = 0;
    for (int octave = 1; octave <= octaves; ++octave) {
        const double cells = static_cast<double>(1u << static_cast<unsigned>(octave));
        const auto column = static_cast<std::uint32_t>(u * cells);
        const auto row = static_cast<std::uint32_t>(v * cells);
        const std::uint32_t cell = mixed(mixed(mixed(seed * 32u + static_cast<std::uint32_t>(octave)) + column) + row);
        sum += static_cast<double>(cell >> 8) * 0x1p-24 - 0.5;
    }
    // Twelve times the variance of one octave is 1: the spread stays the same for any number of them.
    const double spread = 0.25 * 3.4641016151377544 / std::sqrt(static_cast<double>(octaves));
    return static_cast<float>(std::clamp(0.5 + spread * sum, 0.0, 1.0));
}

TextureId seam_texture(Device& device, int side, int slices, std::span<const float> texels) {
    const auto per_slice = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    GNOMON_CHECK_EQ(texels.size(), per_slice * static_cast<std::size_t>(slices));
    const TextureId id = device.create_texture("noise", {.format = Format::R16Unorm,
                                                         .width = side,
                                                         .height = side,
                                                         .levels = full_level_count(side, side),
                                                         .kind = slices > 1 ? TextureKind::Array : TextureKind::Flat,
                                                         .layers = slices});
    std::vector<std::uint16_t> codes(per_slice);
    for (int slice = 0; slice < slices; ++slice) {
        const std::span<const float> values = texels.subspan(static_cast<std::size_t>(slice) * per_slice, per_slice);
        std::ranges::transform(values, codes.begin(),
                               [](float value) { return static_cast<std::uint16_t>(value * 65535.0f + 0.5f); });
        device.execute(WriteTexture{.id = id, .data = std::as_bytes(std::span(codes)), .layer = slice});
    }
    device.execute(GenerateMips{id});
    return id;
}

TextureId seam_texture(Device& device, int side, int slices) {
    const int octaves = full_level_count(side, side) - 1;
    std::vector<float> texels;
    texels.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * static_cast<std::size_t>(slices));
    for (int slice = 0; slice < slices; ++slice)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                texels.push_back(seam_noise((x + 0.5) / side, (y + 0.5) / side, octaves, static_cast<unsigned>(slice)));
    return seam_texture(device, side, slices, texels);
}

Sampler seam_sampler(AddressMode address) { return {.mip = MipFilter::Linear, .address_u = address, .address_v = address}; }

int seam_cure(std::string_view seam, std::span<const std::string_view> cures, std::string_view cure) {
    std::string names;
    for (std::size_t i = 0; i < cures.size(); ++i) {
        if (cures[i] == cure) return static_cast<int>(i);
        names += names.empty() ? "" : ", ";
        names += cures[i];
    }
    fail("--cure {}: seam '{}' does not have it; expected one of {}", cure, seam, names);
}

void measure_draw(Device& device, const Draw& draw, SeamImage& image) {
    // Counting costs time, and warms the caches.
    device.take_tally();
    device.enable_counters(true);
    device.execute(draw);
    device.enable_counters(false);
    image.counters = device.take_counters();
    const auto begin = std::chrono::steady_clock::now();
    device.execute(draw);
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - begin;
    image.milliseconds = elapsed.count();
}

SeamImage draw_seam_passes(Device& device, const SeamPlane& plane, const SeamPass& probed, const SeamPass& plain) {
    // A triangle twice as wide and high as the picture.
    const glm::vec3 right = plane.origin + plane.dx * static_cast<float>(2 * kSeamSide);
    const glm::vec3 below = plane.origin + plane.dy * static_cast<float>(2 * kSeamSide);
    const std::array<float, 15> corners{-1.0f, 1.0f,  plane.origin.x, plane.origin.y, plane.origin.z,
                                        3.0f,  1.0f,  right.x,        right.y,        right.z,
                                        -1.0f, -3.0f, below.x,        below.y,        below.z};
    const BufferId vertices = device.create_buffer("seam plane", std::as_bytes(std::span(corners)));
    const SeamVertex vertex;
    const auto draw_of = [&](const SeamPass& pass) {
        return Draw{.label = pass.label,
                    .program = pass.program,
                    .vertex_constants = constants_of(vertex),
                    .pixel_constants = pass.constants,
                    .vertices = vertices,
                    .count = 3};
    };

    const ProbeTargets targets(device, kSeamSide, kSeamSide);
    device.execute(ClearColor{targets.colors()[0], glm::vec4(-1.0f)});
    Draw draw = draw_of(probed);
    std::ranges::copy(targets.colors(), draw.color.begin());
    device.execute(draw);

    const TextureId picture =
        device.create_texture("seam picture", {.format = Format::Rgba8Unorm, .width = kSeamSide, .height = kSeamSide});
    draw = draw_of(plain);
    draw.color[0] = picture;
    draw.derivative_report = targets.derivatives();
    SeamImage measured;
    measure_draw(device, draw, measured);

    SeamImage image = targets.read();
    image.counters = measured.counters;
    image.milliseconds = measured.milliseconds;
    return image;
}

}  // namespace gnomon::studies
