// The texture unit against the oracle on random textures, samplers, profiles and coordinates. D3D11.3 7.18, 22.4
//
// A case is one texture, view, sampler and profile with 64 samples; its index is its seed. GNOMON_ORACLE_CASE=index runs one.
#include "sim/denormals.h"
#include "tests/oracle/random.h"
#include "tests/oracle/sampler.h"
#include "tests/oracle/texel.h"
#include "texunit/record.h"
#include "texunit/sample.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

using namespace gnomon;

namespace {

using oracle::Contents;
using oracle::Kind;
using oracle::Question;
using oracle::Random;

constexpr std::size_t kSamplesPerCase = 64;

template <class T, std::size_t N>
const T& one_of(Random& random, const std::array<T, N>& list) {
    return list[static_cast<std::size_t>(random.integer(0, static_cast<int>(N) - 1))];
}

// --- What is sampled ------------------------------------------------------------------------------------------------------

/// Bits of one component as the contents have it.
int code_bits(const FormatInfo& info, int component) {
    switch (info.type) {
        case ComponentType::Float11: return component == 2 ? 10 : 11;
        case ComponentType::Unorm8:
        case ComponentType::Snorm8:
        case ComponentType::Srgb8: return 8;
        case ComponentType::Unorm16:
        case ComponentType::Snorm16:
        case ComponentType::Float16:
        case ComponentType::Depth16: return 16;
        case ComponentType::Depth24: return 24;
        case ComponentType::Float32:
        case ComponentType::Uint32:
        case ComponentType::Depth32: return 32;
    }
    return 0;
}

/// What kind of texels a texture has.
enum class Palette { Ordinary, Extremes, Anything };

std::uint32_t random_code(Random& random, const FormatInfo& info, int component, Palette palette) {
    const std::uint32_t any = random.bits() >> (32 - code_bits(info, component));
    switch (info.type) {
        case ComponentType::Depth32:
            return std::bit_cast<std::uint32_t>(palette == Palette::Extremes && random.chance(2) ? 1.0f : random.unit());
        case ComponentType::Float32:
            if (palette == Palette::Anything) return any;
            if (palette == Palette::Extremes)
                return one_of(random, std::array{0x00000000u, 0x80000000u, 0x00000001u, 0x807fffffu, 0x7f7fffffu, 0xff7fffffu,
                                                 0x7f800000u, 0x3f800000u, 0x00800000u, 0x3f800001u});
            return std::bit_cast<std::uint32_t>(random.in(-2.0f, 2.0f));
        case ComponentType::Float16:
            if (palette == Palette::Anything) return any;
            if (palette == Palette::Extremes)
                return one_of(random,
                              std::array{0x0000u, 0x8000u, 0x0001u, 0x83ffu, 0x7bffu, 0xfbffu, 0x7c00u, 0x3c00u, 0x3c01u});
            return (any & 0x83ffu) | static_cast<std::uint32_t>(random.integer(8, 18)) << 10;
        case ComponentType::Float11: {
            const int mantissa = component == 2 ? 5 : 6;
            if (palette == Palette::Anything) return any;
            return (any & ((1u << mantissa) - 1u)) |
                   static_cast<std::uint32_t>(random.integer(palette == Palette::Extremes ? 0 : 8, 18)) << mantissa;
        }
        case ComponentType::Unorm8:
        case ComponentType::Snorm8:
        case ComponentType::Srgb8:
        case ComponentType::Unorm16:
        case ComponentType::Snorm16:
        case ComponentType::Uint32:
        case ComponentType::Depth16:
        case ComponentType::Depth24: {
            const std::uint32_t last = 0xffffffffu >> (32 - code_bits(info, component));
            if (palette == Palette::Extremes) return one_of(random, std::array{0u, 1u, last, last - 1, last / 2, last / 2 + 1});
            return any;
        }
    }
    return 0;
}

Contents random_contents(Random& random) {
    Contents contents;
    contents.format = one_of(random, kFormats).format;
    contents.kind = one_of(random, std::array{Kind::Flat, Kind::Flat, Kind::Array, Kind::Cube});
    const auto side = [&] {
        return random.chance(12) ? random.integer(17, 64) : one_of(random, std::array{1, 2, 3, 4, 5, 7, 8, 13, 16});
    };
    contents.width = side();
    contents.height = random.chance(2) ? contents.width : side();
    if (random.chance(60)) {
        contents.width = 4096;
        contents.height = 2;
    }
    if (contents.kind == Kind::Cube) {
        contents.width = std::min(contents.width, 16);
        contents.height = contents.width;
    }
    contents.layers = contents.kind == Kind::Cube ? 6 : contents.kind == Kind::Array ? 3 : 1;
    const int full = full_level_count(contents.width, contents.height);
    contents.levels = random.chance(3) ? random.integer(1, full) : full;

    // One value for the whole texture, or one per level, tells levels apart and finds filters that do not keep constants.
    const FormatInfo& info = format_info(contents.format);
    const Palette palette = one_of(random, std::array{Palette::Ordinary, Palette::Ordinary, Palette::Ordinary,
                                                      Palette::Ordinary, Palette::Extremes, Palette::Anything});
    const bool constant = random.chance(12);
    for (int level = 0; level < contents.levels; ++level) {
        for (int layer = 0; layer < contents.layers; ++layer) {
            const int texels = contents.width_of(level) * contents.height_of(level);
            std::vector<std::uint32_t> image;
            image.reserve(static_cast<std::size_t>(texels * info.components));
            for (int i = 0; i < texels; ++i)
                for (int c = 0; c < info.components; ++c) {
                    const auto above = static_cast<std::size_t>(c);
                    image.push_back(constant && i > 0 ? image[above] : random_code(random, info, c, palette));
                }
            contents.codes.push_back(std::move(image));
        }
    }
    return contents;
}

/// The bytes of one level as the texture stores them.
std::vector<std::byte> stored_bytes(const FormatInfo& info, const std::vector<std::uint32_t>& codes) {
    std::vector<std::byte> bytes;
    const auto put = [&](std::uint32_t value, int count) {
        for (int i = 0; i < count; ++i) bytes.push_back(static_cast<std::byte>(value >> 8 * i & 255u));
    };
    if (info.type == ComponentType::Float11) {
        for (std::size_t i = 0; i < codes.size(); i += 3) put(codes[i] | codes[i + 1] << 11 | codes[i + 2] << 22, 4);
        return bytes;
    }
    for (const std::uint32_t code : codes) put(code, info.bytes_per_texel / info.components);
    return bytes;
}

Texture texture_of(const Contents& contents) {
    const TextureKind kind = contents.kind == Kind::Flat    ? TextureKind::Flat
                             : contents.kind == Kind::Array ? TextureKind::Array
                                                            : TextureKind::Cube;
    Texture texture(TextureDesc{.format = contents.format,
                                .width = contents.width,
                                .height = contents.height,
                                .levels = contents.levels,
                                .kind = kind,
                                .layers = contents.layers});
    for (int level = 0; level < contents.levels; ++level)
        for (int layer = 0; layer < contents.layers; ++layer) {
            const auto& codes = contents.codes[static_cast<std::size_t>(level * contents.layers + layer)];
            const auto bytes = stored_bytes(texture.info(), codes);
            texture.set_level_bytes(level, bytes.data(), bytes.size(), layer);
        }
    return texture;
}

// --- How ------------------------------------------------------------------------------------------------------------------

Profile random_profile(Random& random) {
    const auto preset = [](std::string_view name) {
        for (const Profile& p : profile_presets())
            if (p.name == name) return p;
        return Profile{};
    };
    Profile p =
        preset(one_of(random, std::array<std::string_view, 7>{"d3d11", "d3d11", "d3d11", "d3d10", "nv40", "g80", "ideal"}));
    if (p.probe_placement == ProbePlacement::Ewa) p.probe_placement = ProbePlacement::Centred;
    if (random.chance(2)) return p;

    // Half of the profiles differ from their preset in some choices.
    const auto maybe = [&](auto& field, const auto& list) {
        if (random.chance(5)) field = one_of(random, list);
    };
    maybe(p.texel_fraction_bits, std::array{1, 2, 4, 5, 7, 8});
    maybe(p.texel_rounding, std::array{FixedRounding::NearestEven, FixedRounding::Truncate});
    maybe(p.texel_carry, std::array{TexelCarry::Texel, TexelCarry::Weight});
    maybe(p.bilinear_form,
          std::array{BilinearForm::Lerp, BilinearForm::Products, BilinearForm::PlainLerp, BilinearForm::FusedLerp});
    maybe(p.filters_float32, std::array{true, false});
    maybe(p.border_precision, std::array{BorderPrecision::Float, BorderPrecision::Unorm8});
    maybe(p.compare_reference, std::array{CompareReference::Quantised, CompareReference::Raw});
    maybe(p.cube_edges, std::array{CubeEdges::Seamless, CubeEdges::PerFace});
    maybe(p.cube_corner, std::array{CubeCorner::ThreeTexels, CubeCorner::TwoAdjacent});
    maybe(p.lod_rule, std::array{LodRule::Longest, LodRule::Box, LodRule::Area});
    maybe(p.lod_fraction_bits, std::array{1, 3, 6, 8});
    maybe(p.lod_rounding, std::array{FixedRounding::NearestEven, FixedRounding::Truncate});
    maybe(p.mip_tie, std::array{MipTie::Up, MipTie::Down, MipTie::Even});
    maybe(p.aniso_rule, std::array{AnisoRule::D3d11, AnisoRule::OpenGl, AnisoRule::Vulkan});
    maybe(p.ellipse_transform, std::array{true, false});
    maybe(p.aniso_clamps_to_top, std::array{true, false});
    maybe(p.probe_count, std::array{ProbeCount::Ceil, ProbeCount::Round, ProbeCount::Steps});
    maybe(p.probe_placement, std::array{ProbePlacement::Interior, ProbePlacement::Centred});
    maybe(p.aniso_limits, std::array{AnisoLimits::Any, AnisoLimits::Steps});
    if (p.arithmetic == Arithmetic::Fp32) maybe(p.flush_denormals, std::array{true, false});
    p.name += "*";
    return p;
}

Sampler random_sampler(Random& random, const Contents& contents, bool compares) {
    constexpr std::array kModes{AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp, AddressMode::Border,
                                AddressMode::MirrorOnce};
    const bool integer = format_info(contents.format).is_integer();
    Sampler s;
    const auto filter = [&] { return integer || random.chance(3) ? TexelFilter::Nearest : TexelFilter::Linear; };
    s.min = filter();
    s.mag = filter();
    s.mip = one_of(random, std::array{MipFilter::Base, MipFilter::Nearest, MipFilter::Linear});
    if (integer && s.mip == MipFilter::Linear) s.mip = MipFilter::Nearest;
    s.address_u = one_of(random, kModes);
    s.address_v = one_of(random, kModes);
    if (integer && s.address_u == AddressMode::Border) s.address_u = AddressMode::Wrap;
    if (integer && s.address_v == AddressMode::Border) s.address_v = AddressMode::Mirror;
    if (!integer && random.chance(2)) s.max_anisotropy = random.integer(2, 16);
    if (!integer && !compares && random.chance(6)) s.reduction = random.chance(2) ? Reduction::Minimum : Reduction::Maximum;
    s.compare = static_cast<CompareOp>(random.integer(0, 7));
    const float last = static_cast<float>(contents.levels - 1);
    if (random.chance(3)) s.lod_bias = one_of(random, std::array{-16.0f, 15.99f, 0.5f, random.in(-2.0f, 2.0f)});
    if (random.chance(3)) s.min_lod = one_of(random, std::array{-1000.0f, 0.25f, last, random.in(-1.0f, last)});
    if (random.chance(3)) s.max_lod = one_of(random, std::array{0.0f, 0.75f, last, random.in(-1.0f, last)});
    for (int c = 0; c < 4; ++c) s.border[c] = one_of(random, std::array{0.0f, 1.0f, random.in(-2.0f, 2.0f), random.unit()});
    return s;
}

float ulps_from(Random& random, float x) {
    for (int i = random.integer(-2, 2); i != 0; i += i > 0 ? -1 : 1) x = std::nextafter(x, i > 0 ? HUGE_VALF : -HUGE_VALF);
    return x;
}

/// A number that tends to break things.
float odd_float(Random& random) {
    return one_of(random, std::array{0.0f,
                                     -0.0f,
                                     1e-40f,
                                     -1e-40f,
                                     0x1p-126f,
                                     -1e-10f,
                                     1e-10f,
                                     -0x1p-25f,
                                     1.0f,
                                     std::nextafter(1.0f, 0.0f),
                                     -1.0f,
                                     10.0f,
                                     -10.0f,
                                     9.99f,
                                     -10.5f,
                                     2.0f,
                                     0.5f,
                                     1e30f,
                                     -1e30f,
                                     16777216.0f,
                                     8388607.5f,
                                     HUGE_VALF,
                                     -HUGE_VALF,
                                     std::numeric_limits<float>::quiet_NaN(),
                                     random.any_float()});
}

/// A normalised coordinate along an axis of `size` texels.
float random_coordinate(Random& random, int size) {
    const auto n = static_cast<float>(size);
    const auto texel = static_cast<float>(random.integer(-2 * size - 9, 3 * size + 9));
    switch (random.integer(0, 9)) {
        case 0:
        case 1:
        case 2: return random.unit();
        case 3:
        case 4: return random.in(-2.5f, 3.5f);
        case 5: return ulps_from(random, (texel + 0.5f) / n);
        case 6: return ulps_from(random, texel / n);
        case 7: return ulps_from(random, (texel + static_cast<float>(random.integer(0, 512)) / 512.0f) / n);
        case 8: return random.in(-1.0f, 1.0f) * std::ldexp(1.0f, random.integer(-30, 30));
        default: return random.chance(3) ? odd_float(random) : random.unit();
    }
}

std::array<double, 3> random_direction(Random& random, int size) {
    std::array<float, 3> d{random.in(-1.0f, 1.0f), random.in(-1.0f, 1.0f), random.in(-1.0f, 1.0f)};
    const auto at = static_cast<std::size_t>(random.integer(0, 2));
    const auto other = (at + static_cast<std::size_t>(random.integer(1, 2))) % 3;
    switch (random.integer(0, 7)) {
        case 0:
        case 1: break;
        case 2: d[at] = d[other] * (random.chance(2) ? 1.0f : -1.0f); break;  // an edge
        case 3: d = {random.chance(2) ? 1.0f : -1.0f, random.chance(2) ? 1.0f : -1.0f, random.chance(2) ? 1.0f : -1.0f}; break;
        case 4:
            d[at] = ulps_from(random, random.chance(2) ? 1.0f : -1.0f);
            d[other] = ulps_from(random, 1.0f);
            break;
        case 5: {  // texel centres and borders
            const auto texel = [&] {
                return (static_cast<float>(random.integer(0, 2 * size)) / static_cast<float>(size)) - 1.0f;
            };
            d = {ulps_from(random, texel()), ulps_from(random, texel()), ulps_from(random, texel())};
            d[at] = random.chance(2) ? 1.0f : -1.0f;
            break;
        }
        case 6: d[at] = random.chance(2) ? 0.0f : random.in(-1e-3f, 1e-3f); break;
        default:
            if (random.chance(4)) d[at] = odd_float(random);
    }
    const float scale = random.chance(3) ? std::ldexp(1.0f, random.integer(-20, 20)) : 1.0f;
    return {static_cast<double>(d[0] * scale), static_cast<double>(d[1] * scale), static_cast<double>(d[2] * scale)};
}

/// Derivatives of about 2^-4 to 2^8 texels, in relations that have rules of their own, and worse.
Question::Gradient random_gradient(Random& random, const Contents& contents, int base, double unit) {
    const double w = contents.width_of(base);
    const double h = contents.height_of(base);
    const auto length = [&] { return std::ldexp(1.0 + static_cast<double>(random.unit()), random.integer(-5, 8)); };
    const double x = length();
    const double y = random.chance(2) ? x * std::ldexp(1.0, random.integer(-4, 4)) : length();
    const double angle = static_cast<double>(random.in(0.0f, 6.2831853f));
    const double turn = static_cast<double>(random.in(0.0f, 6.2831853f));
    std::array<double, 3> dx{x * std::cos(angle), x * std::sin(angle), static_cast<double>(random.in(-1.0f, 1.0f)) * x};
    std::array<double, 3> dy{y * std::cos(turn), y * std::sin(turn), static_cast<double>(random.in(-1.0f, 1.0f)) * y};
    const auto along = [&](double by) { return std::array{y * std::cos(angle + by), y * std::sin(angle + by), dy[2]}; };
    switch (random.integer(0, 15)) {
        case 0: dx = {}; break;
        case 1: dy = {}; break;
        case 2: dx = dy = {}; break;
        case 3:
            dx = {x, 0, 0};
            dy = {0, y, 0};
            break;
        case 4:
            dx = {0, x, 0};
            dy = {y, 0, 0};
            break;
        case 5: dy = along(0); break;
        case 6: dy = along(1.57079632679); break;
        case 7: dy = along(static_cast<double>(random.in(-1e-3f, 1e-3f))); break;
        case 8: dy = {dx[0], dx[1], dx[2]}; break;
        case 9: dx[0] = 0; break;
        case 10:
            dx = {std::ldexp(1.0, random.integer(-3, 7)), 0, 0};
            dy = {0, std::ldexp(1.0, random.integer(-3, 7)), 0};
            break;
        default: break;
    }
    Question::Gradient g;
    for (std::size_t i = 0; i < 3; ++i) {
        const double size = i == 1 ? h : w;
        g.dx[i] = static_cast<double>(static_cast<float>(dx[i] / size * unit));
        g.dy[i] = static_cast<double>(static_cast<float>(dy[i] / size * unit));
    }
    if (random.chance(12)) {
        const double scale = std::ldexp(1.0, random.integer(-140, 120));
        for (std::size_t i = 0; i < 3; ++i) {
            g.dx[i] = static_cast<double>(static_cast<float>(g.dx[i] * scale));
            g.dy[i] = static_cast<double>(static_cast<float>(g.dy[i] * scale));
        }
    }
    if (random.chance(40))
        (random.chance(2) ? g.dx : g.dy)[static_cast<std::size_t>(random.integer(0, 2))] =
            static_cast<double>(odd_float(random));
    return g;
}

Question random_question(Random& random, const Contents& contents, const oracle::Levels& view, bool compares, bool fp64) {
    Question q;
    const int level = random.integer(0, contents.levels - 1);
    double unit = 1;
    if (contents.kind == Kind::Cube) {
        q.coordinate = random_direction(random, contents.width_of(level));
        // One texel is 2 / size of the major axis.
        double major = 0;
        for (const double d : q.coordinate) major = std::fmax(major, std::fabs(d));
        unit = std::isfinite(major) ? 2 * major : 2;
    } else {
        q.coordinate[0] = static_cast<double>(random_coordinate(random, contents.width_of(level)));
        q.coordinate[1] = static_cast<double>(random_coordinate(random, contents.height_of(level)));
        q.coordinate[2] = static_cast<double>(
            random.chance(8) ? odd_float(random) : 0.25f * static_cast<float>(random.integer(-6, 4 * contents.layers + 6)));
        if (random.chance(4)) q.offset = {random.integer(-8, 7), random.integer(-8, 7)};
    }
    if (fp64 && random.chance(2)) q.coordinate[0] += 1e-10 * static_cast<double>(random.unit());
    if (random.chance(3)) {
        const float last = static_cast<float>(contents.levels);
        q.lod = static_cast<double>(
            one_of(random, std::array{random.in(-2.0f, last), 0.0f, static_cast<float>(random.integer(-300, 2000)) / 512.0f,
                                      ulps_from(random, static_cast<float>(random.integer(-300, 2000)) / 512.0f)}));
        if (random.chance(20)) q.lod = static_cast<double>(odd_float(random));
    } else {
        q.gradient = random_gradient(random, contents, view.base, unit);
    }
    if (random.chance(4))
        q.lod_bias = static_cast<double>(one_of(random, std::array{-16.0f, 15.99f, 0.5f, random.in(-2.0f, 2.0f)}));
    if (compares) {
        // Around the value of some texel, or anything.
        const int x = random.integer(0, contents.width_of(level) - 1);
        const int y = random.integer(0, contents.height_of(level) - 1);
        const double texel = oracle::texel_value(contents.format, Profile{}, contents.code(level, 0, x, y, 0), 0);
        const float step =
            contents.format == Format::D16 || contents.format == Format::R16Unorm ? 0.5f / 65535.0f : 0.5f / 16777215.0f;
        q.reference = static_cast<double>(
            one_of(random, std::array{static_cast<float>(texel), ulps_from(random, static_cast<float>(texel)),
                                      static_cast<float>(texel) + step, random.unit(), random.in(-0.5f, 1.5f)}));
        if (random.chance(30)) q.reference = static_cast<double>(odd_float(random));
    }
    return q;
}

// --- The comparison ---------------------------------------------------------------------------------------------------------

struct Tally {
    std::size_t samples = 0;
    std::size_t exact = 0;    // of one legal value
    std::size_t open = 0;     // of more than one set of texels
    std::size_t uniform = 0;  // of texels that are all the same, but not that
    std::size_t failures = 0;
    double worst = 0;  // share of the allowance used
    std::size_t worst_case = 0;
    std::string report;
};

std::string shown(double x, bool fp64) {
    if (fp64) return fmt::format("{:a} (0x{:016x})", x, std::bit_cast<std::uint64_t>(x));
    return fmt::format("{:a} (0x{:08x})", x, std::bit_cast<std::uint32_t>(static_cast<float>(x)));
}

std::string describe(const Contents& contents, const oracle::Levels& view, const Sampler& s, const Profile& p) {
    const auto name = [](auto value) { return name_of(value); };
    std::string text = fmt::format("{} kind {} {}x{} levels {} layers {} view {}+{} min_lod {:a}",
                                   format_info(contents.format).name, static_cast<int>(contents.kind), contents.width,
                                   contents.height, contents.levels, contents.layers, view.base, view.count, view.min_lod);
    text += fmt::format(
        "\n    sampler min {} mag {} mip {} {} {} aniso {} {} compare {} bias {:a} lod [{:a}, {:a}] border {:a} {:a} {:a} {:a}",
        name(s.min), name(s.mag), name(s.mip), name(s.address_u), name(s.address_v), s.max_anisotropy, name(s.reduction),
        name(s.compare), s.lod_bias, s.min_lod, s.max_lod, s.border[0], s.border[1], s.border[2], s.border[3]);
    text += fmt::format("\n    profile {}", p.name);
    const Profile& base = profile_presets().front();
    for_each_field(p, [&](std::string_view field, const auto& value) {
        for_each_field(base, [&](std::string_view other, const auto& standard) {
            if constexpr (std::is_same_v<decltype(value), decltype(standard)>) {
                if (field != other || value == standard || field == "name" || field == "summary") return;
                text += fmt::format(" {}={}", field, field_text(value));
            }
        });
    });
    return text;
}

std::string describe(const Question& q) {
    std::string text = fmt::format("at ({:a}, {:a}, {:a}) offset {} {}", q.coordinate[0], q.coordinate[1], q.coordinate[2],
                                   q.offset[0], q.offset[1]);
    if (q.gradient)
        text += fmt::format(" dx ({:a}, {:a}, {:a}) dy ({:a}, {:a}, {:a})", q.gradient->dx[0], q.gradient->dx[1],
                            q.gradient->dx[2], q.gradient->dy[0], q.gradient->dy[1], q.gradient->dy[2]);
    else
        text += fmt::format(" lod {:a}", q.lod);
    text += fmt::format(" bias {:a}", q.lod_bias);
    if (q.reference) text += fmt::format(" reference {:a}", *q.reference);
    return text;
}

std::string describe(const SampleRecord& record) {
    std::string text = fmt::format("    clamped lod {:a}, {}, ratio {:a}, {} probes\n", record.clamped_lod,
                                   record.magnified ? "magnified" : "minified", record.ratio, record.probes.size());
    for (const ProbeRecord& probe : record.probes) {
        text += fmt::format("    probe ({:a}, {:a})", probe.u, probe.v);
        for (const LevelRecord& level : probe.levels) {
            text += fmt::format(" level {} x {:a}:", level.level, level.weight);
            for (const TapRecord& tap : level.taps)
                text += fmt::format(" {}({}, {}, {}){:a} x {:a}",
                                    tap.border   ? "border "
                                    : tap.corner ? "corner "
                                                 : "",
                                    tap.layer, tap.x, tap.y, tap.value[0], tap.weight);
        }
        text += "\n";
    }
    return text;
}

SampleRequest request_of(const Question& q) {
    SampleRequest r;
    r.coordinate = q.coordinate;
    if (q.gradient) r.gradient = SampleRequest::Gradient{q.gradient->dx, q.gradient->dy};
    r.lod = q.lod;
    r.lod_bias = q.lod_bias;
    r.reference = q.reference;
    r.offset = {q.offset[0], q.offset[1]};
    return r;
}

bool same(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b));
}

