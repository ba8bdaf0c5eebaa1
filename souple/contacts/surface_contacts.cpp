#include "souple/contacts/surface_contacts.h"

#include "souple/assert.h"
#include "souple/collision/continuous.h"
#include "souple/collision/nearest.h"
#include "souple/contacts/contact_law.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/error.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <tuple>

namespace souple {
namespace {

using kernels::Classification;

constexpr std::size_t contact_grain = 256;
constexpr std::uint16_t no_color = std::numeric_limits<std::uint16_t>::max();
constexpr std::uint32_t no_vertex = std::numeric_limits<std::uint32_t>::max();
// Pairs that start nearer than this have no side to keep, and continuous detection ignores them: otherwise
// two sheets in one plane could never separate. [m]
constexpr float coincident_distance = 1e-8f;

const kernels::ElementPairKernels& simd_kernels() {
  return kernels::find_element_pair_kernels(instruction_set());
}

/// Positions of the four particles of a pair relative to the first: x at the start of the substep, p at its
/// end.
struct Motion {
  Vec3f x[4], p[4];
};

Motion motion_of(const NearPair& pair, const ParticleView& particles) {
  const auto& i = pair.particle;
  Motion motion;
  const Vec3f moved = particles.moved(i[0]);
  for (std::size_t k = 1; k < 4; ++k) {
    motion.p[k] = particles.difference(i[k], i[0]);
    motion.x[k] = motion.p[k] - (particles.moved(i[k]) - moved);
  }
  return motion;
}

/// The part of the motion x -> p up to which the two elements do not touch, at most 1.
float safe_time(const Motion& motion, bool edges) {
  Moving4 moving;
  for (std::size_t k = 0; k < 4; ++k) moving.x[k] = Vec3d(motion.x[k]), moving.p[k] = Vec3d(motion.p[k]);
  const double time = edges ? edge_edge_time(moving, 0) : vertex_triangle_time(moving, 0);
  return static_cast<float>(time);
}

/// Whether the nearest points at `toi` differ, so that they have a normal, and a particle can move along it.
bool has_normal(const NearPair& pair, const Motion& motion, float toi, bool edges,
                const ParticleView& particles) {
  Vec3f at[4];
  for (std::size_t k = 1; k < 4; ++k) at[k] = motion.x[k] + (motion.p[k] - motion.x[k]) * toi;
  float c[4] = {1, 0, 0, 0};
  if (edges) {
    float s = 0, t = 0;
    nearest_on_edges(at[0], at[1], at[2], at[3], s, t);
    c[0] = 1 - s, c[1] = s, c[2] = t - 1, c[3] = -t;
  } else {
    float weight[3];
    nearest_on_triangle(at[0], at[1], at[2], at[3], weight);
    for (std::size_t k = 0; k < 3; ++k) c[k + 1] = -weight[k];
  }
  float inverse_mass = 0;
  for (std::size_t k = 0; k < 4; ++k) inverse_mass += particles.inverse_mass(pair.particle[k]) * c[k] * c[k];
  return inverse_mass > 0 && length(at[1] * c[1] + at[2] * c[2] + at[3] * c[3]) > 0;
}

/// Of the nearest points of a contact's elements in the substep [m].
Vec3f relative_motion(const kernels::ContactColumns& contacts, std::size_t c, const ParticleView& particles) {
  Vec3f motion;
  for (std::size_t k = 0; k < 4; ++k) motion += particles.moved(contacts.particle[k][c]) * contacts.c[k][c];
  return motion;
}

// Whether the path from q to k starts towards the origin, by more than rounding errors. Otherwise a vertex
// just above an edge would get a contact from neither triangle.
bool points_to_origin(const Vec3f& q, const Vec3f& k) {
  constexpr float sine = 1e-4f;
  const float along = -dot(q, k - q);
  return along > 0 && along * along > sine * sine * length_squared(q) * length_squared(k - q);
}

}  // namespace

void SurfaceContacts::set_surfaces(std::vector<ContactSurface> surfaces) {
  clear_contacts();
  pairs_.set_surfaces(std::move(surfaces));
  if (!pairs_.any()) return;
  build_vertex_edges();
  // The numbers of colors and of violations vary between substeps.
  used_.reserve(3 * pairs_.particle_count());
  begin_.reserve(512), next_slot_.reserve(512);
  correction_pair_.reserve(256), correction_toi_.reserve(256), violations_.reserve(256);
  corrected_particles_.reserve(2048);
  corrections_.resize(256);
}

// --- feature owners

void SurfaceContacts::build_vertex_edges() {
  const std::size_t n = pairs_.particle_count();
  owner_of_vertex_.assign(n, {no_vertex, no_vertex, no_vertex});
  struct Entry {
    std::uint32_t vertex;
    VertexEdge edge;
  };
  std::vector<Entry> found;
  for (std::size_t a = 0; a < pairs_.surface_count(); ++a) {
    const ContactSurface& surface = pairs_.surface(a);
    for (std::array<std::uint32_t, 3> t : surface.triangles) {
      for (std::uint32_t& i : t) i += surface.begin;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t i = t[k], j = t[(k + 1) % 3], opposite = t[(k + 2) % 3];
        if (owner_of_vertex_[i][0] == no_vertex) owner_of_vertex_[i] = t;
        found.push_back({i, {j, opposite}});
        found.push_back({j, {i, opposite}});
      }
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const Entry& a, const Entry& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.edge.other < b.edge.other;
  });
  vertex_edges_.clear();
  vertex_edges_begin_.assign(n + 1, 0);
  for (const Entry& one : found) {
    vertex_edges_.push_back(one.edge);
    ++vertex_edges_begin_[one.vertex + 1];
  }
  for (std::size_t i = 0; i < n; ++i) vertex_edges_begin_[i + 1] += vertex_edges_begin_[i];
}

