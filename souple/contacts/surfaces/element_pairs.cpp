#include "souple/contacts/surfaces/element_pairs.h"

#include "souple/assert.h"
#include "souple/contacts/contact_law.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/contacts/surfaces/pair_search.h"
#include "souple/intersections/intersection_resolver.h"
#include "souple/math/sentinels.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <cmath>
#include <utility>

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
  searches_.resize(surfaces_.size());
  search_ = std::make_unique<PairSearch>(surfaces_);
  const std::size_t particles = surfaces_.particle_count();
  for (std::vector<Vec4f>* each : {&velocity_now_, &before_}) each->reserve(particles);
  paths_ = PredictedPaths(particles);
  bounds_ = MotionBounds(particles);
}

ElementPairs::ElementPairs() = default;
ElementPairs::ElementPairs(ElementPairs&&) noexcept = default;
ElementPairs& ElementPairs::operator=(ElementPairs&&) noexcept = default;
ElementPairs::~ElementPairs() = default;

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
  pairs_.clear(surfaces_.particle_count());
  const Motion motion{particles, velocity, 0, threads};
  for (std::uint32_t a = 0; a < surfaces_.size(); ++a) predict(a, motion, false);
  search_->groups().find(surfaces_);
  search_->find_all(input(motion));
  add_found(motion);
  for (const std::uint32_t group : search_->over()) find_within_limit(group, motion);
  pairs_.end_search();
}

bool ElementPairs::is_searched(std::uint32_t surface) const {
  return search_->is_searched(surfaces_, surface);
}

PairSearchInput ElementPairs::input(const Motion& motion) const {
  return {surfaces_, paths_, motion.particles.position, motion.threads};
}

void ElementPairs::begin_substep(float h, bool still_have_margins) {
  bounds_.set_still_have_margins(still_have_margins);
  remaining_ -= h;
  for (Search& search : searches_) search.covered -= h, search.added = 0;
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

void ElementPairs::predict(std::uint32_t surface, const Motion& motion, bool one_substep) {
  paths_.find_mean(surfaces_, surface, motion.particles, motion.velocity);
  const float dt = one_substep ? substep_length() : horizon(surface, motion.particles, motion.velocity);
  searches_[surface].covered = dt - motion.ago, searches_[surface].found = 0;
  if (!paths_.predict_surface(surfaces_, surface, motion.particles, motion.velocity, motion.ago, dt,
                              motion.threads))
    return;
  const Bounds bounds = paths_.bounds_of(surfaces_[surface], surface, motion.ago, dt);
  const Vec3f size = bounds.hi - bounds.lo;
  search_->groups().set_bounds(
      surface, around(bounds.lo, bounds.hi, far_surface_margin_part * max(size.x, max(size.y, size.z))));
}

// All of a group, which may have a limit.
void ElementPairs::predict_group(MotionLimit::Group group, const Motion& motion, bool one_substep) {
  Motion limited = motion;
  limited.velocity = limit_.limited(surfaces_, group, motion.particles, motion.velocity, substep_length());
  for (const std::uint32_t a : group) {
    if (group.size() > 1) paths_.set_frame(a, limit_.frame(a));
    predict(a, limited, one_substep);
  }
}

// Searches a group that has more pairs than its budget: for one substep, and then for shortened motions.
void ElementPairs::find_within_limit(std::uint32_t group, const Motion& motion) {
  const MotionLimit::Group members = search_->groups().members(group);
  const std::size_t budget = search_->budget(surfaces_, group);
  bool one_substep = limit_.is_active(members[0]), found = false;
  limit_.begin_search(surfaces_, members, motion.particles, motion.velocity);
  if (!one_substep) {
    predict_group(members, motion, one_substep = true);
    found = search_->find_group(input(motion), group, budget);
  }
  while (!found) {
    // Pairs that are near although they hardly move have to be found.
    const bool helps =
        limit_.shorten(surfaces_, members, motion.particles, motion.velocity, substep_length());
    if (!helps && !limit_.is_active(members[0])) one_substep = false;
    predict_group(members, motion, one_substep);
    found = search_->find_group(input(motion), group, helps ? budget : NearPairFinder::unlimited);
  }
  add_found(motion);
}

// --- searches within a step

std::size_t ElementPairs::update(const ParticleView& particles, float h, Threads& threads) {
  shorten_motions(particles, h);
  paths_.find_off_path(surfaces_, search_->groups().overlaps_other(), particles, threads);
  return refind(particles, h, true, threads);
}

std::size_t ElementPairs::update(const ParticleView& particles, float h,
                                 std::span<const std::uint32_t> particles_moved, Threads& threads) {
  shorten_motions(particles, h);
  paths_.find_off_path(surfaces_, search_->groups().overlaps_other(), particles, particles_moved);
  return refind(particles, h, false, threads);
}

void ElementPairs::shorten_motions(const ParticleView& particles, float h) {
  const SurfaceGroups& groups = search_->groups();
  for (std::size_t g = 0; g < groups.size(); ++g) limit_.apply(surfaces_, groups.members(g), particles, h);
}

// Chooses the surfaces all of whose pairs are searched again.
void ElementPairs::choose_surfaces(float h, bool may_be_over) {
  // For a fifth of all particles, a search for their pairs alone takes as long as a search for all pairs.
  constexpr std::size_t refind_all_divisor = 5;
  // Pairs that were replaced stay until the next search of all. They may take as much as so many searches.
  constexpr std::size_t kept_budgets = 2, added_budgets = 8;
  for (Search& search : searches_) search.off_path = 0;
  for (const std::uint32_t i : paths_.off_path()) ++searches_[surfaces_.of(i)].off_path;
  for (std::uint32_t a = 0; a < searches_.size(); ++a) {
    Search& search = searches_[a];
    const std::size_t particles = surfaces_[a].end - surfaces_[a].begin;
    search.again =
        is_searched(a) && ((may_be_over && search.covered <= -0.5f * h) ||
                           search.off_path > particles / refind_all_divisor + 8 ||
                           (search.off_path > 0 && search.found > kept_budgets * search_->budget(a)));
  }
  const SurfaceGroups& groups = search_->groups();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::size_t added = 0, off_path = 0;
    for (const std::uint32_t a : groups.members(g))
      added += searches_[a].added, off_path += searches_[a].off_path;
    if (off_path > 0 && added > added_budgets * search_->budget(surfaces_, g)) choose_all(groups.members(g));
  }
}

