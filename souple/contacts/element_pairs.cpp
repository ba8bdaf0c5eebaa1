#include "souple/contacts/element_pairs.h"

#include "souple/assert.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/state/bytes.h"
#include "souple/untangling/intersection_resolver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
// The search skips boxes that are not finite.
constexpr Bounds infinite_box{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
// Threads test pairs in batches of one size, whose results are joined in order: they do not depend on the
// number of threads.
constexpr std::size_t batch_size = 1024;
constexpr std::size_t particle_grain = 2048;
// Elements that are nearer than their thickness at rest: their thickness is this part of the rest distance.
constexpr float rest_part = 0.9f;
// Margin around the path that follows from a particle's velocity, as parts of the path's length and of the
// radius: contacts may move the particle. `predict` adds the fall by gravity: a particle may fall where the
// rest of its object does not, or the reverse.
constexpr float motion_margin_part = 0.15f, radius_margin_part = 0.25f;
// Margin of a surface's bounds, as a part of its size. The rest of the world may pull a surface far from all
// others by as much within a step, while its particles are not checked.
constexpr float far_surface_margin_part = 0.125f;
// Greatest number of particles whose mean motion stands for that of an object.
constexpr std::uint32_t max_samples = 512;

// Far pairs: more than the contact distance apart by at least this part of their thickness.
constexpr float far_part = 0.4f;

std::size_t batches_of(std::size_t n) {
  return (n + batch_size - 1) / batch_size;
}

Bounds around(const Vec3f& a, const Vec3f& b, float margin) {
  return {{min(a.x, b.x) - margin, min(a.y, b.y) - margin, min(a.z, b.z) - margin},
          {max(a.x, b.x) + margin, max(a.y, b.y) + margin, max(a.z, b.z) + margin}};
}

// Longest edge at rest [m].
float longest_edge(const ContactSurface& surface) {
  double longest = 0;
  const auto measure = [&](std::uint32_t i, std::uint32_t j) {
    longest = std::max(longest, length(surface.rest[i] - surface.rest[j]));
  };
  if (surface.rest.empty()) return 0;
  for (const Edge& edge : surface.edges) measure(edge[0], edge[1]);
  for (const Triangle& t : surface.triangles) measure(t[0], t[1]), measure(t[1], t[2]), measure(t[2], t[0]);
  return static_cast<float>(longest);
}

const std::uint32_t (*quads(const std::vector<NearPair>& pairs))[4] {
  return pairs.empty() ? nullptr : &pairs[0].particle;
}

// Of elements of surfaces with self-collision.
constexpr auto itself = [](std::uint32_t a, std::uint32_t b) { return a == b; };

kernels::ParticleRecords records_of(const ParticleView& particles, std::span<const Vec4f> moved) {
  if (particles.moving.empty()) return {};
  kernels::ParticleRecords records;
  records.moving = &particles.moving[0].x;
  records.corrected = particles.corrected.empty() ? records.moving : &particles.corrected[0].x;
  records.position = particles.form == Form::plain ? records.moving : &particles.position[0].x;
  if (!particles.start.empty()) records.start = &particles.start[0].x;
  if (!moved.empty()) records.moved = &moved[0].x;
  return records;
}

}  // namespace

kernels::ParticleRecords ElementPairs::particle_records(const ParticleView& particles) const {
  kernels::ParticleRecords result = records_of(particles, moved_);
  result.contact_margin = contact_margin_.data();
  result.turn = step_.turn.empty() ? nullptr : &step_.turn.data()->x;
  return result;
}

kernels::ElementPairColumns ElementPairs::columns() {
  return {quads(particle_), thickness_.data(), distance_bound_.data()};
}

