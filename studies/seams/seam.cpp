// Counting and colouring what the lanes of quads did.
#include "studies/seams/seam.h"

#include "sim/error.h"
#include "studies/false_color.h"
#include "studies/filter_charts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::studies {

namespace {

constexpr Rgb kNothing{150, 150, 150};

/// Calls visit(pixels) with the drawn pixels of every quad that has any.
template <class Visit>
void for_each_quad(const SeamImage& image, const Visit& visit) {
    std::vector<SeamPixel> drawn;
    for (int top = 0; top < image.height; top += 2)
        for (int left = 0; left < image.width; left += 2) {
            drawn.clear();
            for (int y = top; y < std::min(top + 2, image.height); ++y)
                for (int x = left; x < std::min(left + 2, image.width); ++x) {
                    const SeamPixel& pixel = image.pixels[static_cast<std::size_t>(y * image.width + x)];
                    if (pixel.drawn()) drawn.push_back(pixel);
                }
            if (!drawn.empty()) visit(drawn);
        }
}

template <class ColorOf>
ByteImage picture(const SeamImage& image, const ColorOf& color_of) {
    ByteImage colors{.width = image.width, .height = image.height, .channels = 3, .values = {}};
    colors.values.reserve(3 * image.pixels.size());
    for (const SeamPixel& pixel : image.pixels) {
        const Rgb color = pixel.drawn() ? color_of(pixel) : kNothing;
        colors.values.insert(colors.values.end(), color.begin(), color.end());
    }
    return colors;
}

}  // namespace

double lod_error(const SeamPixel& pixel) {
    if (pixel.lod == pixel.smooth_lod) return 0.0;  // infinities too
    const double error = std::fabs(static_cast<double>(pixel.lod) - static_cast<double>(pixel.smooth_lod));
    return error < kWorstLod ? error : kWorstLod;
}

SeamMeasures measure_seam(const SeamImage& image, const SeamImage& uncured, const SeamImage& reference) {
    GNOMON_CHECK_EQ(image.pixels.size(), uncured.pixels.size());
    GNOMON_CHECK_EQ(image.pixels.size(), reference.pixels.size());
    const auto is_bad = [](const SeamPixel& pixel) { return pixel.drawn() && lod_error(pixel) >= kLodStep; };
    SeamMeasures measures;
    double lod_errors = 0;
    double exact_errors = 0;
    double crossing_errors = 0;
    double value_errors = 0;
    std::uint64_t crossing = 0;
    std::uint64_t once_bad = 0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const SeamPixel& pixel = image.pixels[i];
        if (!pixel.drawn()) continue;
        ++measures.pixels;
        measures.outside_pixels += pixel.is(SeamPixel::kOutside);
        const double error = lod_error(pixel);
        measures.worst_lod_error = std::max(measures.worst_lod_error, error);
        if (is_bad(pixel)) {
            ++measures.bad_pixels;
            lod_errors += error;
        }
        SeamPixel exact = pixel;
        exact.smooth_lod = pixel.exact_lod;
        exact_errors += lod_error(exact);
        if (uncured.pixels[i].is(SeamPixel::kDisagrees)) {
            ++crossing;
            crossing_errors += lod_error(exact);
        }
        const double change = std::fabs(static_cast<double>(pixel.value) - static_cast<double>(reference.pixels[i].value));
        measures.worst_value_error = std::max(measures.worst_value_error, change);
        measures.changed_pixels += change >= 1.0 / 255;
        if (is_bad(uncured.pixels[i])) {
            ++once_bad;
            value_errors += change;
        }
    }
    for_each_quad(image, [&](const std::vector<SeamPixel>& quad) {
        ++measures.quads;
        measures.disagreeing_quads +=
            std::ranges::any_of(quad, [](const SeamPixel& pixel) { return pixel.is(SeamPixel::kDisagrees); });
        measures.bad_quads += std::ranges::any_of(quad, is_bad);
    });
    const auto mean = [](double sum, std::uint64_t count) { return count > 0 ? sum / static_cast<double>(count) : 0.0; };
    measures.mean_lod_error = mean(lod_errors, measures.bad_pixels);
    measures.exact_lod_error = mean(exact_errors, measures.pixels);
    measures.crossing_lod_error = mean(crossing_errors, crossing);
    measures.mean_value_error = mean(value_errors, once_bad);
    return measures;
}

std::span<const std::string_view> seam_picture_names() {
    static constexpr std::array<std::string_view, 6> kNames{"choice", "disagreeing", "lod-error",
                                                            "lod",    "probes",      "derivatives"};
    return kNames;
}

std::vector<SeamPicture> seam_pictures(const SeamImage& image) {
    std::vector<SeamPicture> pictures;
    pictures.push_back({"choice", picture(image, [](const SeamPixel& pixel) {
                            return kLevelColors[static_cast<std::size_t>(pixel.used) % kLevelColors.size()];
                        })});
    pictures.push_back({"disagreeing", picture(image, [](const SeamPixel& pixel) {
                            return pixel.is(SeamPixel::kDisagrees) ? Rgb{200, 20, 30} : Rgb{255, 255, 255};
                        })});
    // Too coarse is red, too fine blue; a level of four octaves or more is full.
    pictures.push_back({"lod-error", picture(image, [](const SeamPixel& pixel) {
                            const auto error = static_cast<float>(lod_error(pixel)) / 4.0f;
                            return error_color(pixel.lod < pixel.smooth_lod ? -error : error);
                        })});
    pictures.push_back({"lod", picture(image, [](const SeamPixel& pixel) {
                            return lod_color(std::clamp(static_cast<double>(pixel.lod), 0.0, 8.0));
                        })});
    pictures.push_back({"probes", picture(image, [](const SeamPixel& pixel) {
                            return amount_color(probe_step(static_cast<int>(pixel.probes)));
                        })});
    FloatImage drawn{image.width, image.height, {}};
    for (const SeamPixel& pixel : image.pixels) drawn.values.push_back(pixel.drawn() ? 1.0f : -1.0f);
    pictures.push_back({"derivatives", derivative_image(image.derivatives, drawn)});
    return pictures;
}

}  // namespace gnomon::studies
