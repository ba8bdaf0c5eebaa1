#pragma once

#include "souple/math/vec3.h"

#include <cstddef>
#include <cstdint>

// Kernels over the links of a coarse level (multilevel/level_links.h), one register of links at a time. A link keeps
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

/// Input for the limits of the links.
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

/// Links between particles of the world, one array per number. Links are taken 16 at a time.
struct ParticleLinks {
  const std::uint32_t* a = nullptr;  ///< 4 times the end: the index of its record's first float
  const std::uint32_t* b = nullptr;
  const float* longest = nullptr;  ///< the length above which a link is stretched [m]
};

/// Sets bit k of stretched[i] where link 16 i + k is stretched; blocks [begin, end) of 16 links. The length is
/// that of (x_a - x_b) + (d_a - d_b).
using FindStretched = void (*)(const ParticleLinks&, const float* position, const float* moving,
                               std::uint16_t* stretched, std::size_t begin, std::size_t end);

/// Data of a link besides its ends, for the sweeps of stretched links.
struct StretchedMeasures {
  const float* longest = nullptr;       ///< the length it is shortened to [m]
  const float* compliance = nullptr;    ///< alpha [m/N]
  const float* inverse_mass = nullptr;  ///< w_a + w_b [1/kg]
  float shortest_part = 0;              ///< a link is lengthened to this part of `longest`
  float softest = 0;  ///< a link of this compliance per inverse mass or more has no correction [m kg/N]
  float sweeps_over_h2 = 0;  ///< number of sweeps n over h^2 [1/s^2]
};
/// Fills x, y, z, min_length, max_length and `gain` of links [begin, end), whole registers, from records x and d of the
/// world's particles.
///
///   L = longest,  l = min(|u|, shortest part L),  g = 1 / (w + n alpha / (r h^2)),  r = 1 - alpha / (softest w)
using MeasureStretched = void (*)(const LinkArrays&, const StretchedMeasures&, const float* position,
                                  const float* moving, float* gain, std::size_t begin, std::size_t end);

struct LinkKernels {
  MeasureLinks measure;
  SweepLinks sweep;
  FindStretched find_stretched;
  MeasureStretched measure_stretched;
};

/// Compiled in one translation unit per instruction set (compile_links.h).
template <class Isa>
const LinkKernels& link_kernels();

// The formulas, for floats and registers of floats.

/// L and l of a link. A link stretched at the start of the substep shrinks to its rest length, or by the stretch of its
/// path if that is less. A folded link may unfold. No correction compresses an unstretched link, but ends that approach
/// each other on their own may do so.
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

/// The gain g of a stretched link. Levels and the finest sweep supply the stiffness of soft links, so that these sweeps
/// add less the softer the link is.
template <class T>
T stretched_gain(const T& alpha, const T& inverse_mass, const T& softest, const T& sweeps_over_h2) {
  const T one(1), zero(0), rest = one - alpha / (softest * inverse_mass);
  const auto acts = rest > zero;
  return select(acts, one / (inverse_mass + sweeps_over_h2 * alpha / select(acts, rest, one)), zero);
}

/// A link's ratio L / |X| without the path. `now`: |x|.
template <class T>
T link_ratio(const T& now, const T& rest_length) {
  return rest_length / max(now, rest_length * T(1e-6f));
}
/// Ratio along the path.
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
