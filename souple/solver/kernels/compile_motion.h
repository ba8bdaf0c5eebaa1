#pragma once

#include "souple/math/simd/instruction_sets.h"
#include "souple/solver/kernels/motion.h"

// Included by the translation units that are compiled for one instruction set, and by nothing else; every
// template here carries the set's tag. A record's fourth float is never written: it may hold the inverse
// mass.

namespace souple::kernels {

/// Four floats, repeated over a register.
template <class Set>
inline typename Set::Vector records_of(float x, float y, float z, float w) {
  const float record[4] = {x, y, z, w};
  float spread[Set::lanes];
  for (int lane = 0; lane < Set::lanes; ++lane) spread[lane] = record[lane % 4];
  return Set::load(spread);
}

template <class Set>
inline typename Set::Mask three_of_four() {
  typename Set::Mask mask{};
  for (int lane = 0; lane < Set::lanes; ++lane) mask[lane] = lane % 4 == 3 ? 0 : -1;
  return mask;
}

/// Says at the end whether a number came by that is infinite, no number, or so large that the sum of three
/// is.
template <class Set>
class Watch {
 public:
  void add(typename Set::Vector a) {
    const typename Set::Vector large = a * 8.0f;
    sum_ = sum_ + (large - large);  // NOLINT(misc-redundant-expression): infinity less infinity is no number,
                                    // nor is any sum with it
  }
  bool is_clean() const {
    for (int lane = 0; lane < Set::lanes; ++lane)
      if (sum_[lane] != 0.0f) return false;
    return true;
  }

 private:
  typename Set::Vector sum_{};
};

/// The last particles, fewer than a register holds, copied to where a whole register may be read and written.
template <class Set>
class LastRecords {
 public:
  LastRecords(const MotionArrays& of, std::size_t count) : of_(of), floats_(4 * count) {
    copy(of.position, position_), copy(of.moving, moving_), copy(of.start, start_);
    copy(of.velocity, velocity_), copy(of.force, force_);
  }
  MotionArrays arrays() {
    return {position_, is_plain() ? position_ : moving_, start_, velocity_, of_.force ? force_ : nullptr};
  }
  void copy_back() const {
    copy(position_, of_.position), copy(start_, of_.start), copy(velocity_, of_.velocity);
    if (!is_plain()) copy(moving_, of_.moving);
  }

 private:
  bool is_plain() const { return of_.moving == of_.position; }
  void copy(const float* from, float* to) const {
    for (std::size_t k = 0; from && k < floats_; ++k) to[k] = from[k];
  }

  const MotionArrays of_;
  std::size_t floats_;
  float position_[Set::lanes]{}, moving_[Set::lanes]{}, start_[Set::lanes]{}, velocity_[Set::lanes]{},
      force_[Set::lanes]{};
};

/// Calls f on every register's worth of particles [begin, end).
template <class Set, class Function>
inline void for_each_register(const MotionArrays& a, std::size_t begin, std::size_t end, const Function& f) {
  constexpr std::size_t records = Set::lanes / 4;
  const auto at = [&a](std::size_t i) {
    return MotionArrays{a.position + 4 * i, a.moving + 4 * i, a.start + 4 * i, a.velocity + 4 * i,
                        a.force ? a.force + 4 * i : nullptr};
  };
  std::size_t i = begin;
  for (; i + records <= end; i += records) f(at(i));
  if (i == end) return;
  LastRecords<Set> last(at(i), end - i);
  f(last.arrays());
  last.copy_back();
}

template <class Set, bool windy>
[[gnu::flatten]] bool predict(const MotionArrays& arrays, std::size_t begin, std::size_t end,
                              const float (&gravity)[3], float h) {
  using Vector = typename Set::Vector;
  const Vector g = records_of<Set>(gravity[0], gravity[1], gravity[2], 0);
  const typename Set::Mask xyz = three_of_four<Set>();
  Watch<Set> watch;
  for_each_register<Set>(arrays, begin, end, [&](const MotionArrays& at) {
    const Vector w = Set::spread_last(Set::load(at.position));
    const Vector p = Set::load(at.moving), v = Set::load(at.velocity);
    const typename Set::Mask moves = (w != 0.0f) & xyz;
    Vector a = g;
    if constexpr (windy) a = a + Set::load(at.force) * w;
    const Vector v_star = moves ? v + a * h : v;
    watch.add(v_star);
    Set::store(at.start, p);
    Set::store(at.velocity, v_star);
    Set::store(at.moving, moves ? p + v_star * h : p);
  });
  return watch.is_clean();
}

template <class Set>
bool predict_any(const MotionArrays& arrays, std::size_t begin, std::size_t end, const float (&gravity)[3],
                 float h) {
  return (arrays.force ? predict<Set, true> : predict<Set, false>)(arrays, begin, end, gravity, h);
}

template <class Set, bool displacement>
[[gnu::flatten]] bool finish(const MotionArrays& arrays, std::size_t begin, std::size_t end, float h) {
  using Vector = typename Set::Vector;
  const typename Set::Mask xyz = three_of_four<Set>();
  Watch<Set> watch;
  for_each_register<Set>(arrays, begin, end, [&](const MotionArrays& at) {
    const Vector x = Set::load(at.position), q = Set::load(at.moving), v_star = Set::load(at.velocity);
    const Vector base = Set::spread_last(x) != 0.0f ? v_star : Vector{};
    const Vector v = base + (q - (Set::load(at.start) + base * h)) / h;
    watch.add(xyz ? v : Vector{});
    Set::store(at.velocity, xyz ? v : v_star);
    if constexpr (displacement) {
      const Vector moved = x + q;
      watch.add(moved);
      Set::store(at.position, xyz ? moved : x);
      Set::store(at.moving, xyz ? q - (moved - x) : q);
    }
  });
  return watch.is_clean();
}

template <class Set>
const MotionKernels& motion_kernels() {
  static constexpr MotionKernels kernels{predict_any<Set>, {finish<Set, false>, finish<Set, true>}};
  return kernels;
}

}  // namespace souple::kernels
