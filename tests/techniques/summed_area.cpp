// Summed-area tables against sums in double and in integers; rectangles against sums of their texels.
// [Crow84], [Lauritzen07] 8.5
#include "techniques/summed_area.h"

#include "pipeline/program.h"
#include "scenes/procedural.h"
#include "techniques/common/full_screen.h"
#include "techniques/frame.h"
#include "tests/oracle/random.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

using namespace gnomon;
using namespace gnomon::techniques;

namespace {

constexpr double kUnit = 0x1p-24;  // rounding to nearest of a float in [1, 2), relative

/// Additions, multiplications or divisions that round, one after the other. [Higham02] 3.1
double gamma_of(int operations) { return operations * kUnit / (1 - operations * kUnit); }

/// Moments texel by texel, rows top first.
struct MomentMap {
    int width = 1;
    int height = 1;
    bool centred = false;
    std::vector<std::array<float, 2>> texels{};

    [[nodiscard]] const std::array<float, 2>& at(int x, int y) const {
        return texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
    [[nodiscard]] TableDesc table(Format format) const {
        return {.format = format, .width = width, .height = height, .centred = centred};
    }
};

/// What a light sees: blocks at many depths, a slope with a little noise below them, and places where nothing is.
MomentMap make_map(int width, int height, bool centred) {
    MomentMap map{.width = width, .height = height, .centred = centred};
    oracle::Random random(static_cast<std::uint64_t>(width * 10007 + height));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto block = static_cast<std::uint64_t>((y / 16) * 1009 + x / 16);
            oracle::Random of_block(block);
            float depth = 0.55f + 0.4f * static_cast<float>(y) / static_cast<float>(height) + 0.004f * random.unit();
            if (block % 5 == 1) depth = 0.2f + 0.3f * of_block.unit();
            if (block % 7 == 3) depth = 1.0f;
            const float m = centred ? depth - 0.5f : depth;
            map.texels.push_back({m, m * m});
        }
    return map;
}

TextureId upload(Device& device, const MomentMap& map) {
    const TextureId id =
        device.create_texture("moments", {.format = Format::Rg32Float, .width = map.width, .height = map.height});
    device.execute(WriteTexture{.id = id, .data = std::as_bytes(std::span(map.texels))});
    return id;
}

template <class Word>
std::vector<Word> words_of(const Device& device, TextureId id) {
    const auto bytes = device.texture(id).level_bytes(0);
    std::vector<Word> words(bytes.size() / sizeof(Word));
    std::memcpy(words.data(), bytes.data(), bytes.size());
    return words;
}

/// Sums in double, with a row and a column of zeros in front.
class Sums {
public:
    /// Of `number(x, y)`.
    template <class Number>
    Sums(int width, int height, const Number& number)
        : pitch_(static_cast<std::size_t>(width) + 1), sums_(pitch_ * (static_cast<std::size_t>(height) + 1)) {
        for (int y = 0; y < height; ++y) {
            double row = 0;
            for (int x = 0; x < width; ++x) {
                row += static_cast<double>(number(x, y));
                at(x + 1, y + 1) = at(x + 1, y) + row;
            }
        }
    }
    /// Of the texels left of and above a corner.
    [[nodiscard]] double before(int x, int y) const {
        return sums_[static_cast<std::size_t>(y) * pitch_ + static_cast<std::size_t>(x)];
    }
    /// Bilinear between corners: the integral from the origin.
    [[nodiscard]] double before(double x, double y) const {
        const int i = std::min(static_cast<int>(x), static_cast<int>(pitch_) - 2);
        const int j = std::min(static_cast<int>(y), static_cast<int>(sums_.size() / pitch_) - 2);
        const double u = x - i;
        const double v = y - j;
        return (1 - v) * ((1 - u) * before(i, j) + u * before(i + 1, j)) +
               v * ((1 - u) * before(i, j + 1) + u * before(i + 1, j + 1));
    }
    [[nodiscard]] double total() const { return sums_.back(); }

private:
    double& at(int x, int y) { return sums_[static_cast<std::size_t>(y) * pitch_ + static_cast<std::size_t>(x)]; }

