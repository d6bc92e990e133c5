// Radix sort: four passes over digits of 8 bits, lowest first, each stable. [Satish09] section 4
//
// A pass counts the digits of every tile, scans the counts digit by digit over all tiles, and moves each word to the place of
// its digit, tile and rank. Inside a tile every thread owns a run of words and its own row of counters, so nothing is contended
// and ranks follow the order of words.
#include "pipeline/compute.h"
#include "pipeline/parallel_primitives.h"

namespace gnomon {

namespace {

constexpr int kDigitBits = 8;
constexpr int kDigits = 1 << kDigitBits;
constexpr int kThreads = kMaxSharedWords / kDigits;  // a counter per thread and digit fills the shared memory
constexpr int kWordsPerThread = 256;
constexpr int kSortTileWords = kThreads * kWordsPerThread;

/// The word whose unsigned order is the order of the keys, then one digit of it. A float has its other bits turned over where
/// it is negative. `order` is 0 for unsigned, 1 for signed, 2 for float keys.
Int digit_of(Int key, int order, int shift) {
    const Int top(std::numeric_limits<std::int32_t>::min());
    if (order == 2) key = key ^ (shift_right<31>(key) & ~top);
    if (order != 0) key = key ^ top;
    return shift_right(key, shift) & Int(kDigits - 1);
}

/// Counter of a thread and digit: rows of threads.
Int counter_of(Int thread, Int digit) { return thread * Int(kDigits) + digit; }

/// Calls body(t, at) for every word of the group's tile, the words of one thread in order.
template <class G, class Body>
void for_each_word(G& g, int count, const Body& body) {
    g.threads([&](const auto& t) {
        const Int first = Int(g.id.x * kSortTileWords) + t.index * Int(kWordsPerThread);
        for (int k = 0; k < kWordsPerThread; ++k) {
            const Int at = first + Int(k);
            body(t, at, at < Int(count));
        }
    });
}

/// How often every digit occurs among the words of every thread.
template <class G>
SharedArray<Int> count_digits(G& g, const ReadBuffer<std::int32_t>& keys, int count, int order, int shift) {
    const auto counters = g.shared_int(kThreads * kDigits);
    for_each_word(g, count, [&](const auto& t, Int at, Mask present) {
        const Int counter = counter_of(t.index, digit_of(t.load(keys, at, present), order, shift));
        t.store(counters, counter, t.load(counters, counter, present) + Int(1), present);
    });
    return counters;
}

struct CountDigits {
    static constexpr GroupSize kGroupSize{kThreads, 1, 1};

    ReadBuffer<std::int32_t> keys;
    RwBuffer<std::int32_t> digits;  // [digit * tiles + tile]
    int count = 0;
    int order = 0;
    int shift = 0;
    int tiles = 0;

    static constexpr auto fields() {
        using C = CountDigits;
        return std::tuple{Field{"keys", &C::keys},   Field{"digits", &C::digits}, Field{"count", &C::count},
                          Field{"order", &C::order}, Field{"shift", &C::shift},   Field{"tiles", &C::tiles}};
    }
    template <class G>
    void operator()(G& g) const {
        const auto counters = count_digits(g, keys, count, order, shift);
        for (int block = 0; block < kDigits; block += kThreads) {
            g.threads([&](const auto& t) {
                const Int digit = Int(block) + t.index;
                Int sum(0);
                for (int thread = 0; thread < kThreads; ++thread) sum += t.load(counters, counter_of(Int(thread), digit));
                t.store(digits, digit * Int(tiles) + Int(g.id.x), sum);
            });
        }
    }
};

/// With `values` or without: a sort of keys alone has no second buffer to name.
struct Values {
    ReadBuffer<std::int32_t> values;
    RwBuffer<std::int32_t> sorted_values;
};
struct NoValues {};

template <class Payload>
struct ScatterDigits : Payload {
    static constexpr GroupSize kGroupSize{kThreads, 1, 1};
    static constexpr bool kHasValues = std::is_same_v<Payload, Values>;

    ReadBuffer<std::int32_t> keys;
    ReadBuffer<std::int32_t> starts;  // exclusive scan of the digits' counts
    RwBuffer<std::int32_t> sorted_keys;
    int count = 0;
    int order = 0;
    int shift = 0;
    int tiles = 0;

