// How far a shadow is from the truth: error norms, light leaks and acne. docs/report.md defines every number.
#pragma once

#include "scenes/reference.h"
#include "sim/fields.h"
#include "studies/images.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace gnomon::studies {

/// A pixel is judged when the machine drew a surface there and (almost) all of the pixel's truth is known: pixels on the
/// silhouette of an object or of the light's frustum are left out. With one sample per pixel the weight is 0 or 1.
inline constexpr float kJudgedWeight = 0.999f;

/// Errors are visibility - truth. All sums run in double over rows from the top, so they have one value on every machine.
struct Metrics {
    double rmse = 0;                    // root of the mean squared error
    double mae = 0;                     // mean absolute error
    double p99 = 0;                     // absolute error that 99 % of the pixels do not exceed (nearest rank)
    double leak = 0;                    // mean visibility where the truth is fully shadowed
    double acne = 0;                    // mean missing visibility where the truth is fully lit
    std::uint64_t pixels = 0;           // judged
    std::uint64_t shadowed_pixels = 0;  // of these, truth 0: what leak is the mean of
    std::uint64_t lit_pixels = 0;       // of these, truth 1: what acne is the mean of
    std::uint64_t not_finite = 0;       // of these, visibility NaN or infinite; each counts as an error of 1

    static constexpr auto fields() {
        using M = Metrics;
        return std::tuple{Field{"rmse", &M::rmse},
                          Field{"mae", &M::mae},
                          Field{"p99", &M::p99},
                          Field{"leak", &M::leak},
                          Field{"acne", &M::acne},
                          Field{"pixels", &M::pixels},
                          Field{"shadowed_pixels", &M::shadowed_pixels},
                          Field{"lit_pixels", &M::lit_pixels},
                          Field{"not_finite", &M::not_finite}};
    }
    bool operator==(const Metrics&) const = default;
};

/// Whether pixel `i` is judged.
bool is_judged(const FloatImage& visibility, const scenes::ReferenceImage& truth, std::size_t i);

/// visibility - truth of one pixel; of a visibility that is no finite number, an error of 1.
double error_of(float visibility, float truth);

/// The smallest of the values that at least `percent` % of them do not exceed (nearest rank), 1 to 100; of none, 0. Reorders
/// them.
double percentile(std::vector<double>& values, std::size_t percent);

/// Means over no pixels are 0. The images must have one size.
Metrics measure(const FloatImage& visibility, const scenes::ReferenceImage& truth);

/// The same; none, and a warning, when no pixel is judged: zeros would read as a perfect result.
std::optional<Metrics> measure_judged(const FloatImage& visibility, const scenes::ReferenceImage& truth);

}  // namespace gnomon::studies
