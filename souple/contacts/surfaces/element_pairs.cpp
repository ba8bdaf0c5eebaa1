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
  searches_.resize(surfaces_.size()), overlaps_other_.assign(surfaces_.size(), 0);
  for (std::uint32_t a = 0; a < surfaces_.size(); ++a) {
    const ContactSurface& surface = surfaces_[a];
    searches_[a].elements = surface.reserved_end - surface.begin + surface.edges.size();
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
                              std::span<const std::uint8_t> still, const ContactStep& step,
                              Threads& threads) {
  paths_.begin_step(surfaces_, radius, contact_margin, still, step.gravity);
  bounds_.begin_step(surfaces_, still);
  step_ = step;
  remaining_ = step.dt;
  limit_.begin_step(surfaces_);
  anew_.clear();
  find(particles, velocity, 0, threads);
}

void ElementPairs::begin_substep(float h, bool still_have_margins) {
  bounds_.set_still_have_margins(still_have_margins);
  remaining_ -= h;
  for (Search& search : searches_) search.covered -= h;
  paths_.advance(h);
}

std::span<const std::uint32_t> ElementPairs::drop_replaced(Threads& threads) {
  const std::span<const std::uint32_t> kept = pairs_.drop_replaced();
  if (!kept.empty()) threads.each(chunk_count(), 4, [&](std::size_t c) { bounds_.add_chunk(c, pairs_); });
  return kept;
}

std::span<const IndexRange> ElementPairs::take_searched_anew() {
  taken_anew_.swap(anew_);
  anew_.clear();
  return taken_anew_;
}

// Time that the next search of a surface covers [s]: the rest of the step. If its particles move faster relative to it, it
// is the time in which their mean motion is motion_in_thicknesses times their thickness. It is then a multiple of h.
float ElementPairs::horizon(std::size_t surface, const ParticleView& particles,
                            std::span<const Vec4f> velocity) const {
  constexpr double motion_in_thicknesses = 1;
  if (!surfaces_[surface].self_collision || !(step_.h > 0) || !(step_.h < remaining_)) return remaining_;
  double speeds = 0, thickness = 0;
  surfaces_.for_each_sample(surface, [&](std::uint32_t i) {
    if (particles.inverse_mass(i) == 0) return;
    speeds += static_cast<double>(length(paths_.relative_velocity(velocity[i].xyz(), surface)));
    thickness += static_cast<double>(paths_.thickness(i));
  });
  const double h = static_cast<double>(step_.h), remaining = static_cast<double>(remaining_);
  if (!(speeds * remaining > motion_in_thicknesses * thickness)) return remaining_;
  return static_cast<float>(
      min(remaining, max(1.0, std::floor(motion_in_thicknesses * thickness / speeds / h)) * h));
}

std::size_t ElementPairs::budget() const {
  std::size_t elements = 0;
  for (std::uint32_t a = 0; a < searches_.size(); ++a)
    if (is_searched(a)) elements += searches_[a].elements;
  return pairs_of_any + pairs_of_element * elements;
}

// `ago`: the particles are those of so many seconds before the substep's end.
void ElementPairs::find(const ParticleView& particles, std::span<const Vec4f> velocity, float ago,
                        Threads& threads) {
  const float h = step_.h > 0 ? min(step_.h, remaining_) : remaining_;
  const auto begin = [&](std::span<const Vec4f> v) {
    paths_.find_means(surfaces_, particles, v);
    paths_.set_frame(limit_.frame());
  };
  limit_.update_frame(surfaces_, overlaps_other_, particles, velocity);
  std::span<const Vec4f> v = limit_.limited(surfaces_, particles, velocity, h);
  begin(v);
  bool one_substep = limit_.is_active();
  bool found = find_within(one_substep, budget(), particles, v, ago, threads);
  if (!found && !one_substep) found = find_within(one_substep = true, budget(), particles, v, ago, threads);
  while (!found) {
    // Pairs that are near although they hardly move have to be found.
    const bool helps = limit_.shorten(surfaces_, overlaps_other_, particles, velocity, h);
    v = limit_.limited(surfaces_, particles, velocity, h);
    begin(v);
    if (!helps && !limit_.is_active()) one_substep = false;
    found =
        find_within(one_substep, helps ? budget() : NearPairFinder::unlimited, particles, v, ago, threads);
  }
  pairs_.clear(surfaces_.particle_count());
  add_found(particles, threads);
  pairs_.end_search();
}

// Searches for the pairs of the next substep, or within the surfaces' horizons. Returns false if there are more than `most`.
bool ElementPairs::find_within(bool one_substep, std::size_t most, const ParticleView& particles,
                               std::span<const Vec4f> velocity, float ago, Threads& threads) {
  const float h = step_.h > 0 ? min(step_.h, remaining_) : remaining_;
  for (std::uint32_t a = 0; a < surfaces_.size(); ++a) {
    searches_[a].covered = one_substep ? h : horizon(a, particles, velocity);
    searches_[a].found = 0;
    if (paths_.predict_surface(surfaces_, a, particles, velocity, ago, searches_[a].covered, threads))
      find_bounds(a);
  }
  find_overlaps();
  select_inter_object_elements();
  const auto others = [this](std::uint32_t a, std::uint32_t b) {
    return surfaces_.collides_with_other(a, b);
  };
  return self_finder_.find(self_elements_, paths_.relative_boxes(), itself, particles.position, self_pairs_,
                           threads, most) &&
         inter_object_finder_.find(inter_object_elements_, paths_.boxes(), others, particles.position,
                                   inter_object_pairs_, threads, most);
}

