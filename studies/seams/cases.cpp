// The list of small cases.
#include "studies/seams/cases.h"

#include "sim/error.h"
#include "studies/seams/case_list.h"

namespace gnomon::studies {

std::span<const SeamCase> all_seam_cases() {
    static const std::array cases{lvsm_layers_seam(), pages_seam(),    cube_faces_seam(), atlas_seam(),
                                  wrap_seam(),        centroid_seam(), branch_seam(),     discard_seam()};
    return cases;
}

const SeamCase& find_seam_case(std::string_view name) {
    std::string names;
    for (const SeamCase& seam : all_seam_cases()) {
        if (seam.name == name) return seam;
        names += names.empty() ? "" : ", ";
        names += seam.name;
    }
    fail("seam '{}': not known; expected one of {}", name, names);
}

}  // namespace gnomon::studies
