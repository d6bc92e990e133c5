#include "texunit/record.h"

#include "sim/denormals.h"
#include "texunit/instruction.h"

namespace gnomon {

namespace {

double number(Float value, int lane_of) { return widened(lane(value, lane_of)); }
double number(const Double& value, int lane_of) { return lane(value, lane_of); }

/// Copies what lane 0 goes through.
class Recorder {
public:
    static constexpr bool kWatches = true;

    Recorder(const Texture& texture, SampleRecord& record) : texture_(texture), record_(record) {}

    template <class Real>
    void begin(const LevelOfDetail<Real>& lod, const LevelPair<Real>& pair) {
        record_.lod = number(lod.lod, 0);
        record_.clamped_lod = number(pair.clamped, 0);
        record_.magnified = in_lane(pair.magnify);
        if (lod.anisotropic) record_.ratio = number(lod.ratio, 0);
    }
    template <class Real>
    void begin_probe(const Vec2<Real>& at, const Real& weight, Mask lanes) {
        in_probe_ = in_lane(lanes);
        if (!in_probe_) return;
        record_.probes.push_back({.u = number(at.x, 0), .v = number(at.y, 0), .weight = number(weight, 0), .levels = {}});
    }
    template <class Real>
    void begin_level(Int level, const Real& weight, Mask lanes) {
        in_level_ = in_probe_ && in_lane(lanes);
        if (!in_level_) return;
        record_.probes.back().levels.push_back({.level = lane(level, 0), .weight = number(weight, 0), .taps = {}});
    }
    template <class Real, std::size_t kCount, class Value>
    void footprint(const Footprint<Real>& f, const Texels<kCount, Value>& texels, const std::array<Value, kCount>& result) {
        if (!in_level_) return;
        LevelRecord& level = record_.probes.back().levels.back();
        const double u = f.linear ? number(f.fraction_u, 0) : 0.0;
        const double v = f.linear ? number(f.fraction_v, 0) : 0.0;
        for (std::size_t i = 0; i < (f.linear ? 4u : 1u); ++i) {
            TapRecord tap = locate(lane(f.offset[i], 0), level.level);
            tap.border = in_lane(f.outside[i]);
            tap.corner = f.has_corner && in_lane(f.corner[i]);
            tap.weight = ((i & 1) != 0 ? u : 1.0 - u) * ((i & 2) != 0 ? v : 1.0 - v);
            if (!tap.border && !tap.corner) tap.raw = codes(lane(f.offset[i], 0));
            for (std::size_t c = 0; c < kCount; ++c) tap.value[c] = number(texels[i][c], 0);
            level.taps.push_back(tap);
        }
        for (std::size_t c = 0; c < kCount; ++c) level.sum[c] = number(result[c], 0);
    }
    template <class Real, std::size_t kCount>
    void ellipse_texel(Int offset, Mask border, const std::array<Real, kCount>& texel, const Real& weight, Mask inside) {
        if (!in_level_ || !in_lane(inside)) return;
        LevelRecord& level = record_.probes.back().levels.back();
        TapRecord tap = locate(lane(offset, 0), level.level);
        tap.border = in_lane(border);
        tap.weight = number(weight, 0);
        if (!tap.border) tap.raw = codes(lane(offset, 0));
        for (std::size_t c = 0; c < kCount; ++c) tap.value[c] = number(texel[c], 0);
        level.taps.push_back(tap);
    }
    template <std::size_t kCount, class Value, class Real>
    void end_ellipse(const std::array<Value, kCount>& result, const Real& total) {
        if (!in_level_) return;
        LevelRecord& level = record_.probes.back().levels.back();
        if (level.taps.empty()) {  // nothing under the ellipse: the core takes another filter
            record_.probes.back().levels.pop_back();
            in_level_ = false;
            return;
        }
        for (TapRecord& tap : level.taps) tap.weight /= number(total, 0);
        for (std::size_t c = 0; c < kCount; ++c) level.sum[c] = number(result[c], 0);
    }
    template <std::size_t kCount, class Value>
    void end_probe(const std::array<Value, kCount>& result) {
        if (!in_probe_) return;
        for (std::size_t c = 0; c < kCount; ++c) record_.probes.back().sum[c] = number(result[c], 0);
    }

private:
    static bool in_lane(Mask mask) { return (mask.bits() & 1u) != 0; }

