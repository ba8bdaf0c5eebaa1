#pragma once

#include "souple/constraints/all.h"

#include <array>
#include <cstdint>
#include <cstring>

// One example of each constraint kind, a meter in size, for the typed tests. A new kind adds its example
// here.

namespace souple {

/// A small pseudo-random generator that gives equal numbers with every compiler.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2862933555777941757u + 3037000493u) {}
  /// Uniform in [-1, 1).
  double operator()() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
  }
  Vec3d vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

template <class Kind>
using Points = std::array<Vec3d, Kind::arity>;
template <class Kind>
using ParamsOf = typename Kind::template Params<float>;

template <class Kind>
struct Example;  // points(): a regular shape; params(points): parameters for which these points are at rest
                 // or well within the limit

struct TetExample {
  static std::array<Vec3d, 4> points() {
    return {{{0, 0, 0}, {1, 0.1, 0}, {0.2, 0.9, 0.1}, {0.1, 0.3, 1.1}}};
  }
};
struct HingeExample {
  static std::array<Vec3d, 4> points() { return {{{0, 0, 0}, {1, 0, 0.1}, {0.4, 0.8, 0}, {0.7, -0.9, 0}}}; }
};

template <class Kind>
const Vec3d (&raw(const Points<Kind>& x))[Kind::arity] {
  return *reinterpret_cast<const Vec3d(*)[Kind::arity]>(x.data());
}

template <>
struct Example<Distance> {
  static Points<Distance> points() { return {{{0, 0, 0}, {0.8, 0.5, 0.3}}}; }
  static ParamsOf<Distance> params(const Points<Distance>& x) {
    return {static_cast<float>(length(x[0] - x[1]))};
  }
};
template <>
struct Example<DihedralBending> : HingeExample {
  static ParamsOf<DihedralBending> params(const Points<DihedralBending>& x) {
    return DihedralBending::from_rest(raw<DihedralBending>(x));
  }
};
template <>
struct Example<IsometricBending> : HingeExample {
  static ParamsOf<IsometricBending> params(const Points<IsometricBending>& x) {
    return IsometricBending::from_rest(raw<IsometricBending>(x));
  }
};
template <>
struct Example<RopeBending> {
  static Points<RopeBending> points() { return {{{0, 0, 0}, {0.9, 0.2, 0.1}, {1.7, 0.9, -0.2}}}; }
  static ParamsOf<RopeBending> params(const Points<RopeBending>&) { return {1.0f}; }
};
template <>
struct Example<TriangleMembrane> {
  static Points<TriangleMembrane> points() { return {{{0, 0, 0}, {1, 0.1, 0.2}, {0.2, 0.9, 0}}}; }
  static ParamsOf<TriangleMembrane> params(const Points<TriangleMembrane>& x) {
    return TriangleMembrane::from_rest(raw<TriangleMembrane>(x), {1, 1, 0});
  }
};
template <>
struct Example<TetVolume> : TetExample {
  static ParamsOf<TetVolume> params(const Points<TetVolume>& x) {
    return TetVolume::from_rest(raw<TetVolume>(x));
  }
};
template <>
struct Example<NeoHookean> : TetExample {
  static ParamsOf<NeoHookean> params(const Points<NeoHookean>& x) {
    return NeoHookean::from_rest(raw<NeoHookean>(x));
  }
};
template <>
struct Example<ParticleContact> {
  static Points<ParticleContact> points() { return {{{0, 0, 0}, {0.8, 0.5, 0.3}}}; }
  static ParamsOf<ParticleContact> params(const Points<ParticleContact>& x) {
    return {static_cast<float>(length(x[0] - x[1]))};
  }
};
template <>
struct Example<Attachment> {
  static Points<Attachment> points() { return {{{0.3, 0.5, -0.2}}}; }  // relative to the target
  static ParamsOf<Attachment> params(const Points<Attachment>&) { return {{3, 4, 5}}; }
};
template <>
struct Example<BallJoint> {
  static Points<BallJoint> points() { return {{{0, 0, 0}, {1, 0, 0}, {0.6, 0, 0}, {0.9, 0.8, 0.5}}}; }
  static ParamsOf<BallJoint> params(const Points<BallJoint>& x) {
    return BallJoint::from_rest(raw<BallJoint>(x), x[0] + (x[1] - x[0]) * 0.6);
  }
};
template <>
struct Example<ConeLimit> {
  static Points<ConeLimit> points() { return {{{0, 0, 0}, {1, 0, 0}, {1.8, 0.5, 0.1}}}; }
  static ParamsOf<ConeLimit> params(const Points<ConeLimit>&) { return {0.3f}; }
};
template <>
struct Example<TwistLimit> : HingeExample {
  static ParamsOf<TwistLimit> params(const Points<TwistLimit>& x) {
    return TwistLimit::from_rest(raw<TwistLimit>(x), 0.1);
  }
};
template <>
struct Example<Tether> {
  static Points<Tether> points() { return {{{0, 0, 0}, {0.8, 0.5, 0.3}}}; }
  static ParamsOf<Tether> params(const Points<Tether>& x) { return Tether::from_rest(raw<Tether>(x)); }
};

/// Converts parameters to another scalar type; they consist of plain numbers.
template <class Kind, class T>
typename Kind::template Params<T> converted(const ParamsOf<Kind>& params) {
  constexpr std::size_t count = sizeof(params) / sizeof(float);
  static_assert(sizeof(typename Kind::template Params<T>) == count * sizeof(T));
  std::array<float, count> from;
  std::memcpy(from.data(), &params, sizeof(params));
  std::array<T, count> to;
  for (std::size_t i = 0; i < count; ++i) to[i] = T(from[i]);
  typename Kind::template Params<T> result;
  std::memcpy(static_cast<void*>(&result), to.data(), sizeof(result));
  return result;
}

}  // namespace souple
