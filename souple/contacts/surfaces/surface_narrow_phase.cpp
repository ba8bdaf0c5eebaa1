#include "souple/contacts/surfaces/surface_narrow_phase.h"

#include "souple/assert.h"
#include "souple/broad_phase/spatial_hash.h"
#include "souple/collision/nearest.h"
#include "souple/collision/segment_triangle/segment_triangle.h"
#include "souple/contacts/anchor.h"
#include "souple/contacts/contact_law.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/contacts/surfaces/element_motion.h"
#include "souple/error.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

using kernels::Classification;

// Pairs that start nearer than this have no side to keep, and continuous detection ignores them: otherwise
// two sheets in one plane could never separate. The order of their objects determines the side (describe_coincident). [m]
constexpr float coincident_distance = 1e-8f;

const kernels::ElementPairKernels& narrow_kernels() {
  return kernels::find_element_pair_kernels(instruction_set());
}

// Twice the area times the unit normal of the pair's triangle.
Vec3f triangle_normal(const NearPair& pair, const ParticleView& particles) {
  const auto& i = pair.particle;
  return cross(particles.difference(i[2], i[1]), particles.difference(i[3], i[1]));
}

bool has_triangle_normal(const NearPair& pair, const ParticleView& particles) {
  const float squared = length_squared(triangle_normal(pair, particles));
  return squared > 0 && std::isfinite(squared);
}

// Whether a contact between the vertex and the nearest point of the triangle moves anything.
bool can_move(const NearPair& pair, const ParticleView& particles) {
  const auto& i = pair.particle;
  float weight[3];
  nearest_on_triangle(Vec3f{}, particles.difference(i[1], i[0]), particles.difference(i[2], i[0]),
                      particles.difference(i[3], i[0]), weight);
  float inverse_mass = particles.inverse_mass(i[0]);
  for (std::size_t k = 0; k < 3; ++k)
    inverse_mass += particles.inverse_mass(i[k + 1]) * weight[k] * weight[k];
  return inverse_mass > 0;
}

/// Discrete detection of a vertex v and a triangle (Müller et al. 2007, section 3.4: "the ray x_i -> p_i enters an
/// object"). The vertex' path within the substep must cross the triangle of the substep's start.
///
///   path: x_v + t d,  0 <= t <= 1,   d = (p_v - x_v) - 1/3 sum_k (p_k - x_k)
///
/// Deviations: the path is relative to the triangle's mean motion, so that a moving triangle meets a vertex at
/// rest. If the path ends on the side of the triangle's plane where it begins, a segment longer by the thickness along
/// the normal also counts. So a vertex that rests on a triangle keeps its contact. Pairs whose particles cannot move do
/// not cross.
PathCrossing find_path_crossing(const CrossingTest& test, const NearPair& pair, float thickness,
                                const ParticleView& particles) {
  const std::uint32_t v = pair.particle[0], a = pair.particle[1], b = pair.particle[2], c = pair.particle[3];
  float inverse_mass = 0;
  for (const std::uint32_t i : pair.particle) inverse_mass += particles.inverse_mass(i);
  if (!(inverse_mass > 0)) return {};
  // Not from differences of positions: all triangles of a rigid mesh must see the same path, to the bit.
  const Vec3f moved = particles.moved(v);
  const Vec3f path = moved - (particles.moved(a) + particles.moved(b) + particles.moved(c)) * (1.0f / 3);
  const auto start = [&](std::uint32_t i) {
    return particles.difference(i, v) - (particles.moved(i) - moved);
  };
  const Corners<float> corners{start(a), start(b), start(c)};
  const Vec3f twice_area = cross(corners.b - corners.a, corners.c - corners.a);
  const float size = length(twice_area);
  if (!(size > 0)) return {};
  Crossing<float> crossing = test.in_float({{}, path}, corners);
  const float before = -dot(twice_area, corners.a), after = dot(twice_area, path - corners.a);
  if (crossing.side == 0 && before * after > 0) {
    const Vec3f down = twice_area * ((before > 0 ? -thickness : thickness) / size);
    crossing = test.in_float({{}, path + down}, corners);
  }
  if (crossing.side == 0) return {};
  return {true, crossing.weight, twice_area * (crossing.side / size)};
}

