// Subdivisions, solids and views of them.
#include "tests/oracle/meshes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace oracle {

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

// --- Subdivisions ---------------------------------------------------------------------------------------------------------

class Subdivider {
public:
    Subdivider(Random& random, const Point& top_left, const Point& bottom_right, const SamplePattern& pattern)
        : random_(random), pattern_(pattern) {
        mesh_.vertices = {top_left, {bottom_right.x, top_left.y}, bottom_right, {top_left.x, bottom_right.y}};
        mesh_.triangles = {{0, 1, 2}, {0, 2, 3}};
    }

    void step() {
        const auto t = static_cast<std::size_t>(random_.between(0, static_cast<std::int64_t>(mesh_.triangles.size()) - 1));
        switch (random_.integer(0, 3)) {
            case 0:
            case 1: split_triangle(t); break;
            case 2: split_edge(t); break;
            default: flip_edge(t); break;
        }
    }
    SnappedMesh take() { return std::move(mesh_); }

private:
    [[nodiscard]] std::int64_t area(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
        return turn(mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]);
    }

    /// A sample near p.
    Point sample_near(const Point& p) {
        return pattern_.at(static_cast<int>(p.x >> 8), static_cast<int>(p.y >> 8), random_.integer(0, pattern_.count - 1));
    }

    void split_triangle(std::size_t t) {
        const auto [a, b, c] = mesh_.triangles[t];
        const SnappedTriangle corners = mesh_.triangle(t);
        const std::int64_t u = random_.between(0, 1024);
        const std::int64_t v = random_.between(0, 1024 - u);
        const auto mix = [&](std::int64_t p, std::int64_t q, std::int64_t r) { return p + ((q - p) * u + (r - p) * v) / 1024; };
        Point p{mix(corners[0].x, corners[1].x, corners[2].x), mix(corners[0].y, corners[1].y, corners[2].y)};
        if (random_.chance(2)) p = sample_near(p);
        const std::uint32_t n = push(p);
        if (area(a, b, n) > 0 && area(b, c, n) > 0 && area(c, a, n) > 0) {
            mesh_.triangles[t] = {a, b, n};
            mesh_.triangles.push_back({b, c, n});
            mesh_.triangles.push_back({c, a, n});
        } else {
            mesh_.vertices.pop_back();
        }
    }

    /// Triangle with the directed edge (p, q), its third corner last; the number of triangles if the edge is on the border.
    std::size_t find(std::uint32_t p, std::uint32_t q, std::uint32_t& third) const {
        for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                if (mesh_.triangles[i][k] == p && mesh_.triangles[i][(k + 1) % 3] == q) {
                    third = mesh_.triangles[i][(k + 2) % 3];
                    return i;
                }
        return mesh_.triangles.size();
    }

    void split_edge(std::size_t t) {
        const auto k = static_cast<std::size_t>(random_.integer(0, 2));
        const std::uint32_t a = mesh_.triangles[t][k];
        const std::uint32_t b = mesh_.triangles[t][(k + 1) % 3];
        const std::uint32_t c = mesh_.triangles[t][(k + 2) % 3];
        std::uint32_t d = 0;
        const std::size_t other = find(b, a, d);
        const bool border = other == mesh_.triangles.size();
        const Point& p = mesh_.vertices[a];
        const Point& q = mesh_.vertices[b];
        const std::int64_t at = random_.between(1, 1023);
        // The border stays straight: it is axis aligned. Elsewhere both neighbours take whatever point it is.
        Point middle{p.x + (q.x - p.x) * at / 1024, p.y + (q.y - p.y) * at / 1024};
        if (!border && random_.chance(2)) middle = sample_near(middle);
        const std::uint32_t n = push(middle);
        const bool fits = area(a, n, c) > 0 && area(n, b, c) > 0 && (border || (area(b, n, d) > 0 && area(n, a, d) > 0));
        if (!fits) {
            mesh_.vertices.pop_back();
            return;
        }
        mesh_.triangles[t] = {a, n, c};
        mesh_.triangles.push_back({n, b, c});
        if (border) return;
        mesh_.triangles[other] = {b, n, d};
        mesh_.triangles.push_back({n, a, d});
    }

    void flip_edge(std::size_t t) {
        const auto k = static_cast<std::size_t>(random_.integer(0, 2));
        const std::uint32_t a = mesh_.triangles[t][k];
        const std::uint32_t b = mesh_.triangles[t][(k + 1) % 3];
        const std::uint32_t c = mesh_.triangles[t][(k + 2) % 3];
        std::uint32_t d = 0;
        const std::size_t other = find(b, a, d);
        if (other == mesh_.triangles.size() || area(c, d, b) <= 0 || area(d, c, a) <= 0) return;
        mesh_.triangles[t] = {c, d, b};
        mesh_.triangles[other] = {d, c, a};
    }

    std::uint32_t push(const Point& p) {
        mesh_.vertices.push_back(p);
        return static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
    }

    Random& random_;
    SamplePattern pattern_;
    SnappedMesh mesh_;
};

