#pragma once

#include "souple/math/svd.h"

namespace souple {

/// The factors of M = R S.
template <class T>
struct PolarDecomposition {
  Mat3<T> rotation;  ///< the rotation nearest to M: det = +1, also where M reflects
  Mat3<T> stretch;   ///< exactly symmetric; unit of M. Where M reflects, its smallest eigenvalue is negative
};

/// R = U V^T, S = V diag(sigma) V^T of the singular value decomposition (see svd.h for its conventions).
///
/// R minimizes |M - R| and maximizes trace(R^T M) among rotations (Kabsch 1978). It is unique unless sigma.y
/// + sigma.z = 0. For M of rank 1 or 0, and for reflections with two equal smallest singular values, the result is one
/// of the nearest rotations. For M = 0 it is the identity.
template <class T>
PolarDecomposition<T> polar_decomposition(const Mat3<T>& m) {
  const Svd<T> d = svd(m);
  const Mat3<T> v_sigma{d.v.column[0] * d.sigma.x, d.v.column[1] * d.sigma.y, d.v.column[2] * d.sigma.z};
  Mat3<T> s = v_sigma * transpose(d.v);
  s(0, 1) = s(1, 0);
  s(0, 2) = s(2, 0);
  s(1, 2) = s(2, 1);
  return {d.u * transpose(d.v), s};
}

/// The rotation R alone.
template <class T>
Mat3<T> nearest_rotation(const Mat3<T>& m) {
  const Svd<T> d = svd(m);
  return d.u * transpose(d.v);
}

}  // namespace souple
