// What a pixel functor sees: interpolated inputs, derivatives, textures, and the profile's arithmetic.
#pragma once

#include "pipeline/wave.h"
#include "sim/counters.h"
#include "sim/math.h"
#include "sim/profile.h"
#include "sim/quad.h"
#include "sim/vec.h"
#include "texunit/aniso.h"
#include "texunit/sample.h"

#include "pipeline/command.h"

#include <memory>
#include <span>

namespace gnomon {

/// Textures by id, as the device holds them.
using TextureTable = std::span<const std::unique_ptr<Texture>>;

template <class RealType, class VaryingsType>
class FragmentContext {
public:
    using Real = RealType;

    FragmentContext(const VaryingsType& inputs, const Vec4<Real>& fragment_position, std::uint32_t active,
                    TextureTable textures, const Profile& profile, Counters* counters)
        : in(inputs),
          position(fragment_position),
          textures_(textures),
          profile_(profile),
          active_(active),
          counters_(counters) {}

    const VaryingsType& in;
    const Vec4<Real>& position;  // pixel centre, depth, w

    /// Texture sampling with the level of detail of the quad's derivatives. D3D11.3 22.4.15
    Vec4<Real> sample(TextureId id, const Sampler& sampler, const Vec2<Real>& uv,
                      const SampleOperands<Real>& operands = {}) const {
        const Texture& texture = this->texture(id);
        const LevelOfDetail<Real> lod = needs_lod(sampler) ? quad_lod(texture, sampler, uv) : LevelOfDetail<Real>(Real(0.0f));
        return count_and_sample(texture, sampler, uv, lod, operands);
    }
    /// With the shader's own derivatives. D3D11.3 22.4.17
    Vec4<Real> sample_gradient(TextureId id, const Sampler& sampler, const Vec2<Real>& uv, const Gradients<Real>& gradients,
                               const SampleOperands<Real>& operands = {}) const {
        const Texture& texture = this->texture(id);
        return count_and_sample(texture, sampler, uv, level_of_detail(gradients, texture, sampler, profile_), operands);
    }
    /// With the shader's own level of detail. D3D11.3 22.4.18
    Vec4<Real> sample_level(TextureId id, const Sampler& sampler, const Vec2<Real>& uv, const Real& lod,
                            const SampleOperands<Real>& operands = {}) const {
        return count_and_sample(texture(id), sampler, uv, LevelOfDetail<Real>(lod), operands);
    }
    /// Comparison at level 0. D3D11.3 22.4.20
    Real sample_compare(TextureId id, const Sampler& sampler, const Vec2<Real>& uv, const Real& reference) const {
        const Texture& texture = this->texture(id);
        const LevelOfDetail<Real> top(Real(0.0f));
        count_sample(texture, sampler, uv, top, {});
        return gnomon::sample_compare(TextureView(texture), sampler, profile_, uv, reference, top);
    }
    /// Four texels of one component, unfiltered. D3D11.3 22.4.2
    Vec4<Real> gather(TextureId id, const Sampler& sampler, const Vec2<Real>& uv, int component = 0,
                      const glm::ivec2& offset = {0, 0}) const {
        count_gather();
        return gnomon::gather(TextureView(texture(id)), sampler, profile_, Vec3<Real>{uv.x, uv.y, Real(0.0f)}, component,
                              offset);
    }
    /// Four comparisons. D3D11.3 22.4.3
    Vec4<Real> gather_compare(TextureId id, const Sampler& sampler, const Vec2<Real>& uv, const Real& reference,
                              const glm::ivec2& offset = {0, 0}) const {
        count_gather();
        return gnomon::gather_compare(TextureView(texture(id)), sampler, profile_, Vec3<Real>{uv.x, uv.y, Real(0.0f)},
                                      reference, offset);
    }
    /// Width and height of level 0, texels.
    [[nodiscard]] glm::ivec2 size(TextureId id) const { return {texture(id).width(0), texture(id).height(0)}; }

    Real ddx(const Real& x) const { return count_derivative(), ddx_coarse(x); }
    Real ddy(const Real& x) const { return count_derivative(), ddy_coarse(x); }
    Real ddx_fine(const Real& x) const { return count_derivative(), gnomon::ddx_fine(x); }
    Real ddy_fine(const Real& x) const { return count_derivative(), gnomon::ddy_fine(x); }

    Real rcp(const Real& x) const { return gnomon::rcp(x); }
    Real rsqrt(const Real& x) const { return gnomon::rsqrt(x); }
    Real exp2(const Real& x) const { return gnomon::exp2(x); }
    Real log2(const Real& x) const { return gnomon::log2(x); }

private:
    [[nodiscard]] const Texture& texture(TextureId id) const { return *textures_[static_cast<std::size_t>(id) - 1]; }

    static bool needs_lod(const Sampler& sampler) {
        return sampler.mip != MipFilter::Base || sampler.min != sampler.mag || sampler.max_anisotropy > 1;
    }

    LevelOfDetail<Real> quad_lod(const Texture& texture, const Sampler& sampler, const Vec2<Real>& uv) const {
        count_derivative();
        return level_of_detail(quad_gradients(uv, profile_), TextureView(texture), sampler, profile_);
    }

    Vec4<Real> count_and_sample(const Texture& texture, const Sampler& sampler, const Vec2<Real>& uv,
                                const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands) const {
        count_sample(texture, sampler, uv, lod, operands);
        return gnomon::sample(TextureView(texture), sampler, profile_, uv, lod, operands);
    }

    void count_sample(const Texture& texture, const Sampler& sampler, const Vec2<Real>& uv, const LevelOfDetail<Real>& lod,
                      const SampleOperands<Real>& operands) const {
        if (counters_ == nullptr) return;
        const SampleCost cost =
            sample_cost(TextureView(texture), sampler, profile_, Vec3<Real>{uv.x, uv.y, Real(0.0f)}, lod, operands, active_);
        counters_->texture_instructions += static_cast<std::uint64_t>(std::popcount(active_));
        counters_->texture_probes += cost.probes;
        counters_->texels_fetched += cost.texels;
    }
    void count_gather() const {
        if (counters_ == nullptr) return;
        const auto lanes = static_cast<std::uint64_t>(std::popcount(active_));
        counters_->texture_instructions += lanes;
        counters_->texels_fetched += 4 * lanes;
    }
    /// Lanes that count and share their quad with a lane that does not.
    void count_derivative() const {
        if (counters_ == nullptr) return;
        const std::uint32_t with_helper = quad_any(~active_ & kAllLanes);
        counters_->invalid_derivatives += static_cast<std::uint64_t>(std::popcount(active_ & with_helper));
    }

    TextureTable textures_;
    const Profile& profile_;
    std::uint32_t active_;
    Counters* counters_;
};

}  // namespace gnomon
