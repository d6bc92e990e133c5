// Seams at the edges of triangles under multisampling: a centroid varying is taken at the centre of covered pixels and at a
// sample of cut ones, so that neighbours are less or more than a pixel apart. D3D11.3 3.5.5
#include "studies/seams/case_list.h"
#include "techniques/common/full_screen.h"

namespace gnomon::studies {

namespace {

constexpr std::array<std::string_view, 2> kCentroidCures{"none", "explicit-gradients"};

/// One coordinate, evaluated in two places.
struct CentroidVertex {
    template <class Real>
    struct Input {
        Vec2<Real> position;
        Vec2<Real> coordinate;
    };
    template <class Real>
    struct Varyings {
        Vec2<Real> centroid;
        Vec2<Real> centre;
        static constexpr std::array interpolation{Interpolation::PerspectiveCentroid, Interpolation::PerspectiveCentroid,
                                                  Interpolation::Perspective, Interpolation::Perspective};
    };
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return VertexOutput{Vec4<Real>{v.in.position.x, v.in.position.y, Real(0.5f), Real(1.0f)},
                            Varyings<Real>{v.in.coordinate, v.in.coordinate}};
    }
};

/// Samples at the centroid, so that it never reads outside of what the triangle covers.
template <bool kProbes>
struct CentroidPixel {
    enum Cure : int { kNone, kExplicitGradients };  // in the order of kCentroidCures

    TextureId texture = TextureId::None;
    Sampler sampler;
    int cure = 0;  // of kCentroidCures

    static constexpr auto fields() {
        using C = CentroidPixel;
        return std::tuple{Field{"texture", &C::texture}, Field{"sampler", &C::sampler}, Field{"cure", &C::cure}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec2<Real>& centroid = f.in.centroid;
        const Vec2<Real>& centre = f.in.centre;
        SeamLookup<Real> lookup{flat_coordinate(centroid.x, centroid.y), cure == kExplicitGradients};
        if (cure == kExplicitGradients) lookup.gradients = shader_gradients(f, centre.x, centre.y);
        const Real value = look_up(f, texture, sampler, lookup);
        return seam_colors<kProbes>(f, value, [&] {
            // Samples are an eighth of a pixel from the centre at least.
            const Real least(kCentroidPlane.dx.x * 0.0625f);
            const Mask moved = max(abs(centroid.x - centre.x), abs(centroid.y - centre.y)) > least;
            const Real own = gnomon::select(moved, Real(1.0f), Real(0.0f));
            SeamLookup<Real> smooth{flat_coordinate(centre.x, centre.y), cure == kExplicitGradients};
            if (cure == kExplicitGradients) smooth.gradients = lookup.gradients;
            return SeamLanes<Real>{.own = own,
                                   .used = own,
                                   .sampled = level_of(f, texture, sampler, lookup),
                                   .smooth_lod = level_of(f, texture, sampler, smooth).unclamped,
                                   .exact_lod = f.lod(texture, sampler, plane_gradients<Real>(kCentroidPlane)).unclamped,
                                   .outside = Mask(false),
                                   .value = value};
        });
    }
};

/// What the fragment of each pixel left in its first covered sample.
struct FirstCovered {
    MultisampledTexture first;
    MultisampledTexture second;
    MultisampledTexture third;

