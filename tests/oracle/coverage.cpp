// Coverage by definition and by spans. D3D11.3 3.4.2.1, 3.5.4, 15.7, 15.11
#include "tests/oracle/coverage.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace oracle {

namespace {

/// The smallest integer not below n / d, d > 0.
std::int64_t ceil_div(std::int64_t n, std::int64_t d) { return n / d + (n % d > 0 ? 1 : 0); }

/// The smallest grid x not left of line pq on row y; q lies below p.
std::int64_t first_at_or_right(const Point& p, const Point& q, std::int64_t y) {
    return p.x + ceil_div((q.x - p.x) * (y - p.y), q.y - p.y);
}

/// Grid columns [left, right) of the triangle on row y. False where the row misses it.
bool span_on_row(const SnappedTriangle& t, std::int64_t y, std::int64_t& left, std::int64_t& right) {
    int met = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Point& a = t[i];
        const Point& b = t[(i + 1) % 3];
        const Point& upper = a.y < b.y ? a : b;
        const Point& lower = a.y < b.y ? b : a;
        if (!(upper.y <= y && y < lower.y)) continue;
        const std::int64_t x = first_at_or_right(upper, lower, y);
        left = met == 0 ? x : std::min(left, x);
        right = met == 0 ? x : std::max(right, x);
        ++met;
    }
    return met != 0;
}

}  // namespace

PixelRect intersection(const PixelRect& a, const PixelRect& b) {
    return {std::max(a.left, b.left), std::max(a.top, b.top), std::min(a.right, b.right), std::min(a.bottom, b.bottom)};
}

PixelRect implicit_scissor(float x, float y, float width, float height) {
    const auto floor = [](double v) { return static_cast<int>(std::floor(v)); };
    return {floor(x), floor(y), floor(static_cast<double>(x) + static_cast<double>(width)),
            floor(static_cast<double>(y) + static_cast<double>(height))};
}

Facing facing(const SnappedTriangle& t, bool front_is_counter_clockwise) {
    const std::int64_t area = turn(t[0], t[1], t[2]);
    return (front_is_counter_clockwise ? area < 0 : area > 0) ? Facing::Front : Facing::Back;
}

Masks::Masks(const PixelRect& rect)
    : rect_(rect),
      masks_(rect.empty()
                 ? 0
                 : static_cast<std::size_t>(rect.right - rect.left) * static_cast<std::size_t>(rect.bottom - rect.top)) {}

void Masks::clear() { std::fill(masks_.begin(), masks_.end(), 0u); }

std::uint64_t Masks::samples() const {
    std::uint64_t count = 0;
    for (const std::uint32_t mask : masks_) count += static_cast<std::uint64_t>(std::popcount(mask));
    return count;
}

std::uint32_t mask_by_definition(const SnappedTriangle& t, int x, int y, const SamplePattern& pattern) {
    std::uint32_t mask = 0;
    for (int i = 0; i < pattern.count; ++i)
        if (covers(t, pattern.at(x, y, i))) mask |= 1u << i;
    return mask;
}

void add_coverage(Masks& masks, const SnappedTriangle& t, const SamplePattern& pattern) {
    const PixelRect& rect = masks.rect();
    const auto [highest, lowest] = std::minmax({t[0].y, t[1].y, t[2].y});
    const auto pixel = [](std::int64_t grid) { return static_cast<int>(grid >> 8); };
    const int top = std::max(rect.top, pixel(highest));
    const int bottom = std::min(rect.bottom, pixel(lowest) + 1);
    for (int y = top; y < bottom; ++y)
        for (int i = 0; i < pattern.count; ++i) {
            const Point sample = pattern.at(0, y, i);
            std::int64_t left = 0;
            std::int64_t right = 0;
            if (!span_on_row(t, sample.y, left, right)) continue;
            // 256 x + sample.x in [left, right)
            const auto first = static_cast<int>((left - sample.x + 255) >> 8);
            const auto end = static_cast<int>((right - sample.x + 255) >> 8);
            for (int x = std::max(rect.left, first); x < std::min(rect.right, end); ++x) masks.at(x, y) |= 1u << i;
        }
}

Masks coverage(const SnappedTriangle& t, const PixelRect& rect, const SamplePattern& pattern) {
    Masks masks(rect);
    add_coverage(masks, t, pattern);
    return masks;
}

std::vector<CoveredPixel> covered_pixels(const Masks& masks) {
    std::vector<CoveredPixel> pixels;
    const PixelRect& rect = masks.rect();
    for (int y = rect.top; y < rect.bottom; ++y)
        for (int x = rect.left; x < rect.right; ++x)
            if (masks.at(x, y) != 0) pixels.push_back({x, y, masks.at(x, y)});
    return pixels;
}

SampleCounts::SampleCounts(const PixelRect& rect, const SamplePattern& pattern) : rect_(rect), pattern_(pattern) {
    const std::size_t pixels =
        static_cast<std::size_t>(rect.right - rect.left) * static_cast<std::size_t>(rect.bottom - rect.top);
    front_.assign(pixels * 16, 0);
    back_.assign(pixels * 16, 0);
}

void SampleCounts::add(const SnappedTriangle& t) { add(coverage(t, rect_, pattern_), oracle::facing(t)); }

void SampleCounts::add(const Masks& masks, Facing facing) {
    std::vector<int>& counts = facing == Facing::Front ? front_ : back_;
    for (const CoveredPixel& p : covered_pixels(masks))
        for (int i = 0; i < pattern_.count; ++i) counts[index(p.x, p.y, i)] += static_cast<int>(p.mask >> i & 1u);
}

}  // namespace oracle
