#include "souple/contacts/surfaces/element_pairs.h"

#include "souple/assert.h"
#include "souple/contacts/contact_law.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/intersections/intersection_resolver.h"
#include "souple/math/sentinels.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

// Threads test pairs in batches of one size, whose results are joined in order: they do not depend on the
// number of threads.
constexpr std::size_t batch_size = 1024;
// Margin of a surface's bounds, as a part of its size. The rest of the world may pull a surface far from all
// others by as much within a step, while its particles are not checked.
constexpr float far_surface_margin_part = 0.125f;
// Pairs that a search may find: for each element that may touch itself or another surface, and for any scene. A sheet
// that collapses in folds has 25.
constexpr std::size_t self_pairs_of_element = 32, other_pairs_of_element = 20, pairs_of_any = 65536;
// Far pairs: more than the contact distance apart by at least this part of their thickness.
constexpr float far_part = 0.4f;

std::size_t batches_of(std::size_t n) {
  return (n + batch_size - 1) / batch_size;
}

// Compares elements of surfaces with self-collision.
constexpr auto itself = [](std::uint32_t a, std::uint32_t b) { return a == b; };

kernels::ParticleRecords records_of(const ParticleView& particles, std::span<const Vec4f> moved) {
  if (particles.moving.empty()) return {};
  kernels::ParticleRecords records;
  records.moving = &particles.moving[0].x;
  records.corrected = particles.corrected.empty() ? records.moving : &particles.corrected[0].x;
  records.position = &particles.position[0].x;
  if (!particles.start.empty()) records.start = &particles.start[0].x;
  if (!moved.empty()) records.moved = &moved[0].x;
  return records;
}

}  // namespace

kernels::ParticleRecords ElementPairs::particle_records(const ParticleView& particles) const {
  kernels::ParticleRecords result = records_of(particles, bounds_.moved());
  result.contact_margin = paths_.contact_margin().data();
  result.turn = step_.turn.empty() ? nullptr : &step_.turn.data()->x;
  return result;
}

ElementPairs::ElementPairs(std::vector<ContactSurface> surfaces, ParticlePairs joined,
                           const IntersectionResolver* intersection_resolver)
    : surfaces_(std::move(surfaces), std::move(joined)), intersection_resolver_(intersection_resolver) {
  if (!surfaces_.any()) return;
  overlaps_other_.assign(surfaces_.size(), 0);
  for (std::uint32_t a = 0; a < surfaces_.size(); ++a) {
    const ContactSurface& surface = surfaces_[a];
    if (!surface.self_collision) continue;
    self_elements_.add_triangles(surface.triangles, surface.begin, a);
    self_elements_.add_edges(surface.edges, surface.begin, a);
  }
  self_elements_.index_particles();
  const std::size_t particles = surfaces_.particle_count();
  for (std::vector<Vec4f>* each : {&velocity_now_, &before_}) each->reserve(particles);
  paths_ = PredictedPaths(particles);
  bounds_ = MotionBounds(particles);
}

void ElementPairs::begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                              std::span<const float> radius, std::span<const float> contact_margin,
                              const ContactStep& step, Threads& threads) {
  paths_.begin_step(radius, contact_margin, step.gravity);
  step_ = step;
  remaining_ = step.dt;
  limit_.begin_step(surfaces_);
  find(particles, velocity, threads);
}

// Time that the next search covers [s]: the rest of the step. If particles move faster relative to their object, it is
// the time in which their mean motion is motion_in_thicknesses times their thickness. It is then a multiple of h.
float ElementPairs::horizon(const ParticleView& particles, std::span<const Vec4f> velocity) const {
  constexpr double motion_in_thicknesses = 1;
  if (!(step_.h > 0) || !(step_.h < remaining_)) return remaining_;
  double speeds = 0, thickness = 0;
  for (std::size_t a = 0; a < surfaces_.size(); ++a) {
    if (!surfaces_[a].self_collision) continue;
    surfaces_.for_each_sample(a, [&](std::uint32_t i) {
      if (particles.inverse_mass(i) == 0) return;
      speeds += static_cast<double>(length(paths_.relative_velocity(velocity[i].xyz(), a)));
      thickness += static_cast<double>(paths_.thickness(i));
    });
  }
  const double h = static_cast<double>(step_.h), remaining = static_cast<double>(remaining_);
  if (!(speeds * remaining > motion_in_thicknesses * thickness)) return remaining_;
  return static_cast<float>(
      min(remaining, max(1.0, std::floor(motion_in_thicknesses * thickness / speeds / h)) * h));
}

