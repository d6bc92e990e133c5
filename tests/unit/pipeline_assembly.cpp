// Assembly in pieces: whatever pieces primitives are taken in, they are those of the whole list; and what it knows of vertices.
// pipeline/assembly.h
#include "pipeline/assembly.h"
#include "tests/oracle/random.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <set>
#include <type_traits>
#include <vector>

using namespace gnomon;

// It can hold no memory, so none that grows with the draw.
static_assert(std::is_trivially_copyable_v<Assembly>);

namespace {

struct Corners {
    std::vector<std::uint32_t> at;  // positions in the list, in winding order
    std::uint32_t first, last;      // the leading one, where the first or the last vertex leads
};

/// Primitives of positions [begin, end), as the tables of D3D11.3 8.10 list them.
void append_run(Topology topology, std::uint32_t begin, std::uint32_t end, std::vector<Corners>& out) {
    for (std::uint32_t i = begin; i < end; ++i) {
        const std::uint32_t k = i - begin;
        switch (topology) {
            case Topology::PointList: out.push_back({{i}, i, i}); break;
            case Topology::LineList:
                if (k % 2 == 1) out.push_back({{i - 1, i}, i - 1, i});
                break;
            case Topology::LineStrip:
                if (k >= 1) out.push_back({{i - 1, i}, i - 1, i});
                break;
            case Topology::TriangleList:
                if (k % 3 == 2) out.push_back({{i - 2, i - 1, i}, i - 2, i});
                break;
            case Topology::TriangleStrip:
                if (k >= 2 && k % 2 == 0) out.push_back({{i - 2, i - 1, i}, i - 2, i});
                if (k >= 2 && k % 2 == 1) out.push_back({{i - 2, i, i - 1}, i - 2, i});
                break;
            case Topology::TriangleFan:
                if (k >= 2) out.push_back({{i - 1, i, begin}, i - 1, i});
                break;
        }
    }
}

struct List {
    std::vector<std::uint32_t> wide;
    std::vector<std::uint16_t> narrow;
    IndexType type;

    [[nodiscard]] std::span<const std::byte> bytes() const {
        return type == IndexType::Uint16 ? std::as_bytes(std::span(narrow)) : std::as_bytes(std::span(wide));
    }
};

/// `one_restart_in` 0: none.
List random_list(oracle::Random& random, IndexType type, int one_restart_in) {
    List list{.wide = {}, .narrow = {}, .type = type};
    const int count = random.integer(1, 400);
    for (int i = 0; i < count; ++i) {
        const bool restarts = one_restart_in > 0 && random.chance(one_restart_in);
        const auto number = static_cast<std::uint32_t>(random.integer(100, 300));
        list.wide.push_back(restarts ? 0xffffffffu : number);
        list.narrow.push_back(restarts ? std::uint16_t{0xffff} : static_cast<std::uint16_t>(number));
    }
    return list;
}

}  // namespace

