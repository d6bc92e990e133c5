// llvmpipe 22.3: triangles.
//
// - A vertex becomes a pixel position by a fused multiply-add, unless clipping made it: then without.
// - Everything outside the view volume is clipped, there is no guard band; what is left is a fan of triangles, each snapped to
//   1/256 pixel and given planes of its own.
// - Depth and attributes are planes through the positions that were not snapped, from the target's corner; they are
//   evaluated with fused multiply-adds.
// - With four samples the scissor's left and upper edges lie half a pixel outside, but where they are edges of the tiles of 64
//   pixels: what is not clipped there reaches into the samples of the next column and row that are that near.
// - Denormals are zero.
#include "tests/agree/driver_model_parts.h"

namespace gnomon::agree {
namespace {

constexpr Flushing kFp;
float add(float a, float b) { return kFp.add(a, b); }
float sub(float a, float b) { return kFp.sub(a, b); }
float mul(float a, float b) { return kFp.mul(a, b); }
float div(float a, float b) { return kFp.div(a, b); }
float fused(float a, float b, float c) { return kFp.fused(a, b, c); }

struct Scale {
    std::array<float, 3> scale;
    std::array<float, 3> translate;

    explicit Scale(const Viewport& v) {
        scale = {0.5f * static_cast<float>(v.width), 0.5f * static_cast<float>(v.height), 1};
        translate = {scale[0] + static_cast<float>(v.x), scale[1] + static_cast<float>(v.y), 0};
    }
};

struct Vertex {
    std::array<float, 4> clip{};
    std::array<float, 4> window{};  // x, y, z, 1/w
    Color color{};
};

Vertex shaded(const ClipVertex& in, const Scale& to) {
    Vertex v{.clip = in.clip, .color = in.color};
    v.window[3] = div(1.0f, in.clip[3]);
    for (std::size_t i = 0; i < 3; ++i) v.window[i] = fused(mul(in.clip[i], v.window[3]), to.scale[i], to.translate[i]);
    return v;
}

// Comparisons with NaN are true.
unsigned clip_flags(const std::array<float, 4>& p) {
    const auto greater = [](float a, float b) { return !(kFp(a) <= kFp(b)); };
    unsigned flags = 0;
    if (greater(p[0], p[3])) flags |= 1u;
    if (greater(0, add(p[0], p[3]))) flags |= 2u;
    if (greater(p[1], p[3])) flags |= 4u;
    if (greater(0, add(p[1], p[3]))) flags |= 8u;
    if (greater(0, p[2])) flags |= 16u;
    if (greater(p[2], p[3])) flags |= 32u;
    return flags;
}

constexpr std::array<std::array<float, 4>, 6> kPlanes{
    {{-1, 0, 0, 1}, {1, 0, 0, 1}, {0, -1, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 0}, {0, 0, -1, 1}}};

float distance(const Vertex& v, std::size_t plane) {
    float sum = mul(v.clip[0], kPlanes[plane][0]);
    for (std::size_t i = 1; i < 4; ++i) sum = add(sum, mul(v.clip[i], kPlanes[plane][i]));
    return sum;
}

template <std::size_t kCount>
std::array<float, kCount> between(float t, const std::array<float, kCount>& out, const std::array<float, kCount>& in) {
    std::array<float, kCount> result{};
    for (std::size_t i = 0; i < kCount; ++i) result[i] = add(out[i], mul(t, sub(in[i], out[i])));
    return result;
}

Vertex crossing(float t, const Vertex& out, const Vertex& in, const Scale& to) {
    Vertex v{.clip = between(t, out.clip, in.clip), .color = between(t, out.color, in.color)};
    v.window[3] = div(1.0f, v.clip[3]);
    for (std::size_t i = 0; i < 3; ++i) v.window[i] = add(mul(mul(v.clip[i], v.window[3]), to.scale[i]), to.translate[i]);
    return v;
}

// The part on the inner side of a plane; empty where a distance is not finite.
std::vector<Vertex> clipped(const std::vector<Vertex>& polygon, std::size_t plane, const Scale& to) {
    std::vector<Vertex> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vertex& from = polygon[i];
        const Vertex& next = polygon[(i + 1) % polygon.size()];
        const float d0 = distance(from, plane);
        const float d1 = distance(next, plane);
        if (!std::isfinite(d0) || !std::isfinite(d1)) return {};
        if (d0 >= 0) kept.push_back(from);
        if ((d0 >= 0) == (d1 >= 0)) continue;
        // The parameter runs from the vertex that is nearer to the plane.
        const float length = sub(d1, d0);
        const bool from_next = d1 < 0 ? -d1 < d0 : !(-d0 < d1);
        kept.push_back(from_next ? crossing(div(d1, length), next, from, to) : crossing(div(-d0, length), from, next, to));
    }
    return kept;
}

// The triangles that are set up.
std::vector<std::array<Vertex, 3>> drawn_triangles(const ClipTriangle& triangle, const Viewport& viewport) {
    const Scale to(viewport);
    std::vector<Vertex> polygon;
    unsigned any = 0;
    unsigned all = ~0u;
    for (const ClipVertex& vertex : triangle) {
        polygon.push_back(shaded(vertex, to));
        const unsigned flags = clip_flags(vertex.clip);
        any |= flags;
        all &= flags;
    }
    if (all != 0) return {};
    for (std::size_t plane = 0; plane < kPlanes.size() && polygon.size() >= 3; ++plane)
        if ((any >> plane & 1u) != 0) polygon = clipped(polygon, plane, to);
    std::vector<std::array<Vertex, 3>> fan;
    for (std::size_t i = 2; i < polygon.size(); ++i) fan.push_back({polygon[0], polygon[i - 1], polygon[i]});
    return fan;
}

struct Point {
    std::int64_t x, y;  // 1/256 pixel
};
std::int64_t turn(const Point& p, const Point& q, const Point& r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
}

// A triangle clockwise on the screen, the first vertex first, and its grid points with pixel centres (one sample) or corners
// (four) at multiples of 256.
struct SetUp {
    std::array<Vertex, 3> v;
    std::array<Point, 3> p;
    float center;  // what was taken off the positions

