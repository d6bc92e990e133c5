// A map of numbers that texture filters apply to: light pass, resolve, blur, mips. [Donnelly06] section 4, steps 1 to 3
#pragma once

#include "techniques/common/caster.h"
#include "techniques/common/gaussian.h"
#include "techniques/common/map_passes.h"

namespace gnomon::techniques {

/// How receivers read a map; part of their constants.
struct MapLookup {
    TextureId texture = TextureId::None;
    Sampler sampler{};
    int in_shader = 0;  // 1: bilinear, from four texels that the shader loads and weighs at its own precision

    static constexpr auto fields() {
        using M = MapLookup;
        return std::tuple{Field{"texture", &M::texture}, Field{"sampler", &M::sampler}, Field{"in_shader", &M::in_shader}};
    }

    /// `at` is a MapPosition or a GradientPosition (receiver.h).
    template <class F, class At>
    auto sample(const F& f, const At& at) const {
        if (in_shader == 0) return sample_at(f, texture, sampler, at, at.uv);
        return bilinear(f.size(texture), at.uv, [&](Int x, Int y) { return f.load(texture, x, y); });
    }
    /// The same of one slice of an array, which may differ from lane to lane; derivatives are of uv alone.
    template <class F, class At, class Real = typename F::Real>
    Vec4<Real> sample_slice(const F& f, const At& at, const Real& slice) const {
        if (in_shader == 0) return sample_at(f, texture, sampler, at, Vec3<Real>{at.uv.x, at.uv.y, slice});
        return bilinear_slice(f, at.uv, slice);
    }

private:
    template <class F, class Real = typename F::Real>
    Vec4<Real> bilinear_slice(const F& f, const Vec2<Real>& uv, const Real& slice) const {
        const glm::ivec2 size = f.size(texture);
        const Vec2<Real> texel{Real(1.0f / static_cast<float>(size.x)), Real(1.0f / static_cast<float>(size.y))};
        return bilinear(size, uv, [&](Int x, Int y) {  // the sampler is a nearest one, asked for the middle of a texel
            const Vec3<Real> at{(Real(x) + Real(0.5f)) * texel.x, (Real(y) + Real(0.5f)) * texel.y, slice};
            return f.sample_level(texture, sampler, at, Real(0.0f));
        });
    }

    /// As on hardware that does not filter 32-bit floats. [Donnelly06] section 4
    template <class Real, class Fetch>
    static Vec4<Real> bilinear(const glm::ivec2& size, const Vec2<Real>& uv, const Fetch& fetch) {
        const auto axis = [](const Real& coordinate, int texels) {
            const Real position = coordinate * Real(static_cast<float>(texels)) - Real(0.5f);
            const Real whole = floor(clamp(position, Real(-1.0f), Real(static_cast<float>(texels))));
            return std::pair{bounded_truncate_to_int(whole), position - whole};
        };
        const auto [x, u] = axis(uv.x, size.x);
        const auto [y, v] = axis(uv.y, size.y);
        const auto texel = [&](Int column, Int row) {
            return fetch(clamp(column, Int(0), Int(size.x - 1)), clamp(row, Int(0), Int(size.y - 1)));
        };
        const auto mix = [](const Vec4<Real>& a, const Vec4<Real>& b, const Real& t) {
            return Vec4<Real>{a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.z + (b.z - a.z) * t, a.w + (b.w - a.w) * t};
        };
        const Vec4<Real> upper = mix(texel(x, y), texel(x + Int(1), y), u);
        const Vec4<Real> lower = mix(texel(x, y + Int(1)), texel(x + Int(1), y + Int(1)), u);
        return mix(upper, lower, v);
    }
};

/// The parameters that every technique on a FilteredMap takes: depth, blur.
std::vector<Parameter> filtered_map_parameters();

/// What the light pass draws into a FilteredMap.
struct FilteredMapContent {
    const CasterPrograms& programs;
    std::span<const std::byte> constants;  // a DepthCaster
    bool euclidean = false;
    std::span<const glm::vec4> nothing;  // per slice: what stands where nothing is, as far as can be
};

/// One texture, of one slice per target of the light pass.
class FilteredMap {
public:
    /// `split`: how an RGBA texel holds two moments, if it does, which a blur has to know.
    FilteredMap(Device& device, const TechniqueSettings& settings, int slices = 1, const MomentSplit& split = {});

    /// Draws the scene into every slice, and resolves where there are several samples.
    void render(std::span<const SceneDraw> scene, const MapView& view, const FilteredMapContent& content,
                PassTimer& timer) const;
    /// Blurs and makes mips, as the settings ask. The kernel grows with the zoom of the view, so that shadows in every window
    /// are as soft. [PSVSM] steps 2d, 2e
    void filter(const MapView& view, PassTimer& timer) const;

