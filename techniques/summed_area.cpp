// Summed-area tables by two dispatches: summed_area.h says in which order they add. [Crow84], [Lauritzen07] 8.5
#include "techniques/summed_area.h"

#include "pipeline/compute.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace gnomon::techniques {

namespace {

constexpr int kLinesPerGroup = 8;
constexpr GroupSize kGroup{kLinesPerGroup, kLineParts, 1};  // x: line, y: part

/// Scans kLinesPerGroup lines of `count` texels. `read(t, line, at)` gives the kSums numbers of a texel, `write(t, line, at,
/// sums)` takes what they add up to; both leave alone what is outside the map.
template <class Lane, std::size_t kSums, class G, class Read, class Write>
void scan_lines(G& g, int count, const Read& read, const Write& write) {
    using Sums = std::array<Lane, kSums>;
    std::array<SharedArray<Lane>, kSums> scanned;
    std::array<SharedArray<Lane>, kSums> next;
    for (std::size_t i = 0; i < kSums; ++i) {
        scanned[i] = g.template shared<Lane>(kGroup.threads());
        next[i] = g.template shared<Lane>(kGroup.threads());
    }
    const int run = (count + kLineParts - 1) / kLineParts;
    const auto line_of = [&](const auto& t) { return Int(g.id.x * kLinesPerGroup) + t.local.x; };
    const auto each_texel = [&](const auto& t, const auto& visit) {
        const Int first = t.local.y * Int(run);
        for (int k = 0; k < run; ++k) visit(line_of(t), first + Int(k));
    };

    // Every part adds up its run.
    g.threads([&](const auto& t) {
        Sums sums{};
        each_texel(t, [&](Int line, Int at) {
            const Sums texel = read(t, line, at);
            for (std::size_t i = 0; i < kSums; ++i) sums[i] = sums[i] + texel[i];
        });
        for (std::size_t i = 0; i < kSums; ++i) t.store(scanned[i], t.index, sums[i]);
    });

    // Scan the runs: each step doubles how far back they reach. [Hillis86]
    for (int back = 1; back < kLineParts; back *= 2) {
        g.threads([&](const auto& t) {
            const Mask reaches = t.local.y >= Int(back);
            for (std::size_t i = 0; i < kSums; ++i) {
                const Lane own = t.load(scanned[i], t.index);
                const Lane before = t.load(scanned[i], t.index - Int(back * kLinesPerGroup));
                t.store(next[i], t.index, select(reaches, before + own, own));
            }
        });
        std::swap(scanned, next);
    }

    // Run over the texels again from all that lies before them.
    g.threads([&](const auto& t) {
        Sums running;
        for (std::size_t i = 0; i < kSums; ++i) running[i] = t.load(scanned[i], t.index - Int(kLinesPerGroup));
        each_texel(t, [&](Int line, Int at) {
            const Sums texel = read(t, line, at);
            for (std::size_t i = 0; i < kSums; ++i) running[i] = running[i] + texel[i];
            write(t, line, at, running);
        });
    });
}

template <std::size_t kCount, class Lane>
std::array<Lane, kCount> first_of(const Vec4<Lane>& texel) {
    const std::array all{texel.x, texel.y, texel.z, texel.w};
    std::array<Lane, kCount> first;
    std::copy_n(all.begin(), kCount, first.begin());
    return first;
}
template <class Lane, std::size_t kCount>
Vec4<Lane> texel_of(const std::array<Lane, kCount>& sums) {
    if constexpr (kCount == 2) {
        return {sums[0], sums[1], Lane(0), Lane(0)};
    } else {
        return {sums[0], sums[1], sums[2], sums[3]};
    }
}

/// The rows of a map of moments, into a table of kSums floats per texel.
template <std::size_t kSums>
struct FloatRows {
    static constexpr GroupSize kGroupSize = kGroup;

    ReadImage moments{};
    RwImage table{};
    TableCoding coding{};
    int count = 0;  // texels of a row

    static constexpr auto fields() {
        using R = FloatRows;
        return std::tuple{Field{"moments", &R::moments}, Field{"table", &R::table}, Field{"coding", &R::coding},
                          Field{"count", &R::count}};
    }

    template <class G>
    void operator()(G& g) const {
        using Real = typename G::Real;
        scan_lines<Real, kSums>(
            g, count,
            [&](const auto& t, Int line, Int at) {
                const Vec4<Real> texel = t.load(moments, at, line);
                return first_of<kSums>(coding.store(Moments<Real>{texel.x, texel.y}));
            },
            [&](const auto& t, Int line, Int at, const auto& sums) { t.store(table, at, line, texel_of(sums)); });
    }
};

/// The columns of a table, in place.
template <std::size_t kSums>
struct FloatColumns {
    static constexpr GroupSize kGroupSize = kGroup;

    RwImage table{};
    int count = 0;  // texels of a column

    static constexpr auto fields() {
        return std::tuple{Field{"table", &FloatColumns::table}, Field{"count", &FloatColumns::count}};
    }

    template <class G>
    void operator()(G& g) const {
        scan_lines<typename G::Real, kSums>(
            g, count, [&](const auto& t, Int line, Int at) { return first_of<kSums>(t.load(table, line, at)); },
            [&](const auto& t, Int line, Int at, const auto& sums) { t.store(table, line, at, texel_of(sums)); });
    }
};

struct FixedRows {
    static constexpr GroupSize kGroupSize = kGroup;

