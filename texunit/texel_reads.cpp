// The instructions that do not filter, and what filtering costs. D3D11.3 22.4.2 to 22.4.6
#include "texunit/instruction.h"

namespace gnomon {

namespace {

/// (left, lower), (right, lower), (right, upper), (left, upper). D3D11.3 22.4.2
constexpr std::array<std::size_t, 4> kGatherOrder{2, 3, 1, 0};

/// Level 0 of the view is there: the resource's lower limit may have clamped it off. D3D11.3 5.8.4, 5.8.6
bool has_finest_level(const TextureView& view) { return !view.empty() && view.min_lod() < 1.0f; }

/// Counts probes and texels of the lanes it is given.
struct CountingObserver {
    static constexpr bool kWatches = true;
    std::uint32_t active;
    SampleCost cost{};
    std::uint32_t level_lanes = 0;

    [[nodiscard]] std::uint64_t count(std::uint32_t lanes) const {
        return static_cast<std::uint64_t>(std::popcount(lanes & active));
    }
    template <class Real>
    void begin(const LevelOfDetail<Real>&, const LevelPair<Real>&) {}
    template <class Real>
    void begin_probe(const Vec2<Real>&, const Real&, Mask lanes) {
        probe_lanes = lanes.bits();
        cost.probes += count(probe_lanes);
    }
    template <class Real>
    void begin_level(Int, const Real&, Mask lanes) {
        level_lanes = lanes.bits() & probe_lanes;
    }
    template <class Real, class AnyTexels, class Result>
    void footprint(const Footprint<Real>& f, const AnyTexels&, const Result&) {
        cost.texels += count(level_lanes) * (f.linear ? 4 : 1);
    }
    template <class Real, class Texel>
    void ellipse_texel(Int, Mask, const Texel&, const Real&, Mask inside) {
        cost.texels += count(level_lanes & inside.bits());
    }
    template <class Result, class Real>
    void end_ellipse(const Result&, const Real&) {}
    template <class Result>
    void end_probe(const Result&) {}

    std::uint32_t probe_lanes = 0;
};

template <class Real>
struct NoTap {
    static constexpr bool kCompares = false;
    static constexpr bool kStandard = false;
    static constexpr bool kIsFinite = false;
    std::array<Real, 1> operator()(Int, Mask) const { return {Real(0.0f)}; }
};

/// Where a texel of one level of a layer is stored; lanes outside of the level are sent to its first.
struct TexelLanes {
    Int offset;
    Mask inside;
};
GNOMON_INLINE TexelLanes locate_texel(const Texture& texture, Int x, Int y, int level, int layer) {
    const Int width(texture.width(level));
    const Int height(texture.height(level));
    const Mask inside = (x >= Int(0)) & (x < width) & (y >= Int(0)) & (y < height);
    const LevelLanes place = locate_level(texture.table(), Int(level));
    const Int within = select(inside, y * place.pitch + x * Int(texture.info().bytes_per_texel), Int(0));
    return {place.offset + Int(layer * texture.layer_stride()) + within, inside};
}

}  // namespace

template <class Real>
SampleCost sample_cost(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec3<Real>& coordinate,
                       const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands, std::uint32_t active) {
    if (view.empty()) return {};
    // The filter itself, over texels that are not read.
    const FormatInfo& format = view.texture().info();
    const Sampler effective = effective_sampler(sampler, format, profile);
    const LayerPosition<Real> at = locate_layer(view.texture(), coordinate);
    const Lookup lookup{view, effective, profile, operands.offset, at.layer};
    const NoTap<Real> tap;
    CountingObserver observer{.active = active};
    const Blend blend;
    SampleCore<1, Real, Real, NoTap<Real>, CountingObserver> core(lookup, blend, tap, observer);
    (void)core.sample(at.uv, lod, operands.lod_bias);
    return observer.cost;
}

template <class Real>
Vec4<Real> gather(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec3<Real>& coordinate,
                  int component, const glm::ivec2& offset) {
    const FormatInfo& format = view.texture().info();
    const Real zero(0.0f);
    const Real missing(component == 3 ? 1.0f : 0.0f);  // D3D11.3 19.1.3.3
    if (component >= format.components) return {missing, missing, missing, missing};
    if (!has_finest_level(view)) return {zero, zero, zero, zero};
    const Instruction how = decide_instruction(format, sampler, profile, false, true);
    const LayerPosition<Real> at = locate_layer(view.texture(), coordinate);
    const Lookup lookup{view, sampler, profile, offset, at.layer, false, false, true};
    using Tap = AnyTap<4, Real, false>;
    const auto run = [&](const Tap& tap) {
        Unobserved nobody;
        const auto texels = SampleCore<4, Real, Real, Tap, Unobserved>(lookup, how.blend, tap, nobody).gather(at.uv);
        std::array<Real, 4> result;
        for (std::size_t i = 0; i < 4; ++i) {
            result[i] = texels[kGatherOrder[i]][static_cast<std::size_t>(component)];
            if (how.numbers.code_scale != 0.0f) result[i] = result[i] * Real(1.0f / how.numbers.largest);
        }
        return Vec4<Real>{result[0], result[1], result[2], result[3]};
    };
    return with_codec(format.format, [&]<class AnyCodec>(AnyCodec) {
        const NumberTap<AnyCodec, Real> concrete(lookup, how.numbers);
        return run(Tap(concrete));
    });
}

template <class Real>
Vec4<Real> gather_compare(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec3<Real>& coordinate,
                          const Real& reference, const glm::ivec2& offset) {
    const LayerPosition<Real> at = locate_layer(view.texture(), coordinate);
    const Lookup lookup{view, sampler, profile, offset, at.layer, false, false, true};
    if (!has_finest_level(view)) {
        const Real result = compare_out_of_bounds(lookup, reference);
        return {result, result, result, result};
    }
    using Tap = AnyTap<1, Real, true>;
    const auto run = [&](const Tap& tap) {
        Unobserved nobody;
        const auto texels = SampleCore<1, Real, Real, Tap, Unobserved>(lookup, Blend{}, tap, nobody).gather(at.uv);
        return Vec4<Real>{texels[kGatherOrder[0]][0], texels[kGatherOrder[1]][0], texels[kGatherOrder[2]][0],
                          texels[kGatherOrder[3]][0]};
    };
    return with_codec(view.texture().desc().format, [&]<class AnyCodec>(AnyCodec) {
        const CompareTap<AnyCodec, Real> concrete(lookup, reference);
        return run(Tap(concrete));
    });
}

template <class Real>
Vec4<Int> sample_codes(const TextureView& view, const Sampler& given, const Profile& profile, const Vec3<Real>& coordinate,
                       const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands) {
    if (view.empty()) return {Int(0), Int(0), Int(0), Int(view.texture().info().components == 4 ? 0 : 1)};
    Sampler sampler = given;
    sampler.min = sampler.mag = TexelFilter::Nearest;
    if (sampler.mip == MipFilter::Linear) sampler.mip = MipFilter::Nearest;
    const LayerPosition<Real> at = locate_layer(view.texture(), coordinate);
    const Lookup lookup{view, sampler, profile, operands.offset, at.layer};
    using Tap = AnyTap<4, Int, false>;
    const auto run = [&](const Tap& tap) {
        Unobserved nobody;
        const auto c = SampleCore<4, Int, Real, Tap, Unobserved>(lookup, Blend{}, tap, nobody)
                           .sample(at.uv, LevelOfDetail<Real>(lod.lod), operands.lod_bias);
        return Vec4<Int>{c[0], c[1], c[2], c[3]};
    };
    return with_codec(view.texture().desc().format, [&]<class AnyCodec>(AnyCodec) {
        const CodeTap<AnyCodec> concrete(lookup);
        return run(Tap(concrete));
    });
}

template <class Real>
Vec4<Real> load_texel(const Texture& texture, Int x, Int y, int level, int layer) {
    const TexelLanes at = locate_texel(texture, x, y, level, layer);
    return with_codec(texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        const Vec4<Real> color = expand(AnyCodec::template decode<Real>(AnyCodec::load(texture.data(), at.offset)));
        const Vec4<Real> nothing = out_of_bounds<Real>(texture.info());
        return Vec4<Real>{select(at.inside, color.x, nothing.x), select(at.inside, color.y, nothing.y),
                          select(at.inside, color.z, nothing.z), select(at.inside, color.w, nothing.w)};
    });
}