// Whether the triangle of a pair owns the feature where its nearest point lies: the triangle, an edge or a
// corner. Bit k of on_border: corner k has no weight.
bool SurfaceContacts::is_owner(const NearPair& pair, unsigned on_border,
                               const ParticleView& particles) const {
  if (on_border == 0) return true;
  if (std::has_single_bit(on_border))
    return is_owner_of_edge(pair, static_cast<std::size_t>(std::countr_zero(on_border)), particles);
  const auto k = static_cast<std::size_t>(std::countr_zero(~on_border & 7u)) % 3;
  return is_owner_of_corner(pair, k, particles);
}

// The edge opposite to `corner`: its first triangle owns it, unless a triangle with this edge extends below
// the vertex x. With q the nearest point of the edge and k the corner opposite to it, (x - q) . (k - q) <= 0
// must hold.
bool SurfaceContacts::is_owner_of_edge(const NearPair& pair, std::size_t corner,
                                       const ParticleView& particles) const {
  const std::uint32_t x = pair.particle[0], k = pair.particle[1 + corner];
  const std::uint32_t i = pair.particle[1 + (corner + 1) % 3], j = pair.particle[1 + (corner + 2) % 3];
  const Vec3f to_i = particles.difference(i, x), to_j = particles.difference(j, x);
  const float s = nearest_on_edge(Vec3f{}, to_i, to_j);
  const Vec3f to_q = to_i * (1 - s) + to_j * s;
  bool first = true;
  for (std::uint32_t n = vertex_edges_begin_[i]; n < vertex_edges_begin_[i + 1]; ++n) {
    if (vertex_edges_[n].other != j) continue;
    const std::uint32_t opposite = vertex_edges_[n].opposite;
    if (first && opposite != k) return false;
    first = false;
    if (opposite != k && opposite != x && points_to_origin(to_q, particles.difference(opposite, x)))
      return false;
  }
  return true;
}

// A corner: its first triangle owns it, if all edges at the corner fulfill the condition above.
bool SurfaceContacts::is_owner_of_corner(const NearPair& pair, std::size_t corner,
                                         const ParticleView& particles) const {
  const auto& i = pair.particle;
  const std::uint32_t x = i[0], q = i[1 + corner];
  for (const std::uint32_t k : owner_of_vertex_[q])
    if (k != i[1] && k != i[2] && k != i[3]) return false;
  const Vec3f to_q = particles.difference(q, x);
  for (std::uint32_t n = vertex_edges_begin_[q]; n < vertex_edges_begin_[q + 1]; ++n) {
    const std::uint32_t other = vertex_edges_[n].other;
    if (other != x && points_to_origin(to_q, particles.difference(other, x))) return false;
  }
  return true;
}

