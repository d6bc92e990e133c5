// Colours to targets: blending, conversion to the format and the write mask of a wave. D3D11.3 17.1, 17.4, 17.15, 3.2
#pragma once

#include "pipeline/blend.h"
#include "pipeline/command.h"
#include "pipeline/wave.h"
#include "sim/profile.h"
#include "texunit/texture.h"

namespace gnomon {

/// A colour target of a draw, at one layer.
struct ColorTarget {
    Texture* texture = nullptr;  // null: the functor's colour goes nowhere
    TargetView view;
    BlendState state;
    std::byte* base = nullptr;  // of the layer
    std::int32_t pitch = 0;     // bytes
    std::int32_t plane = 0;     // bytes from sample to sample
    int width = 0;
    bool merges = false;  // reads what is stored: it blends or leaves components alone

    ColorTarget() = default;
    ColorTarget(Texture& target, const TargetView& where, const BlendState& how);
    void set_layer(int layer) { base = texture->row(view.level, 0, view.first_layer + layer); }
};

/// The colours of one wave for one target.
template <class Real>
struct OutputColors {
    Vec4<Real> color;
    Vec4<Real> second;  // of dual source blending
    glm::vec4 constant{0.0f};
};

/// Writes the lanes in `mask` at sample s.
template <class Real>
void write_color(const ColorTarget& target, const Wave& wave, std::uint32_t mask, int s, const OutputColors<Real>& colors,
                 const Profile& profile);

extern template void write_color(const ColorTarget&, const Wave&, std::uint32_t, int, const OutputColors<Float>&,
                                 const Profile&);
extern template void write_color(const ColorTarget&, const Wave&, std::uint32_t, int, const OutputColors<Double>&,
                                 const Profile&);

}  // namespace gnomon