    SetUp(const std::array<Vertex, 3>& vertices, int samples) : v(vertices), center(samples == 1 ? 0.5f : 0.0f) {
        for (std::size_t i = 0; i < 3; ++i) p[i] = {snapped(v[i].window[0]), snapped(v[i].window[1])};
        if (turn(p[0], p[1], p[2]) < 0) {
            std::swap(v[1], v[2]);
            std::swap(p[1], p[2]);
        }
    }

    [[nodiscard]] std::int64_t snapped(float position) const { return round_to_int(mul(sub(position, center), 256.0f)); }

    [[nodiscard]] bool covers(const Point& s) const {
        if (turn(p[0], p[1], p[2]) == 0) return false;
        for (std::size_t i = 0; i < 3; ++i) {
            const Point& a = p[i];
            const Point& b = p[(i + 1) % 3];
            const std::int64_t side = turn(a, b, s);
            const bool is_top_left = b.y < a.y || (b.y == a.y && b.x > a.x);
            if (side < 0 || (side == 0 && !is_top_left)) return false;
        }
        return true;
    }
};

std::uint32_t mask_of(const SetUp& t, int x, int y, int samples) {
    if (samples == 1) return t.covers({std::int64_t{x} * 256, std::int64_t{y} * 256}) ? 1 : 0;
    std::uint32_t mask = 0;
    for (std::size_t s = 0; s < 4; ++s) {
        const Point point{std::int64_t{x} * 256 + kSampleEighths[s][0] * 32, std::int64_t{y} * 256 + kSampleEighths[s][1] * 32};
        if (t.covers(point)) mask |= 1u << s;
    }
    return mask;
}

// One axis of the pixels that may be covered, and of the scissor, of which it may begin one pixel outside.
struct Range {
    int first, last, scissor;

