// Compaction and unique: flags, their inclusive scan, and a scatter to the places it gives. [Blelloch90] section 1.5
#include "pipeline/compute.h"
#include "pipeline/parallel_primitives.h"

namespace gnomon {

namespace {

constexpr int kThreads = 256;
constexpr int kWordsPerThread = kTileWords / kThreads;

/// Calls body(t, at, present) for every word of the group's tile.
template <class G, class Body>
void for_each_word(G& g, int count, const Body& body) {
    g.threads([&](const auto& t) {
        for (int row = 0; row < kWordsPerThread; ++row) {
            const Int at = Int(g.id.x * kTileWords + row * kThreads) + t.index;
            body(t, at, at < Int(count));
        }
    });
}

/// 1 where a flag is set.
struct OnesOfFlags {
    static constexpr GroupSize kGroupSize{kThreads, 1, 1};

    ReadBuffer<std::int32_t> flags;
    RwBuffer<std::int32_t> ones;
    int count = 0;

    static constexpr auto fields() {
        using O = OnesOfFlags;
        return std::tuple{Field{"flags", &O::flags}, Field{"ones", &O::ones}, Field{"count", &O::count}};
    }
    template <class G>
    void operator()(G& g) const {
        for_each_word(g, count, [&](const auto& t, Int at, Mask present) {
            t.store(ones, at, select(t.load(flags, at, present) != Int(0), Int(1), Int(0)), present);
        });
    }
};

/// 1 where a word differs from the one before it, or has none.
struct OnesOfHeads {
    static constexpr GroupSize kGroupSize{kThreads, 1, 1};

    ReadBuffer<std::int32_t> from;
    RwBuffer<std::int32_t> ones;
    int count = 0;

    static constexpr auto fields() {
        using O = OnesOfHeads;
        return std::tuple{Field{"from", &O::from}, Field{"ones", &O::ones}, Field{"count", &O::count}};
    }
    template <class G>
    void operator()(G& g) const {
        for_each_word(g, count, [&](const auto& t, Int at, Mask present) {
            const Mask differs = t.load(from, at, present) != t.load(from, at - Int(1), present);
            t.store(ones, at, select(differs | (at == Int(0)), Int(1), Int(0)), present);
        });
    }
};

/// Words with a one go where the inclusive scan of the ones says, less one.
struct ScatterOnes {
    static constexpr GroupSize kGroupSize{kThreads, 1, 1};

    ReadBuffer<std::int32_t> from;
    ReadBuffer<std::int32_t> ones;
    ReadBuffer<std::int32_t> places;
    RwBuffer<std::int32_t> to;
    int count = 0;

    static constexpr auto fields() {
        using S = ScatterOnes;
        return std::tuple{Field{"from", &S::from}, Field{"ones", &S::ones}, Field{"places", &S::places}, Field{"to", &S::to},
                          Field{"count", &S::count}};
    }
    template <class G>
    void operator()(G& g) const {
        for_each_word(g, count, [&](const auto& t, Int at, Mask present) {
            const Mask kept = present & (t.load(ones, at, present) != Int(0));
            t.store(to, t.load(places, at, kept) - Int(1), t.load(from, at, kept), kept);
        });
    }
};

constexpr int tiles_of(int count) { return (count + kTileWords - 1) / kTileWords; }

}  // namespace

int ParallelPrimitives::compact_ones(BufferId from, BufferId ones, BufferId to, int count) {
    static const ComputeProgram program = make_compute_program<ScatterOnes>("compact.scatter");
    const BufferId places = scratch(places_, "places", count);
    inclusive_scan<std::int32_t>(ones, places, count, CombineOp::Sum);
    const ScatterOnes scatter{.from = {from}, .ones = {ones}, .places = {places}, .to = {to}, .count = count};
    run("scatter kept words", program, constants_of(scatter), tiles_of(count));
    return static_cast<int>(word(places, count - 1));
}

int ParallelPrimitives::compact(BufferId from, BufferId flags, BufferId to, int count) {
    static const ComputeProgram program = make_compute_program<OnesOfFlags>("compact.flags");
    check("compaction", 0, {from, flags, to});
    check("compaction", count, {from, flags});
    if (count == 0) return 0;
    const OnesOfFlags functor{.flags = {flags}, .ones = {scratch(ones_, "ones", count)}, .count = count};
    run("ones of flags", program, constants_of(functor), tiles_of(count));
    return compact_ones(from, ones_.id, to, count);
}

int ParallelPrimitives::unique(BufferId from, BufferId to, int count) {
    static const ComputeProgram program = make_compute_program<OnesOfHeads>("unique.heads");
    check("unique", 0, {from, to});
    check("unique", count, {from});
    if (count == 0) return 0;
    const OnesOfHeads functor{.from = {from}, .ones = {scratch(ones_, "ones", count)}, .count = count};
    run("ones of heads", program, constants_of(functor), tiles_of(count));
    return compact_ones(from, ones_.id, to, count);
}

}  // namespace gnomon
