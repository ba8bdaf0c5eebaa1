#include "souple/contacts/particle_contacts.h"

#include "souple/contacts/kernels/find_kernels.h"
#include "souple/error.h"
#include "souple/math/sentinels.h"
#include "souple/state/bytes.h"
#include "souple/state/saved_bytes.h"

#include <algorithm>

namespace souple {
namespace {

// Limits of the margin, as parts of the largest diameter. Smaller margins cost more broad phases, larger ones
// more pairs without contact.
constexpr float min_margin = 0.1f;
constexpr float max_margin = 1.0f;
// Only particles of objects whose boxes overlap enter the broad phase. Boxes grow by this part of their size
// beyond their velocities' margin: an object may be dragged along within the step.
constexpr float box_margin_part = 0.125f;
constexpr std::size_t pair_grain = 256;  // least number of pairs that pays for a thread
// The first s in [0, 1] with |d + s motion| = radius_sum, from outside; negative when there is none.
float first_touch(const Vec3f& d, const Vec3f& motion, float radius_sum) {
  const Vec3d d0(d), m(motion);
  const double a = dot(m, m), b = dot(d0, m), c = dot(d0, d0) - double(radius_sum) * double(radius_sum);
  const double discriminant = b * b - a * c;
  if (!(c > 0) || !(b < 0) || !(discriminant >= 0)) return -1;
  const double s = c / (-b + sqrt(discriminant));
  return s <= 1 ? float(s) : -1.0f;
}

}  // namespace

bool ParticleContacts::interact(std::uint32_t object_a, std::uint32_t object_b) const {
  const ContactObject &a = objects_[object_a], &b = objects_[object_b];
  if (!(a.moves || b.moves) || !materials_->collide(object_a, object_b)) return false;
  if (object_a == object_b) return a.self_collision;
  return a.are_balls && b.are_balls;
}

// Bounds of the motion within the step of each object of balls: its box, with margins for its fastest particle and for
// being dragged along. A position or velocity that is not finite makes the box infinite.
void ParticleContacts::find_boxes(const ParticleView& particles, std::span<const Vec4f> velocity) {
  boxes_.bounds.clear();
  for (const std::uint32_t a : boxes_.object) {
    const ContactObject& object = objects_[a];
    Vec3f lo{infinity, infinity, infinity}, hi = -lo, sum;
    float fastest = 0;
    for (std::uint32_t i = object.begin; i < object.end; ++i) {
      const Vec3f x = particles.relative(i, {}), v = velocity[i].xyz();
      lo = {min(lo.x, x.x), min(lo.y, x.y), min(lo.z, x.z)};
      hi = {max(hi.x, x.x), max(hi.y, x.y), max(hi.z, x.z)};
      fastest = max(fastest, dot(v, v));
      sum += x + v;
    }
    if (!is_finite(sum)) hi = {infinity, infinity, infinity}, lo = -hi;
    const Vec3f size = hi - lo;
    const float margin = 2.2f * (sqrt(fastest) + step_.gravity * step_.dt) * step_.dt +
                         (1 + max_margin) * largest_diameter_ +
                         box_margin_part * max(size.x, max(size.y, size.z));
    const Vec3f margins{margin, margin, margin};
    boxes_.bounds.push_back({lo - margins, hi + margins});
  }
}

// Particles of objects that may collide with another object, or with themselves, within the step.
void ParticleContacts::find_members(const ParticleView& particles, std::span<const Vec4f> velocity) {
  members_.clear(), boxes_.object.clear(), boxes_.are_near.clear();
  largest_diameter_ = 0;
  for (std::uint32_t a = 0; a < objects_.size(); ++a) {
    const ContactObject& object = objects_[a];
    boxes_.are_near.push_back(object.self_collision && object.moves ? 1 : 0);
    if (!object.are_balls && !object.self_collision) continue;
    boxes_.object.push_back(a);
    for (std::uint32_t i = object.begin; i < object.end; ++i)
      largest_diameter_ = max(largest_diameter_, 2 * radius_[i]);
  }
  find_boxes(particles, velocity);
  for (const auto& [k, l] : boxes_.sweep.find(boxes_.bounds)) {
    const std::uint32_t a = boxes_.object[k], b = boxes_.object[l];
    if (interact(a, b)) boxes_.are_near[a] = boxes_.are_near[b] = 1;
  }
  for (std::uint32_t a = 0; a < objects_.size(); ++a)
    for (std::uint32_t i = objects_[a].begin; boxes_.are_near[a] != 0 && i < objects_[a].end; ++i)
      members_.push_back({i, a});
  if (members_.empty()) largest_diameter_ = 0;  // no pair is possible
}

void ParticleContacts::begin_step(const ContactInput& input, Threads& threads) {
  const std::vector<ContactObject>& objects = input.tables.objects;
  const ContactMaterialTable& materials = input.tables.against_objects;
  if (materials.rows() < objects.size() || materials.columns() < objects.size())
    throw Error("ParticleContacts: the material table is smaller than objects x objects; rebuild it");
  objects_ = objects, radius_ = input.radius;
  materials_ = &materials;
  step_ = input.step;
  clear_contacts();
  save_friction();
  find_members(input.particles, input.velocity);
  const auto speed = [&](std::size_t m) { return input.velocity[members_[m].particle].xyz(); };
  find_pairs(input.particles, 2.2f * largest_motion_.from_mean(members_.size(), speed, threads) * step_.dt);
}

void ParticleContacts::find_pairs(const ParticleView& particles, float wanted_margin) {
  save_friction();
  if (!(largest_diameter_ > 0)) return;
  margin_ = max(min_margin * largest_diameter_, min(wanted_margin, max_margin * largest_diameter_));
  sort_into_cells(particles);
  list_pairs();
  restore_friction();
}

// Pairs are in order of (i, j), both as members and as particles: the particles of each object are one
// ascending range.
void ParticleContacts::save_friction() {
  if (pairs_.empty()) return;
  friction_cache_.clear();
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (displacement_[p] == FrictionDisplacement{}) continue;
    friction_cache_.push_back(
        {members_[pairs_[p].i].particle, members_[pairs_[p].j].particle, displacement_[p]});
  }
  pairs_.clear();
}

