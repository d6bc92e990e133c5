// Reduction and scan: parallel_primitives.h says in which order words are combined. [Blelloch90], [Hillis86]
#include "pipeline/compute.h"
#include "pipeline/parallel_primitives.h"

#include <limits>

namespace gnomon {

namespace {

constexpr int kThreads = 256;
constexpr int kWordsPerThread = kTileWords / kThreads;

struct SumInteger {
    using Word = std::int32_t;
    static constexpr std::string_view kName = "sum";
    static constexpr Word kNeutral = 0;
    static Int combine(Int a, Int b) { return a + b; }
};
struct MinSigned {
    using Word = std::int32_t;
    static constexpr std::string_view kName = "min-signed";
    static constexpr Word kNeutral = std::numeric_limits<Word>::max();
    static Int combine(Int a, Int b) { return min(a, b); }
};
struct MaxSigned {
    using Word = std::int32_t;
    static constexpr std::string_view kName = "max-signed";
    static constexpr Word kNeutral = std::numeric_limits<Word>::min();
    static Int combine(Int a, Int b) { return max(a, b); }
};
/// With the top bit turned over, signed order is unsigned order.
constexpr std::int32_t kTopBit = std::numeric_limits<std::int32_t>::min();
struct MinUnsigned {
    using Word = std::int32_t;
    static constexpr std::string_view kName = "min-unsigned";
    static constexpr Word kNeutral = -1;
    static Int combine(Int a, Int b) { return min(a ^ Int(kTopBit), b ^ Int(kTopBit)) ^ Int(kTopBit); }
};
struct MaxUnsigned {
    using Word = std::int32_t;
    static constexpr std::string_view kName = "max-unsigned";
    static constexpr Word kNeutral = 0;
    static Int combine(Int a, Int b) { return max(a ^ Int(kTopBit), b ^ Int(kTopBit)) ^ Int(kTopBit); }
};
struct SumFloat {
    using Word = float;
    static constexpr std::string_view kName = "sum-float";
    static constexpr Word kNeutral = 0.0f;
    template <class Real>
    static Real combine(const Real& a, const Real& b) {
        return a + b;
    }
};
struct MinFloat {
    using Word = float;
    static constexpr std::string_view kName = "min-float";
    static constexpr Word kNeutral = std::numeric_limits<float>::infinity();
    template <class Real>
    static Real combine(const Real& a, const Real& b) {
        return min(a, b);
    }
};
struct MaxFloat {
    using Word = float;
    static constexpr std::string_view kName = "max-float";
    static constexpr Word kNeutral = -std::numeric_limits<float>::infinity();
    template <class Real>
    static Real combine(const Real& a, const Real& b) {
        return max(a, b);
    }
};

/// What a word is in registers.
template <class Monoid, class Real>
using LaneOf = std::conditional_t<std::is_same_v<typename Monoid::Word, float>, Real, Int>;

/// from[at] where at < count, else the neutral word.
template <class Monoid, class T>
auto load_or_neutral(const T& t, const ReadBuffer<typename Monoid::Word>& from, Int at, int count) {
    using Lane = LaneOf<Monoid, typename T::Real>;
    const Mask present = at < Int(count);
    return select(present, t.load(from, at, present), Lane(Monoid::kNeutral));
}

template <class Monoid>
struct ReduceTile {
    static constexpr GroupSize kGroupSize{kThreads, 1, 1};

    ReadBuffer<typename Monoid::Word> from;
    RwBuffer<typename Monoid::Word> to;  // one word per tile
    int count = 0;

    static constexpr auto fields() {
        using R = ReduceTile;
        return std::tuple{Field{"from", &R::from}, Field{"to", &R::to}, Field{"count", &R::count}};
    }

