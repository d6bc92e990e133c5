#include "studies/filter_charts.h"

#include "sim/denormals.h"
#include "sim/scalar_math.h"
#include "texunit/instruction.h"
#include "texunit/mipmap.h"
#include "texunit/upload.h"

#include <algorithm>
#include <atomic>

namespace gnomon::studies {

namespace {

constexpr int kTextureSide = 256;
constexpr int kSquareSide = 16;  // texels
constexpr int kSectors = 24;
constexpr int kTunnelTurns = 4;  // repeats of the texture around the tunnel, and per circumference along it

/// Nearest that a pixel comes to the horizon, or to the end of the tunnel, pixels: where neighbours of a patch's own pixels lie
/// beyond it.
constexpr double kNearestHorizon = 1.0 / 16.0;

/// Position of a pixel's centre from the axis of view, pixels; y points down.
glm::dvec2 from_center(const ChartView& view, int x, int y) {
    return {x + 0.5 - 0.5 * view.width, y + 0.5 - 0.5 * view.height};
}

/// Angle of a vector from the x axis, -pi to pi.
double angle_of(const glm::dvec2& v) {
    if (v.x == 0.0 && v.y == 0.0) return 0.0;
    const double x = v.x < 0.0 ? -v.x : v.x;
    const double y = v.y < 0.0 ? -v.y : v.y;
    const double first = y <= x ? scalar::atan(y / x) : 0.5 * scalar::kPi - scalar::atan(x / y);
    const double upper = v.x < 0.0 ? scalar::kPi - first : first;
    return v.y < 0.0 ? -upper : upper;
}

/// A vector in axes that are turned by an angle.
glm::dvec2 turned(const glm::dvec2& v, double angle) {
    const auto [s, c] = scalar::sincos(angle);
    return {v.x * c + v.y * s, v.y * c - v.x * s};
}

/// First row below the horizon: even, so that no quad lies across.
int horizon_row(const ChartView& view) { return view.height / 4 / 2 * 2; }

/// Ground seen from one texture's side above it with a focal length in pixels: `below` and `across` are the pixel's distances
/// from the horizon and from the middle.
glm::dvec2 ground(double across, double below, double focal_px) {
    const double depth = focal_px / std::max(below, kNearestHorizon);
    return {across * depth / focal_px, depth};
}

/// Tunnel and disc fit the shorter side of the picture.
double short_side(const ChartView& view) { return std::min(view.width, view.height); }

/// The tunnel's patches are its right and its left half, each with the seam of its angles in the other.
double tunnel_axis(int patch) { return patch == 0 ? 0.0 : scalar::kPi; }
double sector_axis(int patch) { return 2.0 * scalar::kPi * patch / kSectors; }

glm::dvec2 tunnel_coordinate(const ChartView& view, int patch, const glm::dvec2& center_px) {
    const glm::dvec2 t = turned(center_px, tunnel_axis(patch));
    const double radius_px = std::sqrt(t.x * t.x + t.y * t.y);
    const double angle = tunnel_axis(patch) + angle_of(t);
    const double depth = short_side(view) / std::max(radius_px, kNearestHorizon);  // in radii of the tunnel
    return {kTunnelTurns * angle / (2.0 * scalar::kPi), kTunnelTurns * depth / (2.0 * scalar::kPi)};
}

std::vector<glm::vec4> checkerboard() {
    std::vector<glm::vec4> texels;
    for (int y = 0; y < kTextureSide; ++y)
        for (int x = 0; x < kTextureSide; ++x) {
            const float value = (x / kSquareSide + y / kSquareSide) % 2 == 0 ? 1.0f : 0.0f;
            texels.emplace_back(value, value, value, 1.0f);
        }
    return texels;
}

std::vector<glm::vec4> level_colors(int level) {
    const auto side = static_cast<std::size_t>(level_size(kTextureSide, level));
    const Rgb& color = kLevelColors[static_cast<std::size_t>(level)];
    const auto number = [](std::uint8_t code) { return static_cast<float>(code) / 255.0f; };
    return std::vector<glm::vec4>(side * side, {number(color[0]), number(color[1]), number(color[2]), 1.0f});
}

/// 0 to 1 as 0 to 255, to nearest, clamped; NaN is 0.
std::uint8_t code_of(double value) {
    const double clamped = value > 0.0 ? std::min(value, 1.0) : 0.0;
    return static_cast<std::uint8_t>(clamped * 255.0 + 0.5);
}

/// Counts the texels that each lane reads.
class TexelCounter {
public:
    static constexpr bool kWatches = true;