void ParticleContacts::restore_friction() {
  displacement_.assign(pairs_.size(), {});
  std::size_t next = 0;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const std::uint32_t i = members_[pairs_[p].i].particle, j = members_[pairs_[p].j].particle;
    while (next < friction_cache_.size() &&
           (friction_cache_[next].i < i || (friction_cache_[next].i == i && friction_cache_[next].j < j)))
      ++next;
    if (next < friction_cache_.size() && friction_cache_[next].i == i && friction_cache_[next].j == j)
      displacement_[p] = friction_cache_[next].displacement;
  }
  friction_cache_.clear();
}

std::vector<CachedFriction> ParticleContacts::friction_cache() const {
  if (pairs_.empty()) return friction_cache_;
  std::vector<CachedFriction> result;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (displacement_[p] == FrictionDisplacement{}) continue;
    result.push_back({members_[pairs_[p].i].particle, members_[pairs_[p].j].particle, displacement_[p]});
  }
  return result;
}

void ParticleContacts::set_friction_cache(std::span<const CachedFriction> cache) {
  pairs_.clear();
  clear_contacts();
  friction_cache_.assign(cache.begin(), cache.end());
}

void ParticleContacts::save(SavedBytesWriter& out) const {
  static_assert(sizeof(CachedFriction) == 32, "without padding");
  const std::vector<CachedFriction> cache = friction_cache();
  out.put_all(std::span<const CachedFriction>(cache));
}

