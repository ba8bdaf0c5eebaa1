#include "souple/contacts/surfaces/element_surfaces.h"

#include "souple/assert.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <utility>

namespace souple {
namespace {

// Elements that are nearer than their thickness at rest: their thickness is this part of the rest distance.
constexpr float rest_part = 0.9f;

// Edges at rest, the sides of triangles included [m].
struct EdgeLengths {
  float longest = 0, mean = 0;
};

EdgeLengths edge_lengths(const ContactSurface& surface) {
  double longest = 0, sum = 0, count = 0;
  const auto measure = [&](std::uint32_t i, std::uint32_t j) {
    const double one = length(surface.rest[i] - surface.rest[j]);
    longest = std::max(longest, one), sum += one, ++count;
  };
  if (surface.rest.empty()) return {};
  for (const Edge& edge : surface.edges) measure(edge[0], edge[1]);
  for (const Triangle& t : surface.triangles) measure(t[0], t[1]), measure(t[1], t[2]), measure(t[2], t[0]);
  return {static_cast<float>(longest), static_cast<float>(count > 0 ? sum / count : 0)};
}

}  // namespace

ElementSurfaces::ElementSurfaces(std::vector<ContactSurface> surfaces, ParticlePairs joined)
    : surfaces_(std::move(surfaces)), joined_(std::move(joined)), any_(any_may_collide(surfaces_)) {
  if (!any_) return;
  std::uint32_t end = 0;
  for (ContactSurface& surface : surfaces_) {
    surface.reserved_end = std::max(surface.reserved_end, surface.end);
    end = std::max(end, surface.reserved_end);
  }
  surface_of_.assign(end, no_surface);
  rest_.assign(end, {});
  longest_edge_.assign(surfaces_.size(), 0), mean_edge_.assign(surfaces_.size(), 0);
  for (std::uint32_t a = 0; a < surfaces_.size(); ++a) {
    const ContactSurface& surface = surfaces_[a];
    std::fill(surface_of_.data() + surface.begin, surface_of_.data() + surface.end, a);
    const EdgeLengths edges = edge_lengths(surface);
    mean_edge_[a] = edges.mean;
    if (!surface.self_collision) continue;
    for (std::size_t i = 0; i < surface.rest.size(); ++i)
      rest_[surface.begin + i].set_xyz(Vec3f(surface.rest[i] - surface.rest[0]));
    longest_edge_[a] = edges.longest;
  }
}

void ElementSurfaces::set_end(std::size_t surface, std::uint32_t end) {
  if (!any_) return;
  ContactSurface& one = surfaces_[surface];
  SOUPLE_ASSERT(one.begin <= end && end <= one.reserved_end, "particles of the surface's range");
  one.end = end;
  std::fill(surface_of_.data() + one.begin, surface_of_.data() + end, static_cast<std::uint32_t>(surface));
  std::fill(surface_of_.data() + end, surface_of_.data() + one.reserved_end, no_surface);
}

bool ElementSurfaces::are_joined(const NearPair& pair, bool edges) const {
  if (joined_.empty()) return false;
  const std::size_t first = edges ? 2 : 1;
  for (std::size_t a = 0; a < first; ++a)
    for (std::size_t b = first; b < 4; ++b)
      if (joined_.contains(pair.particle[a], pair.particle[b])) return true;
  return false;
}

bool ElementSurfaces::is_joined_to(std::uint32_t particle, std::uint32_t surface) const {
  return joined_.contains(particle, surfaces_[surface].begin);
}

void ElementSurfaces::limit_to_rest_distance(std::span<const NearPair> pairs, bool edges,
                                             float* thickness) const {
  for (std::size_t k = 0; k < pairs.size(); k += rest_batch)
    limit_some_to_rest_distance(pairs.subspan(k, std::min(rest_batch, pairs.size() - k)), edges,
                                thickness + k);
}

// The kernel reads records of positions and displacements: copies of the corners at rest, and zeros.
void ElementSurfaces::limit_some_to_rest_distance(std::span<const NearPair> pairs, bool edges,
                                                  float* thickness) const {
  static constexpr Vec4f undisplaced[4 * rest_batch]{};
  Vec4f corners[4 * rest_batch];
  std::uint32_t records[rest_batch][4];
  std::size_t which[rest_batch], count = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto& i = pairs[k].particle;
    const std::uint32_t surface = surface_of_[i[0]];
    const float near_enough = thickness[k] / rest_part + 2 * longest_edge_[surface];
    if (surfaces_[surface].rest.empty() ||
        length_squared(rest_[i[0]].xyz() - rest_[i[3]].xyz()) > near_enough * near_enough)
      continue;
    for (std::size_t j = 0; j < 4; ++j) {
      records[count][j] = static_cast<std::uint32_t>(4 * count + j);
      corners[4 * count + j] = rest_[i[j]];
    }
    which[count++] = k;
  }
  if (count == 0) return;
  float distance[rest_batch];
  kernels::ParticleRecords at_rest;
  at_rest.position = &corners[0].x;
  at_rest.moving = const_cast<float*>(&undisplaced[0].x);  // only read
  const kernels::ElementPairKernels& kernels = kernels::find_element_pair_kernels(instruction_set());
  kernels.distances[edges ? 1 : 0](at_rest, records, 0, count, distance);
  for (std::size_t n = 0; n < count; ++n)
    thickness[which[n]] = min(thickness[which[n]], rest_part * distance[n]);
}

std::size_t ElementSurfaces::bytes() const {
  return bytes_of(surfaces_, surface_of_, rest_);
}

}  // namespace souple
