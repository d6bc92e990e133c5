// One value per pixel: Float, Int and Mask, as wide as the instruction set, on Google Highway (static dispatch).
//
// Lanes come in quads of four: top-left, top-right, bottom-left, bottom-right. D3D11.3 3.5.7
// Every operation here gives the same bits at any width: IEEE fp32 with one rounding per operation, two's complement integers.
// Nothing is fused, and nothing is left to the instruction set (NaN in min/max, float to integer out of range).
#pragma once

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

/// Functions on the path of every pixel: a call costs more than they do, because lane values travel through memory.
#define GNOMON_INLINE [[gnu::always_inline]] inline

namespace gnomon {

namespace hn = hwy::HWY_NAMESPACE;

namespace detail {
inline constexpr int kLaneLimit = 16;
using FloatTag = hn::CappedTag<float, kLaneLimit>;
using IntTag = hn::RebindToSigned<FloatTag>;
using UintTag = hn::RebindToUnsigned<FloatTag>;
using FloatVector = hn::Vec<FloatTag>;
using IntVector = hn::Vec<IntTag>;
using MaskVector = hn::Mask<FloatTag>;
}  // namespace detail

/// Pixels per wave: 4, 8 or 16.
inline constexpr int kLanes =
    static_cast<int>(HWY_LANES(float)) < detail::kLaneLimit ? static_cast<int>(HWY_LANES(float)) : detail::kLaneLimit;
inline constexpr int kQuadsPerWave = kLanes / 4;
inline constexpr std::uint32_t kAllLanes = (1u << kLanes) - 1u;
static_assert(kLanes == 4 || kLanes == 8 || kLanes == 16);

/// A truth value per lane.
struct Mask {
    detail::MaskVector m;

    Mask() : m(hn::FirstN(detail::FloatTag{}, 0)) {}
    explicit Mask(detail::MaskVector mask) : m(mask) {}
    explicit Mask(bool all) : m(hn::FirstN(detail::FloatTag{}, all ? static_cast<std::size_t>(kLanes) : 0)) {}

    /// Bit i of `bits` is lane i.
    static Mask from_bits(std::uint32_t bits) {
        const std::uint64_t word = bits;
        return Mask(hn::LoadMaskBits(detail::FloatTag{}, reinterpret_cast<const std::uint8_t*>(&word)));
    }
    [[nodiscard]] std::uint32_t bits() const {
        std::uint64_t bits = 0;  // as one word: put together from bytes it takes eight instructions
        static_assert(std::endian::native == std::endian::little);
        hn::StoreMaskBits(detail::FloatTag{}, m, reinterpret_cast<std::uint8_t*>(&bits));
        return static_cast<std::uint32_t>(bits) & kAllLanes;
    }

    friend Mask operator&(Mask a, Mask b) { return Mask(hn::And(a.m, b.m)); }
    friend Mask operator|(Mask a, Mask b) { return Mask(hn::Or(a.m, b.m)); }
    friend Mask operator^(Mask a, Mask b) { return Mask(hn::Xor(a.m, b.m)); }
    friend Mask operator!(Mask a) { return Mask(hn::Not(a.m)); }
};

inline bool any(Mask m) { return !hn::AllFalse(detail::FloatTag{}, m.m); }
inline bool all(Mask m) { return hn::AllTrue(detail::FloatTag{}, m.m); }
inline bool none(Mask m) { return hn::AllFalse(detail::FloatTag{}, m.m); }

/// A 32-bit two's complement integer per lane; + - * wrap.
struct Int {
    using Scalar = std::int32_t;
    detail::IntVector v;

    Int() : v(hn::Zero(detail::IntTag{})) {}
    Int(std::int32_t x) : v(hn::Set(detail::IntTag{}, x)) {}
    explicit Int(detail::IntVector x) : v(x) {}
    static Int load(const std::int32_t* p) { return Int(hn::LoadU(detail::IntTag{}, p)); }
    void store(std::int32_t* p) const { hn::StoreU(v, detail::IntTag{}, p); }
    [[nodiscard]] std::array<std::int32_t, kLanes> lanes() const {
        std::array<std::int32_t, kLanes> out;
        store(out.data());
        return out;
    }

    friend Int operator+(Int a, Int b) { return Int(hn::Add(a.v, b.v)); }
    friend Int operator-(Int a, Int b) { return Int(hn::Sub(a.v, b.v)); }
    friend Int operator*(Int a, Int b) { return Int(hn::Mul(a.v, b.v)); }
    friend Int operator&(Int a, Int b) { return Int(hn::And(a.v, b.v)); }
    friend Int operator|(Int a, Int b) { return Int(hn::Or(a.v, b.v)); }
    friend Int operator^(Int a, Int b) { return Int(hn::Xor(a.v, b.v)); }
    friend Int operator~(Int a) { return Int(hn::Not(a.v)); }
    Int& operator+=(Int b) { return *this = *this + b; }