void ElementPairs::find_bounds(std::uint32_t surface) {
  Bounds bounds{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (std::uint32_t i = surfaces_[surface].begin; i < surfaces_[surface].end; ++i)
    bounds = united(bounds, paths_.boxes()[i]);
  const Vec3f size = bounds.hi - bounds.lo;
  searches_[surface].bounds =
      around(bounds.lo, bounds.hi, far_surface_margin_part * max(size.x, max(size.y, size.z)));
}

// Finds the surfaces whose bounds overlap those of a surface that they may collide with. Returns whether their elements
// are at hand.
bool ElementPairs::find_overlaps() {
  surface_bounds_.clear();
  for (Search& search : searches_) surface_bounds_.push_back(search.bounds), search.overlaps_other = false;
  for (const auto& [a, b] : surface_sweep_.find(surface_bounds_))
    if (surfaces_.collides_with_other(a, b)) searches_[a].overlaps_other = searches_[b].overlaps_other = true;
  bool complete = true;
  for (std::size_t a = 0; a < searches_.size(); ++a) {
    overlaps_other_[a] = searches_[a].overlaps_other ? 1 : 0;
    complete = complete && (!searches_[a].overlaps_other || searches_[a].in_elements);
  }
  return complete;
}

void ElementPairs::select_inter_object_elements() {
  const auto is_current = [](const Search& search) { return search.in_elements == search.overlaps_other; };
  if (std::all_of(searches_.begin(), searches_.end(), is_current)) return;
  inter_object_elements_.clear();
  for (std::uint32_t a = 0; a < surfaces_.size(); ++a) {
    searches_[a].in_elements = searches_[a].overlaps_other;
    if (!searches_[a].in_elements) continue;
    const ContactSurface& surface = surfaces_[a];
    inter_object_elements_.add_triangles(surface.triangles, surface.begin, a);
    inter_object_elements_.add_edges(surface.edges, surface.begin, a);
    if (surface.particles_only) inter_object_elements_.add_particles(surface.begin, surface.reserved_end, a);
  }
  inter_object_elements_.index_particles();
}

// --- searches within a step

std::size_t ElementPairs::update(const ParticleView& particles, float h, Threads& threads) {
  limit_.apply(surfaces_, particles, h, threads);
  paths_.find_off_path(surfaces_, overlaps_other_, particles, threads);
  return refind(particles, h, true, threads);
}

std::size_t ElementPairs::update(const ParticleView& particles, float h,
                                 std::span<const std::uint32_t> particles_moved, Threads& threads) {
  limit_.apply(surfaces_, particles, h, threads);
  paths_.find_off_path(surfaces_, overlaps_other_, particles, particles_moved);
  return refind(particles, h, false, threads);
}

// Chooses the surfaces all of whose pairs are searched again. Returns whether these are all that are searched at all.
bool ElementPairs::choose_surfaces(float h, bool may_be_over) {
  // For a fifth of all particles, a search for their pairs alone takes as long as a search for all pairs.
  constexpr std::size_t refind_all_divisor = 5;
  // Pairs that were replaced stay until the next search of all. They may take as much as so many searches.
  constexpr std::size_t kept_budgets = 2;
  for (Search& search : searches_) search.off_path = 0;
  for (const std::uint32_t i : paths_.off_path()) ++searches_[surfaces_.of(i)].off_path;
  bool all = true;
  for (std::uint32_t a = 0; a < searches_.size(); ++a) {
    Search& search = searches_[a];
    const std::size_t particles = surfaces_[a].end - surfaces_[a].begin;
    search.again =
        is_searched(a) && ((may_be_over && search.covered <= -0.5f * h) ||
                           search.off_path > particles / refind_all_divisor + 8 ||
                           (search.off_path > 0 && search.found > kept_budgets * budget_of(search)));
    all = all && (search.again || !is_searched(a));
  }
  return all;
}

std::size_t ElementPairs::refind(const ParticleView& particles, float h, bool may_be_over, Threads& threads) {
  // Storage of replaced pairs, in pairs of an ordinary search.
  constexpr std::size_t stored_budgets = 8;
  const bool all = choose_surfaces(h, may_be_over);
  const auto is_chosen = [](const Search& search) { return search.again; };
  const bool any = std::any_of(searches_.begin(), searches_.end(), is_chosen);
  if (!any && paths_.off_path().empty()) return size();
  const ParticleView before = rewind(particles, h);
  const std::size_t first = size();
  if (!(all && any) && first <= stored_budgets * budget() && refind_some(before, h, threads)) {
    for (std::uint32_t a = 0; a < searches_.size(); ++a)
      if (searches_[a].again) paths_.find_shift(surfaces_, a, particles);
    return first;
  }
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
  find(before, velocity_now_, h, threads);
  anew_.clear();
  remaining_ -= h;
  for (Search& search : searches_) search.covered -= h;
}

// Predicts the paths of the chosen surfaces for the rest of the step, and of other particles that have left theirs.
// Contacts moved the latter, so a prediction of their motion is valid for a short time only. Fills moved_.
void ElementPairs::predict_some(const ParticleView& before, float h, Threads& threads) {
  constexpr float covered_substeps = 3;
  moved_.clear();
  for (const std::uint32_t i : paths_.off_path()) {
    const std::uint32_t a = surfaces_.of(i);
    if (searches_[a].again) continue;
    const float dt = max(min(searches_[a].covered + h, covered_substeps * h), h);
    paths_.predict_off_path(i, a, paths_.shift_of(surfaces_, a, before), before, velocity_now_[i].xyz(), h,
                            dt);
    moved_.push_back(i);
  }
  const float remaining = remaining_;
  remaining_ = max(remaining_ + h, h);
  for (std::uint32_t a = 0; a < searches_.size(); ++a) {
    if (!searches_[a].again) continue;
    paths_.find_mean(surfaces_, a, before, velocity_now_);
    const float dt = limit_.is_active() ? h : horizon(a, before, velocity_now_);
    paths_.predict_surface(surfaces_, a, before, velocity_now_, h, dt, threads);
    searches_[a].covered = dt - h, searches_[a].found = 0;
    find_bounds(a);
    for (std::uint32_t i = surfaces_[a].begin; i < surfaces_[a].end; ++i)
      if (surfaces_.of(i) == a) moved_.push_back(i);
  }
  remaining_ = remaining;
  std::sort(moved_.begin(), moved_.end());
}

// Searches for the pairs of the particles that left their paths, and of the chosen surfaces. Returns false if all pairs
// have to be searched.
bool ElementPairs::refind_some(const ParticleView& before, float h, Threads& threads) {
  predict_some(before, h, threads);
  if (!find_overlaps()) return false;
  const auto others = [this](std::uint32_t a, std::uint32_t b) {
    return surfaces_.collides_with_other(a, b) && searches_[a].overlaps_other && searches_[b].overlaps_other;
  };
  if (!self_finder_.find_moved(moved_, paths_.relative_boxes(), itself, before.position, self_pairs_, threads,
                               budget()) ||
      !inter_object_finder_.find_moved(moved_, paths_.boxes(), others, before.position, inter_object_pairs_,
                                       threads, budget()))
    return false;
  for (const std::uint32_t i : moved_) pairs_.replace_pairs_of(i);
  add_found(before, threads);
  for (std::uint32_t a = 0; a < searches_.size(); ++a)
    if (searches_[a].again) anew_.push_back({surfaces_[a].begin, surfaces_[a].reserved_end});
  return true;
}

// --- pairs

// Keeps the pairs that can come into contact before they are searched again.
void ElementPairs::add_batch(Batch& batch, std::span<const NearPair> pairs, bool edges, bool inter_object,
                             const ParticleView& particles) const {
  const auto covered = [&](std::uint32_t i) { return searches_[surfaces_.of(i)].covered; };
  float dt = 0;  // until the first of a pair's surfaces is searched again
  for (const NearPair& pair : pairs)
    dt = max(dt, inter_object ? min(covered(pair.particle[0]), covered(pair.particle[3]))
                              : covered(pair.particle[0]));
  dt += step_.h;  // `covered` may be that after the substep
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
                       const ParticleView& particles, Threads& threads) {
  const std::size_t count = batches_of(pairs.size());
  if (batches_.size() < count) {
    const std::size_t before = batches_.size();
    batches_.resize(count + count / 2 + 16);
    for (std::size_t b = before; b < batches_.size(); ++b)
      batches_[b].near.resize(batch_size), batches_[b].far.resize(batch_size);
  }
  threads.each(count, 1, [&](std::size_t b) {
    add_batch(batches_[b], pairs.subspan(b * batch_size, std::min(batch_size, pairs.size() - b * batch_size)),
              edges, inter_object, particles);
  });
  const std::span<Batch> batches = std::span(batches_).first(count);
  pairs_.append(batches, &Batch::near, edges, inter_object, threads);
  pairs_.append(batches, &Batch::far, edges, inter_object, threads);
}

void ElementPairs::count_found(const NearPairs& pairs) {
  for (const std::vector<NearPair>* const list : {&pairs.vertex_triangle, &pairs.edge_edge})
    for (const NearPair& pair : *list) ++searches_[surfaces_.of(pair.particle[0])].found;
}

void ElementPairs::add_found(const ParticleView& particles, Threads& threads) {
  count_found(self_pairs_), count_found(inter_object_pairs_);
  const std::size_t first = chunk_count();
  add(self_pairs_.vertex_triangle, false, false, particles, threads);
  add(inter_object_pairs_.vertex_triangle, false, true, particles, threads);
  add(self_pairs_.edge_edge, true, false, particles, threads);
  add(inter_object_pairs_.edge_edge, true, true, particles, threads);
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
