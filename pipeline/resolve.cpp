#include "pipeline/resolve.h"

#include "pipeline/target_codec.h"
#include "sim/denormals.h"
#include "texunit/store.h"

#include <algorithm>

namespace gnomon {

namespace {

/// The samples of a wave of pixels.
template <class AnyCodec>
using Samples = std::array<typename AnyCodec::Words, kMaxSamples>;

/// In order of samples, then times 1 / N, a power of two.
template <class AnyCodec, class Real, class Decode>
typename AnyCodec::template Texel<Real> mean(const Samples<AnyCodec>& samples, int count, const Decode& decode) {
    typename AnyCodec::template Texel<Real> sum = decode(samples[0]);
    for (std::size_t s = 1; s < static_cast<std::size_t>(count); ++s) {
        const auto texel = decode(samples[s]);
        for (std::size_t c = 0; c < sum.size(); ++c) sum[c] = sum[c] + texel[c];
    }
    for (Real& component : sum) component = component * Real(1.0f / static_cast<float>(count));
    return sum;
}

/// SwiftShader Blitter.cpp: of four 8-bit samples the upper mean of two upper means, else of codes or numbers.
template <class AnyCodec>
typename AnyCodec::Words resolved_by_swiftshader(const Samples<AnyCodec>& samples, int count, const Profile& profile) {
    constexpr int kBits = kPlainUnormBits<AnyCodec>;
    if constexpr (kBits > 0) {
        std::array<Int, AnyCodec::kComponents> codes;
        for (std::size_t c = 0; c < codes.size(); ++c) {
            const auto code = [&](std::size_t s) { return AnyCodec::code(samples[s], c); };
            const auto upper_mean = [](Int a, Int b) { return shift_right_logical<1>(a + b + Int(1)); };
            if (kBits == 8 && count == 4) {
                codes[c] = upper_mean(upper_mean(code(0), code(1)), upper_mean(code(2), code(3)));
                continue;
            }
            Int sum = code(0);
            for (std::size_t s = 1; s < static_cast<std::size_t>(count); ++s) sum = sum + code(s);
            codes[c] = bounded_round_to_int(Float(sum) * Float(1.0f / static_cast<float>(count)));
        }
        return packed<AnyCodec>(codes);
    } else {
        return encode_target<AnyCodec>(mean<AnyCodec, Float>(samples, count, decode_as_swiftshader<AnyCodec>), profile);
    }
}

template <class Real, class AnyCodec>
typename AnyCodec::Words resolved(const Samples<AnyCodec>& samples, int count, const Profile& profile) {
    constexpr bool kCompared = kPlainUnormBits<AnyCodec> > 0 || kIsFloat<AnyCodec>;
    if constexpr (kCompared) {
        if (profile.resolve_arithmetic == ResolveArithmetic::SwiftShader)
            return resolved_by_swiftshader<AnyCodec>(samples, count, profile);
    }
    const bool llvmpipe = kCompared && profile.resolve_arithmetic == ResolveArithmetic::Llvmpipe;
    const auto decode = [llvmpipe](const auto& words) {
        auto texel = AnyCodec::template decode<Real>(words, llvmpipe ? UnormDecode::Reciprocal : UnormDecode::Divide);
        if (llvmpipe)
            for (Real& component : texel) component = component + Real(0.0f);  // its sum begins with 0: -0 becomes 0
        return texel;
    };
    return encode_target<AnyCodec>(mean<AnyCodec, Real>(samples, count, decode), profile);
}

template <class Real>
void resolve_rows(const Texture& source, Texture& destination, const ResolvePlace& place, const Profile& profile, int first,
                  int end) {
    // SwiftShader resolves on a thread that keeps denormals.
    const DenormalScope denormals(profile.flush_denormals && profile.resolve_arithmetic != ResolveArithmetic::SwiftShader);
    const int width = source.width(0);
    const int samples = source.desc().samples;
    with_codec(source.desc().format, [&]<class AnyCodec>(AnyCodec) {
        for (int y = first; y < end; ++y) {
            for (int x = 0; x < width; x += kLanes) {
                // Lanes past the end repeat the last texel.
                const Int column = min(Int(x) + lane_index(), Int(width - 1));
                Samples<AnyCodec> words;
                for (int k = 0; k < samples; ++k)
                    words[static_cast<std::size_t>(k)] =
                        AnyCodec::load(source.row(0, y, place.source_layer, k), column * Int(AnyCodec::kBytes));
                store_row<AnyCodec>(
                    destination.row(place.level, y, place.layer) + static_cast<std::ptrdiff_t>(x) * AnyCodec::kBytes,
                    resolved<Real, AnyCodec>(words, samples, profile), std::min(kLanes, width - x));
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
