// Small vectors and 4x4 matrix products of lane values, as shaders use them.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace gnomon {

template <class Real>
struct Vec2 {
    Real x, y;
};

template <class Real>
struct Vec3 {
    Real x, y, z;
};

template <class Real>
struct Vec4 {
    Real x, y, z, w;
};

template <class Real>
Vec2<Real> operator+(Vec2<Real> a, Vec2<Real> b) {
    return {a.x + b.x, a.y + b.y};
}
template <class Real>
Vec3<Real> operator+(Vec3<Real> a, Vec3<Real> b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Real>
Vec3<Real> operator-(Vec3<Real> a, Vec3<Real> b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Real>
Vec3<Real> operator*(Vec3<Real> a, Real s) {
    return {a.x * s, a.y * s, a.z * s};
}

template <class Real>
Real dot(Vec2<Real> a, Vec2<Real> b) {
    return a.x * b.x + a.y * b.y;
}
template <class Real>
Real dot(Vec3<Real> a, Vec3<Real> b) {
    return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
template <class Real>
Vec3<Real> normalize(Vec3<Real> a) {
    return a * (Real(1.0f) / sqrt(dot(a, a)));
}

/// A uniform vector in every lane.
template <class Real>
Vec3<Real> splat(const glm::vec3& a) {
    return {Real(a.x), Real(a.y), Real(a.z)};
}

/// m * (p, 1), rows summed left to right.
template <class Real>
Vec4<Real> transform_point(const glm::mat4& m, Vec3<Real> p) {
    const auto row = [&](int r) { return ((Real(m[0][r]) * p.x + Real(m[1][r]) * p.y) + Real(m[2][r]) * p.z) + Real(m[3][r]); };
    return {row(0), row(1), row(2), row(3)};
}

/// The upper 3x3 of m times v.
template <class Real>
Vec3<Real> transform_vector(const glm::mat4& m, Vec3<Real> v) {
    const auto row = [&](int r) { return (Real(m[0][r]) * v.x + Real(m[1][r]) * v.y) + Real(m[2][r]) * v.z; };
    return {row(0), row(1), row(2)};
}

}  // namespace gnomon
