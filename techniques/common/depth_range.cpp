// A depth buffer reduced to a histogram and its ends by one dispatch. [Lauritzen10]
#include "techniques/common/depth_range.h"

#include "pipeline/compute.h"
#include "sim/scalar_math.h"
#include "techniques/common/caster.h"

#include <bit>
#include <cstring>

namespace gnomon::techniques {

namespace {

constexpr std::int32_t kNearestWord = kDistanceBins;  // the largest of what the bits lack of kNearestBase: 0, nothing in view
constexpr std::int32_t kFarthestWord = kDistanceBins + 1;
constexpr std::size_t kWords = kDistanceBins + 2;
constexpr std::int32_t kNearestBase = 0x7f800000;  // the bits of infinity; those of positive floats ascend with the floats
constexpr int kRowsPerGroup = 8;

/// Counts the pixels of eight rows, first in memory of the group's own.
struct CountDistances {
    static constexpr GroupSize kGroupSize{32, kRowsPerGroup, 1};

    ReadImage depth{};
    RwBuffer<std::int32_t> counts{};
    int width = 0;
    int height = 0;
    float near_far = 0.0f;  // product of the distances of the planes
    float far_plane = 1.0f;
    float range = 0.0f;  // between the planes
    float inverse_near = 1.0f;
    float bins_per_octave = 1.0f;

    static constexpr auto fields() {
        using C = CountDistances;
        return std::tuple{Field{"depth", &C::depth},
                          Field{"counts", &C::counts},
                          Field{"width", &C::width},
                          Field{"height", &C::height},
                          Field{"near_far", &C::near_far},
                          Field{"far_plane", &C::far_plane},
                          Field{"range", &C::range},
                          Field{"inverse_near", &C::inverse_near},
                          Field{"bins_per_octave", &C::bins_per_octave}};
    }

    template <class G>
    void operator()(G& g) const {
        using Real = typename G::Real;
        const SharedArray<Int> own = g.shared_int(kWords);
        g.threads([&](const auto& t) {
            for (int first = 0; first < width; first += kGroupSize.x) {
                const Int x = Int(first) + t.local.x;
                const Mask on_image = (x < Int(width)) & (t.id.y < Int(height));
                const Real z = t.load(depth, x, t.id.y, on_image).x;
                const Mask drawn = on_image & (z < Real(1.0f));

                // Distance of a depth d in [0, 1]: n f / (f - d (f - n)).
                const Real distance = Real(near_far) / (Real(far_plane) - z * Real(range));
                const Real octaves = t.log2(distance * Real(inverse_near));
                const Real bin =
                    clamp(octaves * Real(bins_per_octave), Real(0.0f), Real(static_cast<float>(kDistanceBins - 1)));
                const Int bits = bits_of(to_float(distance));
                t.atomic_add(own, bounded_truncate_to_int(bin), Int(1), drawn);
                t.atomic_max(own, Int(kNearestWord), Int(kNearestBase) - bits, drawn);
                t.atomic_max(own, Int(kFarthestWord), bits, drawn);
            }
        });
        g.threads([&](const auto& t) {
            for (int first = 0; first < kDistanceBins; first += kGroupSize.threads()) {
                const Int bin = Int(first) + t.index;
                const Int pixels = t.load(own, bin);
                t.atomic_add(counts, bin, pixels, pixels > Int(0));
            }
            const Mask first = t.index == Int(0);
            for (const std::int32_t word : {kNearestWord, kFarthestWord})
                t.atomic_max(counts, Int(word), t.load(own, Int(word), first), first);
        });
    }
};

}  // namespace

DepthRange::DepthRange(Device& device) : device_(device) { counts_ = device.create_zeroed_buffer("distances", kWords * 4); }

DistanceHistogram DepthRange::measure(std::span<const SceneDraw> scene, const scenes::View& camera, int width, int height) {
    static const ComputeProgram program = make_compute_program<CountDistances>("count-distances");
    if (depth_ == TextureId::None)
        depth_ = device_.create_texture("distances in view", {.format = Format::D32Float, .width = width, .height = height});
    draw_depth_map(device_, scene, camera.clip_from_world(), depth_, {});

    std::array<std::uint32_t, kWords> words{};
    device_.execute(WriteBuffer{.id = counts_, .data = std::as_bytes(std::span(words))});
    const auto n = static_cast<double>(camera.znear);
    const auto f = static_cast<double>(camera.zfar);
    const CountDistances count{.depth = {depth_},
                               .counts = {counts_},
                               .width = width,
                               .height = height,
                               .near_far = static_cast<float>(n * f),
                               .far_plane = camera.zfar,
                               .range = static_cast<float>(f - n),
                               .inverse_near = static_cast<float>(1.0 / n),
                               .bins_per_octave = static_cast<float>(kDistanceBins / scalar::log2(f / n))};
    device_.execute(Dispatch{.label = "count distances",
                             .program = &program,
                             .constants = constants_of(count),
                             .groups_y = static_cast<std::uint32_t>((height + kRowsPerGroup - 1) / kRowsPerGroup)});

    std::memcpy(words.data(), device_.buffer(counts_).data.data(), sizeof words);
    DistanceHistogram histogram;
    if (words[kFarthestWord] == 0) return histogram;
    histogram.nearest = static_cast<double>(std::bit_cast<float>(kNearestBase - words[kNearestWord]));
    histogram.farthest = static_cast<double>(std::bit_cast<float>(words[kFarthestWord]));
    histogram.bins.assign(words.begin(), words.begin() + kDistanceBins);
    return histogram;
}

}  // namespace gnomon::techniques