// --- Solids ---------------------------------------------------------------------------------------------------------------

using Position = Solid::Position;

constexpr double kRadius = 1000;

Position rounded(double x, double y, double z) {
    const auto nearest = [](double v) { return static_cast<std::int64_t>(std::floor(v + 0.5)); };
    return {nearest(x), nearest(y), nearest(z)};
}

/// p at the distance `radius` from the origin.
Position at_radius(const Position& p, double radius) {
    const auto x = static_cast<double>(p.x);
    const auto y = static_cast<double>(p.y);
    const auto z = static_cast<double>(p.z);
    const double scale = radius / std::sqrt(x * x + y * y + z * z);
    return rounded(x * scale, y * scale, z * scale);
}

/// Six times the volume of the tetrahedron; positive if d is on the inner side of abc, whose cross product points outwards.
std::int64_t depth_below(const Position& a, const Position& b, const Position& c, const Position& d) {
    const Position u{b.x - a.x, b.y - a.y, b.z - a.z};
    const Position v{c.x - a.x, c.y - a.y, c.z - a.z};
    return -((u.y * v.z - u.z * v.y) * (d.x - a.x) + (u.z * v.x - u.x * v.z) * (d.y - a.y) +
             (u.x * v.y - u.y * v.x) * (d.z - a.z));
}

/// All triples that have every other vertex below them; nothing unless they close, which four points in one plane prevent.
bool find_hull(Solid& solid) {
    solid.triangles.clear();
    const auto n = static_cast<std::uint32_t>(solid.vertices.size());
    const auto is_face = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        for (std::uint32_t d = 0; d < n; ++d)
            if (d != a && d != b && d != c &&
                depth_below(solid.vertices[a], solid.vertices[b], solid.vertices[c], solid.vertices[d]) <= 0)
                return false;
        return true;
    };
    for (std::uint32_t a = 0; a < n; ++a)
        for (std::uint32_t b = a + 1; b < n; ++b)
            for (std::uint32_t c = b + 1; c < n; ++c) {
                if (is_face(a, b, c)) solid.triangles.push_back({a, b, c});
                if (is_face(a, c, b)) solid.triangles.push_back({a, c, b});
            }
    return !solid.triangles.empty() && is_closed(solid.triangles);
}

/// The hull of the regular solid's vertices.
Solid regular(int faces) {
    Solid solid;
    if (faces == 4) solid.vertices = {{577, 577, 577}, {577, -577, -577}, {-577, 577, -577}, {-577, -577, 577}};
    if (faces == 8) solid.vertices = {{1000, 0, 0}, {-1000, 0, 0}, {0, 1000, 0}, {0, -1000, 0}, {0, 0, 1000}, {0, 0, -1000}};
    if (faces == 20)
        for (const std::int64_t s : {526, -526})
            for (const std::int64_t l : {851, -851}) {
                solid.vertices.push_back({0, s, l});
                solid.vertices.push_back({s, l, 0});
                solid.vertices.push_back({l, 0, s});
            }
    find_hull(solid);
    return solid;
}

