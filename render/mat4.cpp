#include "render/mat4.h"

#include <cmath>
#include <cstddef>
#include <utility>

namespace souple::render {

Mat4 operator*(const Mat4& a, const Mat4& b) {
  Mat4 product;
  for (std::size_t column = 0; column < 4; ++column) {
    for (std::size_t row = 0; row < 4; ++row) {
      float sum = 0;
      for (std::size_t k = 0; k < 4; ++k) sum += a.m[4 * k + row] * b.m[4 * column + k];
      product.m[4 * column + row] = sum;
    }
  }
  return product;
}

Vec4 operator*(const Mat4& m, const Vec4& v) {
  const auto row = [&](std::size_t r) {
    return m.m[r] * v.x + m.m[4 + r] * v.y + m.m[8 + r] * v.z + m.m[12 + r] * v.w;
  };
  return {row(0), row(1), row(2), row(3)};
}

Mat4 inverse(const Mat4& m) {
  // Gauss-Jordan elimination with the largest pivot of each column, in double: near and far planes differ by
  // orders of magnitude.
  std::array<std::array<double, 8>, 4> rows{};
  for (std::size_t r = 0; r < 4; ++r) {
    for (std::size_t c = 0; c < 4; ++c) rows[r][c] = double(m.m[4 * c + r]);
    rows[r][4 + r] = 1;
  }
  for (std::size_t c = 0; c < 4; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < 4; ++r) {
      if (std::abs(rows[r][c]) > std::abs(rows[pivot][c])) pivot = r;
    }
    std::swap(rows[c], rows[pivot]);
    const double scale = 1 / rows[c][c];
    for (double& value : rows[c]) value *= scale;
    for (std::size_t r = 0; r < 4; ++r) {
      const double factor = rows[r][c];
      if (r == c || factor == 0) continue;
      for (std::size_t k = 0; k < 8; ++k) rows[r][k] -= factor * rows[c][k];
    }
  }
  Mat4 result;
  for (std::size_t r = 0; r < 4; ++r) {
    for (std::size_t c = 0; c < 4; ++c) result.m[4 * c + r] = float(rows[r][4 + c]);
  }
  return result;
}

Mat4 to_mat4(const Transform& transform) {
  Mat4 result;
  const std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  for (std::size_t column = 0; column < 3; ++column) {
    const Vec3d image = transform.direction(axes[column]) * transform.scale;
    for (int row = 0; row < 3; ++row) result.m[4 * column + std::size_t(row)] = float(image[row]);
  }
  for (int row = 0; row < 3; ++row) result.m[12 + std::size_t(row)] = float(transform.translation[row]);
  return result;
}

Mat4 perspective(float fov, float aspect, float near, float far) {
  const float scale = 1 / std::tan(fov / 2);
  Mat4 result;
  result.m = {};
  result.m[0] = scale / aspect;
  result.m[5] = scale;
  result.m[10] = (far + near) / (near - far);
  result.m[11] = -1;
  result.m[14] = 2 * far * near / (near - far);
  return result;
}

Mat4 orthographic(float left, float right, float bottom, float top, float near, float far) {
  Mat4 result;
  result.m[0] = 2 / (right - left);
  result.m[5] = 2 / (top - bottom);
  result.m[10] = 2 / (near - far);
  result.m[12] = (left + right) / (left - right);
  result.m[13] = (bottom + top) / (bottom - top);
  result.m[14] = (near + far) / (near - far);
  return result;
}

Mat4 to_texture(const Mat4& clip) {
  Mat4 half;
  half.m = {0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 0.5f, 0, 0.5f, 0.5f, 0.5f, 1};
  return half * clip;
}

Mat4 look_at(const Vec3f& eye, const Vec3f& target, const Vec3f& up) {
  const Vec3f back = normalized(eye - target);
  const Vec3f right = normalized(cross(up, back));
  const Vec3f above = cross(back, right);
  Mat4 result;
  result.m = {right.x, above.x, back.x, 0, right.y,          above.y,          back.y,          0,
              right.z, above.z, back.z, 0, -dot(right, eye), -dot(above, eye), -dot(back, eye), 1};
  return result;
}

}  // namespace souple::render