    /// The texel that a byte offset is, from the layout of the texture alone.
    [[nodiscard]] TapRecord locate(std::int32_t offset, int level) const {
        const LevelTable& table = texture_.table();
        const auto l = static_cast<std::size_t>(level);
        TapRecord tap{.level = level};
        tap.layer = offset / texture_.layer_stride();
        const std::int32_t within = offset % texture_.layer_stride() - table.offset[l];
        tap.y = within / table.pitch[l];
        tap.x = within % table.pitch[l] / texture_.info().bytes_per_texel;
        return tap;
    }
    [[nodiscard]] std::array<std::uint32_t, 4> codes(std::int32_t offset) const {
        return with_codec(texture_.desc().format, [&]<class AnyCodec>(AnyCodec) {
            const auto words = AnyCodec::load(texture_.data(), Int(offset));
            std::array<std::uint32_t, 4> result{};
            for (std::size_t c = 0; c < AnyCodec::kComponents; ++c)
                result[c] = static_cast<std::uint32_t>(lane(AnyCodec::code(words, c), 0));
            return result;
        });
    }

    const Texture& texture_;
    SampleRecord& record_;
    bool in_probe_ = false;
    bool in_level_ = false;
};

void check(const TextureView& view, const Sampler& sampler, const SampleRequest& request) {
    const TextureDesc& desc = view.texture().desc();
    for (const int offset : {request.offset.x, request.offset.y}) {
        if (offset < -8 || offset > 7) fail("sample: offset {}, expected -8 to 7", offset);
        if (offset != 0 && desc.kind == TextureKind::Cube) fail("sample: offset {} on a cube texture, expected none", offset);
    }
    if (!format_info(desc.format).is_integer()) return;
    const bool nearest = sampler.min == TexelFilter::Nearest && sampler.mag == TexelFilter::Nearest &&
                         sampler.mip != MipFilter::Linear && sampler.max_anisotropy <= 1;
    if (!nearest || sampler.reduction != Reduction::Average)
        fail("sample: format {} holds integers, which only nearest filters read", name_of(desc.format));
    if (request.reference) fail("sample: format {} holds integers, which are not compared", name_of(desc.format));
}

/// Up to kLanes requests of one shape; lanes beyond the last repeat it.
template <class Real>
struct RequestLanes {
    std::span<const SampleRequest> requests;

