#include "pipeline/output.h"

#include "pipeline/peer_blend.h"
#include "pipeline/target_codec.h"
#include "texunit/store.h"

namespace gnomon {

namespace {

/// What is stored with some components replaced by what is new: bit c of `components` names component c.
template <class AnyCodec>
typename AnyCodec::Words merge_components(const typename AnyCodec::Words& fresh, const typename AnyCodec::Words& stored,
                                          int components) {
    std::array<std::uint32_t, AnyCodec::kWords> bits{};
    for (std::size_t c = 0; c < AnyCodec::kComponents; ++c)
        if ((components >> c & 1) != 0) AnyCodec::add_component_bits(bits, c);
    typename AnyCodec::Words merged;
    for (std::size_t w = 0; w < AnyCodec::kWords; ++w) {
        const Int mask(static_cast<std::int32_t>(bits[w]));
        merged[w] = (fresh[w] & mask) | (stored[w] & ~mask);
    }
    return merged;
}

template <class Real>
Vec4<Float> to_floats(const Vec4<Real>& c) {
    return {to_float(c.x), to_float(c.y), to_float(c.z), to_float(c.w)};
}
template <class AnyCodec>
typename AnyCodec::Words encode_color(const Vec4<Float>& color, const Profile& profile) {
    return encode_target<AnyCodec>(truncate<AnyCodec::kComponents>(color), profile);
}

/// UNORM of 8 or 16 bits on integers, as llvmpipe blends it.
template <class AnyCodec, class Real>
typename AnyCodec::Words blend_on_codes(const typename AnyCodec::Words& stored, const OutputColors<Real>& colors,
                                        const BlendState& state, const Profile& profile) {
    constexpr int kBits = kPlainUnormBits<AnyCodec>;
    const auto codes = [&](const auto& color) {
        const auto code = [&](const auto& x) { return driver_unorm_code(x, kBits, profile.unorm_rounding); };
        return std::array<Int, 4>{code(color.x), code(color.y), code(color.z), code(color.w)};
    };
    const glm::vec4& k = colors.constant;
    BlendCodes in{codes(colors.color), codes(colors.second), {}, codes(Vec4<Float>{k.x, k.y, k.z, k.w})};
    in.dst = {Int(0), Int(0), Int(0), Int((1 << kBits) - 1)};
    for (std::size_t c = 0; c < AnyCodec::kComponents; ++c) in.dst[c] = AnyCodec::code(stored, c);
    const std::array<Int, 4> blended = blend_codes(in, state, kBits);
    std::array<Int, AnyCodec::kComponents> kept;
    for (std::size_t c = 0; c < kept.size(); ++c) kept[c] = blended[c];
    return packed<AnyCodec>(kept);
}

/// Blending as a driver does it, of formats that were compared with it. False: of others, which blend as the specification
/// says.
template <class AnyCodec, class Real>
bool blend_as_driver(const typename AnyCodec::Words& stored, const OutputColors<Real>& colors, const BlendState& state,
                     const Profile& profile, typename AnyCodec::Words& words) {
    constexpr bool kUnorm = kPlainUnormBits<AnyCodec> > 0;
    if constexpr (!kUnorm && !kIsFloat<AnyCodec>) {
        return false;
    } else {
        const glm::vec4& k = colors.constant;
        BlendInput<Float> in{to_floats(colors.color), to_floats(colors.second), {}, {k.x, k.y, k.z, k.w}};
        switch (profile.blend_arithmetic) {
            case BlendArithmetic::D3d11: return false;
            case BlendArithmetic::Llvmpipe:
                if constexpr (kUnorm) {
                    words = blend_on_codes<AnyCodec>(stored, colors, state, profile);
                } else {
                    in.dst = expand(AnyCodec::template decode<Float>(stored));
                    words = encode_color<AnyCodec>(blend_as_llvmpipe(in, state, profile.flush_denormals && !kIsHalf<AnyCodec>),
                                                   profile);
                }
                return true;
            case BlendArithmetic::SwiftShader:
                words = stored;
                if (leaves_target(state)) return true;
                in.dst = expand(decode_as_swiftshader<AnyCodec>(stored));
                if constexpr (kUnorm) {
                    const auto limited = [](const Vec4<Float>& c) {
                        return Vec4<Float>{saturate(c.x), saturate(c.y), saturate(c.z), saturate(c.w)};
                    };
                    in.src = limited(in.src);
                    in.src1 = limited(in.src1);
                    in.constant = limited(in.constant);
                }
                words = encode_color<AnyCodec>(blend_as_swiftshader(in, state), profile);
                return true;
        }
        __builtin_unreachable();
    }
}

}  // namespace

ColorTarget::ColorTarget(Texture& target, const TargetView& where, const BlendState& how)
    : texture(&target),
      view(where),
      state(how),
      pitch(target.table().pitch[static_cast<std::size_t>(where.level)]),
      plane(target.layer_stride()),
      width(target.width(where.level)) {
    const int every = (1 << target.info().components) - 1;
    merges = how.enable || (how.write_mask & every) != every;
    set_layer(0);
}

namespace {

/// What a target stores where it holds `stored` now: blended, with the components of the write mask.
template <class AnyCodec, class Real>
typename AnyCodec::Words merged(const ColorTarget& target, const typename AnyCodec::Words& stored,
                                const OutputColors<Real>& colors, const Profile& profile) {
    constexpr std::size_t kCount = AnyCodec::kComponents;
    typename AnyCodec::Words words;
    if (!target.state.enable) {
        words = encode_target<AnyCodec>(truncate<kCount>(colors.color), profile);
    } else if (!blend_as_driver<AnyCodec>(stored, colors, target.state, profile, words)) {
        const Vec4<Real> dst = expand(AnyCodec::template decode<Real>(stored));
        const glm::vec4& k = colors.constant;
        const Vec4<Real> color =
            blend(BlendInput<Real>{colors.color, colors.second, dst, {Real(k.x), Real(k.y), Real(k.z), Real(k.w)}},
                  target.state, blend_range(target.texture->info().type));
        words = encode_target<AnyCodec>(truncate<kCount>(color), profile);
    }
    return merge_components<AnyCodec>(words, stored, target.state.write_mask);
}

/// Stores the lanes in `mask` to the plane of one sample.
template <class AnyCodec>
GNOMON_INLINE void store_wave(const ColorTarget& target, std::byte* plane, const Wave& wave, std::uint32_t mask,
                              const typename AnyCodec::Words& words) {
    const std::ptrdiff_t pitch = target.pitch;
    if (AnyCodec::kBytes == 4 && wave.row) {
        // Lanes outside get back what they had: the tile is this worker's alone.
        std::byte* upper = plane + wave.quad_y[0] * pitch + std::ptrdiff_t{wave.quad_x[0]} * 4;
        Int texels = words[0];
        if (mask != kAllLanes) texels = select(Mask::from_bits(mask), texels, load_quad_row(upper, upper + pitch));
        store_quad_row(texels, upper, upper + pitch);
        return;
    }
    const SpilledTexels<AnyCodec> spilled(words);
    for (std::size_t q = 0; q < static_cast<std::size_t>(wave.quads); ++q) {
        const std::uint32_t lanes = mask >> (4 * q) & 0xfu;
        if (lanes == 0) continue;
        std::byte* top = plane + wave.quad_y[q] * pitch + std::ptrdiff_t{wave.quad_x[q]} * AnyCodec::kBytes;
        std::byte* bottom = top + pitch;
        // A whole quad of 32-bit texels is two stores.
        if (AnyCodec::kBytes == 4 && lanes == 0xfu) {
            std::memcpy(top, &spilled.words[0][4 * q], 8);
            std::memcpy(bottom, &spilled.words[0][4 * q + 2], 8);
            continue;
        }
        if ((lanes & 1u) != 0) spilled.store_lane(top, 4 * q);
        if ((lanes & 2u) != 0) spilled.store_lane(top + AnyCodec::kBytes, 4 * q + 1);
        if ((lanes & 4u) != 0) spilled.store_lane(bottom, 4 * q + 2);
        if ((lanes & 8u) != 0) spilled.store_lane(bottom + AnyCodec::kBytes, 4 * q + 3);
    }
}

std::byte* plane_of(const ColorTarget& target, std::size_t sample) {
    return target.base + std::ptrdiff_t{target.plane} * static_cast<std::ptrdiff_t>(sample);
}

/// What most draws do: every component replaced, codes as the specification rounds them. One encoding serves all samples.
template <class AnyCodec, class Real>
void replace_samples(const ColorTarget& target, const Wave& wave, std::span<const std::uint32_t> lanes,
                     const OutputColors<Real>& colors, const Profile& profile) {
    const auto words = AnyCodec::encode(truncate<AnyCodec::kComponents>(colors.color), profile.float_narrowing);
    for (std::size_t s = 0; s < lanes.size(); ++s)
        if (lanes[s] != 0) store_wave<AnyCodec>(target, plane_of(target, s), wave, lanes[s], words);
}

template <class AnyCodec, class Real>
void write_samples(const ColorTarget& target, const Wave& wave, std::span<const std::uint32_t> lanes,
                   const OutputColors<Real>& colors, const Profile& profile) {
    typename AnyCodec::Words words;
    if (!target.merges) words = encode_target<AnyCodec>(truncate<AnyCodec::kComponents>(colors.color), profile);
    for (std::size_t s = 0; s < lanes.size(); ++s) {
        if (lanes[s] == 0) continue;
        std::byte* plane = plane_of(target, s);
        if (target.merges) {
            // Lanes past the last quad repeat the first, lanes past the target's edge read what lies there: padding.
            const Int offset = wave.pixels.y * Int(target.pitch) + wave.pixels.x * Int(AnyCodec::kBytes);
            words = merged<AnyCodec>(target, AnyCodec::load(plane, offset), colors, profile);
        }
        store_wave<AnyCodec>(target, plane, wave, lanes[s], words);
    }
}

}  // namespace

template <class Real>
ColorWriter<Real> color_writer(const ColorTarget& target, const Profile& profile) {
    const bool replaces =
        !target.merges && profile.unorm_rounding == UnormRounding::HalfUp && profile.half_targets == HalfTargets::Narrowed;
    return with_codec(target.texture->desc().format, [&]<class AnyCodec>(AnyCodec) -> ColorWriter<Real> {
        return replaces ? &replace_samples<AnyCodec, Real> : &write_samples<AnyCodec, Real>;
    });
}

template ColorWriter<Float> color_writer(const ColorTarget&, const Profile&);
template ColorWriter<Double> color_writer(const ColorTarget&, const Profile&);

}  // namespace gnomon
