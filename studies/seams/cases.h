// Small named cases of the seam laboratory: one discontinuity each, drawn by the machine, without and with what cures it.
#pragma once

#include "studies/seams/seam.h"

#include <span>
#include <string_view>
#include <vector>

namespace gnomon::studies {

/// A case is drawn on a device whose profile decides about derivatives, level of detail and filters.
struct SeamCase {
    std::string_view name;
    std::string_view summary;             // one line: where lanes of a quad go apart
    std::string_view source;              // where it is met
    std::string_view expectation;         // one line that a test checks: what is bad without a cure, and with each
    std::vector<std::string_view> cures;  // "none" first; one of them is `reference`
    std::string_view reference;           // the cure whose values are right
    /// Throws Error for a cure that the case does not have, and Stopped.
    SeamImage (*draw)(Device& device, std::string_view cure);
};

/// All of them, in the order of `gnomon list seams`.
std::span<const SeamCase> all_seam_cases();
/// Throws Error that lists the names.
const SeamCase& find_seam_case(std::string_view name);

}  // namespace gnomon::studies
