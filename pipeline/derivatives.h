// Where derivatives come from: which lanes a quad's differences were taken over. D3D11.3 3.5.7, 22.5
//
// A derivative is valid to compute in any quad, and not to be trusted where a lane that it reads is no pixel of the primitive
// (a helper, whose inputs are extrapolated), was discarded, or stands outside the branch that takes it (and holds whatever it
// held before). Lanes that it does not read make it no worse: a fine derivative reads one row or column, a coarse one the row
// or column through one corner, a level of detail both.
#pragma once

#include "sim/counters.h"
#include "sim/quad.h"

#include <bit>

namespace gnomon {

/// Bits of a texel of the derivative report; 0: all derivatives of the pixel were sound.
enum DerivativeCause : std::uint32_t {
    kFromHelper = 1u << 0,
    kFromKilled = 1u << 1,
    kFromInactive = 1u << 2,
};

/// Lanes of a wave that used a derivative which read a lane of each kind.
struct DerivativeCauses {
    std::uint32_t helper = 0;
    std::uint32_t killed = 0;
    std::uint32_t inactive = 0;

    [[nodiscard]] std::uint32_t any() const { return helper | killed | inactive; }
    DerivativeCauses& operator|=(const DerivativeCauses& other) {
        helper |= other.helper;
        killed |= other.killed;
        inactive |= other.inactive;
        return *this;
    }
};

/// Which lanes of a wave do what while its functor runs.
struct LaneFlow {
    std::uint32_t covered = 0;         // inside the primitive, at the sample where the functor runs for one; others are helpers
    std::uint32_t counting = 0;        // of these, lanes whose results are wanted
    std::uint32_t branch = kAllLanes;  // lanes inside the branch under way
    std::uint32_t killed = 0;          // discarded so far

    /// Lanes whose instructions count.
    [[nodiscard]] std::uint32_t active() const { return counting & branch & ~killed; }

    /// One derivative taken now, for which readers(bits) are the lanes whose differences read a lane of `bits`. A lane is bad
    /// for one reason: what helpers do makes them no worse.
    template <class Readers>
    [[nodiscard]] DerivativeCauses causes(const Readers& readers) const {
        const std::uint32_t lanes = active();
        return {lanes & readers(~covered & kAllLanes), lanes & readers(killed & covered),
                lanes & readers(~branch & covered & kAllLanes)};
    }
};

inline void count_derivative(Counters& counters, const LaneFlow& flow, const DerivativeCauses& causes) {
    const auto lanes = [](std::uint32_t bits) { return static_cast<std::uint64_t>(std::popcount(bits)); };
    counters.derivatives += lanes(flow.active());
    counters.derivatives_helper += lanes(causes.helper);
    counters.derivatives_killed += lanes(causes.killed);
    counters.derivatives_inactive += lanes(causes.inactive);
    counters.invalid_derivatives += lanes(causes.any());
}

}  // namespace gnomon