void find_chunk_violations(ElementPairs& candidates, std::size_t chunk, const ParticleView& particles,
                           bool all, std::vector<PairToi>& found) {
  constexpr float distance_part = 0.9f;  // of the distance: pairs with a smaller motion are skipped
  std::uint32_t near[ElementPairs::chunk_size];
  const kernels::ParticleRecords records = candidates.particle_records(particles);
  const std::size_t count = all ? candidates.find_near(chunk, {distance_part, 0, 0}, records, near)
                                : candidates.find_moved_by(distance_part, chunk, records, near);
  for (std::size_t k = 0; k < count; ++k) {
    if (candidates.distance_bound(near[k]) < coincident_distance || candidates.is_replaced(near[k])) continue;
    const float toi =
        safe_time(motion_of(candidates.pair(near[k]), particles), candidates.chunk(chunk).edges);
    SOUPLE_ASSERT(0 <= toi && toi <= 1, "a time of impact is a part of the motion");
    if (toi < 1) found.push_back({near[k], toi});
  }
}

}  // namespace

Anchor<4> anchor_of(const kernels::ContactColumns& contacts, std::size_t c) {
  Anchor<4> anchor;
  for (std::size_t k = 0; k < 4; ++k) {
    anchor.particle[k] = contacts.particle[k][c];
    anchor.weight[k] = contacts.c[k][c];
  }
  return anchor;
}

Vec3f correction_of(const kernels::ContactColumns& contacts, std::size_t c) {
  const auto vector = [c](float* const(&of)[3]) { return Vec3f{of[0][c], of[1][c], of[2][c]}; };
  return vector(contacts.normal) * contacts.normal_sum[c] + vector(contacts.tangent_sum);
}

void SurfaceNarrowPhase::begin_step(const ElementSurfaces& surfaces, const ContactMaterialTable& materials,
                                    const ContactStep& step) {
  if (materials.rows() < surfaces.size() || materials.columns() < surfaces.size())
    throw Error(
        "SurfaceContacts: the contact material table has fewer rows or columns than there are surfaces; "
        "rebuild it");
  materials_ = &materials;
  step_ = step;
}

void SurfaceNarrowPhase::begin_substep(float h) {
  limits_ = {1 / h, step_.restitution_threshold(h)};
}

ContactMaterialPair SurfaceNarrowPhase::material(std::uint32_t one, std::uint32_t other,
                                                 const Vec3f& moved) const {
  ContactMaterialPair result = materials_->at(one, other);
  if (result.kinetic_friction < result.static_friction)
    result.kinetic_friction =
        kinetic_friction_at(result, moved, limits_.restitution_threshold / limits_.inverse_h);
  return result;
}

float SurfaceNarrowPhase::release(std::uint32_t one, std::uint32_t other) const {
  return step_.depenetration_speed(materials_->radius(one, other)) / limits_.inverse_h;
}

void SurfaceNarrowPhase::find_contacts(ElementPairs& candidates, const ParticleView& particles,
                                       std::vector<PairToi>& found, Threads& threads) {
  find(candidates.chunk_count(), found, threads, [&](std::size_t chunk, std::vector<PairToi>& of_chunk) {
    is_discrete() ? find_chunk_crossings(candidates, chunk, particles, of_chunk)
                  : find_chunk_contacts(candidates, chunk, particles, of_chunk);
  });
}

void SurfaceNarrowPhase::find_violations(ElementPairs& candidates, const ParticleView& particles, bool all,
                                         std::vector<PairToi>& found, Threads& threads) {
  find(candidates.chunk_count(), found, threads, [&](std::size_t chunk, std::vector<PairToi>& of_chunk) {
    find_chunk_violations(candidates, chunk, particles, all, of_chunk);
  });
}