    template <class G>
    void operator()(G& g) const {
        using Lane = LaneOf<Monoid, typename G::Real>;
        const auto partial = g.template shared<Lane>(kThreads);

        // Every thread combines its column of the tile.
        g.threads([&](const auto& t) {
            Lane result(Monoid::kNeutral);
            for (int row = 0; row < kWordsPerThread; ++row) {
                const Int at = Int(g.id.x * kTileWords + row * kThreads) + t.index;
                result = Monoid::combine(result, load_or_neutral<Monoid>(t, from, at, count));
            }
            t.store(partial, t.index, result);
        });

        // Fold the columns in half until one is left.
        for (int half = kThreads / 2; half > 0; half /= 2) {
            g.threads(half, [&](const auto& t) {
                t.store(partial, t.index, Monoid::combine(t.load(partial, t.index), t.load(partial, t.index + Int(half))));
            });
        }
        g.threads(1, [&](const auto& t) { t.store(to, Int(g.id.x), t.load(partial, t.index)); });
    }
};

template <class Monoid>
struct ScanTile {
    static constexpr GroupSize kGroupSize{kThreads, 1, 1};

    ReadBuffer<typename Monoid::Word> from;
    ReadBuffer<typename Monoid::Word> carries;  // inclusive scan of the tiles' words; not read by the first tile
    RwBuffer<typename Monoid::Word> to;
    int count = 0;
    int exclusive = 0;

    static constexpr auto fields() {
        using S = ScanTile;
        return std::tuple{Field{"from", &S::from}, Field{"carries", &S::carries}, Field{"to", &S::to},
                          Field{"count", &S::count}, Field{"exclusive", &S::exclusive}};
    }

