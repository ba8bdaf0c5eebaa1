#pragma once

#include "souple/math/vec3.h"

#include <cstddef>
#include <cstdint>

// Kernels over the links of a coarse level (solver/level_links.h), one register of links at a time. A link keeps
// the distance of its ends J and K between l and L:
//
//   u = (X_J - X_K) + (d_J - d_K),   C = |u| - clamp(|u|, l, L)
//   d_J -= omega w_J g C u / |u|,    d_K += omega w_K g C u / |u|,    g = 1 / (w_J + w_K + alpha~)
//
// X_J - X_K is loaded from an array of its own: it is constant during a substep, and two records less are gathered.

namespace souple::kernels {

/// The links of a level, one array per number. Every color is padded to whole registers of the widest
/// instruction set with links of a fixed particle to itself.
struct LinkArrays {
  const std::uint32_t* a = nullptr;  ///< 4 times the end J: the index of its record's first float
  const std::uint32_t* b = nullptr;  ///< of the end K
  float* x = nullptr;                ///< X_J - X_K at the start of the substep [m]
  float* y = nullptr;
  float* z = nullptr;
  float* min_length = nullptr;  ///< l [m]
  float* max_length = nullptr;  ///< L [m]
  const float* gain = nullptr;  ///< g [kg]
};

/// What the limits of the links are measured from.
struct LinkMeasures {
  const float* position = nullptr;         ///< records X of the level
  const float* moving = nullptr;           ///< records d of the level; w = inverse mass
  const float* start = nullptr;            ///< records of the world's particles at the start of the substep
  const std::uint32_t* start_a = nullptr;  ///< 4 times the particle of the world that J is made from
  const std::uint32_t* start_b = nullptr;
  const float* rest_length = nullptr;  ///< of the link [m]
  const float* path_length =
      nullptr;               ///< rest length of the path along finer links [m]; null: no finer links
  float* stretch = nullptr;  ///< of the path, read; without path: of the link, written [m]
};

/// Fills x, y, z, min_length and max_length of links [begin, end), whole registers.
using MeasureLinks = void (*)(const LinkArrays&, const LinkMeasures&, std::size_t begin, std::size_t end);
/// Projects links [begin, end), whole registers, in order; `moving`: records d of the level.
using SweepLinks = void (*)(const LinkArrays&, float* moving, std::size_t begin, std::size_t end,
                            float relaxation);

struct LinkKernels {
  MeasureLinks measure;
  SweepLinks sweep;
};

/// Compiled in one translation unit per instruction set (compile_links.h).
template <class Isa>
const LinkKernels& link_kernels();

// The formulas, for floats and registers of floats.

/// L and l of a link. A link that is stretched at the start of the substep shrinks to its rest length, or by the
/// stretch of its path where that is less; a folded link may unfold. No correction compresses an unstretched link,
/// but ends that approach each other on their own may do so.
///
///   L = |X| max(rest / |x|, path / (path + stretch)),   l = min(L, |X|, |X + d|)
///
/// `across`: x, the vector between the particles that the ends are made from; X, d: between the ends.
template <class T>
struct LinkLimits {
  T min_length, max_length;

  LinkLimits(const Vec3<T>& X, const Vec3<T>& d, const T& ratio) {
    const Vec3<T> moved = X + d;
    const T now = sqrt(dot(X, X));
    max_length = now * ratio;
    min_length = min(max_length, min(now, sqrt(dot(moved, moved))));
  }
};

/// A link's ratio L / |X| without the path. `now`: |x|.
template <class T>
T link_ratio(const T& now, const T& rest_length) {
  return rest_length / max(now, rest_length * T(1e-6f));
}
/// The same along the path.
template <class T>
T path_ratio(const T& path_length, const T& stretch, const T& rest_length) {
  return path_length / max(path_length + stretch, rest_length * T(1e-6f));
}

/// Omega g C u / |u|. Coincident ends are not corrected.
template <class T>
Vec3<T> link_correction(const Vec3<T>& u, const T& min_length, const T& max_length, const T& gain) {
  const T now = sqrt(dot(u, u));
  const T C = now - max(min(now, max_length), min_length);
  return u * (C * gain / max(now, T(1e-18f)));
}

}  // namespace souple::kernels
