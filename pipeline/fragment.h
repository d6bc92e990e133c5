// What a pixel functor sees: interpolated inputs, derivatives, textures, and the profile's arithmetic.
#pragma once

#include "pipeline/command.h"
#include "pipeline/derivatives.h"
#include "pipeline/traffic.h"
#include "pipeline/wave.h"
#include "sim/error.h"
#include "sim/math.h"
#include "sim/profile.h"
#include "sim/quad.h"
#include "sim/vec.h"
#include "texunit/aniso.h"
#include "texunit/sample.h"

#include <climits>
#include <concepts>
#include <memory>
#include <span>

namespace gnomon {

/// Textures by id, as the device holds them.
using TextureTable = std::span<const std::unique_ptr<Texture>>;

/// What every run of a functor in a draw shares.
struct PixelEnvironment {
    TextureTable textures;
    const Profile* profile = nullptr;
    bool reports_derivatives = false;
    const Draw* draw = nullptr;  // whose it is: for messages
};

/// What only the functor's call shows to be impossible; device.h lists it. Out of line, for it does not happen. validate.cpp
[[noreturn]] void refuse_missing(const PixelEnvironment& environment, TextureId id);
[[noreturn]] void refuse_cube(const PixelEnvironment& environment, TextureId id);
[[noreturn]] void refuse_filter(const PixelEnvironment& environment, TextureId id);
[[noreturn]] void refuse_comparison(const PixelEnvironment& environment, TextureId id);
[[noreturn]] void refuse_codes(const PixelEnvironment& environment, TextureId id);
[[noreturn]] void refuse_offset(const PixelEnvironment& environment, TextureId id, const glm::ivec2& offset);
[[noreturn]] void refuse_component(const PixelEnvironment& environment, TextureId id, int component);

/// The system values of one run. D3D11.3 chapter 23
struct PixelSystemValues {
    std::uint32_t primitive_id = 0;
    std::uint32_t layer = 0;
    std::uint32_t viewport = 0;
    bool front = true;
    int sample = -1;  // the sample it runs for; -1: for the whole pixel
    int samples = 1;  // of the targets
    std::uint32_t sample_mask = 0xffffffffu;
};

/// Which texel `load` and `load_codes` read. Out of range reads as 0.
struct TexelPlace {
    int level = 0;
    int layer = 0;
};

/// What FragmentContext::lod says.
template <class Real>
struct SampledLevel {
    Real clamped;
    Real unclamped;
    Int probes;  // 1 where the sample is not anisotropic
};

/// `kDiscards`: the functor says that it does.
template <class RealType, class VaryingsType, bool kDiscards>
class FragmentContext {
public:
    using Real = RealType;

    FragmentContext(const VaryingsType& inputs, const Vec4<Real>& fragment_position, const PixelSystemValues& system,
                    const Wave& wave, const PixelEnvironment& environment, LaneFlow& flow, DerivativeCauses& causes,
                    Tally* tally)
        : in(inputs),
          position(fragment_position),
          system_(system),
          wave_(wave),
          environment_(environment),
          flow_(flow),
          causes_(causes),
          tally_(tally) {}

    const VaryingsType& in;
    const Vec4<Real>& position;  // pixel centre (the sample's position where the functor runs per sample), depth, w

    [[nodiscard]] bool front_facing() const { return system_.front; }
    [[nodiscard]] std::uint32_t primitive_id() const { return system_.primitive_id; }
    [[nodiscard]] std::uint32_t layer() const { return system_.layer; }
    [[nodiscard]] std::uint32_t viewport() const { return system_.viewport; }
    /// 0 where the functor runs for the whole pixel.
    [[nodiscard]] int sample_index() const { return system_.sample < 0 ? 0 : system_.sample; }
    /// Bit s: sample s of the pixel is covered and in the sample mask; 0 in helper pixels. D3D11.3 16.3.2
    [[nodiscard]] Int coverage() const {
        if (system_.samples == 1) return select(Mask::from_bits(wave_.covered), Int(1), Int(0));
        Int bits(0);
        for (int s = 0; s < system_.samples; ++s)
            if ((system_.sample_mask >> s & 1u) != 0)
                bits = bits | select(Mask::from_bits(wave_.samples.covered[static_cast<std::size_t>(s)]), Int(1 << s), Int(0));
        return bits;
    }

