// Cube maps: from a direction to a face, and across the edges of faces. D3D11.3 5.3.8, 7.18.7, 7.18.11, 7.18.12
#pragma once

#include "sim/double_lanes.h"
#include "sim/vec.h"

namespace gnomon {

/// A direction on the face it leaves the cube through: +x, -x, +y, -y, +z, -z are faces 0 to 5.
template <class Real>
struct CubeDirection {
    Int face;
    Vec2<Real> minor;  // the two other components, mirrored into the axes of the face: right and down
    Real major;        // magnitude of the largest component
};

/// The components of v along the right and down axes of each lane's face. D3D11.3 5.3.8
template <class Value>
Vec2<Value> minor_axes(Int face, const Vec3<Value>& v) {
    const Mask negative = (face & Int(1)) == Int(1);
    const Mask along_x = face < Int(2);
    const Mask along_y = (face == Int(2)) | (face == Int(3));
    const Value zero(0);
    const Value right =
        select(along_x, select(negative, v.z, zero - v.z), select(along_y, v.x, select(negative, zero - v.x, v.x)));
    const Value down = select(along_y, select(negative, zero - v.z, v.z), zero - v.y);
    return {right, down};
}

/// The component of v out of each lane's face.
template <class Value>
Value major_axis(Int face, const Vec3<Value>& v) {
    const Value along = select(face < Int(2), v.x, select(face < Int(4), v.y, v.z));
    return select((face & Int(1)) == Int(1), Value(0) - along, along);
}

/// The face of the largest component; of equal ones z goes before y before x. D3D11.3 7.18.7
template <class Real>
[[gnu::noinline]] CubeDirection<Real> face_of(const Vec3<Real>& direction) {
    const Vec3<Real> size{abs(direction.x), abs(direction.y), abs(direction.z)};
    const Mask z = (size.z >= size.x) & (size.z >= size.y);
    const Mask y = size.y >= size.x;
    const auto pick = [&](const Real& component, int positive) {
        return select(component < Real(0.0f), Int(positive + 1), Int(positive));
    };
    const Int face = select(z, pick(direction.z, 4), select(y, pick(direction.y, 2), pick(direction.x, 0)));
    return {face, minor_axes(face, direction), major_axis(face, direction)};
}

/// Position on the face, [0, 1]. D3D11.3 7.18.7
template <class Real>
Vec2<Real> face_coordinate(const CubeDirection<Real>& on) {
    const Real half(0.5f);
    return {on.minor.x / on.major * half + half, on.minor.y / on.major * half + half};
}

/// Derivative of the position on the face from that of the direction: the quotient rule, halved for [0, 1]. D3D11.3 7.18.11
template <class Real>
Vec2<Real> face_derivative(const CubeDirection<Real>& on, const Vec3<Real>& derivative) {
    const Vec2<Real> minor = minor_axes(on.face, derivative);
    const Real major = major_axis(on.face, derivative);
    const Real squared = on.major * on.major;
    const Real half(0.5f);
    return {half * ((on.major * minor.x - on.minor.x * major) / squared),
            half * ((on.major * minor.y - on.minor.y * major) / squared)};
}

/// A texel of a face.
struct CubeTexel {
    Int face, x, y;
};

/// The texel of the adjacent face where x or y (not both) is one outside `size` texels; others stay. D3D11.3 7.18.12
inline CubeTexel across_edge(Int face, Int x, Int y, Int size) {
    // The texel's centre in half texels, and over the edge: what was outward becomes the new face's normal, and the old normal
    // ends half a texel inside.
    const Int right = x + x + Int(1) - size;
    const Int down = y + y + Int(1) - size;
    const Mask out_x = (x < Int(0)) | (x >= size);
    const Mask out_y = (y < Int(0)) | (y >= size);
    const Int r = select(out_x, clamp(right, Int(0) - size, size), right);
    const Int d = select(out_y, clamp(down, Int(0) - size, size), down);
    const Int out = select(out_x | out_y, size - Int(1), size);

    // In the axes of the cube.
    const Mask negative = (face & Int(1)) == Int(1);
    const Int signed_out = select(negative, Int(0) - out, out);
    const Mask along_x = face < Int(2);
    const Mask along_y = (face == Int(2)) | (face == Int(3));
    const Int minus_r = Int(0) - r;
    const Int minus_d = Int(0) - d;
    const Vec3<Int> v{select(along_x, signed_out, select(along_y, r, select(negative, minus_r, r))),
                      select(along_y, signed_out, minus_d),
                      select(along_x, select(negative, r, minus_r), select(along_y, select(negative, minus_d, d), signed_out))};

    // The new face is where a whole `size` points.
    const auto pick = [&](Int component, int positive) { return select(component < Int(0), Int(positive + 1), Int(positive)); };
    const auto reaches = [&](Int component) { return (component == size) | (component == Int(0) - size); };
    const Int other = select(reaches(v.x), pick(v.x, 0), select(reaches(v.y), pick(v.y, 2), pick(v.z, 4)));
    const Int moved = select(out_x | out_y, other, face);
    const Vec2<Int> minor = minor_axes(moved, v);
    return {moved, shift_right<1>(minor.x + size - Int(1)), shift_right<1>(minor.y + size - Int(1))};
}

}  // namespace gnomon
