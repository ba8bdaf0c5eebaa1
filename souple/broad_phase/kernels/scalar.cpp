#include "souple/broad_phase/kernels/compile.h"
namespace souple::kernels {

template <>
struct Lanes<Scalar> {
  static constexpr std::uint32_t count = 1;
  using Vector = float;
  using Mask = std::uint32_t;
  static Vector broadcast(float a) { return a; }
  static Mask at_most(const float* a, Vector b) { return *a <= b ? 1 : 0; }
  static Mask at_least(const float* a, Vector b) { return *a >= b ? 1 : 0; }
  static Mask equal(const std::uint32_t* a, std::uint32_t b) { return *a == b ? 1 : 0; }
  static Mask has_none(const std::uint32_t* a, std::uint32_t b) { return (*a & b) == 0 ? 1 : 0; }
  static std::uint32_t bits(Mask mask) { return mask; }
};

template const PatchKernels& patch_kernels<Scalar>();

}  // namespace souple::kernels
