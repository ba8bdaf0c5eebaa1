#pragma once

#include "souple/constraints/constraint.h"

// How a constraint moves its particles, written once for all of them.
//
//   PBD   (Müller et al. 2007, eq. 8 and section 3.3):
//           dlambda = -k' C / sum_i w_i |grad_i C|^2,   k' = 1 - (1 - k)^(1/n)
//   XPBD  (Macklin et al. 2016, eqs. 18 and 26):
//           dlambda = (-C - alpha~ lambda) / (sum_i w_i |grad_i C|^2 + alpha~),   alpha~ = alpha / h^2
//   both:   dx_i = w_i grad_i C dlambda
//
// Several coupled rows solve (J W J^T + alpha~) dlambda = rhs at once.
//
// A sweep of Gauss-Seidel from lambda = 0 is too soft. With J W J^T = L + D + L^T (D: the terms of the
// constraints themselves) it finds -C(x*) = (L + D + alpha~) lambda and leaves C(x) = -(alpha~ - L^T) lambda. For a
// smooth stress J^T lambda vanishes between the constraints, so lambda^T L^T lambda = -1/2 lambda^T D lambda. In the
// mean the sweep acts as if the compliance were alpha~ + D/2. Therefore a sweep without stored multipliers subtracts
// that, as far as alpha~ reaches:
//
//   dlambda = -C / (D + alpha~ - c),   c = min(phi D / 2, alpha~)       (SetProjector::find_shared)
//
// phi is the fraction of D of particles that the constraint shares with others of its kind: a spring alone is
// exact in one sweep. A stress that varies from constraint to constraint is as stable as before, because
// alpha~ - c >= 0.
//
// Kelvin-Voigt damping, stress = alpha^-1 (C + tau dC/dt), acts on the velocities that the solver leaves:
//
//           dlambda = -gamma grad C . v / (gamma sum_i w_i |grad_i C|^2 + alpha~),   gamma = tau / h
//           dv_i = w_i grad_i C dlambda
//
// That is the implicit Euler step of the damper alone. Particles at rest, and rigid motions, have grad C . v = 0 and
// are not changed. Rejected: XPBD's damping within the projection (eq. 26). There gamma multiplies the denominator, so
// that one projection corrects less of C. One iteration per substep then leaves a damped material softer: a cotton
// cloth with tau = 5 ms hung 10 % too long instead of 2.7 %.

namespace souple {

/// Input of one projection.
template <class Kind, class T>
struct ProjectionInput {
  Vec3<T> x[Kind::arity];          ///< positions relative to the constraint's origin [m]
  T inverse_mass[Kind::arity];     ///< 1/kg
  T alpha[compliance_size<Kind>];  ///< alpha~ = alpha / h^2, packed lower triangle; 0 in PBD mode
  T lambda[rows_of<Kind>];         ///< stored multipliers, 0 where none are stored
  T scale{1};                      ///< PBD: k'; otherwise 1
  T half_shared{0};                ///< phi / 2; only without stored multipliers

  ProjectionInput() {
    for (T& a : alpha) a = T(0);
    for (T& l : lambda) l = T(0);
  }
};

/// Solves the symmetric system A y = b in place (A packed lower, b becomes y) by LDL^T. A row whose pivot
/// vanishes relative to its diagonal is linearly dependent (or has no gradient) and gets y = 0.
template <int n, class T>
void solve_symmetric(T (&A)[n * (n + 1) / 2], T (&b)[n]) {
  const auto at = [](int row, int column) { return row * (row + 1) / 2 + column; };
  T inverse_pivot[n];
  for (int j = 0; j < n; ++j) {
    const T diagonal = A[at(j, j)];
    T pivot = diagonal;
    for (int k = 0; k < j; ++k) pivot -= A[at(j, k)] * A[at(j, k)] * A[at(k, k)];
    const auto usable = pivot > diagonal * T(1e-6f);
    A[at(j, j)] = select(usable, pivot, T(0));
    inverse_pivot[j] = select(usable, T(1) / select(usable, pivot, T(1)), T(0));
    for (int i = j + 1; i < n; ++i) {
      T l = A[at(i, j)];
      for (int k = 0; k < j; ++k) l -= A[at(i, k)] * A[at(j, k)] * A[at(k, k)];
      A[at(i, j)] = l * inverse_pivot[j];
    }
  }
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < i; ++k) b[i] -= A[at(i, k)] * b[k];
  for (int i = 0; i < n; ++i) b[i] = b[i] * inverse_pivot[i];
  for (int i = n - 1; i >= 0; --i)
    for (int k = i + 1; k < n; ++k) b[i] -= A[at(k, i)] * b[k];
}

