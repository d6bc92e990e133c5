// The texels and weights that a filter may use, as far as the declared precision fixes them. D3D11.3 7.18.6 to 7.18.9, 22.4.19
#pragma once

#include "tests/verify/lookup_footprint.h"
#include "tests/verify/lookup_verifier.h"

#include <cstdint>
#include <vector>

namespace verify {

/// What a texel, a filter or a whole sample may be, component by component.
struct Bounds {
    Color lo{};
    Color hi{};
};

Bounds nothing();
void include(Bounds& a, const Bounds& b);
Bounds lerp(const Bounds& a, const Bounds& b, double w);

/// Four taps and the weights of the right and of the lower ones. A nearest filter repeats its texel.
struct Cell {
    std::array<Bounds, 4> tap;  // (0,0), (1,0), (0,1), (1,1)
    Range a;                    // of u
    Range b;                    // of v
};

/// Exact for points as taps: a bilinear function has its extremes over a box of weights at the corners.
Bounds hull(const Cell& cell);
Bounds hull(const std::vector<Cell>& cells);

/// The texels and the arithmetic of one request; refers to its arguments.
class Lookup {
public:
    Lookup(const Image& image, const gnomon::Sampler& sampler, const LookupPrecision& precision,
           const gnomon::SampleRequest& request);

    [[nodiscard]] double tolerance() const { return tolerance_; }
    [[nodiscard]] gnomon::Reduction reduction() const { return sampler_.reduction; }
    [[nodiscard]] int last_level() const { return static_cast<int>(image_.levels.size()) - 1; }

    /// Every cell that a filter may find itself in, `along` of the way along the line of anisotropy, [-1/2, 1/2].
    [[nodiscard]] std::vector<Cell> cells(int level, gnomon::TexelFilter filter, const Footprint& footprint,
                                          double along) const;

    /// The extremes of everything under the ellipse's bounding box. The filter may be wider than the ellipse by half and by two
    /// texels; [Heckbert89] 3.5.8 adds one.
    [[nodiscard]] Bounds under_ellipse(int level, const Footprint& footprint) const;

    /// The extremes of the image and the border.
    [[nodiscard]] Bounds anything() const;

private:
    /// Where along one axis a filter may be: a texel index before the address mode, and the weight of the next one.
    struct Span {
        std::int64_t first = 0;
        Range weight;
    };

    void set_reference(double reference);
    [[nodiscard]] gnomon::AddressMode address_mode(gnomon::AddressMode mode) const;
    [[nodiscard]] std::vector<Span> spans(double coordinate, double error, int size, int offset,
                                          gnomon::TexelFilter filter) const;
    [[nodiscard]] Bounds border() const;
    [[nodiscard]] Bounds tap(const Image::Level& level, std::int64_t u, std::int64_t v) const;
    [[nodiscard]] Bounds compared(const Bounds& texel) const;

    const Image& image_;
    const gnomon::Sampler& sampler_;
    const LookupPrecision& precision_;
    const gnomon::SampleRequest& request_;
    Range reference_;
    double decode_error_ = 0;  // relative, of texels that are compared
    double tolerance_ = 0;
};

}  // namespace verify
