// Colours to targets: conversion to the format and the write mask of a wave. D3D11.3 17.1, 3.2
#pragma once

#include "pipeline/wave.h"
#include "sim/double_lanes.h"
#include "sim/profile.h"
#include "sim/vec.h"
#include "texunit/texture.h"

namespace gnomon {

/// Writes the lanes in `mask` of a colour to level 0 of a target.
template <class Real>
void write_color(Texture& target, const Wave& wave, std::uint32_t mask, const Vec4<Real>& color, const Profile& profile);

extern template void write_color(Texture&, const Wave&, std::uint32_t, const Vec4<Float>&, const Profile&);
extern template void write_color(Texture&, const Wave&, std::uint32_t, const Vec4<Double>&, const Profile&);

}  // namespace gnomon
