// The texture unit from the specification, one sample at a time, in double: what a sample may legally return, as a set.
// D3D11.3 3.2, 5.3.8, 5.8, 7.18, 22.4
//
// Coordinates of one probe go through the binary32 operations of the specification one by one, so texels and weights are known
// exactly. Levels of detail and places of several probes come from sums, roots and logarithms whose last bits are free: they
// are intervals that the same formulas give in interval arithmetic, each operation widened by its rounding, and every level of
// detail and every texel in reach is legal.
#pragma once

#include "sim/profile.h"
#include "texunit/format.h"
#include "texunit/sampler.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace oracle {

enum class Kind { Flat, Array, Cube };

/// A texture as component codes: per level and layer, texels in rows, components within texels.
struct Contents {
    gnomon::Format format = gnomon::Format::R8Unorm;
    Kind kind = Kind::Flat;
    int width = 1;   // texels of level 0
    int height = 1;  // texels of level 0
    int levels = 1;
    int layers = 1;  // slices, or the six faces +X -X +Y -Y +Z -Z

    std::vector<std::vector<std::uint32_t>> codes{};

    [[nodiscard]] int width_of(int level) const { return width >> level > 1 ? width >> level : 1; }
    [[nodiscard]] int height_of(int level) const { return height >> level > 1 ? height >> level : 1; }
    [[nodiscard]] std::vector<std::uint32_t>& image(int level, int layer) {
        return codes[static_cast<std::size_t>(level * layers + layer)];
    }
    [[nodiscard]] std::uint32_t code(int level, int layer, int x, int y, int component) const;
};

/// Some levels of a texture. D3D11.3 5.8.3
struct Levels {
    int base = 0;
    int count = 1;
    float min_lod = 0;  // in levels of the texture
};

struct Question {
    std::array<double, 3> coordinate{};
    struct Gradient {
        std::array<double, 3> dx{};
        std::array<double, 3> dy{};
    };
    std::optional<Gradient> gradient{};
    double lod = 0;
    double lod_bias = 0;
    std::optional<double> reference{};
    std::array<int, 2> offset{};
};

/// What one component may be.
struct Outcome {
    bool finite = true;  // a number in [low, high] is legal
    double low = 0;
    double high = 0;
    bool nan = false;  // and so are these
    bool up = false;   // +infinity
    bool down = false;
    bool bits = false;       // one texel, moved: the sign of zero counts, denormals may keep their bits
    bool denormals = false;  // and must
    bool uniform = false;    // every texel under the filter is the same number
    double allowance = 0;    // for rounding, on either side
    double ideal_low = 0;    // low and high before the allowance for rounding
    double ideal_high = 0;

    [[nodiscard]] bool accepts(double got) const;
};
using Color = std::array<Outcome, 4>;

struct Answer {
    double lod_low = 0;  // level of detail before bias and clamps; a NaN says that it may be NaN
    double lod_high = 0;
    bool lod_nan = false;
    std::vector<Color> colors;  // any of these

    [[nodiscard]] bool accepts(const std::array<double, 4>& got) const;
    [[nodiscard]] bool accepts_lod(double got) const;
    /// The largest share of the allowance for rounding that a component needs, in the accepting colour that needs least.
    [[nodiscard]] double deviation(const std::array<double, 4>& got) const;
};

/// What sample, sample_b, sample_d, sample_l and sample_c may return. Profiles of address_arithmetic and unorm_filter other
/// than the specification's, of aniso_rule llvmpipe and swiftshader and of probe_placement ewa are not covered.
Answer sample(const Contents& contents, const Levels& view, const gnomon::Sampler& sampler, const gnomon::Profile& profile,
              const Question& question);

/// What gather4 may return of one component, in its order. D3D11.3 22.4.2, 22.4.3
Color gather(const Contents& contents, const Levels& view, const gnomon::Sampler& sampler, const gnomon::Profile& profile,
             const Question& question, int component);

}  // namespace oracle
