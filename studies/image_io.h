// Image files through OpenImageIO: 8-bit PNG and float OpenEXR. Same image, same bytes: no dates, no host names.
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

}  // namespace gnomon::studies
