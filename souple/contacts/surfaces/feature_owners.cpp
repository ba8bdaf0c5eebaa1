#include "souple/contacts/surfaces/feature_owners.h"

#include "souple/collision/nearest.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace souple {
namespace {

constexpr std::uint32_t no_vertex = std::numeric_limits<std::uint32_t>::max();

// Whether the path from q to k starts towards the origin, by more than rounding errors. Otherwise a vertex
// just above an edge would get a contact from neither triangle.
bool points_to_origin(const Vec3f& q, const Vec3f& k) {
  constexpr float sine = 1e-4f;
  const float along = -dot(q, k - q);
  return along > 0 && along * along > sine * sine * length_squared(q) * length_squared(k - q);
}

}  // namespace

void FeatureOwners::build(const ElementSurfaces& surfaces) {
  const std::size_t n = surfaces.particle_count();
  owner_of_vertex_.assign(n, {no_vertex, no_vertex, no_vertex});
  edges_.fill(n, [&](const auto& add) {
    for (std::size_t a = 0; a < surfaces.size(); ++a)
      for (std::array<std::uint32_t, 3> t : surfaces[a].triangles) {
        for (std::uint32_t& i : t) i += surfaces[a].begin;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t i = t[k], j = t[(k + 1) % 3], opposite = t[(k + 2) % 3];
          if (owner_of_vertex_[i][0] == no_vertex) owner_of_vertex_[i] = t;
          add(i, {j, opposite}), add(j, {i, opposite});
        }
      }
  });
  for (std::size_t i = 0; i < n; ++i)
    std::stable_sort(edges_[i].begin(), edges_[i].end(),
                     [](const VertexEdge& a, const VertexEdge& b) { return a.other < b.other; });
}

bool FeatureOwners::is_owner(const NearPair& pair, unsigned on_border, const SurfacePoint& x) const {
  if (on_border == 0) return true;
  if (std::has_single_bit(on_border))
    return is_owner_of_edge(pair, static_cast<std::size_t>(std::countr_zero(on_border)), x);
  const auto k = static_cast<std::size_t>(std::countr_zero(~on_border & 7u)) % 3;
  return is_owner_of_corner(pair, k, x);
}

// The edge opposite to `corner`: its first triangle owns it, unless a triangle with this edge extends below
// the vertex x. With q the nearest point of the edge and k the corner opposite to it, (x - q) . (k - q) <= 0
// must hold.
bool FeatureOwners::is_owner_of_edge(const NearPair& pair, std::size_t corner, const SurfacePoint& x) const {
  const std::uint32_t k = pair.particle[1 + corner];
  const std::uint32_t i = pair.particle[1 + (corner + 1) % 3], j = pair.particle[1 + (corner + 2) % 3];
  const Vec3f to_i = x.to(i), to_j = x.to(j);
  const float s = nearest_on_edge(Vec3f{}, to_i, to_j);
  const Vec3f to_q = to_i * (1 - s) + to_j * s;
  bool first = true;
  for (const auto& [other, opposite] : edges_[i]) {
    if (other != j) continue;
    if (first && opposite != k) return false;
    first = false;
    if (opposite != k && opposite != x.particle && points_to_origin(to_q, x.to(opposite))) return false;
  }
  return true;
}

// A corner: its first triangle owns it, if all edges at the corner fulfill the condition above.
bool FeatureOwners::is_owner_of_corner(const NearPair& pair, std::size_t corner,
                                       const SurfacePoint& x) const {
  const auto& i = pair.particle;
  const std::uint32_t q = i[1 + corner];
  for (const std::uint32_t k : owner_of_vertex_[q])
    if (k != i[1] && k != i[2] && k != i[3]) return false;
  const Vec3f to_q = x.to(q);
  for (const VertexEdge& edge : edges_[q])
    if (edge.other != x.particle && points_to_origin(to_q, x.to(edge.other))) return false;
  return true;
}

std::size_t FeatureOwners::bytes() const {
  return bytes_of(owner_of_vertex_) + edges_.bytes();
}

}  // namespace souple