    std::size_t pitch_;
    std::vector<double> sums_;
};

/// Both moments of a map, and their magnitudes.
struct MapSums {
    std::array<Sums, 2> moments;
    std::array<double, 2> magnitudes;

    explicit MapSums(const MomentMap& map)
        : moments{Sums(map.width, map.height, [&](int x, int y) { return map.at(x, y)[0]; }),
                  Sums(map.width, map.height, [&](int x, int y) { return map.at(x, y)[1]; })},
          magnitudes{Sums(map.width, map.height, [&](int x, int y) { return std::fabs(map.at(x, y)[0]); }).total(),
                     moments[1].total()} {}
};

using Rectangle = std::array<float, 4>;  // low x, low y, high x, high y, texels

double mean_of(const Sums& sums, const Rectangle& r) {
    const auto [x0, y0, x1, y1] =
        std::array{static_cast<double>(r[0]), static_cast<double>(r[1]), static_cast<double>(r[2]), static_cast<double>(r[3])};
    const double sum = sums.before(x1, y1) - sums.before(x0, y1) - sums.before(x1, y0) + sums.before(x0, y0);
    return sum / ((x1 - x0) * (y1 - y0));
}

/// Texel by texel, each with the part of it that is inside.
double direct_mean_of(const MomentMap& map, const Rectangle& r, std::size_t moment) {
    const auto overlap = [](int texel, float low, float high) {
        return std::max(0.0,
                        std::min(texel + 1.0, static_cast<double>(high)) - std::max<double>(texel, static_cast<double>(low)));
    };
    double sum = 0;
    double area = 0;
    for (int y = static_cast<int>(r[1]); y < map.height && static_cast<float>(y) < r[3]; ++y)
        for (int x = static_cast<int>(r[0]); x < map.width && static_cast<float>(x) < r[2]; ++x) {
            const double part = overlap(x, r[0], r[2]) * overlap(y, r[1], r[3]);
            sum += part * static_cast<double>(map.at(x, y)[moment]);
            area += part;
        }
    return sum / area;
}

/// One rectangle per pixel.
struct MeanPerPixel {
    SummedAreaLookup table{};
    TextureId rectangles = TextureId::None;

