// The triangle that covers a target, as a draw.
#include "techniques/common/full_screen.h"

#include "pipeline/program.h"

#include <algorithm>

namespace gnomon::techniques {

FullScreen::FullScreen(Device& device) : device_(device) {
    constexpr std::array<float, 6> kCorners{-1.0f, 1.0f, 3.0f, 1.0f, -1.0f, -3.0f};
    triangle_ = device.create_buffer("full screen", std::as_bytes(std::span(kCorners)));
}

void FullScreen::draw(std::string_view label, const Program& program, std::span<const std::byte> constants,
                      const Targets& targets) const {
    const FullScreenVertex vertex;
    Draw draw{.label = label,
              .program = &program,
              .vertex_constants = constants_of(vertex),
              .pixel_constants = constants,
              .vertices = triangle_,
              .count = 3,
              .depth_state = {.compare = CompareOp::Always},
              .scissors = targets.scissors,
              .depth = targets.depth};
    std::ranges::copy(targets.colors, draw.color.begin());
    device_.execute(draw);
}

}  // namespace gnomon::techniques
