// Measurements as compact text, for keeping.
#pragma once

#include "tests/agree/measure.h"

#include <string>

namespace gnomon::agree {

/// Lines of `what: numbers`, floats in full; step tables as position=value where they change, but counts alone where nothing
/// is rounded.
std::string capture_text(const Measurements& measurements);

}  // namespace gnomon::agree
