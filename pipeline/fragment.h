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
};

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

/// Which texel `load` reads. Out of range reads as 0.
struct TexelPlace {
    int level = 0;
    int layer = 0;
    int sample = 0;
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
    /// Runs `body` for the lanes in `mask`, if there are any: what `if` is in a shading language. Lanes outside compute along,
    /// so the body keeps what it wants with select().
    template <class Body>
    void branch(Mask mask, const Body& body) const {
        const std::uint32_t outer = flow_.branch;
        flow_.branch &= mask.bits();
        if ((flow_.branch & flow_.covered) != 0) body();
        flow_.branch = outer;
    }

    /// Texture sampling with the level of detail of the quad's derivatives. D3D11.3 22.4.15
    Vec4<Real> sample(TextureId id, const Sampler& sampler, const Vec2<Real>& uv,
                      const SampleOperands<Real>& operands = {}) const {
        const Texture& texture = sampled(id);
        const LevelOfDetail<Real> lod = needs_lod(sampler) ? quad_lod(texture, sampler, uv) : LevelOfDetail<Real>(Real(0.0f));
        return count_and_sample(id, texture, sampler, uv, lod, operands);
    }
    /// With the shader's own derivatives. D3D11.3 22.4.17
    Vec4<Real> sample_gradient(TextureId id, const Sampler& sampler, const Vec2<Real>& uv, const Gradients<Real>& gradients,
                               const SampleOperands<Real>& operands = {}) const {
        const Texture& texture = sampled(id);
        return count_and_sample(id, texture, sampler, uv, level_of_detail(gradients, texture, sampler, profile()), operands);
    }
    /// With the shader's own level of detail. D3D11.3 22.4.18
    Vec4<Real> sample_level(TextureId id, const Sampler& sampler, const Vec2<Real>& uv, const Real& lod,
                            const SampleOperands<Real>& operands = {}) const {
        return count_and_sample(id, sampled(id), sampler, uv, LevelOfDetail<Real>(lod), operands);
    }
    /// Comparison at level 0. D3D11.3 22.4.20
    Real sample_compare(TextureId id, const Sampler& sampler, const Vec2<Real>& uv, const Real& reference) const {
        const Texture& texture = sampled(id);
        const LevelOfDetail<Real> top(Real(0.0f));
        count_sample(id, texture, sampler, uv, top, {});
        return gnomon::sample_compare(TextureView(texture), sampler, profile(), uv, reference, top);
    }
    /// Four texels of one component, unfiltered. D3D11.3 22.4.2
    Vec4<Real> gather(TextureId id, const Sampler& sampler, const Vec2<Real>& uv, int component = 0,
                      const glm::ivec2& offset = {0, 0}) const {
        const Texture& texture = sampled(id);
        count_texels(id, texture, 4);
        return gnomon::gather(TextureView(texture), sampler, profile(), Vec3<Real>{uv.x, uv.y, Real(0.0f)}, component, offset);
    }
    /// Four comparisons. D3D11.3 22.4.3
    Vec4<Real> gather_compare(TextureId id, const Sampler& sampler, const Vec2<Real>& uv, const Real& reference,
                              const glm::ivec2& offset = {0, 0}) const {
        const Texture& texture = sampled(id);
        count_texels(id, texture, 4);
        return gnomon::gather_compare(TextureView(texture), sampler, profile(), Vec3<Real>{uv.x, uv.y, Real(0.0f)}, reference,
                                      offset);
    }
    /// One texel or sample, unfiltered. D3D11.3 22.4.6 (ld), 22.4.7 (ld2dms)
    Vec4<Real> load(TextureId id, Int x, Int y, const TexelPlace& place = {}) const {
        const Texture& texture = this->texture(id);
        const TextureDesc& desc = texture.desc();
        const bool inside = place.level >= 0 && place.level < desc.levels && place.layer >= 0 && place.layer < desc.layers &&
                            place.sample >= 0 && place.sample < desc.samples;
        count_texels(id, texture, 1);
        if (inside) return load_texel<Real>(texture, x, y, place.level, place.layer * desc.samples + place.sample);
        return load_texel<Real>(texture, Int(-1), Int(-1), 0);
    }
    /// Width and height of level 0, texels.
    [[nodiscard]] glm::ivec2 size(TextureId id) const { return {texture(id).width(0), texture(id).height(0)}; }
    [[nodiscard]] int samples(TextureId id) const { return texture(id).desc().samples; }

