// Summed-area tables of two moments: built by compute, integrated over rectangles in pixel functors. [Crow84],
// [Lauritzen07] 8.5
//
// Texel (x, y) of a table is the sum of the moments of texels (0, 0) to (x, y) of the map.
//
// Order of additions: first every row of the map, then every column of what came out. A line of n texels is cut into
// kLineParts runs of ceil(n / kLineParts). Each run is added up from its first texel to its last; the runs' sums are scanned in
// log2 kLineParts steps, in each of which part p adds the sum of part p - 2^step before its own [Hillis86]; then every run
// starts from what lies before it and adds texel after texel. No texel passes more than table_additions() additions. Under
// fp64 arithmetic a line's sums are doubles and round once, when they are stored.
#pragma once

#include "pipeline/device.h"
#include "techniques/common/pixel_footprint.h"
#include "techniques/common/split_moments.h"

#include <array>

namespace gnomon::techniques {

inline constexpr int kLineParts = 32;

/// The most additions between a moment and a sum that it is in, of tables of floats:
/// |error of a sum| <= g(k) sum |m| with g(k) = k u / (1 - k u), u = 2^-24. [Higham02] 4.2
constexpr int table_additions(int width, int height) {
    const auto line = [](int texels) { return 2 * ((texels + kLineParts - 1) / kLineParts) + 4; };
    return line(width) + line(height);
}

/// Numbers as multiples of 2^-bits in 32 bits, whose sums wrap: a difference of two of them is right as long as it is in range
/// itself. [Lauritzen07] 8.5.2
struct FixedPoint {
    int bits = 0;       // of the fraction, up to 24; 0: floats instead
    int is_signed = 0;  // 0: [0, 1 - 2^-bits]; 1: [-1/2, 1/2 - 2^-bits], and sums in [-2^31, 2^31)

    static constexpr auto fields() {
        return std::tuple{Field{"bits", &FixedPoint::bits}, Field{"is_signed", &FixedPoint::is_signed}};
    }

    /// To nearest even, and into the range.
    template <class Real>
    [[nodiscard]] Int encode(const Real& number) const {
        const std::int32_t one = std::int32_t{1} << bits;
        const std::int32_t high = (is_signed != 0 ? one / 2 : one) - 1;
        const std::int32_t low = is_signed != 0 ? -one / 2 : 0;
        const Real bound(static_cast<float>(one));
        const Int code = bounded_round_to_int(clamp_to_numbers(number, Real(-1.0f), Real(1.0f)) * bound);
        return clamp(code, Int(low), Int(high));
    }
    /// A sum, correctly rounded.
    template <class Real>
    [[nodiscard]] Real decode(Int sum) const {
        const Real unit(1.0f / static_cast<float>(std::int32_t{1} << bits));
        if (is_signed != 0) return Real(sum) * unit;
        const Real upper(shift_right_logical<16>(sum));
        return (upper * Real(65536.0f) + Real(sum & Int(0xffff))) * unit;
    }
};

/// How a table holds moments; part of the constants of who writes and who reads it. At most one of the two is on.
struct TableCoding {
    MomentSplit split{};
    FixedPoint fixed{};

    static constexpr auto fields() {
        return std::tuple{Field{"split", &TableCoding::split}, Field{"fixed", &TableCoding::fixed}};
    }

    /// The floats that are added up. Of a split, coarse parts are rounded to nearest, not down, and fine parts lie in
    /// [-1/2, 1/2]: exact, and with sums that stay small.
    template <class Real>
    [[nodiscard]] Vec4<Real> store(const Moments<Real>& m) const {
        if (split.factor == 0.0f) return split.store(m);
        const Moments<Real> scaled{m.first * Real(split.factor), m.second * Real(split.factor)};
        const Moments<Real> whole{floor(scaled.first + Real(0.5f)), floor(scaled.second + Real(0.5f))};
        const Real unit(1.0f / split.factor);
        return {whole.first * unit, whole.second * unit, scaled.first - whole.first, scaled.second - whole.second};
    }
};

/// What a table of some size is to hold.
struct TableDesc {
    Format format = Format::Rg32Float;  // rg32f: sums; rgba32f: sums of both parts of a split; rg32ui: fixed point
    int width = 1;                      // texels
    int height = 1;
    bool centred = false;   // moments are in [-1/2, 1/2], else in [0, 1]
    int split_bits = 0;     // bits of coarse parts; 0: as many as leave their sums exact
    int fraction_bits = 0;  // of fixed point, up to 24; 0: as many as leave every sum in range
};

/// Bits of the coarse parts whose sums are exact in a float: 24 - ceil(log2(texels)), one more where they are centred; 1 to 23.
int exact_split_bits(const TableDesc& desc);
/// Bits of a fraction whose sums are in range: 32 - ceil(log2(texels)), at most 24.
int exact_fraction_bits(const TableDesc& desc);

TableCoding table_coding(const TableDesc& desc);

/// The side of the largest square of texels whose sum is in range, texels.
float largest_side(const TableDesc& desc);

/// Cuts an interval along one axis into three strips of whole texels with a weight each: the texel it begins in, those it
/// holds, the texel it ends in.
template <class Real>
struct TexelStrips {
    std::array<Int, 4> edges;  // ascending
    std::array<Real, 3> weights;
};

/// 0 <= low < high <= texels.
template <class Real>
TexelStrips<Real> strips_of(const Real& low, const Real& high, int texels) {
    const Int first = min(bounded_truncate_to_int(low), Int(texels - 1));
    const Int second = first + Int(1);
    const Int third = max(bounded_truncate_to_int(high), second);
    const Real zero(0.0f);
    return {.edges = {first, second, third, min(third + Int(1), Int(texels))},
            .weights = {min(high, Real(second)) - low, Real(1.0f), max(high - Real(third), zero)}};
}

/// How receivers read a table; part of their constants.
struct SummedAreaLookup {
    TextureId table = TextureId::None;
    TableCoding coding{};