// --- search

void SurfaceContacts::begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                                 std::span<const float> radius, std::span<float> contact_margin,
                                 const ContactMaterialTable& materials, const ContactStep& step,
                                 Threads& threads) {
  clear_contacts();
  pairs_.clear();
  if (!pairs_.any()) return;
  if (materials.rows() < pairs_.surface_count() || materials.columns() < pairs_.surface_count())
    throw Error(
        "SurfaceContacts: the contact material table has fewer rows or columns than there are surfaces; "
        "rebuild it");
  materials_ = &materials;
  step_ = step;
  contact_margin_ = contact_margin;
  pairs_.begin_step(particles, velocity, radius, contact_margin, step, threads);
  reset_colors();
}

void SurfaceContacts::clear_contacts() {
  contacts_.resize(0);
  begin_.assign(1, 0);
}

// Pairs from `first_new` on are new and have no color; 0: all pairs are new.
void SurfaceContacts::reset_colors_from(std::size_t first_new) {
  if (first_new == 0) return reset_colors();
  const std::size_t old_size = color_.size();
  resize_with_spare(color_, pairs_.size());
  std::fill(color_.begin() + static_cast<std::ptrdiff_t>(old_size), color_.end(), no_color);
}

void SurfaceContacts::reset_colors() {
  resize_with_spare(color_, pairs_.size());
  std::fill(color_.begin(), color_.end(), no_color);
  used_.assign(pairs_.particle_count(), 0);
}

// Calls of_chunk(index of the chunk, its results) and joins the results of all chunks in order.
template <class Function>
void SurfaceContacts::find(std::vector<PairToi>& found, Threads& threads, const Function& of_chunk) {
  const std::size_t count = pairs_.chunk_count();
  if (chunk_results_.size() < count) {
    const std::size_t before = chunk_results_.size();
    chunk_results_.resize(count + count / 2 + 16);
    for (std::size_t c = before; c < chunk_results_.size(); ++c)
      chunk_results_[c].pairs.reserve(ElementPairs::chunk_size);
  }
  threads.for_each(count, 4, [&](std::size_t c, std::size_t last) {
    for (; c < last; ++c) {
      chunk_results_[c].pairs.clear();
      of_chunk(c, chunk_results_[c].pairs);
    }
  });
  std::size_t sum = 0;
  for (std::size_t c = 0; c < count; ++c) {
    chunk_results_[c].offset = sum;
    sum += chunk_results_[c].pairs.size();
  }
  resize_with_spare(found, sum, ContactArrays::spare);
  for (std::size_t c = 0; c < count; ++c)
    std::copy(chunk_results_[c].pairs.begin(), chunk_results_[c].pairs.end(),
              found.begin() + static_cast<std::ptrdiff_t>(chunk_results_[c].offset));
}

void SurfaceContacts::refresh(const ParticleView& particles, const Substep& substep, Threads& threads) {
  clear_contacts();
  if (!pairs_.any()) return;
  limits_ = {1 / substep.h, 2 * step_.gravity * substep.h};
  pairs_.begin_substep(substep.h);
  reset_colors_from(pairs_.update(particles, substep.h, threads));
  pairs_.measure(particles, threads);
  const bool discrete = step_.detection == Detection::discrete;
  find(contact_pairs_, threads, [&](std::size_t chunk, std::vector<PairToi>& found) {
    discrete ? find_chunk_crossings(chunk, particles, found) : find_chunk_contacts(chunk, particles, found);
  });
  sort_by_color(particles);
  describe_contacts(particles, threads);
  for (std::size_t c = 0; discrete && c < size(); ++c) describe_crossing(pair_[c], c, particles);
}