    /// The lanes in `mask` write nothing; they go on as helpers. The functor says `static constexpr bool discards = true`.
    /// D3D11.3 22.5.1
    void discard(Mask mask) const {
        static_assert(kDiscards, "a pixel functor that discards says 'static constexpr bool discards = true'");
        flow_.killed |= mask.bits() & flow_.branch;
    }
    /// Runs `body` for the lanes in `mask`, helpers too, if there are any: what `if` is in a shading language. Lanes outside
    /// compute along, so the body keeps what it wants with select().
    template <class Body>
    void branch(Mask mask, const Body& body) const {
        const std::uint32_t outer = flow_.branch;
        flow_.branch &= mask.bits();
        if (flow_.branch != 0) body();
        flow_.branch = outer;
    }

    /// Texture sampling with the level of detail of the quad's derivatives. Of an array, slice 0. D3D11.3 22.4.15
    Vec4<Real> sample(const TextureLevels& id, const Sampler& sampler, const Vec2<Real>& uv,
                      const SampleOperands<Real>& operands = {}) const {
        return sample(id, sampler, first_slice(uv), operands);
    }
    /// At (u, v, slice) of an array, a slice for each lane, to nearest even and clamped; the derivatives are those of u and v.
    /// Coordinates are Vec3<Real>; as templates these overloads leave `{u, v}` to the others.
    template <std::same_as<Vec3<Real>> Coordinate = Vec3<Real>>
    Vec4<Real> sample(const TextureLevels& id, const Sampler& sampler, const Coordinate& coordinate,
                      const SampleOperands<Real>& operands = {}) const {
        const TextureView view = filtered(id, sampler, operands.offset);
        return count_and_sample(id, view, sampler, coordinate, quad_lod(view, sampler, coordinate), operands);
    }
    /// With the shader's own derivatives. D3D11.3 22.4.17
    Vec4<Real> sample_gradient(const TextureLevels& id, const Sampler& sampler, const Vec2<Real>& uv,
                               const Gradients<Real>& gradients, const SampleOperands<Real>& operands = {}) const {
        return sample_gradient(id, sampler, first_slice(uv), gradients, operands);
    }
    template <std::same_as<Vec3<Real>> Coordinate = Vec3<Real>>
    Vec4<Real> sample_gradient(const TextureLevels& id, const Sampler& sampler, const Coordinate& coordinate,
                               const Gradients<Real>& gradients, const SampleOperands<Real>& operands = {}) const {
        const TextureView view = filtered(id, sampler, operands.offset);
        return count_and_sample(id, view, sampler, coordinate, level_of_detail(gradients, view, sampler, profile()), operands);
    }
    /// With the shader's own level of detail. D3D11.3 22.4.18
    Vec4<Real> sample_level(const TextureLevels& id, const Sampler& sampler, const Vec2<Real>& uv, const Real& lod,
                            const SampleOperands<Real>& operands = {}) const {
        return sample_level(id, sampler, first_slice(uv), lod, operands);
    }
    template <std::same_as<Vec3<Real>> Coordinate = Vec3<Real>>
    Vec4<Real> sample_level(const TextureLevels& id, const Sampler& sampler, const Coordinate& coordinate, const Real& lod,
                            const SampleOperands<Real>& operands = {}) const {
        const TextureView view = filtered(id, sampler, operands.offset);
        return count_and_sample(id, view, sampler, coordinate, LevelOfDetail<Real>(lod), operands);
    }
    /// Comparison at level 0. D3D11.3 22.4.20
    Real sample_compare(const TextureLevels& id, const Sampler& sampler, const Vec2<Real>& uv, const Real& reference) const {
        const TextureView view = compared(id, sampler);
        return count_and_compare(id, view, sampler, uv, reference, LevelOfDetail<Real>(Real(0.0f)));
    }
    /// Comparison with the level of detail and the anisotropy of the quad's derivatives. D3D11.3 22.4.19
    Real sample_compare_quad(const TextureLevels& id, const Sampler& sampler, const Vec2<Real>& uv,
                             const Real& reference) const {
        const TextureView view = compared(id, sampler);
        return count_and_compare(id, view, sampler, uv, reference, quad_lod(view, sampler, first_slice(uv)));
    }
    /// ... of the shader's own derivatives. HLSL shader model 6.7, SampleCmpGrad
    Real sample_compare_gradient(const TextureLevels& id, const Sampler& sampler, const Vec2<Real>& uv, const Real& reference,
                                 const Gradients<Real>& gradients) const {
        const TextureView view = compared(id, sampler);
        return count_and_compare(id, view, sampler, uv, reference, level_of_detail(gradients, view, sampler, profile()));
    }
    /// The levels that `sample` would read at these coordinates (`clamped`), and the level of detail before bias and clamp.
    /// D3D11.3 22.5.6 (lod)
    SampledLevel<Real> lod(const TextureLevels& id, const Sampler& sampler, const Vec2<Real>& uv) const {
        note_derivative([&](std::uint32_t bits) { return quad_gradients_readers(bits, profile()); });
        return lod(id, sampler, quad_gradients(uv, profile()));
    }
    /// ... that `sample_gradient` would read.
    SampledLevel<Real> lod(const TextureLevels& id, const Sampler& sampler, const Gradients<Real>& gradients) const {
        const TextureView view = sampled(id, {0, 0});
        const LevelOfDetail<Real> level = level_of_detail(gradients, view, sampler, profile());
        const LevelPair<Real> pair = select_levels(level.lod, Real(0.0f), sampler, view, profile());
        const Real available = clamp(pair.clamped, Real(0.0f), Real(static_cast<float>(view.levels() - 1)));
        return {available, level.lod, level.anisotropic ? level.probes : Int(1)};
    }
    /// Four texels of one component (0 to 3), unfiltered. D3D11.3 22.4.2
    Vec4<Real> gather(const TextureLevels& id, const Sampler& sampler, const Vec2<Real>& uv, int component = 0,
                      const glm::ivec2& offset = {0, 0}) const {
        const TextureView view = sampled(id, offset);
        if (component < 0 || component > 3) [[unlikely]]
            refuse_component(environment_, id.texture, component);
        count_texels(id.texture, view.texture(), 4);
        return gnomon::gather(view, sampler, profile(), first_slice(uv), component, offset);
    }
    /// Four comparisons. D3D11.3 22.4.3
    Vec4<Real> gather_compare(const TextureLevels& id, const Sampler& sampler, const Vec2<Real>& uv, const Real& reference,
                              const glm::ivec2& offset = {0, 0}) const {
        const TextureView view = sampled(id, offset);
        if (view.texture().info().is_integer()) [[unlikely]]
            refuse_comparison(environment_, id.texture);
        count_texels(id.texture, view.texture(), 4);
        return gnomon::gather_compare(view, sampler, profile(), first_slice(uv), reference, offset);
    }
    /// One texel, unfiltered. D3D11.3 22.4.6 (ld)
    Vec4<Real> load(const TextureLevels& id, Int x, Int y, const TexelPlace& place = {}) const {
        return load_plane(id.texture, x, y, stored_place(id, place), 0);
    }
    /// Its codes to the bit, of a format of unsigned integers; out of range 0. D3D11.3 22.4.6 (ld)
    Vec4<Int> load_codes(const TextureLevels& id, Int x, Int y, const TexelPlace& place = {}) const {
        const Texture& texture = this->texture(id.texture);
        if (!texture.info().is_integer()) [[unlikely]]
            refuse_codes(environment_, id.texture);
        const TexelPlace at = stored_place(id, place);
        count_texels(id.texture, texture, 1);
        if (has_plane(texture.desc(), at, 0))
            return gnomon::load_codes(texture, x, y, at.level, at.layer * texture.desc().samples);
        return gnomon::load_codes(texture, Int(-1), Int(-1), 0);
    }
    /// One sample of a texel, unfiltered; out of range reads as 0. D3D11.3 22.4.7 (ld2dms)
    Vec4<Real> load(const MultisampledTexture& id, Int x, Int y, int sample, int layer = 0) const {
        return load_plane(id.texture, x, y, {0, layer}, sample);
    }
    /// Width and height of the finest level, texels.
    [[nodiscard]] glm::ivec2 size(const TextureLevels& id) const {
        const TextureView view = this->view(id);
        return {view.width(), view.height()};
    }
    [[nodiscard]] glm::ivec2 size(const MultisampledTexture& id) const {
        return {texture(id.texture).width(0), texture(id.texture).height(0)};
    }
    [[nodiscard]] int samples(const MultisampledTexture& id) const { return texture(id.texture).desc().samples; }

