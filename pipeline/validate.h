// Refuses draws, clears and resolves that no machine could do, with the reason, before anything is touched.
#pragma once

#include "pipeline/draw.h"
#include "pipeline/resources.h"

#include <string>

namespace gnomon {

/// Fills `context`, which must stay where it is; false where the draw draws nothing. Throws Error, which names the draw and
/// what is wrong.
bool resolve_draw(const Draw& draw, Resources& resources, const Profile& profile, DrawContext& context);

/// The view's texture. Throws Error where it, its level or its layers do not exist; `what` begins the message.
Texture& resolve_view(const TargetView& view, Resources& resources, const std::string& what);

/// Throws Error where the profile has no such resource.
void check_texture(const TextureDesc& desc, const Profile& profile);

}  // namespace gnomon