void SurfaceContacts::find_chunk_contacts(std::size_t chunk, const ParticleView& particles,
                                          std::vector<PairToi>& found) {
  std::uint32_t near[ElementPairs::chunk_size];
  float classification[ElementPairs::chunk_size];
  const kernels::ParticleRecords records = pairs_.particle_records(particles);
  const std::size_t count =
      pairs_.find_near(chunk, {1, 1 + speculative_part, pairs_.contact_margin(chunk)}, records, near);
  if (count == 0) return;
  simd_kernels().classify[pairs_.chunk(chunk).edges ? 1 : 0](records, pairs_.columns(), speculative_part,
                                                             near, 0, count, classification);
  for (std::size_t k = 0; k < count; ++k) {
    float toi = 1;
    if (!pairs_.is_replaced(near[k]) &&
        is_contact(near[k], static_cast<unsigned>(classification[k]), particles, toi))
      found.push_back({near[k], toi});
  }
}

// --- discrete detection

PathCrossing SurfaceContacts::path_crossing_of(std::uint32_t pair, const ParticleView& particles) {
  const NearPair& particle = pairs_.pair(pair);
  return find_path_crossing(step_.segment_test, particle, pairs_.columns().thickness[pair], particles);
}

void SurfaceContacts::find_chunk_crossings(std::size_t chunk, const ParticleView& particles,
                                           std::vector<PairToi>& found) {
  if (pairs_.chunk(chunk).edges) return;
  std::uint32_t near[ElementPairs::chunk_size];
  const std::size_t count =
      pairs_.find_near(chunk, {1, 1 + speculative_part, 0}, pairs_.particle_records(particles), near);
  for (std::size_t k = 0; k < count; ++k)
    if (!pairs_.is_replaced(near[k]) && path_crossing_of(near[k], particles).found)
      found.push_back({near[k], 1});
}

// Replaces the nearest points and the normal between them by the crossing and the triangle's normal.
void SurfaceContacts::describe_crossing(std::uint32_t pair, std::size_t contact,
                                        const ParticleView& particles) {
  const PathCrossing crossing = path_crossing_of(pair, particles);
  const auto& i = pairs_.pair(pair).particle;
  Vec3f approach;
  float inverse_mass = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const float c = k == 0 ? 1 : -crossing.weight[static_cast<int>(k) - 1];
    columns_.c[k][contact] = c;
    approach -= particles.moved(i[k]) * c;
    inverse_mass += particles.inverse_mass(i[k]) * c * c;
  }
  for (int axis = 0; axis < 3; ++axis) columns_.normal[axis][contact] = crossing.normal[axis];
  columns_.inverse_mass[contact] = inverse_mass;
  columns_.approach[contact] = dot(crossing.normal, approach);
}

bool SurfaceContacts::is_contact(std::uint32_t pair, unsigned classification, const ParticleView& particles,
                                 float& toi) const {
  const bool edges = pairs_.are_edges(pair);
  const NearPair& particle = pairs_.pair(pair);
  if ((classification & Classification::fast) != 0) {
    const Motion motion = motion_of(particle, particles);
    toi = safe_time(motion, edges);
    if (toi < 1) return has_normal(particle, motion, toi, edges, particles);
  }
  if ((classification & Classification::touches) == 0) return false;
  const unsigned on_border = classification / Classification::on_border;
  if (!edges) return is_owner(particle, on_border, particles);
  const auto is_rope = [&](std::uint32_t i) {
    return pairs_.surface(pairs_.surface_of(i)).triangles.empty();
  };
  return on_border == 0 || is_rope(particle.particle[0]) || is_rope(particle.particle[2]);
}

// --- colors

// The lowest color that none of its movable particles has.
std::uint16_t SurfaceContacts::color_of(const NearPair& pair, const ParticleView& particles) {
  const std::size_t n = pairs_.particle_count();
  for (std::size_t round = 0;; ++round) {
    if (used_.size() == round * n) used_.resize(used_.size() + n, 0);
    std::uint64_t* const used = used_.data() + round * n;
    std::uint64_t occupied = 0;
    for (const std::uint32_t i : pair.particle)
      if (particles.inverse_mass(i) > 0) occupied |= used[i];
    if (occupied == ~std::uint64_t{0}) continue;
    const int bit = std::countr_one(occupied);
    for (const std::uint32_t i : pair.particle) used[i] |= std::uint64_t{1} << bit;
    return static_cast<std::uint16_t>(64 * round + static_cast<std::size_t>(bit));
  }
}