Vec4<Int> load_codes(const Texture& texture, Int x, Int y, int level, int layer) {
    const TexelLanes at = locate_texel(texture, x, y, level, layer);
    return with_codec(texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        const auto words = AnyCodec::load(texture.data(), at.offset);
        std::array<Int, 4> codes{Int(0), Int(0), Int(0), Int(1)};
        for (std::size_t c = 0; c < AnyCodec::kComponents; ++c) codes[c] = select(at.inside, AnyCodec::code(words, c), Int(0));
        return Vec4<Int>{codes[0], codes[1], codes[2], codes[3]};
    });
}

template <class Real>
Gradients<Real> cube_gradients(const Vec3<Real>& direction, const Vec3<Real>& dx, const Vec3<Real>& dy) {
    const CubeDirection<Real> on = face_of(direction);
    return {face_derivative(on, dx), face_derivative(on, dy)};
}

template SampleCost sample_cost(const TextureView&, const Sampler&, const Profile&, const Vec3<Float>&,
                                const LevelOfDetail<Float>&, const SampleOperands<Float>&, std::uint32_t);
template SampleCost sample_cost(const TextureView&, const Sampler&, const Profile&, const Vec3<Double>&,
                                const LevelOfDetail<Double>&, const SampleOperands<Double>&, std::uint32_t);
template Vec4<Float> gather(const TextureView&, const Sampler&, const Profile&, const Vec3<Float>&, int, const glm::ivec2&);
template Vec4<Double> gather(const TextureView&, const Sampler&, const Profile&, const Vec3<Double>&, int, const glm::ivec2&);
template Vec4<Float> gather_compare(const TextureView&, const Sampler&, const Profile&, const Vec3<Float>&, const Float&,
                                    const glm::ivec2&);
template Vec4<Double> gather_compare(const TextureView&, const Sampler&, const Profile&, const Vec3<Double>&, const Double&,
                                     const glm::ivec2&);
template Vec4<Int> sample_codes(const TextureView&, const Sampler&, const Profile&, const Vec3<Float>&,
                                const LevelOfDetail<Float>&, const SampleOperands<Float>&);
template Vec4<Int> sample_codes(const TextureView&, const Sampler&, const Profile&, const Vec3<Double>&,
                                const LevelOfDetail<Double>&, const SampleOperands<Double>&);
template Vec4<Float> load_texel(const Texture&, Int, Int, int, int);
template Vec4<Double> load_texel(const Texture&, Int, Int, int, int);
template Gradients<Float> cube_gradients(const Vec3<Float>&, const Vec3<Float>&, const Vec3<Float>&);
template Gradients<Double> cube_gradients(const Vec3<Double>&, const Vec3<Double>&, const Vec3<Double>&);

}  // namespace gnomon