std::size_t ElementPairs::budget() const {
  const auto elements = [](const SurfaceElements& all) { return all.vertices().size() + all.edges().size(); };
  return pairs_of_any + self_pairs_of_element * elements(self_elements_) +
         other_pairs_of_element * elements(inter_object_elements_);
}

void ElementPairs::find(const ParticleView& particles, std::span<const Vec4f> velocity, Threads& threads) {
  const float h = step_.h > 0 ? min(step_.h, remaining_) : remaining_;
  limit_.update_frame(surfaces_, overlaps_other_, particles, velocity);
  std::span<const Vec4f> v = limit_.limited(surfaces_, particles, velocity, h);
  paths_.find_means(surfaces_, particles, v);
  paths_.set_frame(limit_.frame());
  float dt = limit_.is_active() ? h : horizon(particles, v);
  bool found = find_within(dt, budget(), particles, v, threads);
  if (!found && dt > h) found = find_within(dt = h, budget(), particles, v, threads);
  while (!found) {
    // Pairs that are near although they hardly move have to be found.
    const bool helps = limit_.shorten(surfaces_, overlaps_other_, particles, velocity, h);
    v = limit_.limited(surfaces_, particles, velocity, h);
    paths_.find_means(surfaces_, particles, v);
    paths_.set_frame(limit_.frame());
    if (!helps && !limit_.is_active()) dt = horizon(particles, v);
    found = find_within(dt, helps ? budget() : NearPairFinder::unlimited, particles, v, threads);
  }
  covered_ = dt;
  pairs_.clear(surfaces_.particle_count());
  add_found(particles, dt, threads);
}

// Searches for the pairs within dt. Returns false if there are more than `most`.
bool ElementPairs::find_within(float dt, std::size_t most, const ParticleView& particles,
                               std::span<const Vec4f> velocity, Threads& threads) {
  paths_.predict_all(surfaces_, particles, velocity, dt, threads);
  select_inter_object_elements();
  const auto others = [this](std::uint32_t a, std::uint32_t b) {
    return surfaces_.collides_with_other(a, b);
  };
  return self_finder_.find(self_elements_, paths_.relative_boxes(), itself, particles.position, self_pairs_,
                           threads, most) &&
         inter_object_finder_.find(inter_object_elements_, paths_.boxes(), others, particles.position,
                                   inter_object_pairs_, threads, most);
}

// Selects the elements of surfaces whose bounds overlap those of a surface that they may collide with.
void ElementPairs::select_inter_object_elements() {
  const std::size_t n = surfaces_.size();
  surface_bounds_.assign(n, {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}});
  for (std::size_t a = 0; a < n; ++a) {
    Bounds& bounds = surface_bounds_[a];
    for (std::uint32_t i = surfaces_[a].begin; i < surfaces_[a].end; ++i)
      bounds = united(bounds, paths_.boxes()[i]);
    const Vec3f size = bounds.hi - bounds.lo;
    bounds = around(bounds.lo, bounds.hi, far_surface_margin_part * max(size.x, max(size.y, size.z)));
  }
  overlaps_other_now_.assign(n, 0);
  for (const auto& [a, b] : surface_sweep_.find(surface_bounds_))
    if (surfaces_.collides_with_other(a, b)) overlaps_other_now_[a] = overlaps_other_now_[b] = 1;
  if (overlaps_other_now_ == overlaps_other_) return;
  overlaps_other_ = overlaps_other_now_;
  inter_object_elements_.clear();
  for (std::uint32_t a = 0; a < n; ++a) {
    if (overlaps_other_[a] == 0) continue;
    const ContactSurface& surface = surfaces_[a];
    inter_object_elements_.add_triangles(surface.triangles, surface.begin, a);
    inter_object_elements_.add_edges(surface.edges, surface.begin, a);
    if (surface.particles_only) inter_object_elements_.add_particles(surface.begin, surface.reserved_end, a);
  }
  inter_object_elements_.index_particles();
}

// --- searches within a step

std::size_t ElementPairs::update(const ParticleView& particles, float h, Threads& threads) {
  const bool over = covered_ <= -0.5f * h;
  limit_.apply(surfaces_, particles, h, threads);
  if (!over) paths_.find_off_path(surfaces_, overlaps_other_, particles, threads);
  return refind(particles, h, over, threads);
}

std::size_t ElementPairs::update(const ParticleView& particles, float h,
                                 std::span<const std::uint32_t> particles_moved, Threads& threads) {
  limit_.apply(surfaces_, particles, h, threads);
  paths_.find_off_path(surfaces_, overlaps_other_, particles, particles_moved);
  return refind(particles, h, false, threads);
}

