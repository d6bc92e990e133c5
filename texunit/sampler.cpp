#include "texunit/sampler.h"

#include <cmath>

namespace gnomon {

void check_sampler(const Sampler& sampler, std::string_view what) {
    for_each_field(sampler, [&](std::string_view name, const auto& value) {
        if constexpr (std::is_enum_v<std::remove_cvref_t<decltype(value)>>) check_enum(value, fmt::format("{}.{}", what, name));
    });
    if (sampler.max_anisotropy < 1 || sampler.max_anisotropy > 16)
        fail("{}: max_anisotropy {}, expected 1 to 16", what, sampler.max_anisotropy);
    if (!(sampler.lod_bias >= -16.0f && sampler.lod_bias <= 15.99f))
        fail("{}: lod_bias {}, expected -16 to 15.99", what, sampler.lod_bias);
    if (std::isnan(sampler.min_lod) || std::isnan(sampler.max_lod))
        fail("{}: levels of detail from {} to {}, expected numbers", what, sampler.min_lod, sampler.max_lod);
}

}  // namespace gnomon