    static constexpr auto fields() {
        using C = FirstCovered;
        return std::tuple{Field{"first", &C::first}, Field{"second", &C::second}, Field{"third", &C::third}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Int x = truncate_to_int(f.position.x);
        const Int y = truncate_to_int(f.position.y);
        const std::array<MultisampledTexture, kProbeTargets> from{first, second, third};
        std::array<Vec4<Real>, kProbeTargets> found{};
        for (int s = kCentroidSamples; s-- > 0;) {
            const Mask covered = f.load(first, x, y, s).x >= Real(0.0f);
            for (std::size_t i = 0; i < kProbeTargets; ++i) {
                const Vec4<Real> here = f.load(from[i], x, y, s);
                const auto take = [&](const Real& yes, const Real& no) { return gnomon::select(covered, yes, no); };
                found[i] = {take(here.x, found[i].x), take(here.y, found[i].y), take(here.z, found[i].z),
                            take(here.w, found[i].w)};
            }
            // Pixels without a covered sample stay undrawn.
            if (s == kCentroidSamples - 1) found[0].x = gnomon::select(covered, found[0].x, Real(-1.0f));
        }
        return found;
    }
};

/// Positions and coordinates of the triangles' corners: exact, for corners are multiples of 1/256 pixel.
std::vector<float> make_vertices() {
    std::vector<float> vertices;
    for (const CentroidTriangle& triangle : centroid_triangles())
        for (const glm::ivec2& corner : triangle) {
            const glm::vec2 at_px = glm::vec2(corner) / 256.0f;
            const glm::vec3 value = kCentroidPlane.origin + kCentroidPlane.dx * at_px.x + kCentroidPlane.dy * at_px.y;
            vertices.insert(vertices.end(),
                            {at_px.x / (kSeamSide / 2) - 1.0f, 1.0f - at_px.y / (kSeamSide / 2), value.x, value.y});
        }
    return vertices;
}

SeamImage draw_centroid(Device& device, std::string_view cure) {
    const int chosen = seam_cure("centroid", kCentroidCures, cure);
    const TextureId texture = seam_texture(device, kCentroidSide);
    const Sampler sampler = seam_sampler();
    const std::vector<float> corners = make_vertices();
    const BufferId vertices = device.create_buffer("seam triangles", std::as_bytes(std::span(corners)));
    const auto target = [&](Format format) {
        return device.create_texture("seam samples",
                                     {.format = format, .width = kSeamSide, .height = kSeamSide, .samples = kCentroidSamples});
    };
    const CentroidVertex vertex;
    const auto draw_of = [&](const Program& program, std::span<const std::byte> constants) {
        return Draw{.label = "seam.centroid",
                    .program = &program,
                    .vertex_constants = constants_of(vertex),
                    .pixel_constants = constants,
                    .vertices = vertices,
                    .count = static_cast<std::uint32_t>(corners.size() / 4)};
    };

    // Probed, into samples; then a sample of each pixel.
    static const Program probed_program = make_program<CentroidVertex, CentroidPixel<true>>("seam.centroid.probed");
    const CentroidPixel<true> probed{.texture = texture, .sampler = sampler, .cure = chosen};
    Draw draw = draw_of(probed_program, constants_of(probed));
    FirstCovered found;
    for (MultisampledTexture* samples : {&found.first, &found.second, &found.third}) {
        samples->texture = target(Format::Rgba32Float);
        device.execute(ClearColor{samples->texture, glm::vec4(-1.0f)});
    }
    draw.color[0] = found.first.texture;
    draw.color[1] = found.second.texture;
    draw.color[2] = found.third.texture;
    device.execute(draw);
    const ProbeTargets targets(device, kSeamSide, kSeamSide);
    static const Program found_program = make_program<techniques::FullScreenVertex, FirstCovered>("seam.centroid.found");
    techniques::FullScreen(device).run("first covered samples", found_program, found, targets.colors());

    // As a user would draw it.
    static const Program plain_program = make_program<CentroidVertex, CentroidPixel<false>>("seam.centroid");
    const CentroidPixel<false> plain{.texture = texture, .sampler = sampler, .cure = chosen};
    draw = draw_of(plain_program, constants_of(plain));
    draw.color[0] = target(Format::Rgba8Unorm);
    draw.derivative_report = targets.derivatives();
    SeamImage measured;
    measure_draw(device, draw, measured);

    SeamImage image = targets.read();
    image.counters = measured.counters;
    image.milliseconds = measured.milliseconds;
    return image;
}

}  // namespace

const std::vector<CentroidTriangle>& centroid_triangles() {
    static const std::vector<CentroidTriangle> triangles = [] {
        constexpr int kPixel = 256;
        constexpr int kCell = 32;  // pixels
        constexpr CentroidTriangle kFirst{glm::ivec2{3 * kPixel + 77, 4 * kPixel + 19},
                                          glm::ivec2{28 * kPixel + 181, 9 * kPixel + 53},
                                          glm::ivec2{11 * kPixel + 105, 28 * kPixel + 229}};
        std::vector<CentroidTriangle> made;
        for (int row = 0; row < kSeamSide / kCell; ++row)
            for (int column = 0; column < kSeamSide / kCell; ++column) {
                // Each its own slopes: mirrored, and narrower from column to column and row to row.
                CentroidTriangle triangle = kFirst;
                triangle[1] -= glm::ivec2(column * 331, row * -217);
                triangle[2] -= glm::ivec2(row * -151, column * 413);
                for (glm::ivec2& corner : triangle) {
                    if (column % 2 != 0) corner.x = kCell * kPixel - corner.x;
                    if (row % 2 != 0) corner.y = kCell * kPixel - corner.y;
                    corner += glm::ivec2(column, row) * (kCell * kPixel);
                }
                made.push_back(triangle);
            }
        return made;
    }();
    return triangles;
}

SeamCase centroid_seam() {
    return {.name = "centroid",
            .summary = "derivatives of a centroid varying at the edges of triangles, 4 samples per pixel",
            .source = "D3D11.3 3.5.5",
            .expectation =
                "none: pixels whose derivatives read a centroid off its centre are bad, by up to a level; "
                "explicit-gradients (of the centre): none is",
            .cures = {kCentroidCures.begin(), kCentroidCures.end()},
            .reference = "explicit-gradients",
            .draw = draw_centroid};
}

}  // namespace gnomon::studies
