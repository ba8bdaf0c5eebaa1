#include "souple/fluid/kernels/find_kernels.h"

#include "souple/fluid/kernels/shapes.h"
#include "souple/simd/find_for.h"

namespace souple::kernels {

const NeighborKernels& find_neighbor_kernels(InstructionSet set) {
  return *souple::detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &neighbor_kernels<Isa>(); });
}

namespace {

/// find(tag of the shape)
template <class Find>
auto find_for_shape(SmoothingShape shape, const Find& find) {
  switch (shape) {
    case SmoothingShape::poly6_spiky:
      return find(std::type_identity<Poly6Spiky>{});
    case SmoothingShape::cubic_spline:
      return find(std::type_identity<CubicSpline>{});
    case SmoothingShape::wendland:
    case SmoothingShape::wide_wendland:
      break;
  }
  return find(std::type_identity<Wendland>{});
}

}  // namespace

const DensityKernels& find_density_kernels(InstructionSet set, SmoothingShape shape) {
  return *find_for_shape(shape, [&]<class Shape>(std::type_identity<Shape>) {
    return souple::detail::find_for(
        set, []<class Isa>(std::type_identity<Isa>) { return &density_kernels<Isa, Shape>(); });
  });
}

const VelocityKernels& find_velocity_kernels(InstructionSet set, SmoothingShape shape) {
  return *find_for_shape(shape, [&]<class Shape>(std::type_identity<Shape>) {
    return souple::detail::find_for(
        set, []<class Isa>(std::type_identity<Isa>) { return &velocity_kernels<Isa, Shape>(); });
  });
}

}  // namespace souple::kernels