    static constexpr auto fields() {
        return std::tuple{Field{"table", &MeanPerPixel::table}, Field{"rectangles", &MeanPerPixel::rectangles}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec2<Int> at = pixel_of(f);
        const Vec4<Real> r = f.load(rectangles, at.x, at.y);
        const auto means = table.mean(f, TexelRectangle<Real>{{r.x, r.y}, {r.z, r.w}});
        return Vec4<Real>{means.first, means.second, Real(0.0f), Real(1.0f)};
    }
};

constexpr int kPixels = 32;  // per side of the target

/// The means of a table over kPixels^2 rectangles.
std::vector<std::array<float, 2>> means_of(Device& device, const SummedAreaLookup& table, const std::vector<Rectangle>& boxes) {
    REQUIRE(boxes.size() == kPixels * kPixels);
    const TextureId rectangles =
        device.create_texture("rectangles", {.format = Format::Rgba32Float, .width = kPixels, .height = kPixels});
    device.execute(WriteTexture{.id = rectangles, .data = std::as_bytes(std::span(boxes))});
    const TextureId means = device.create_texture("means", {.format = Format::Rg32Float, .width = kPixels, .height = kPixels});
    static const Program program = make_program<FullScreenVertex, MeanPerPixel>("test.means");
    const std::array<TargetView, 1> target{means};
    FullScreen(device).run("means", program, MeanPerPixel{.table = table, .rectangles = rectangles}, target);
    return words_of<std::array<float, 2>>(device, means);
}

/// Inside a map; of up to `side` texels per axis, at least one where the map has it.
std::vector<Rectangle> random_rectangles(int width, int height, float side, std::uint64_t seed) {
    oracle::Random random(seed);
    std::vector<Rectangle> all;
    for (int i = 0; i < kPixels * kPixels; ++i) {
        const auto axis = [&](int texels) {
            const auto end = static_cast<float>(texels);
            float low = random.in(0.0f, end);
            float high = low + random.in(1.0f, std::max(side, 1.0f));
            if (i % 3 == 0) low = std::floor(low), high = std::ceil(high);
            if (i % 7 == 0) high = end;
            low = std::min(low, end - 0.5f);
            return std::pair{low, std::clamp(high, low + 0.5f, end)};
        };
        const auto [x0, x1] = axis(width);
        const auto [y0, y1] = axis(height);
        all.push_back({x0, y0, x1, y1});
    }
    return all;
}

/// Rectangles of whole texels, in the quarter of the map where sums are largest.
std::vector<Rectangle> far_squares(int size, int side, std::uint64_t seed) {
    oracle::Random random(seed);
    std::vector<Rectangle> all;
    for (int i = 0; i < kPixels * kPixels; ++i) {
        const auto x = static_cast<float>(random.integer(size / 2, size - side));
        const auto y = static_cast<float>(random.integer(size / 2, size - side));
        all.push_back({x, y, x + static_cast<float>(side), y + static_cast<float>(side)});
    }
    return all;
}

const std::vector<std::pair<int, int>> kSizes{{1, 1}, {7, 5}, {37, 37}, {64, 64}, {100, 100}, {257, 257}, {300, 3}, {3, 300}};

std::vector<std::byte> table_bytes(const MomentMap& map, Format format, int threads) {
    Device device(load_profile("d3d11"), threads);
    const SummedAreaTable table(device, map.table(format));
    table.build(upload(device, map));
    return device.texture(table.id()).level_bytes(0);
}

}  // namespace

TEST_CASE("tables of floats are sums within the bound of their additions", "[techniques][summed_area]") {
    for (const auto& [width, height] : kSizes)
        for (const bool centred : {false, true})
            for (const char* profile : {"d3d11", "ideal"}) {
                INFO(width << "x" << height << " centred " << centred << " " << profile);
                const MomentMap map = make_map(width, height, centred);
                Device device(load_profile(profile), 2);
                const SummedAreaTable table(device, map.table(Format::Rg32Float));
                table.build(upload(device, map));
                const auto found = words_of<std::array<float, 2>>(device, table.id());
                // In double only the stores of a row's sums and of the table's round.
                const int roundings = profile == std::string("ideal") ? 2 : table_additions(width, height);
                for (std::size_t moment = 0; moment < 2; ++moment) {
                    const Sums sums(width, height, [&](int x, int y) { return map.at(x, y)[moment]; });
                    const Sums sizes(width, height, [&](int x, int y) { return std::fabs(map.at(x, y)[moment]); });
                    double worst = 0;  // of error / bound
                    for (int y = 0; y < height; ++y)
                        for (int x = 0; x < width; ++x) {
                            const std::size_t texel = static_cast<std::size_t>(y * width + x);
                            const double error = static_cast<double>(found[texel][moment]) - sums.before(x + 1, y + 1);
                            const double bound = gamma_of(roundings) * sizes.before(x + 1, y + 1) + 1e-12;
                            worst = std::max(worst, std::fabs(error) / bound);
                        }
                    CHECK(worst <= 1.0);
                    if (width * height > 1000) CHECK(worst > 0.0);
                }
            }
}

TEST_CASE("of a split table the coarse sums are exact", "[techniques][summed_area]") {
    for (const auto& [width, height] : kSizes)
        for (const bool centred : {false, true}) {
            INFO(width << "x" << height << " centred " << centred);
            const MomentMap map = make_map(width, height, centred);
            const TableDesc desc = map.table(Format::Rgba32Float);
            Device device(load_profile("d3d11"), 2);
            const SummedAreaTable table(device, desc);
            table.build(upload(device, map));
            const auto found = words_of<std::array<float, 4>>(device, table.id());
            const double factor = std::ldexp(1.0, exact_split_bits(desc));
            REQUIRE(table.lookup().coding.split.factor == static_cast<float>(factor));
            for (std::size_t moment = 0; moment < 2; ++moment) {
                const auto coarse_of = [&](int x, int y) {
                    return std::floor(static_cast<double>(map.at(x, y)[moment]) * factor + 0.5) / factor;
                };
                const Sums coarse(width, height, coarse_of);
                const Sums fine(width, height, [&](int x, int y) {
                    return (static_cast<double>(map.at(x, y)[moment]) - coarse_of(x, y)) * factor;
                });
                // A fine part is at most 1/2.
                const double bound = gamma_of(table_additions(width, height)) / 2;
                bool same = true;
                bool close = true;
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x) {
                        const auto& texel = found[static_cast<std::size_t>(y * width + x)];
                        same = same && static_cast<double>(texel[moment]) == coarse.before(x + 1, y + 1);
                        const double exact = fine.before(x + 1, y + 1);
                        close = close &&
                                std::fabs(static_cast<double>(texel[moment + 2]) - exact) <= bound * (x + 1) * (y + 1) + 1e-12;
                    }
                CHECK(same);
                CHECK(close);
            }
        }
}

