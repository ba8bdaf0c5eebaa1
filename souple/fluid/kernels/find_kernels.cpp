#include "souple/fluid/kernels/find_kernels.h"

#include "souple/fluid/kernels/shapes.h"

namespace souple::kernels {

const NeighbourKernels& find_neighbour_kernels(InstructionSet set) {
  const NeighbourKernels* const packed = souple::detail::find_for(
      set, []<class Set>(std::type_identity<Set>) { return &neighbour_kernels<Set>(); });
  return packed ? *packed : neighbour_kernels<OneLane>();
}

namespace {

template <class Shape>
const DensityKernels& find_with_shape(InstructionSet set) {
  const DensityKernels* const packed = souple::detail::find_for(
      set, []<class Set>(std::type_identity<Set>) { return &density_kernels<Set, Shape>(); });
  return packed ? *packed : density_kernels<PlainLanes, Shape>();
}

}  // namespace

const DensityKernels& find_density_kernels(InstructionSet set, SmoothingShape shape) {
  switch (shape) {
    case SmoothingShape::poly6_spiky:
      return find_with_shape<Poly6Spiky>(set);
    case SmoothingShape::cubic_spline:
      return find_with_shape<CubicSpline>(set);
    case SmoothingShape::wendland:
      break;
  }
  return find_with_shape<Wendland>(set);
}

}  // namespace souple::kernels
