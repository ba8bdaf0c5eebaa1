#include "souple/solver/kernels/find_kernels.h"

#include "souple/simd/find_for.h"
#include "souple/solver/kernels/cells.h"
#include "souple/solver/kernels/links.h"
#include "souple/solver/kernels/motion.h"
#include "souple/solver/kernels/triangles.h"

namespace souple {
namespace {

/// find(tag of the set), or null for simd::Scalar: projection has scalar code of its own, which users' kinds need.
template <class Find>
auto find_packed(InstructionSet set, const Find& find) {
  return detail::find_for(set, [&]<class Isa>(std::type_identity<Isa> tag) {
    if constexpr (std::is_same_v<Isa, simd::Scalar>) {
      return decltype(find(tag)){};
    } else {
      return find(tag);
    }
  });
}

}  // namespace

template <class Kind>
const kernels::KindKernels* detail::find_compiled(InstructionSet set) {
  return find_packed(set,
                     []<class Isa>(std::type_identity<Isa>) { return &kernels::kind_kernels<Isa, Kind>(); });
}

// Every kind of EveryConstraint; one that is missing here fails to link.
template const kernels::KindKernels* detail::find_compiled<Distance>(InstructionSet set);
template const kernels::KindKernels* detail::find_compiled<DihedralBending>(InstructionSet set);
template const kernels::KindKernels* detail::find_compiled<IsometricBending>(InstructionSet set);
template const kernels::KindKernels* detail::find_compiled<TriangleMembrane>(InstructionSet set);
template const kernels::KindKernels* detail::find_compiled<TetVolume>(InstructionSet set);
template const kernels::KindKernels* detail::find_compiled<NeoHookean>(InstructionSet set);
template const kernels::KindKernels* detail::find_compiled<RopeBending>(InstructionSet set);
template const kernels::KindKernels* detail::find_compiled<ParticleContact>(InstructionSet set);
template const kernels::KindKernels* detail::find_compiled<Attachment>(InstructionSet set);
template const kernels::KindKernels* detail::find_compiled<BallJoint>(InstructionSet set);
template const kernels::KindKernels* detail::find_compiled<ConeLimit>(InstructionSet set);
template const kernels::KindKernels* detail::find_compiled<TwistLimit>(InstructionSet set);
template const kernels::KindKernels* detail::find_compiled<Tether>(InstructionSet set);

const kernels::LinkKernels* find_link_kernels(InstructionSet set) {
  return find_packed(set, []<class Isa>(std::type_identity<Isa>) { return &kernels::link_kernels<Isa>(); });
}

const kernels::CellKernels* find_cell_kernels(InstructionSet set) {
  return find_packed(set, []<class Isa>(std::type_identity<Isa>) { return &kernels::cell_kernels<Isa>(); });
}

const kernels::MotionKernels* find_motion_kernels(InstructionSet set) {
  return find_packed(set, []<class Isa>(std::type_identity<Isa>) { return &kernels::motion_kernels<Isa>(); });
}

const kernels::TriangleKernels* find_triangle_kernels(InstructionSet set) {
  return find_packed(set,
                     []<class Isa>(std::type_identity<Isa>) { return &kernels::triangle_kernels<Isa>(); });
}

}  // namespace souple