// Calls of_chunk(index of the chunk, its results) and joins the results of all chunks in order.
template <class Function>
void SurfaceNarrowPhase::find(std::size_t count, std::vector<PairToi>& found, Threads& threads,
                              const Function& of_chunk) {
  if (chunk_results_.size() < count) {
    const std::size_t before = chunk_results_.size();
    chunk_results_.resize(count + count / 2 + 16);
    for (std::size_t c = before; c < chunk_results_.size(); ++c)
      chunk_results_[c].pairs.reserve(ElementPairs::chunk_size);
  }
  threads.each(count, 4, [&](std::size_t c) {
    chunk_results_[c].pairs.clear();
    of_chunk(c, chunk_results_[c].pairs);
  });
  std::size_t sum = 0;
  for (std::size_t c = 0; c < count; ++c) {
    chunk_results_[c].offset = sum;
    sum += chunk_results_[c].pairs.size();
  }
  resize_with_spare(found, sum, contact_spare);
  for (std::size_t c = 0; c < count; ++c)
    std::copy(chunk_results_[c].pairs.begin(), chunk_results_[c].pairs.end(),
              found.begin() + static_cast<std::ptrdiff_t>(chunk_results_[c].offset));
}

void SurfaceNarrowPhase::find_chunk_contacts(ElementPairs& candidates, std::size_t chunk,
                                             const ParticleView& particles,
                                             std::vector<PairToi>& found) const {
  std::uint32_t near[ElementPairs::chunk_size];
  float classification[ElementPairs::chunk_size];
  const kernels::ParticleRecords records = candidates.particle_records(particles);
  const std::size_t count =
      candidates.find_near(chunk, {1, 1 + speculative_part, candidates.contact_margin(chunk)}, records, near);
  if (count == 0) return;
  narrow_kernels().classify[candidates.chunk(chunk).edges ? 1 : 0](
      records, candidates.columns(), speculative_part, near, 0, count, classification);
  for (std::size_t k = 0; k < count; ++k) {
    float toi = 1;
    if (!candidates.is_replaced(near[k]) &&
        is_contact(candidates, near[k], static_cast<unsigned>(classification[k]), particles, toi))
      found.push_back({near[k], toi});
  }
}

PathCrossing SurfaceNarrowPhase::path_crossing_of(ElementPairs& candidates, std::uint32_t pair,
                                                  const ParticleView& particles) const {
  const NearPair& particle = candidates.pair(pair);
  return find_path_crossing(*step_.crossing_test, particle, candidates.columns().thickness[pair], particles);
}

void SurfaceNarrowPhase::find_chunk_crossings(ElementPairs& candidates, std::size_t chunk,
                                              const ParticleView& particles,
                                              std::vector<PairToi>& found) const {
  if (candidates.chunk(chunk).edges) return;
  std::uint32_t near[ElementPairs::chunk_size];
  const std::size_t count =
      candidates.find_near(chunk, {1, 1 + speculative_part, 0}, candidates.particle_records(particles), near);
  for (std::size_t k = 0; k < count; ++k)
    if (!candidates.is_replaced(near[k]) && path_crossing_of(candidates, near[k], particles).found)
      found.push_back({near[k], 1});
}

void SurfaceNarrowPhase::describe_crossing(ElementPairs& candidates, std::uint32_t pair, std::size_t contact,
                                           const ParticleView& particles,
                                           const kernels::ContactColumns& out) const {
  const PathCrossing crossing = path_crossing_of(candidates, pair, particles);
  const auto& i = candidates.pair(pair).particle;
  float inverse_mass = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const float c = k == 0 ? 1 : -crossing.weight[static_cast<int>(k) - 1];
    out.c[k][contact] = c;
    inverse_mass += particles.inverse_mass(i[k]) * c * c;
  }
  for (int axis = 0; axis < 3; ++axis) out.normal[axis][contact] = crossing.normal[axis];
  out.inverse_mass[contact] = inverse_mass;
  out.approach[contact] = -dot(crossing.normal, anchor_of(out, contact).moved(particles));
}

// A pair of two objects that find_near returned. Pairs that were squeezed until they coincide do not count.
bool SurfaceNarrowPhase::is_placed_at_one_place(const ElementPairs& candidates, std::uint32_t pair) const {
  const auto& i = candidates.pair(pair).particle;
  return step_.placed && candidates.distance_bound(pair) < coincident_distance &&
         candidates.surfaces().of(i[0]) != candidates.surfaces().of(i[3]);
}