void ElementPairs::set_surfaces(std::vector<ContactSurface> surfaces) {
  ParticlePairs excluded = std::move(excluded_);
  const IntersectionResolver* const intersection_resolver = intersection_resolver_;
  *this = {};
  excluded_ = std::move(excluded);
  intersection_resolver_ = intersection_resolver;
  surfaces_ = std::move(surfaces);
  const std::size_t n = surfaces_.size();
  any_ = any_may_collide(surfaces_);
  if (!any_) return;
  overlaps_other_.assign(n, 0);
  std::uint32_t end = 0;
  for (ContactSurface& surface : surfaces_) {
    surface.reserved_end = std::max(surface.reserved_end, surface.end);
    end = std::max(end, surface.reserved_end);
  }
  surface_of_.assign(end, no_surface);
  rest_.assign(end, {});
  longest_edge_.assign(n, 0);
  for (std::uint32_t a = 0; a < n; ++a) {
    const ContactSurface& surface = surfaces_[a];
    std::fill(surface_of_.begin() + surface.begin, surface_of_.begin() + surface.end, a);
    if (!surface.self_collision) continue;
    self_elements_.add_triangles(surface.triangles, surface.begin, a);
    self_elements_.add_edges(surface.edges, surface.begin, a);
    for (std::size_t i = 0; i < surface.rest.size(); ++i)
      rest_[surface.begin + i].set_xyz(Vec3f(surface.rest[i] - surface.rest[0]));
    longest_edge_[a] = longest_edge(surface);
  }
  self_elements_.index_particles();
  for (std::vector<Vec4f>* each : {&velocity_now_, &before_}) each->reserve(end);
  off_path_.reserve(end), remeasured_.reserve(end);
  chunks_.reserve(64);
}

void ElementPairs::set_end(std::size_t surface, std::uint32_t end) {
  if (!any_) return;
  ContactSurface& one = surfaces_[surface];
  SOUPLE_ASSERT(one.begin <= end && end <= one.reserved_end, "particles of the surface's range");
  one.end = end;
  std::fill(surface_of_.begin() + one.begin, surface_of_.begin() + end, static_cast<std::uint32_t>(surface));
  std::fill(surface_of_.begin() + end, surface_of_.begin() + one.reserved_end, no_surface);
}

void ElementPairs::exclude(std::vector<std::array<std::uint32_t, 2>> pairs) {
  const std::size_t n = pairs.size();
  for (std::size_t k = 0; k < n; ++k) pairs.push_back({pairs[k][1], pairs[k][0]});
  std::sort(pairs.begin(), pairs.end());
  SOUPLE_ASSERT(pairs.size() == 2 * n, "each pair stands in both orders");
  excluded_ = std::move(pairs);
}

bool ElementPairs::is_excluded(const NearPair& pair, bool edges) const {
  if (excluded_.empty()) return false;
  const std::size_t first = edges ? 2 : 1;
  for (std::size_t a = 0; a < first; ++a)
    for (std::size_t b = first; b < 4; ++b)
      if (std::binary_search(excluded_.begin(), excluded_.end(),
                             std::array<std::uint32_t, 2>{pair.particle[a], pair.particle[b]}))
        return true;
  return false;
}

void ElementPairs::clear() {
  particle_.clear(), thickness_.clear(), distance_bound_.clear(), is_edges_.clear();
  chunks_.clear();
}

void ElementPairs::begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                              std::span<const float> radius, std::span<const float> contact_margin,
                              const ContactStep& step, Threads& threads) {
  radius_ = radius;
  contact_margin_ = contact_margin;
  step_ = step;
  remaining_ = step.dt;
  find(particles, velocity, threads);
}

// Time that the next search covers [s]: the rest of the step. If particles move faster relative to their
// object, the time in which their mean motion is motion_in_thicknesses times their thickness; then it is a
// multiple of h.
float ElementPairs::horizon(const ParticleView& particles, std::span<const Vec4f> velocity) const {
  constexpr double motion_in_thicknesses = 1;
  if (!(step_.h > 0) || !(step_.h < remaining_)) return remaining_;
  double speeds = 0, thickness = 0;
  for (std::size_t a = 0; a < surfaces_.size(); ++a) {
    const ContactSurface& surface = surfaces_[a];
    if (!surface.self_collision) continue;
    const std::uint32_t stride = (surface.end - surface.begin) / max_samples + 1;
    for (std::uint32_t i = surface.begin; i < surface.end; i += stride) {
      if (particles.inverse_mass(i) == 0) continue;
      speeds += static_cast<double>(length(velocity[i].xyz() - mean_velocity_[a]));
      thickness += 2 * static_cast<double>(max(radius_[i], min_thickness));
    }
  }
  const double h = static_cast<double>(step_.h), remaining = static_cast<double>(remaining_);
  if (!(speeds * remaining > motion_in_thicknesses * thickness)) return remaining_;
  return static_cast<float>(
      min(remaining, max(1.0, std::floor(motion_in_thicknesses * thickness / speeds / h)) * h));
}

