// The houses of `city`: a core, and on its faces piers, spandrels, glass and cornices, so that facades shadow themselves.
#pragma once

#include "scenes/random.h"
#include "scenes/scene.h"

#include <glm/vec3.hpp>

namespace gnomon::scenes {

/// What a house is made of. The members may be the same meshes for several houses.
struct HouseMeshes {
    Mesh& wall;
    Mesh& glass;
    Mesh& trim;  // mullions, string courses, cornices, railings
    Mesh& roof;  // what stands on it
    Mesh& awning;
};

/// A house between two heights of x and of z, its front on the side of x nearer to 0.
struct House {
    double front_x = 10;  // either sign; |back_x| > |front_x|
    double back_x = 24;
    double low_z = 0;
    double high_z = 12;
    int storeys = 3;        // 3.2 m each; the ground floor has 4.2 m
    int bays = 4;           // of the front
    bool high_end = false;  // windows in the face towards +z
    bool shop = false;      // awnings over the ground floor
    bool balconies = false;
    bool plain = false;  // neither mullions nor string courses
};

/// Height of a house's walls; parapets stand 0.9 m above it.
double house_height(int storeys);

/// A whole house; what stands on its roof is drawn from `random`.
void append_house(const HouseMeshes& meshes, const House& house, Random& random);

/// The building that closes the street: columns, a gable, a tower. Its front, in the plane z = `front_z`, faces +z.
void append_town_hall(const HouseMeshes& meshes, double front_z);

}  // namespace gnomon::scenes
