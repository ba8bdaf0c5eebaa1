#include "souple/solver/set_projector.h"

#include "souple/math/disjoint_sets.h"

#include <atomic>

#include <fmt/core.h>

namespace souple {

void detail::throw_missing_particle(std::string_view kind, std::size_t constraint, std::uint32_t particle,
                                    std::size_t particle_count) {
  throw Error(fmt::format("{} {} names particle {}, but there are {} particles", kind, constraint, particle,
                          particle_count));
}

std::vector<std::uint32_t> detail::lowest_connected(std::span<const std::uint32_t> indices, std::size_t arity,
                                                    std::size_t particle_count) {
  DisjointSets connected(particle_count);
  for (std::size_t k = 0; k < indices.size(); ++k) connected.join(indices[k - k % arity], indices[k]);
  std::vector<std::uint32_t> result;
  for (std::size_t k = 0; k < indices.size(); k += arity) result.push_back(connected.root(indices[k]));
  return result;
}

std::uint64_t detail::next_revision() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

template class SetProjector<Distance>;
template class SetProjector<DihedralBending>;
template class SetProjector<IsometricBending>;
template class SetProjector<TriangleMembrane>;
template class SetProjector<TetVolume>;
template class SetProjector<NeoHookean>;
template class SetProjector<RopeBending>;

}  // namespace souple