void ElementPairs::find(const ParticleView& particles, std::span<const Vec4f> velocity, Threads& threads) {
  find_means(particles, velocity);
  covered_ = horizon(particles, velocity);
  const float dt = covered_;
  elapsed_ = 0;
  predict_all(particles, velocity, dt, threads);
  select_inter_object_elements();
  self_finder_.find(self_elements_, relative_boxes_, itself, particles.position, self_pairs_, threads);
  const auto others = [this](std::uint32_t a, std::uint32_t b) { return collides_with_other(a, b); };
  inter_object_finder_.find(inter_object_elements_, boxes_, others, particles.position, inter_object_pairs_,
                            threads);
  clear();
  valid_from_.assign(surface_of_.size(), 0);
  add_found(particles, dt, threads);
}

// --- boxes

Vec3d ElementPairs::mean_position(const ContactSurface& surface, const ParticleView& particles) const {
  Vec3d sum;
  double count = 0;
  const std::uint32_t stride = (surface.end - surface.begin) / max_samples + 1;
  for (std::uint32_t i = surface.begin; i < surface.end; i += stride) {
    if (particles.inverse_mass(i) == 0) continue;
    sum += Vec3d(particles.relative(i, {}));
    ++count;
  }
  return count > 0 ? sum / count : sum;
}

// Mean velocities and positions of the particles that can move.
void ElementPairs::find_means(const ParticleView& particles, std::span<const Vec4f> velocity) {
  mean_velocity_.assign(surfaces_.size(), {});
  shift_.assign(surfaces_.size(), {});
  mean_position_.assign(surfaces_.size(), {});
  for (std::size_t a = 0; a < surfaces_.size(); ++a) {
    Vec3d sum;
    double count = 0;
    const ContactSurface& surface = surfaces_[a];
    const std::uint32_t stride = (surface.end - surface.begin) / max_samples + 1;
    for (std::uint32_t i = surface.begin; i < surface.end; i += stride) {
      if (particles.inverse_mass(i) == 0) continue;
      sum += Vec3d(velocity[i].xyz());
      ++count;
    }
    const Vec3f mean(count > 0 ? sum / count : sum);
    if (is_finite(mean)) mean_velocity_[a] = mean;
    mean_position_[a] = mean_position(surface, particles);
  }
}

void ElementPairs::find_shift(const ParticleView& particles) {
  for (std::size_t a = 0; a < surfaces_.size(); ++a)
    if (surfaces_[a].self_collision)
      shift_[a] = Vec3f(mean_position(surfaces_[a], particles) - mean_position_[a]);
}

void ElementPairs::predict_all(const ParticleView& particles, std::span<const Vec4f> velocity, float dt,
                               Threads& threads) {
  const std::size_t n = surface_of_.size();
  boxes_.resize(n), relative_boxes_.resize(n), path_.resize(n), predicted_velocity_.resize(n);
  threads.for_each(n, particle_grain, [&](std::size_t i, std::size_t end) {
    for (; i < end; ++i) {
      boxes_[i] = infinite_box;
      if (surface_of_[i] != no_surface)
        predict(static_cast<std::uint32_t>(i), particles.relative(i, {}), velocity[i].xyz(), 0, dt,
                radius_margin_part * max(radius_[i], 0.0f));
    }
  });
}

