// Sampler state as one plain value. D3D11.3 7.18.3
#pragma once

#include "sim/enum_names.h"
#include "sim/fields.h"

#include <glm/vec4.hpp>

namespace gnomon {

/// Within a level.
enum class TexelFilter { Nearest, Linear };
template <>
inline constexpr std::array kEnumNames<TexelFilter>{EnumName{TexelFilter::Nearest, "nearest"},
                                                    EnumName{TexelFilter::Linear, "linear"}};

/// Between levels.
enum class MipFilter {
    Base,     // level 0 only
    Nearest,  // D3D11.3 7.18.10
    Linear,
};
template <>
inline constexpr std::array kEnumNames<MipFilter>{EnumName{MipFilter::Base, "base"}, EnumName{MipFilter::Nearest, "nearest"},
                                                  EnumName{MipFilter::Linear, "linear"}};

/// What lies outside the texture. D3D11.3 7.18.9
enum class AddressMode { Wrap, Mirror, Clamp, Border, MirrorOnce };
template <>
inline constexpr std::array kEnumNames<AddressMode>{
    EnumName{AddressMode::Wrap, "wrap"}, EnumName{AddressMode::Mirror, "mirror"}, EnumName{AddressMode::Clamp, "clamp"},
    EnumName{AddressMode::Border, "border"}, EnumName{AddressMode::MirrorOnce, "mirror-once"}};

/// What becomes of the texels under a filter. D3D11.3 7.18.3, 5.9.4.5.6
enum class Reduction {
    Average,  // weighted
    Minimum,  // the smallest, component by component, of those whose weight is not 0
    Maximum,
};
template <>
inline constexpr std::array kEnumNames<Reduction>{
    EnumName{Reduction::Average, "average"}, EnumName{Reduction::Minimum, "minimum"}, EnumName{Reduction::Maximum, "maximum"}};

/// `reference OP texel` of comparison sampling, and `new OP stored` of the depth test.
enum class CompareOp { Never, Less, Equal, LessEqual, Greater, NotEqual, GreaterEqual, Always };
template <>
inline constexpr std::array kEnumNames<CompareOp>{EnumName{CompareOp::Never, "never"},
                                                  EnumName{CompareOp::Less, "less"},
                                                  EnumName{CompareOp::Equal, "equal"},
                                                  EnumName{CompareOp::LessEqual, "less-equal"},
                                                  EnumName{CompareOp::Greater, "greater"},
                                                  EnumName{CompareOp::NotEqual, "not-equal"},
                                                  EnumName{CompareOp::GreaterEqual, "greater-equal"},
                                                  EnumName{CompareOp::Always, "always"}};

struct Sampler {
    TexelFilter min = TexelFilter::Linear;  // where the level of detail is above 0
    TexelFilter mag = TexelFilter::Linear;  // and where it is not
    MipFilter mip = MipFilter::Base;
    AddressMode address_u = AddressMode::Clamp;
    AddressMode address_v = AddressMode::Clamp;
    int max_anisotropy = 1;  // 1 to 16; above 1 several probes of min, mag and mip make a sample
    Reduction reduction = Reduction::Average;
    CompareOp compare = CompareOp::LessEqual;
    float lod_bias = 0.0f;    // [-16, 15.99]
    float min_lod = 0.0f;     // levels
    float max_lod = 1000.0f;  // levels
    glm::vec4 border{0.0f};   // red is what comparisons see

    static constexpr auto fields() {
        using S = Sampler;
        return std::tuple{Field{"min", &S::min},
                          Field{"mag", &S::mag},
                          Field{"mip", &S::mip},
                          Field{"address_u", &S::address_u},
                          Field{"address_v", &S::address_v},
                          Field{"max_anisotropy", &S::max_anisotropy},
                          Field{"reduction", &S::reduction},
                          Field{"compare", &S::compare},
                          Field{"lod_bias", &S::lod_bias},
                          Field{"min_lod", &S::min_lod},
                          Field{"max_lod", &S::max_lod},
                          Field{"border", &S::border}};
    }
    bool operator==(const Sampler&) const = default;

    /// Asks for more than one texel anywhere: what formats that are not filtered cannot be read with.
    [[nodiscard]] bool filters() const {
        return min == TexelFilter::Linear || mag == TexelFilter::Linear || mip == MipFilter::Linear || max_anisotropy > 1;
    }
};

/// Throws Error, with `what` in front, for a member out of range. Limits of the level of detail may cross: then min_lod holds.
void check_sampler(const Sampler& sampler, std::string_view what);

}  // namespace gnomon
