// Levels of detail and anisotropy.
#include "tests/agree/made_texture.h"
#include "tests/agree/measure.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace gnomon::agree {
namespace {

float narrow(double x) { return static_cast<float>(x); }

// Levels that hold their number.
Levels numbered_levels(TexelFormat format, int size) {
    return made_levels(format, {size, size}, full_levels(size, size),
                       [](int level, int, int) { return static_cast<float>(level); });
}

// A point in the middle with gradients in texels of level 0.
Point with_gradients(const std::array<float, 4>& texels, std::array<int, 2> size) {
    const auto w = static_cast<float>(size[0]);
    const auto h = static_cast<float>(size[1]);
    return {.u = 0.5f, .v = 0.5f, .dudx = texels[0] / w, .dvdx = texels[1] / h, .dudy = texels[2] / w, .dvdy = texels[3] / h};
}

// Each point as two quads, of which the first sample counts: llvmpipe 22.3 takes anisotropic footprints from quads and lets
// neighbouring ones share.
std::vector<float> try_quads(const Source& source, const Levels& texture, const SamplerState& sampler,
                             std::span<const Point> points, std::string& refused) {
    std::vector<Point> twice;
    for (const Point& point : points) twice.insert(twice.end(), 2, point);
    const std::vector<float> all = try_samples(source, texture, sampler, Instruction::Gradient, as_quads(twice), refused);
    std::vector<float> values;
    for (std::size_t i = 0; i < all.size(); i += 8) values.push_back(all[i]);
    return values;
}

// The response of a one-level texture, 0 left and 1 right of the middle, to a footprint that walks across it.
struct EdgeWalk {
    std::array<int, 2> size{};
    double major_texels = 1;
    double minor_texels = 1;
    double step_texels = 1;
    double reach_texels = 1;