std::size_t ElementPairs::refind(const ParticleView& particles, float h, bool over, Threads& threads) {
  // For a fifth of all particles, a search for their pairs alone takes as long as a search for all pairs.
  constexpr std::size_t refind_all_divisor = 5;
  // Pairs that were replaced stay until the next search of all. They may take as much as so many searches.
  constexpr std::size_t kept_budgets = 2;
  const std::size_t off_path = paths_.off_path().size();
  const bool all = over || off_path > surfaces_.particle_count() / refind_all_divisor + 8 ||
                   (off_path > 0 && size() > kept_budgets * budget());
  if (!all && off_path == 0) return size();
  const ParticleView before = rewind(particles, h);
  const std::size_t first = size();
  if (!all && refind_off_path(before, h, threads)) return first;
  refind_all(before, h, threads);
  limit_.apply(surfaces_, particles, h, threads);
  paths_.find_shift(surfaces_, particles);
  return 0;
}

// Returns the particles at the substep's start. Sets velocity_now_ to their mean velocities since then.
ParticleView ElementPairs::rewind(const ParticleView& particles, float h) {
  velocity_now_.resize(surfaces_.particle_count());
  for (std::size_t i = 0; i < velocity_now_.size(); ++i) velocity_now_[i].set_xyz(particles.moved(i) / h);
  before_.assign(particles.start.begin(), particles.start.end());
  ParticleView before = particles;
  before.moving = before_;
  return before;
}

// Searches for all pairs, for the rest of the step.
void ElementPairs::refind_all(const ParticleView& before, float h, Threads& threads) {
  remaining_ = max(remaining_ + h, h);
  find(before, velocity_now_, threads);
  begin_substep(h);
}

// Searches for the pairs of the particles that left their paths. Contacts moved these particles, so a prediction of
// their motion is valid for a short time only.
// Returns false if there are too many.
bool ElementPairs::refind_off_path(const ParticleView& before, float h, Threads& threads) {
  constexpr float covered_substeps = 3;
  const float dt = max(min(covered_ + h, covered_substeps * h), h);
  paths_.predict_off_path(surfaces_, before, velocity_now_, h, dt);
  const std::span<const std::uint32_t> off_path = paths_.off_path();
  const auto others = [this](std::uint32_t a, std::uint32_t b) {
    return surfaces_.collides_with_other(a, b);
  };
  if (!self_finder_.find_moved(off_path, paths_.relative_boxes(), itself, before.position, self_pairs_,
                               threads, budget()) ||
      !inter_object_finder_.find_moved(off_path, paths_.boxes(), others, before.position, inter_object_pairs_,
                                       threads, budget()))
    return false;
  for (const std::uint32_t i : off_path) pairs_.replace_pairs_of(i);
  add_found(before, dt, threads);
  return true;
}

// --- pairs

// Keeps the pairs that can come into contact within dt.
void ElementPairs::add_batch(Batch& batch, std::span<const NearPair> pairs, bool edges, bool inter_object,
                             const ParticleView& particles, float dt) const {
  const kernels::ElementPairKernels& kernels = kernels::find_element_pair_kernels(instruction_set());
  const std::size_t kind = edges ? 1 : 0;
  float distance[batch_size], thickness[batch_size], range[batch_size];
  kernels::ParticleRecords records = records_of(particles, paths_.velocity());
  records.contact_margin = paths_.contact_margin().data();
  kernels.ranges[kind](records, paths_.margins(inter_object), dt, &pairs[0].particle, 0, pairs.size(),
                       thickness, range);
  kernels.distances[kind](records, &pairs[0].particle, 0, pairs.size(), distance);
  batch.near.count = batch.far.count = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (distance[k] > range[k] || surfaces_.are_joined(pairs[k], edges)) continue;
    if (intersection_resolver_ && intersection_resolver_->exempts(pairs[k], edges)) continue;
    (distance[k] > (1 + speculative_part + far_part) * thickness[k] ? batch.far : batch.near)
        .add(pairs[k], thickness[k], distance[k]);
  }
  if (inter_object) return;
  for (List* const list : {&batch.near, &batch.far})
    surfaces_.limit_to_rest_distance(std::span(list->particle).first(list->count), edges,
                                     list->thickness.data());
}

void ElementPairs::add(std::span<const NearPair> pairs, bool edges, bool inter_object,
                       const ParticleView& particles, float dt, Threads& threads) {
  const std::size_t count = batches_of(pairs.size());
  if (batches_.size() < count) {
    const std::size_t before = batches_.size();
    batches_.resize(count + count / 2 + 16);
    for (std::size_t b = before; b < batches_.size(); ++b)
      batches_[b].near.resize(batch_size), batches_[b].far.resize(batch_size);
  }
  threads.each(count, 1, [&](std::size_t b) {
    add_batch(batches_[b], pairs.subspan(b * batch_size, std::min(batch_size, pairs.size() - b * batch_size)),
              edges, inter_object, particles, dt);
  });
  const std::span<Batch> batches = std::span(batches_).first(count);
  pairs_.append(batches, &Batch::near, edges, inter_object, threads);
  pairs_.append(batches, &Batch::far, edges, inter_object, threads);
}