void ParticleContacts::check_saved(SavedBytes in, std::size_t particles) const {
  const std::vector<CachedFriction> cache = in.get_list<CachedFriction>(in.size() / sizeof(CachedFriction));
  in.require_end();
  for (std::size_t k = 0; k < cache.size(); ++k) {
    const CachedFriction& one = cache[k];
    in.require(one.i < one.j && one.j < particles && is_finite(one.displacement.sliding) &&
               is_finite(one.displacement.rolling));
    in.require(k == 0 || std::pair(cache[k - 1].i, cache[k - 1].j) < std::pair(one.i, one.j));
  }
}

void ParticleContacts::load(SavedBytes in) {
  set_friction_cache(in.get_list<CachedFriction>(in.size() / sizeof(CachedFriction)));
}

void ParticleContacts::sort_into_cells(const ParticleView& particles) {
  auto& [corner, place, radius, half_margin, cells, search] = places_;
  corner = {infinity, infinity, infinity};
  for (const Member& member : members_) {
    const Vec3f x = particles.relative(member.particle, {});
    if (!is_finite(x)) continue;
    corner = {min(corner.x, x.x), min(corner.y, x.y), min(corner.z, x.z)};
  }
  place.clear(), radius.clear();
  for (const Member& member : members_) {
    place.push_back(particles.relative(member.particle, corner));
    radius.push_back(radius_[member.particle]);
  }
  half_margin.assign(members_.size(), margin_ / 2);
  const SearchedBalls balls{place, {}, radius, half_margin};
  cells.sort(balls, largest_diameter_ + margin_);
  cells.gather(balls, 0, cells.size());
}

// Pairs of members within the margin that interact.
void ParticleContacts::list_pairs() {
  const kernels::VertexBallKernels& kernels = kernels::find_vertex_ball_kernels(instruction_set());
  pairs_.clear();
  for (std::size_t slot = 0; slot < places_.cells.size(); ++slot)
    for (const std::uint32_t other : places_.cells.find_near(slot, 0, kernels, places_.search)) {
      const auto [i, j] = std::minmax({places_.cells.ball(slot), places_.cells.ball(other)});
      if (interact(members_[i].object, members_[j].object) &&
          !joined_.contains(members_[i].particle, members_[j].particle))
        pairs_.push_back({i, j});
    }
  later_.fill(members_.size(), [&](const auto& add) {
    for (const Pair& pair : pairs_) add(pair.i, pair.j);
  });
  pairs_.clear();
  for (std::uint32_t i = 0; i < members_.size(); ++i) {
    std::sort(later_[i].begin(), later_[i].end());
    for (const std::uint32_t j : later_[i]) pairs_.push_back({i, j});
  }
}

void ParticleContacts::build(const ContactGeometry& geometry) {
  joined_ = geometry.joined;
  clear_contacts();
}

void ParticleContacts::clear_contacts() {
  contacts_.clear();
  color_begin_.assign(1, 0);
}

void ParticleContacts::refresh(const ParticleView& particles, const Substep& substep, double,
                               Threads& threads) {
  last_h_ = substep.h;
  if (!(largest_diameter_ > 0)) return clear_contacts();
  const auto displacement = [&](std::size_t m) {
    return particles.relative(members_[m].particle, places_.corner) - places_.place[m];
  };
  if (2 * largest_motion_.from_mean(members_.size(), displacement, threads) > margin_) {
    const auto moved = [&](std::size_t m) { return particles.moved(members_[m].particle); };
    find_pairs(particles, 2.2f * largest_motion_.from_mean(members_.size(), moved, threads));
  }
  is_contact_.resize(pairs_.size());
  threads.each(pairs_.size(), pair_grain, [&](std::size_t p) {
    is_contact_[p] = may_touch(static_cast<std::uint32_t>(p), particles) ? 1 : 0;
  });
  color_contacts(particles);
  if (contacts_.capacity() < sorted_.size()) contacts_.reserve(2 * sorted_.size());
  contacts_.resize(sorted_.size());
  threads.each(contacts_.size(), grain(),
               [&](std::size_t c) { contacts_[c] = contact_of(sorted_[c], particles, substep.h); });
}