    /// As the profile has them where the shader does not say which. D3D11.3 22.5.2 (coarse), 22.5.4 (fine)
    Real ddx(const Real& x) const { return profile().plain_derivative == PlainDerivative::Fine ? ddx_fine(x) : ddx_coarse(x); }
    Real ddy(const Real& x) const { return profile().plain_derivative == PlainDerivative::Fine ? ddy_fine(x) : ddy_coarse(x); }
    Real ddx_coarse(const Real& x) const {
        note_derivative([&](std::uint32_t bits) { return ddx_coarse_readers(bits, profile().derivative_corner); });
        return gnomon::ddx_coarse(x, profile().derivative_corner);
    }
    Real ddy_coarse(const Real& x) const {
        note_derivative([&](std::uint32_t bits) { return ddy_coarse_readers(bits, profile().derivative_corner); });
        return gnomon::ddy_coarse(x, profile().derivative_corner);
    }
    Real ddx_fine(const Real& x) const { return note_derivative(ddx_fine_readers), gnomon::ddx_fine(x); }
    Real ddy_fine(const Real& x) const { return note_derivative(ddy_fine_readers), gnomon::ddy_fine(x); }

    /// Another lane of the quad: 0 top-left, 1 top-right, 2 bottom-left, 3 bottom-right; helpers have values too. HLSL shader
    /// model 6.0, QuadReadLaneAt
    template <int kLane>
    Real quad_read(const Real& x) const {
        return quad_broadcast<kLane>(x);
    }
    /// All four lanes of a quad where any of them is in the mask. HLSL shader model 6.7, QuadAny
    Mask quad_any(Mask mask) const { return Mask::from_bits(gnomon::quad_any(mask.bits())); }

