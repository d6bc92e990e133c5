// A profile of ours in the place of a driver.
#pragma once

#include "sim/profile.h"
#include "tests/agree/measure.h"

namespace gnomon::agree {

/// Samples as `profile` predicts them. Throws Error as sample_all does, and for comparisons of what is no depth format.
Source profile_source(const Profile& profile);

}  // namespace gnomon::agree
