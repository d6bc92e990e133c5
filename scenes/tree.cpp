// A broad-leaved tree: trunk, limbs in a spiral, twigs, and leaves that are turned at random.
#include "scenes/tree.h"

#include "sim/scalar_math.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <cstdint>

namespace gnomon::scenes {

namespace {

glm::dvec3 unit(const glm::dvec3& v) { return v / std::sqrt(glm::dot(v, v)); }

/// A leaf: two triangles folded along the midrib.
void append_leaf(Shape& leaves, const glm::dvec3& stem, const glm::dvec3& along, const glm::dvec3& across) {
    const glm::dvec3 fold = 0.25 * glm::cross(unit(along), across);
    const auto first = static_cast<std::uint32_t>(leaves.positions.size());
    for (const glm::dvec3& p : {stem, stem + 0.5 * along + across + fold, stem + along, stem + 0.5 * along - across + fold}) {
        leaves.positions.emplace_back(p);
    }
    leaves.triangles.emplace_back(first, first + 2, first + 1);
    leaves.triangles.emplace_back(first, first + 3, first + 2);
}

}  // namespace

void append_leaves(Shape& leaves, const Twig& twig, Random& random) {
    for (int i = 0; i < twig.leaves; ++i) {
        // Braces and separate statements: elsewhere the compiler chooses the order in which numbers are drawn.
        const double share = random.uniform(0.25, 1.05);
        const glm::dvec3 spread{random.uniform(-0.12, 0.12), random.uniform(-0.1, 0.1), random.uniform(-0.12, 0.12)};
        const glm::dvec3 stem = twig.from + (twig.to - twig.from) * share + twig.size * spread;
        const double turn = random.uniform(0, 2 * scalar::kPi);
        const auto [s, c] = scalar::sincos(turn);
        const double length = twig.size * random.uniform(0.13, 0.22);
        const glm::dvec3 along = length * unit({c, random.uniform(-0.6, 0.25), s});
        const glm::dvec3 across = 0.3 * length * unit({-s, random.uniform(-0.3, 0.3), c});
        append_leaf(leaves, stem, along, across);
    }
}

void append_tree(Mesh& bark, Mesh& foliage, const Tree& tree) {
    Random random(tree.seed);
    const double size = tree.size;
    Shape leaves;
    const glm::dvec3 crotch = tree.foot + size * glm::dvec3(0.1, 2.3, 0.05);
    const glm::dvec3 top = tree.foot + size * glm::dvec3(0.25, 4.1, 0.15);
    append(bark, tube(tree.foot, crotch, size * 0.17, size * 0.12, 12), kRounded);
    append(bark, tube(crotch, top, size * 0.12, size * 0.04, 10), kRounded);
    for (int limb = 0; limb < tree.limbs; ++limb) {
        const double share = limb / (tree.limbs - 1.0);
        const auto [s, c] = scalar::sincos(2.39996 * limb + 0.5);  // the golden angle in radians
        const glm::dvec3 root = crotch + (top - crotch) * (0.9 * share);
        const double reach = 1.75 - 0.9 * share;
        const glm::dvec3 tip = root + size * glm::dvec3(reach * c, random.uniform(0.5, 0.9), reach * s);
        append(bark, tube(root, tip, size * (0.055 - 0.02 * share), size * 0.016, 6), kRounded);
        for (int twig = 0; twig < tree.twigs; ++twig) {
            const glm::dvec3 start = root + (tip - root) * (0.4 + 0.6 * twig / (tree.twigs - 1.0));
            const glm::dvec3 turn{random.uniform(-0.45, 0.45), random.uniform(0.05, 0.4), random.uniform(-0.45, 0.45)};
            const glm::dvec3 end = start + size * turn;
            if (tree.twigs_drawn) append(bark, tube(start, end, size * 0.014, size * 0.006, 4), kRounded);
            append_leaves(leaves, {.from = start, .to = end, .leaves = tree.leaves, .size = size * tree.leaf_size}, random);
        }
    }
    append(foliage, leaves, kFlat);
}

}  // namespace gnomon::scenes