// The path of a particle that is at x at the time `since` after pairs were found and moves with v for dt.
void ElementPairs::predict(std::uint32_t i, const Vec3f& x, const Vec3f& v, float since, float dt,
                           float margin) {
  const Vec3f relative_v = v - mean_velocity_[surface_of_[i]], relative_x = x - shift_[surface_of_[i]];
  const float contact_distance = max(radius_[i], min_thickness) * (1 + speculative_part) + contact_margin_[i];
  const float fall = 0.5f * step_.gravity * dt * dt, relative_length = dt * length(relative_v);
  PredictedPath& path = path_[i];
  path = {x - v * since, relative_x - relative_v * since,
          margin + 2 * fall + motion_margin_part * dt * length(v),
          margin + min(fall, relative_length) + motion_margin_part * relative_length, since + 1.01f * dt};
  boxes_[i] = around(x, x + v * dt, contact_distance + path.margin);
  relative_boxes_[i] =
      around(relative_x, relative_x + relative_v * dt, contact_distance + path.relative_margin);
  predicted_velocity_[i].set_xyz(v);
}

bool ElementPairs::is_on_path(std::uint32_t i, const Vec3f& x) const {
  const std::uint32_t surface = surface_of_[i];
  SOUPLE_ASSERT(surface != no_surface, "a particle of a surface");
  const PredictedPath& path = path_[i];
  if (elapsed_ > path.valid_until) return false;
  const Vec3f v = predicted_velocity_[i].xyz();
  const auto within = [](const Vec3f& d, float margin) { return length_squared(d) <= margin * margin; };
  if (overlaps_other_[surface] != 0 && !within(x - (path.origin + v * elapsed_), path.margin)) return false;
  if (!surfaces_[surface].self_collision) return true;
  return within(x - shift_[surface] - (path.relative_origin + (v - mean_velocity_[surface]) * elapsed_),
                path.relative_margin);
}

// Selects the elements of surfaces whose bounds overlap those of a surface that they may collide with.
void ElementPairs::select_inter_object_elements() {
  const std::size_t n = surfaces_.size();
  surface_bounds_.assign(n, {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}});
  for (std::size_t a = 0; a < n; ++a) {
    Bounds& bounds = surface_bounds_[a];
    for (std::uint32_t i = surfaces_[a].begin; i < surfaces_[a].end; ++i) bounds = united(bounds, boxes_[i]);
    const Vec3f size = bounds.hi - bounds.lo;
    bounds = around(bounds.lo, bounds.hi, far_surface_margin_part * max(size.x, max(size.y, size.z)));
  }
  overlaps_other_now_.assign(n, 0);
  for (const auto& [a, b] : surface_sweep_.find(surface_bounds_))
    if (collides_with_other(a, b)) overlaps_other_now_[a] = overlaps_other_now_[b] = 1;
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

// Finds particles that have left their paths. Positions of surfaces far from all others are not checked
// within a step; the margin of their bounds covers their motion.
void ElementPairs::find_off_path(const ParticleView& particles, Threads& threads) {
  find_shift(particles);
  const std::size_t n = surface_of_.size(), chunks = batches_of(n);
  for (std::size_t c = off_path_of_chunk_.size(); c < chunks; ++c)
    off_path_of_chunk_.emplace_back().reserve(batch_size);
  threads.for_each(chunks, 2, [&](std::size_t c, std::size_t last) {
    for (; c < last; ++c) {
      off_path_of_chunk_[c].clear();
      for (std::size_t k = c * batch_size; k < std::min(n, (c + 1) * batch_size); ++k) {
        const auto i = static_cast<std::uint32_t>(k);
        if (surface_of_[i] != no_surface && !is_on_path(i, particles.relative(i, {})))
          off_path_of_chunk_[c].push_back(i);
      }
    }
  });
  off_path_.clear();
  for (std::size_t c = 0; c < chunks; ++c)
    off_path_.insert(off_path_.end(), off_path_of_chunk_[c].begin(), off_path_of_chunk_[c].end());
}

std::size_t ElementPairs::update(const ParticleView& particles, float h, Threads& threads) {
  const bool over = covered_ <= -0.5f * h;
  if (!over) find_off_path(particles, threads);
  return refind(particles, h, over, threads);
}

// Compares all particles of a surface with one shift, that of the last update of all particles.
std::size_t ElementPairs::update(const ParticleView& particles, float h,
                                 std::span<const std::uint32_t> particles_moved, Threads& threads) {
  off_path_.clear();
  for (const std::uint32_t i : particles_moved)
    if (!is_on_path(i, particles.relative(i, {}))) off_path_.push_back(i);
  return refind(particles, h, false, threads);
}