    ReadImage moments{};
    RwUintImage table{};
    FixedPoint fixed{};
    int count = 0;

    static constexpr auto fields() {
        using R = FixedRows;
        return std::tuple{Field{"moments", &R::moments}, Field{"table", &R::table}, Field{"fixed", &R::fixed},
                          Field{"count", &R::count}};
    }

    template <class G>
    void operator()(G& g) const {
        scan_lines<Int, 2>(
            g, count,
            [&](const auto& t, Int line, Int at) {
                const auto texel = t.load(moments, at, line);
                return std::array{fixed.encode(texel.x), fixed.encode(texel.y)};
            },
            [&](const auto& t, Int line, Int at, const auto& sums) { t.store(table, at, line, texel_of(sums)); });
    }
};

struct FixedColumns {
    static constexpr GroupSize kGroupSize = kGroup;

    RwUintImage table{};
    int count = 0;

    static constexpr auto fields() {
        return std::tuple{Field{"table", &FixedColumns::table}, Field{"count", &FixedColumns::count}};
    }

    template <class G>
    void operator()(G& g) const {
        scan_lines<Int, 2>(
            g, count, [&](const auto& t, Int line, Int at) { return first_of<2>(t.load(table, line, at)); },
            [&](const auto& t, Int line, Int at, const auto& sums) { t.store(table, line, at, texel_of(sums)); });
    }
};

struct TablePrograms {
    ComputeProgram rows;
    ComputeProgram columns;
};
const TablePrograms& float_programs() {
    static const TablePrograms programs{make_compute_program<FloatRows<2>>("table.rows"),
                                        make_compute_program<FloatColumns<2>>("table.columns")};
    return programs;
}
const TablePrograms& split_programs() {
    static const TablePrograms programs{make_compute_program<FloatRows<4>>("table.rows-split"),
                                        make_compute_program<FloatColumns<4>>("table.columns-split")};
    return programs;
}
const TablePrograms& fixed_programs() {
    static const TablePrograms programs{make_compute_program<FixedRows>("table.rows-fixed"),
                                        make_compute_program<FixedColumns>("table.columns-fixed")};
    return programs;
}

/// ceil(log2(texels)).
int log2_texels(const TableDesc& desc) {
    return static_cast<int>(
        std::bit_width(static_cast<std::uint32_t>(desc.width) * static_cast<std::uint32_t>(desc.height) - 1));
}

}  // namespace

int exact_split_bits(const TableDesc& desc) { return std::clamp(24 - log2_texels(desc) + (desc.centred ? 1 : 0), 1, 23); }

int exact_fraction_bits(const TableDesc& desc) { return std::min(32 - log2_texels(desc), 24); }

TableCoding table_coding(const TableDesc& desc) {
    TableCoding coding;
    if (desc.format == Format::Rgba32Float) {
        const int bits = desc.split_bits != 0 ? desc.split_bits : exact_split_bits(desc);
        coding.split.factor = static_cast<float>(std::int32_t{1} << bits);
    }
    if (desc.format == Format::Rg32Uint) {
        coding.fixed.bits = desc.fraction_bits != 0 ? desc.fraction_bits : exact_fraction_bits(desc);
        coding.fixed.is_signed = desc.centred ? 1 : 0;
    }
    return coding;
}

float largest_side(const TableDesc& desc) {
    const int whole = std::max(desc.width, desc.height);
    const int bits = table_coding(desc).fixed.bits;
    if (bits <= exact_fraction_bits(desc)) return static_cast<float>(whole);
    const std::int64_t texels = std::int64_t{1} << (32 - bits);
    std::int64_t side = 1;
    while ((side + 1) * (side + 1) <= texels) ++side;
    return static_cast<float>(side);
}

SummedAreaTable::SummedAreaTable(Device& device, const TableDesc& desc)
    : device_(device), desc_(desc), coding_(table_coding(desc)) {
    table_ = device.create_texture("summed-area table", {.format = desc.format, .width = desc.width, .height = desc.height});
}

void SummedAreaTable::build(TextureId moments) const {
    const int width = desc_.width;
    const int height = desc_.height;
    const auto rows_and_columns = [&](const TablePrograms& programs, const auto& rows, const auto& columns) {
        run("table rows", programs.rows, constants_of(rows), height);
        run("table columns", programs.columns, constants_of(columns), width);
    };
    if (coding_.fixed.bits != 0) {
        const FixedRows rows{.moments = {moments}, .table = {table_}, .fixed = coding_.fixed, .count = width};
        rows_and_columns(fixed_programs(), rows, FixedColumns{.table = {table_}, .count = height});
    } else if (coding_.split.factor != 0.0f) {
        const FloatRows<4> rows{.moments = {moments}, .table = {table_}, .coding = coding_, .count = width};
        rows_and_columns(split_programs(), rows, FloatColumns<4>{.table = {table_}, .count = height});
    } else {
        const FloatRows<2> rows{.moments = {moments}, .table = {table_}, .count = width};
        rows_and_columns(float_programs(), rows, FloatColumns<2>{.table = {table_}, .count = height});
    }
}

void SummedAreaTable::run(std::string_view label, const ComputeProgram& program, std::span<const std::byte> constants,
                          int lines) const {
    const int groups = (lines + kLinesPerGroup - 1) / kLinesPerGroup;
    device_.execute(
        Dispatch{.label = label, .program = &program, .constants = constants, .groups_x = static_cast<std::uint32_t>(groups)});
}

}  // namespace gnomon::techniques