bool ElementPairs::are_all_chosen(MotionLimit::Group group) const {
  return std::all_of(group.begin(), group.end(),
                     [this](std::uint32_t a) { return searches_[a].again || !is_searched(a); });
}

// Returns whether that was news.
bool ElementPairs::choose_all(MotionLimit::Group group) {
  if (are_all_chosen(group)) return false;
  for (const std::uint32_t a : group) searches_[a].again = is_searched(a);
  return true;
}

// After groups were found: what overlaps others only now is searched again, and groups that met while one of them has a
// limit. Returns whether there is any.
bool ElementPairs::choose_more() {
  const SurfaceGroups& groups = search_->groups();
  bool any = false;
  for (std::uint32_t a = 0; a < searches_.size(); ++a)
    if (search_->is_new(a) && !searches_[a].again) searches_[a].again = any = true;
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (limit_.differs(groups.members(g))) any = choose_all(groups.members(g)) || any;
  return any;
}

// Groups that exceeded their budget are searched whole. Returns whether there is any that was not.
bool ElementPairs::choose_over() {
  bool any = false;
  for (const std::uint32_t g : search_->over()) any = choose_all(search_->groups().members(g)) || any;
  return any;
}

std::size_t ElementPairs::refind(const ParticleView& particles, float h, bool may_be_over, Threads& threads) {
  choose_surfaces(h, may_be_over);
  const auto is_chosen = [](const Search& search) { return search.again; };
  if (paths_.off_path().empty() && std::none_of(searches_.begin(), searches_.end(), is_chosen)) return size();
  const ParticleView before = rewind(particles, h);
  const Motion motion{before, velocity_now_, h, threads};
  const float remaining = std::exchange(remaining_, max(remaining_ + h, h));
  bool all = false;
  do {
    do {
      predict_chosen(motion);
      search_->groups().find(surfaces_);
    } while (choose_more());
    all = true;
    for (std::uint32_t a = 0; a < searches_.size(); ++a) all = all && (searches_[a].again || !is_searched(a));
    if (all) {
      search_->find_all(input(motion));
    } else {
      list_moved();
      search_->find_moved(input(motion), moved_);
    }
  } while (choose_over());
  const std::size_t first = replace(all);
  add_found(motion);
  for (const std::uint32_t group : search_->over()) find_within_limit(group, motion);
  if (all) pairs_.end_search();
  remaining_ = remaining;
  shorten_motions(particles, h);
  for (std::uint32_t a = 0; a < searches_.size(); ++a)
    if (searches_[a].again) paths_.find_shift(surfaces_, a, particles);
  return first;
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

// Predicts the paths of the chosen surfaces for the rest of the step, and of other particles that have left theirs.
void ElementPairs::predict_chosen(const Motion& motion) {
  const SurfaceGroups& groups = search_->groups();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const MotionLimit::Group group = groups.members(g);
    if (limit_.is_needed(group) && are_all_chosen(group)) {
      limit_.begin_search(surfaces_, group, motion.particles, motion.velocity);
      predict_group(group, motion, limit_.is_active(group[0]));
      continue;
    }
    for (const std::uint32_t a : group)
      if (searches_[a].again) predict(a, motion, limit_.is_active(a));
  }
  predict_off_path(motion);
}

