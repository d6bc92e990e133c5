// Data-parallel primitives over buffers of 32-bit words: reduction, scan, compaction, radix sort, unique. [Blelloch90]
//
// Each is a chain of dispatches, so observers and counters see what it does. All are deterministic: the result follows from the
// input and the profile alone.
//
// Sums of floats follow one fixed tree, so their rounding is fixed as well (fp32 arithmetic, u = 2^-24, without denormals):
// - reduce: tiles of kTileWords words. In a tile 256 running sums, the t-th over words t, t + 256, t + 512, ...; then halves
//   are added, 128 and 128, 64 and 64, down to one. The tiles' sums are reduced in the same way. No word passes through more
//   than 24 additions per level: |error| <= g(24 levels) sum |x|, with g(k) = k u / (1 - k u) [Higham02] and levels =
//   ceil(log(count) / log(kTileWords)), at least 1.
// - scans: in a tile every thread sums 16 neighbouring words, the threads' sums are scanned in 8 doubling steps [Hillis86],
// then
//   every thread runs over its words again, starting from what lies before them. Tiles start from the scan of the tiles' sums,
//   by reduce. |error| <= g(40 levels) sum |x| over the words that went in.
// Under a profile with fp64 arithmetic tiles compute in double and round once per level.
#pragma once

#include "pipeline/device.h"

#include <cstdint>
#include <vector>

namespace gnomon {

/// How words are combined. Sums of integers wrap and sums start from 0. Min and max of floats leave NaN out, as min and max of
/// lanes do.
enum class CombineOp { Sum, Min, Max };

inline constexpr int kTileWords = 4096;                        // words per group of a reduction or scan
inline constexpr int kMaxPrimitiveWords = 65535 * kTileWords;  // what one dispatch reaches

/// Runs primitives on a device; owns the scratch buffers they need, which grow with use and are kept.
///
/// Words are std::uint32_t, std::int32_t or float. Counts are words, from 0 to kMaxPrimitiveWords and to the size of the
/// buffers; the words behind the first `count` are left alone. The buffers of one call must differ. Throws Error otherwise.
class ParallelPrimitives {
public:
    /// `device` must outlive the object.
    explicit ParallelPrimitives(Device& device) : device_(device) {}

    /// All words combined; of none, 0 for Sum and what changes nothing for Min and Max (the largest word; +-infinity).
    template <class Word>
    Word reduce(BufferId from, int count, CombineOp op);

    /// to[i] = from[0] op ... op from[i].
    template <class Word>
    void inclusive_scan(BufferId from, BufferId to, int count, CombineOp op);
    /// to[i] = from[0] op ... op from[i - 1]; to[0] is what the reduction of no word gives.
    template <class Word>
    void exclusive_scan(BufferId from, BufferId to, int count, CombineOp op);

    /// The words whose flag is not 0, in their order, to the front of `to`. Returns how many; what `to` cannot hold is dropped.
    int compact(BufferId from, BufferId flags, BufferId to, int count);
    /// The words that differ in a bit from the word before them: of sorted words, each once. Returns how many, as compact does.
    int unique(BufferId from, BufferId to, int count);

    /// Sorts the first `count` words, ascending and stable. Floats go by totalOrder of IEEE 754 5.10: -NaN, -infinity, ...,
    /// -0, +0, ..., +infinity, NaN.
    template <class Word>
    void radix_sort(BufferId keys, int count);
    /// The same; `values` (any words) move with their keys.
    template <class Word>
    void radix_sort(BufferId keys, BufferId values, int count);

private:
    struct Scratch {
        BufferId id = BufferId::None;
        int words = 0;
    };
    enum class KeyOrder { Unsigned, Signed, Float };

    /// A buffer of at least so many words whose content is undefined.
    BufferId scratch(Scratch& kept, std::string_view label, int words);
    /// Throws Error unless each buffer holds `count` words.
    void check(std::string_view what, int count, std::initializer_list<BufferId> buffers) const;
    [[nodiscard]] std::uint32_t word(BufferId id, int index) const;
    void run(std::string_view label, const ComputeProgram& program, std::span<const std::byte> constants, int groups);

    /// The tiles' combined words to `to`.
    template <class Monoid>
    void reduce_tiles(BufferId from, BufferId to, int count);
    template <class Monoid>
    std::uint32_t reduce_words(BufferId from, int count);
    template <class Monoid>
    void scan_words(BufferId from, BufferId to, int count, bool exclusive, std::size_t level);
    /// Words whose flag is 1 (others are 0) to the front of `to`.
    int compact_ones(BufferId from, BufferId ones, BufferId to, int count);
    void sort_words(BufferId keys, BufferId values, int count, KeyOrder order);

    Device& device_;
    std::vector<Scratch> sums_;     // per level of a reduction or scan
    std::vector<Scratch> carries_;  // per level of a scan
    Scratch ones_, places_;         // compaction
    Scratch keys_, values_;         // the other half of a sort
    Scratch digits_, starts_;       // its counts and their scan
};

}  // namespace gnomon