std::size_t ElementPairs::refind(const ParticleView& particles, float h, bool over, Threads& threads) {
  // For a fifth of all particles, a search for their pairs alone takes as long as a search for all pairs.
  constexpr std::size_t refind_all_divisor = 5;
  const bool all = over || off_path_.size() > surface_of_.size() / refind_all_divisor + 8;
  if (!all && off_path_.empty()) return size();
  const ParticleView before = rewind(particles, h);
  if (all) {
    refind_all(before, h, threads);
    find_shift(particles);
    return 0;
  }
  const std::size_t first = size();
  refind_off_path(before, h, threads);
  return first;
}

// Returns the particles at the substep's start. Sets velocity_now_ to their mean velocities since then.
ParticleView ElementPairs::rewind(const ParticleView& particles, float h) {
  velocity_now_.resize(surface_of_.size());
  for (std::size_t i = 0; i < velocity_now_.size(); ++i) velocity_now_[i].set_xyz(particles.moved(i) / h);
  before_.assign(particles.start.begin(), particles.start.end());
  ParticleView before = particles;
  before.moving = before_;
  if (particles.form == Form::plain) before.position = before_;
  return before;
}

// Searches for all pairs, for the rest of the step.
void ElementPairs::refind_all(const ParticleView& before, float h, Threads& threads) {
  remaining_ = max(remaining_ + h, h);
  find(before, velocity_now_, threads);
  begin_substep(h);
}

// Searches for the pairs of the particles in off_path_. Contacts moved these particles, so a prediction of
// their motion is valid for a short time only.
void ElementPairs::refind_off_path(const ParticleView& before, float h, Threads& threads) {
  constexpr float covered_substeps = 3;
  const float dt = max(min(covered_ + h, covered_substeps * h), h);
  saved_shift_ = shift_;
  find_shift(before);
  for (const std::uint32_t i : off_path_) {
    predict(i, before.relative(i, {}), velocity_now_[i].xyz(), elapsed_ - h, dt,
            0.5f * max(radius_[i], 0.0f));
    valid_from_[i] = static_cast<std::uint32_t>(size());
  }
  shift_.swap(saved_shift_);
  self_finder_.find_moved(off_path_, relative_boxes_, itself, before.position, self_pairs_, threads);
  const auto others = [this](std::uint32_t a, std::uint32_t b) { return collides_with_other(a, b); };
  inter_object_finder_.find_moved(off_path_, boxes_, others, before.position, inter_object_pairs_, threads);
  add_found(before, dt, threads);
}

// --- pairs

// Keeps the pairs that can come into contact within dt.
void ElementPairs::add_batch(Batch& batch, std::span<const NearPair> pairs, bool edges, bool inter_object,
                             const ParticleView& particles, float dt) const {
  const kernels::ElementPairKernels& kernels = kernels::find_element_pair_kernels(instruction_set());
  const std::size_t kind = edges ? 1 : 0;
  float distance[batch_size], thickness[batch_size], range[batch_size];
  kernels::ParticleRecords records = records_of(particles, predicted_velocity_);
  records.contact_margin = contact_margin_.data();
  const kernels::PredictionMargins margins{
      radius_.data(), inter_object ? &path_[0].margin : &path_[0].relative_margin,
      sizeof(PredictedPath) / sizeof(float), min_thickness, speculative_part};
  kernels.ranges[kind](records, margins, dt, &pairs[0].particle, 0, pairs.size(), thickness, range);
  kernels.distances[kind](records, &pairs[0].particle, 0, pairs.size(), distance);
  batch.near.count = batch.far.count = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (distance[k] > range[k] || is_excluded(pairs[k], edges)) continue;
    if (intersection_resolver_ && intersection_resolver_->exempts(pairs[k], edges)) continue;
    (distance[k] > (1 + speculative_part + far_part) * thickness[k] ? batch.far : batch.near)
        .add(pairs[k], thickness[k], distance[k]);
  }
  if (inter_object) return;
  limit_to_rest_distance(batch.near, edges);
  limit_to_rest_distance(batch.far, edges);
}