    [[nodiscard]] int count() const { return static_cast<int>(2 * reach_texels / step_texels) + 1; }
    /// Texels right of the edge.
    [[nodiscard]] double at(double i) const { return i * step_texels - reach_texels; }
    void add_points(std::vector<Point>& points) const {
        for (int i = 0; i < count(); ++i) {
            Point point = with_gradients({narrow(major_texels), 0, 0, narrow(minor_texels)}, size);
            point.u = narrow(0.5 + at(i) / size[0]);
            points.push_back(point);
        }
    }
};

Levels edge_levels(TexelFormat format, std::array<int, 2> size) {
    return made_levels(format, size, 1, [&](int, int x, int) { return x < size[0] / 2 ? 0.0f : 1.0f; });
}

// A minor axis of several texels parts the probes; each makes a ramp one texel wide at most.
constexpr double kMinorTexels = 4;
constexpr std::array<int, 2> kProbeSize{512, 4};
EdgeWalk probe_walk(double ratio) {
    return {.size = kProbeSize,
            .major_texels = kMinorTexels * ratio,
            .minor_texels = kMinorTexels,
            .step_texels = 1.0 / 16,
            .reach_texels = kMinorTexels * ratio / 2 + 3};
}

// Rises of the response, parted by flat stretches: those of coarse weights within one rise are shorter.
ProbeLine probes_of(const EdgeWalk& walk, std::span<const float> response) {
    constexpr float kFlat = 1e-5f;
    constexpr double kParting = 0.3;  // texels
    constexpr double kWidest = 1.5;   // texels
    ProbeLine line;
    std::size_t first = 0;
    std::size_t last = 0;
    double weight = 0;
    double moment = 0;
    const auto finish = [&] {
        if (first == 0) return;
        if (static_cast<double>(last + 1 - first) * walk.step_texels > kWidest) line.is_smooth = true;
        line.weights.push_back(narrow(weight));
        line.positions.push_back(narrow(-moment / weight / walk.major_texels));
        first = 0;
        weight = moment = 0;
    };
    for (std::size_t i = 1; i < response.size(); ++i) {
        const double rise = response[i] - response[i - 1];
        if (std::abs(rise) <= kFlat) continue;
        if (first != 0 && static_cast<double>(i - last) * walk.step_texels > kParting) finish();
        if (first == 0) first = i;
        last = i;
        weight += rise;
        moment += rise * walk.at(static_cast<double>(i) - 0.5);
    }
    finish();
    std::reverse(line.positions.begin(), line.positions.end());
    std::reverse(line.weights.begin(), line.weights.end());
    line.is_smooth = line.is_smooth || line.weights.size() > 16;
    return line;
}

std::vector<ProbeLine> measure_lines(const Source& source, TexelFormat format, std::span<const double> ratios, int limit,
                                     std::string& refused) {
    std::vector<Point> points;
    for (const double ratio : ratios) probe_walk(ratio).add_points(points);
    SamplerState sampler = clamped(Filter::Linear);
    sampler.max_anisotropy = static_cast<float>(limit);
    const std::vector<float> values = try_quads(source, edge_levels(format, kProbeSize), sampler, points, refused);
    std::vector<ProbeLine> lines;
    std::span<const float> rest(values);
    for (const double ratio : ratios) {
        if (rest.empty()) break;
        const EdgeWalk walk = probe_walk(ratio);
        ProbeLine& line = lines.emplace_back(probes_of(walk, rest.first(static_cast<std::size_t>(walk.count()))));
        rest = rest.subspan(static_cast<std::size_t>(walk.count()));
        line.ratio = narrow(ratio);
        line.limit = limit;
    }
    return lines;
}

// Distance of a response to that of `probes` equal ones whose filter is `width` texels wide.
double response_distance(const EdgeWalk& walk, std::span<const float> response, int probes, bool interior, double width) {
    double sum = 0;
    for (std::size_t i = 0; i < response.size(); ++i) {
        double expected = 0;
        for (int k = 0; k < probes; ++k) {
            const double t = interior ? (k + 1.0) / (probes + 1) - 0.5 : (k + 0.5) / probes - 0.5;
            const double texels = walk.at(static_cast<double>(i)) + t * walk.major_texels;
            expected += (width > 0 ? std::clamp(texels / width + 0.5, 0.0, 1.0) : texels >= 0 ? 1.0 : 0.0) / probes;
        }
        sum += (response[i] - expected) * (response[i] - expected);
    }
    return std::sqrt(sum / static_cast<double>(response.size()));
}

void measure_magnified_probes(const Source& source, TexelFormat format, AnisoMeasurement& result) {
    // Off the texels' boundaries by an odd fraction of the step.
    const EdgeWalk walk{
        .size = {64, 8}, .major_texels = 4, .minor_texels = 0.5, .step_texels = 1.0 / 32, .reach_texels = 4 + 1.0 / 64};
    std::vector<Point> points;
    walk.add_points(points);
    SamplerState sampler = clamped(Filter::Nearest);
    sampler.max_anisotropy = 16;
    const std::vector<float> response = try_quads(source, edge_levels(format, walk.size), sampler, points, result.refused);
    for (int n = 1; n <= 16; ++n) {
        const auto distance = [&](bool interior) {
            return response.empty() ? 1.0
                                    : std::min(response_distance(walk, response, n, interior, 0),
                                               response_distance(walk, response, n, interior, 1));
        };
        result.magnified_interior[static_cast<std::size_t>(n - 1)] = distance(true);
        result.magnified_centred[static_cast<std::size_t>(n - 1)] = distance(false);
    }
}

void measure_aniso_lod(const Source& source, TexelFormat format, float bias, std::vector<AnisoLod>& lods,
                       std::string& refused) {
    constexpr int kSize = 128;
    SamplerState sampler = clamped(Filter::Linear, Mip::Linear);
    sampler.max_anisotropy = 16;
    sampler.lod_bias = bias;
    std::vector<Point> points;
    points.reserve(lods.size());
    for (const AnisoLod& lod : lods) points.push_back(with_gradients(lod.texels, {kSize, kSize}));
    const std::vector<float> values = try_quads(source, numbered_levels(format, kSize), sampler, points, refused);
    if (values.size() != lods.size()) lods.clear();
    for (std::size_t i = 0; i < lods.size(); ++i) {
        lods[i].lod = values[i];
        lods[i].bias = bias;
    }
}

// Two vectors of 2 to `longest` texels, neither along an axis nor along one another.
std::array<float, 4> oblique_pair(Sequence& random, double longest) {
    for (;;) {
        std::array<float, 4> texels{};
        for (float& x : texels) x = narrow(std::floor((random.next() * 2 - 1) * longest * 64) / 64);
        const double area = std::abs(double{texels[0]} * texels[3] - double{texels[1]} * texels[2]);
        const double dx = std::hypot(texels[0], texels[1]);
        const double dy = std::hypot(texels[2], texels[3]);
        // At least 1.5 texels across.
        if (dx > 2 && dy > 2 && area > 1.5 * std::hypot(dx, dy)) return texels;
    }
}

}  // namespace