    static constexpr auto fields() {
        using S = SummedAreaLookup;
        return std::tuple{Field{"table", &S::table}, Field{"coding", &S::coding}};
    }

    /// The means of the moments over a rectangle inside the map, each texel a constant: equal to the table at the rectangle's
    /// corners, bilinear between texels. Written as nine rectangles of whole texels with weights >= 0, so that sums cancel
    /// before anything is weighed: of fixed point every difference is exact.
    template <class F, class Real = typename F::Real>
    Moments<Real> mean(const F& f, const TexelRectangle<Real>& rectangle) const {
        const glm::ivec2 size = f.size(table);
        const auto columns = strips_of(rectangle.low.x, rectangle.high.x, size.x);
        const auto rows = strips_of(rectangle.low.y, rectangle.high.y, size.y);
        const Real share = f.rcp(area(rectangle));
        if (coding.fixed.bits != 0) {
            const auto load = [&](Int x, Int y) { return f.load_codes(table, x, y); };
            const auto number = [&](Int code) { return coding.fixed.template decode<Real>(code); };
            const Vec4<Real> sum = weighted_sum(columns, rows, load, number);
            return {sum.x * share, sum.y * share};
        }
        const auto load = [&](Int x, Int y) { return f.load(table, x, y); };
        const Vec4<Real> sum = weighted_sum(columns, rows, load, [](const Real& same) { return same; });
        return coding.split.restore(Vec4<Real>{sum.x * share, sum.y * share, sum.z * share, sum.w * share});
    }

private:
    /// `load(x, y)` is the sum up to a texel and 0 left of and above the map; `number` makes a number of a difference.
    template <class Real, class Load, class Number>
    static Vec4<Real> weighted_sum(const TexelStrips<Real>& columns, const TexelStrips<Real>& rows, const Load& load,
                                   const Number& number) {
        using Sums = decltype(load(Int(0), Int(0)));
        const auto minus = [](const Sums& a, const Sums& b) { return Sums{a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w}; };
        // The sums of the strips' columns down to an edge between rows.
        const auto above = [&](Int edge) {
            std::array<Sums, 4> up_to;
            for (std::size_t i = 0; i < 4; ++i) up_to[i] = load(columns.edges[i] - Int(1), edge - Int(1));
            return std::array{minus(up_to[1], up_to[0]), minus(up_to[2], up_to[1]), minus(up_to[3], up_to[2])};
        };
        Vec4<Real> total{Real(0.0f), Real(0.0f), Real(0.0f), Real(0.0f)};
        auto before = above(rows.edges[0]);
        for (std::size_t j = 0; j < 3; ++j) {
            const auto after = above(rows.edges[j + 1]);
            for (std::size_t i = 0; i < 3; ++i) {
                const Real weight = rows.weights[j] * columns.weights[i];
                const Sums sum = minus(after[i], before[i]);
                total.x += number(sum.x) * weight;
                total.y += number(sum.y) * weight;
                total.z += number(sum.z) * weight;
                total.w += number(sum.w) * weight;
            }
            before = after;
        }
        return total;
    }
};

/// A table and the dispatches that fill it.
class SummedAreaTable {
public:
    SummedAreaTable(Device& device, const TableDesc& desc);

    /// From a texture of the table's size with one sample: first moment in red, second in green.
    void build(TextureId moments) const;

    [[nodiscard]] TextureId id() const { return table_; }
    [[nodiscard]] SummedAreaLookup lookup() const { return {.table = table_, .coding = coding_}; }

private:
    void run(std::string_view label, const ComputeProgram& program, std::span<const std::byte> constants, int lines) const;

    Device& device_;
    TableDesc desc_;
    TableCoding coding_;
    TextureId table_ = TextureId::None;
};

}  // namespace gnomon::techniques