TEST_CASE("tables of fixed point are exact, and wrap", "[techniques][summed_area]") {
    for (const auto& [width, height] : kSizes)
        for (const bool centred : {false, true})
            for (const int bits : {0, 24}) {
                INFO(width << "x" << height << " centred " << centred << " bits " << bits);
                const MomentMap map = make_map(width, height, centred);
                TableDesc desc = map.table(Format::Rg32Uint);
                desc.fraction_bits = bits;
                Device device(load_profile("d3d11"), 2);
                const SummedAreaTable table(device, desc);
                table.build(upload(device, map));
                const auto found = words_of<std::array<std::uint32_t, 2>>(device, table.id());
                const double one = std::ldexp(1.0, bits == 0 ? exact_fraction_bits(desc) : bits);
                for (std::size_t moment = 0; moment < 2; ++moment) {
                    const auto code_of = [&](int x, int y) {
                        const double code = std::nearbyint(static_cast<double>(map.at(x, y)[moment]) * one);
                        return std::min(code, (centred ? one / 2 : one) - 1);
                    };
                    const Sums sums(width, height, code_of);  // below 2^53: exact
                    bool same = true;
                    for (int y = 0; y < height; ++y)
                        for (int x = 0; x < width; ++x) {
                            const auto sum = static_cast<std::int64_t>(sums.before(x + 1, y + 1));
                            if (bits == 0) REQUIRE((centred ? sum == static_cast<std::int32_t>(sum) : sum <= 0xffffffffll));
                            same = same &&
                                   found[static_cast<std::size_t>(y * width + x)][moment] == static_cast<std::uint32_t>(sum);
                        }
                    CHECK(same);
                }
            }
}

TEST_CASE("how many bits fit is as the header says", "[techniques][summed_area]") {
    const auto desc = [](int width, int height, bool centred) {
        return TableDesc{.width = width, .height = height, .centred = centred};
    };
    CHECK(exact_fraction_bits(desc(1024, 1024, false)) == 12);
    CHECK(exact_fraction_bits(desc(1000, 1000, false)) == 12);
    CHECK(exact_fraction_bits(desc(1025, 1024, false)) == 11);
    CHECK(exact_fraction_bits(desc(16, 16, false)) == 24);
    CHECK(exact_fraction_bits(desc(1, 1, true)) == 24);
    CHECK(exact_split_bits(desc(1024, 1024, false)) == 4);
    CHECK(exact_split_bits(desc(1024, 1024, true)) == 5);
    CHECK(exact_split_bits(desc(16384, 16384, false)) == 1);
    CHECK(exact_split_bits(desc(1, 1, true)) == 23);
    TableDesc fixed = desc(1024, 512, false);
    fixed.format = Format::Rg32Uint;
    CHECK(largest_side(fixed) == 1024.0f);
    fixed.fraction_bits = 20;
    CHECK(largest_side(fixed) == 64.0f);
    fixed.fraction_bits = 21;
    CHECK(largest_side(fixed) == 45.0f);  // 45^2 <= 2^11 < 46^2
    fixed.fraction_bits = 24;
    CHECK(largest_side(fixed) == 16.0f);
}

