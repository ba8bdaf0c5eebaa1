#pragma once

#include "souple/math/transform.h"
#include "souple/math/vec3.h"

#include <array>

namespace souple::render {

/// Column-major as in OpenGL: m[4 * column + row]. Acts on column vectors.
struct Mat4 {
  std::array<float, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

  friend Mat4 operator*(const Mat4& a, const Mat4& b);
};

struct Vec4 {
  float x = 0, y = 0, z = 0, w = 0;
};
Vec4 operator*(const Mat4& m, const Vec4& v);
Mat4 inverse(const Mat4& m);  ///< of an invertible matrix
Mat4 to_mat4(const Transform& transform);

/// OpenGL clip space: x, y, z in [-w, w]; the eye looks along -z. `fov` is vertical [rad].
Mat4 perspective(float fov, float aspect, float near, float far);
Mat4 orthographic(float left, float right, float bottom, float top, float near, float far);
/// World -> (x, y, depth), each in [0, 1], from world -> clip.
Mat4 to_texture(const Mat4& clip);
Mat4 look_at(const Vec3f& eye, const Vec3f& target, const Vec3f& up);

}  // namespace souple::render