/// Scales a correction and its multipliers down to the longest correction that the kind allows per
/// projection. One factor for all particles keeps momentum. A correction too large for a float becomes zero:
/// its gradient vanished.
template <class Kind, class T>
void limit_correction(const typename Kind::template Params<T>& params, Vec3<T> (&dx)[Kind::arity],
                      T (&dlambda)[rows_of<Kind>]) {
  const T limit = Kind::template max_correction<T>(params);
  T farthest{0};
  for (int i = 0; i < Kind::arity; ++i) farthest = max(farthest, dot(dx[i], dx[i]));
  const auto too_far = farthest > limit * limit;
  const T factor = select(too_far, limit / sqrt(select(too_far, farthest, T(1))), T(1));
  const auto bounded = farthest < T(1e38f);
  for (int i = 0; i < Kind::arity; ++i)
    for (int axis = 0; axis < 3; ++axis) dx[i][axis] = select(bounded, dx[i][axis] * factor, T(0));
  for (int r = 0; r < rows_of<Kind>; ++r) dlambda[r] = select(bounded, dlambda[r] * factor, T(0));
}

/// Factor omega of corrections that follow those of levels of tets.
inline constexpr float level_relaxation = 0.5f;

/// The terms of dlambda that are computed; omitted terms cost nothing.
enum class Terms {
  plain,   ///< no stored multipliers: lambda = 0
  general  ///< all
};

/// Factor of D that replaces D + alpha~ by D + alpha~ - c: 1 - c/D. With several rows one factor for all of
/// them, so that alpha~ - c stays positive semidefinite where D is diagonal.
template <int rows, class T>
T kept_fraction(const T (&D)[rows * (rows + 1) / 2], const T (&alpha)[rows * (rows + 1) / 2],
                const T& half_shared) {
  T fraction = half_shared;
  for (int r = 0; r < rows; ++r) {
    T own = alpha[r * (r + 3) / 2];
    for (int s = 0; s < rows; ++s)
      if (const T& a = alpha[r > s ? r * (r + 1) / 2 + s : s * (s + 1) / 2 + r]; s != r) own -= max(a, -a);
    const T d = D[r * (r + 3) / 2];
    const auto usable = d > T(0);
    fraction = min(fraction, select(usable, own / select(usable, d, T(1)), fraction));
  }
  return T(1) - max(fraction, T(0));
}

template <class Kind, class T>
T gradient_product(const Vec3<T>& a, const Vec3<T>& b) {
  return has_unit_gradients<Kind> ? T(1) : dot(a, b);
}

/// One projection: fills dx and `dlambda`, both scaled.
template <class Kind, class T, Terms terms = Terms::general>
inline void project_constraint(const ProjectionInput<Kind, T>& in,
                               const typename Kind::template Params<T>& params, Vec3<T> (&dx)[Kind::arity],
                               T (&dlambda)[rows_of<Kind>]) {
  constexpr int rows = rows_of<Kind>;
  constexpr int arity = Kind::arity;
  T C[rows];
  Vec3<T> gradient[rows][arity];
  evaluate_rows<Kind, T>(in.x, params, C, gradient);

  T A[rows * (rows + 1) / 2];
  for (int r = 0, k = 0; r < rows; ++r) {
    T rhs = -C[r];
    if constexpr (terms == Terms::general)
      for (int s = 0; s < rows; ++s)
        rhs -= in.alpha[r >= s ? r * (r + 1) / 2 + s : s * (s + 1) / 2 + r] * in.lambda[s];
    dlambda[r] = rhs;
    for (int s = 0; s <= r; ++s, ++k) {
      T sum = in.inverse_mass[0] * gradient_product<Kind>(gradient[r][0], gradient[s][0]);
      for (int i = 1; i < arity; ++i)
        sum += in.inverse_mass[i] * gradient_product<Kind>(gradient[r][i], gradient[s][i]);
      A[k] = sum;
    }
  }
  T kept = T(1);
  if constexpr (terms == Terms::plain && Kind::sense == Sense::equality)
    kept = kept_fraction<rows>(A, in.alpha, in.half_shared);
  for (int k = 0; k < rows * (rows + 1) / 2; ++k) A[k] = A[k] * kept + in.alpha[k];
  if constexpr (rows == 1) {
    const auto usable = A[0] > T(0);
    dlambda[0] = select(usable, dlambda[0] / A[0], T(0));
    // A violated inequality pushes, never pulls: the multiplier stays >= 0.
    if constexpr (Kind::sense == Sense::non_negative) dlambda[0] = max(dlambda[0], -in.lambda[0]);
  } else {
    solve_symmetric<rows>(A, dlambda);
  }
  for (int r = 0; r < rows; ++r) dlambda[r] = dlambda[r] * in.scale;
  for (int i = 0; i < arity; ++i) {
    Vec3<T> sum = gradient[0][i] * dlambda[0];
    for (int r = 1; r < rows; ++r) sum += gradient[r][i] * dlambda[r];
    dx[i] = sum * in.inverse_mass[i];
  }
  static_assert(
      !requires { Kind::template reach<T>(params); }, "rename the constraint's reach: max_correction");
  if constexpr (requires { Kind::template max_correction<T>(params); })
    limit_correction<Kind, T>(params, dx, dlambda);
}