// False for pairs that did not touch during the substep and that other constraints are unlikely to push
// together: they get no contact.
bool ParticleContacts::may_touch(std::uint32_t pair, const ParticleView& particles) const {
  const std::uint32_t i = members_[pairs_[pair].i].particle, j = members_[pairs_[pair].j].particle;
  if (!(particles.inverse_mass(i) + particles.inverse_mass(j) > 0)) return false;
  const float path = length(particles.moved(i) - particles.moved(j));
  return length(particles.difference(i, j)) < 1.1f * (radius_[i] + radius_[j]) + path;
}

// In order of (i, j), a contact takes the color after the highest that its two particles have so far. So two
// contacts of one particle keep their order. Solving color after color then equals, to the bit, solving one contact
// after another in order of (i, j). Colors in reverse order equal the reverse order. This order carries a push from the
// floor up through a heap in one sweep, and down again in the next. Greedy coloring needs fewer colors but loses the
// order. A heap of 288 grains then lay 0.069 m high instead of 0.08, and still crept after six seconds.
//
// A particle that cannot move takes no color, so a pinned cloth does not serialize a thousand grains on it.
void ParticleContacts::color_contacts(const ParticleView& particles) {
  next_color_.assign(members_.size(), 0);
  colored_pairs_.clear();
  color_begin_.assign(1, 0);
  for (std::uint32_t p = 0; p < pairs_.size(); ++p) {
    if (is_contact_[p] == 0) continue;
    const auto [i, j] = pairs_[p];
    const std::uint32_t color = std::max(next_color_[i], next_color_[j]);
    if (particles.inverse_mass(members_[i].particle) > 0) next_color_[i] = color + 1;
    if (particles.inverse_mass(members_[j].particle) > 0) next_color_[j] = color + 1;
    colored_pairs_.push_back({p, color});
    if (color + 1 == color_begin_.size()) color_begin_.push_back(0);
    ++color_begin_[color + 1];
  }
  // Counting sort, stable.
  for (std::size_t color = 1; color < color_begin_.size(); ++color)
    color_begin_[color] += color_begin_[color - 1];
  next_slot_ = color_begin_;
  sorted_.resize(colored_pairs_.size());
  for (const ColoredPair& colored : colored_pairs_) sorted_[next_slot_[colored.color]++] = colored.pair;
}

ParticleContacts::Contact ParticleContacts::contact_of(std::uint32_t pair, const ParticleView& particles,
                                                       float h) const {
  const Member &a = members_[pairs_[pair].i], &b = members_[pairs_[pair].j];
  const std::uint32_t i = a.particle, j = b.particle;
  const float radius_sum = radius_[i] + radius_[j];
  const Vec3f motion = particles.moved(i) - particles.moved(j);
  const Vec3f to = particles.difference(i, j);
  const Vec3f from = to - motion;
  const float start_distance = length(from);
  Contact contact{i,     j, pair,   radius_sum, materials_->at(a.object, b.object), balls_of(a, b, particles),
                  false, 0, motion, {0, 1, 0}};
  contact.displacement = displacement_[pair];
  if (start_distance > 0) contact.normal = from * (1 / start_distance);
  const Vec3f slip = contact.balls == Balls::none
                         ? Vec3f{}
                         : cross(contact.normal, step_.turn[i].xyz() + step_.turn[j].xyz());
  contact.material.kinetic_friction =
      kinetic_friction_at(contact.material, motion + slip, step_.sliding_threshold(h));
  const float overlap = start_distance - radius_sum;
  if (overlap < 0) {
    contact.slop = min(0.0f, overlap + step_.depenetration_speed(contact.material.radius) * h);
    // Where the centers passed each other, separate them along the old normal.
    contact.fixed_normal = dot(from, to) < 0;
  } else if (length(motion) > 0.25f * radius_sum) {
    const float s = first_touch(from, motion, radius_sum);
    contact.fixed_normal = s >= 0;
    if (contact.fixed_normal) contact.normal = normalized(from + motion * s);
  }
  return contact;
}