TEST_CASE("tables are the same for 1, 2 and 8 threads", "[techniques][summed_area][order]") {
    for (const auto& [width, height] : kSizes)
        for (const Format format : {Format::Rg32Float, Format::Rgba32Float, Format::Rg32Uint}) {
            INFO(width << "x" << height << " " << name_of(format));
            const MomentMap map = make_map(width, height, true);
            const auto one = table_bytes(map, format, 1);
            CHECK(one == table_bytes(map, format, 2));
            CHECK(one == table_bytes(map, format, 8));
        }
}

TEST_CASE("no thread of a table's dispatches depends on the order of another", "[techniques][summed_area][races]") {
    for (const auto& [width, height] : {std::pair{1, 1}, std::pair{37, 70}, std::pair{70, 37}})
        for (const Format format : {Format::Rg32Float, Format::Rgba32Float, Format::Rg32Uint}) {
            INFO(width << "x" << height << " " << name_of(format));
            const MomentMap map = make_map(width, height, false);
            Device device(load_profile("d3d11"), 2);
            device.set_race_check(true);
            const SummedAreaTable table(device, map.table(format));
            CHECK_NOTHROW(table.build(upload(device, map)));
            CHECK(device.texture(table.id()).level_bytes(0) == table_bytes(map, format, 1));
        }
}

namespace {

/// What is left of the error of a mean over a rectangle.
struct MeanErrors {
    double worst = 0;
    double square_sum = 0;

    void add(double error) {
        worst = std::max(worst, std::fabs(error));
        square_sum += error * error;
    }
    [[nodiscard]] double rms() const { return std::sqrt(square_sum / (kPixels * kPixels)); }
};

/// The bound of the error of a mean over an area. What lies under the rectangle itself rounds 8 times more: the difference, its
/// weight, nine additions of which no term sees more than 4, and the share of the area.
double mean_bound(const TableDesc& desc, double map_sum, double box_area, double box_mean) {
    const double local = gamma_of(16) * std::fabs(box_mean);
    const TableCoding coding = table_coding(desc);
    if (coding.fixed.bits != 0) return std::ldexp(1.0, -coding.fixed.bits) + gamma_of(16);
    // Four sums of the table, each with the error of its additions, and differences of them.
    const double of_table = 4 * gamma_of(table_additions(desc.width, desc.height) + 3);
    if (coding.split.factor == 0.0f) return of_table * map_sum / box_area + local;
    const double texels = static_cast<double>(desc.width) * desc.height;
    return of_table * texels / 2 / static_cast<double>(coding.split.factor) / box_area + gamma_of(16);
}

}  // namespace

TEST_CASE("means over rectangles are the direct sums of their texels", "[techniques][summed_area]") {
    for (const auto& [width, height] : kSizes)
        for (const Format format : {Format::Rg32Float, Format::Rgba32Float, Format::Rg32Uint})
            for (const bool centred : {false, true}) {
                INFO(width << "x" << height << " " << name_of(format) << " centred " << centred);
                const MomentMap map = make_map(width, height, centred);
                const MapSums sums(map);
                Device device(load_profile("d3d11"), 2);
                const SummedAreaTable table(device, map.table(format));
                table.build(upload(device, map));
                const auto boxes = random_rectangles(width, height, 24.0f, static_cast<std::uint64_t>(width));
                const auto means = means_of(device, table.lookup(), boxes);
                double worst = 0;
                for (std::size_t i = 0; i < boxes.size(); ++i)
                    for (std::size_t moment = 0; moment < 2; ++moment) {
                        const Rectangle& r = boxes[i];
                        const double exact = direct_mean_of(map, r, moment);
                        REQUIRE(std::fabs(exact - mean_of(sums.moments[moment], r)) < 1e-9);
                        const double box_area = static_cast<double>(r[2] - r[0]) * static_cast<double>(r[3] - r[1]);
                        const double bound = mean_bound(map.table(format), sums.magnitudes[moment], box_area, 1.0);
                        const double error = std::fabs(static_cast<double>(means[i][moment]) - exact);
                        worst = std::max(worst, error / bound);
                        if (error > bound)
                            FAIL(fmt::format("[{:a}, {:a}] to [{:a}, {:a}], moment {}: {:a}, exact {:a}", r[0], r[1], r[2],
                                             r[3], moment + 1, means[i][moment], exact));
                    }
                CHECK(worst > 0);
            }
}

