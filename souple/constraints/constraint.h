#pragma once

#include "souple/math/mat3.h"

#include <type_traits>

// The interface of a constraint kind. A constraint file states only C and its gradient, for any scalar T:
//
//   struct Distance {
//     static constexpr const char* name = "distance";
//     static constexpr int arity = 2;                       // particles
//     static constexpr Sense sense = Sense::equality;
//     template <class T> struct Params { T rest_length; };  // members of type T only:
//                                                           // stored as plain numbers
//     template <class T>
//     static T evaluate(const Vec3<T> (&x)[2], const Params<T>& p, Vec3<T> (&gradient)[2]);
//   };
//
// A constraint of several coupled strains declares `rows` > 1 and fills arrays; its compliance is a symmetric
// rows x rows matrix:
//
//   static constexpr int rows = 3;
//   template <class T>
//   static void evaluate(const Vec3<T> (&x)[arity], const Params<T>& p, T (&C)[rows],
//                        Vec3<T> (&gradient)[rows][arity]);
//
// A constraint on absolute positions (an attachment) also declares its origin. Its positions are relative to that
// point, so that no digits are lost far from the world's origin. All other constraints are invariant to translation and
// get positions relative to their first particle:
//
//   template <class T> static Vec3<T> origin(const Params<T>& p);
//
// The linearization of a constraint may be valid only over a part of its size: a crushed tet has almost no gradient.
// Such a constraint may declare the longest correction [m] of one projection. Longer corrections are scaled down:
//
//   template <class T> static T max_correction(const Params<T>& p);
//
// A constraint of one row whose gradients are unit vectors, or all zero, may declare it; their lengths are
// then not computed:
//
//   static constexpr bool unit_gradients = true;
//
// A constraint that measures stretch may give it, from C, for reports and pictures: (l - l0) / l0, positive for
// extension.
//
//   static float strain(const Params<float>& p, const float (&C)[rows]);
//
// A constraint whose material is often too stiff for one sweep may state its softness, so that a solver sweeps it more
// often. The softness is that of its stiffest row at rest, from compliance and inverse masses: sum_k w_k |gradient_k|^2
// / (2 alpha) [1/s^2]:
//
//   static float softness(const Params<float>& p, const std::array<float, compliance_size>& alpha,
//                         const float (&w)[arity]);
//
// A bending constraint states the signed lengths of its gradients along the normal of a flat sheet. To first order, C =
// |sum_k flat_gradient_k x_k| (multilevel/stiff_bending.h):
//
//   static std::array<float, arity> flat_gradient(const Params<float>& p);
//
// Only where it is flat at rest is this so; a kind that may be bent there also states
//
//   static bool is_flat(const Params<float>& p);
//
// A constraint of two particles with C = |x0 - x1| - l may state l. It is then solved as Distance is: cloth of it gets
// levels, ropes of it are solved exactly (multilevel/):
//
//   static float rest_length(const Params<float>& p);
//
// One that resists stretch otherwise may name the links of which it consists, for the levels alone:
//
//   static std::array<KindLink, n> links(const Params<float>& p, const std::array<float, compliance_size>& alpha);
//
// A constraint with C = |x0 - t| may state t:
//
//   static Vec3f target(const Params<float>& p);
//
// Where the gradient is undefined (0/0), evaluate returns C = 0 or a zero gradient, never a NaN. Thresholds
// are relative: a constraint must behave alike at millimeters and at hundreds of meters.

namespace souple {

/// equality: C = 0. non_negative: satisfied while C >= 0.
enum class Sense { equality, non_negative };

/// A link of a constraint: see `links` above.
struct KindLink {
  int a, b;      ///< particles of the constraint
  float length;  ///< at rest [m]
  float energy;  ///< 2 E / strain^2 [J]
};

namespace detail {
template <class Kind, class = void>
struct RowsOf : std::integral_constant<int, 1> {};
template <class Kind>
struct RowsOf<Kind, std::void_t<decltype(Kind::rows)>> : std::integral_constant<int, Kind::rows> {};

template <class Kind, class = void>
struct HasOrigin : std::false_type {};
template <class Kind>
struct HasOrigin<Kind,
                 std::void_t<decltype(Kind::template origin<float>(typename Kind::template Params<float>{}))>>
    : std::true_type {};
template <class Kind, class = void>
struct HasUnitGradients : std::false_type {};
template <class Kind>
struct HasUnitGradients<Kind, std::void_t<decltype(Kind::unit_gradients)>>
    : std::bool_constant<Kind::unit_gradients> {};
}  // namespace detail

/// Number of scalars C that a constraint of this kind couples.
template <class Kind>
inline constexpr int rows_of = detail::RowsOf<Kind>::value;

/// Entries of the packed lower triangle of a rows x rows symmetric matrix, row by row: (0,0) (1,0) (1,1)
/// (2,0) ...
template <class Kind>
inline constexpr int compliance_size = rows_of<Kind>*(rows_of<Kind> + 1) / 2;

template <class Kind>
inline constexpr bool has_origin = detail::HasOrigin<Kind>::value;

template <class Kind>
inline constexpr bool has_unit_gradients = detail::HasUnitGradients<Kind>::value;

/// Calls either form of evaluate; fills C[rows] and gradient[rows][arity].
template <class Kind, class T>
void evaluate_rows(const Vec3<T> (&x)[Kind::arity], const typename Kind::template Params<T>& params,
                   T (&C)[rows_of<Kind>], Vec3<T> (&gradient)[rows_of<Kind>][Kind::arity]) {
  if constexpr (rows_of<Kind> == 1) {
    C[0] = Kind::evaluate(x, params, gradient[0]);
  } else {
    Kind::evaluate(x, params, C, gradient);
  }
}

}  // namespace souple
