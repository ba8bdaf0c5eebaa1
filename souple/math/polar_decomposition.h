#pragma once

#include "souple/math/svd.h"

namespace souple {

/// The rotation R of the polar decomposition M = R S, with det R = +1 also where M reflects. R = U V^T of the singular
/// value decomposition (see svd.h for its conventions).
///
/// R minimizes |M - R| and maximizes trace(R^T M) among rotations (Kabsch 1978). It is unique unless sigma.y
/// + sigma.z = 0. For M of rank 1 or 0, and for reflections with two equal smallest singular values, the result is one
/// of the nearest rotations. For M = 0 it is the identity.
template <class T>
Mat3<T> nearest_rotation(const Mat3<T>& m) {
  const Svd<T> d = svd(m);
  return d.u * transpose(d.v);
}

}  // namespace souple