Solid divided(const Solid& solid) {
    Solid result;
    result.vertices = solid.vertices;
    std::map<Edge, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [at, added] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(result.vertices.size()));
        if (added) {
            const Position& p = solid.vertices[a];
            const Position& q = solid.vertices[b];
            result.vertices.push_back(at_radius({p.x + q.x, p.y + q.y, p.z + q.z}, kRadius));
        }
        return at->second;
    };
    for (const auto& [a, b, c] : solid.triangles) {
        const std::uint32_t ab = middle(a, b);
        const std::uint32_t bc = middle(b, c);
        const std::uint32_t ca = middle(c, a);
        result.triangles.insert(result.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    return result;
}

// --- Views ----------------------------------------------------------------------------------------------------------------

using Rotation = std::array<std::array<double, 3>, 3>;

/// From a random quaternion. Arithmetic and square roots only: the same everywhere.
Rotation random_rotation(Random& random) {
    double x = 0, y = 0, z = 0, w = 0, length2 = 0;
    do {
        x = static_cast<double>(random.in(-1.0f, 1.0f));
        y = static_cast<double>(random.in(-1.0f, 1.0f));
        z = static_cast<double>(random.in(-1.0f, 1.0f));
        w = static_cast<double>(random.in(-1.0f, 1.0f));
        length2 = x * x + y * y + z * z + w * w;
    } while (length2 > 1 || length2 < 0.01);
    const double s = 2 / length2;
    return {{{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)},
             {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)},
             {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)}}};
}

struct Camera {
    double distance, near, far, focal, shift_x, shift_y;
};

/// The solid's radius is 1.
Camera random_camera(Random& random, ViewKind kind) {
    const auto in = [&](float low, float high) { return static_cast<double>(random.in(low, high)); };
    Camera camera{};
    camera.shift_x = in(-0.7f, 0.7f);
    camera.shift_y = in(-0.7f, 0.7f);
    camera.focal = in(0.5f, 2.5f);
    camera.near = in(0.05f, 0.5f);
    switch (kind) {
        case ViewKind::InFront:
            camera.distance = camera.near + in(1.6f, 6.0f);
            camera.far = camera.distance + 2;
            break;
        case ViewKind::NearCuts:
            camera.distance = in(-0.6f, 1.3f);
            camera.far = 4;
            break;
        case ViewKind::FarCuts:
            camera.distance = camera.near + in(1.6f, 6.0f);
            camera.far = camera.distance + in(-0.8f, 0.8f);
            break;
        case ViewKind::Inside:
            camera.distance = in(-0.3f, 0.3f);
            camera.shift_x *= 0.4;
            camera.shift_y *= 0.4;
            camera.far = 4;
            break;
    }
    return camera;
}

/// Rounded to the unit, and kept within what ClippedTriangle takes.
std::int64_t in_units(double v) {
    return std::clamp(static_cast<std::int64_t>(std::floor(v * (1 << kClipFractionBits) + 0.5)), std::int64_t{-(1 << 22)},
                      std::int64_t{1 << 22});
}

ClipVertex seen(const Camera& camera, double x, double y, double z) {
    return {in_units(x * camera.focal), in_units(y * camera.focal),
            in_units((z - camera.near) * camera.far / (camera.far - camera.near)), in_units(z)};
}

}  // namespace

bool is_closed(const std::vector<Corners>& triangles) {
    std::set<Edge> edges;
    for (const Corners& t : triangles)
        for (std::size_t k = 0; k < 3; ++k)
            if (!edges.emplace(t[k], t[(k + 1) % 3]).second) return false;
    return std::all_of(edges.begin(), edges.end(),
                       [&](const Edge& e) { return e.first != e.second && edges.contains({e.second, e.first}); });
}

