// Measurements of a texture unit from outside: textures and coordinates in, numbers out, what they say as plain values.
//
// Each takes a Source, so that the same measurement runs on a Vulkan driver (SamplingPeer::sample) and on a profile of ours
// (profile_source). They know nothing about the unit; fit.h makes a profile of what they saw.
#pragma once

#include "tests/agree/sampling.h"

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gnomon::agree {

/// Samples of a texture at points, as SamplingPeer::sample returns them. Throws Error for what it cannot do.
using Source = std::function<std::vector<Sample>(const Levels&, const SamplerState&, Instruction, std::span<const Point>)>;

/// A value over equally spaced positions 0..last, as the positions where it changes.
struct StepTable {
    struct Step {
        int position = 0;  // the first with this value
        float value = 0;

        bool operator==(const Step&) const = default;
    };
    std::string refused{};  // why there is nothing; empty when there is
    int last = 0;
    std::vector<Step> steps{};
    int distinct = 0;
    bool is_monotone = false;  // never falls

    bool operator==(const StepTable&) const = default;
};

enum class StepRounding { NearestEven, NearestUp, NearestDown, Truncate };

/// A table read as position / last, rounded to so many bits.
struct StepRule {
    bool is_exact = false;      // each position has its own value
    std::optional<int> bits{};  // 1 to 12; none where no rule explains the table
    StepRounding rounding = StepRounding::NearestEven;
    double largest_error = 0;  // between the values and the rule's
};
StepRule step_rule(const StepTable& table);

/// Weights between two texels 0 and 1 (of the format's range).
struct WeightMeasurement {
    TexelFormat format = TexelFormat::R32f;
    StepTable ramp{};       // 2^16 steps from one texel's centre to the next one's
    int fine_distinct = 0;  // of 1024 positions 2^-24 texels apart, next to the first centre
    int first_one = 0;      // least position of the ramp with the second texel alone; last + 1 if none
    bool is_filtered = false;
    int between_codes = 0;  // distinct values between two texels one code apart (unorm); 2 or so: results are codes
};
WeightMeasurement measure_weights(const Source& source, TexelFormat format);

/// Where a gather's 2x2 footprint moves on, in the positions of WeightMeasurement::ramp; last + 1 if not before the end.
struct GatherMeasurement {
    std::string refused{};
    int last = 0;
    int switch_position = 0;
};
GatherMeasurement measure_gather(const Source& source);

/// Where a nearest filter goes from texel k - 1 to k.
struct TexelBoundary {
    int size = 0;  // texels of the axis
    int texel = 0;
    float coordinate = 0;      // the least with texel k
    double offset_texels = 0;  // coordinate * size - k, exactly
};
struct BoundaryMeasurement {
    TexelFormat format = TexelFormat::R32f;
    std::string refused{};
    std::vector<TexelBoundary> boundaries{};
};
BoundaryMeasurement measure_boundaries(const Source& source, TexelFormat format);

/// Every code by a nearest filter.
struct DecodeMeasurement {
    TexelFormat format = TexelFormat::Rgba8;
    std::string refused{};
    int codes = 0;
    int divides = 0;      // equal to code / largest, correctly rounded
    int reciprocals = 0;  // equal to code * binary32(1 / largest)
};
DecodeMeasurement measure_decode(const Source& source, TexelFormat format);

/// How two texels meet: results that equal each form, of pairs with the weight `weight_steps`ths.
struct FormMeasurement {
    std::string refused{};
    int samples = 0;
    int lerps = 0;                  // a + w (b - a)
    int fused = 0;                  // fma(w, b - a, a)
    int products = 0;               // a (1 - w) + b w
    bool keeps_infinity = false;    // between infinity and a number
    bool ignores_infinity = false;  // of weight 0
    int late_unorm = 0;   // rg16unorm: of `samples`, equal to a filter of codes multiplied by the reciprocal of the largest
    int early_unorm = 0;  // equal to a filter of decoded texels, by either way to decode
};
FormMeasurement measure_form(const Source& source, TexelFormat format, int weight_bits);

struct DenormalMeasurement {
    std::string refused{};
    bool is_float32_filtered = false;  // or else the next says nothing
    bool filter_flushes = false;       // halfway between two texels of 2^-130 and 2^-129: 0
    bool nearest_flushes = false;      // a texel read alone
    bool half_flushes = false;         // between two halfs below 2^-14
};
DenormalMeasurement measure_denormals(const Source& source, TexelFormat format);

struct CompareMeasurement {
    std::string refused{};
    StepTable ramp{};        // LessEqual with a reference between the two texels, 4096 steps between their centres
    bool is_strict = false;  // LessEqual is exact to the ulp around a texel of d32f
};
CompareMeasurement measure_compare(const Source& source);

/// Explicit level of detail between two levels.
struct MipMeasurement {
    StepTable ramp{};                 // LOD 0 to 1 in 4096 steps, levels 0 and 1
    int fine_distinct = 0;            // of 1024 positions 2^-24 apart from 0
    std::vector<float> switch_lod{};  // nearest mip filter: the least LOD of levels 1, 2, ...
    std::vector<int> at_half{};       // the level at LOD L + 1/2, L = 0, 1, ...
    bool clamps_after_bias = false;   // to [min LOD, max LOD]
};
MipMeasurement measure_mips(const Source& source, TexelFormat format);

/// The level of detail of gradients, from levels that hold their number.
struct GradientLod {
    std::array<float, 4> texels{};  // dudx, dvdx, dudy, dvdy in texels of level 0
    float lod = 0;
};
struct LodMeasurement {
    std::string refused{};
    std::vector<GradientLod> isotropic{};  // 2^(3 k / 200) texels, k = 0 to 200
    std::vector<GradientLod> oblique{};    // pairs off the axes
};
LodMeasurement measure_lod(const Source& source, TexelFormat format);

/// Where the probes of an anisotropic sample lie: jumps of the response to an edge.
struct ProbeLine {
    float ratio = 1;                 // of the two gradients
    int limit = 16;                  // the sampler's
    bool is_smooth = false;          // no separate probes
    std::vector<float> positions{};  // on the longer gradient, -1/2 to 1/2
    std::vector<float> weights{};
};
struct AnisoLod {
    std::array<float, 4> texels{};
    float bias = 0;
    float lod = 0;
};
struct AnisoMeasurement {
    std::string refused{};
    std::vector<ProbeLine> ratios{};   // 1 to 16, limit 16
    std::vector<ProbeLine> beyond{};   // ratio 32
    std::vector<ProbeLine> limits{};   // ratio 16, limits 2 to 16
    std::vector<AnisoLod> straight{};  // along the axes, ratios to 32
    std::vector<AnisoLod> oblique{};
    std::vector<AnisoLod> magnified{};  // a minor axis below one texel, with a bias
    /// Minor axis of 1/2 texel, ratio 8, nearest filters: distance of the response to that of n + 1 probes, by both placements.
    std::array<double, 16> magnified_interior{};
    std::array<double, 16> magnified_centred{};
};
AnisoMeasurement measure_anisotropy(const Source& source, TexelFormat format);

/// Everything above.
struct Measurements {
    std::string device{};
    std::optional<int> reported_subpixel_bits{};
    TexelFormat filtered = TexelFormat::R32f;  // the float format that the later measurements took
    std::vector<WeightMeasurement> weights{};  // r32f, rg16f, rgba8, rg16unorm
    GatherMeasurement gather{};
    std::vector<BoundaryMeasurement> boundaries{};  // the same formats but rg16f
    std::vector<DecodeMeasurement> decode{};
    FormMeasurement form{};
    DenormalMeasurement denormals{};
    CompareMeasurement compare{};
    MipMeasurement mips{};
    LodMeasurement lod{};
    AnisoMeasurement aniso{};
};
Measurements measure_all(const Source& source);

}  // namespace gnomon::agree