MipMeasurement measure_mips(const Source& source, TexelFormat format) {
    MipMeasurement result;
    const auto sample_lods = [&](const Levels& texture, const SamplerState& sampler, std::span<const float> lods) {
        std::vector<Point> points;
        for (const float lod : lods) points.push_back({.u = 0.5f, .v = 0.5f, .lod = lod});
        return try_samples(source, texture, sampler, Instruction::Lod, points, result.ramp.refused);
    };

    const Levels two = made_levels(format, {2, 2}, 2, [](int level, int, int) { return static_cast<float>(level); });
    std::vector<float> lods;
    for (int i = 0; i <= 4096; ++i) lods.push_back(static_cast<float>(i) / 4096);
    const std::vector<float> ramp = sample_lods(two, clamped(Filter::Linear, Mip::Linear), lods);
    if (ramp.empty()) return result;
    result.ramp = step_table(ramp);
    lods.clear();
    for (int i = 0; i < 1024; ++i) lods.push_back(static_cast<float>(i) * 0x1p-24f);
    const std::vector<float> fine = sample_lods(two, clamped(Filter::Linear, Mip::Linear), lods);
    result.fine_distinct = static_cast<int>(std::set<float>(fine.begin(), fine.end()).size());

    // Where the nearest mip filter changes over, and what it takes halfway.
    const Levels chain = numbered_levels(format, 32);
    std::vector<Search> searches;
    for (int level = 1; level <= 5; ++level) {
        const auto above = static_cast<float>(level);
        searches.push_back({.below = above - 0.75f, .above = above, .threshold = above - 0.5f});
    }
    result.switch_lod = find_thresholds(
        searches, [&](std::span<const float> at) { return sample_lods(chain, clamped(Filter::Nearest, Mip::Nearest), at); });
    for (const float level :
         sample_lods(chain, clamped(Filter::Nearest, Mip::Nearest), std::vector<float>{0.5f, 1.5f, 2.5f, 3.5f}))
        result.at_half.push_back(static_cast<int>(level));

    SamplerState limited = clamped(Filter::Linear, Mip::Linear);
    limited.lod_bias = 0.5f;
    limited.min_lod = 1.25f;
    limited.max_lod = 3.5f;
    lods.clear();
    for (int i = -8; i <= 40; ++i) lods.push_back(static_cast<float>(i) / 8);
    const std::vector<float> clamps = sample_lods(chain, limited, lods);
    result.clamps_after_bias = clamps.size() == lods.size();
    for (std::size_t i = 0; i < clamps.size(); ++i)
        if (std::abs(clamps[i] - std::clamp(lods[i] + 0.5f, 1.25f, 3.5f)) > 1.0f / 16) result.clamps_after_bias = false;
    return result;
}

LodMeasurement measure_lod(const Source& source, TexelFormat format) {
    constexpr int kSize = 64;
    LodMeasurement result;
    for (int i = 0; i <= 200; ++i) {
        const auto texels = narrow(std::exp2(i * 3 / 200.0));
        result.isotropic.push_back({.texels = {texels, 0, 0, texels}});
    }
    Sequence random;
    for (int i = 0; i < 32; ++i) result.oblique.push_back({.texels = oblique_pair(random, 8)});
    const Levels texture = numbered_levels(format, kSize);
    for (std::vector<GradientLod>* lods : {&result.isotropic, &result.oblique}) {
        std::vector<Point> points;
        for (const GradientLod& lod : *lods) points.push_back(with_gradients(lod.texels, {kSize, kSize}));
        const std::vector<float> values =
            try_samples(source, texture, clamped(Filter::Linear, Mip::Linear), Instruction::Gradient, points, result.refused);
        if (values.size() != lods->size()) lods->clear();
        for (std::size_t i = 0; i < lods->size(); ++i) (*lods)[i].lod = values[i];
    }
    return result;
}

AnisoMeasurement measure_anisotropy(const Source& source, TexelFormat format) {
    AnisoMeasurement result;
    std::vector<double> ratios;
    for (int quarter = 4; quarter <= 64; ++quarter) ratios.push_back(quarter / 4.0);
    result.ratios = measure_lines(source, format, ratios, 16, result.refused);
    if (result.ratios.empty()) return result;
    result.beyond = measure_lines(source, format, std::array{32.0}, 16, result.refused);
    for (int limit = 2; limit <= 16; ++limit)
        for (const ProbeLine& line : measure_lines(source, format, std::array{16.0}, limit, result.refused))
            result.limits.push_back(line);

    for (const float ratio : {1.0f, 1.5f, 2.0f, 2.5f, 3.25f, 4.0f, 6.5f, 8.0f, 11.5f, 15.5f, 16.0f, 24.0f, 32.0f}) {
        result.straight.push_back({.texels = {2 * ratio, 0, 0, 2}});
        result.straight.push_back({.texels = {0, 2, 2 * ratio, 0}});
    }
    measure_aniso_lod(source, format, 0, result.straight, result.refused);
    Sequence random;
    for (int i = 0; i < 32; ++i) result.oblique.push_back({.texels = oblique_pair(random, 16)});
    measure_aniso_lod(source, format, 0, result.oblique, result.refused);
    result.magnified = {{.texels = {1, 0, 0, 0.25f}}, {.texels = {2, 0, 0, 0.5f}}, {.texels = {4, 0, 0, 0.5f}}};
    measure_aniso_lod(source, format, 3, result.magnified, result.refused);
    measure_magnified_probes(source, format, result);
    return result;
}

}  // namespace gnomon::agree