    friend Mask operator<(Int a, Int b) { return mask(hn::Lt(a.v, b.v)); }
    friend Mask operator>(Int a, Int b) { return mask(hn::Gt(a.v, b.v)); }
    friend Mask operator<=(Int a, Int b) { return !(a > b); }
    friend Mask operator>=(Int a, Int b) { return !(a < b); }
    friend Mask operator==(Int a, Int b) { return mask(hn::Eq(a.v, b.v)); }
    friend Mask operator!=(Int a, Int b) { return !(a == b); }

private:
    static Mask mask(hn::Mask<detail::IntTag> m) { return Mask(hn::RebindMask(detail::FloatTag{}, m)); }
};

template <int kBits>
Int shift_left(Int a) {
    return Int(hn::ShiftLeft<kBits>(a.v));
}
/// Arithmetic: the sign comes in from the left.
template <int kBits>
Int shift_right(Int a) {
    return Int(hn::ShiftRight<kBits>(a.v));
}
/// Arithmetic, by the same count in every lane, 0 <= count < 32.
inline Int shift_right(Int a, int count) { return Int(hn::ShiftRightSame(a.v, count)); }
/// Logical: zeros come in from the left.
template <int kBits>
Int shift_right_logical(Int a) {
    return Int(hn::BitCast(detail::IntTag{}, hn::ShiftRight<kBits>(hn::BitCast(detail::UintTag{}, a.v))));
}
/// Logical shifts by a count per lane, 0 <= count < 32.
inline Int shift_right_logical(Int a, Int count) {
    const detail::UintTag du;
    return Int(hn::BitCast(detail::IntTag{}, hn::Shr(hn::BitCast(du, a.v), hn::BitCast(du, count.v))));
}
inline Int shift_left(Int a, Int count) { return Int(hn::Shl(a.v, count.v)); }

inline Int min(Int a, Int b) { return Int(hn::Min(a.v, b.v)); }
inline Int max(Int a, Int b) { return Int(hn::Max(a.v, b.v)); }
inline std::int32_t max_of_lanes(Int x) { return hn::GetLane(hn::MaxOfLanes(detail::IntTag{}, x.v)); }
inline std::int32_t min_of_lanes(Int x) { return hn::GetLane(hn::MinOfLanes(detail::IntTag{}, x.v)); }
inline Int clamp(Int x, Int low, Int high) { return min(max(x, low), high); }
inline Int select(Mask m, Int yes, Int no) { return Int(hn::IfThenElse(hn::RebindMask(detail::IntTag{}, m.m), yes.v, no.v)); }

/// An IEEE binary32 per lane.
struct Float {
    using Scalar = float;
    detail::FloatVector v;

    Float() : v(hn::Zero(detail::FloatTag{})) {}
    Float(float x) : v(hn::Set(detail::FloatTag{}, x)) {}
    explicit Float(detail::FloatVector x) : v(x) {}
    explicit Float(Int x) : v(hn::ConvertTo(detail::FloatTag{}, x.v)) {}  // round to nearest even
    static Float load(const float* p) { return Float(hn::LoadU(detail::FloatTag{}, p)); }
    void store(float* p) const { hn::StoreU(v, detail::FloatTag{}, p); }
    [[nodiscard]] std::array<float, kLanes> lanes() const {
        std::array<float, kLanes> out;
        store(out.data());
        return out;
    }

    friend Float operator+(Float a, Float b) { return Float(hn::Add(a.v, b.v)); }
    friend Float operator-(Float a, Float b) { return Float(hn::Sub(a.v, b.v)); }
    friend Float operator*(Float a, Float b) { return Float(hn::Mul(a.v, b.v)); }
    friend Float operator/(Float a, Float b) { return Float(hn::Div(a.v, b.v)); }
    friend Float operator-(Float a) { return Float(hn::Neg(a.v)); }
    Float& operator+=(Float b) { return *this = *this + b; }
    Float& operator-=(Float b) { return *this = *this - b; }
    Float& operator*=(Float b) { return *this = *this * b; }

