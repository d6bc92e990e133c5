// Image files through OpenImageIO: 8-bit PNG and float OpenEXR out, whatever it knows in. Same image, same bytes: no dates, no
// host names.
#pragma once

#include "studies/images.h"

#include <filesystem>
#include <span>

namespace gnomon::studies {

/// Throws Error when the file cannot be written.
void write_png(const std::filesystem::path& path, const ByteImage& image);

/// Two float channels without loss: Y is the image, A says how much of each pixel counts. Throws Error when the file cannot be
/// written.
void write_exr(const std::filesystem::path& path, const FloatImage& y, std::span<const float> a);

/// The first image of a file as numbers: missing colour channels are 0, alpha 1. 8-bit files give 0 to 1 by code / 255, no
/// transfer function undone. Throws Error when it cannot be read or has sides over kMaxTextureSize.
ColorImage read_image(const std::filesystem::path& path);

}  // namespace gnomon::studies
