// Shadow mapping with one comparison. [Donnelly06] section 4, alternate methods 1 and 2; [Williams78]
#pragma once

#include "techniques/technique.h"

namespace gnomon::techniques {

/// One comparison sample: of the nearest texel, or what hardware calls PCF, the bilinear filter of four comparisons. With an
/// anisotropic sampler, the mean of such samples along the pixel's footprint. D3D11.3 22.4.19
struct CompareReceiver {
    TextureId map = TextureId::None;
    Sampler sampler{};

    static constexpr auto fields() {
        using R = CompareReceiver;
        return std::tuple{Field{"map", &R::map}, Field{"sampler", &R::sampler}};
    }

    template <class F, class At>
    auto visibility(const F& f, const At& at) const {
        return compare_sample(f, map, sampler, at);
    }
};

extern const Technique kShadowMap;
extern const Technique kPcfHardware;
extern const Technique kPssm;  // kShadowMap with a map for each of four splits. [Zhang06]

}  // namespace gnomon::techniques