    template <class Get>
    [[nodiscard]] Real all(const Get& get) const {
        std::array<typename Real::Scalar, kLanes> values;
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<typename Real::Scalar>(get(requests[std::min(i, requests.size() - 1)]));
        return Real::load(values.data());
    }
    template <class Get>
    [[nodiscard]] Vec3<Real> vector(const Get& get) const {
        return {all([&](const SampleRequest& r) { return get(r)[0]; }), all([&](const SampleRequest& r) { return get(r)[1]; }),
                all([&](const SampleRequest& r) { return get(r)[2]; })};
    }
    [[nodiscard]] Vec3<Real> coordinate() const {
        return vector([](const SampleRequest& r) { return r.coordinate; });
    }
    [[nodiscard]] Real reference() const {
        return all([](const SampleRequest& r) { return *r.reference; });
    }
    [[nodiscard]] SampleOperands<Real> operands() const {
        return {.offset = requests.front().offset, .lod_bias = all([](const SampleRequest& r) { return r.lod_bias; })};
    }
    [[nodiscard]] LevelOfDetail<Real> lod(const TextureView& view, const Sampler& sampler, const Profile& profile) const {
        if (!requests.front().gradient) return LevelOfDetail<Real>(all([](const SampleRequest& r) { return r.lod; }));
        const Vec3<Real> dx = vector([](const SampleRequest& r) { return r.gradient->dx; });
        const Vec3<Real> dy = vector([](const SampleRequest& r) { return r.gradient->dy; });
        Gradients<Real> gradients{{dx.x, dx.y}, {dy.x, dy.y}};
        if (view.texture().desc().kind == TextureKind::Cube) gradients = cube_gradients(coordinate(), dx, dy);
        return level_of_detail(gradients, view, effective_sampler(sampler, view.texture().info(), profile), profile);
    }
};

bool same_shape(const SampleRequest& a, const SampleRequest& b) {
    return a.offset == b.offset && a.gradient.has_value() == b.gradient.has_value() &&
           a.reference.has_value() == b.reference.has_value();
}

template <class Real>
std::array<double, 4> colour(const Vec4<Real>& color, int i) {
    return {number(color.x, i), number(color.y, i), number(color.z, i), number(color.w, i)};
}
std::array<double, 4> unsigned_codes(const Vec4<Int>& codes, int i) {
    const auto wide = [&](Int code) { return static_cast<double>(static_cast<std::uint32_t>(lane(code, i))); };
    return {wide(codes.x), wide(codes.y), wide(codes.z), wide(codes.w)};
}

template <class Real>
void sample_wave(const TextureView& view, const Sampler& sampler, const Profile& profile,
                 std::span<const SampleRequest> requests, SampleResult* results) {
    const RequestLanes<Real> lanes{requests};
    const LevelOfDetail<Real> lod = lanes.lod(view, sampler, profile);
    const bool integer = view.texture().info().is_integer();
    Vec4<Real> color{};
    Vec4<Int> codes{};
    if (requests.front().reference) {
        const Real result =
            sample_compare(view, sampler, profile, lanes.coordinate(), lanes.reference(), lod, lanes.operands());
        color = {result, result, result, result};
    } else if (integer) {
        codes = sample_codes(view, sampler, profile, lanes.coordinate(), lod, lanes.operands());
    } else {
        color = sample(view, sampler, profile, lanes.coordinate(), lod, lanes.operands());
    }
    for (std::size_t i = 0; i < requests.size(); ++i) {
        const int l = static_cast<int>(i);
        results[i] = {.lod = number(lod.lod, l), .color = integer ? unsigned_codes(codes, l) : colour(color, l)};
    }
}

template <class Real>
SampleRecord record(const TextureView& view, const Sampler& sampler, const Profile& profile, const SampleRequest& request) {
    SampleRecord result;
    const RequestLanes<Real> lanes{std::span(&request, 1)};
    const LevelOfDetail<Real> lod = lanes.lod(view, sampler, profile);
    result.lod = number(lod.lod, 0);
    if (view.empty()) {
        SampleResult nothing;
        sample_wave<Real>(view, sampler, profile, lanes.requests, &nothing);
        result.result = nothing.color;
        return result;
    }
    Recorder recorder(view.texture(), result);
    if (request.reference) {
        const Real value =
            compare_observed(view, sampler, profile, lanes.coordinate(), lanes.reference(), lod, lanes.operands(), recorder);
        result.result.fill(number(value, 0));
    } else {
        const Instruction how = decide_instruction(view.texture().info(), sampler, profile, false, false);
        if (how.numbers.code_scale != 0.0f) result.scale = static_cast<double>(1.0f / how.numbers.largest);
        result.result =
            colour(sample_observed<4>(view, sampler, profile, lanes.coordinate(), lod, lanes.operands(), recorder), 0);
        if (view.texture().info().is_integer())
            result.result = unsigned_codes(sample_codes(view, sampler, profile, lanes.coordinate(), lod, lanes.operands()), 0);
    }
    return result;
}

}  // namespace

SampleRecord record_sample(const TextureView& view, const Sampler& sampler, const Profile& profile,
                           const SampleRequest& request) {
    check(view, sampler, request);
    const DenormalScope denormals(profile.flush_denormals);
    return profile.arithmetic == Arithmetic::Fp32 ? record<Float>(view, sampler, profile, request)
                                                  : record<Double>(view, sampler, profile, request);
}

std::vector<SampleResult> sample_all(const TextureView& view, const Sampler& sampler, const Profile& profile,
                                     std::span<const SampleRequest> requests) {
    for (const SampleRequest& request : requests) check(view, sampler, request);
    const DenormalScope denormals(profile.flush_denormals);
    std::vector<SampleResult> results(requests.size());
    for (std::size_t first = 0; first < requests.size();) {
        std::size_t count = 1;
        while (count < kLanes && first + count < requests.size() && same_shape(requests[first], requests[first + count]))
            ++count;
        const auto wave = requests.subspan(first, count);
        if (profile.arithmetic == Arithmetic::Fp32) {
            sample_wave<Float>(view, sampler, profile, wave, &results[first]);
        } else {
            sample_wave<Double>(view, sampler, profile, wave, &results[first]);
        }
        first += count;
    }
    return results;
}

}  // namespace gnomon