ParticleContacts::Range ParticleContacts::contacts_of(int color) const {
  const auto c = static_cast<std::size_t>(color);
  return {color_begin_[c], color_begin_[c + 1]};
}

std::uint32_t ParticleContacts::particle_of(int color, std::size_t index,
                                            const ParticleView& particles) const {
  const Contact& contact = contacts_[contacts_of(color).begin + index];
  return particles.first_movable(std::array{contact.i, contact.j});
}

// Returns C and sets the normal, for a difference x_i - x_j.
float ParticleContacts::gap(const Contact& contact, const Vec3f& difference, Vec3f& normal) const {
  normal = contact.normal;
  if (contact.fixed_normal) return dot(normal, difference) - contact.radius_sum;
  const float l = length(difference);
  if (l > 0) normal = difference * (1 / l);
  return l - contact.radius_sum;
}

void ParticleContacts::project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
                               const Substep&) {
  const std::size_t first = contacts_of(color).begin;
  for (std::size_t c = first + begin; c < first + end; ++c) project_one(contacts_[c], particles);
}

// As in collider_contacts.cpp, for the difference of two particles.
void ParticleContacts::project_one(Contact& contact, const ParticleView& particles) const {
  const std::uint32_t i = contact.i, j = contact.j;
  Vec3f n;
  const float C = gap(contact, particles.difference(i, j), n);
  if (!(contact.slop > C) && !(contact.sums.normal_sum > 0)) return;
  if (contact.balls != Balls::none) return project_rolling(contact, C, n, particles);
  const Anchor<2> anchor = between(i, j);
  const Vec3f moved = anchor.moved(particles) + contact.displacement.sliding;
  const Vec3f change = solve_contact(contact.sums, C, contact.slop, n, moved, contact.material);
  contact.normal = n;
  anchor.correct(particles, change, anchor.inverse_mass(particles));
}

ParticleContacts::Balls ParticleContacts::balls_of(const Member& a, const Member& b,
                                                   const ParticleView& particles) const {
  const bool rolls_i = objects_[a.object].rolls && radius_[a.particle] > 0;
  const bool rolls_j = objects_[b.object].rolls && radius_[b.particle] > 0;
  if (step_.turn.empty() || !(rolls_i || rolls_j)) return Balls::none;
  if (!rolls_j) return Balls::i;
  if (!rolls_i) return Balls::j;
  const bool equal = radius_[a.particle] == radius_[b.particle] &&
                     particles.inverse_mass(a.particle) == particles.inverse_mass(b.particle);
  return equal ? Balls::equal : Balls::both;
}

// Shares of two equal balls are 5/4.
constexpr ParticleContacts::BallRotation ParticleContacts::equal_balls{1.25f,    1.25f,    1, 1,
                                                                       1 / 3.5f, 1 / 2.5f, 0};

// The moment arm r0 is the radius of the ball, or the harmonic mean of both: equal balls have that of one.
ParticleContacts::BallRotation ParticleContacts::rotation_of(const Contact& contact,
                                                             const ParticleView& particles) const {
  if (contact.balls == Balls::equal) return equal_balls;
  const bool rolls_i = contact.balls != Balls::j, rolls_j = contact.balls != Balls::i;
  const float r_i = radius_[contact.i], r_j = radius_[contact.j];
  const float w_i = particles.inverse_mass(contact.i), w_j = particles.inverse_mass(contact.j);
  const float r0 = rolls_i && rolls_j ? 2 * r_i * r_j / (r_i + r_j) : rolls_i ? r_i : r_j;
  const float share = inverse_inertia_factor / (w_i + w_j), arm_i = r0 / r_i, arm_j = r0 / r_j;
  const float share_i = rolls_i ? share * w_i : 0.0f, share_j = rolls_j ? share * w_j : 0.0f;
  const float B = share_i * arm_i * arm_i + share_j * arm_j * arm_j;
  return {share_i,
          share_j,
          arm_i,
          arm_j,
          1 / (1 + share_i + share_j),
          B > 0 ? 1 / B : 0.0f,
          share_i * arm_i - share_j * arm_j};
}

