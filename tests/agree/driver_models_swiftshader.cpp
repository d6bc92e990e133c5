// SwiftShader with 4 sub-pixel bits: triangles.
//
// - A vertex becomes a grid point at once: the viewport's scale and offset are in 1/16 pixel, with pixel centres at multiples.
// - Everything outside the view volume is clipped, there is no guard band; what is left is snapped and filled as one polygon,
//   by scanlines with exact remainders.
// - The winding is that of the whole triangle's grid points, by an area in fp32: where its sign is wrong nothing is drawn.
// - Depth is a plane through grid points, from the vertex of largest w. With four samples it is taken at the mirror image of
//   the sample's x.
#include "tests/agree/driver_model_parts.h"

namespace gnomon::agree {
namespace {

constexpr Flushing kFp;
float add(float a, float b) { return kFp.add(a, b); }
float sub(float a, float b) { return kFp.sub(a, b); }
float mul(float a, float b) { return kFp.mul(a, b); }
float div(float a, float b) { return kFp.div(a, b); }

constexpr int kBits = 4;
constexpr int kOne = 1 << kBits;
constexpr int kMask = kOne - 1;

struct Scale {
    float width, height, x0, y0;  // 1/16 pixel

    explicit Scale(const Viewport& v) {
        const float half_width = 0.5f * static_cast<float>(v.width);
        const float half_height = 0.5f * static_cast<float>(v.height);
        width = half_width * kOne;
        height = half_height * kOne;
        x0 = (static_cast<float>(v.x) + half_width) * kOne - kOne / 2;
        y0 = (static_cast<float>(v.y) + half_height) * kOne - kOne / 2;
    }
};

struct Point {
    std::int32_t x, y;
};

struct Vertex {
    std::array<float, 4> clip{};
    Point grid{};
    float z = 0;
    float over_w = 0;
    Color color{};
};

Point grid_point(const std::array<float, 4>& clip, float over_w, const Scale& to) {
    constexpr float kLargest = 2147483520.0f;
    return {round_to_int(min_ps(add(to.x0, mul(mul(clip[0], over_w), to.width)), kLargest)),
            round_to_int(min_ps(add(to.y0, mul(mul(clip[1], over_w), to.height)), kLargest))};
}

Vertex shaded(const ClipVertex& in, const Scale& to) {
    Vertex v{.clip = in.clip, .color = in.color};
    // A w of zero gets the bits of 1 on top: -0 becomes -1.
    const float w = in.clip[3];
    v.over_w = div(1.0f, kFp(w) == 0 ? std::bit_cast<float>(std::bit_cast<std::uint32_t>(w) | 0x3f800000u) : w);
    v.grid = grid_point(v.clip, v.over_w, to);
    v.z = mul(v.clip[2], v.over_w);
    return v;
}

using Clip = std::array<float, 4>;

// Distances to the planes in the order of clipping: near, far, left, right, top, bottom.
float distance(const Clip& v, std::size_t plane) {
    switch (plane) {
        case 0: return v[2];
        case 1: return sub(v[3], v[2]);
        case 2: return add(v[3], v[0]);
        case 3: return sub(v[3], v[0]);
        case 4: return sub(v[3], v[1]);
        default: return add(v[3], v[1]);
    }
}

bool is_outside(const Clip& given, std::size_t plane) {
    const Clip v{kFp(given[0]), kFp(given[1]), kFp(given[2]), kFp(given[3])};
    switch (plane) {
        case 0: return !(0 <= v[2]);
        case 1: return v[3] < v[2];
        case 2: return !(-v[3] <= v[0]);
        case 3: return v[3] < v[0];
        case 4: return v[3] < v[1];
        default: return !(-v[3] <= v[1]);
    }
}

Clip crossing(const Clip& in, const Clip& out, float d_in, float d_out) {
    const float scale = div(1.0f, sub(d_out, d_in));
    Clip v{};
    for (std::size_t i = 0; i < 4; ++i) v[i] = mul(sub(mul(d_out, in[i]), mul(d_in, out[i])), scale);
    return v;
}

std::vector<Clip> clipped(const std::vector<Clip>& polygon, std::size_t plane) {
    std::vector<Clip> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Clip& a = polygon[i];
        const Clip& b = polygon[(i + 1) % polygon.size()];
        const float da = distance(a, plane);
        const float db = distance(b, plane);
        if (da >= 0) {
            kept.push_back(a);
            if (db < 0) kept.push_back(crossing(a, b, da, db));
        } else if (db > 0) {
            kept.push_back(crossing(b, a, db, da));
        }
    }
    return kept;
}

bool is_finite(const Clip& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

struct Outline {
    std::vector<Point> points;
    bool is_counter_clockwise = false;
};

// The polygon that is filled; without points where there is none.
Outline outline_of(const std::array<Vertex, 3>& v, const Scale& to) {
    Outline outline;
    // Twice the area, positive where the vertices turn counter-clockwise on the screen, with roundings.
    const auto x = [&](std::size_t i) { return static_cast<float>(v[i].grid.x); };
    const auto y = [&](std::size_t i) { return static_cast<float>(v[i].grid.y); };
    float area = (y(0) - y(2)) * x(1) + (y(2) - y(1)) * x(0) + (y(1) - y(0)) * x(2);
    if (std::signbit(v[0].clip[3]) ^ std::signbit(v[1].clip[3]) ^ std::signbit(v[2].clip[3])) area = -area;
    outline.is_counter_clockwise = area > 0;

    unsigned any = 0;
    unsigned all = ~0u;
    for (const Vertex& vertex : v) {
        if (!is_finite(vertex.clip)) return outline;
        unsigned flags = 0;
        for (std::size_t plane = 0; plane < 6; ++plane)
            if (is_outside(vertex.clip, plane)) flags |= 1u << plane;
        any |= flags;
        all &= flags;
    }
    if (all != 0) return outline;
    if (any == 0) {
        outline.points = {v[0].grid, v[1].grid, v[2].grid};
        return outline;
    }
    std::vector<Clip> polygon{v[0].clip, v[1].clip, v[2].clip};
    for (std::size_t plane = 0; plane < 6 && polygon.size() >= 3; ++plane)
        if ((any >> plane & 1u) != 0) polygon = clipped(polygon, plane);
    if (polygon.size() < 3) return outline;
    for (const Clip& p : polygon) outline.points.push_back(grid_point(p, kFp(p[3]) != 0 ? div(1.0f, p[3]) : 1.0f, to));
    return outline;
}

std::int64_t ceil_div(std::int64_t a, std::int64_t b) { return a > 0 ? (a + b - 1) / b : -(-a / b); }

// Where each row of a scissor starts and ends.
struct Spans {
    Viewport scissor;
    std::vector<int> left, right;

    Spans(const Outline& outline, const Viewport& v, Point offset)
        : scissor(v), left(static_cast<std::size_t>(v.height)), right(left) {
        const std::size_t count = outline.points.size();
        for (std::size_t i = 0; i < count; ++i) {
            Point a = outline.points[i];
            Point b = outline.points[(i + 1) % count];
            if (!outline.is_counter_clockwise) std::swap(a, b);
            add_edge({a.x - offset.x, a.y - offset.y}, {b.x - offset.x, b.y - offset.y});
        }
    }

    // Counter-clockwise, an edge that goes down is a left one.
    void add_edge(Point a, Point b) {
        if (a.y == b.y) return;
        const bool is_right = b.y < a.y;
        if (is_right) std::swap(a, b);
        const int first = std::max((a.y + kMask) >> kBits, scissor.y);
        const int last = std::min((b.y + kMask) >> kBits, scissor.y + scissor.height);
        for (int y = first; y < last; ++y) {
            const std::int64_t dy = b.y - a.y;
            const std::int64_t along = std::int64_t{y} * kOne - a.y;
            const std::int64_t x = ceil_div(std::int64_t{a.x} * dy + (b.x - a.x) * along, dy * kOne);
            const auto row = static_cast<std::size_t>(y - scissor.y);
            (is_right ? right : left)[row] =
                static_cast<int>(std::clamp<std::int64_t>(x, scissor.x, scissor.x + scissor.width));
        }
    }

    [[nodiscard]] bool covers(int x, int y) const {
        const auto row = static_cast<std::size_t>(y - scissor.y);
        return left[row] <= x && x < right[row];
    }
};

template <class Sink>
void each_pixel(const Outline& outline, const Window& window, const Sink& sink) {
    if (outline.points.empty()) return;
    const Viewport& scissor = window.scissor;
    std::vector<Spans> spans;
    if (window.samples == 1) {
        spans.emplace_back(outline, scissor, Point{0, 0});
    } else {
        for (const auto& [x, y] : kSampleEighths) spans.emplace_back(outline, scissor, Point{2 * x - 8, 2 * y - 8});
    }
    const auto above = [](const Point& a, const Point& b) { return a.y < b.y; };
    const auto [top, bottom] = std::minmax_element(outline.points.begin(), outline.points.end(), above);
    const int first_row = std::max((top->y >> kBits) - 1, scissor.y);
    const int end_row = std::min((bottom->y >> kBits) + 2, scissor.y + scissor.height);
    for (int y = first_row; y < end_row; ++y) {
        const auto row = static_cast<std::size_t>(y - scissor.y);
        int first = scissor.x + scissor.width;
        int end = scissor.x;
        for (const Spans& sample : spans) {
            first = std::min(first, sample.left[row]);
            end = std::max(end, sample.right[row]);
        }
        for (int x = std::max(first, scissor.x); x < end; ++x) {
            std::uint32_t mask = 0;
            for (std::size_t s = 0; s < spans.size(); ++s)
                if (spans[s].covers(x, y)) mask |= 1u << s;
            if (mask != 0) sink(x, y, mask);
        }
    }
}

// Rotated so that the first vertex has the largest w; among equals, what the rotation for the smallest y left first.
std::array<Vertex, 3> rotated(std::array<Vertex, 3> v) {
    const auto rotate = [&v](std::array<float, 3> keys, float chosen) {
        if (chosen == keys[1]) v = {v[1], v[2], v[0]};
        if (chosen == keys[2]) v = {v[2], v[0], v[1]};
    };
    const std::array<float, 3> y{v[0].clip[1], v[1].clip[1], v[2].clip[1]};
    rotate(y, min_ps(min_ps(y[0], y[1]), y[2]));
    const std::array<float, 3> w{v[0].clip[3], v[1].clip[3], v[2].clip[3]};
    rotate(w, max_ps(max_ps(w[0], w[1]), w[2]));
    return v;
}

// value = origin + x dx + y dy, from a vertex.
struct Plane {
    float dx, dy, origin;

    [[nodiscard]] float at(float x, float y) const { return x * dx + (origin + y * dy); }
};

// Offsets from the first vertex in pixels.
struct Offsets {
    float x1, y1, x2, y2;

    explicit Offsets(const std::array<Vertex, 3>& v) {
        constexpr float kStep = 1.0f / kOne;
        x1 = static_cast<float>(v[1].grid.x - v[0].grid.x) * kStep;
        y1 = static_cast<float>(v[1].grid.y - v[0].grid.y) * kStep;
        x2 = static_cast<float>(v[2].grid.x - v[0].grid.x) * kStep;
        y2 = static_cast<float>(v[2].grid.y - v[0].grid.y) * kStep;
    }
};

Plane depth_plane(const std::array<Vertex, 3>& v) {
    const Offsets o(v);
    const float z1 = v[1].z - v[0].z;
    const float z2 = v[2].z - v[0].z;
    const float over_area = 1.0f / (o.x1 * o.y2 - o.x2 * o.y1);
    return {(o.y2 * z1 - o.y1 * z2) * over_area, (o.x1 * z2 - o.x2 * z1) * over_area, v[0].z};
}

float bias_of(const std::array<Vertex, 3>& v, const Plane& plane, const DepthDraw& draw) {
    float bias = 0;
    if (draw.bias_constant != 0) {
        float step = 1.01f / 65535.0f;
        if (draw.format == DepthFormat::D32f) {
            // Of the first vertex's depth and of the others' differences from it.
            const auto exponent = [](float z) { return std::bit_cast<std::int32_t>(z) & 0x7f800000; };
            const std::int32_t largest = std::max({exponent(v[0].z), exponent(v[1].z - v[0].z), exponent(v[2].z - v[0].z)});
            step = std::bit_cast<float>(largest) * 0x1p-23f;
        }
        bias = step * draw.bias_constant;
    }
    if (draw.bias_slope != 0) bias += max_ps(std::abs(plane.dx), std::abs(plane.dy)) * draw.bias_slope;
    return bias;
}

std::array<Vertex, 3> shaded(const ClipTriangle& triangle, const Scale& to) {
    return {shaded(triangle[0], to), shaded(triangle[1], to), shaded(triangle[2], to)};
}

}  // namespace

void swiftshader_coverage(const ClipTriangle& triangle, const Window& window, const PixelSink& sink) {
    const Scale to(window.viewport);
    each_pixel(outline_of(shaded(triangle, to), to), window, sink);
}

void swiftshader_depth(const ClipTriangle& triangle, const DepthDraw& draw, const DepthSink& sink) {
    const Viewport viewport{0, 0, draw.width, draw.height};
    const Scale to(viewport);
    const std::array<Vertex, 3> vertices = shaded(triangle, to);
    const std::array<Vertex, 3> v = rotated(vertices);
    const Plane plane = depth_plane(v);
    const float bias = bias_of(v, plane, draw);
    const bool has_bias = draw.bias_constant != 0 || draw.bias_slope != 0;
    const float x0 = static_cast<float>(v[0].grid.x) * (1.0f / kOne);
    const float y0 = static_cast<float>(v[0].grid.y) * (1.0f / kOne);
    each_pixel(outline_of(vertices, to), whole_window(viewport, draw.samples), [&](int x, int y, std::uint32_t mask) {
        for (int s = 0; s < draw.samples; ++s) {
            if ((mask >> s & 1u) == 0) continue;
            float px = static_cast<float>(x) - x0;
            float py = static_cast<float>(y) - y0;
            if (draw.samples > 1) {
                const auto& eighths = kSampleEighths[static_cast<std::size_t>(s)];
                px -= static_cast<float>(eighths[0]) / 8 - 0.5f;
                py += static_cast<float>(eighths[1]) / 8 - 0.5f;
            }
            float z = plane.at(px, py);
            if (has_bias) z += bias;
            sink(x, y, s, min_ps(max_ps(z, 0.0f), 1.0f));
        }
    });
}

void swiftshader_attributes(const ClipTriangle& triangle, const Viewport& viewport, Interpolation interpolation,
                            std::span<Color> target) {
    const Scale to(viewport);
    const std::array<Vertex, 3> vertices = shaded(triangle, to);
    const std::array<Vertex, 3> v = rotated(vertices);
    constexpr float kStep = 1.0f / kOne;
    const float w1 = v[1].clip[3];
    const float w2 = v[2].clip[3];
    const float x1 = w1 * kStep * static_cast<float>(v[1].grid.x - v[0].grid.x);
    const float y1 = w1 * kStep * static_cast<float>(v[1].grid.y - v[0].grid.y);
    const float x2 = w2 * kStep * static_cast<float>(v[2].grid.x - v[0].grid.x);
    const float y2 = w2 * kStep * static_cast<float>(v[2].grid.y - v[0].grid.y);
    const float area = x1 * y2 - x2 * y1;
    std::array<Plane, 3> m{};
    m[0].origin = v[0].over_w;
    if (area != 0) {
        const float over_area = 1.0f / area;
        const float first = over_area * v[0].over_w;
        m[0] = {(y1 * w2 - y2 * w1) * first, (x2 * w1 - x1 * w2) * first, v[0].over_w};
        m[1] = {y2 * over_area, -x2 * over_area, 0};
        m[2] = {-y1 * over_area, x1 * over_area, 0};
    }
    const auto sum = [&m](float a, float b, float c) {
        return Plane{a * m[0].dx + b * m[1].dx + c * m[2].dx, a * m[0].dy + b * m[1].dy + c * m[2].dy,
                     a * m[0].origin + b * m[1].origin + c * m[2].origin};
    };
    const Plane over_w = sum(1, 1, 1);
    const bool perspective = interpolation == Interpolation::Perspective;
    std::array<Plane, 4> planes{};
    for (std::size_t c = 0; c < 4; ++c) {
        std::array<float, 3> a{v[0].color[c], v[1].color[c], v[2].color[c]};
        if (!perspective)
            for (std::size_t i = 0; i < 3; ++i) a[i] *= v[i].clip[3];
        planes[c] = sum(a[0], a[1], a[2]);
    }
    const float x0 = static_cast<float>(v[0].grid.x) * kStep;
    const float y0 = static_cast<float>(v[0].grid.y) * kStep;
    each_pixel(outline_of(vertices, to), whole_window(viewport, 1), [&](int x, int y, std::uint32_t) {
        const float px = static_cast<float>(x) - x0;
        const float py = static_cast<float>(y) - y0;
        const float w = 1.0f / over_w.at(px, py);
        Color& out = target[static_cast<std::size_t>(y * viewport.width + x)];
        for (std::size_t c = 0; c < 4; ++c) out[c] = perspective ? planes[c].at(px, py) * w : planes[c].at(px, py);
    });
}

std::uint32_t swiftshader_depth_code(DepthFormat format, float z) {
    if (format == DepthFormat::D32f) return std::bit_cast<std::uint32_t>(z);
    return static_cast<std::uint32_t>(round_to_int(z * 65535.0f));
}

}  // namespace gnomon::agree
