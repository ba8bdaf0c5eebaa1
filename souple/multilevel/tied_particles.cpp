#include "souple/multilevel/tied_particles.h"

#include "souple/assert.h"
#include "souple/geometry/adjacency.h"
#include "souple/math/sentinels.h"
#include "souple/solver/facets.h"

#include <algorithm>

namespace souple {

TiedParticles::TiedParticles(std::span<Projector* const> projectors, const ParticleView& particles) {
  std::vector<Edge> ties;
  for (Projector* projector : projectors) {
    const Facets facets = projector->facets();
    if (facets.attachments == nullptr && facets.distances == nullptr) continue;
    const StructureFacet& set = facets.attachments != nullptr ? *facets.attachments : *facets.distances;
    for (std::size_t i = 0; i < projector->size(); ++i) {
      const StructureFacet::Pull pull = set.pull(i);
      if (pull.compliance != 0) continue;
      if (facets.attachments != nullptr) attached_.push_back(pull.particle[0]);
      if (facets.distances != nullptr && pull.rest_length == 0) ties.push_back(pull.particle);
    }
  }
  std::sort(attached_.begin(), attached_.end());
  if (ties.empty()) return;
  const Components components = connected_components(ties, particles.position.size());
  std::vector<std::uint32_t> representative(components.count, no_index);
  for (const bool fixed : {true, false})
    for (std::uint32_t i = 0; i < components.of_vertex.size(); ++i)
      if (std::uint32_t& r = representative[components.of_vertex[i]];
          r == no_index && is_fixed(i, particles) == fixed)
        r = i;
  for (const Edge& tie : ties)
    for (const std::uint32_t i : tie) tied_.emplace_back(i, representative[components.of_vertex[i]]);
  std::sort(tied_.begin(), tied_.end());
  tied_.erase(std::unique(tied_.begin(), tied_.end()), tied_.end());
  for (const auto& [i, r] : tied_) {
    SOUPLE_ASSERT(representative[components.of_vertex[r]] == r, "a representative stands for itself");
    groups_.emplace_back(r, i);
  }
  std::sort(groups_.begin(), groups_.end());
}

bool TiedParticles::is_fixed(std::uint32_t particle, const ParticleView& particles) const {
  return particles.inverse_mass(particle) == 0 ||
         std::binary_search(attached_.begin(), attached_.end(), particle);
}

std::uint32_t TiedParticles::representative(std::uint32_t particle) const {
  const auto at = std::lower_bound(tied_.begin(), tied_.end(), std::pair(particle, std::uint32_t{0}));
  return at != tied_.end() && at->first == particle ? at->second : particle;
}

bool TiedParticles::is_alone(std::uint32_t representative) const {
  const auto at =
      std::lower_bound(groups_.begin(), groups_.end(), std::pair(representative, std::uint32_t{0}));
  return (at == groups_.end() || at->first != representative) &&
         !std::binary_search(attached_.begin(), attached_.end(), representative);
}

float TiedParticles::mass(std::uint32_t representative, const ParticleView& particles) const {
  if (is_fixed(representative, particles)) return 0;
  if (groups_.empty()) return 1 / particles.inverse_mass(representative);
  float sum = 0;
  for_each_of(representative, [&](std::uint32_t i) { sum += 1 / particles.inverse_mass(i); });
  return sum;
}

}  // namespace souple
