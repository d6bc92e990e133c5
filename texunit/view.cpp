#include "texunit/view.h"

namespace gnomon {

TextureView::TextureView(const Texture& texture, int base, int levels, float min_lod)
    : texture_(&texture), base_(base), levels_(levels), min_lod_(min_lod) {
    const int available = texture.desc().levels;
    if (base < 0 || base >= available) fail("view from level {} of a texture with {} levels", base, available);
    if (levels < 1 || levels > available - base)
        fail("view of {} levels from level {} of a texture with {}: expected 1 to {}", levels, base, available,
             available - base);
    if (!(min_lod >= 0.0f)) fail("view with a lower limit of {} on the level of detail: expected 0 or more", min_lod);
}

}  // namespace gnomon