    Range(std::int64_t from, std::int64_t to, int origin, int size, int samples)
        : first(clamped(from, origin, size)), last(clamped(to + 1, origin, size)), scissor(origin) {
        constexpr int kTile = 64;
        if (samples > 1 && from < origin && to >= origin && origin % kTile != 0) first = origin - 1;
    }

    [[nodiscard]] static int clamped(std::int64_t value, int origin, int size) {
        return static_cast<int>(std::clamp<std::int64_t>(value, origin, origin + size));
    }
    [[nodiscard]] bool keeps(int pixel, int eighths) const { return pixel >= scissor || eighths >= 4; }
};

template <class Sink>
void each_pixel(const SetUp& t, const Window& window, const Sink& sink) {
    const auto [left, right] = std::minmax({t.p[0].x, t.p[1].x, t.p[2].x});
    const auto [top, bottom] = std::minmax({t.p[0].y, t.p[1].y, t.p[2].y});
    const Range columns(left >> 8, (right - 1) >> 8, window.scissor.x, window.scissor.width, window.samples);
    const Range rows(top >> 8, (bottom - 1) >> 8, window.scissor.y, window.scissor.height, window.samples);
    for (int y = rows.first; y < rows.last; ++y)
        for (int x = columns.first; x < columns.last; ++x) {
            std::uint32_t mask = mask_of(t, x, y, window.samples);
            if (window.samples > 1)
                for (std::size_t s = 0; s < 4; ++s)
                    if (!columns.keeps(x, kSampleEighths[s][0]) || !rows.keeps(y, kSampleEighths[s][1])) mask &= ~(1u << s);
            if (mask != 0) sink(x, y, mask);
        }
}

// value = origin + x dx + y dy, x and y in pixels of the target.
struct Plane {
    float origin, dx, dy;

    [[nodiscard]] float at(float x, float y) const { return fused(dy, y, fused(dx, x, origin)); }
};

// The parts of a plane that depend on the positions alone, which are not the snapped ones.
struct PlaneMaker {
    float x0, y0, dx01, dy01, dx20, dy20, over_area;

    explicit PlaneMaker(const SetUp& t) {
        const auto& [a, b, c] = t.v;
        x0 = sub(a.window[0], t.center);
        y0 = sub(a.window[1], t.center);
        dx01 = sub(a.window[0], b.window[0]);
        dy01 = sub(a.window[1], b.window[1]);
        dx20 = sub(c.window[0], a.window[0]);
        dy20 = sub(c.window[1], a.window[1]);
        over_area = div(1.0f, sub(mul(dx01, dy20), mul(dy01, dx20)));
    }

    [[nodiscard]] Plane through(float a, float b, float c) const {
        const float d01 = sub(a, b);
        const float d20 = sub(c, a);
        Plane plane{};
        plane.dx = sub(mul(d01, mul(dy20, over_area)), mul(d20, mul(dy01, over_area)));
        plane.dy = sub(mul(d20, mul(dx01, over_area)), mul(d01, mul(dx20, over_area)));
        plane.origin = sub(a, add(mul(plane.dx, x0), mul(plane.dy, y0)));
        return plane;
    }
};

// What the bias adds to every fragment's depth.
float bias_of(const SetUp& t, const PlaneMaker& maker, const DepthDraw& draw) {
    if (draw.bias_constant == 0 && draw.bias_slope == 0) return 0;
    const std::array<float, 3> z{t.v[0].window[2], t.v[1].window[2], t.v[2].window[2]};
    const float dz01 = sub(z[0], z[1]);
    const float dz20 = sub(z[2], z[0]);
    const float over_x = std::abs(mul(sub(mul(dz20, maker.dy01), mul(maker.dy20, dz01)), maker.over_area));
    const float over_y = std::abs(mul(sub(mul(maker.dx20, dz01), mul(dz20, maker.dx01)), maker.over_area));
    const float slope = mul(over_x > over_y ? over_x : over_y, draw.bias_slope);
    if (draw.format != DepthFormat::D32f) {
        // Twice the resolution, as OpenGL's drivers have it.
        const double step = 1.0 / (draw.format == DepthFormat::D16 ? 65535.0 : 16777215.0);
        return add(static_cast<float>(static_cast<double>(draw.bias_constant) * step * 2), slope);
    }
    const float largest = std::max({std::abs(z[0]), std::abs(z[1]), std::abs(z[2])});
    const std::int32_t exponent = (std::bit_cast<std::int32_t>(largest) & (0xff << 23)) - (23 << 23);
    return add(mul(std::bit_cast<float>(std::max(exponent, 0)), draw.bias_constant), slope);
}

}  // namespace

