// The techniques by the names that the benchmark and gnomon_peer_render use.
#pragma once

#include "tests/peer/frame.h"

#include <string>
#include <string_view>
#include <vector>

namespace gnomon::peer {

struct NamedTechnique {
    std::string name;
    TechniqueOptions options;  // with a 512 x 512 map
};

/// none, shadow-map, pcf-bilinear, pcf-3x3, ...: all that are timed, in the order of the table.
const std::vector<NamedTechnique>& named_techniques();

/// Throws Error, which lists the names, on an unknown one.
const TechniqueOptions& technique_named(std::string_view name);

}  // namespace gnomon::peer