// Limits the thickness of pairs of one surface: contacts keep them no farther apart than at rest.
void ElementPairs::limit_to_rest_distance(List& list, bool edges) const {
  NearPair near[batch_size];
  std::size_t which[batch_size], count = 0;
  for (std::size_t k = 0; k < list.count; ++k) {
    const auto& i = list.particle[k].particle;
    const std::uint32_t surface = surface_of_[i[0]];
    const float near_enough = list.thickness[k] / rest_part + 2 * longest_edge_[surface];
    if (surfaces_[surface].rest.empty() ||
        length_squared(rest_[i[0]].xyz() - rest_[i[3]].xyz()) > near_enough * near_enough)
      continue;
    near[count] = list.particle[k];
    which[count++] = k;
  }
  if (count == 0) return;
  float distance[batch_size];
  kernels::ParticleRecords at_rest;
  at_rest.position = &rest_[0].x;
  at_rest.moving = const_cast<float*>(at_rest.position);  // only read
  const kernels::ElementPairKernels& kernels = kernels::find_element_pair_kernels(instruction_set());
  kernels.distances[edges ? 1 : 0](at_rest, &near[0].particle, 0, count, distance);
  for (std::size_t n = 0; n < count; ++n)
    list.thickness[which[n]] = min(list.thickness[which[n]], rest_part * distance[n]);
}

void ElementPairs::add(std::span<const NearPair> pairs, bool edges, bool inter_object,
                       const ParticleView& particles, float dt, Threads& threads) {
  const std::size_t count = batches_of(pairs.size());
  if (batches_.size() < count) {
    const std::size_t before = batches_.size();
    batches_.resize(count + count / 2 + 16);
    for (std::size_t b = before; b < batches_.size(); ++b)
      for (List* list : {&batches_[b].near, &batches_[b].far}) {
        list->particle.resize(batch_size);
        list->thickness.resize(batch_size);
        list->distance_bound.resize(batch_size);
      }
  }
  threads.for_each(count, 1, [&](std::size_t b, std::size_t last) {
    for (; b < last; ++b)
      add_batch(batches_[b],
                pairs.subspan(b * batch_size, std::min(batch_size, pairs.size() - b * batch_size)), edges,
                inter_object, particles, dt);
  });
  append(&Batch::near, count, edges, inter_object, threads);
  append(&Batch::far, count, edges, inter_object, threads);
}

// Appends the lists of all batches to the columns, and divides the new pairs into chunks.
void ElementPairs::append(List Batch::*list, std::size_t batches, bool edges, bool inter_object,
                          Threads& threads) {
  const std::size_t begin = size();
  std::size_t sum = begin;
  for (std::size_t b = 0; b < batches; ++b) {
    (batches_[b].*list).offset = sum;
    sum += (batches_[b].*list).count;
  }
  resize_with_spare(particle_, sum);
  resize_with_spare(is_edges_, sum);
  for (std::vector<float>* column : {&thickness_, &distance_bound_}) resize_with_spare(*column, sum);
  threads.for_each(batches, 1, [&](std::size_t b, std::size_t last) {
    for (; b < last; ++b) {
      const List& from = batches_[b].*list;
      std::copy_n(from.particle.data(), from.count, particle_.data() + from.offset);
      std::copy_n(from.thickness.data(), from.count, thickness_.data() + from.offset);
      std::copy_n(from.distance_bound.data(), from.count, distance_bound_.data() + from.offset);
      std::fill_n(is_edges_.data() + from.offset, from.count, edges ? 1 : 0);
    }
  });
  for (std::size_t next = begin; next < sum; next += chunk_size) {
    Chunk chunk;
    chunk.begin = static_cast<std::uint32_t>(next);
    chunk.end = static_cast<std::uint32_t>(std::min(sum, next + chunk_size));
    chunk.edges = edges, chunk.inter_object = inter_object;
    SOUPLE_ASSERT(chunk.begin < chunk.end, "a chunk has pairs");
    chunks_.push_back(chunk);
  }
}