SnappedMesh random_subdivision(Random& random, const Point& top_left, const Point& bottom_right, int steps,
                               const SamplePattern& pattern) {
    Subdivider subdivider(random, top_left, bottom_right, pattern);
    for (int i = 0; i < steps; ++i) subdivider.step();
    return subdivider.take();
}

Solid sphere(int faces, int levels) {
    Solid solid = regular(faces);
    for (int i = 0; i < levels; ++i) solid = divided(solid);
    return solid;
}

Solid displaced(Random& random, Solid solid, float amount) {
    for (Position& p : solid.vertices) p = at_radius(p, kRadius * static_cast<double>(1 - amount * random.unit()));
    return solid;
}

Solid random_hull(Random& random, int points) {
    Solid solid;
    do {
        solid.vertices.clear();
        while (solid.vertices.size() < static_cast<std::size_t>(points)) {
            const std::int64_t x = random.between(-1000, 1000);
            const std::int64_t y = random.between(-1000, 1000);
            const std::int64_t z = random.between(-1000, 1000);
            if (x * x + y * y + z * z <= 1000000) solid.vertices.push_back({x, y, z});
        }
    } while (!find_hull(solid));
    return solid;
}

Solid random_solid(Random& random) {
    constexpr std::array<int, 3> faces{4, 8, 20};
    const int start = faces[static_cast<std::size_t>(random.integer(0, 2))];
    switch (random.integer(0, 2)) {
        case 0: return random_hull(random, random.integer(4, 20));
        case 1: return sphere(start, random.integer(0, 2));
        default: return displaced(random, sphere(start, random.integer(1, 3)), 0.6f);
    }
}

ClipMesh random_view(Random& random, const Solid& solid, ViewKind kind) {
    const Rotation r = random_rotation(random);
    const Camera camera = random_camera(random, kind);
    ClipMesh mesh;
    mesh.triangles = solid.triangles;
    for (const Position& p : solid.vertices) {
        const std::array<double, 3> v{static_cast<double>(p.x) / kRadius, static_cast<double>(p.y) / kRadius,
                                      static_cast<double>(p.z) / kRadius};
        const auto row = [&](std::size_t i) { return r[i][0] * v[0] + r[i][1] * v[1] + r[i][2] * v[2]; };
        mesh.vertices.push_back(seen(camera, row(0) + camera.shift_x, row(1) + camera.shift_y, row(2) + camera.distance));
    }
    return mesh;
}

std::array<ClipVertex, 3> random_clip_triangle(Random& random, ClipKind kind) {
    constexpr Camera camera{.distance = 0, .near = 0.5, .far = 20, .focal = 1, .shift_x = 0, .shift_y = 0};
    const auto in = [&](float low, float high) { return static_cast<double>(random.in(low, high)); };
    std::array<ClipVertex, 3> t{};
    for (ClipVertex& v : t) {
        const double reach = kind == ClipKind::Wide ? 900 : 8;
        const double x = in(-1, 1) * reach;
        const double y = in(-1, 1) * reach;
        switch (kind) {
            case ClipKind::InFront: v = seen(camera, x, y, in(0.6f, 19.5f)); break;
            case ClipKind::AnyW:
            case ClipKind::Wide: v = seen(camera, x, y, in(-6, 24)); break;
            case ClipKind::OnPlanes: {
                const int where = random.integer(0, 3);
                v = seen(camera, x, y, where == 2 ? 0.0 : in(-6, 24));
                if (where == 0) v.z = 0;
                if (where == 1) v.z = v.w;
                break;
            }
            case ClipKind::Anything: {
                const auto any = [&] {
                    const std::int64_t whole = random.between(-(1 << 22), 1 << 22);
                    return whole >> random.integer(0, 20);
                };
                v.x = any();
                v.y = any();
                v.z = any();
                v.w = any();
                break;
            }
        }
    }
    return t;
}

}  // namespace oracle