void ParticleContacts::turn(const Contact& contact, const BallRotation& balls, const Vec3f& friction,
                            const Vec3f& moment) const {
  Vec4f &i = step_.turn[contact.i], &j = step_.turn[contact.j];
  if (balls.share_i > 0) i.set_xyz(i.xyz() + (friction + moment * balls.arm_i) * balls.share_i);
  if (balls.share_j > 0) j.set_xyz(j.xyz() + (friction - moment * balls.arm_j) * balls.share_j);
}

namespace {

/// Rotation of a pair of balls in the substep [m]. `slip`: displacement by it at the point of contact, for x_i - x_j as
/// a vector. `roll`: rotation of i relative to j, times the moment arm.
struct Rotation {
  Vec3f slip, roll;
};

Rotation rotation_between(const Vec3f& turn_i, const Vec3f& turn_j, float arm_i, float arm_j,
                          const Vec3f& n) {
  return {cross(n, turn_i + turn_j), turn_i * arm_i - turn_j * arm_j};
}

// As within_friction; without a root where it sticks, as most contacts do.
Vec3f limited(const Vec3f& sticking, float static_limit, float kinetic_limit) {
  const float squared = dot(sticking, sticking);
  return squared <= static_limit * static_limit ? sticking : sticking * (kinetic_limit / sqrt(squared));
}

/// Sums of the corrections of friction: T and G (contact_law.h).
struct PairFriction {
  Vec3f tangent, moment;
};

// solve_rolling for a pair of balls. Rolling and sliding of equal balls are independent (c = 0).
template <class Balls>
[[gnu::always_inline]] inline PairFriction solve_pair(const PairFriction& sums, const Balls& balls,
                                                      const Vec3f& n, const Vec3f& slip, const Vec3f& roll,
                                                      const ContactMaterialPair& material, float normal) {
  const float mu_s = material.static_friction, mu_k = material.kinetic_friction;
  const float moment_limit = material.rolling_friction * normal;
  if (balls.c != 0) {
    const RollingResponse<float> response{1 / balls.inverse_A, balls.c, 1 / balls.inverse_B};
    const auto [friction, moment] =
        solve_rolling<float>({cross(sums.tangent, n), sums.moment}, response, n, cross(slip, n), roll, mu_s,
                             mu_k, material.rolling_friction, normal);
    return {cross(n, friction), moment};
  }
  const Vec3f tangent = sums.tangent - slip * balls.inverse_A;
  PairFriction result{limited(tangent - n * dot(n, tangent), mu_s * normal, mu_k * normal), {}};
  if (moment_limit > 0)
    result.moment = limited(sums.moment - roll * balls.inverse_B, moment_limit, moment_limit);
  return result;
}

}  // namespace

// As project_one. A contact that does not push has neither friction nor moment.
void ParticleContacts::project_rolling(Contact& contact, float C, const Vec3f& n,
                                       const ParticleView& particles) const {
  const std::uint32_t i = contact.i, j = contact.j;
  const BallRotation balls = rotation_of(contact, particles);
  const FrictionDisplacement& displacement = contact.displacement;
  const auto [slip, roll] =
      rotation_between(step_.turn[i].xyz(), step_.turn[j].xyz(), balls.arm_i, balls.arm_j, n);
  const Vec3f moved = particles.moved(i) - particles.moved(j) + displacement.sliding;
  const float dn = max(contact.slop - C, -contact.sums.normal_sum), normal_sum = contact.sums.normal_sum + dn;
  const PairFriction before{contact.sums.tangent_sum, contact.moment_sum};
  PairFriction after{};
  if (normal_sum > 0)
    after =
        solve_pair(before, balls, n, moved + slip, roll + displacement.rolling, contact.material, normal_sum);
  contact.sums.normal_sum = max(normal_sum, 0.0f);
  contact.sums.tangent_sum = after.tangent;
  contact.moment_sum = after.moment;
  contact.normal = n;
  const Vec3f tangent = after.tangent - before.tangent, dx = n * dn + tangent;
  const float w_i = particles.inverse_mass(i), w_j = particles.inverse_mass(j);
  const float share = 1 / (w_i + w_j);
  if (w_i > 0) particles.correct(i, dx * (w_i * share));
  if (w_j > 0) particles.correct(j, dx * (-w_j * share));
  turn(contact, balls, cross(tangent, n), after.moment - before.moment);
}