void llvmpipe_coverage(const ClipTriangle& triangle, const Window& window, const PixelSink& sink) {
    for (const auto& vertices : drawn_triangles(triangle, window.viewport))
        each_pixel(SetUp(vertices, window.samples), window, sink);
}

void llvmpipe_depth(const ClipTriangle& triangle, const DepthDraw& draw, const DepthSink& sink) {
    const Viewport viewport{0, 0, draw.width, draw.height};
    for (const auto& vertices : drawn_triangles(triangle, viewport)) {
        const SetUp t(vertices, draw.samples);
        const PlaneMaker maker(t);
        const Plane plane = maker.through(t.v[0].window[2], t.v[1].window[2], t.v[2].window[2]);
        const float bias = bias_of(t, maker, draw);
        each_pixel(t, whole_window(viewport, draw.samples), [&](int x, int y, std::uint32_t mask) {
            for (int s = 0; s < draw.samples; ++s) {
                if ((mask >> s & 1u) == 0) continue;
                const auto& eighths = kSampleEighths[static_cast<std::size_t>(s)];
                const float sx = draw.samples == 1 ? 0 : static_cast<float>(eighths[0]) / 8;
                const float sy = draw.samples == 1 ? 0 : static_cast<float>(eighths[1]) / 8;
                const float z = add(plane.at(static_cast<float>(x) + sx, static_cast<float>(y) + sy), bias);
                sink(x, y, s, max_ps(min_ps(z, 1.0f), 0.0f));
            }
        });
    }
}

void llvmpipe_attributes(const ClipTriangle& triangle, const Viewport& viewport, Interpolation interpolation,
                         std::span<Color> target) {
    for (const auto& vertices : drawn_triangles(triangle, viewport)) {
        const SetUp t(vertices, 1);
        const PlaneMaker maker(t);
        const bool perspective = interpolation == Interpolation::Perspective;
        const Plane over_w = maker.through(t.v[0].window[3], t.v[1].window[3], t.v[2].window[3]);
        std::array<Plane, 4> planes{};
        for (std::size_t c = 0; c < 4; ++c) {
            std::array<float, 3> a{t.v[0].color[c], t.v[1].color[c], t.v[2].color[c]};
            if (perspective)
                for (std::size_t i = 0; i < 3; ++i) a[i] = mul(a[i], t.v[i].window[3]);
            planes[c] = maker.through(a[0], a[1], a[2]);
        }
        each_pixel(t, whole_window(viewport, 1), [&](int x, int y, std::uint32_t) {
            const auto fx = static_cast<float>(x);
            const auto fy = static_cast<float>(y);
            const float w = div(1.0f, over_w.at(fx, fy));
            Color& out = target[static_cast<std::size_t>(y * viewport.width + x)];
            for (std::size_t c = 0; c < 4; ++c) out[c] = perspective ? mul(planes[c].at(fx, fy), w) : planes[c].at(fx, fy);
        });
    }
}

std::uint32_t llvmpipe_depth_code(DepthFormat format, float z) {
    switch (format) {
        case DepthFormat::D16: {
            // Scaled to 2^16 less one part, then rounded by the addition that aligns the code with the mantissa.
            const float scaled = z * (65535.0f / 65536.0f);
            return std::bit_cast<std::uint32_t>(scaled + 128.0f) & 0xffffu;
        }
        case DepthFormat::D24: return static_cast<std::uint32_t>(round_to_int(z * 16777215.0f));
        case DepthFormat::D32f: return std::bit_cast<std::uint32_t>(z);
    }
    return 0;
}

}  // namespace gnomon::agree
