// A broad-leaved tree and its leaves, for the scenes in which foliage throws the shadow.
#pragma once

#include "scenes/random.h"
#include "scenes/scene.h"
#include "scenes/shapes.h"

#include <glm/vec3.hpp>

#include <cstdint>

namespace gnomon::scenes {

/// Where a tree stands and how much there is of it. At size 1 the trunk is 4.1 m high and the crown 3.5 m wide; the whole tree
/// has about 4,000 triangles at any size.
struct Tree {
    glm::dvec3 foot{0.0};
    double size = 1;
    std::uint64_t seed = 1;
    int limbs = 11;           // >= 2
    int twigs = 6;            // of a limb, >= 2
    int leaves = 22;          // of a twig
    double leaf_size = 1;     // relative to the tree's size
    bool twigs_drawn = true;  // as wood; leaves hang there in any case
};

/// Trunk, limbs that leave it in a spiral, twigs that leave the limbs; leaves around the twigs.
void append_tree(Mesh& bark, Mesh& foliage, const Tree& tree);

/// A twig by its ends. At size 1 a leaf is 0.13 to 0.22 m long.
struct Twig {
    glm::dvec3 from{0.0};
    glm::dvec3 to{0.0};
    int leaves = 22;
    double size = 1;
};

/// Leaves around a twig, each turned at random: two triangles each, without the twig.
void append_leaves(Shape& leaves, const Twig& twig, Random& random);

}  // namespace gnomon::scenes