/// What is wrong with a record, or nothing: its result is the sample's, weights sum to 1, texels are those of the texture.
std::string fault_of(const SampleRecord& record, const SampleResult& result, const Contents& contents, const Profile& profile,
                     bool compares) {
    for (std::size_t c = 0; c < 4; ++c)
        if (!same(record.result[c], result.color[c])) return "record: result";
    if (!same(record.lod, result.lod)) return "record: lod";
    const FormatInfo& info = format_info(contents.format);
    double all_probes = 0;
    for (const ProbeRecord& probe : record.probes) {
        all_probes += probe.weight;
        double all_levels = 0;
        for (const LevelRecord& level : probe.levels) {
            all_levels += level.weight;
            double all_taps = 0;
            for (const TapRecord& tap : level.taps) {
                all_taps += tap.weight;
                if (tap.border || tap.corner) continue;
                if (tap.level != level.level) return "record: level of a tap";
                for (int c = 0; c < (compares ? 1 : info.components); ++c) {
                    const auto i = static_cast<std::size_t>(c);
                    const std::uint32_t code = contents.code(tap.level, tap.layer, tap.x, tap.y, c);
                    if (tap.raw[i] != code) return "record: code of a texel";
                    const double value = oracle::texel_value(contents.format, profile, code, c);
                    const double error = info.is_integer() ? 0x1p-24 : oracle::texel_error(contents.format, profile);
                    const bool close = same(tap.value[i], value) || std::fabs(tap.value[i] - value) <= error * value;
                    const bool flushed = std::fabs(value) < 0x1p-126 && tap.value[i] == 0;
                    if (compares ? tap.value[i] != 0 && tap.value[i] != 1 : !close && !flushed)
                        return "record: value of a texel";
                }
            }
            if (std::fabs(all_taps - 1) > 0x1p-20) return "record: weights of texels";
        }
        if (!probe.levels.empty() && std::fabs(all_levels - 1) > 0x1p-20) return "record: weights of levels";
    }
    if (!record.probes.empty() && std::fabs(all_probes - 1) > 0x1p-20) return "record: weights of probes";
    return "";
}