    [[nodiscard]] TextureId id() const { return map_; }
    [[nodiscard]] MapLookup lookup() const;

private:
    /// Where the light pass draws: the map itself, or a band of it with several samples.
    struct LightTarget {
        TextureId color = TextureId::None;
        int first_row = 0;
    };
    void draw(std::span<const SceneDraw> scene, const MapView& view, const FilteredMapContent& content,
              const LightTarget& target) const;
    /// The mean of the samples of a band into the rows of the map that it stands for.
    void resolve(int first_row) const;

    Device& device_;
    TechniqueSettings settings_;
    int blur_;  // taps per axis where nothing is zoomed in on
    MomentSplit split_;
    int slices_;
    int band_rows_;  // what the textures of the light pass hold at a time: the whole map, unless its samples are too many
    TextureId map_ = TextureId::None;
    TextureId samples_ = TextureId::None;   // None: the map itself is rendered to
    TextureId resolved_ = TextureId::None;  // None: resolves go into the map itself
    TextureId depth_ = TextureId::None;
    TextureId scratch_ = TextureId::None;  // None: no blur
    FullScreen full_screen_;
};

/// The two casters of an encoding.
template <class Encoding>
CasterPrograms make_caster_programs(std::string_view plane, std::string_view distance) {
    return {make_program<CasterVertex, DepthCaster<Encoding>>(plane),
            make_program<DistanceCasterVertex, DepthCaster<Encoding>>(distance)};
}

/// What an encoding makes of the depth 1, target by target.
template <class Encoding>
auto encoding_of_nothing(const Encoding& encoding) {
    const auto colors = as_array(encoding.encode(Float(1.0f)));
    std::array<glm::vec4, std::tuple_size_v<decltype(colors)>> values;
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = {lane(colors[i].x, 0), lane(colors[i].y, 0), lane(colors[i].z, 0), lane(colors[i].w, 0)};
    return values;
}

/// A light pass that stores what an encoding makes of depth.
template <class Encoding>
struct EncodedLightPass {
    const CasterPrograms& programs;
    DepthScale scale;
    Encoding encoding;

    void render(const FilteredMap& map, std::span<const SceneDraw> scene, const MapView& view, PassTimer& timer) const {
        const DepthCaster<Encoding> caster{.scale = scale, .encoding = encoding};
        const auto nothing = encoding_of_nothing(encoding);
        map.render(
            scene, view,
            {.programs = programs, .constants = constants_of(caster), .euclidean = scale.euclidean != 0, .nothing = nothing},
            timer);
    }
};

/// How an encoding splits moments, if it does.
template <class Encoding>
MomentSplit split_of(const Encoding& encoding) {
    if constexpr (requires { encoding.split; }) {
        return encoding.split;
    } else {
        return {};
    }
}

/// The passes of one filtered map: an `Encoding` of depth in, a `Receiver` with members map (a MapLookup) and scale (a
/// DepthScale).
template <class Encoding, class Receiver>
class FilteredMapPasses final : public MapPasses<Receiver> {
public:
    static constexpr int kSlices = static_cast<int>(std::tuple_size_v<decltype(encoding_of_nothing(Encoding{}))>);

    FilteredMapPasses(Device& device, const TechniqueSettings& settings, const CasterPrograms& casters,
                      const Encoding& encoding, const Receiver& receiver)
        : map_(device, settings, kSlices, split_of(encoding)),
          metric_(settings.parameters.word<DepthMetric>("depth")),
          casters_(casters),
          encoding_(encoding),
          receiver_(receiver) {
        receiver_.map = map_.lookup();
    }

    void render(std::span<const SceneDraw> scene, const MapView& view, PassTimer& timer) override {
        receiver_.scale = make_depth_scale(metric_, view.light);
        EncodedLightPass<Encoding>{casters_, receiver_.scale, encoding_}.render(map_, scene, view, timer);
        map_.filter(view, timer);
    }
    [[nodiscard]] const Receiver& receiver() const override { return receiver_; }
    [[nodiscard]] std::vector<TextureId> maps() const override { return {map_.id()}; }

private:
    FilteredMap map_;
    DepthMetric metric_;
    const CasterPrograms& casters_;
    Encoding encoding_;
    Receiver receiver_;
};

/// The passes of a technique whose maps hold what an encoding makes of depth.
template <class Encoding, class Receiver>
std::unique_ptr<ShadowPasses> make_filtered_map_passes(Device& device, const TechniqueSettings& settings,
                                                       const CasterPrograms& casters, const ReceiverPrograms& programs,
                                                       const Encoding& encoding, const Receiver& receiver) {
    return make_shadow_passes<Receiver>(device, settings, programs, [&](const TechniqueSettings& of_map) {
        return std::make_unique<FilteredMapPasses<Encoding, Receiver>>(device, of_map, casters, encoding, receiver);
    });
}

}  // namespace gnomon::techniques