// Sorts by color; within a color vertices and triangles come first, then edges, each in order of pairs.
void SurfaceContacts::sort_by_color(const ParticleView& particles) {
  next_slot_.assign(next_slot_.capacity() > 0 ? 2 : 256, 0);
  for (const PairToi& contact : contact_pairs_) {
    std::uint16_t& color = color_[contact.pair];
    if (color == no_color) color = color_of(pairs_.pair(contact.pair), particles);
    const std::size_t kind = 2 * std::size_t{color} + (pairs_.are_edges(contact.pair) ? 1 : 0);
    if (next_slot_.size() <= kind) next_slot_.resize(2 * std::size_t{color} + 2, 0);
    ++next_slot_[kind];
  }
  begin_.clear();
  std::size_t sum = 0;
  for (std::size_t kind = 0; kind < next_slot_.size(); kind += 2) {
    const std::size_t vertices = next_slot_[kind], edges = next_slot_[kind + 1];
    next_slot_[kind] = sum, next_slot_[kind + 1] = sum + vertices;
    if (vertices + edges == 0) continue;
    begin_.push_back(sum), begin_.push_back(sum + vertices);
    sum += vertices + edges;
  }
  begin_.push_back(sum);
  resize_with_spare(pair_, sum, ContactArrays::spare);
  resize_with_spare(toi_, sum, ContactArrays::spare);
  for (const PairToi& contact : contact_pairs_) {
    const std::size_t slot =
        next_slot_[2 * std::size_t{color_[contact.pair]} + (pairs_.are_edges(contact.pair) ? 1 : 0)]++;
    pair_[slot] = contact.pair;
    toi_[slot] = contact.toi;
  }
  SOUPLE_ASSERT(std::is_sorted(begin_.begin(), begin_.end()), "colors follow each other");
  SOUPLE_ASSERT(colors_are_independent(particles), "contacts of one color share no particle that moves");
}

bool SurfaceContacts::colors_are_independent(const ParticleView& particles) const {
  // Per particle: its last contact, counted from 1. Warm steps allocate nothing, with assertions too.
  thread_local std::vector<std::size_t> last;
  last.assign(pairs_.particle_count(), 0);
  for (std::size_t kind = 0; kind + 1 < begin_.size(); ++kind)
    for (std::size_t slot = begin_[kind]; slot < begin_[kind + 1]; ++slot)
      for (const std::uint32_t i : pairs_.pair(pair_[slot]).particle) {
        if (!(particles.inverse_mass(i) > 0)) continue;
        if (last[i] > begin_[kind - kind % 2] && last[i] != slot + 1) return false;
        last[i] = slot + 1;
      }
  return true;
}

// --- contacts

void SurfaceContacts::describe(bool edges, std::size_t begin, std::size_t end, const ParticleView& particles,
                               const std::vector<std::uint32_t>& pairs, const std::vector<float>& tois,
                               const kernels::ContactColumns& out) {
  if (begin >= end) return;
  for (std::size_t c = begin; c < end; ++c) {
    const NearPair& pair = pairs_.pair(pairs[c]);
    const float radius =
        materials_->radius(pairs_.surface_of(pair.particle[0]), pairs_.surface_of(pair.particle[3]));
    out.slop[c] = step_.depenetration_speed(radius) / limits_.inverse_h;
  }
  simd_kernels().describe[edges ? 1 : 0](pairs_.particle_records(particles), pairs_.columns(), pairs.data(),
                                         tois.data(), begin, end, out);
  for (std::size_t c = begin; c < end; ++c) {
    const NearPair& pair = pairs_.pair(pairs[c]);
    const ContactMaterialPair& surface =
        materials_->at(pairs_.surface_of(pair.particle[0]), pairs_.surface_of(pair.particle[3]));
    out.static_friction[c] = surface.static_friction;
    out.kinetic_friction[c] = surface.kinetic_friction;
    if (surface.kinetic_friction < surface.static_friction)
      out.kinetic_friction[c] = kinetic_friction_at(surface, relative_motion(out, c, particles),
                                                    limits_.restitution_threshold / limits_.inverse_h);
    out.restitution[c] = surface.restitution;
    if (step_.turn.empty()) continue;
    const std::uint32_t ball = pair.particle[0];
    out.share[c] = pairs_.surface(pairs_.surface_of(ball)).rolls
                       ? inverse_inertia_factor * particles.inverse_mass(ball) / out.inverse_mass[c]
                       : 0.0f;
    out.rolling_friction[c] = surface.rolling_friction;
    for (float* const sum : out.moment_sum) sum[c] = 0;
  }
}