    template <class G>
    void operator()(G& g) const {
        using Lane = LaneOf<Monoid, typename G::Real>;
        auto scanned = g.template shared<Lane>(kThreads);
        auto next = g.template shared<Lane>(kThreads);
        const auto first_of = [&](const auto& t) { return Int(g.id.x * kTileWords) + t.index * Int(kWordsPerThread); };

        // Every thread combines its own neighbouring words.
        g.threads([&](const auto& t) {
            const Int first = first_of(t);
            Lane result(Monoid::kNeutral);
            for (int k = 0; k < kWordsPerThread; ++k)
                result = Monoid::combine(result, load_or_neutral<Monoid>(t, from, first + Int(k), count));
            t.store(scanned, t.index, result);
        });

        // Scan the threads' words: each step doubles how far back they reach.
        for (int back = 1; back < kThreads; back *= 2) {
            g.threads([&](const auto& t) {
                const Lane own = t.load(scanned, t.index);
                const Lane before = t.load(scanned, t.index - Int(back));
                t.store(next, t.index, select(t.index >= Int(back), Monoid::combine(before, own), own));
            });
            std::swap(scanned, next);
        }

        // Run over the words again from all that lies before them.
        g.threads([&](const auto& t) {
            const Int first = first_of(t);
            const Lane in_tile = select(t.index > Int(0), t.load(scanned, t.index - Int(1)), Lane(Monoid::kNeutral));
            const Lane carry = g.id.x > 0 ? t.load(carries, Int(g.id.x - 1)) : Lane(Monoid::kNeutral);
            Lane running = Monoid::combine(carry, in_tile);
            for (int k = 0; k < kWordsPerThread; ++k) {
                const Int at = first + Int(k);
                const Lane included = Monoid::combine(running, load_or_neutral<Monoid>(t, from, at, count));
                t.store(to, at, exclusive != 0 ? running : included, at < Int(count));
                running = included;
            }
        });
    }
};

constexpr int tiles_of(int count) { return (count + kTileWords - 1) / kTileWords; }

/// Calls visit(Monoid{}) with the one of a type of word and an operation.
template <class Word, class Visit>
decltype(auto) with_monoid(CombineOp op, const Visit& visit) {
    constexpr bool kFloat = std::is_same_v<Word, float>;
    constexpr bool kSigned = std::is_same_v<Word, std::int32_t>;
    switch (op) {
        case CombineOp::Sum: return visit(std::conditional_t<kFloat, SumFloat, SumInteger>{});
        case CombineOp::Min:
            return visit(std::conditional_t<kFloat, MinFloat, std::conditional_t<kSigned, MinSigned, MinUnsigned>>{});
        case CombineOp::Max:
            return visit(std::conditional_t<kFloat, MaxFloat, std::conditional_t<kSigned, MaxSigned, MaxUnsigned>>{});
    }
    __builtin_unreachable();
}

}  // namespace

template <class Monoid>
void ParallelPrimitives::reduce_tiles(BufferId from, BufferId to, int count) {
    static const std::string name = fmt::format("reduce.{}", Monoid::kName);
    static const ComputeProgram program = make_compute_program<ReduceTile<Monoid>>(name);
    const ReduceTile<Monoid> functor{.from = {from}, .to = {to}, .count = count};
    run("reduce tiles", program, constants_of(functor), tiles_of(count));
}

template <class Monoid>
std::uint32_t ParallelPrimitives::reduce_words(BufferId from, int count) {
    for (std::size_t level = 0;; ++level) {
        if (sums_.size() <= level) sums_.emplace_back();
        const BufferId sums = scratch(sums_[level], "sums of tiles", tiles_of(count));
        reduce_tiles<Monoid>(from, sums, count);
        from = sums;
        count = tiles_of(count);
        if (count == 1) return word(from, 0);
    }
}

template <class Monoid>
void ParallelPrimitives::scan_words(BufferId from, BufferId to, int count, bool exclusive, std::size_t level) {
    const int tiles = tiles_of(count);
    if (sums_.size() <= level) sums_.resize(level + 1);
    if (carries_.size() <= level) carries_.resize(level + 1);
    const BufferId carries = scratch(carries_[level], "scan of tiles", tiles);
    if (tiles > 1) {
        const BufferId sums = scratch(sums_[level], "sums of tiles", tiles);
        reduce_tiles<Monoid>(from, sums, count);
        scan_words<Monoid>(sums, carries, tiles, false, level + 1);
    }
    static const std::string name = fmt::format("scan.{}", Monoid::kName);
    static const ComputeProgram program = make_compute_program<ScanTile<Monoid>>(name);
    const ScanTile<Monoid> functor{
        .from = {from}, .carries = {carries}, .to = {to}, .count = count, .exclusive = exclusive ? 1 : 0};
    run("scan tiles", program, constants_of(functor), tiles);
}

template <class Word>
Word ParallelPrimitives::reduce(BufferId from, int count, CombineOp op) {
    check("reduction", count, {from});
    return with_monoid<Word>(op, [&]<class Monoid>(Monoid) {
        if (count == 0) return std::bit_cast<Word>(Monoid::kNeutral);
        return std::bit_cast<Word>(reduce_words<Monoid>(from, count));
    });
}

template <class Word>
void ParallelPrimitives::inclusive_scan(BufferId from, BufferId to, int count, CombineOp op) {
    check("scan", count, {from, to});
    if (count == 0) return;
    with_monoid<Word>(op, [&]<class Monoid>(Monoid) { scan_words<Monoid>(from, to, count, false, 0); });
}

template <class Word>
void ParallelPrimitives::exclusive_scan(BufferId from, BufferId to, int count, CombineOp op) {
    check("scan", count, {from, to});
    if (count == 0) return;
    with_monoid<Word>(op, [&]<class Monoid>(Monoid) { scan_words<Monoid>(from, to, count, true, 0); });
}

template std::uint32_t ParallelPrimitives::reduce(BufferId, int, CombineOp);
template std::int32_t ParallelPrimitives::reduce(BufferId, int, CombineOp);
template float ParallelPrimitives::reduce(BufferId, int, CombineOp);
template void ParallelPrimitives::inclusive_scan<std::uint32_t>(BufferId, BufferId, int, CombineOp);
template void ParallelPrimitives::inclusive_scan<std::int32_t>(BufferId, BufferId, int, CombineOp);
template void ParallelPrimitives::inclusive_scan<float>(BufferId, BufferId, int, CombineOp);
template void ParallelPrimitives::exclusive_scan<std::uint32_t>(BufferId, BufferId, int, CombineOp);
template void ParallelPrimitives::exclusive_scan<std::int32_t>(BufferId, BufferId, int, CombineOp);
template void ParallelPrimitives::exclusive_scan<float>(BufferId, BufferId, int, CombineOp);

}  // namespace gnomon