/// What a case samples, and how.
struct Case {
    Contents contents;
    bool compares = false;
    Profile profile;
    Sampler sampler;
    oracle::Levels view;
    std::vector<Question> questions;
};

Case random_case(std::uint64_t index) {
    Random random(index);
    Case c;
    c.contents = random_contents(random);
    const FormatInfo& info = format_info(c.contents.format);
    const bool comparable = info.is_depth || c.contents.format == Format::R32Float || c.contents.format == Format::R16Unorm ||
                            c.contents.format == Format::R8Unorm;
    c.compares = comparable && random.chance(2);
    c.profile = random_profile(random);
    c.sampler = random_sampler(random, c.contents, c.compares);
    c.view = {.base = 0, .count = c.contents.levels};
    if (random.chance(3)) {
        c.view.base = random.integer(0, c.contents.levels - 1);
        c.view.count = random.integer(1, c.contents.levels - c.view.base);
    }
    const auto levels = static_cast<float>(c.contents.levels);
    if (random.chance(4)) c.view.min_lod = std::min(random.in(0.0f, levels), levels - 0.01f);
    const bool fp64 = c.profile.arithmetic == Arithmetic::Fp64;
    for (std::size_t i = 0; i < kSamplesPerCase; ++i)
        c.questions.push_back(random_question(random, c.contents, c.view, c.compares, fp64));
    return c;
}

