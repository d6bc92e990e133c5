// The harness's textures, samplers and points as Gnomon's own.
#pragma once

#include "tests/agree/sampling.h"
#include "texunit/record.h"

#include <bit>

namespace gnomon::agree {

inline Format format_of(TexelFormat format) {
    switch (format) {
        case TexelFormat::R32f: return Format::R32Float;
        case TexelFormat::Rg32f: return Format::Rg32Float;
        case TexelFormat::Rg16f: return Format::Rg16Float;
        case TexelFormat::Rgba8: return Format::Rgba8Unorm;
        case TexelFormat::Rg16Unorm: return Format::Rg16Unorm;
        case TexelFormat::D32f: return Format::D32Float;
    }
    __builtin_unreachable();
}

inline AddressMode mode_of(Address address) {
    switch (address) {
        case Address::Wrap: return AddressMode::Wrap;
        case Address::Mirror: return AddressMode::Mirror;
        case Address::Clamp: return AddressMode::Clamp;
        case Address::Border: return AddressMode::Border;
        case Address::MirrorOnce: return AddressMode::MirrorOnce;
    }
    __builtin_unreachable();
}

inline CompareOp op_of(Compare compare) {
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
    __builtin_unreachable();
}

inline Texture texture_of(const Levels& levels) {
    Texture texture({.format = format_of(levels.format),
                     .width = levels.width,
                     .height = levels.height,
                     .levels = static_cast<int>(levels.levels.size())});
    for (std::size_t i = 0; i < levels.levels.size(); ++i)
        texture.set_level_bytes(static_cast<int>(i), levels.levels[i].data(), levels.levels[i].size());
    return texture;
}

inline Sampler sampler_of(const SamplerState& state) {
    const auto filter = [](Filter f) { return f == Filter::Linear ? TexelFilter::Linear : TexelFilter::Nearest; };
    Sampler sampler{.min = filter(state.min),
                    .mag = filter(state.mag),
                    .mip = state.mip == Mip::Base      ? MipFilter::Base
                           : state.mip == Mip::Nearest ? MipFilter::Nearest
                                                       : MipFilter::Linear,
                    .address_u = mode_of(state.address_u),
                    .address_v = mode_of(state.address_v),
                    .max_anisotropy = static_cast<int>(state.max_anisotropy),
                    .compare = op_of(state.compare),
                    .lod_bias = state.lod_bias,
                    .min_lod = state.min_lod,
                    .max_lod = state.max_lod};
    const float white = state.border == 2 ? 1.0f : 0.0f;
    sampler.border = {white, white, white, state.border == 0 ? 0.0f : 1.0f};
    return sampler;
}

inline SampleRequest request_of(const Point& point, const SamplerState& state, Instruction instruction) {
    SampleRequest request{.coordinate = {point.u, point.v, 0.0}, .lod = point.lod};
    if (instruction == Instruction::Gradient)
        request.gradient = SampleRequest::Gradient{.dx = {point.dudx, point.dvdx, 0.0}, .dy = {point.dudy, point.dvdy, 0.0}};
    if (state.compare != Compare::None) request.reference = point.reference;
    return request;
}

/// What a profile of ours returns for the same points.
inline std::vector<Sample> sample_by(const Profile& profile, const Levels& levels, const SamplerState& state,
                                     Instruction instruction, std::span<const Point> points) {
    const Texture texture = texture_of(levels);
    std::vector<SampleRequest> requests;
    requests.reserve(points.size());
    for (const Point& point : points) requests.push_back(request_of(point, state, instruction));
    std::vector<Sample> samples;
    samples.reserve(points.size());
    for (const SampleResult& result : sample_all(texture, sampler_of(state), profile, requests)) {
        Sample sample;
        for (std::size_t c = 0; c < sample.size(); ++c) sample[c] = static_cast<float>(result.color[c]);
        samples.push_back(sample);
    }
    return samples;
}

}  // namespace gnomon::agree
