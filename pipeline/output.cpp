#include "pipeline/output.h"

#include "texunit/codec.h"
#include "texunit/store.h"

namespace gnomon {

template <class Real>
void write_color(Texture& target, const Wave& wave, std::uint32_t mask, const Vec4<Real>& color, const Profile& profile) {
    with_codec(target.desc().format, [&]<class AnyCodec>(AnyCodec) {
        const auto texel = truncate<AnyCodec::kComponents>(color);
        const SpilledTexels<AnyCodec> spilled(AnyCodec::encode(texel, profile.float_narrowing));
        const std::ptrdiff_t pitch = target.table().pitch[0];
        for (std::size_t q = 0; q < static_cast<std::size_t>(wave.quads); ++q) {
            const std::uint32_t lanes = mask >> (4 * q) & 0xfu;
            std::byte* top = target.row(0, 0) + wave.quad_y[q] * pitch + std::ptrdiff_t{wave.quad_x[q]} * AnyCodec::kBytes;
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

template void write_color(Texture&, const Wave&, std::uint32_t, const Vec4<Float>&, const Profile&);
template void write_color(Texture&, const Wave&, std::uint32_t, const Vec4<Double>&, const Profile&);

}  // namespace gnomon