void ElementPairs::add_found(const ParticleView& particles, float dt, Threads& threads) {
  const std::size_t first = chunk_count();
  add(self_pairs_.vertex_triangle, false, false, particles, dt, threads);
  add(inter_object_pairs_.vertex_triangle, false, true, particles, dt, threads);
  add(self_pairs_.edge_edge, true, false, particles, dt, threads);
  add(inter_object_pairs_.edge_edge, true, true, particles, dt, threads);
  bounds_.resize(chunk_count());
  threads.each(chunk_count() - first, 4, [&](std::size_t c) { bounds_.add_chunk(first + c, pairs_); });
}

// --- chunks that need no test

// Few pairs of a chunk have moved particles. Distances are computed of these alone.
std::size_t ElementPairs::find_moved_by(float part, std::size_t index,
                                        const kernels::ParticleRecords& records, std::uint32_t* found) {
  constexpr float rounding = 1e-6f;
  const Chunk& chunk = pairs_.chunks()[index];
  if (!bounds_.may_have_moved(index, chunk)) return 0;
  NearPair near[chunk_size];
  float motion[chunk_size], distance[chunk_size];
  std::size_t count = 0;
  for (std::uint32_t pair = chunk.begin; pair < chunk.end; ++pair) {
    if (!was_moved(pair) || is_replaced(pair)) continue;
    motion[count] = bounds_.of_pair(pairs_.pair(pair), chunk.edges) * (1 + rounding);
    if (!(motion[count] >= part * (pairs_.distance_bound(pair) - chunk.motion_since))) continue;
    near[count] = pairs_.pair(pair);
    found[count++] = pair;
  }
  if (count == 0) return 0;
  kernels::ParticleRecords at_start = records;
  at_start.moving = const_cast<float*>(records.start);  // only read
  kernels::find_element_pair_kernels(instruction_set())
      .distances[chunk.edges ? 1 : 0](at_start, &near[0].particle, 0, count, distance);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < count; ++k) {
    columns().distance_bound[found[k]] = distance[k];
    if (motion[k] >= part * distance[k]) found[kept++] = found[k];
  }
  return kept;
}

std::size_t ElementPairs::find_near(std::size_t index, const kernels::NearRule& rule,
                                    const kernels::ParticleRecords& records, std::uint32_t* found) {
  Chunk& chunk = pairs_.chunks()[index];
  const float far = rule.thickness_part > 0
                        ? chunk.min_gap_bound - chunk.motion_since
                        : rule.bound_part * (chunk.min_distance_bound - chunk.motion_since);
  if (bounds_.of_chunk(index, chunk) + rule.contact_margin < far) return 0;
  const kernels::ElementPairKernels& kernels = kernels::find_element_pair_kernels(instruction_set());
  const kernels::NearPairStatistics statistics = kernels.find_near[chunk.edges ? 1 : 0](
      records, columns(), rule, chunk.motion_since, speculative_part, chunk.begin, chunk.end, found);
  SOUPLE_ASSERT(statistics.found <= chunk.end - chunk.begin, "at most all pairs of the chunk are near");
  chunk.min_distance_bound = statistics.min_distance_bound;
  chunk.min_gap_bound = statistics.min_gap_bound;
  chunk.motion_since = 0;
  return statistics.found;
}

void ElementPairs::end_substep() {
  const std::span<Chunk> chunks = pairs_.chunks();
  for (std::size_t c = 0; c < chunks.size(); ++c) chunks[c].motion_since += bounds_.of_chunk(c, chunks[c]);
}

std::size_t ElementPairs::bytes() const {
  std::size_t sum =
      bytes_of(self_pairs_.vertex_triangle, self_pairs_.edge_edge, inter_object_pairs_.vertex_triangle,
               inter_object_pairs_.edge_edge, velocity_now_, before_);
  for (const Batch& batch : batches_) sum += batch.near.bytes() + batch.far.bytes();
  return sum + surfaces_.bytes() + paths_.bytes() + limit_.bytes() + pairs_.bytes() + bounds_.bytes() +
         self_elements_.bytes() + inter_object_elements_.bytes() + self_finder_.bytes() +
         inter_object_finder_.bytes();
}

}  // namespace souple
