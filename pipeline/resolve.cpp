#include "pipeline/resolve.h"

#include "sim/denormals.h"
#include "texunit/codec.h"
#include "texunit/store.h"

#include <algorithm>

namespace gnomon {

namespace {

template <class Real>
void resolve_rows(const Texture& source, Texture& destination, const ResolvePlace& place, const Profile& profile, int first,
                  int end) {
    const DenormalScope denormals(profile.flush_denormals);
    const int width = source.width(0);
    const int samples = source.desc().samples;
    const Real weight(1.0f / static_cast<float>(samples));  // a power of two
    with_codec(source.desc().format, [&]<class AnyCodec>(AnyCodec) {
        for (int y = first; y < end; ++y) {
            for (int x = 0; x < width; x += kLanes) {
                // Lanes past the end repeat the last texel.
                const Int column = min(Int(x) + lane_index(), Int(width - 1));
                typename AnyCodec::template Texel<Real> sum;
                for (int s = 0; s < samples; ++s) {
                    const auto words = AnyCodec::load(source.row(0, y, place.source_layer, s), column * Int(AnyCodec::kBytes));
                    const auto texel = AnyCodec::template decode<Real>(words);
                    for (std::size_t c = 0; c < texel.size(); ++c) sum[c] = s == 0 ? texel[c] : sum[c] + texel[c];
                }
                for (Real& component : sum) component = component * weight;
                store_row<AnyCodec>(
                    destination.row(place.level, y, place.layer) + static_cast<std::ptrdiff_t>(x) * AnyCodec::kBytes,
                    AnyCodec::encode(sum, profile.float_narrowing), std::min(kLanes, width - x));
            }
        }
    });
}

}  // namespace

void resolve_samples(const Texture& source, Texture& destination, const ResolvePlace& place, const Profile& profile,
                     Workers& workers) {
    constexpr int kRows = 16;
    const int height = source.height(0);
    workers.for_each(static_cast<std::size_t>((height + kRows - 1) / kRows), [&](std::size_t piece) {
        const int first = static_cast<int>(piece) * kRows;
        const int end = std::min(first + kRows, height);
        if (profile.arithmetic == Arithmetic::Fp32) {
            resolve_rows<Float>(source, destination, place, profile, first, end);
        } else {
            resolve_rows<Double>(source, destination, place, profile, first, end);
        }
    });
}

}  // namespace gnomon
