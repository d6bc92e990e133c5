// What a pixel functor sees: interpolated inputs, derivatives, textures, and the profile's arithmetic.
#pragma once

#include "pipeline/wave.h"
#include "sim/counters.h"
#include "sim/math.h"
#include "sim/profile.h"
#include "sim/quad.h"
#include "sim/vec.h"
#include "texunit/lod.h"
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
    Vec4<Real> sample(TextureId id, const Sampler& sampler, const Vec2<Real>& uv) const {
        const Texture& texture = this->texture(id);
        const Real lod = needs_lod(sampler) ? quad_lod(texture, uv) : Real(0.0f);
        count_sample(texture, sampler, lod);
        return gnomon::sample(texture, sampler, profile_, uv, lod);
    }
    /// With the shader's own level of detail. D3D11.3 22.4.18
    Vec4<Real> sample_level(TextureId id, const Sampler& sampler, const Vec2<Real>& uv, const Real& lod) const {
        const Texture& texture = this->texture(id);
        count_sample(texture, sampler, lod);
        return gnomon::sample(texture, sampler, profile_, uv, lod);
    }
    /// Comparison at level 0. D3D11.3 22.4.20
    Real sample_compare(TextureId id, const Sampler& sampler, const Vec2<Real>& uv, const Real& reference) const {
        const Texture& texture = this->texture(id);
        count_sample(texture, sampler, Real(0.0f));
        return gnomon::sample_compare(texture, sampler, profile_, uv, reference, Real(0.0f));
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

    static bool needs_lod(const Sampler& sampler) { return sampler.mip != MipFilter::Base || sampler.min != sampler.mag; }

    Real quad_lod(const Texture& texture, const Vec2<Real>& uv) const {
        count_derivative();
        return implicit_lod(uv, texture.width(0), texture.height(0), profile_);
    }

    void count_sample(const Texture& texture, const Sampler& sampler, const Real& lod) const {
        if (counters_ == nullptr) return;
        counters_->texture_instructions += static_cast<std::uint64_t>(std::popcount(active_));
        for (int i = 0; i < kLanes; ++i)
            if ((active_ >> i & 1u) != 0)
                counters_->texels_fetched += static_cast<std::uint64_t>(texels_per_lane(sampler, lod, texture, profile_, i));
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