    static constexpr auto fields() {
        using S = ScatterDigits;
        const auto common =
            std::tuple{Field{"keys", &S::keys},   Field{"starts", &S::starts}, Field{"sorted_keys", &S::sorted_keys},
                       Field{"count", &S::count}, Field{"order", &S::order},   Field{"shift", &S::shift},
                       Field{"tiles", &S::tiles}};
        if constexpr (kHasValues) {
            return std::tuple_cat(common, std::tuple{Field{"values", &S::values}, Field{"sorted_values", &S::sorted_values}});
        } else {
            return common;
        }
    }
    template <class G>
    void operator()(G& g) const {
        // Where the first word of every thread and digit goes.
        const auto places = count_digits(g, keys, count, order, shift);
        for (int block = 0; block < kDigits; block += kThreads) {
            g.threads([&](const auto& t) {
                const Int digit = Int(block) + t.index;
                Int place = t.load(starts, digit * Int(tiles) + Int(g.id.x));
                for (int thread = 0; thread < kThreads; ++thread) {
                    const Int counter = counter_of(Int(thread), digit);
                    const Int counted = t.load(places, counter);
                    t.store(places, counter, place);
                    place += counted;
                }
            });
        }

        for_each_word(g, count, [&](const auto& t, Int at, Mask present) {
            const Int key = t.load(keys, at, present);
            const Int counter = counter_of(t.index, digit_of(key, order, shift));
            const Int place = t.load(places, counter, present);
            t.store(places, counter, place + Int(1), present);
            t.store(sorted_keys, place, key, present);
            if constexpr (kHasValues) t.store(this->sorted_values, place, t.load(this->values, at, present), present);
        });
    }
};

}  // namespace

void ParallelPrimitives::sort_words(BufferId keys, BufferId values, int count, KeyOrder order) {
    static const ComputeProgram counting = make_compute_program<CountDigits>("sort.count");
    static const ComputeProgram scatter_keys = make_compute_program<ScatterDigits<NoValues>>("sort.scatter-keys");
    static const ComputeProgram scatter_pairs = make_compute_program<ScatterDigits<Values>>("sort.scatter-pairs");
    if (count < 2) return;
    const int tiles = (count + kSortTileWords - 1) / kSortTileWords;
    const BufferId digits = scratch(digits_, "digits", tiles * kDigits);
    const BufferId starts = scratch(starts_, "starts of digits", tiles * kDigits);
    BufferId other_keys = scratch(keys_, "keys", count);
    BufferId other_values = values == BufferId::None ? values : scratch(values_, "values", count);

    // An even number of passes: the last one writes to the caller's buffers.
    static_assert(32 / kDigitBits % 2 == 0);
    for (int shift = 0; shift < 32; shift += kDigitBits) {
        const int how = static_cast<int>(order);
        const CountDigits count_functor{
            .keys = {keys}, .digits = {digits}, .count = count, .order = how, .shift = shift, .tiles = tiles};
        run("count digits", counting, constants_of(count_functor), tiles);
        exclusive_scan<std::int32_t>(digits, starts, tiles * kDigits, CombineOp::Sum);

        const auto scatter = [&](const ComputeProgram& program, auto functor) {
            functor.keys = {keys};
            functor.starts = {starts};
            functor.sorted_keys = {other_keys};
            functor.count = count;
            functor.order = how;
            functor.shift = shift;
            functor.tiles = tiles;
            run("scatter by digit", program, constants_of(functor), tiles);
        };
        if (values == BufferId::None) {
            scatter(scatter_keys, ScatterDigits<NoValues>{});
        } else {
            scatter(scatter_pairs, ScatterDigits<Values>{{{values}, {other_values}}, {}, {}, {}, 0, 0, 0, 0});
        }
        std::swap(keys, other_keys);
        std::swap(values, other_values);
    }
}

template <class Word>
void ParallelPrimitives::radix_sort(BufferId keys, int count) {
    check("sort", count, {keys});
    constexpr KeyOrder kOrder = std::is_same_v<Word, float>          ? KeyOrder::Float
                                : std::is_same_v<Word, std::int32_t> ? KeyOrder::Signed
                                                                     : KeyOrder::Unsigned;
    sort_words(keys, BufferId::None, count, kOrder);
}

template <class Word>
void ParallelPrimitives::radix_sort(BufferId keys, BufferId values, int count) {
    check("sort", count, {keys, values});
    constexpr KeyOrder kOrder = std::is_same_v<Word, float>          ? KeyOrder::Float
                                : std::is_same_v<Word, std::int32_t> ? KeyOrder::Signed
                                                                     : KeyOrder::Unsigned;
    sort_words(keys, values, count, kOrder);
}

template void ParallelPrimitives::radix_sort<std::uint32_t>(BufferId, int);
template void ParallelPrimitives::radix_sort<std::int32_t>(BufferId, int);
template void ParallelPrimitives::radix_sort<float>(BufferId, int);
template void ParallelPrimitives::radix_sort<std::uint32_t>(BufferId, BufferId, int);
template void ParallelPrimitives::radix_sort<std::int32_t>(BufferId, BufferId, int);
template void ParallelPrimitives::radix_sort<float>(BufferId, BufferId, int);

}  // namespace gnomon