    template <class Real>
    void begin(const LevelOfDetail<Real>&, const LevelPair<Real>&) {}
    template <class Real>
    void begin_probe(const Vec2<Real>&, const Real&, Mask lanes) {
        probe_lanes_ = lanes.bits();
    }
    template <class Real>
    void begin_level(Int, const Real&, Mask lanes) {
        level_lanes_ = lanes.bits() & probe_lanes_;
    }
    template <class Real, class AnyTexels, class Result>
    void footprint(const Footprint<Real>& f, const AnyTexels&, const Result&) {
        add(level_lanes_, f.linear ? 4 : 1);
    }
    template <class Real, class Texel>
    void ellipse_texel(Int, Mask, const Texel&, const Real&, Mask inside) {
        add(level_lanes_ & inside.bits(), 1);
    }
    template <class Result, class Real>
    void end_ellipse(const Result&, const Real&) {}
    template <class Result>
    void end_probe(const Result&) {}

    [[nodiscard]] const std::array<std::int32_t, kLanes>& texels() const { return texels_; }

private:
    void add(std::uint32_t lanes, std::int32_t count) {
        for (std::size_t i = 0; i < texels_.size(); ++i) texels_[i] += (lanes >> i & 1u) != 0 ? count : 0;
    }

    std::array<std::int32_t, kLanes> texels_{};
    std::uint32_t probe_lanes_ = 0;
    std::uint32_t level_lanes_ = 0;
};

/// The pixels of one wave: quads side by side.
struct WavePixels {
    std::array<int, kLanes> x{};
    std::array<int, kLanes> y{};
    std::array<int, kLanes> patch{};
    std::uint32_t covered = 0;  // in the picture and not background
};

WavePixels wave_pixels(const ChartView& view, int first_x, int first_y) {
    WavePixels wave;
    for (std::size_t i = 0; i < wave.x.size(); ++i) {
        const int lane_of = static_cast<int>(i);
        wave.x[i] = first_x + lane_of / 4 * 2 + lane_of % 2;
        wave.y[i] = first_y + lane_of % 4 / 2;
        const bool inside = wave.x[i] < view.width && wave.y[i] < view.height;
        wave.patch[i] = inside ? chart_patch(view, wave.x[i], wave.y[i]) : kNoPatch;
        if (wave.patch[i] != kNoPatch) wave.covered |= 1u << i;
    }
    return wave;
}

/// For every quad the patch of its first pixel that is left; 0 where none is.
std::array<int, kLanes> next_patches(const WavePixels& wave, std::uint32_t left) {
    std::array<int, kLanes> drawn{};
    for (std::size_t quad = 0; quad < drawn.size(); quad += 4) {
        const std::uint32_t lanes = left >> quad & 0xfu;
        if (lanes == 0) continue;
        const int patch = wave.patch[quad + static_cast<std::size_t>(std::countr_zero(lanes))];
        std::fill_n(drawn.begin() + static_cast<std::ptrdiff_t>(quad), 4, patch);
    }
    return drawn;
}

/// What one wave of samples gave.
template <class Real>
struct WaveResult {
    std::array<std::array<typename Real::Scalar, kLanes>, 3> color;
    std::array<typename Real::Scalar, kLanes> clamped_lod;
    std::array<std::int32_t, kLanes> amount;  // probes or texels
};

class ChartPainter {
public:
    ChartPainter(const ChartView& view, const Texture& texture, const Sampler& sampler, const Profile& profile)
        : view_(view),
          texture_(texture),
          sampler_(effective_sampler(sampler, texture.info(), profile)),
          profile_(profile),
          elliptical_(is_elliptical(sampler_, profile)) {
        for (ByteImage* image : {&chart_.picture, &chart_.lod, &chart_.probes}) {
            *image = {.width = view.width, .height = view.height, .channels = 3, .values = {}};
            const std::size_t pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
            image->values.reserve(3 * pixels);
            for (std::size_t i = 0; i < pixels; ++i)
                image->values.insert(image->values.end(), kBackground.begin(), kBackground.end());
        }
    }

    /// Two rows of pixels.
    template <class Real>
    void paint_quads(int first_y) {
        for (int x = 0; x < view_.width; x += kLanes / 2) paint_wave<Real>(wave_pixels(view_, x, first_y));
    }