void ParticleContacts::apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                         const Substep& substep, Threads& threads) {
  for (std::size_t color = 0; color + 1 < color_begin_.size(); ++color) {
    const std::size_t first = color_begin_[color];
    threads.for_each(color_begin_[color + 1] - first, grain(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = first + begin; c < first + end; ++c)
        apply_restitution_to(contacts_[c], particles, velocity, substep.h);
    });
  }
}

void ParticleContacts::apply_restitution_to(Contact& contact, const ParticleView& particles,
                                            std::span<Vec4f> velocity, float h) {
  if (contact.balls != Balls::none) return apply_rolling_restitution(contact, particles, velocity, h);
  const std::uint32_t i = contact.i, j = contact.j;
  const Vec3f n = contact.normal;
  const Anchor<2> anchor = between(i, j);
  const Vec3f u = anchor.velocity(velocity);
  const float u_n = dot(n, u);
  Vec3f unused;
  const float C = gap(contact, particles.difference(i, j), unused);
  update_friction_displacement(contact, C, {(u - n * u_n) * h, {}});
  if (!(contact.sums.normal_sum > 0)) return;
  const float inverse_h = 1 / h;
  const auto [change, restitution_velocity] =
      solve_restitution(contact.sums, n, u, -dot(n, contact.predicted) * inverse_h,
                        step_.restitution_threshold(h), contact.material, inverse_h);
  contact.restitution_velocity = restitution_velocity;
  anchor.accelerate(velocity, particles, change, anchor.inverse_mass(particles));
  contact.depth = max(0.0f, -C);
}

void ParticleContacts::apply_rolling_restitution(Contact& contact, const ParticleView& particles,
                                                 std::span<Vec4f> velocity, float h) {
  const std::uint32_t i = contact.i, j = contact.j;
  const Vec3f n = contact.normal;
  const BallRotation balls = rotation_of(contact, particles);
  const Vec3f u = velocity[i].xyz() - velocity[j].xyz();
  const float inverse_h = 1 / h, u_n = dot(n, u);
  const auto [slip, roll] =
      rotation_between(step_.turn[i].xyz(), step_.turn[j].xyz(), balls.arm_i, balls.arm_j, n);
  Vec3f unused;
  const float C = gap(contact, particles.difference(i, j), unused);
  update_friction_displacement(contact, C, {(u - n * u_n) * h + slip, roll});
  if (!(contact.sums.normal_sum > 0)) return;
  const float approach = -dot(n, contact.predicted) * inverse_h,
              normal_sum = contact.sums.normal_sum * inverse_h;
  const float target =
      approach > step_.restitution_threshold(h) ? contact.material.restitution * approach : 0.0f;
  contact.restitution_velocity = max(target - u_n, -normal_sum);
  const PairFriction before{contact.sums.tangent_sum * inverse_h, contact.moment_sum * inverse_h};
  const PairFriction after = solve_pair(before, balls, n, u + slip * inverse_h, roll * inverse_h,
                                        contact.material, normal_sum + contact.restitution_velocity);
  const Vec3f tangent = after.tangent - before.tangent, change = n * contact.restitution_velocity + tangent;
  const float w_i = particles.inverse_mass(i), w_j = particles.inverse_mass(j);
  const float share = 1 / (w_i + w_j);
  if (w_i > 0) velocity[i].set_xyz(velocity[i].xyz() + change * (w_i * share));
  if (w_j > 0) velocity[j].set_xyz(velocity[j].xyz() - change * (w_j * share));
  turn(contact, balls, cross(tangent, n) * h, (after.moment - before.moment) * h);
  contact.depth = max(0.0f, -C);
}

