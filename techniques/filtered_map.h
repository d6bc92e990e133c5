// A map of numbers that texture filters apply to: light pass, resolve, blur, mips. [Donnelly06] section 4, steps 1 to 3
#pragma once

#include "techniques/caster.h"
#include "techniques/gaussian.h"
#include "techniques/technique.h"

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

    /// Implicit derivatives come from the quad.
    template <class F, class Real = typename F::Real>
    Vec4<Real> sample(const F& f, const Vec2<Real>& uv) const {
        if (in_shader == 0) return f.sample(texture, sampler, uv);
        return bilinear(f, uv, [&](Int x, Int y) { return f.load(texture, x, y); });
    }

    /// The same in a slice for each lane, to nearest even and clamped.
    template <class F, class Real>
    Vec4<Real> sample_slice(const F& f, const Vec2<Real>& uv, const Real& slice) const {
        if (in_shader == 0) return f.sample(texture, sampler, Vec3<Real>{uv.x, uv.y, slice});
        // A load takes one slice for all lanes. The sampler is a nearest one here, and the nearest at a texel's centre is it.
        const glm::ivec2 size = f.size(texture);
        const auto centre = [](Int texel, int texels) { return (Real(texel) + Real(0.5f)) / Real(static_cast<float>(texels)); };
        return bilinear(f, uv, [&](Int x, Int y) {
            return f.sample(texture, sampler, Vec3<Real>{centre(x, size.x), centre(y, size.y), slice});
        });
    }

private:
    /// As on hardware that does not filter 32-bit floats; `fetch(x, y)` is a texel inside the texture. [Donnelly06] section 4,
    /// [Lauritzen08] 3.1
    template <class F, class Fetch, class Real = typename F::Real>
    Vec4<Real> bilinear(const F& f, const Vec2<Real>& uv, const Fetch& fetch) const {
        const glm::ivec2 size = f.size(texture);
        const auto axis = [](const Real& coordinate, int texels) {
            const Real position = coordinate * Real(static_cast<float>(texels)) - Real(0.5f);
            const Real whole = floor(clamp(position, Real(-1.0f), Real(static_cast<float>(texels))));
            return std::pair{bounded_truncate_to_int(whole), position - whole};
        };
        const auto [x, u] = axis(uv.x, size.x);
        const auto [y, v] = axis(uv.y, size.y);
        const auto texel = [&, left = x, top = y](Int right, Int down) {
            return fetch(clamp(left + right, Int(0), Int(size.x - 1)), clamp(top + down, Int(0), Int(size.y - 1)));
        };
        const auto mix = [](const Vec4<Real>& a, const Vec4<Real>& b, const Real& t) {
            return Vec4<Real>{a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.z + (b.z - a.z) * t, a.w + (b.w - a.w) * t};
        };
        return mix(mix(texel(Int(0), Int(0)), texel(Int(1), Int(0)), u), mix(texel(Int(0), Int(1)), texel(Int(1), Int(1)), u),
                   v);
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
    FilteredMap(Device& device, const TechniqueSettings& settings, int slices = 1);

    /// Draws the scene into every slice, and resolves where there are several samples.
    void render(std::span<const SceneDraw> scene, const scenes::View& light, const FilteredMapContent& content,
                PassTimer& timer) const;
    /// Blurs and makes mips, as the settings ask.
    void filter(PassTimer& timer) const;

    [[nodiscard]] TextureId id() const { return map_; }
    [[nodiscard]] MapLookup lookup() const;

private:
    Device& device_;
    TechniqueSettings settings_;
    GaussianKernel kernel_;
    int slices_;
    TextureId map_ = TextureId::None;
    TextureId samples_ = TextureId::None;  // None: the map itself is rendered to
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

/// The passes of a technique with one filtered map: an `Encoding` of depth in, a `Receiver` with members lighting, map (a
/// MapLookup) and scale (a DepthScale).
template <class Encoding, class Receiver>
class FilteredMapPasses final : public ShadowPasses {
public:
    static constexpr int kSlices = static_cast<int>(std::tuple_size_v<decltype(encoding_of_nothing(Encoding{}))>);

    FilteredMapPasses(Device& device, const TechniqueSettings& settings, const CasterPrograms& casters, const Program& program,
                      const Encoding& encoding, const Receiver& receiver)
        : map_(device, settings, kSlices),
          metric_(settings.parameters.word<DepthMetric>("depth")),
          casters_(casters),
          program_(program),
          encoding_(encoding),
          receiver_(receiver) {
        receiver_.map = map_.lookup();
    }

    void render_map(std::span<const SceneDraw> scene, const scenes::View& light, PassTimer& timer) override {
        receiver_.scale = make_depth_scale(metric_, light);
        const DepthCaster<Encoding> caster{.scale = receiver_.scale, .encoding = encoding_};
        const auto nothing = encoding_of_nothing(encoding_);
        map_.render(scene, light,
                    {.programs = casters_,
                     .constants = constants_of(caster),
                     .euclidean = caster.scale.euclidean != 0,
                     .nothing = nothing},
                    timer);
        map_.filter(timer);
    }
    [[nodiscard]] const Program& receiver_program() const override { return program_; }
    std::span<const std::byte> receiver_constants(const Lighting& lighting) override {
        receiver_.lighting = lighting;
        return constants_of(receiver_);
    }
    [[nodiscard]] std::vector<TextureId> maps() const override { return {map_.id()}; }

private:
    FilteredMap map_;
    DepthMetric metric_;
    const CasterPrograms& casters_;
    const Program& program_;
    Encoding encoding_;
    Receiver receiver_;
};

}  // namespace gnomon::techniques
