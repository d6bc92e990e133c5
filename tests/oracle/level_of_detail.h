// Level of detail and line of anisotropy from gradients, as intervals. D3D11.3 7.18.10, 7.18.11, 5.8
#pragma once

#include "tests/oracle/interval.h"
#include "tests/oracle/sampler.h"

#include <vector>

namespace oracle {

/// One legal reading of the gradients.
struct Footprint {
    bool lod_nan = false;
    Interval lod{};    // before bias; a point for an instruction's own
    bool own = false;  // the instruction's own
    int probes = 1;
    Interval axis_u{};  // the line of anisotropy from end to end, in the units of the coordinate
    Interval axis_v{};
};

/// The component that chooses a cube's face. D3D11.3 7.18.7
struct CubeFace {
    int face = 0;
    int major = 0;              // index of the largest component
    double major_sign = 1;      // of that component
    std::array<int, 2> axis{};  // components that become u and v
    std::array<double, 2> sign{};
};
CubeFace cube_face(int face);
/// More than one where a component is no number.
std::vector<CubeFace> cube_faces(const std::array<double, 3>& direction);

/// `width` and `height` are those of the view's finest level.
std::vector<Footprint> footprints(Kind kind, std::array<int, 2> size, const gnomon::Sampler& sampler,
                                  const gnomon::Profile& profile, const Question& question);

/// Levels, filter and weight. D3D11.3 7.18.10
struct MipChoice {
    bool magnified = false;
    int fine = 0;  // of the view
    int coarse = 0;
    double weight = 0;       // of the coarse one: the least
    double weight_high = 0;  // and the greatest

    bool operator==(const MipChoice&) const = default;
};
/// Every choice in reach. `width` receives the width of the interval of unquantised levels of detail.
std::vector<MipChoice> mip_choices(const Footprint& footprint, const Levels& view, const gnomon::Sampler& sampler,
                                   const gnomon::Profile& profile, const Question& question, double& width);

/// The sampler's limit as the profile has it, and the number of probes for a ratio.
int anisotropy_limit(const gnomon::Sampler& sampler, const gnomon::Profile& profile);

}  // namespace oracle
