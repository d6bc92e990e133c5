// Arrays of 32-bit words that lanes read and write by index: the memory side of buffers and of group-shared memory.
//
// Indices are unsigned: a negative Int is past every end. Reads out of range give 0, writes and atomics out of range do
// nothing. D3D11.3 22.4.10, 22.4.11, 22.4.12, 22.4.13, 22.17.8 and after. Of group-shared memory the specification leaves both
// undefined: here it is the same.
#pragma once

#include "sim/double_lanes.h"
#include "sim/lanes.h"

#include <atomic>
#include <bit>
#include <cstdint>

namespace gnomon {

/// Lanes of `wanted` whose index lies in [0, count).
GNOMON_INLINE Mask in_range(Int index, std::int32_t count, Mask wanted) {
    return wanted & (index >= Int(0)) & (index < Int(count));
}

/// Calls visit(lane) for every set lane, in order.
template <class Visit>
void for_each_lane(Mask mask, const Visit& visit) {
    for (std::uint32_t bits = mask.bits(); bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(std::countr_zero(bits)));
}

/// Every lane's index is one more than that of the lane before: the usual case, and one plain load or store.
GNOMON_INLINE bool consecutive(Int index) { return all(index == Int(lane(index, 0)) + lane_index()); }

/// words[index] where `valid`, else 0. `valid` lanes must be in range; no other word is touched.
GNOMON_INLINE Int load_words(const std::int32_t* words, Int index, Mask valid) {
    if (all(valid)) {
        if (consecutive(index)) return Int::load(words + lane(index, 0));
        return gather(words, index);
    }
    const std::uint32_t bits = valid.bits();
    if (bits == 0) return Int(0);
    const Int inside = select(valid, index, Int(lane(index, std::countr_zero(bits))));
    return select(valid, gather(words, inside), Int(0));
}

/// words[index] = value where `valid`; of lanes with one index the last wins.
GNOMON_INLINE void store_words(std::int32_t* words, Int index, Int value, Mask valid) {
    if (all(valid) && consecutive(index)) {
        value.store(words + lane(index, 0));
        return;
    }
    const auto to = index.lanes();
    const auto from = value.lanes();
    for_each_lane(valid, [&](std::size_t i) { words[to[i]] = from[i]; });
}

/// Read-modify-write of one word. What they leave does not depend on their order.
/// D3D11.3 22.17.8, 22.17.9, 22.17.10, 22.17.12, 22.17.13, 22.17.14, 22.17.15, 22.17.16
enum class AtomicOp { Add, And, Or, Xor, Min, Max, MinUnsigned, MaxUnsigned };

template <AtomicOp kOp>
constexpr std::int32_t atomic_result(std::int32_t old, std::int32_t operand) {
    const auto a = static_cast<std::uint32_t>(old);
    const auto b = static_cast<std::uint32_t>(operand);
    switch (kOp) {
        case AtomicOp::Add: return static_cast<std::int32_t>(a + b);
        case AtomicOp::And: return old & operand;
        case AtomicOp::Or: return old | operand;
        case AtomicOp::Xor: return old ^ operand;
        case AtomicOp::Min: return old < operand ? old : operand;
        case AtomicOp::Max: return old > operand ? old : operand;
        case AtomicOp::MinUnsigned: return a < b ? old : operand;
        case AtomicOp::MaxUnsigned: return a > b ? old : operand;
    }
    __builtin_unreachable();
}

/// On memory that only this thread sees.
template <AtomicOp kOp>
void update_words(std::int32_t* words, Int index, Int operand, Mask valid) {
    const auto to = index.lanes();
    const auto from = operand.lanes();
    for_each_lane(valid, [&](std::size_t i) { words[to[i]] = atomic_result<kOp>(words[to[i]], from[i]); });
}
/// On memory that groups share.
template <AtomicOp kOp>
void update_words_atomically(std::int32_t* words, Int index, Int operand, Mask valid) {
    const auto to = index.lanes();
    const auto from = operand.lanes();
    for_each_lane(valid, [&](std::size_t i) {
        const std::atomic_ref<std::int32_t> word(words[to[i]]);
        std::int32_t old = word.load(std::memory_order_relaxed);
        while (!word.compare_exchange_weak(old, atomic_result<kOp>(old, from[i]), std::memory_order_relaxed)) {
        }
    });
}

/// An array in group-shared memory, of Int, Float or Double lanes.
template <class Lane>
struct SharedArray {
    using Word = std::conditional_t<std::is_same_v<Lane, Double>, double, std::int32_t>;
    Word* words = nullptr;
    std::int32_t count = 0;
};

GNOMON_INLINE Int load_shared(const SharedArray<Int>& array, Int index, Mask valid) {
    return load_words(array.words, index, valid);
}
GNOMON_INLINE Float load_shared(const SharedArray<Float>& array, Int index, Mask valid) {
    return float_of_bits(load_words(array.words, index, valid));
}
inline Double load_shared(const SharedArray<Double>& array, Int index, Mask valid) {
    Double result;
    const auto from = index.lanes();
    for_each_lane(valid, [&](std::size_t i) { result.v[i] = array.words[from[i]]; });
    return result;
}
GNOMON_INLINE void store_shared(const SharedArray<Int>& array, Int index, Int value, Mask valid) {
    store_words(array.words, index, value, valid);
}
GNOMON_INLINE void store_shared(const SharedArray<Float>& array, Int index, Float value, Mask valid) {
    store_words(array.words, index, bits_of(value), valid);
}
inline void store_shared(const SharedArray<Double>& array, Int index, const Double& value, Mask valid) {
    const auto to = index.lanes();
    for_each_lane(valid, [&](std::size_t i) { array.words[to[i]] = value.v[i]; });
}

}  // namespace gnomon