void run_case(std::uint64_t index, Tally& tally) {
    const auto [contents, compares, profile, sampler, view, questions] = random_case(index);
    const bool fp64 = profile.arithmetic == Arithmetic::Fp64;
    std::vector<SampleRequest> requests;
    for (const Question& question : questions) requests.push_back(request_of(question));
    const Texture texture = texture_of(contents);
    const TextureView seen(texture, view.base, view.count, view.min_lod);
    const auto results = sample_all(seen, sampler, profile, requests);

    for (std::size_t i = 0; i < questions.size(); ++i) {
        const oracle::Answer answer = oracle::sample(contents, view, sampler, profile, questions[i]);
        const auto& got = results[i].color;
        ++tally.samples;
        if (answer.colors.size() == 1 && answer.colors[0][0].low == answer.colors[0][0].high) ++tally.exact;
        if (answer.colors.size() > 1) ++tally.open;
        if (answer.colors.size() == 1) {
            for (std::size_t c = 0; c < 4; ++c) {
                const auto& o = answer.colors[0][c];
                if (o.uniform && o.low < o.high && static_cast<float>(got[c]) != static_cast<float>(0.5 * (o.low + o.high)))
                    ++tally.uniform;
            }
        }
        std::string wrong;
        if (!answer.accepts(got))
            wrong = "color";
        else if (!answer.accepts_lod(results[i].lod))
            wrong = "lod";
        if (wrong.empty() && i % 8 == 0) {
            const SampleRecord record = record_sample(seen, sampler, profile, requests[i]);
            wrong = fault_of(record, results[i], contents, profile, compares);
        }
        if (wrong.empty()) {
            const double deviation = answer.deviation(got);
            if (deviation > tally.worst) {
                tally.worst = deviation;
                tally.worst_case = index;
            }
            continue;
        }
        if (++tally.failures > 8) continue;
        tally.report += fmt::format(
            "{}: GNOMON_ORACLE_CASE={} gnomon_tests \"[oracle]\", sample {}\n    {}\n    {}\n    lod {} in [{:a}, {:a}]{}\n",
            wrong, index, i, describe(contents, view, sampler, profile), describe(questions[i]), shown(results[i].lod, fp64),
            answer.lod_low, answer.lod_high, answer.lod_nan ? " or NaN" : "");
        tally.report += describe(record_sample(seen, sampler, profile, requests[i]));
        for (std::size_t c = 0; c < 4; ++c) {
            tally.report += fmt::format("    channel {}: {}", c, shown(got[c], fp64));
            std::size_t listed = 0;
            for (const auto& color : answer.colors) {
                const auto& o = color[c];
                if (++listed > 4) break;
                tally.report +=
                    fmt::format("{} [{}, {}]{}{}{}", listed == 1 ? ", legal" : " or", shown(o.low, fp64), shown(o.high, fp64),
                                o.nan ? " NaN" : "", o.up ? " inf" : "", o.down ? " -inf" : "");
            }
            tally.report += fmt::format(" ({} sets)\n", answer.colors.size());
        }
    }
}

