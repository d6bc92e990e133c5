#include "texunit/peer_aniso.h"

#include "sim/scalar_math.h"
#include "texunit/peer_address.h"

#include <cmath>

namespace gnomon {

namespace {

constexpr int kTableSize = 1024;

/// exp(-2 i / 1023) in binary32 with six decimals, as the source spells them. Mesa 22.3.6 lp_bld_sample.c, aniso_filter_table
const std::array<std::int32_t, kTableSize>& weight_table() {
    static const auto table = [] {
        std::array<std::int32_t, kTableSize> bits{};
        for (std::size_t i = 0; i < bits.size(); ++i) {
            const float r2 = static_cast<float>(i) / static_cast<float>(kTableSize - 1);
            const auto weight = static_cast<float>(scalar::exp(static_cast<double>(-2.0f * r2)));
            bits[i] =
                std::bit_cast<std::int32_t>(static_cast<float>(std::floor(static_cast<double>(weight) * 1e6 + 0.5) / 1e6));
        }
        return bits;
    }();
    return table;
}

}  // namespace

LevelOfDetail<Float> llvmpipe_anisotropy(const Gradients<Float>& gradients, int width, int height) {
    const Float w(static_cast<float>(width));
    const Float h(static_cast<float>(height));
    const Vec2<Float> x{gradients.dx.x * w, gradients.dx.y * h};
    const Vec2<Float> y{gradients.dy.x * w, gradients.dy.y * h};
    LevelOfDetail<Float> result(half_log2_linear(min_second(dot(x, x), dot(y, y))));
    result.anisotropic = true;
    result.ratio = Float(1.0f);
    result.major = gradients.dx;
    result.minor = gradients.dy;
    result.probes = Int(1);
    return result;
}

LevelOfDetail<Float> swiftshader_anisotropy(const Gradients<Float>& gradients, int width, int height, int max_anisotropy) {
    const Float w(static_cast<float>(width));
    const Float h(static_cast<float>(height));
    const Float one(1.0f);
    const Vec2<Float> x{gradients.dx.x * w, gradients.dx.y * h};
    const Vec2<Float> y{gradients.dy.x * w, gradients.dy.y * h};
    const Float squared_x = dot(x, x);
    const Float squared_y = dot(y, y);
    const Float squared = max_second(squared_x, squared_y);
    const Float determinant = abs(x.x * y.y - y.x * x.y);
    const Float ratio = min_second(squared * (one / determinant), Float(static_cast<float>(max_anisotropy)));

    LevelOfDetail<Float> result(half_log2_linear_of_square(squared * (one / (ratio * ratio))));
    const Mask major_is_x = squared_x >= squared_y;
    result.anisotropic = true;
    result.ratio = ratio;
    result.major = {select(major_is_x, gradients.dx.x, gradients.dy.x), select(major_is_x, gradients.dx.y, gradients.dy.y)};
    result.minor = {Float(0.0f), Float(0.0f)};
    result.probes = clamp(round_to_int(ratio), Int(1), Int(max_anisotropy));
    return result;
}

LlvmpipeEllipse::LlvmpipeEllipse(const Vec2<Float>& coordinate, const Vec2<Float>& dx, const Vec2<Float>& dy, int width,
                                 int height, Int level) {
    const Float one(1.0f);
    const Float two(2.0f);
    const Float scale = one / Float(shift_left(Int(1), level));
    const Float w(static_cast<float>(width));
    const Float h(static_cast<float>(height));
    const Float xu = dx.x * w * scale;
    const Float yu = dy.x * w * scale;
    const Float xv = dx.y * h * scale;
    const Float yv = dy.y * h * scale;

    // A u^2 + B u v + C v^2 = F, and the half sides of its box.
    const Float a = (xv * xv + yv * yv) + one;
    const Float b = (xu * xv + yu * yv) * Float(-2.0f);
    const Float c = (xu * xu + yu * yu) + one;
    const Float f = a * c - (b * b) * Float(0.25f);
    const Float d = (Float(0.0f) - b * b) + (a * c) * Float(4.0f);
    const Float half_width = (two / d) * sqrt((d * c) * f);
    const Float half_height = (two / d) * sqrt((a * d) * f);

    const Float table_scale = Float(static_cast<float>(kTableSize - 1)) / f;
    a_ = a * table_scale;
    b_ = b * table_scale;
    c_ = c * table_scale;
    const Float u = coordinate.x * (w * scale) - Float(0.5f);
    const Float v = coordinate.y * (h * scale) - Float(0.5f);
    // Within +-2^30, so that indices can be counted on from there; texels that far away are not told apart anyway.
    const auto limited = [](Float x) { return bounded_truncate_to_int(clamp(x, Float(-0x1p30f), Float(0x1p30f))); };
    first_u_ = limited(floor(u - half_width));
    last_u_ = limited(-floor(-(u + half_width)));
    first_v_ = limited(floor(v - half_height));
    last_v_ = limited(-floor(-(v + half_height)));
    center_v_ = v;
    du_ = Float(first_u_) - u;
    step_ = ((du_ + du_) + one) * a_;
    start_ = (du_ * du_) * a_;
}

Float LlvmpipeEllipse::weight_of(Float q, Mask inside) {
    const Int index = truncate_to_int(q);
    const Int entry = max(index, Int(0)) & Int(kTableSize - 1);
    const Float weight = float_of_bits(gather(weight_table().data(), entry));
    return select(inside & (index < Int(kTableSize)), weight, Float(0.0f));
}

}  // namespace gnomon
