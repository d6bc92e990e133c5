#include "texunit/mipmap.h"

#include "sim/denormals.h"
#include "texunit/codec.h"
#include "texunit/store.h"

namespace gnomon {

namespace {

/// Up to three texels of the level above along one axis, and their weights.
template <class Real>
struct Taps {
    int count;
    std::array<Int, 3> index;
    std::array<Real, 3> weight;
};

template <class Real>
Taps<Real> taps_of(Int x, int size_above, MipGeneration filter) {
    const Real one(1.0f);
    if (filter == MipGeneration::Bilinear && size_above > 1 && size_above % 2 != 0) {
        // One sample at the centre of the coarser texel, (x + 1/2) * above / level, between two texels of the level above.
        const Real level(static_cast<float>(size_above / 2));
        const Real center = (Real(x) + Real(0.5f)) * Real(static_cast<float>(size_above)) / level - Real(0.5f);
        const Real whole = floor(center);
        const Int first = bounded_truncate_to_int(whole);
        const Real right = center - whole;
        return {2, {first, min(first + Int(1), Int(size_above - 1)), Int(0)}, {one - right, right, one}};
    }
    if (size_above == 1) return {1, {Int(0), Int(0), Int(0)}, {one, one, one}};
    const Int first = x + x;
    if (size_above % 2 == 0) return {2, {first, first + Int(1), Int(0)}, {Real(0.5f), Real(0.5f), one}};
    const int n = size_above / 2;
    const Real total(static_cast<float>(2 * n + 1));
    const Real left = Real(Int(n) - x) / total;
    const Real middle = Real(static_cast<float>(n)) / total;
    const Real right = Real(x + Int(1)) / total;
    return {3, {first, first + Int(1), first + Int(2)}, {left, middle, right}};
}

/// The mean of up to three values: one of them plus weighted differences from it, so that constants stay what they are whatever
/// the weights round to; where that is not finite, the weighted sum.
template <class Real>
Real weighted_mean(const std::array<Real, 3>& v, const Taps<Real>& taps) {
    if (taps.count == 1) return v[0];
    Real mean = v[0] + taps.weight[1] * (v[1] - v[0]);
    Real sum = v[0] * taps.weight[0] + v[1] * taps.weight[1];
    if (taps.count == 3) {
        mean = v[1] + (taps.weight[0] * (v[0] - v[1]) + taps.weight[2] * (v[2] - v[1]));
        sum = sum + v[2] * taps.weight[2];
    }
    return select(mean - mean == Real(0.0f), mean, sum);
}

/// One wave of texels of `level`, starting at (x, y).
template <class AnyCodec, class Real>
void reduce_wave(Texture& texture, int layer, int level, int x, int y, const Profile& profile) {
    const int above = level - 1;
    const Int column = min(Int(x) + lane_index(), Int(texture.width(level) - 1));
    const Taps<Real> across = taps_of<Real>(column, texture.width(above), profile.mip_generation);
    const Taps<Real> down = taps_of<Real>(Int(y), texture.height(above), profile.mip_generation);
    const auto l = static_cast<std::size_t>(above);
    const Int origin(texture.table().offset[l] + layer * texture.layer_stride());
    const Int pitch(texture.table().pitch[l]);

    // Means along each column of texels, then across the columns.
    constexpr std::size_t kCount = AnyCodec::kComponents;
    std::array<std::array<Real, 3>, kCount> columns;
    for (std::size_t i = 0; i < static_cast<std::size_t>(across.count); ++i) {
        std::array<std::array<Real, 3>, kCount> texels;
        for (std::size_t j = 0; j < static_cast<std::size_t>(down.count); ++j) {
            const Int offset = origin + down.index[j] * pitch + across.index[i] * Int(AnyCodec::kBytes);
            const auto texel = AnyCodec::template decode<Real>(AnyCodec::load(texture.data(), offset));
            for (std::size_t c = 0; c < kCount; ++c) texels[c][j] = texel[c];
        }
        for (std::size_t c = 0; c < kCount; ++c) columns[c][i] = weighted_mean(texels[c], down);
    }
    std::array<Real, kCount> sum;
    for (std::size_t c = 0; c < kCount; ++c) sum[c] = weighted_mean(columns[c], across);

    const int count = std::min(kLanes, texture.width(level) - x);
    store_row<AnyCodec>(texture.row(level, y, layer) + x * AnyCodec::kBytes, AnyCodec::encode(sum, profile.float_narrowing),
                        count);
}

template <class Real>
void generate(Texture& texture, const Profile& profile, Workers& workers) {
    with_codec(texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        const int layers = texture.desc().layers;
        for (int level = 1; level < texture.desc().levels; ++level) {
            const int width = texture.width(level);
            const int height = texture.height(level);
            const int rows_per_piece = std::max(1, 8192 / width);
            const int pieces = (height + rows_per_piece - 1) / rows_per_piece;
            workers.for_each(static_cast<std::size_t>(pieces * layers), [&](std::size_t task) {
                const DenormalScope denormals(profile.flush_denormals);
                const int layer = static_cast<int>(task) / pieces;
                const int first = static_cast<int>(task) % pieces * rows_per_piece;
                for (int y = first; y < std::min(height, first + rows_per_piece); ++y)
                    for (int x = 0; x < width; x += kLanes) reduce_wave<AnyCodec, Real>(texture, layer, level, x, y, profile);
            });
        }
    });
}

}  // namespace

void generate_mips(Texture& texture, const Profile& profile, Workers& workers) {
    if (texture.info().is_integer()) fail("mips of a texture in {}: integers are not filtered", texture.info().name);
    if (profile.arithmetic == Arithmetic::Fp32) {
        generate<Float>(texture, profile, workers);
    } else {
        generate<Double>(texture, profile, workers);
    }
}

}  // namespace gnomon
