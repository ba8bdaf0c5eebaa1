#pragma once

#include "souple/state/particles.h"

#include <cstddef>
#include <span>
#include <vector>

namespace souple {

/// Chebyshev semi-iterative acceleration of any iteration x_k -> x^ (Wang 2015, "A Chebyshev semi-iterative
/// approach for accelerating projective and position-based dynamics", eqs. 9, 10 and 18):
///
///   x_{k+1} = omega_{k+1} (gamma (x^ - x_k) + x_k - x_{k-1}) + x_{k-1}
///   omega_{k+1} = 1 for k < S,   2 / (2 - rho^2) for k = S,   4 / (4 - rho^2 omega_k) beyond
///
/// rho is the spectral radius that the iteration is assumed to have, gamma = 0.9 keeps a nonlinear one from
/// overshooting and S = 2 lets the first iterations take out what is rough (Wang has 10: he iterates 100
/// times). Multipliers are extrapolated with the positions, so that compliance stays what it is.
class Chebyshev {
 public:
  /// Iterations before the first extrapolation.
  static constexpr int delay = 2;
  /// The last two iterates of one array.
  template <class T>
  struct History {
    std::vector<T> last, before;

    void begin(std::span<const T> x) {
      last.assign(x.begin(), x.end());
      before.assign(x.begin(), x.end());
    }
  };

  /// rho in [0, 1); 0: no acceleration.
  explicit Chebyshev(float rho) : rho_squared_(rho * rho) {}

  /// Whether `iterations` are enough to gain anything.
  bool helps(int iterations) const { return rho_squared_ > 0 && iterations > delay; }
  void begin() { iteration_ = 0, omega_ = 1; }
  /// After each iteration, before its arrays are accelerated.
  void advance() {
    if (iteration_ == delay) omega_ = 2 / (2 - rho_squared_);
    if (iteration_ > delay) omega_ = 4 / (4 - rho_squared_ * omega_);
    ++iteration_;
  }
  /// x holds x^ and becomes x_{k+1}; what does not change keeps its bits.
  template <class T>
  void accelerate(std::span<T> x, History<T>& history) const {
    if (omega_ > 1)
      for (std::size_t i = 0; i < x.size(); ++i) extrapolate(x[i], history.last[i], history.before[i]);
    history.before.swap(history.last);
    history.last.assign(x.begin(), x.end());
  }

 private:
  static constexpr float gamma = 0.9f;

  template <class T>
  void extrapolate(T& x, T last, T before) const {
    x = T(omega_) * (T(gamma) * (x - last) + (last - before)) + before;
  }
  void extrapolate(Vec4f& x, const Vec4f& last, const Vec4f& before) const {
    extrapolate(x.x, last.x, before.x);
    extrapolate(x.y, last.y, before.y);
    extrapolate(x.z, last.z, before.z);
  }

  float rho_squared_;
  float omega_ = 1;
  int iteration_ = 0;
};

}  // namespace souple