    Real rcp(const Real& x) const { return gnomon::rcp(x); }
    Real rsqrt(const Real& x) const { return gnomon::rsqrt(x); }
    Real exp2(const Real& x) const { return gnomon::exp2(x); }
    Real log2(const Real& x) const { return gnomon::log2(x); }
    SinCosLanes<Real> sin_cos(const Real& x) const { return gnomon::sin_cos(x); }

private:
    [[nodiscard]] const Profile& profile() const { return *environment_.profile; }
    [[nodiscard]] const Texture& texture(TextureId id) const {
        const std::size_t index = static_cast<std::size_t>(id) - 1;
        if (index >= environment_.textures.size()) [[unlikely]]
            refuse_missing(environment_, id);
        return *environment_.textures[index];
    }
    [[nodiscard]] TextureView view(const TextureLevels& id) const {
        const Texture& texture = this->texture(id.texture);
        const int levels = id.levels == 0 ? texture.desc().levels - id.first_level : id.levels;
        return TextureView(texture, id.first_level, levels);
    }
    /// For an instruction at 2D coordinates.
    [[nodiscard]] TextureView sampled(const TextureLevels& id, const glm::ivec2& offset) const {
        const TextureView view = this->view(id);
        if (view.texture().desc().kind == TextureKind::Cube) [[unlikely]]
            refuse_cube(environment_, id.texture);
        const auto in_range = [](int texels) { return texels >= -8 && texels <= 7; };  // D3D11.3 22.4.2, 22.4.15
        if (!in_range(offset.x) || !in_range(offset.y)) [[unlikely]]
            refuse_offset(environment_, id.texture, offset);
        return view;
    }
    [[nodiscard]] TextureView filtered(const TextureLevels& id, const Sampler& sampler, const glm::ivec2& offset) const {
        const TextureView view = sampled(id, offset);
        if (!filters_format(view.texture().info(), profile()) && sampler.filters()) [[unlikely]]
            refuse_filter(environment_, id.texture);
        return view;
    }
    [[nodiscard]] TextureView compared(const TextureLevels& id, const Sampler& sampler) const {
        const TextureView view = filtered(id, sampler, {0, 0});
        if (view.texture().info().is_integer()) [[unlikely]]
            refuse_comparison(environment_, id.texture);
        return view;
    }
    static Vec3<Real> first_slice(const Vec2<Real>& uv) { return {uv.x, uv.y, Real(0.0f)}; }