    Chart take() { return std::move(chart_); }

private:
    template <class Real>
    void paint_wave(const WavePixels& wave) {
        for (std::uint32_t left = wave.covered; left != 0;) {
            const std::array<int, kLanes> patch = next_patches(wave, left);
            const WaveResult<Real> result = sample_wave<Real>(wave, patch);
            for (std::size_t i = 0; i < patch.size(); ++i) {
                if ((left >> i & 1u) == 0 || wave.patch[i] != patch[i]) continue;
                store(wave.x[i], wave.y[i], result, i);
                left &= ~(1u << i);
            }
        }
    }

    template <class Real>
    WaveResult<Real> sample_wave(const WavePixels& wave, const std::array<int, kLanes>& patch) const {
        // Coordinates in the profile's arithmetic, and what their differences across the quad make of them.
        std::array<typename Real::Scalar, kLanes> u;
        std::array<typename Real::Scalar, kLanes> v;
        for (std::size_t i = 0; i < u.size(); ++i) {
            const glm::dvec2 at = chart_coordinate(view_, patch[i], wave.x[i], wave.y[i]);
            u[i] = static_cast<typename Real::Scalar>(at.x);
            v[i] = static_cast<typename Real::Scalar>(at.y);
        }
        const Vec2<Real> uv{Real::load(u.data()), Real::load(v.data())};
        const LevelOfDetail<Real> lod = level_of_detail(quad_gradients(uv, profile_), texture_, sampler_, profile_);
        const LevelPair<Real> pair = select_levels(lod.lod, Real(0.0f), sampler_, texture_, profile_);

        // The sample; an ellipse is counted while it is walked.
        TexelCounter counter;
        const Vec4<Real> color = elliptical_
                                     ? sample_observed<4>(texture_, sampler_, profile_, Vec3<Real>{uv.x, uv.y, Real(0.0f)}, lod,
                                                          SampleOperands<Real>{}, counter)
                                     : sample(texture_, sampler_, profile_, uv, lod);
        return {.color = {color.x.lanes(), color.y.lanes(), color.z.lanes()},
                .clamped_lod = pair.clamped.lanes(),
                .amount = elliptical_ ? counter.texels() : lod.probes.lanes()};
    }

    template <class Real>
    void store(int x, int y, const WaveResult<Real>& result, std::size_t lane_of) {
        const auto& [red, green, blue] = result.color;
        const auto number = [&](const auto& lanes) { return static_cast<double>(lanes[lane_of]); };
        put(chart_.picture, x, y, {code_of(number(red)), code_of(number(green)), code_of(number(blue))});
        put(chart_.lod, x, y, lod_color(number(result.clamped_lod)));
        const int amount = result.amount[lane_of];
        put(chart_.probes, x, y, amount_color(elliptical_ ? texel_step(amount) : probe_step(amount)));
    }

    static void put(ByteImage& image, int x, int y, const Rgb& color) {
        const std::size_t pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
        std::ranges::copy(color, image.values.begin() + static_cast<std::ptrdiff_t>(3 * pixel));
    }