void ElementPairs::add_found(const ParticleView& particles, float dt, Threads& threads) {
  const std::size_t first = chunks_.size();
  add(self_pairs_.vertex_triangle, false, false, particles, dt, threads);
  add(inter_object_pairs_.vertex_triangle, false, true, particles, dt, threads);
  add(self_pairs_.edge_edge, true, false, particles, dt, threads);
  add(inter_object_pairs_.edge_edge, true, true, particles, dt, threads);
  measure_new_chunks(first, threads);
}

// --- chunks that need no test

void ElementPairs::measure_new_chunks(std::size_t first, Threads& threads) {
  resize_with_spare(blocks_, chunks_.size());
  threads.for_each(chunks_.size() - first, 4, [&](std::size_t c, std::size_t last) {
    for (; c < last; ++c) {
      Chunk& chunk = chunks_[first + c];
      auto& blocks = blocks_[first + c];
      std::array<std::uint32_t, 64> seen;  // cache of blocks that were added, by their last bits
      seen.fill(no_surface);
      const auto add = [&](std::uint32_t block) {
        if (seen[block % seen.size()] == block) return;
        seen[block % seen.size()] = block;
        for (std::uint32_t k = chunk.blocks; k-- > 0;)
          if (blocks[k] == block) return;
        if (chunk.blocks == max_blocks) {
          chunk.blocks = too_many;
        } else {
          blocks[chunk.blocks++] = block;
        }
      };
      chunk.min_distance_bound = chunk.min_gap_bound = infinity;
      for (std::uint32_t k = chunk.begin; k < chunk.end; ++k) {
        for (const std::uint32_t i : particle_[k].particle)
          if (chunk.blocks != too_many) add(i / static_cast<std::uint32_t>(block_size));
        chunk.min_distance_bound = min(chunk.min_distance_bound, distance_bound_[k]);
        chunk.min_gap_bound =
            min(chunk.min_gap_bound, distance_bound_[k] - (1 + speculative_part) * thickness_[k]);
      }
    }
  });
}

void ElementPairs::measure(const ParticleView& particles, Threads& threads) {
  const std::size_t n = surface_of_.size(), blocks = (n + block_size - 1) / block_size;
  moved_.resize(n), block_motion_.resize(blocks), block_relative_motion_.resize(blocks);
  block_contact_margin_.resize(blocks);
  mean_motion_.assign(surfaces_.size(), {});
  for (std::size_t a = 0; a < surfaces_.size(); ++a) {
    Vec3d sum;
    double count = 0;
    const std::uint32_t stride = (surfaces_[a].end - surfaces_[a].begin) / max_samples + 1;
    for (std::uint32_t i = surfaces_[a].begin; i < surfaces_[a].end; i += stride, ++count)
      sum += Vec3d(particles.moved(i));
    if (count > 0) mean_motion_[a] = Vec3f(sum / count);
  }
  threads.for_each(blocks, particle_grain / block_size, [&](std::size_t b, std::size_t last) {
    for (; b < last; ++b) {
      float farthest = 0, max_relative = 0, contact_margin = 0;
      for (std::size_t i = b * block_size; i < std::min(n, (b + 1) * block_size); ++i) {
        contact_margin = max(contact_margin, contact_margin_[i]);
        const Vec3f moved = particles.moved(i);
        moved_[i].set_xyz(moved);
        farthest = max(farthest, length_squared(moved));
        if (surface_of_[i] != no_surface)
          max_relative = max(max_relative, length_squared(moved - mean_motion_[surface_of_[i]]));
      }
      block_motion_[b] = sqrt(farthest), block_relative_motion_[b] = sqrt(max_relative);
      block_contact_margin_[b] = contact_margin;
    }
  });
  was_moved_.assign(n, 0);
  remeasured_.clear();
  max_motion_ = max_relative_motion_ = max_contact_margin_ = 0;
  for (const float farthest : block_motion_) max_motion_ = max(max_motion_, farthest);
  for (const float farthest : block_relative_motion_)
    max_relative_motion_ = max(max_relative_motion_, farthest);
  for (const float contact_margin : block_contact_margin_)
    max_contact_margin_ = max(max_contact_margin_, contact_margin);
}

