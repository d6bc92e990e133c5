#include "tests/agree/profile_source.h"

#include "sim/denormals.h"
#include "texunit/record.h"
#include "texunit/sample.h"

#include <algorithm>

namespace gnomon::agree {
namespace {

Format format_of(TexelFormat format) {
    switch (format) {
        case TexelFormat::R32f: return Format::R32Float;
        case TexelFormat::Rg32f: return Format::Rg32Float;
        case TexelFormat::Rg16f: return Format::Rg16Float;
        case TexelFormat::Rgba8: return Format::Rgba8Unorm;
        case TexelFormat::Rg16Unorm: return Format::Rg16Unorm;
        case TexelFormat::D32f: return Format::D32Float;
    }
    fail("unknown texel format");
}

gnomon::Texture texture_of(const Levels& levels, const SamplerState& sampler) {
    const std::size_t count = sampler.mip == Mip::Base ? 1 : levels.levels.size();
    gnomon::Texture texture({.format = format_of(levels.format),
                             .width = levels.width,
                             .height = levels.height,
                             .levels = static_cast<int>(count)});
    for (std::size_t i = 0; i < count; ++i)
        texture.set_level_bytes(static_cast<int>(i), levels.levels[i].data(), levels.levels[i].size());
    return texture;
}

AddressMode mode_of(Address address) {
    switch (address) {
        case Address::Wrap: return AddressMode::Wrap;
        case Address::Mirror: return AddressMode::Mirror;
        case Address::Clamp: return AddressMode::Clamp;
        case Address::Border: return AddressMode::Border;
        case Address::MirrorOnce: return AddressMode::MirrorOnce;
    }
    fail("unknown address mode");
}

// With one level in the view, Vulkan's filter between levels has nothing to do.
MipFilter mip_of(Mip mip) {
    switch (mip) {
        case Mip::Base: return MipFilter::Base;
        case Mip::Nearest: return MipFilter::Nearest;
        case Mip::Linear: return MipFilter::Linear;
    }
    fail("unknown mip filter");
}

CompareOp op_of(Compare compare) {
    switch (compare) {
        case Compare::None:
        case Compare::Never: return CompareOp::Never;
        case Compare::Less: return CompareOp::Less;
        case Compare::Equal: return CompareOp::Equal;
        case Compare::LessEqual: return CompareOp::LessEqual;
        case Compare::Greater: return CompareOp::Greater;
        case Compare::NotEqual: return CompareOp::NotEqual;
        case Compare::GreaterEqual: return CompareOp::GreaterEqual;
        case Compare::Always: return CompareOp::Always;
    }
    fail("unknown comparison");
}

Sampler sampler_of(const SamplerState& state) {
    const auto filter = [](Filter f) { return f == Filter::Linear ? TexelFilter::Linear : TexelFilter::Nearest; };
    const float rgb = state.border == 2 ? 1.0f : 0.0f;
    return {.min = filter(state.min),
            .mag = filter(state.mag),
            .mip = mip_of(state.mip),
            .address_u = mode_of(state.address_u),
            .address_v = mode_of(state.address_v),
            .max_anisotropy = static_cast<int>(state.max_anisotropy),
            .compare = op_of(state.compare),
            .lod_bias = state.lod_bias,
            .min_lod = state.min_lod,
            .max_lod = state.max_lod,
            .border = {rgb, rgb, rgb, state.border == 0 ? 0.0f : 1.0f}};
}

std::vector<Sample> gathered(const TextureView& view, const Sampler& sampler, const Profile& profile,
                             std::span<const Point> points) {
    const DenormalScope denormals(profile.flush_denormals);
    std::vector<Sample> samples;
    for (const Point& point : points) {
        const auto texels = gather<Float>(view, sampler, profile, Vec3<Float>{Float(point.u), Float(point.v), Float(0.0f)}, 0);
        samples.push_back({lane(texels.x, 0), lane(texels.y, 0), lane(texels.z, 0), lane(texels.w, 0)});
    }
    return samples;
}

}  // namespace

Source profile_source(const Profile& profile) {
    return [profile](const Levels& levels, const SamplerState& state, Instruction instruction, std::span<const Point> points) {
        const gnomon::Texture texture = texture_of(levels, state);
        const Sampler sampler = sampler_of(state);
        const bool compares = state.compare != Compare::None;
        if (compares && levels.format != TexelFormat::D32f) fail("comparison of a format that is not d32f");
        if (instruction == Instruction::Gather) {
            if (compares) fail("gathered comparisons are not adapted");
            return gathered(texture, sampler, profile, points);
        }
        std::vector<SampleRequest> requests;
        requests.reserve(points.size());
        for (const Point& point : points) {
            SampleRequest& request = requests.emplace_back();
            request.coordinate = {point.u, point.v, 0};
            request.lod = point.lod;
            if (instruction == Instruction::Gradient)
                request.gradient = {.dx = {point.dudx, point.dvdx, 0}, .dy = {point.dudy, point.dvdy, 0}};
            if (compares) request.reference = point.reference;
        }
        std::vector<Sample> samples;
        samples.reserve(points.size());
        for (const SampleResult& result : sample_all(texture, sampler, profile, requests))
            samples.push_back({static_cast<float>(result.color[0]), static_cast<float>(result.color[1]),
                               static_cast<float>(result.color[2]), static_cast<float>(result.color[3])});
        return samples;
    };
}

}  // namespace gnomon::agree