void SurfaceContacts::describe_contacts(const ParticleView& particles, Threads& threads) {
  contacts_.resize(contact_pairs_.size());
  columns_ = contacts_.columns();
  threads.for_each(contact_pairs_.size(), contact_grain, [&](std::size_t begin, std::size_t end) {
    auto kind =
        static_cast<std::size_t>(std::upper_bound(begin_.begin(), begin_.end(), begin) - begin_.begin()) - 1;
    for (; begin < end; ++kind) {
      const std::size_t last = std::min(end, begin_[kind + 1]);
      describe(kind % 2 == 1, begin, last, particles, pair_, toi_, columns_);
      begin = std::max(begin, last);
    }
  });
}

void SurfaceContacts::project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
                              const Substep&) {
  const std::size_t first = begin_[2 * static_cast<std::size_t>(color)];
  simd_kernels().project(pairs_.particle_records(particles), columns_, first + begin, first + end);
}

// --- continuous detection

void SurfaceContacts::find_chunk_violations(std::size_t chunk, const ParticleView& particles, bool all,
                                            std::vector<PairToi>& found) {
  constexpr float distance_part = 0.9f;  // of the distance: pairs with a smaller motion are skipped
  if (!all && !pairs_.any_moved_by(distance_part, pairs_.chunk(chunk))) return;
  std::uint32_t near[ElementPairs::chunk_size];
  const std::size_t count =
      pairs_.find_near(chunk, {distance_part, 0, 0}, pairs_.particle_records(particles), near);
  for (std::size_t k = 0; k < count; ++k) {
    if (!all && !pairs_.was_moved(near[k])) continue;
    if (pairs_.distance_bound(near[k]) < coincident_distance || pairs_.is_replaced(near[k])) continue;
    const float toi = safe_time(motion_of(pairs_.pair(near[k]), particles), pairs_.chunk(chunk).edges);
    SOUPLE_ASSERT(0 <= toi && toi <= 1, "a time of impact is a part of the motion");
    if (toi < 1) found.push_back({near[k], toi});
  }
}

// Finds the pairs that would touch along their motions, in order of pairs.
void SurfaceContacts::find_violations(const ParticleView& particles, Threads& threads) {
  pairs_.measure(particles, threads);
  find(violations_, threads, [&](std::size_t chunk, std::vector<PairToi>& found) {
    find_chunk_violations(chunk, particles, true, found);
  });
}

// After a pass. It moved only particles of violations and of correction contacts, so only their pairs are
// tested: all other pairs have no violation, as before.
void SurfaceContacts::refind_violations(const ParticleView& particles, const Substep& substep,
                                        Threads& threads) {
  corrected_particles_.clear();
  for (const PairToi& violation : violations_)
    for (const std::uint32_t i : pairs_.pair(violation.pair).particle) corrected_particles_.push_back(i);
  for (const std::uint32_t* const column : corrections_.columns().particle)
    corrected_particles_.insert(corrected_particles_.end(), column, column + correction_pair_.size());
  std::sort(corrected_particles_.begin(), corrected_particles_.end());
  corrected_particles_.erase(std::unique(corrected_particles_.begin(), corrected_particles_.end()),
                             corrected_particles_.end());
  const std::size_t first_new = pairs_.update(particles, substep.h, corrected_particles_, threads);
  reset_colors_from(first_new);
  if (first_new == 0) return find_violations(particles, threads);
  pairs_.measure(particles, corrected_particles_);
  find(violations_, threads, [&](std::size_t chunk, std::vector<PairToi>& found) {
    find_chunk_violations(chunk, particles, false, found);
  });
}