void ParticleContacts::visit_impulses(const ParticleView& particles, const ImpulseFunction& f) const {
  for (const Contact& contact : contacts_) {
    if (!(contact.sums.normal_sum > 0)) continue;
    const Anchor<2> anchor = between(contact.i, contact.j);
    f(anchor.impulse(contact.normal * contact.sums.normal_sum + contact.sums.tangent_sum,
                     anchor.inverse_mass(particles)));
  }
}

ContactReport ParticleContacts::report() const {
  return report_of(contacts_);
}

// A displacement starts again at 0 if the gap is at least 2 % of the sum of radii. It also does if the pair slides or
// rolls, at the limit of its kinetic or rolling friction.
void ParticleContacts::update_friction_displacement(const Contact& contact, float C,
                                                    const FrictionDisplacement& change) {
  const bool near = C < 0.02f * contact.radius_sum;
  const auto at_limit = [&](const Vec3f& sum, float friction) {
    const float limit = 0.999f * friction * contact.sums.normal_sum;
    return contact.sums.normal_sum > 0 && dot(sum, sum) > limit * limit;
  };
  auto& [sliding, rolling] = displacement_[contact.pair];
  const bool slides = at_limit(contact.sums.tangent_sum, contact.material.kinetic_friction);
  const bool rolls = at_limit(contact.moment_sum, contact.material.rolling_friction) ||
                     !(contact.material.rolling_friction > 0);
  sliding = near && !slides ? sliding + change.sliding : Vec3f{};
  rolling = near && !rolls ? rolling + change.rolling : Vec3f{};
}

void ParticleContacts::events(const ParticleView& particles, std::vector<ContactPush>& out) const {
  const float inverse_h = last_h_ > 0 ? 1 / last_h_ : 0.0f;
  const std::size_t first = out.size();
  for (const Contact& contact : contacts_) {
    if (!(contact.sums.normal_sum > 0)) continue;
    const std::uint32_t i = contact.i, j = contact.j;
    const float impulse = normal_impulse(contact.sums.normal_sum, contact.restitution_velocity, inverse_h,
                                         between(i, j).inverse_mass(particles));
    const Vec3f point = particles.relative(i, {}) - contact.normal * radius_[i];
    out.push_back({i, j, point, contact.normal, impulse});
  }
  sort_pushes(out, first);
}

void ParticleContacts::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  for (std::size_t color = 0; color + 1 < color_begin_.size(); ++color)
    for (std::size_t c = color_begin_[color]; c < color_begin_[color + 1]; ++c) {
      const Contact& contact = contacts_[c];
      Vec3f unused;
      const float C = gap(contact, particles.difference(contact.i, contact.j), unused);
      const std::uint32_t pair[] = {contact.i, contact.j};
      visitor({pair, static_cast<int>(color), 0, max(0.0f, -C)});
    }
}

void ParticleContacts::erase_particles(std::uint32_t begin, std::uint32_t end) {
  save_friction();
  std::size_t kept = 0;
  for (CachedFriction m : friction_cache_) {
    if ((m.i >= begin && m.i < end) || (m.j >= begin && m.j < end)) continue;
    if (m.i >= end) m.i -= end - begin;
    if (m.j >= end) m.j -= end - begin;
    friction_cache_[kept++] = m;
  }
  friction_cache_.resize(kept);
  forget_members();
}

void ParticleContacts::clear() {
  friction_cache_.clear();
  pairs_.clear();
  forget_members();
}

void ParticleContacts::forget_members() {
  members_.clear();
  clear_contacts();
  largest_diameter_ = 0;
}

std::size_t ParticleContacts::bytes() const {
  return bytes_of(joined_.sorted(), boxes_.bounds, members_, places_.place, pairs_, displacement_,
                  friction_cache_, contacts_) +
         places_.cells.bytes() + later_.bytes();
}

}  // namespace souple
