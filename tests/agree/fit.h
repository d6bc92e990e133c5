// From measurements to a profile.
#pragma once

#include "sim/profile.h"
#include "tests/agree/measure.h"

#include <string>
#include <vector>

namespace gnomon::agree {

enum class Basis {
    Measured,  // the measurements leave no other value
    Reported,  // the driver says so
    Assumed,   // they do not tell; the value is d3d11's, or what goes with the rest
};

/// Where a field's value has come from.
struct FieldEvidence {
    std::string field{};
    Basis basis = Basis::Assumed;
    std::string text{};  // one line
};

struct FittedProfile {
    Profile profile{};
    std::vector<FieldEvidence> evidence{};  // one per field but name and summary, in their order
};

/// d3d11 with every field that the measurements determine; its name is the device's.
FittedProfile fit_profile(const Measurements& measurements);

/// Differences of a measured level of detail to a model's, levels.
struct Residual {
    double rms = 0;
    double largest = 0;
};
/// Of isotropic gradients to each Log2Model, in their order, stored as `profile` stores levels of detail.
std::array<Residual, 3> log2_residuals(const LodMeasurement& lod, const Profile& profile);

}  // namespace gnomon::agree