float ElementPairs::contact_margin(std::size_t index) const {
  const Chunk& chunk = chunks_[index];
  if (max_contact_margin_ <= 0 || chunk.blocks == too_many) return max_contact_margin_;
  float most = 0;
  for (std::uint32_t k = 0; k < chunk.blocks; ++k) most = max(most, block_contact_margin_[blocks_[index][k]]);
  return most;
}

void ElementPairs::measure(const ParticleView& particles, std::span<const std::uint32_t> particles_moved) {
  for (const std::uint32_t i : remeasured_) was_moved_[i] = 0;
  remeasured_.assign(particles_moved.begin(), particles_moved.end());
  for (const std::uint32_t i : particles_moved) {
    was_moved_[i] = 1;
    const Vec3f moved = particles.moved(i);
    moved_[i].set_xyz(moved);
    float &farthest = block_motion_[i / block_size], &max_relative = block_relative_motion_[i / block_size];
    farthest = max(farthest, length(moved));
    if (surface_of_[i] != no_surface)
      max_relative = max(max_relative, length(moved - mean_motion_[surface_of_[i]]));
    max_motion_ = max(max_motion_, farthest);
    max_relative_motion_ = max(max_relative_motion_, max_relative);
  }
}

// Largest motion of a point of one element relative to a point of the other element [m].
float ElementPairs::relative_motion(const NearPair& pair, bool edges) const {
  const auto squared = [&](std::size_t a, std::size_t b) {
    return length_squared(moved_[pair.particle[a]].xyz() - moved_[pair.particle[b]].xyz());
  };
  const float third = edges ? max(squared(1, 2), squared(1, 3)) : squared(0, 1);
  return sqrt(max(third, max(squared(0, 2), squared(0, 3))));
}

bool ElementPairs::any_moved_by(float part, const Chunk& chunk) const {
  constexpr float rounding = 1e-6f;
  for (std::size_t pair = chunk.begin; pair < chunk.end; ++pair)
    if (was_moved(pair) && relative_motion(particle_[pair], chunk.edges) * (1 + rounding) >=
                               part * (distance_bound_[pair] - chunk.motion_since))
      return true;
  return false;
}

// Upper bound of the relative motions of a chunk's pairs, rounding included [m].
float ElementPairs::motion_bound(const Chunk& chunk) const {
  constexpr float both = 2.001f;
  if (chunk.blocks == too_many) return both * (chunk.inter_object ? max_motion_ : max_relative_motion_);
  const std::vector<float>& moved = chunk.inter_object ? block_motion_ : block_relative_motion_;
  const auto& blocks = blocks_[static_cast<std::size_t>(&chunk - chunks_.data())];
  float farthest = 0;
  for (std::uint32_t k = 0; k < chunk.blocks; ++k) farthest = max(farthest, moved[blocks[k]]);
  return both * farthest;
}

std::size_t ElementPairs::find_near(std::size_t index, const kernels::NearRule& rule,
                                    const kernels::ParticleRecords& records, std::uint32_t* found) {
  Chunk& chunk = chunks_[index];
  const float far = rule.thickness_part > 0
                        ? chunk.min_gap_bound - chunk.motion_since
                        : rule.bound_part * (chunk.min_distance_bound - chunk.motion_since);
  if (motion_bound(chunk) + rule.contact_margin < far) return 0;
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
  for (Chunk& chunk : chunks_) chunk.motion_since += motion_bound(chunk);
}

std::size_t ElementPairs::bytes() const {
  std::size_t sum =
      bytes_of(surfaces_, surface_of_, rest_, boxes_, relative_boxes_, path_, predicted_velocity_,
               self_pairs_.vertex_triangle, self_pairs_.edge_edge, inter_object_pairs_.vertex_triangle,
               inter_object_pairs_.edge_edge, velocity_now_, before_, particle_, thickness_, distance_bound_,
               is_edges_, valid_from_, chunks_, blocks_, moved_, was_moved_);
  for (const Batch& batch : batches_)
    for (const List* list : {&batch.near, &batch.far})
      sum += bytes_of(list->particle, list->thickness, list->distance_bound);
  return sum + self_elements_.bytes() + inter_object_elements_.bytes() + self_finder_.bytes() +
         inter_object_finder_.bytes();
}

}  // namespace souple