/// Elastic forces of one constraint, times h^2, except for the part that sweeps supply (docs/notes/solvers.md, "Tet
/// levels"). A sweep relaxed by omega acts on a smooth stress as a spring of compliance alpha~/omega + b D beside
/// the others, b = `sweep_share`:
///
///   f_i = -grad_i C (1/alpha~ - 1/(alpha~/omega + b D)) C
template <class Kind, class T>
inline void elastic_forces(const ProjectionInput<Kind, T>& in,
                           const typename Kind::template Params<T>& params, const T& sweep_share,
                           Vec3<T> (&f)[Kind::arity]) {
  constexpr int rows = rows_of<Kind>;
  T C[rows];
  Vec3<T> gradient[rows][Kind::arity];
  evaluate_rows<Kind, T>(in.x, params, C, gradient);
  for (int i = 0; i < Kind::arity; ++i) f[i] = {T(0), T(0), T(0)};
  for (int r = 0; r < rows; ++r) {
    T D = in.inverse_mass[0] * dot(gradient[r][0], gradient[r][0]);
    for (int i = 1; i < Kind::arity; ++i) D += in.inverse_mass[i] * dot(gradient[r][i], gradient[r][i]);
    const T alpha = in.alpha[r * (r + 3) / 2];
    const T supplied = alpha * T(1 / level_relaxation) + sweep_share * D;
    const T lambda = C[r] * ((alpha - supplied) / (alpha * supplied)) * in.scale;
    for (int i = 0; i < Kind::arity; ++i) f[i] += gradient[r][i] * lambda;
  }
}

/// Input of the damping of one constraint.
template <class Kind, class T>
struct DampingInput {
  ProjectionInput<Kind, T> constraint;  ///< after the substep; its multipliers and scale are not read
  Vec3<T> velocity[Kind::arity];        ///< m/s
  T gamma{0};                           ///< tau / h
};

/// The damping of one constraint: fills dv. A satisfied inequality is not damped.
template <class Kind, class T>
inline void damp_constraint(const DampingInput<Kind, T>& in, const typename Kind::template Params<T>& params,
                            Vec3<T> (&dv)[Kind::arity]) {
  constexpr int rows = rows_of<Kind>;
  constexpr int arity = Kind::arity;
  T C[rows], dlambda[rows], A[rows * (rows + 1) / 2];
  Vec3<T> gradient[rows][arity];
  evaluate_rows<Kind, T>(in.constraint.x, params, C, gradient);
  const T* w = in.constraint.inverse_mass;
  for (int r = 0, k = 0; r < rows; ++r) {
    T rate = dot(gradient[r][0], in.velocity[0]);
    for (int i = 1; i < arity; ++i) rate += dot(gradient[r][i], in.velocity[i]);
    dlambda[r] = -in.gamma * rate;
    for (int s = 0; s <= r; ++s, ++k) {
      T sum = w[0] * gradient_product<Kind>(gradient[r][0], gradient[s][0]);
      for (int i = 1; i < arity; ++i) sum += w[i] * gradient_product<Kind>(gradient[r][i], gradient[s][i]);
      A[k] = in.gamma * sum + in.constraint.alpha[k];
    }
  }
  if constexpr (rows == 1) {
    const auto usable = A[0] > T(0);
    dlambda[0] = select(usable, dlambda[0] / A[0], T(0));
    if constexpr (Kind::sense == Sense::non_negative) dlambda[0] = select(C[0] < T(0), dlambda[0], T(0));
  } else {
    solve_symmetric<rows>(A, dlambda);
  }
  for (int i = 0; i < arity; ++i) {
    Vec3<T> sum = gradient[0][i] * dlambda[0];
    for (int r = 1; r < rows; ++r) sum += gradient[r][i] * dlambda[r];
    dv[i] = sum * w[i];
  }
}

}  // namespace souple
