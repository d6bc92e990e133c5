// Which samples one triangle covers, without a draw: for tools and for other people's oracles. D3D11.3 3.4.1, 3.4.2
#pragma once

#include "sim/profile.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace gnomon {

/// A target without memory.
struct CoverageTarget {
    int width = 0;  // pixels, 1 to kMaxTextureSize
    int height = 0;
    int samples = 1;  // 1, 2, 4, 8 or 16, and no more than the profile has
};

struct CoveredPixel {
    int x = 0;
    int y = 0;
    std::uint32_t mask = 0;  // bit s: sample s

    bool operator==(const CoveredPixel&) const = default;
};

inline constexpr float kMaxPosition = 32767.0f;  // either way: the range of 16.8 positions. D3D11.3 15.16

/// Calls visit(pixels) with what a triangle covers, in pieces of whole rows, top first and each row from the left; memory is
/// that of a row of tiles, however large the triangle. The corners (pixels, y down, of any winding) are snapped to the
/// profile's grid; profiles that transform or clip in a way of their own (llvmpipe, swiftshader) get them in clip space, as a
/// draw over the whole target would. Throws Error for positions outside +-kMaxPosition, for NaN, and for targets that the
/// profile does not have.
void visit_covered_pixels(const std::array<glm::vec2, 3>& corners, const CoverageTarget& target, const Profile& profile,
                          const std::function<void(std::span<const CoveredPixel>)>& visit);

/// The same at once.
std::vector<CoveredPixel> covered_pixels(const std::array<glm::vec2, 3>& corners, const CoverageTarget& target,
                                         const Profile& profile);

}  // namespace gnomon