    friend Mask operator<(Float a, Float b) { return Mask(hn::Lt(a.v, b.v)); }
    friend Mask operator>(Float a, Float b) { return Mask(hn::Gt(a.v, b.v)); }
    friend Mask operator<=(Float a, Float b) { return Mask(hn::Le(a.v, b.v)); }
    friend Mask operator>=(Float a, Float b) { return Mask(hn::Ge(a.v, b.v)); }
    friend Mask operator==(Float a, Float b) { return Mask(hn::Eq(a.v, b.v)); }
    // Not hn::Ne: with a NaN that is true on SSE and false on AVX. D3D11.3 3.1.3.1 says true.
    friend Mask operator!=(Float a, Float b) { return !(a == b); }
};

inline Float select(Mask m, Float yes, Float no) { return Float(hn::IfThenElse(m.m, yes.v, no.v)); }
inline Mask is_nan(Float x) { return x != x; }

/// A NaN operand gives the other one; of two zeros, the second. D3D11.3 3.1.3.1
inline Float min(Float a, Float b) { return select((a < b) | is_nan(b), a, b); }
inline Float max(Float a, Float b) { return select((a > b) | is_nan(b), a, b); }
/// NaN gives `low`.
inline Float clamp(Float x, Float low, Float high) { return min(max(x, low), high); }
/// The same with ends that are numbers.
inline Float clamp_to_numbers(Float x, Float low, Float high) {
    const Float above = select(x > low, x, low);
    return select(above < high, above, high);
}
inline Float saturate(Float x) { return clamp_to_numbers(x, Float(0.0f), Float(1.0f)); }

/// a b + c with one rounding, on any instruction set: what a model of fused hardware asks for by name.
inline Float fused_multiply_add(Float a, Float b, Float c) {
#if HWY_NATIVE_FMA
    return Float(hn::MulAdd(a.v, b.v, c.v));
#else
    const auto x = a.lanes();
    const auto y = b.lanes();
    auto z = c.lanes();
    for (std::size_t i = 0; i < z.size(); ++i) z[i] = std::fma(x[i], y[i], z[i]);
    return Float::load(z.data());
#endif
}

inline Float abs(Float x) { return Float(hn::Abs(x.v)); }
inline Float sqrt(Float x) { return Float(hn::Sqrt(x.v)); }  // correctly rounded
// NaN and infinities stay, and so does the sign of a zero: Highway loses it where it has no instruction to round.
inline Float floor(Float x) { return Float(hn::CopySign(hn::Floor(x.v), x.v)); }
inline Float round(Float x) { return Float(hn::CopySign(hn::Round(x.v), x.v)); }  // to nearest even

inline Int bits_of(Float x) { return Int(hn::BitCast(detail::IntTag{}, x.v)); }
inline Float float_of_bits(Int x) { return Float(hn::BitCast(detail::FloatTag{}, x.v)); }

/// To integer, toward zero and to nearest even: NaN gives 0, out of range saturates to +-2147483520. D3D11.3 3.2.4.1
inline Int truncate_to_int(Float x) {
    const Float limited = clamp(select(is_nan(x), Float(0.0f), x), Float(-2147483520.0f), Float(2147483520.0f));
    return Int(hn::ConvertTo(detail::IntTag{}, limited.v));
}
inline Int round_to_int(Float x) {
    const Float limited = clamp(select(is_nan(x), Float(0.0f), x), Float(-2147483520.0f), Float(2147483520.0f));
    return Int(hn::NearestInt(limited.v));
}
/// The same where the caller knows that |x| < 2^31 or x is NaN.
inline Int bounded_truncate_to_int(Float x) {
    return Int(hn::ConvertTo(detail::IntTag{}, select(is_nan(x), Float(0.0f), x).v));
}
inline Int bounded_round_to_int(Float x) { return Int(hn::NearestInt(select(is_nan(x), Float(0.0f), x).v)); }

/// Reads 32 bits per lane at `base + byte_offset`; every lane is read, so every offset must be valid.
inline Int gather_bits(const std::byte* base, Int byte_offset) {
    return Int(hn::GatherOffset(detail::IntTag{}, reinterpret_cast<const std::int32_t*>(base), byte_offset.v));
}
/// Reads two words per lane at `base + byte_offset`: half the loads of two gathers of one word.
struct IntPair {
    Int first, second;
};
inline IntPair gather_pairs(const std::byte* base, Int byte_offset) {
    const hn::RepartitionToWide<detail::IntTag> wide;
    const hn::Half<detail::IntTag> half;
    const auto* words = reinterpret_cast<const std::int64_t*>(base);
    const auto lower = hn::GatherOffset(wide, words, hn::PromoteTo(wide, hn::LowerHalf(half, byte_offset.v)));
    const auto upper = hn::GatherOffset(wide, words, hn::PromoteTo(wide, hn::UpperHalf(half, byte_offset.v)));
    const auto a = hn::BitCast(detail::IntTag{}, lower);
    const auto b = hn::BitCast(detail::IntTag{}, upper);
    return {Int(hn::ConcatEven(detail::IntTag{}, b, a)), Int(hn::ConcatOdd(detail::IntTag{}, b, a))};
}
/// table[index] per lane.
inline Int gather(const std::int32_t* table, Int index) { return Int(hn::GatherIndex(detail::IntTag{}, table, index.v)); }

/// 0, 1, 2, ... by lane.
inline Int lane_index() { return Int(hn::Iota(detail::IntTag{}, 0)); }

/// The value of one lane.
inline float lane(Float x, int i) { return x.lanes()[static_cast<std::size_t>(i)]; }
inline std::int32_t lane(Int x, int i) { return x.lanes()[static_cast<std::size_t>(i)]; }

}  // namespace gnomon
