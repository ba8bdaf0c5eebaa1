#pragma once

#include "souple/simd/instruction_sets.h"
#include "souple/solver/kernels/motion.h"

// Included only by translation units that are compiled for one instruction set; every template here has the
// tag of that instruction set as parameter. A record's fourth float is never changed: it may hold the inverse
// mass.

namespace souple::kernels {

/// Four floats, repeated to fill a register.
template <class Isa>
inline typename Isa::Vector records_of(float x, float y, float z, float w) {
  const float record[4] = {x, y, z, w};
  float broadcast[Isa::lanes];
  for (int lane = 0; lane < Isa::lanes; ++lane) broadcast[lane] = record[lane % 4];
  return Isa::load(broadcast);
}

template <class Isa>
inline typename Isa::Mask three_of_four() {
  typename Isa::Mask mask{};
  for (int lane = 0; lane < Isa::lanes; ++lane) mask[lane] = lane % 4 == 3 ? 0 : -1;
  return mask;
}

/// Detects infinity, NaN, and values so large that a sum of three of them would be infinite.
template <class Isa>
class FiniteCheck {
 public:
  void add(typename Isa::Vector a) {
    const typename Isa::Vector large = a * 8.0f;
    sum_ = sum_ + (large - large);  // NOLINT(misc-redundant-expression): infinity minus infinity is NaN, and
                                    // so is any sum with it
  }
  bool all_finite() const {
    for (int lane = 0; lane < Isa::lanes; ++lane)
      if (sum_[lane] != 0.0f) return false;
    return true;
  }

 private:
  typename Isa::Vector sum_{};
};

/// A copy of the last particles, fewer than a register holds, in arrays that can be read and written as whole
/// registers.
template <class Isa>
class LastRecords {
 public:
  LastRecords(const MotionArrays& of, std::size_t count) : of_(of), floats_(4 * count) {
    copy(of.position, position_), copy(of.moving, moving_), copy(of.start, start_);
    copy(of.velocity, velocity_);
  }
  MotionArrays arrays() { return {position_, moving_, start_, velocity_}; }
  void copy_back() const {
    copy(position_, of_.position), copy(moving_, of_.moving), copy(start_, of_.start);
    copy(velocity_, of_.velocity);
  }

 private:
  void copy(const float* from, float* to) const {
    for (std::size_t k = 0; k < floats_; ++k) to[k] = from[k];
  }

  const MotionArrays of_;
  std::size_t floats_;
  float position_[Isa::lanes]{}, moving_[Isa::lanes]{}, start_[Isa::lanes]{}, velocity_[Isa::lanes]{};
};

/// Calls f for every register of particles [begin, end).
template <class Isa, class Function>
inline void for_each_register(const MotionArrays& a, std::size_t begin, std::size_t end, const Function& f) {
  constexpr std::size_t records = Isa::lanes / 4;
  const auto at = [&a](std::size_t i) {
    return MotionArrays{a.position + 4 * i, a.moving + 4 * i, a.start + 4 * i, a.velocity + 4 * i};
  };
  std::size_t i = begin;
  for (; i + records <= end; i += records) f(at(i));
  if (i == end) return;
  LastRecords<Isa> last(at(i), end - i);
  f(last.arrays());
  last.copy_back();
}

template <class Isa, bool in_air>
[[gnu::flatten]] bool predict(const MotionArrays& arrays, std::size_t begin, std::size_t end,
                              const float (&gravity)[3], float h) {
  using Vector = typename Isa::Vector;
  const Vector g = records_of<Isa>(gravity[0], gravity[1], gravity[2], 0);
  const typename Isa::Mask xyz = three_of_four<Isa>();
  FiniteCheck<Isa> finite_check;
  for_each_register<Isa>(arrays, begin, end, [&](const MotionArrays& at) {
    const Vector w = Isa::broadcast_last(Isa::load(at.position));
    const Vector p = Isa::load(at.moving), v = Isa::load(at.velocity);
    const typename Isa::Mask moves = (w != 0.0f) & xyz;
    Vector a = g;
    if constexpr (in_air) a = a + Isa::load(at.start) * w;
    const Vector v_star = moves ? v + a * h : v;
    finite_check.add(v_star);
    Isa::store(at.start, p);
    Isa::store(at.velocity, v_star);
    Isa::store(at.moving, moves ? p + v_star * h : p);
  });
  return finite_check.all_finite();
}

template <class Isa>
[[gnu::flatten]] bool finish(const MotionArrays& arrays, std::size_t begin, std::size_t end, float h) {
  using Vector = typename Isa::Vector;
  const typename Isa::Mask xyz = three_of_four<Isa>();
  FiniteCheck<Isa> finite_check;
  for_each_register<Isa>(arrays, begin, end, [&](const MotionArrays& at) {
    const Vector x = Isa::load(at.position), q = Isa::load(at.moving), v_star = Isa::load(at.velocity);
    const Vector base = Isa::broadcast_last(x) != 0.0f ? v_star : Vector{};
    const Vector v = base + (q - (Isa::load(at.start) + base * h)) / h;
    finite_check.add(xyz ? v : Vector{});
    Isa::store(at.velocity, xyz ? v : v_star);
    const Vector moved = x + q;
    finite_check.add(moved);
    Isa::store(at.position, xyz ? moved : x);
    Isa::store(at.moving, xyz ? q - (moved - x) : q);
  });
  return finite_check.all_finite();
}

template <class Isa>
const MotionKernels& motion_kernels() {
  static constexpr MotionKernels kernels{predict<Isa, false>, predict<Isa, true>, finish<Isa>};
  return kernels;
}

}  // namespace souple::kernels
