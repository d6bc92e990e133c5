// D3D11.3 7.18 one sample at a time.
#include "tests/verify/scalar_sampler.h"

#include <algorithm>
#include <cmath>

namespace verify {

using namespace gnomon;

namespace {

struct Vector {
    double u = 0;
    double v = 0;
};

double dot(Vector a, Vector b) { return a.u * b.u + a.v * b.v; }

/// Level of detail, and probes along a line in texels of level 0.
struct Lod {
    double lod = 0;
    int probes = 1;
    Vector line;
};

double sign(double x) { return x < 0 ? -1.0 : 1.0; }

/// The ideal transformation of D3D11.3 7.18.11 to the axes of the ellipse, with its caveats.
void make_orthogonal(Vector& dx, Vector& dy) {
    const double area = dx.u * dy.v - dy.u * dx.v;
    // Parallel but for rounding counts as parallel.
    if (area * area <= 1e-24 * dot(dx, dx) * dot(dy, dy) || dot(dx, dy) == 0) return;
    const double a = dx.v * dx.v + dy.v * dy.v;
    const double b = -2 * (dx.u * dx.v + dy.u * dy.v);
    const double c = dx.u * dx.u + dy.u * dy.u;
    const double f = area * area;
    const double p = a - c;
    const double q = a + c;
    const double t = std::sqrt(p * p + b * b);
    if (t == 0) return;
    const double plus = std::max(t + p, 0.0);
    const double minus = std::max(t - p, 0.0);
    dx = {std::sqrt(f * plus / (t * (q + t))), std::sqrt(f * minus / (t * (q + t))) * sign(b)};
    dy = {-std::sqrt(f * minus / (t * (q - t))) * sign(b), std::sqrt(f * plus / (t * (q - t)))};
}

/// D3D11.3 7.18.11
Lod lod_of(const Image& image, const Sampler& sampler, const SampleRequest& request, Defect defect) {
    if (!request.gradient) return {request.lod, 1, {}};
    const double width = image.levels[0].width;
    const double height = image.levels[0].height;
    Vector dx{request.gradient->dx[0] * width, request.gradient->dx[1] * height};
    Vector dy{request.gradient->dy[0] * width, request.gradient->dy[1] * height};
    if (defect != Defect::EllipseIgnored) make_orthogonal(dx, dy);
    const bool is_major_x = dot(dx, dx) > dot(dy, dy);
    const Vector major = is_major_x ? dx : dy;
    const double length_major = std::sqrt(dot(major, major));
    if (sampler.max_anisotropy <= 1) return {std::log2(length_major), 1, {}};
    const double determinant = std::abs(dx.u * dy.v - dx.v * dy.u);
    double ratio = dot(major, major) / determinant;
    double length_minor = determinant / length_major;
    if (ratio > sampler.max_anisotropy) {
        ratio = sampler.max_anisotropy;
        length_minor = length_major / ratio;
    }
    if (length_minor < 1) ratio = std::max(1.0, ratio * length_minor);
    // Less a little, so that a ratio that is whole but for rounding stays so.
    const int probes = std::max(1, static_cast<int>(std::ceil(ratio - 1e-12)));
    return {std::log2(length_minor), probes, defect == Defect::MinorAxis ? (is_major_x ? dy : dx) : major};
}

/// D3D11.3 7.18.9; -1 for the border.
int address(AddressMode mode, int i, int size, Defect defect) {
    if (i >= 0 && i < size) return i;
    switch (mode) {
        case AddressMode::Wrap: i %= size; return i < 0 ? i + size : i;
        case AddressMode::Mirror: {
            if (defect == Defect::MirrorSkipsEdge) {
                if (size == 1) return 0;
                const int m = ((i % (2 * size - 2)) + 2 * size - 2) % (2 * size - 2);
                return m < size ? m : 2 * size - 2 - m;
            }
            if (i < 0) i = -i - 1;
            const bool flip = ((i / size) & 1) != 0;
            i %= size;
            return flip ? size - i - 1 : i;
        }
        case AddressMode::Clamp:
            if (defect == Defect::WrapsAtLastTexel && i == size) return 0;
            return std::clamp(i, 0, size - 1);
        case AddressMode::Border: return defect == Defect::BorderIgnored ? std::clamp(i, 0, size - 1) : -1;
        case AddressMode::MirrorOnce:
            if (i < 0) i = -i - 1;
            return std::clamp(i, 0, size - 1);
    }
    return 0;
}

double compared(const Image& image, const Sampler& sampler, double reference, double texel, Defect defect) {
    if (image.unit_range) reference = std::clamp(reference, 0.0, 1.0);
    if (image.depth_codes > 0) reference = std::floor(reference * image.depth_codes + 0.5) / image.depth_codes;
    const bool equal = reference == texel;
    const bool flip = equal && defect == Defect::EqualityInverted;
    bool pass = false;
    switch (sampler.compare) {
        case CompareOp::Never: pass = false; break;
        case CompareOp::Less: pass = reference < texel; break;
        case CompareOp::Equal: pass = equal; break;
        case CompareOp::LessEqual: pass = reference <= texel; break;
        case CompareOp::Greater: pass = reference > texel; break;
        case CompareOp::NotEqual: pass = !equal; break;
        case CompareOp::GreaterEqual: pass = reference >= texel; break;
        case CompareOp::Always: pass = true; break;
    }
    return pass != flip ? 1.0 : 0.0;
}

Color tap(const Image& image, const Sampler& sampler, const SampleRequest& request, int level, std::array<int, 2> at,
          Defect defect) {
    const Image::Level& texels = image.levels[static_cast<std::size_t>(level)];
    const int x = address(sampler.address_u, at[0], texels.width, defect);
    const int y = address(sampler.address_v, at[1], texels.height, defect);
    Color color{0, 0, 0, 1};
    if (x >= 0 && y >= 0) {
        color = texels.texels[static_cast<std::size_t>(y * texels.width + x)];
    } else {
        for (int c = 0; c < image.components; ++c) {
            const double component = sampler.border[c];
            color[static_cast<std::size_t>(c)] = image.unit_range ? std::clamp(component, 0.0, 1.0) : component;
        }
    }
    if (request.reference) color.fill(compared(image, sampler, *request.reference, color[0], defect));
    return color;
}

Color mix(const Sampler& sampler, const Color& a, const Color& b, double w, Defect defect) {
    const Reduction reduction = defect == Defect::ReductionIgnored ? Reduction::Average : sampler.reduction;
    if (reduction != Reduction::Average && w == 0) return a;
    if (reduction != Reduction::Average && w == 1) return b;
    Color result;
    for (std::size_t c = 0; c < 4; ++c) switch (reduction) {
            case Reduction::Average: result[c] = a[c] * (1 - w) + b[c] * w; break;
            case Reduction::Minimum: result[c] = std::min(a[c], b[c]); break;
            case Reduction::Maximum: result[c] = std::max(a[c], b[c]); break;
        }
    return result;
}

/// One probe on one level. D3D11.3 7.18.7, 7.18.8
Color sample_level(const Image& image, const Sampler& sampler, const SampleRequest& request, int level, Vector uv,
                   TexelFilter filter, Defect defect) {
    const Image::Level& texels = image.levels[static_cast<std::size_t>(level)];
    const bool linear = filter == TexelFilter::Linear;
    const double shift = linear && defect != Defect::CentreOffByHalf ? 0.5 : 0.0;
    const auto fixed = [&](double x) {
        return (defect == Defect::CoordinatesTruncated ? std::floor(x * 256) : std::nearbyint(x * 256)) / 256;
    };
    const double u = fixed(uv.u * texels.width - shift);
    const double v = fixed(uv.v * texels.height - shift);
    const bool shifted = defect != Defect::OffsetAtLevel0Only || level == 0;
    const int x = static_cast<int>(std::floor(u)) + (shifted ? request.offset.x : 0);
    const int y = static_cast<int>(std::floor(v)) + (shifted ? request.offset.y : 0);
    if (!linear) return tap(image, sampler, request, level, {x, y}, defect);
    double a = u - std::floor(u);
    double b = v - std::floor(v);
    if (defect == Defect::SwappedWeights) std::swap(a, b);
    if (defect == Defect::FourBitWeights) {
        a = std::nearbyint(a * 16) / 16;
        b = std::nearbyint(b * 16) / 16;
    }
    if (defect == Defect::WeightsTruncatedTo64) {
        a = std::floor(a * 64) / 64;
        b = std::floor(b * 64) / 64;
    }
    const auto at = [&](int i, int j) { return tap(image, sampler, request, level, {x + i, y + j}, defect); };
    return mix(sampler, mix(sampler, at(0, 0), at(1, 0), a, defect), mix(sampler, at(0, 1), at(1, 1), a, defect), b, defect);
}

/// All levels of one probe. D3D11.3 7.18.10
Color sample_probe(const Image& image, const Sampler& sampler, const SampleRequest& request, double lod, Vector uv,
                   Defect defect) {
    const int last = static_cast<int>(image.levels.size()) - 1;
    const auto level = [&](int l, TexelFilter filter) {
        return sample_level(image, sampler, request, std::clamp(l, 0, last), uv, filter, defect);
    };
    if (lod <= 0) return level(0, sampler.mag);
    switch (sampler.mip) {
        case MipFilter::Base: return level(0, sampler.min);
        case MipFilter::Nearest:
            return level(static_cast<int>(std::floor(lod + (defect == Defect::MipTruncated ? 0.0 : 0.5))), sampler.min);
        case MipFilter::Linear: break;
    }
    const int finer = static_cast<int>(std::floor(lod));
    double w = lod - std::floor(lod);
    if (defect == Defect::Brilinear) w = w < 0.125 ? 0 : w > 0.875 ? 1 : w;
    if (defect == Defect::MipWeightsExchanged) w = 1 - w;
    if (defect == Defect::PointSampledMip) w = w < 0.5 ? 0 : 1;
    return mix(sampler, level(finer, sampler.min), level(finer + 1, sampler.min), w, defect);
}

}  // namespace

const char* name_of(Defect defect) {
    switch (defect) {
        case Defect::None: return "none";
        case Defect::FourBitWeights: return "four-bit weights";
        case Defect::CentreOffByHalf: return "texel centre off by half";
        case Defect::WrapsAtLastTexel: return "wraps at the last texel";
        case Defect::Brilinear: return "brilinear";
        case Defect::LodOffByHalf: return "level of detail off by half";
        case Defect::SwappedWeights: return "swapped weights";
        case Defect::MirrorSkipsEdge: return "mirror skips the edge";
        case Defect::BorderIgnored: return "border ignored";
        case Defect::EqualityInverted: return "equality inverted";
        case Defect::OffsetAtLevel0Only: return "offset at level 0 only";
        case Defect::WeightsTruncatedTo64: return "weights truncated to 1/64";
        case Defect::MipWeightsExchanged: return "mip weights exchanged";
        case Defect::CentredProbes: return "centred probes";
        case Defect::MinorAxis: return "minor axis";
        case Defect::PointSampledMip: return "point-sampled mip";
        case Defect::CoordinatesTruncated: return "coordinates truncated";
        case Defect::LodLimitsIgnored: return "lod limits ignored";
        case Defect::MipTruncated: return "mip truncated";
        case Defect::EllipseIgnored: return "ellipse ignored";
        case Defect::ReductionIgnored: return "reduction ignored";
        case Defect::OneCodeTooBright: return "one code too bright";
    }
    return "";
}

Color sample(const Image& image, const Sampler& sampler, const SampleRequest& request, Defect defect) {
    const Lod from_gradient = lod_of(image, sampler, request, defect);
    const double bias = static_cast<double>(sampler.lod_bias) + request.lod_bias + (defect == Defect::LodOffByHalf ? 0.5 : 0.0);
    double lod = from_gradient.lod + bias;
    if (defect != Defect::LodLimitsIgnored) lod = std::max<double>(sampler.min_lod, std::min<double>(sampler.max_lod, lod));
    lod = std::nearbyint(lod * 256) / 256;
    Color sum{};
    const bool averages = sampler.reduction == Reduction::Average || defect == Defect::ReductionIgnored;
    for (int k = 0; k < from_gradient.probes; ++k) {
        const double n = from_gradient.probes;
        const double along = defect == Defect::CentredProbes ? (k + 0.5) / n - 0.5 : (k + 1) / (n + 1) - 0.5;
        const Vector uv{request.coordinate[0] + along * from_gradient.line.u / image.levels[0].width,
                        request.coordinate[1] + along * from_gradient.line.v / image.levels[0].height};
        const Color color = sample_probe(image, sampler, request, lod, uv, defect);
        if (averages)
            for (std::size_t c = 0; c < 4; ++c) sum[c] += color[c] / n;
        else
            sum = k == 0 ? color : mix(sampler, sum, color, 0.5, defect);
    }
    if (defect == Defect::OneCodeTooBright)
        for (double& component : sum) component += 1.0 / 255;
    return sum;
}

}  // namespace verify
