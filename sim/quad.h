// Derivatives over 2x2 quads. D3D11.3 22.5.2, 22.5.4
//
// Coarse: one pair per quad, from the row and the column through one corner, which is the vendor's choice (top-left if not
// said). Fine: each lane's own row and own column.
#pragma once

#include "sim/double_lanes.h"
#include "sim/lanes.h"
#include "sim/profile_choices.h"

namespace gnomon {

/// Each lane gets the value of lane kLane (0..3) of its own quad.
template <int kLane>
Float quad_broadcast(Float x) {
    return Float(hn::Broadcast<kLane>(x.v));
}
template <int kLane>
Double quad_broadcast(const Double& x) {
    return Double::map([&](std::size_t i) { return x.v[(i & ~std::size_t{3}) + kLane]; });
}

inline Float ddx_coarse(Float x) { return quad_broadcast<1>(x) - quad_broadcast<0>(x); }
inline Float ddy_coarse(Float x) { return quad_broadcast<2>(x) - quad_broadcast<0>(x); }
inline Float ddx_fine(Float x) { return Float(hn::Sub(hn::DupOdd(x.v), hn::DupEven(x.v))); }
inline Float ddy_fine(Float x) {
    const hn::RepartitionToWide<detail::FloatTag> pairs;
    const auto rows = hn::BitCast(pairs, x.v);
    const auto top = hn::BitCast(detail::FloatTag{}, hn::DupEven(rows));
    const auto bottom = hn::BitCast(detail::FloatTag{}, hn::DupOdd(rows));
    return Float(hn::Sub(bottom, top));
}

inline Double ddx_coarse(const Double& x) { return quad_broadcast<1>(x) - quad_broadcast<0>(x); }
inline Double ddy_coarse(const Double& x) { return quad_broadcast<2>(x) - quad_broadcast<0>(x); }
inline Double ddx_fine(const Double& x) {
    return Double::map([&](std::size_t i) { return x.v[i | 1] - x.v[i & ~std::size_t{1}]; });
}
inline Double ddy_fine(const Double& x) {
    return Double::map([&](std::size_t i) { return x.v[i | 2] - x.v[i & ~std::size_t{2}]; });
}

/// Through any corner.
template <class Real>
Real ddx_coarse(const Real& x, DerivativeCorner corner) {
    const bool bottom = corner == DerivativeCorner::BottomLeft || corner == DerivativeCorner::BottomRight;
    return bottom ? quad_broadcast<3>(x) - quad_broadcast<2>(x) : ddx_coarse(x);
}
template <class Real>
Real ddy_coarse(const Real& x, DerivativeCorner corner) {
    const bool right = corner == DerivativeCorner::TopRight || corner == DerivativeCorner::BottomRight;
    return right ? quad_broadcast<3>(x) - quad_broadcast<1>(x) : ddy_coarse(x);
}

/// Lanes whose own row or column has a lane of `bits`: what the fine differences read.
inline std::uint32_t ddx_fine_readers(std::uint32_t bits) {
    const std::uint32_t any = (bits | bits >> 1) & 0x55555555u;
    return any | any << 1;
}
inline std::uint32_t ddy_fine_readers(std::uint32_t bits) {
    const std::uint32_t any = (bits | bits >> 2) & 0x33333333u;
    return any | any << 2;
}
/// Lanes of quads that have a lane of `bits` in the row or column through the corner: what the coarse differences read.
inline std::uint32_t ddx_coarse_readers(std::uint32_t bits, DerivativeCorner corner) {
    const bool bottom = corner == DerivativeCorner::BottomLeft || corner == DerivativeCorner::BottomRight;
    const std::uint32_t row = bottom ? bits >> 2 : bits;
    return ((row | row >> 1) & 0x11111111u) * 0xfu;
}
inline std::uint32_t ddy_coarse_readers(std::uint32_t bits, DerivativeCorner corner) {
    const bool right = corner == DerivativeCorner::TopRight || corner == DerivativeCorner::BottomRight;
    const std::uint32_t column = right ? bits >> 1 : bits;
    return ((column | column >> 2) & 0x11111111u) * 0xfu;
}

/// All four lanes of a quad, where any of them is set.
inline std::uint32_t quad_any(std::uint32_t bits) {
    const std::uint32_t any = (bits | bits >> 1 | bits >> 2 | bits >> 3) & 0x11111111u;
    return any * 0xfu & kAllLanes;
}

}  // namespace gnomon
