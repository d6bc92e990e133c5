// One component of one texel as a number: codes to values, border colours, comparisons.
// D3D11.3 3.1.5, 3.1.6, 3.2.3, 7.18.9.1, 22.4.19
#pragma once

#include "sim/profile.h"
#include "texunit/format.h"
#include "texunit/sampler.h"

#include <cstdint>

namespace oracle {

/// Rounding of the profile's arithmetic, applied to a double: every operation on binary32 operands is exact in double or
/// rounds twice without harm (53 >= 2 * 24 + 2).
struct Arithmetic {
    bool fp32 = true;
    bool flush = true;

    explicit Arithmetic(const gnomon::Profile& profile)
        : fp32(profile.arithmetic == gnomon::Arithmetic::Fp32), flush(profile.flush_denormals) {}

    [[nodiscard]] double round(double x) const;
    [[nodiscard]] double unit() const { return fp32 ? 0x1p-24 : 0x1p-53; }  // relative error of one rounding
    [[nodiscard]] double largest() const;
    /// Absolute error of one operation on small numbers: what is below may become 0.
    [[nodiscard]] double tiny() const;
};

/// The number a component code stands for. Integers are themselves, whatever the arithmetic. D3D11.3 19.1.4
double texel_value(gnomon::Format format, const gnomon::Profile& profile, std::uint32_t code, int component);

/// Relative error of texel_value where the definition is not arithmetic: sRGB in double takes 2.4 log2, off by 2^-48 each, and
/// 2^x. In binary32 the value is the nearest one. D3D11.3 3.2.3.7
double texel_error(gnomon::Format format, const gnomon::Profile& profile);

/// A component of the border colour, clamped to the range of the format.
double border_value(gnomon::Format format, const gnomon::Profile& profile, float border);

/// What a component is that the format lacks.
constexpr double missing_value(int component) { return component == 3 ? 1.0 : 0.0; }

/// Both sides of a comparison, as numbers that order as they compare.
double compared_texel(gnomon::Format format, const gnomon::Profile& profile, std::uint32_t code);
double compared_reference(gnomon::Format format, const gnomon::Profile& profile, double reference);

bool passes(gnomon::CompareOp op, double reference, double texel);

}  // namespace oracle