// Adds correction contacts of the violations and solves all correction contacts, one after the other. They
// conserve momentum.
void SurfaceContacts::solve_corrections(const ParticleView& particles) {
  const std::size_t begin = correction_pair_.size();
  const auto append = [&](bool edges) {
    for (const PairToi& violation : violations_) {
      const NearPair& pair = pairs_.pair(violation.pair);
      if (pairs_.are_edges(violation.pair) != edges ||
          !has_normal(pair, motion_of(pair, particles), violation.toi, edges, particles))
        continue;
      correction_pair_.push_back(violation.pair);
      correction_toi_.push_back(violation.toi);
    }
  };
  append(false);
  const std::size_t edges = correction_pair_.size();
  append(true);
  corrections_.resize(correction_pair_.size());
  const kernels::ContactColumns columns = corrections_.columns();
  describe(false, begin, edges, particles, correction_pair_, correction_toi_, columns);
  describe(true, edges, correction_pair_.size(), particles, correction_pair_, correction_toi_, columns);
  const kernels::ElementPairKernels& scalar_kernels =
      kernels::find_element_pair_kernels(InstructionSet::scalar);
  constexpr int sweeps = 4;
  for (int sweep = 0; sweep < sweeps; ++sweep)
    scalar_kernels.project(pairs_.particle_records(particles), columns, 0, correction_pair_.size());
}

// Particles of violations keep the part of their motion that is safe.
void SurfaceContacts::clamp_to_toi(const ParticleView& particles) {
  clamp_toi_.assign(pairs_.particle_count(), 1);
  for (const PairToi& violation : violations_)
    for (const std::uint32_t i : pairs_.pair(violation.pair).particle)
      clamp_toi_[i] = min(clamp_toi_[i], violation.toi);
  for (std::size_t i = 0; i < clamp_toi_.size(); ++i)
    if (clamp_toi_[i] < 1 && particles.inverse_mass(i) > 0)
      particles.moving[i].set_xyz(particles.start[i].xyz() + particles.moved(i) * clamp_toi_[i]);
}

// A contact's correction beyond the approach becomes the margin of its particles, if it exceeds the
// speculative margin: at most max_part of the thickness. Older margins decay.
void SurfaceContacts::update_contact_margins() {
  constexpr float max_part = 0.5f, decay = 0.9f, negligible = 1e-6f;  // negligible: m
  for (float& contact_margin : contact_margin_)
    contact_margin = contact_margin > negligible ? decay * contact_margin : 0;
  for (std::size_t c = 0; c < size(); ++c) {
    const float beyond = columns_.normal_sum[c] - max(0.0f, columns_.approach[c]);
    if (!(beyond > speculative_part * columns_.thickness[c])) continue;
    SOUPLE_ASSERT(columns_.thickness[c] >= 0, "no thickness is negative");
    const float contact_margin = min(beyond, max_part * columns_.thickness[c]);
    for (const std::uint32_t* particle : columns_.particle)
      contact_margin_[particle[c]] = max(contact_margin_[particle[c]], contact_margin);
  }
}

// First correction contacts, which conserve momentum. Then the motions of remaining violations are clamped.
std::size_t SurfaceContacts::keep_apart(const ParticleView& particles, const Substep& substep,
                                        Threads& threads) {
  if (!pairs_.any()) return 0;
  constexpr int correction_passes = 20, passes = 30;
  correction_pair_.clear(), correction_toi_.clear();
  std::size_t count = 0;
  reset_colors_from(pairs_.update(particles, substep.h, threads));
  if (step_.detection == Detection::discrete) {
    pairs_.measure(particles, threads);
    pairs_.end_substep();
    return 0;
  }
  find_violations(particles, threads);
  for (int pass = 0; pass < passes && !violations_.empty(); ++pass) {
    if (pass < correction_passes) {
      solve_corrections(particles);
    } else {
      count += violations_.size();
      clamp_to_toi(particles);
    }
    refind_violations(particles, substep, threads);
  }
  pairs_.end_substep();
  update_contact_margins();
  return count;
}

// --- velocities

void SurfaceContacts::apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                        const Substep&, Threads& threads) {
  if (velocity.empty()) return;
  for (int color = 0; color < color_count(); ++color) {
    const std::size_t first = begin_[2 * static_cast<std::size_t>(color)];
    threads.for_each(color_size(color), grain(), [&](std::size_t begin, std::size_t end) {
      simd_kernels().apply_restitution(pairs_.particle_records(particles), columns_, limits_, &velocity[0].x,
                                       first + begin, first + end);
    });
  }
}

