#include "pipeline/image_access.h"

#include "pipeline/lane_memory.h"
#include "texunit/codec.h"
#include "texunit/instruction.h"
#include "texunit/store.h"

namespace gnomon {

namespace {

std::byte* texel_address(const ImageLevel& image, std::int32_t x, std::int32_t y) {
    return image.texture.row(image.level, y, image.layer) + x * image.texture.info().bytes_per_texel;
}

/// The words of single texels, exactly their bytes: a gather of words would also touch the neighbours of narrow texels, which
/// another group may be writing.
template <class AnyCodec>
typename AnyCodec::Words load_texel_words(const ImageLevel& image, Int x, Int y, Mask valid) {
    const auto xs = x.lanes();
    const auto ys = y.lanes();
    std::array<std::array<std::int32_t, kLanes>, AnyCodec::kWords> lanes{};
    for_each_lane(valid, [&](std::size_t i) {
        std::array<std::int32_t, AnyCodec::kWords> texel{};
        std::memcpy(texel.data(), texel_address(image, xs[i], ys[i]), AnyCodec::kBytes);
        for (std::size_t w = 0; w < texel.size(); ++w) lanes[w][i] = texel[w];
    });
    typename AnyCodec::Words words;
    for (std::size_t w = 0; w < words.size(); ++w) words[w] = Int::load(lanes[w].data());
    return words;
}

template <class AnyCodec>
void store_texel_words(const ImageLevel& image, Int x, Int y, const typename AnyCodec::Words& words, Mask valid) {
    const auto xs = x.lanes();
    const auto ys = y.lanes();
    const SpilledTexels<AnyCodec> spilled(words);
    for_each_lane(valid, [&](std::size_t i) { spilled.store_lane(texel_address(image, xs[i], ys[i]), i); });
}

}  // namespace

template <class Real>
Vec4<Real> load_texels(const ImageLevel& image, Int x, Int y, Mask valid) {
    return with_codec(image.texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        const Vec4<Real> read = expand(AnyCodec::template decode<Real>(load_texel_words<AnyCodec>(image, x, y, valid)));
        const Vec4<Real> outside = out_of_bounds<Real>(image.texture.info());
        return Vec4<Real>{select(valid, read.x, outside.x), select(valid, read.y, outside.y), select(valid, read.z, outside.z),
                          select(valid, read.w, outside.w)};
    });
}

template <class Real>
void store_texels(const ImageLevel& image, Int x, Int y, const Vec4<Real>& color, Narrowing narrowing, Mask valid) {
    with_codec(image.texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        store_texel_words<AnyCodec>(image, x, y, AnyCodec::encode(truncate<AnyCodec::kComponents>(color), narrowing), valid);
    });
}

Vec4<Int> load_texel_codes(const ImageLevel& image, Int x, Int y, Mask valid) {
    Vec4<Int> codes{Int(0), Int(0), Int(0), Int(image.texture.info().components == 4 ? 0 : 1)};
    with_codec(image.texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        if constexpr (AnyCodec::kIsInteger) {
            const auto words = load_texel_words<AnyCodec>(image, x, y, valid);
            codes.x = words[0];
            if constexpr (AnyCodec::kComponents >= 2) codes.y = words[1];
            if constexpr (AnyCodec::kComponents >= 4) {
                codes.z = words[2];
                codes.w = words[3];
            }
        }
    });
    return codes;
}

void store_texel_codes(const ImageLevel& image, Int x, Int y, const Vec4<Int>& codes, Mask valid) {
    with_codec(image.texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        if constexpr (AnyCodec::kIsInteger)
            store_texel_words<AnyCodec>(image, x, y, truncate<AnyCodec::kComponents>(codes), valid);
    });
}

template Vec4<Float> load_texels(const ImageLevel&, Int, Int, Mask);
template Vec4<Double> load_texels(const ImageLevel&, Int, Int, Mask);
template void store_texels(const ImageLevel&, Int, Int, const Vec4<Float>&, Narrowing, Mask);
template void store_texels(const ImageLevel&, Int, Int, const Vec4<Double>&, Narrowing, Mask);

}  // namespace gnomon
