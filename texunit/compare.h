// The eight comparisons. D3D11.3 17.9 (depth), 7.18.15, 22.4.19 (sample_c)
#pragma once

#include "sim/lanes.h"
#include "texunit/sampler.h"

namespace gnomon {

/// `a OP b` per lane, for any lane type.
template <class Value>
GNOMON_INLINE Mask compare(CompareOp op, const Value& a, const Value& b) {
    switch (op) {
        case CompareOp::Never: return Mask(false);
        case CompareOp::Less: return a < b;
        case CompareOp::Equal: return a == b;
        case CompareOp::LessEqual: return a <= b;
        case CompareOp::Greater: return a > b;
        case CompareOp::NotEqual: return a != b;
        case CompareOp::GreaterEqual: return a >= b;
        case CompareOp::Always: return Mask(true);
    }
    __builtin_unreachable();
}

}  // namespace gnomon
