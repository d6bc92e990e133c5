// Seams of flow control: a branch that some lanes of a quad take, and lanes that are discarded.
#include "studies/seams/case_list.h"

namespace gnomon::studies {

namespace {

/// In a disc of the grid of kDiscs. Exact: halves and their squares.
template <class Real>
Mask in_disc(const Vec4<Real>& position) {
    const auto from_centre = [](const Real& x) {
        const Real side(static_cast<float>(kDiscs.side));
        return (x - side * floor(x / side)) - Real(0.5f) * side;
    };
    const Real x = from_centre(position.x);
    const Real y = from_centre(position.y);
    return x * x + y * y < Real(kDiscs.radius_squared);
}

template <class Real>
SampledLevel<Real> select(Mask mask, const SampledLevel<Real>& yes, const SampledLevel<Real>& no) {
    return {gnomon::select(mask, yes.clamped, no.clamped), gnomon::select(mask, yes.unclamped, no.unclamped),
            gnomon::select(mask, yes.probes, no.probes)};
}

/// What both cases ask: of lanes that `took` the sample; the others, whose choice is `other`, have none.
template <class F, class Real = typename F::Real>
SeamLanes<Real> flow_lanes(const F& f, TextureId texture, const Sampler& sampler, Mask took, const SeamLookup<Real>& lookup,
                           const Real& choice, const Real& value) {
    const Real zero(0.0f);
    SeamLookup<Real> smooth{flat_coordinate(f.in.at.x, f.in.at.y), lookup.has_gradients};
    if (smooth.has_gradients) smooth.gradients = shader_gradients(f, f.in.at.x, f.in.at.y);
    const Gradients<Real> exact = plane_gradients<Real>(kFlowPlane);
    return {.own = choice,
            .used = choice,
            .sampled = select(took, level_of(f, texture, sampler, lookup), SampledLevel<Real>{zero, zero, Int(1)}),
            .smooth_lod = gnomon::select(took, level_of(f, texture, sampler, smooth).unclamped, zero),
            .exact_lod = gnomon::select(took, f.lod(texture, sampler, exact).unclamped, zero),
            .outside = Mask(false),
            .value = value};
}

constexpr std::array<std::string_view, 3> kBranchCures{"none", "coordinates-before", "explicit-gradients"};

/// Samples inside discs only, at coordinates that are computed there.
template <bool kProbes>
struct BranchPixel {
    enum Cure : int { kNone, kCoordinatesBefore, kExplicitGradients };  // in the order of kBranchCures

    TextureId texture = TextureId::None;
    Sampler sampler;
    int cure = 0;  // of kBranchCures

    static constexpr auto fields() {
        using B = BranchPixel;
        return std::tuple{Field{"texture", &B::texture}, Field{"sampler", &B::sampler}, Field{"cure", &B::cure}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Mask inside = in_disc(f.position);
        // Until it is computed, the register of the coordinate holds an old value.
        SeamLookup<Real> lookup{flat_coordinate(Real(0.0f), Real(0.0f)), cure == kExplicitGradients};
        if (cure != 0) lookup.coordinate = f.in.at;
        if (cure == kExplicitGradients) lookup.gradients = shader_gradients(f, lookup.coordinate.x, lookup.coordinate.y);
        Real value(0.5f);
        f.branch(inside, [&] {
            lookup.coordinate.x = gnomon::select(inside, f.in.at.x, lookup.coordinate.x);
            lookup.coordinate.y = gnomon::select(inside, f.in.at.y, lookup.coordinate.y);
            value = gnomon::select(inside, look_up(f, texture, sampler, lookup), value);
        });
        return seam_colors<kProbes>(f, value, [&] {
            const Real choice = gnomon::select(inside, Real(1.0f), Real(0.0f));
            return flow_lanes(f, texture, sampler, inside, lookup, choice, value);
        });
    }
};

SeamImage draw_branch(Device& device, std::string_view cure) {
    const int chosen = seam_cure("branch", kBranchCures, cure);
    const TextureId texture = seam_texture(device, kFlowSide);
    return draw_seam(device, "seam.branch", kFlowPlane, [&]<bool kProbes>(std::bool_constant<kProbes>) {
        return BranchPixel<kProbes>{.texture = texture, .sampler = seam_sampler(), .cure = chosen};
    });
}

constexpr std::array<std::string_view, 3> kDiscardCures{"none", "demote", "explicit-gradients"};

/// Holes cut by a discard, then a sample. Without a cure, lanes that are discarded return at once, as the C of a shader reads:
/// they compute no coordinates and hold old values.
template <bool kProbes>
struct DiscardPixel {
    enum Cure : int { kNone, kDemote, kExplicitGradients };  // in the order of kDiscardCures

    static constexpr bool discards = true;

    TextureId texture = TextureId::None;
    Sampler sampler;
    int cure = 0;  // of kDiscardCures

    static constexpr auto fields() {
        using D = DiscardPixel;
        return std::tuple{Field{"texture", &D::texture}, Field{"sampler", &D::sampler}, Field{"cure", &D::cure}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Mask hole = in_disc(f.position);
        SeamLookup<Real> lookup{f.in.at, cure == kExplicitGradients};
        if (cure == kExplicitGradients) lookup.gradients = shader_gradients(f, lookup.coordinate.x, lookup.coordinate.y);
        f.discard(hole);
        if (cure == kNone) {
            lookup.coordinate.x = gnomon::select(hole, Real(0.0f), lookup.coordinate.x);
            lookup.coordinate.y = gnomon::select(hole, Real(0.0f), lookup.coordinate.y);
        }
        const Real value = look_up(f, texture, sampler, lookup);
        return seam_colors<kProbes>(f, value, [&] {
            const Real choice = gnomon::select(hole, Real(1.0f), Real(0.0f));
            return flow_lanes(f, texture, sampler, !hole, lookup, choice, value);
        });
    }
};

SeamImage draw_discard(Device& device, std::string_view cure) {
    const int chosen = seam_cure("discard", kDiscardCures, cure);
    const TextureId texture = seam_texture(device, kFlowSide);
    return draw_seam(device, "seam.discard", kFlowPlane, [&]<bool kProbes>(std::bool_constant<kProbes>) {
        return DiscardPixel<kProbes>{.texture = texture, .sampler = seam_sampler(), .cure = chosen};
    });
}

}  // namespace

SeamCase branch_seam() {
    return {.name = "branch",
            .summary = "a sample inside a branch that not all lanes take, at coordinates computed there",
            .source = "D3D11.3 3.5.7; HLSL's 'gradient instruction used in a branch'",
            .expectation =
                "none: every pixel whose derivatives read a lane outside is bad and flagged; coordinates-before: "
                "flagged, but none is bad; explicit-gradients: none is bad or flagged",
            .cures = {kBranchCures.begin(), kBranchCures.end()},
            .reference = "explicit-gradients",
            .draw = draw_branch};
}

SeamCase discard_seam() {
    return {.name = "discard",
            .summary = "a sample behind a discard: lanes that returned at once hold old coordinates",
            .source = "alpha-tested casters; D3D11.3 22.5.1, Vulkan 1.3 (Helper Invocations): terminate or demote",
            .expectation =
                "none: every pixel whose derivatives read a discarded lane is bad and flagged; demote (discarded lanes "
                "go on as helpers): flagged, but none is bad; explicit-gradients: none is bad or flagged",
            .cures = {kDiscardCures.begin(), kDiscardCures.end()},
            .reference = "explicit-gradients",
            .draw = draw_discard};
}

}  // namespace gnomon::studies