/// gather4 of every lane of the questions, D3D11.3 22.4.2, 22.4.3.
template <class Real>
void gather_case(std::uint64_t index, Tally& tally) {
    const auto [contents, compares, profile, sampler, view, questions] = random_case(index);
    const Texture texture = texture_of(contents);
    const TextureView seen(texture, view.base, view.count, view.min_lod);
    const int component = compares ? 0 : static_cast<int>(index % 4);
    for (std::size_t first = 0; first < questions.size(); first += kLanes) {
        const Question& q = questions[first];
        std::array<std::array<typename Real::Scalar, kLanes>, 4> lanes{};
        for (std::size_t i = 0; i < kLanes; ++i) {
            const Question& lane_question = questions[std::min(first + i, questions.size() - 1)];
            for (std::size_t axis = 0; axis < 3; ++axis)
                lanes[axis][i] = static_cast<typename Real::Scalar>(lane_question.coordinate[axis]);
            lanes[3][i] = static_cast<typename Real::Scalar>(lane_question.reference.value_or(0));
        }
        Vec4<Real> got;
        {
            const DenormalScope denormals(profile.flush_denormals);
            const Vec3<Real> at{Real::load(lanes[0].data()), Real::load(lanes[1].data()), Real::load(lanes[2].data())};
            const glm::ivec2 offset{q.offset[0], q.offset[1]};
            got = compares ? gather_compare(seen, sampler, profile, at, Real::load(lanes[3].data()), offset)
                           : gather(seen, sampler, profile, at, component, offset);
        }
        for (std::size_t i = 0; i < kLanes && first + i < questions.size(); ++i) {
            Question question = questions[first + i];
            question.offset = q.offset;
            // Which face a direction has that is no number or nothing, and what a reference that is no number, is open.
            double largest = 0;
            double sum = 0;
            for (const double d : question.coordinate) {
                largest = std::fmax(largest, std::fabs(d));
                sum += d;
            }
            if (contents.kind == Kind::Cube && (!(largest > 1e-30) || !std::isfinite(sum))) continue;
            if (question.reference && std::isnan(*question.reference)) continue;
            const oracle::Color expected = oracle::gather(contents, view, sampler, profile, question, component);
            const int l = static_cast<int>(i);
            const std::array<double, 4> values{static_cast<double>(lane(got.x, l)), static_cast<double>(lane(got.y, l)),
                                               static_cast<double>(lane(got.z, l)), static_cast<double>(lane(got.w, l))};
            ++tally.samples;
            for (std::size_t c = 0; c < 4; ++c) {
                if (expected[c].low == expected[c].high) ++tally.exact;
                if (expected[c].accepts(values[c])) continue;
                if (++tally.failures > 8) continue;
                const bool fp64 = profile.arithmetic == Arithmetic::Fp64;
                tally.report +=
                    fmt::format("case {} sample {} component {}\n    {}\n    {}\n    texel {}: {}, expected [{}, {}]\n", index,
                                first + i, component, describe(contents, view, sampler, profile), describe(question), c,
                                shown(values[c], fp64), shown(expected[c].low, fp64), shown(expected[c].high, fp64));
            }
        }
    }
}