    /// As the profile has them where the shader does not say which. D3D11.3 22.5.2 (coarse), 22.5.4 (fine)
    Real ddx(const Real& x) const { return profile().plain_derivative == PlainDerivative::Fine ? ddx_fine(x) : ddx_coarse(x); }
    Real ddy(const Real& x) const { return profile().plain_derivative == PlainDerivative::Fine ? ddy_fine(x) : ddy_coarse(x); }
    Real ddx_coarse(const Real& x) const { return note_derivative(), gnomon::ddx_coarse(x, profile().derivative_corner); }
    Real ddy_coarse(const Real& x) const { return note_derivative(), gnomon::ddy_coarse(x, profile().derivative_corner); }
    Real ddx_fine(const Real& x) const { return note_derivative(), gnomon::ddx_fine(x); }
    Real ddy_fine(const Real& x) const { return note_derivative(), gnomon::ddy_fine(x); }

    Real rcp(const Real& x) const { return gnomon::rcp(x); }
    Real rsqrt(const Real& x) const { return gnomon::rsqrt(x); }
    Real exp2(const Real& x) const { return gnomon::exp2(x); }
    Real log2(const Real& x) const { return gnomon::log2(x); }

private:
    [[nodiscard]] const Profile& profile() const { return *environment_.profile; }
    [[nodiscard]] const Texture& texture(TextureId id) const {
        return *environment_.textures[static_cast<std::size_t>(id) - 1];
    }
    [[nodiscard]] const Texture& sampled(TextureId id) const {
        const Texture& texture = this->texture(id);
        if (texture.desc().samples != 1)
            fail("texture {}: it has {} samples per texel and can only be loaded from, not sampled",
                 static_cast<std::size_t>(id), texture.desc().samples);
        return texture;
    }

    static bool needs_lod(const Sampler& sampler) {
        return sampler.mip != MipFilter::Base || sampler.min != sampler.mag || sampler.max_anisotropy > 1;
    }

    LevelOfDetail<Real> quad_lod(const Texture& texture, const Sampler& sampler, const Vec2<Real>& uv) const {
        note_derivative();
        return level_of_detail(quad_gradients(uv, profile()), TextureView(texture), sampler, profile());
    }

    Vec4<Real> count_and_sample(TextureId id, const Texture& texture, const Sampler& sampler, const Vec2<Real>& uv,
                                const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands) const {
        count_sample(id, texture, sampler, uv, lod, operands);
        return gnomon::sample(TextureView(texture), sampler, profile(), uv, lod, operands);
    }

    void count_sample(TextureId id, const Texture& texture, const Sampler& sampler, const Vec2<Real>& uv,
                      const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands) const {
        if (tally_ == nullptr) return;
        const SampleCost cost = sample_cost(TextureView(texture), sampler, profile(), Vec3<Real>{uv.x, uv.y, Real(0.0f)}, lod,
                                            operands, flow_.active());
        tally_->counters.texture_instructions += static_cast<std::uint64_t>(std::popcount(flow_.active()));
        tally_->counters.texture_probes += cost.probes;
        tally_->counters.texels_fetched += cost.texels;
        tally_->read(id, cost.texels * texel_bytes(texture.info()));
    }
    void count_texels(TextureId id, const Texture& texture, std::uint64_t per_lane) const {
        if (tally_ == nullptr) return;
        const auto lanes = static_cast<std::uint64_t>(std::popcount(flow_.active()));
        tally_->counters.texture_instructions += lanes;
        tally_->counters.texels_fetched += per_lane * lanes;
        tally_->read(id, per_lane * lanes * texel_bytes(texture.info()));
    }
    void note_derivative() const {
        if (tally_ == nullptr && !environment_.reports_derivatives) return;
        const DerivativeCauses causes = flow_.causes();
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
