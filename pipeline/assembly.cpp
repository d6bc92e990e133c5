#include "pipeline/assembly.h"

#include "sim/lanes.h"

#include <bit>
#include <vector>

namespace gnomon {

namespace {

constexpr std::uint32_t kTogether = 16;  // numbers looked at in one step

/// The primitives from number `k` on of a run that begins at position `run`. D3D11.3 8.10, 8.14
template <class Vertex>
void assemble(Topology topology, bool last, std::uint32_t run, std::uint32_t k, const Vertex& vertex,
              std::span<AssembledPrimitive> out) {
    switch (topology) {
        case Topology::PointList:
            for (AssembledPrimitive& p : out) {
                const std::uint32_t v = vertex(run + k++);
                p = {{v, v, v}, v};
            }
            return;
        case Topology::LineList:
        case Topology::LineStrip: {
            const std::uint32_t step = topology == Topology::LineList ? 2 : 1;
            for (std::uint32_t at = run + step * k; AssembledPrimitive & p : out) {
                const std::uint32_t a = vertex(at);
                const std::uint32_t b = vertex(at + 1);
                p = {{a, b, b}, last ? b : a};
                at += step;
            }
            return;
        }
        case Topology::TriangleList:
            for (std::uint32_t at = run + 3 * k; AssembledPrimitive & p : out) {
                const std::uint32_t a = vertex(at);
                const std::uint32_t b = vertex(at + 1);
                const std::uint32_t c = vertex(at + 2);
                p = {{a, b, c}, last ? c : a};
                at += 3;
            }
            return;
        case Topology::TriangleStrip:
            // Every second one turns its last two corners, so that all wind the same way.
            for (AssembledPrimitive& p : out) {
                const std::uint32_t a = vertex(run + k);
                const std::uint32_t b = vertex(run + k + 1);
                const std::uint32_t c = vertex(run + k + 2);
                p = {{a, k % 2 == 0 ? b : c, k % 2 == 0 ? c : b}, last ? c : a};
                ++k;
            }
            return;
        case Topology::TriangleFan:
            for (const std::uint32_t hub = vertex(run); AssembledPrimitive & p : out) {
                const std::uint32_t a = vertex(run + k + 1);
                const std::uint32_t b = vertex(run + k + 2);
                p = {{a, b, hub}, last ? b : a};
                ++k;
            }
            return;
    }
    __builtin_unreachable();
}

}  // namespace

VertexRange VertexNumbers::range(std::uint32_t begin, std::uint32_t end, bool restarts) const {
    if (begin >= end) return {};
    if (!indexed()) return {first_ + begin, first_ + end - 1};

    // Where there are restarts, one more than the number: that is 0 for the one that restarts, which is no highest one.
    const std::uint32_t more = restarts ? 1 : 0;
    const std::uint32_t width = restart();
    std::uint32_t lowest = ~0u;
    std::uint32_t highest = 0;
    std::uint32_t i = begin;
    if (type_ == IndexType::Uint32) {
        const hn::RebindToUnsigned<detail::IntTag> tag;
        auto least = hn::Set(tag, ~0u);
        auto most = hn::Zero(tag);
        const auto* from = reinterpret_cast<const std::uint32_t*>(data_ + std::size_t{first_} * 4);
        for (; end - i >= kLanes; i += kLanes) {
            const auto values = hn::LoadU(tag, from + i);
            least = hn::Min(least, values);
            most = hn::Max(most, hn::Add(values, hn::Set(tag, more)));
        }
        lowest = hn::GetLane(hn::MinOfLanes(tag, least));
        highest = hn::GetLane(hn::MaxOfLanes(tag, most));
    }
    read([&](const auto& number) {
        for (; i < end; ++i) {
            const std::uint32_t value = number(i);
            lowest = std::min(lowest, value);
            highest = std::max(highest, (value + more) & width);
        }
    });
    return highest < more ? VertexRange{} : VertexRange{lowest, highest - more};
}

std::uint32_t VertexNumbers::next_restart(std::uint32_t begin, std::uint32_t end) const {
    return read([&](const auto& number) {
        const auto any_restarts = [&, wanted = restart()](std::uint32_t first) {
            std::uint32_t found = 0;
            for (std::uint32_t j = 0; j < kTogether; ++j) found |= number(first + j) == wanted ? 1u : 0u;
            return found != 0;
        };
        std::uint32_t i = begin;
        while (end - i >= kTogether && !any_restarts(i)) i += kTogether;
        while (i < end && number(i) != restart()) ++i;
        return i;
    });
}

Assembly::Assembly(const VertexNumbers& numbers, Topology topology, ProvokingVertex provoking, bool restart)
    : numbers_(numbers), topology_(topology), provoking_(provoking), restarts_(restart && numbers.indexed()) {
    for (AssemblyRun run = run_from(0); run.primitives != 0; run = run_from(run.end)) count_ += run.primitives;
}

AssemblyCursor Assembly::begin() const { return {.run = run_from(0)}; }

void Assembly::advance(AssemblyCursor& cursor, std::uint64_t primitives) const {
    if (!restarts_) {
        const std::uint64_t to = cursor.id + primitives;
        cursor.instance += static_cast<std::uint32_t>(to / count_);
        cursor.id = cursor.in_run = static_cast<std::uint32_t>(to % count_);
        return;
    }
    while (primitives >= cursor.run.primitives - cursor.in_run) {
        const std::uint32_t rest = cursor.run.primitives - cursor.in_run;
        primitives -= rest;
        cursor.id += rest;
        cursor.in_run = 0;
        if (cursor.id == count_) {
            ++cursor.instance;
            cursor.id = 0;
        }
        cursor.run = run_from(cursor.id == 0 ? 0 : cursor.run.end);
    }
    cursor.id += static_cast<std::uint32_t>(primitives);
    cursor.in_run += static_cast<std::uint32_t>(primitives);
}

std::size_t Assembly::take(AssemblyCursor& cursor, bool by_position, std::span<AssembledPrimitive> out) const {
    const std::size_t taken = std::min<std::size_t>(out.size(), cursor.run.primitives - cursor.in_run);
    const auto fill = [&](const auto& vertex) {
        assemble(topology_, provoking_ == ProvokingVertex::Last, cursor.run.begin, cursor.in_run, vertex, out.first(taken));
    };
    if (by_position) {
        fill([](std::uint32_t position) { return position; });
    } else {
        numbers_.read(fill);
    }
    advance(cursor, taken);
    return taken;
}

Assembly::Positions Assembly::positions(const AssemblyCursor& cursor, std::uint32_t primitives) const {
    AssemblyCursor last = cursor;
    advance(last, primitives - 1);
    const auto corners = static_cast<std::uint32_t>(corner_count(topology_));
    const auto first_of = [&](const AssemblyCursor& at) {
        switch (topology_) {
            case Topology::PointList:
            case Topology::LineList:
            case Topology::TriangleList: return at.run.begin + corners * at.in_run;
            case Topology::LineStrip:
            case Topology::TriangleStrip:
            case Topology::TriangleFan: return at.run.begin + at.in_run;
        }
        __builtin_unreachable();
    };
    return {first_of(cursor), first_of(last) + corners - 1};
}

std::uint64_t Assembly::distinct_vertices(const VertexRange& range) const {
    if (!numbers_.indexed()) return count_ == 0 ? 0 : used_of(run_from(0));
    std::vector<std::uint64_t> seen(static_cast<std::size_t>(range.size() + 63) / 64);
    numbers_.read([&](const auto& number) {
        for (AssemblyRun run = run_from(0); run.primitives != 0; run = run_from(run.end)) {
            for (std::uint32_t i = run.begin; i < run.begin + used_of(run); ++i) {
                const std::uint32_t bit = number(i) - range.lowest;
                seen[bit / 64] |= std::uint64_t{1} << bit % 64;
            }
        }
    });
    std::uint64_t distinct = 0;
    for (const std::uint64_t word : seen) distinct += static_cast<std::uint64_t>(std::popcount(word));
    return distinct;
}

std::uint32_t Assembly::primitives_of(std::uint32_t vertices) const {
    const auto strip = [&](std::uint32_t corners) { return vertices >= corners ? vertices - corners + 1 : 0; };
    switch (topology_) {
        case Topology::PointList: return vertices;
        case Topology::LineList: return vertices / 2;
        case Topology::LineStrip: return strip(2);
        case Topology::TriangleList: return vertices / 3;
        case Topology::TriangleStrip:
        case Topology::TriangleFan: return strip(3);
    }
    __builtin_unreachable();
}

std::uint32_t Assembly::used_of(const AssemblyRun& run) const {
    switch (topology_) {
        case Topology::PointList:
        case Topology::LineList:
        case Topology::TriangleList: return run.primitives * static_cast<std::uint32_t>(corner_count(topology_));
        case Topology::LineStrip:
        case Topology::TriangleStrip:
        case Topology::TriangleFan: return run.end - run.begin;
    }
    __builtin_unreachable();
}

AssemblyRun Assembly::run_from(std::uint32_t position) const {
    const std::uint32_t end = numbers_.count();
    if (!restarts_) return position == 0 ? AssemblyRun{0, end, primitives_of(end)} : AssemblyRun{end, end, 0};
    while (position < end) {
        const std::uint32_t stop = numbers_.next_restart(position, end);
        const std::uint32_t primitives = primitives_of(stop - position);
        if (primitives != 0) return {position, stop, primitives};
        position = stop + (stop < end ? 1 : 0);
    }
    return {end, end, 0};
}

}  // namespace gnomon