void run_cases(std::uint64_t first, std::uint64_t count) {
    Tally tally;
    if (const char* only = std::getenv("GNOMON_ORACLE_CASE")) {
        run_case(std::strtoull(only, nullptr, 10), tally);
    } else {
        for (std::uint64_t i = first; i < first + count; ++i) run_case(i, tally);
    }
    fmt::print(
        "oracle: {} samples, {} of one value, {} of several sets, {} differ from a constant; at most {:.3f} of the allowance, "
        "case {}\n",
        tally.samples, tally.exact, tally.open, tally.uniform, tally.worst, tally.worst_case);
    if (tally.failures != 0)
        FAIL(fmt::format("{} of {} samples are not legal\n{}", tally.failures, tally.samples, tally.report));
    // Outputs that nothing constrains would pass anything.
    CHECK(tally.exact > tally.samples / 20);
    CHECK(tally.open < tally.samples / 2);
}

}  // namespace

TEST_CASE("samples are among those the specification allows", "[oracle][7.18]") { run_cases(0, 3200); }

TEST_CASE("gathered texels are the four of the bilinear filter", "[oracle][22.4.2]") {
    Tally tally;
    for (std::uint64_t i = 0; i < 1600; ++i) {
        if (random_case(i).profile.arithmetic == Arithmetic::Fp64)
            gather_case<Double>(i, tally);
        else
            gather_case<Float>(i, tally);
    }
    fmt::print("oracle: {} gathers\n", tally.samples);
    if (tally.failures != 0) FAIL(fmt::format("{} of {} gathers differ\n{}", tally.failures, tally.samples, tally.report));
    CHECK(tally.exact > tally.samples);
}

TEST_CASE("two million samples are among those the specification allows", "[.][sweep][oracle-sweep]") { run_cases(0, 31250); }
