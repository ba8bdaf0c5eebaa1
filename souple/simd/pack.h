#pragma once

#include "souple/math/scalar.h"
#include "souple/simd/instruction_sets.h"

#include <type_traits>

namespace souple::simd {

/// As many floats as a register of the instruction set has lanes, for use as the scalar T of constraint code.
/// Every operation rounds each lane as float does, so lanes have the same bits as floats.
template <class Isa>
struct Pack {
  using Vector = typename Isa::Vector;
  static constexpr int lanes = Isa::lanes;

  /// Result of a comparison, lane by lane, for `select`.
  struct Mask {
    typename Isa::Mask lanes;
    friend Mask operator&&(Mask a, Mask b) { return {a.lanes & b.lanes}; }
    friend Mask operator||(Mask a, Mask b) { return {a.lanes | b.lanes}; }
  };

  Vector v;

  // Leaves the lanes uninitialized, also for {}: arrays of packs that are filled later cost nothing.
  Pack() {}  // NOLINT(modernize-use-equals-default)
  /// One number in all lanes. Implicit, so that plain numbers mix with packs as they do with floats.
  Pack(float a) : v(Isa::broadcast(a)) {}  // NOLINT(google-explicit-constructor)
  explicit Pack(double a) : Pack(static_cast<float>(a)) {}
  explicit Pack(int a) : Pack(static_cast<float>(a)) {}
  explicit Pack(Vector a) requires(!std::is_same_v<Vector, float>) : v(a) {}

  static Pack load(const float* p) { return Pack(Isa::load(p)); }
  void store(float* p) const { Isa::store(p, v); }

  Pack& operator+=(Pack b) { return *this = *this + b; }
  Pack& operator-=(Pack b) { return *this = *this - b; }
  Pack& operator*=(Pack b) { return *this = *this * b; }
  friend Pack operator+(Pack a, Pack b) { return Pack(a.v + b.v); }
  friend Pack operator-(Pack a, Pack b) { return Pack(a.v - b.v); }
  friend Pack operator*(Pack a, Pack b) { return Pack(a.v * b.v); }
  friend Pack operator/(Pack a, Pack b) { return Pack(a.v / b.v); }
  friend Pack operator-(Pack a) { return Pack(-a.v); }
  friend Mask operator<(Pack a, Pack b) { return {a.v < b.v}; }
  friend Mask operator>(Pack a, Pack b) { return {a.v > b.v}; }
  friend Mask operator<=(Pack a, Pack b) { return {a.v <= b.v}; }
  friend Mask operator>=(Pack a, Pack b) { return {a.v >= b.v}; }

  friend bool any_lane(Mask mask) { return Isa::any(mask.lanes); }
  friend Pack select(Mask mask, Pack a, Pack b) { return Pack(mask.lanes ? a.v : b.v); }
  // Where neither operand is smaller, the operand that std::min and std::max return.
  friend Pack min(Pack a, Pack b) { return Pack(Isa::min(b.v, a.v)); }
  friend Pack max(Pack a, Pack b) { return Pack(Isa::max(b.v, a.v)); }
  friend Pack abs(Pack a) {
    if constexpr (lanes == 1) {
      return Pack(abs(a.v));  // the conversion below would convert the value
    } else {
      return Pack((Vector)((typename Isa::Mask)a.v & 0x7fffffff));
    }
  }
  friend Pack sqrt(Pack a) { return Pack(Isa::sqrt(a.v)); }
  friend Pack atan2(Pack y, Pack x) { return arctangent(y, x); }
};

/// Converts four registers of records (see instruction_sets.h) to their four components, and back: a 4 x 4
/// transpose of every 16 bytes.
template <class Isa>
[[gnu::always_inline]] inline void transpose(typename Isa::Vector (&r)[4]) {
  const auto t0 = Isa::unpack_low(r[0], r[1]), t1 = Isa::unpack_high(r[0], r[1]);
  const auto t2 = Isa::unpack_low(r[2], r[3]), t3 = Isa::unpack_high(r[2], r[3]);
  r[0] = Isa::pair_low(t0, t2);
  r[1] = Isa::pair_high(t0, t2);
  r[2] = Isa::pair_low(t1, t3);
  r[3] = Isa::pair_high(t1, t3);
}

}  // namespace souple::simd