TEST_CASE("fixed point with more bits than fit is right for rectangles up to its limit", "[techniques][summed_area]") {
    for (const bool centred : {false, true})
        for (const int bits : {18, 20, 24}) {
            INFO("bits " << bits << " centred " << centred);
            // The largest sums there can be: nothing anywhere.
            MomentMap map = make_map(257, 257, centred);
            const float nothing = centred ? 0.5f : 1.0f;
            for (std::size_t i = 0; i < map.texels.size() / 2; ++i) map.texels[i] = {nothing, nothing * nothing};
            TableDesc desc = map.table(Format::Rg32Uint);
            desc.fraction_bits = bits;
            const MapSums sums(map);
            Device device(load_profile("d3d11"), 2);
            const SummedAreaTable table(device, desc);
            table.build(upload(device, map));
            const float side = largest_side(desc);
            auto boxes = random_rectangles(257, 257, side, 5);
            for (Rectangle& box : boxes) {
                box[2] = std::min(box[2], box[0] + side);
                box[3] = std::min(box[3], box[1] + side);
            }
            boxes[0] = {3.0f, 3.0f, 3.0f + side, 3.0f + side};
            const auto means = means_of(device, table.lookup(), boxes);
            for (std::size_t i = 0; i < boxes.size(); ++i)
                for (std::size_t moment = 0; moment < 2; ++moment) {
                    const double error =
                        std::fabs(static_cast<double>(means[i][moment]) - mean_of(sums.moments[moment], boxes[i]));
                    REQUIRE(error <= mean_bound(desc, 0, 0, 1.0));
                }
        }
}

TEST_CASE("a rectangle of one texel has the moments of the texel", "[techniques][summed_area]") {
    const int size = 100;
    std::vector<Rectangle> texels;
    for (int i = 0; i < kPixels * kPixels; ++i) {
        const auto x = static_cast<float>(i % kPixels * 3);
        const auto y = static_cast<float>(i / kPixels * 3);
        texels.push_back({x, y, x + 1.0f, y + 1.0f});
    }
    for (const bool centred : {false, true})
        for (const Format format : {Format::Rgba32Float, Format::Rg32Uint}) {
            INFO(name_of(format) << " centred " << centred);
            const MomentMap map = make_map(size, size, centred);
            const TableDesc desc = map.table(format);
            Device device(load_profile("d3d11"), 2);
            const SummedAreaTable table(device, desc);
            table.build(upload(device, map));
            const auto means = means_of(device, table.lookup(), texels);
            // What is left of a sum of fine parts; half a step of fixed point, at its end a whole one.
            const double step = format == Format::Rg32Uint
                                    ? std::ldexp(1.0, -exact_fraction_bits(desc))
                                    : size * size * kUnit * 8 / static_cast<double>(table_coding(desc).split.factor);
            const float variance = 1e-4f;
            for (std::size_t i = 0; i < texels.size(); ++i) {
                const auto& texel = map.at(static_cast<int>(texels[i][0]), static_cast<int>(texels[i][1]));
                for (std::size_t moment = 0; moment < 2; ++moment)
                    REQUIRE(std::fabs(static_cast<double>(means[i][moment] - texel[moment])) <= step + 1e-7);
                // And so vsm's visibility with the nearest texel: with s = least variance, d = depth behind the mean, the bound
                // s / (s + d^2) changes by at most 1/4 of the change of s over s, and 0.65 of the change of d over sqrt(s).
                for (const float behind : {0.01f, 0.03f}) {
                    const auto visibility = [&](const std::array<float, 2>& m) {
                        return lane(
                            chebyshev_upper_bound(Moments<Float>{m[0], m[1]}, Float(texel[0] + behind), Float(variance)), 0);
                    };
                    const double of_variance = step + 2 * std::fabs(static_cast<double>(texel[0])) * step + step * step;
                    const double tolerance = of_variance / (4 * static_cast<double>(variance)) + 0.65 * step / 0.01 + 1e-3;
                    REQUIRE(std::fabs(static_cast<double>(visibility(means[i]) - visibility(texel))) <= tolerance);
                }
            }
        }
}