TEST_CASE("primitives taken in pieces are those of the whole list", "[assembly][8.10][8.12]") {
    for (std::uint64_t seed = 0; seed < 300; ++seed)
        for (const auto& [topology, name] : kEnumNames<Topology>) {
            oracle::Random random(seed);
            const IndexType type = random.chance(2) ? IndexType::Uint16 : IndexType::Uint32;
            const bool indexed = !random.chance(4);
            const bool restart = random.chance(2);
            const List list = random_list(random, type, restart ? static_cast<int>(seed % 5) * 10 + 2 : 0);
            const auto first = static_cast<std::uint32_t>(random.integer(0, static_cast<int>(list.wide.size()) - 1));
            const auto count = static_cast<std::uint32_t>(random.integer(0, static_cast<int>(list.wide.size() - first)));
            const ProvokingVertex provoking = random.chance(2) ? ProvokingVertex::First : ProvokingVertex::Last;
            const VertexNumbers numbers(indexed ? list.bytes() : std::span<const std::byte>{}, type, first, count);
            const Assembly assembly(numbers, topology, provoking, restart);

            std::vector<Corners> expected;
            std::uint32_t begin = 0;
            for (std::uint32_t i = 0; i <= count; ++i) {
                if (i < count && !(restart && indexed && list.wide[first + i] == 0xffffffffu)) continue;
                append_run(topology, begin, i, expected);
                begin = i + 1;
            }
            INFO("seed " << seed << ", " << name);
            REQUIRE(assembly.count() == expected.size());
            if (expected.empty()) continue;
            const auto number = [&](std::uint32_t position) {
                if (!indexed) return first + position;
                return type == IndexType::Uint16 ? list.narrow[first + position] : list.wide[first + position];
            };

            // Through three instances, in groups and jumps of any length.
            const std::uint64_t total = 3 * expected.size();
            AssemblyCursor at = assembly.begin();
            for (std::uint64_t next = 0; next < total;) {
                if (random.chance(4)) {
                    const auto jump = static_cast<std::uint64_t>(random.between(0, static_cast<std::int64_t>(total - next)));
                    assembly.advance(at, jump);
                    next += jump;
                    continue;
                }
                const bool by_position = random.chance(2);
                std::array<AssembledPrimitive, 16> group;
                const std::uint32_t instance = at.instance;
                const std::uint32_t id = at.id;
                const auto wanted = std::min<std::uint64_t>(total - next, static_cast<std::uint64_t>(random.integer(1, 16)));
                const auto left = static_cast<std::uint32_t>(expected.size() - id);
                const Assembly::Positions positions =
                    assembly.positions(at, std::min(left, static_cast<std::uint32_t>(wanted)));
                const std::uint32_t hub = at.run.begin;
                const std::size_t taken = assembly.take(at, by_position, std::span(group).first(wanted));
                REQUIRE(taken >= 1);
                REQUIRE(taken <= wanted);
                for (std::size_t i = 0; i < taken; ++i, ++next) {
                    REQUIRE(instance == next / expected.size());
                    REQUIRE(id + i == next % expected.size());
                    const Corners& corners = expected[id + i];
                    for (std::size_t c = 0; c < corners.at.size(); ++c) {
                        const std::uint32_t position = corners.at[c];
                        REQUIRE(group[i].vertex[c] == (by_position ? position : number(position)));
                        const bool inside = position >= positions.first && position <= positions.last;
                        REQUIRE((inside || (topology == Topology::TriangleFan && position == hub)));
                    }
                    const std::uint32_t leading = provoking == ProvokingVertex::Last ? corners.last : corners.first;
                    REQUIRE(group[i].provoking == (by_position ? leading : number(leading)));
                }
            }

            // What the primitives use of the numbers.
            std::set<std::uint32_t> used;
            for (const Corners& corners : expected)
                for (const std::uint32_t position : corners.at) used.insert(number(position));
            REQUIRE(assembly.distinct_vertices(numbers.range(0, count, restart)) == used.size());
        }
}

TEST_CASE("the range of vertex numbers leaves out what restarts and nothing else", "[assembly][8.12]") {
    const std::array<std::uint32_t, 5> wide{7, 0xffffffffu, 3, 0xffffu, 0};
    const VertexNumbers numbers(std::as_bytes(std::span(wide)), IndexType::Uint32, 0, 5);
    CHECK(numbers.range(0, 3, true).lowest == 3);
    CHECK(numbers.range(0, 3, true).highest == 7);
    CHECK(numbers.range(0, 3, false).highest == 0xffffffffu);
    CHECK(numbers.range(0, 5, true).highest == 0xffffu);
    CHECK(numbers.range(4, 5, true).size() == 1);
    CHECK(numbers.range(1, 2, true).empty());
    CHECK(numbers.range(2, 2, true).empty());
    const std::array<std::uint16_t, 4> narrow{0xfffe, 0xffff, 5, 0xffff};
    const VertexNumbers short_numbers(std::as_bytes(std::span(narrow)), IndexType::Uint16, 0, 4);
    CHECK(short_numbers.range(0, 4, true).lowest == 5);
    CHECK(short_numbers.range(0, 4, true).highest == 0xfffe);
    CHECK(short_numbers.range(0, 4, false).highest == 0xffff);
    CHECK(short_numbers.range(3, 4, true).empty());
    const VertexNumbers in_order({}, IndexType::Uint32, 10, 6);
    CHECK(in_order.range(2, 4, true).lowest == 12);
    CHECK(in_order.range(2, 4, true).highest == 13);
}