    const ChartView& view_;
    const TextureView texture_;
    const Sampler sampler_;
    const Profile& profile_;
    const bool elliptical_;
    Chart chart_;
};

}  // namespace

int chart_patch(const ChartView& view, int x, int y) {
    const glm::dvec2 center_px = from_center(view, x, y);
    switch (view.scene) {
        case ChartScene::Plane: return y < horizon_row(view) ? kNoPatch : 0;
        case ChartScene::Tunnel: return center_px.x >= 0.0 ? 0 : 1;
        case ChartScene::Angles: {
            const double radius_px = 0.5 * short_side(view);
            if (center_px.x * center_px.x + center_px.y * center_px.y > radius_px * radius_px) return kNoPatch;
            const double turn = angle_of(center_px) / (2.0 * scalar::kPi);
            return (static_cast<int>(std::floor(turn * kSectors + 0.5)) + kSectors) % kSectors;
        }
    }
    __builtin_unreachable();
}

glm::dvec2 chart_coordinate(const ChartView& view, int patch, int x, int y) {
    const glm::dvec2 center_px = from_center(view, x, y);
    switch (view.scene) {
        case ChartScene::Plane: return ground(center_px.x, y + 0.5 - horizon_row(view), view.width);
        case ChartScene::Tunnel: return tunnel_coordinate(view, patch, center_px);
        case ChartScene::Angles: {
            const glm::dvec2 t = turned(center_px, sector_axis(patch));
            return ground(t.y, t.x, short_side(view));
        }
    }
    __builtin_unreachable();
}

Texture chart_texture(ChartScene scene, Format format, const Profile& profile, Workers& workers) {
    if (format_info(format).is_integer()) fail("--format {}: holds integers, which filters do not read", name_of(format));
    const int levels = full_level_count(kTextureSide, kTextureSide);
    GNOMON_CHECK_EQ(static_cast<std::size_t>(levels), kLevelColors.size());
    Texture texture({.format = format, .width = kTextureSide, .height = kTextureSide, .levels = levels});
    if (scene == ChartScene::Tunnel) {
        for (int level = 0; level < levels; ++level)
            set_level_colors(texture, level, level_colors(level), profile.float_narrowing);
    } else {
        set_level_colors(texture, 0, checkerboard(), profile.float_narrowing);
        generate_mips(texture, profile, workers);
    }
    return texture;
}

Sampler chart_sampler(ChartFilter filter, int max_anisotropy) {
    Sampler sampler{.address_u = AddressMode::Wrap, .address_v = AddressMode::Wrap};
    switch (filter) {
        case ChartFilter::Nearest:
            sampler.min = sampler.mag = TexelFilter::Nearest;
            sampler.mip = MipFilter::Nearest;
            return sampler;
        case ChartFilter::Bilinear: return sampler;
        case ChartFilter::Trilinear: sampler.mip = MipFilter::Linear; return sampler;
        case ChartFilter::Aniso:
            sampler.mip = MipFilter::Linear;
            sampler.max_anisotropy = max_anisotropy;
            return sampler;
    }
    __builtin_unreachable();
}

bool is_elliptical(const Sampler& sampler, const Profile& profile) {
    if (sampler.max_anisotropy <= 1) return false;
    switch (profile.aniso_rule) {
        case AnisoRule::Llvmpipe: return true;
        case AnisoRule::SwiftShader: return false;
        case AnisoRule::D3d11:
        case AnisoRule::OpenGl:
        case AnisoRule::Vulkan: return profile.probe_placement == ProbePlacement::Ewa;
    }
    __builtin_unreachable();
}

Chart draw_chart(const ChartView& view, const Texture& texture, const Sampler& sampler, const Profile& profile,
                 Workers& workers, const Progress& progress) {
    ChartPainter painter(view, texture, sampler, profile);
    const auto rows = static_cast<std::size_t>(view.height + 1) / 2;
    std::atomic<std::size_t> done{0};
    workers.for_each(rows, [&](std::size_t row) {
        progress.step(name_of(view.scene), done.fetch_add(1, std::memory_order_relaxed), rows);
        const DenormalScope denormals(profile.flush_denormals);
        const int first_y = 2 * static_cast<int>(row);
        switch (profile.arithmetic) {
            case Arithmetic::Fp32: painter.paint_quads<Float>(first_y); return;
            case Arithmetic::Fp64: painter.paint_quads<Double>(first_y); return;
        }
    });
    return painter.take();
}

Rgb lod_color(double clamped_lod) {
    if (clamped_lod <= 0.0) return kMagnified;
    constexpr auto kLast = static_cast<double>(kLevelColors.size() - 1);
    const double limited = clamped_lod < kLast ? clamped_lod : kLast;
    const auto finer = static_cast<std::size_t>(limited);
    const Rgb& from = kLevelColors[finer];
    const Rgb& to = kLevelColors[std::min(finer + 1, kLevelColors.size() - 1)];
    const double share = limited - static_cast<double>(finer);
    Rgb color{};
    for (std::size_t i = 0; i < color.size(); ++i)
        color[i] = static_cast<std::uint8_t>(from[i] + (to[i] - from[i]) * share + 0.5);
    return color;
}

Rgb amount_color(int step) {
    static constexpr std::array<Rgb, kAmountSteps> kColors{
        Rgb{68, 1, 84},    Rgb{72, 26, 108},  Rgb{71, 47, 125},  Rgb{65, 68, 135},  Rgb{57, 86, 140},  Rgb{49, 104, 142},
        Rgb{42, 120, 142}, Rgb{35, 136, 142}, Rgb{31, 152, 139}, Rgb{34, 168, 132}, Rgb{53, 183, 121}, Rgb{84, 197, 104},
        Rgb{122, 209, 81}, Rgb{165, 219, 54}, Rgb{210, 226, 27}, Rgb{253, 231, 37}};
    return kColors[static_cast<std::size_t>(std::clamp(step, 0, kAmountSteps - 1))];
}

int probe_step(int probes) { return std::clamp(probes, 1, kAmountSteps) - 1; }

int texel_limit(int step) { return (step % 2 == 0 ? 4 : 6) << (step / 2); }

int texel_step(int texels) {
    int step = 0;
    while (step < kAmountSteps - 1 && texels > texel_limit(step)) ++step;
    return step;
}

}  // namespace gnomon::studies
