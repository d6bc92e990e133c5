// Where the view frustum is cut by planes parallel to the image: one shadow map for each part. [Zhang06], [Lauritzen10]
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::techniques {

/// The "practical split scheme": count + 1 ascending camera-space distances from `nearest` to `farthest`, the i-th
/// lambda n (f/n)^(i/N) + (1 - lambda) (n + (f - n) i/N). [Zhang06]; [PSVSM] step 1. 0 < nearest < farthest, count
/// >= 1, lambda in [0, 1]: 1 is the logarithmic scheme, 0 the uniform one.
std::vector<double> practical_splits(double nearest, double farthest, int count, double lambda);

/// Distances that give every part as many pixels as possible of a histogram of distances: bin b of B counts pixels between
/// n (f/n)^(b/B) and n (f/n)^((b+1)/B), spread evenly over the logarithm of the distance inside a bin. The first distance is
/// that of the first filled bin, the last that of the last one. Always ascending. After [Lauritzen10], where the partition
/// follows the samples too.
std::vector<double> histogram_splits(std::span<const std::uint32_t> bins, double nearest, double farthest, int count);

}  // namespace gnomon::techniques