TEST_CASE("what tables lose by their size", "[techniques][summed_area][precision]") {
    constexpr int kSide = 8;  // texels of the squares that are averaged
    struct Kind {
        const char* name;
        Format format;
        bool centred;
        int fraction_bits;
    };
    const std::array kinds{Kind{"float", Format::Rg32Float, false, 0}, Kind{"centred", Format::Rg32Float, true, 0},
                           Kind{"split", Format::Rgba32Float, true, 0}, Kind{"fixed", Format::Rg32Uint, true, 0},
                           Kind{"fixed20", Format::Rg32Uint, true, 20}};
    std::string figures = fmt::format("{:>5} {:>8} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "size", "table", "rms M1", "worst M1",
                                      "bound M1", "worst M2", "worst var");
    for (const int size : {64, 128, 256, 512, 1024, 2048}) {
        std::map<std::string, double> rms;
        for (const Kind& kind : kinds) {
            const MomentMap map = make_map(size, size, kind.centred);
            TableDesc desc = map.table(kind.format);
            desc.fraction_bits = kind.fraction_bits;
            const MapSums sums(map);
            Device device(load_profile("d3d11"), 2);
            const SummedAreaTable table(device, desc);
            table.build(upload(device, map));
            const auto boxes = far_squares(size, kSide, static_cast<std::uint64_t>(size));
            const auto means = means_of(device, table.lookup(), boxes);
            std::array<MeanErrors, 2> errors;
            MeanErrors of_variance;
            for (std::size_t i = 0; i < boxes.size(); ++i) {
                const std::array exact{mean_of(sums.moments[0], boxes[i]), mean_of(sums.moments[1], boxes[i])};
                const std::array found{static_cast<double>(means[i][0]), static_cast<double>(means[i][1])};
                for (std::size_t moment = 0; moment < 2; ++moment) errors[moment].add(found[moment] - exact[moment]);
                of_variance.add((found[1] - found[0] * found[0]) - (exact[1] - exact[0] * exact[0]));
            }
            const double bound = mean_bound(desc, sums.magnitudes[0], kSide * kSide, 1.0);
            figures += fmt::format("{:>5} {:>8} {:>10.2e} {:>10.2e} {:>10.2e} {:>10.2e} {:>10.2e}\n", size, kind.name,
                                   errors[0].rms(), errors[0].worst, bound, errors[1].worst, of_variance.worst);
            INFO(figures);
            CHECK(errors[0].worst <= bound);
            CHECK(errors[1].worst <= mean_bound(desc, sums.magnitudes[1], kSide * kSide, 1.0));
            rms[kind.name] = of_variance.rms();
        }
        if (size == 1024) {
            INFO(figures);
            CHECK(rms.at("centred") < 0.5 * rms.at("float"));
            CHECK(rms.at("split") < 0.1 * rms.at("centred"));
            CHECK(rms.at("fixed") < rms.at("float"));
            CHECK(rms.at("fixed20") < 0.1 * rms.at("fixed"));
        }
    }
    WARN(figures);
}
