#pragma once

#include <Core/RaCore.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace Ra {
namespace Core {
namespace Utils {

/// Red, green, blue and opacity, 0 to 1; white unless told.
template <typename S>
class ColorBase : public Eigen::Matrix<S, 4, 1> {
 public:
  using VectorType = Eigen::Matrix<S, 4, 1>;

  explicit ColorBase() : VectorType(S(1), S(1), S(1), S(1)) {}

  template <typename T>
  ColorBase(T r, T g, T b, T alpha = T(1)) : VectorType(S(r), S(g), S(b), S(alpha)) {}

  template <typename Derived>
  ColorBase(const Eigen::MatrixBase<Derived>& rgba) : VectorType(rgba.template cast<S>()) {}

  template <typename Derived>
  static ColorBase fromRGB(const Eigen::MatrixBase<Derived>& rgb, Scalar alpha = 1) {
    return {S(rgb(0)), S(rgb(1)), S(rgb(2)), S(alpha)};
  }

  Eigen::Block<VectorType, 3, 1> rgb() { return this->template head<3>(); }
  Eigen::Matrix<S, 3, 1> rgb() const { return this->template head<3>(); }
  S alpha() const { return (*this)(3); }
  S& alpha() { return (*this)(3); }

  static ColorBase Black() { return {S(0), S(0), S(0)}; }
  static ColorBase Red() { return {S(1), S(0), S(0)}; }
  static ColorBase Green() { return {S(0), S(1), S(0)}; }
  static ColorBase Blue() { return {S(0), S(0), S(1)}; }
  static ColorBase Yellow() { return {S(1), S(1), S(0)}; }
  static ColorBase Magenta() { return {S(1), S(0), S(1)}; }
  static ColorBase Cyan() { return {S(0), S(1), S(1)}; }
  static ColorBase White() { return {S(1), S(1), S(1)}; }
  static ColorBase Gray(S value = S(0.5), S alpha = S(1)) { return {value, value, value, alpha}; }
};

using Color = ColorBase<Scalar>;
using Colorf = ColorBase<float>;
using Colord = ColorBase<double>;

}  // namespace Utils
}  // namespace Core
}  // namespace Ra
