// Colours to targets: blending, conversion to the format and the write mask of a wave. D3D11.3 17.1, 17.4, 17.15, 3.2
#pragma once

#include "pipeline/blend.h"
#include "pipeline/command.h"
#include "pipeline/wave.h"
#include "sim/profile.h"
#include "texunit/texture.h"

#include <span>

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
    const Vec4<Real>& color;
    const Vec4<Real>& second;  // of dual source blending
    const glm::vec4& constant;
};

/// Writes a wave: the lanes of each sample.
template <class Real>
using ColorWriter = void (*)(const ColorTarget& target, const Wave& wave, std::span<const std::uint32_t> lanes,
                             const OutputColors<Real>& colors, const Profile& profile);

/// The one for a target and a profile.
template <class Real>
ColorWriter<Real> color_writer(const ColorTarget& target, const Profile& profile);

extern template ColorWriter<Float> color_writer(const ColorTarget&, const Profile&);
extern template ColorWriter<Double> color_writer(const ColorTarget&, const Profile&);

}  // namespace gnomon
