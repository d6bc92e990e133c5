#include "pipeline/output.h"

#include "texunit/codec.h"
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

template <class Real>
void write_color(const ColorTarget& target, const Wave& wave, std::uint32_t mask, int s, const OutputColors<Real>& colors,
                 const Profile& profile) {
    std::byte* base = target.base + std::ptrdiff_t{target.plane} * s;
    with_codec(target.texture->desc().format, [&]<class AnyCodec>(AnyCodec) {
        constexpr std::size_t kCount = AnyCodec::kComponents;
        typename AnyCodec::Words words;
        if (target.merges) {
            // Lanes past the last quad repeat the first, lanes past the target's edge read what lies there: padding.
            const Int offset = wave.y * Int(target.pitch) + wave.x * Int(AnyCodec::kBytes);
            const auto stored = AnyCodec::load(base, offset);
            Vec4<Real> color = colors.color;
            if (target.state.enable) {
                const Vec4<Real> dst = expand(AnyCodec::template decode<Real>(stored));
                const glm::vec4& k = colors.constant;
                color = blend(BlendInput<Real>{color, colors.second, dst, {Real(k.x), Real(k.y), Real(k.z), Real(k.w)}},
                              target.state, blend_range(target.texture->info().type));
            }
            words = merge_components<AnyCodec>(AnyCodec::encode(truncate<kCount>(color), profile.float_narrowing), stored,
                                               target.state.write_mask);
        } else {
            words = AnyCodec::encode(truncate<kCount>(colors.color), profile.float_narrowing);
        }

        const std::ptrdiff_t pitch = target.pitch;
        if (AnyCodec::kBytes == 4 && wave.row && mask == kAllLanes) {
            std::byte* upper = base + wave.quad_y[0] * pitch + std::ptrdiff_t{wave.quad_x[0]} * 4;
            store_quad_row(words[0], upper, upper + pitch);
            return;
        }
        const SpilledTexels<AnyCodec> spilled(words);
        for (std::size_t q = 0; q < static_cast<std::size_t>(wave.quads); ++q) {
            const std::uint32_t lanes = mask >> (4 * q) & 0xfu;
            if (lanes == 0) continue;
            std::byte* top = base + wave.quad_y[q] * pitch + std::ptrdiff_t{wave.quad_x[q]} * AnyCodec::kBytes;
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
    });
}

template void write_color(const ColorTarget&, const Wave&, std::uint32_t, int, const OutputColors<Float>&, const Profile&);
template void write_color(const ColorTarget&, const Wave&, std::uint32_t, int, const OutputColors<Double>&, const Profile&);

}  // namespace gnomon