bool SurfaceNarrowPhase::is_contact(const ElementPairs& candidates, std::uint32_t pair,
                                    unsigned classification, const ParticleView& particles,
                                    float& toi) const {
  const bool edges = candidates.are_edges(pair);
  const NearPair& particle = candidates.pair(pair);
  if (is_placed_at_one_place(candidates, pair))
    return !edges && has_triangle_normal(particle, particles) && can_move(particle, particles);
  if ((classification & Classification::fast) != 0) {
    const Motion motion = motion_of(particle, particles);
    toi = safe_time(motion, edges);
    if (toi < 1) return has_normal(particle, motion, toi, edges, particles);
  }
  if ((classification & Classification::touches) == 0) return false;
  const unsigned on_border = classification / Classification::on_border;
  if (!edges) return owners_.is_owner(particle, on_border, {particles, particle.particle[0]});
  const auto is_rope = [&](std::uint32_t i) {
    return candidates.surfaces()[candidates.surfaces().of(i)].triangles.empty();
  };
  return on_border == 0 || is_rope(particle.particle[0]) || is_rope(particle.particle[2]);
}

void SurfaceNarrowPhase::describe(ElementPairs& candidates, bool edges, std::size_t begin, std::size_t end,
                                  const ParticleView& particles, const std::vector<std::uint32_t>& pairs,
                                  const std::vector<float>& tois, const kernels::ContactColumns& out) const {
  if (begin >= end) return;
  for (std::size_t c = begin; c < end; ++c) {
    const NearPair& pair = candidates.pair(pairs[c]);
    out.slop[c] =
        release(candidates.surfaces().of(pair.particle[0]), candidates.surfaces().of(pair.particle[3]));
  }
  narrow_kernels().describe[edges ? 1 : 0](candidates.particle_records(particles), candidates.columns(),
                                           pairs.data(), tois.data(), begin, end, out);
  for (std::size_t c = begin; c < end; ++c) {
    const NearPair& pair = candidates.pair(pairs[c]);
    const ContactMaterialPair surface =
        material(candidates.surfaces().of(pair.particle[0]), candidates.surfaces().of(pair.particle[3]),
                 anchor_of(out, c).moved(particles));
    out.static_friction[c] = surface.static_friction;
    out.kinetic_friction[c] = surface.kinetic_friction;
    out.restitution[c] = surface.restitution;
    if (!edges && is_placed_at_one_place(candidates, pairs[c]))
      describe_coincident(candidates, c, particles, out);
    if (step_.turn.empty()) continue;
    const std::uint32_t ball = pair.particle[0];
    out.share[c] = candidates.surfaces()[candidates.surfaces().of(ball)].rolls
                       ? inverse_inertia_factor * particles.inverse_mass(ball) / out.inverse_mass[c]
                       : 0.0f;
    out.rolling_friction[c] = surface.rolling_friction;
    for (float* const sum : out.moment_sum) sum[c] = 0;
  }
}

// A vertex on a triangle of another object: the later object belongs on the side from which the triangle's corners are
// counter-clockwise. So sheets at one place separate in one direction.
void SurfaceNarrowPhase::describe_coincident(const ElementPairs& candidates, std::size_t contact,
                                             const ParticleView& particles,
                                             const kernels::ContactColumns& out) {
  NearPair pair{};
  for (std::size_t k = 0; k < 4; ++k) pair.particle[k] = out.particle[k][contact];
  const bool outside =
      candidates.surfaces().of(pair.particle[0]) > candidates.surfaces().of(pair.particle[3]);
  const Vec3f normal = normalized(triangle_normal(pair, particles)) * (outside ? 1.0f : -1.0f);
  for (int axis = 0; axis < 3; ++axis) out.normal[axis][contact] = normal[axis];
  out.approach[contact] = -dot(normal, anchor_of(out, contact).moved(particles));
}

std::size_t SurfaceNarrowPhase::bytes() const {
  std::size_t sum = owners_.bytes();
  for (const ChunkResult& found : chunk_results_) sum += bytes_of(found.pairs);
  return sum;
}

}  // namespace souple
