// Building blocks of the procedural scenes, computed in double, stored in float; sine and cosine from sim/scalar_math.h.
#include "scenes/shapes.h"

#include "sim/error.h"
#include "sim/scalar_math.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace gnomon::scenes {

namespace {

std::uint32_t add_point(Shape& shape, const glm::dvec3& position) {
    shape.positions.emplace_back(position);
    return static_cast<std::uint32_t>(shape.positions.size() - 1);
}

glm::dvec3 unit(const glm::dvec3& v) { return v / std::sqrt(glm::dot(v, v)); }

/// Turns a closed shape so that its signed volume (the divergence theorem over its faces) is positive: fronts face outwards.
Shape facing_outwards(Shape shape) {
    double volume = 0;
    for (const glm::uvec3& t : shape.triangles) {
        const glm::dvec3 a(shape.positions[t.x] - shape.positions[0]);
        const glm::dvec3 b(shape.positions[t.y] - shape.positions[0]);
        const glm::dvec3 c(shape.positions[t.z] - shape.positions[0]);
        volume += glm::dot(a, glm::cross(b, c));
    }
    if (volume < 0) {
        for (glm::uvec3& t : shape.triangles) std::swap(t.y, t.z);
    }
    return shape;
}

}  // namespace

Shape box(const glm::dvec3& lower, const glm::dvec3& upper) {
    const glm::dvec3 middle = 0.5 * (lower + upper);
    return bar({middle.x, lower.y, middle.z}, {middle.x, upper.y, middle.z}, {1, 0, 0}, upper.x - lower.x, upper.z - lower.z);
}

Shape bar(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& side, double width, double depth) {
    const glm::dvec3 along = unit(b - a);
    const glm::dvec3 x = 0.5 * width * unit(side - along * glm::dot(side, along));
    const glm::dvec3 z = 0.5 * depth * unit(glm::cross(x, along));
    Shape shape;
    for (const glm::dvec3& end : {a, b}) {
        for (const glm::dvec3& corner : {-x - z, x - z, x + z, -x + z}) add_point(shape, end + corner);
    }
    shape.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
    for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t j = (i + 1) % 4;
        shape.triangles.emplace_back(i, i + 4, j + 4);
        shape.triangles.emplace_back(i, j + 4, j);
    }
    return facing_outwards(std::move(shape));
}

Shape tube(const glm::dvec3& a, const glm::dvec3& b, double radius_a, double radius_b, int sides) {
    const glm::dvec3 along = unit(b - a);
    const glm::dvec3 helper = std::fabs(along.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 x = unit(glm::cross(helper, along));
    const glm::dvec3 z = glm::cross(along, x);
    std::vector<glm::dvec3> ring_a;
    std::vector<glm::dvec3> ring_b;
    for (int i = 0; i < sides; ++i) {
        const auto [s, c] = scalar::sincos(2 * scalar::kPi * i / sides);
        ring_a.push_back(a + radius_a * (c * x + s * z));
        ring_b.push_back(b + radius_b * (c * x + s * z));
    }
    return loft({ring_a, ring_b});
}

Shape ellipsoid(const glm::dvec3& center, const glm::dvec3& radii, int slices, int stacks) {
    // Points: the south pole, the rings upwards, the north pole.
    Shape shape;
    add_point(shape, center - glm::dvec3(0, radii.y, 0));
    for (int stack = 1; stack < stacks; ++stack) {
        const auto [height, ring_radius] = scalar::sincos(scalar::kPi * stack / stacks - scalar::kPi / 2);
        for (int slice = 0; slice < slices; ++slice) {
            const auto [s, c] = scalar::sincos(2 * scalar::kPi * slice / slices);
            add_point(shape, center + radii * glm::dvec3(ring_radius * c, height, ring_radius * s));
        }
    }
    const std::uint32_t north = add_point(shape, center + glm::dvec3(0, radii.y, 0));

    // Faces: a fan at each pole, quads between rings.
    const auto n = static_cast<std::uint32_t>(slices);
    const auto rings = static_cast<std::uint32_t>(stacks - 1);
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = (i + 1) % n;
        shape.triangles.emplace_back(0u, 1 + i, 1 + j);
        for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
            const std::uint32_t low = 1 + ring * n;
            shape.triangles.emplace_back(low + i, low + n + i, low + n + j);
            shape.triangles.emplace_back(low + i, low + n + j, low + j);
        }
        const std::uint32_t last = 1 + (rings - 1) * n;
        shape.triangles.emplace_back(last + i, north, last + j);
    }
    return facing_outwards(std::move(shape));
}

Shape revolution(const std::vector<glm::dvec2>& profile, int segments) {
    Shape shape;
    for (int segment = 0; segment < segments; ++segment) {
        const auto [s, c] = scalar::sincos(2 * scalar::kPi * segment / segments);
        for (const glm::dvec2& p : profile) add_point(shape, {p.x * c, p.x * s, p.y});
    }
    const auto n = static_cast<std::uint32_t>(profile.size());
    const auto m = static_cast<std::uint32_t>(segments);
    for (std::uint32_t segment = 0; segment < m; ++segment) {
        const std::uint32_t here = segment * n;
        const std::uint32_t next = (segment + 1) % m * n;
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t j = (i + 1) % n;
            shape.triangles.emplace_back(here + i, next + i, next + j);
            shape.triangles.emplace_back(here + i, next + j, here + j);
        }
    }
    return facing_outwards(std::move(shape));
}

Shape loft(const std::vector<std::vector<glm::dvec3>>& rings) {
    GNOMON_CHECK_LE(2u, rings.size());
    Shape shape;
    const auto n = static_cast<std::uint32_t>(rings.front().size());
    for (const auto& ring : rings) {
        GNOMON_CHECK_EQ(ring.size(), rings.front().size());
        for (const glm::dvec3& p : ring) add_point(shape, p);
    }
    const auto middle = [](const std::vector<glm::dvec3>& ring) {
        glm::dvec3 sum(0.0);
        for (const glm::dvec3& p : ring) sum += p;
        return sum / static_cast<double>(ring.size());
    };
    const std::uint32_t first_middle = add_point(shape, middle(rings.front()));
    const std::uint32_t last_middle = add_point(shape, middle(rings.back()));

    const auto last = static_cast<std::uint32_t>(rings.size() - 1) * n;
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = (i + 1) % n;
        shape.triangles.emplace_back(first_middle, j, i);
        for (std::uint32_t low = 0; low < last; low += n) {
            shape.triangles.emplace_back(low + i, low + j, low + n + j);
            shape.triangles.emplace_back(low + i, low + n + j, low + n + i);
        }
        shape.triangles.emplace_back(last_middle, last + i, last + j);
    }
    return facing_outwards(std::move(shape));
}

Shape grid(const glm::dvec3& origin, const glm::dvec3& u, const glm::dvec3& v, int count_u, int count_v) {
    Shape shape;
    for (int j = 0; j <= count_v; ++j) {
        for (int i = 0; i <= count_u; ++i) add_point(shape, origin + u * (1.0 * i / count_u) + v * (1.0 * j / count_v));
    }
    const auto row = static_cast<std::uint32_t>(count_u + 1);
    for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(count_v); ++j) {
        for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count_u); ++i) {
            const std::uint32_t corner = j * row + i;
            shape.triangles.emplace_back(corner, corner + 1, corner + row + 1);
            shape.triangles.emplace_back(corner, corner + row + 1, corner + row);
        }
    }
    return shape;
}

}  // namespace gnomon::scenes