void SurfaceContacts::append_impacts(const Substep&, std::vector<Impact>& out) const {
  for (std::size_t c = 0; c < size(); ++c) {
    const float approach = columns_.approach[c] * limits_.inverse_h;
    if (!(columns_.normal_sum[c] > 0) || !(columns_.restitution[c] > 0) ||
        !(approach > limits_.restitution_threshold))
      continue;
    out.push_back({columns_.particle[0][c],
                   columns_.particle[3][c],
                   {columns_.normal[0][c], columns_.normal[1][c], columns_.normal[2][c]},
                   approach,
                   columns_.restitution[c],
                   {}});
  }
}

// --- reports

ContactReport SurfaceContacts::report() const {
  ContactReport report;
  for (std::size_t c = 0; c < size(); ++c) {
    if (!(columns_.normal_sum[c] > 0)) continue;
    ++report.count;
    report.deepest = max(report.deepest, columns_.depth[c]);
  }
  return report;
}

void SurfaceContacts::events(const ParticleView& particles, std::vector<ContactPush>& out) const {
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  for (std::size_t contact = 0; contact < size(); ++contact) {
    if (!(columns_.normal_sum[contact] > 0)) continue;
    const auto i = [&](std::size_t k) { return columns_.particle[k][contact]; };
    const auto c = [&](std::size_t k) { return columns_.c[k][contact]; };
    const Vec3f normal{columns_.normal[0][contact], columns_.normal[1][contact], columns_.normal[2][contact]};
    // The particle with the largest weight on each side.
    const bool edges = c(0) < 1 || c(1) > 0;
    const std::uint32_t one = edges && c(1) > c(0) ? i(1) : i(0);
    std::size_t other = edges ? 2 : 1;
    for (std::size_t k = other; k < 4; ++k)
      if (c(k) < c(other)) other = k;
    const Vec3f point = particles.relative(one, {}) - normal * (0.5f * columns_.thickness[contact]);
    out.push_back(
        {one, i(other), point, normal,
         (columns_.normal_sum[contact] * limits_.inverse_h + columns_.restitution_velocity[contact]) /
             columns_.inverse_mass[contact]});
  }
  // Not a stable sort, which would allocate: contacts of the same particles are in order of their points.
  std::sort(out.begin() + first, out.end(), [](const ContactPush& a, const ContactPush& b) {
    const auto key = [](const ContactPush& push) {
      return std::tie(push.particle, push.other, push.point.x, push.point.y, push.point.z, push.impulse);
    };
    return key(a) < key(b);
  });
}

Residual SurfaceContacts::residual(const ParticleView& particles) const {
  Residual result;
  visit(particles, [&](const ConstraintState& state) {
    result.largest = max(result.largest, static_cast<double>(state.residual));
    result.sum += static_cast<double>(state.residual);
    ++result.count;
  });
  return result;
}

void SurfaceContacts::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  for (int color = 0; color < color_count(); ++color)
    for (std::size_t c = begin_[2 * static_cast<std::size_t>(color)];
         c < begin_[2 * static_cast<std::size_t>(color) + 2]; ++c) {
      const std::array<std::uint32_t, 4> i{columns_.particle[0][c], columns_.particle[1][c],
                                           columns_.particle[2][c], columns_.particle[3][c]};
      Vec3f apart;
      for (std::size_t k = 1; k < 4; ++k) apart += particles.difference(i[k], i[0]) * columns_.c[k][c];
      const Vec3f n{columns_.normal[0][c], columns_.normal[1][c], columns_.normal[2][c]};
      const float C = dot(n, apart) - columns_.thickness[c];
      visitor({i, color, 0, max(0.0f, -C)});
    }
}

// The caller sets the surfaces again before the next step.
void SurfaceContacts::erase_particles(std::uint32_t, std::uint32_t) {
  set_surfaces({});
}

std::size_t SurfaceContacts::bytes() const {
  std::size_t sum = bytes_of(owner_of_vertex_, vertex_edges_begin_, vertex_edges_, contact_pairs_, color_,
                             used_, pair_, toi_, clamp_toi_);
  for (const ChunkResult& found : chunk_results_) sum += bytes_of(found.pairs);
  return sum + pairs_.bytes() + contacts_.bytes() + corrections_.bytes();
}

}  // namespace souple