// Contacts moved these particles, so a prediction of their motion is valid for a short time only.
void ElementPairs::predict_off_path(const Motion& motion) {
  constexpr float covered_substeps = 3;
  const float h = motion.ago;
  for (const std::uint32_t i : paths_.off_path()) {
    const std::uint32_t a = surfaces_.of(i);
    if (searches_[a].again) continue;
    const float dt = max(min(searches_[a].covered + h, covered_substeps * h), h);
    paths_.predict_off_path(i, a, paths_.shift_of(surfaces_, a, motion.particles), motion.particles,
                            motion.velocity[i].xyz(), h, dt);
  }
}

// Lists the particles whose pairs are searched again.
void ElementPairs::list_moved() {
  moved_.clear();
  for (const std::uint32_t i : paths_.off_path())
    if (!searches_[surfaces_.of(i)].again) moved_.push_back(i);
  for (std::uint32_t a = 0; a < searches_.size(); ++a)
    for (std::uint32_t i = surfaces_[a].begin; searches_[a].again && i < surfaces_[a].end; ++i)
      if (surfaces_.of(i) == a) moved_.push_back(i);
  std::sort(moved_.begin(), moved_.end());
}

// Drops the pairs that a search replaces. Returns the index of the first new one.
std::size_t ElementPairs::replace(bool all) {
  const SurfaceGroups& groups = search_->groups();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (!are_all_chosen(groups.members(g))) continue;
    for (const std::uint32_t a : groups.members(g)) searches_[a].added = 0;
  }
  if (all) {
    pairs_.clear(surfaces_.particle_count());
    anew_.clear();
    return 0;
  }
  const std::size_t first = size();
  for (const std::uint32_t i : moved_) pairs_.replace_pairs_of(i);
  for (std::uint32_t a = 0; a < searches_.size(); ++a)
    if (searches_[a].again) anew_.push_back({surfaces_[a].begin, surfaces_[a].reserved_end});
  return first;
}

// --- pairs

// Keeps the pairs that can come into contact before they are searched again.
void ElementPairs::add_batch(Batch& batch, std::span<const NearPair> pairs, bool edges, bool inter_object,
                             const ParticleView& particles) const {
  const auto covered = [&](std::uint32_t i) { return searches_[surfaces_.of(i)].covered; };
  // Until the first of a pair's surfaces is searched again; `covered` is the time after the substep.
  const auto time_of = [&](const NearPair& pair) {
    const float time =
        inter_object ? min(covered(pair.particle[0]), covered(pair.particle[3])) : covered(pair.particle[0]);
    return time + step_.h;
  };
  const kernels::ElementPairKernels& kernels = kernels::find_element_pair_kernels(instruction_set());
  const std::size_t kind = edges ? 1 : 0;
  float distance[batch_size], thickness[batch_size], range[batch_size];
  kernels::ParticleRecords records = records_of(particles, paths_.velocity());
  records.contact_margin = paths_.contact_margin().data();
  for (std::size_t begin = 0, end = 0; begin < pairs.size(); begin = end) {
    const float dt = time_of(pairs[begin]);
    while (end < pairs.size() && time_of(pairs[end]) == dt) ++end;
    kernels.ranges[kind](records, paths_.margins(inter_object), dt, &pairs[0].particle, begin, end, thickness,
                         range);
  }
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

void ElementPairs::add(std::span<const NearPair> pairs, bool edges, bool inter_object, const Motion& motion) {
  const std::size_t count = batches_of(pairs.size());
  if (batches_.size() < count) {
    const std::size_t before = batches_.size();
    batches_.resize(count + count / 2 + 16);
    for (std::size_t b = before; b < batches_.size(); ++b)
      batches_[b].near.resize(batch_size), batches_[b].far.resize(batch_size);
  }
  motion.threads.each(count, 1, [&](std::size_t b) {
    add_batch(batches_[b], pairs.subspan(b * batch_size, std::min(batch_size, pairs.size() - b * batch_size)),
              edges, inter_object, motion.particles);
  });
  const std::span<Batch> batches = std::span(batches_).first(count);
  pairs_.append(batches, &Batch::near, edges, inter_object, motion.threads);
  pairs_.append(batches, &Batch::far, edges, inter_object, motion.threads);
}

void ElementPairs::add_found(const Motion& motion) {
  for (std::uint32_t a = 0; a < searches_.size(); ++a)
    searches_[a].found += search_->found(a), searches_[a].added += search_->found(a);
  const std::size_t first = chunk_count();
  add(search_->within().vertex_triangle, false, false, motion);
  add(search_->between().vertex_triangle, false, true, motion);
  add(search_->within().edge_edge, true, false, motion);
  add(search_->between().edge_edge, true, true, motion);
  bounds_.resize(chunk_count());
  motion.threads.each(chunk_count() - first, 4, [&](std::size_t c) { bounds_.add_chunk(first + c, pairs_); });
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
  std::size_t sum = bytes_of(velocity_now_, before_);
  for (const Batch& batch : batches_) sum += batch.near.bytes() + batch.far.bytes();
  return sum + surfaces_.bytes() + paths_.bytes() + limit_.bytes() + pairs_.bytes() + bounds_.bytes() +
         (search_ ? search_->bytes() : 0);
}

}  // namespace souple
