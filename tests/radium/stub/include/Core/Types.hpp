#pragma once

#include <Core/RaCore.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace Ra {
namespace Core {

using Vector2 = Eigen::Matrix<Scalar, 2, 1>;
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
using Vector4 = Eigen::Matrix<Scalar, 4, 1>;
using VectorN = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
using Vector2f = Eigen::Vector2f;
using Vector3f = Eigen::Vector3f;
using Vector4f = Eigen::Vector4f;
using Vector2d = Eigen::Vector2d;
using Vector3d = Eigen::Vector3d;
using Vector4d = Eigen::Vector4d;
using Vector2i = Eigen::Vector2i;
using Vector3i = Eigen::Vector3i;
using Vector4i = Eigen::Vector4i;
using Vector1ui = Eigen::Matrix<uint, 1, 1>;
using Vector2ui = Eigen::Matrix<uint, 2, 1>;
using Vector3ui = Eigen::Matrix<uint, 3, 1>;
using Vector4ui = Eigen::Matrix<uint, 4, 1>;
using VectorNui = Eigen::Matrix<uint, Eigen::Dynamic, 1>;

using Matrix2 = Eigen::Matrix<Scalar, 2, 2>;
using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;
using Matrix4 = Eigen::Matrix<Scalar, 4, 4>;

using Quaternion = Eigen::Quaternion<Scalar>;
using AngleAxis = Eigen::AngleAxis<Scalar>;
using Translation = Eigen::Translation<Scalar, 3>;
using Transform = Eigen::Transform<Scalar, 3, Eigen::Affine>;
using Ray = Eigen::ParametrizedLine<Scalar, 3>;
using Aabb = Eigen::AlignedBox<Scalar, 3>;

}  // namespace Core
}  // namespace Ra
