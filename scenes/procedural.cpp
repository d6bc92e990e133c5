// The table of built-in scenes.
#include "scenes/procedural.h"

#include "scenes/builders.h"

#include <array>

namespace gnomon::scenes {

std::span<const ProceduralScene> procedural_scenes() {
    static constexpr std::array<ProceduralScene, 7> kScenes = {{
        {"planes", "one occluder plane above one receiver plane: Chebyshev's bound is exact ([Donnelly06] 3.1)", make_planes},
        {"car", "a car on a large plane at a shallow angle under a spotlight ([Donnelly06] figure 1)", make_car},
        {"fence", "thin bars receding to the horizon: minification ([Lauritzen08] figure 2.2)", make_fence},
        {"bench", "a tree over a bench over the ground: light bleeding ([Lauritzen08] figures 3.4 and 3.5)", make_bench},
        {"windmill", "a windmill with lattice sails and a gallery: many overlapping shadows ([Lauritzen08] figure 4.8)",
         make_windmill},
        {"overlap", "overlapping shadows with extreme depth ratios, the worst case ([Lauritzen08] figures 4.3 and 4.4)",
         make_overlap},
        {"city", "a street of 300 m with trees, bicycle racks and benches under the sun ([Lefohn07] figure 7)", make_city},
    }};
    return kScenes;
}

}  // namespace gnomon::scenes