    /// A place among all levels of the texture; -1 for levels that the constant leaves out.
    static TexelPlace stored_place(const TextureLevels& id, const TexelPlace& place) {
        const int levels = id.levels == 0 ? INT_MAX - id.first_level : id.levels;
        const bool inside = place.level >= 0 && place.level < levels;
        return {inside ? id.first_level + place.level : -1, place.layer};
    }
    static bool has_plane(const TextureDesc& desc, const TexelPlace& place, int sample) {
        return place.level >= 0 && place.level < desc.levels && place.layer >= 0 && place.layer < desc.layers && sample >= 0 &&
               sample < desc.samples;
    }
    Vec4<Real> load_plane(TextureId id, Int x, Int y, const TexelPlace& place, int sample) const {
        const Texture& texture = this->texture(id);
        const TextureDesc& desc = texture.desc();
        count_texels(id, texture, 1);
        if (has_plane(desc, place, sample))
            return load_texel<Real>(texture, x, y, place.level, place.layer * desc.samples + sample);
        return load_texel<Real>(texture, Int(-1), Int(-1), 0);
    }

    static bool needs_lod(const Sampler& sampler) {
        return sampler.mip != MipFilter::Base || sampler.min != sampler.mag || sampler.max_anisotropy > 1;
    }

    /// Of the quad's derivatives, which are not taken where the sampler has no use for them.
    LevelOfDetail<Real> quad_lod(const TextureView& view, const Sampler& sampler, const Vec3<Real>& coordinate) const {
        if (!needs_lod(sampler)) return LevelOfDetail<Real>(Real(0.0f));
        note_derivative([&](std::uint32_t bits) { return quad_gradients_readers(bits, profile()); });
        const Vec2<Real> uv{coordinate.x, coordinate.y};
        return level_of_detail(quad_gradients(uv, profile()), view, sampler, profile());
    }

    Vec4<Real> count_and_sample(const TextureLevels& id, const TextureView& view, const Sampler& sampler,
                                const Vec3<Real>& coordinate, const LevelOfDetail<Real>& lod,
                                const SampleOperands<Real>& operands) const {
        count_sample(id, view, sampler, coordinate, lod, operands);
        return gnomon::sample(view, sampler, profile(), coordinate, lod, operands);
    }
    Real count_and_compare(const TextureLevels& id, const TextureView& view, const Sampler& sampler, const Vec2<Real>& uv,
                           const Real& reference, const LevelOfDetail<Real>& lod) const {
        count_sample(id, view, sampler, first_slice(uv), lod, {});
        return gnomon::sample_compare(view, sampler, profile(), uv, reference, lod);
    }

    void count_sample(const TextureLevels& id, const TextureView& view, const Sampler& sampler, const Vec3<Real>& coordinate,
                      const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands) const {
        if (tally_ == nullptr) return;
        const SampleCost cost = sample_cost(view, sampler, profile(), coordinate, lod, operands, flow_.active());
        tally_->counters.texture_instructions += static_cast<std::uint64_t>(std::popcount(flow_.active()));
        tally_->counters.texture_probes += cost.probes;
        tally_->counters.texels_fetched += cost.texels;
        tally_->read(id.texture, cost.texels * texel_bytes(view.texture().info()));
    }
    void count_texels(TextureId id, const Texture& texture, std::uint64_t per_lane) const {
        if (tally_ == nullptr) return;
        const auto lanes = static_cast<std::uint64_t>(std::popcount(flow_.active()));
        tally_->counters.texture_instructions += lanes;
        tally_->counters.texels_fetched += per_lane * lanes;
        tally_->read(id, per_lane * lanes * texel_bytes(texture.info()));
    }
    template <class Readers>
    void note_derivative(const Readers& readers) const {
        if (tally_ == nullptr && !environment_.reports_derivatives) return;
        const DerivativeCauses causes = flow_.causes(readers);
        causes_ |= causes;
        if (tally_ != nullptr) count_derivative(tally_->counters, flow_, causes);
    }

    const PixelSystemValues& system_;
    const Wave& wave_;
    const PixelEnvironment& environment_;
    LaneFlow& flow_;
    DerivativeCauses& causes_;
    Tally* tally_;
};

}  // namespace gnomon
