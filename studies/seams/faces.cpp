// Seams between the faces of a cube that the shader projects onto by itself. D3D11.3 7.18.7 has the faces
#include "studies/seams/case_list.h"

namespace gnomon::studies {

namespace {

constexpr std::array<std::string_view, 3> kFaceCures{"none", "explicit-gradients", "quad-broadcast"};

/// Six slices of an array as a cube: an omnidirectional shadow map where there are no comparison cubes.
template <bool kProbes>
struct FacePixel {
    enum Cure : int { kNone, kExplicitGradients, kQuadBroadcast };  // in the order of kFaceCures

    TextureId faces = TextureId::None;
    Sampler sampler;
    int cure = 0;  // of kFaceCures

    static constexpr auto fields() {
        using P = FacePixel;
        return std::tuple{Field{"faces", &P::faces}, Field{"sampler", &P::sampler}, Field{"cure", &P::cure}};
    }

    /// The direction that a point of the plane shows: a stereographic projection, which shows all but one.
    template <class Real>
    static Vec3<Real> direction(const Vec3<Real>& at) {
        const Real two(2.0f);
        return {two * at.x, two * at.y, (Real(1.0f) - at.x * at.x) - at.y * at.y};
    }
    template <class Real>
    static Vec3<Real> direction_change(const Vec3<Real>& at, const glm::vec3& step) {
        const Real two(2.0f);
        const Real x(step.x);
        const Real y(step.y);
        return {two * x, two * y, -two * (at.x * x + at.y * y)};
    }

    /// +x, -x, +y, -y, +z, -z as 0 to 5.
    template <class Real>
    static Real face_of(const Vec3<Real>& d) {
        const Real x = abs(d.x);
        const Real y = abs(d.y);
        const Real z = abs(d.z);
        const Mask by_x = (x >= y) & (x >= z);
        const Real major = gnomon::select(by_x, d.x, gnomon::select(y >= z, d.y, d.z));
        const Real axis = gnomon::select(by_x, Real(0.0f), gnomon::select(y >= z, Real(2.0f), Real(4.0f)));
        return axis + gnomon::select(major < Real(0.0f), Real(1.0f), Real(0.0f));
    }
    /// Right, down and out of the face: linear in the vector.
    template <class Real>
    static Vec3<Real> in_face(const Real& face, const Vec3<Real>& d) {
        const auto is = [&](float number) { return face == Real(number); };
        const auto pick = [&](const std::array<Real, 6>& of_face) {
            Real value = of_face[5];
            for (std::size_t i = 0; i < 5; ++i) value = gnomon::select(is(static_cast<float>(i)), of_face[i], value);
            return value;
        };
        return {pick({-d.z, d.z, d.x, d.x, d.x, -d.x}), pick({-d.y, -d.y, d.z, -d.z, -d.y, -d.y}),
                pick({d.x, -d.x, d.y, -d.y, d.z, -d.z})};
    }
    template <class Real>
    static Vec3<Real> coordinate_in(const Real& face, const Vec3<Real>& d) {
        const Vec3<Real> s = in_face(face, d);
        const Real half(0.5f);
        return {half * (s.x / s.z) + half, half * (s.y / s.z) + half, face};
    }
    /// Exact derivatives: (s / m)' = (s' - (s / m) m') / m.
    template <class Real>
    static Vec2<Real> derivative_in(const Real& face, const Vec3<Real>& d, const Vec3<Real>& change) {
        const Vec3<Real> s = in_face(face, d);
        const Vec3<Real> c = in_face(face, change);
        const Real half(0.5f);
        return {half * (c.x - s.x / s.z * c.z) / s.z, half * (c.y - s.y / s.z * c.z) / s.z};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec3<Real> d = direction(f.in.at);
        const Real own = face_of(d);
        const Real used = cure == kQuadBroadcast ? f.template quad_read<0>(own) : own;
        SeamLookup<Real> lookup{coordinate_in(used, d), cure == kExplicitGradients};
        const auto gradients_in = [&](const Real& face) {
            const Vec3<Real> at = coordinate_in(face, d);
            return shader_gradients(f, at.x, at.y);
        };
        if (cure == kExplicitGradients)
            for (int i = 0; i < kCubeFaces; ++i) {
                const Real face(static_cast<float>(i));
                lookup.gradients = select(used == face, gradients_in(face), lookup.gradients);
            }
        const Real value = look_up(f, faces, sampler, lookup);
        return seam_colors<kProbes>(f, value, [&] {
            const auto smooth = [&](const auto& of_lane) {
                SeamLookup<Real> on_face{coordinate_in(of_lane(used), d), cure == kExplicitGradients};
                if (cure == kExplicitGradients) on_face.gradients = gradients_in(of_lane(used));
                return on_face;
            };
            const Gradients<Real> exact{derivative_in(used, d, direction_change(f.in.at, kFacesPlane.dx)),
                                        derivative_in(used, d, direction_change(f.in.at, kFacesPlane.dy))};
            return SeamLanes<Real>{.own = own,
                                   .used = used,
                                   .sampled = level_of(f, faces, sampler, lookup),
                                   .smooth_lod = smooth_lod_of(f, faces, sampler, used, smooth),
                                   .exact_lod = f.lod(faces, sampler, exact).unclamped,
                                   .outside = used != own,
                                   .value = value};
        });
    }
};

SeamImage draw_faces(Device& device, std::string_view cure) {
    const int chosen = seam_cure("cube-faces", kFaceCures, cure);
    const TextureId faces = seam_texture(device, kFaceSide, kCubeFaces);
    return draw_seam(device, "seam.cube_faces", kFacesPlane, [&]<bool kProbes>(std::bool_constant<kProbes>) {
        return FacePixel<kProbes>{.faces = faces, .sampler = seam_sampler(AddressMode::Clamp), .cure = chosen};
    });
}

}  // namespace

SeamCase cube_faces_seam() {
    return {.name = "cube-faces",
            .summary = "a direction that the shader projects onto the face of a cube by itself",
            .source = "omnidirectional shadow maps as six slices or six tiles of an atlas",
            .expectation =
                "none: every pixel whose derivatives cross an edge is bad; explicit-gradients: none is; "
                "quad-broadcast: none is, but lanes read past their face",
            .cures = {kFaceCures.begin(), kFaceCures.end()},
            .reference = "explicit-gradients",
            .draw = draw_faces};
}

}  // namespace gnomon::studies
