#include "souple/contacts/collider_contacts.h"

#include "souple/broad_phase/spatial_hash.h"
#include "souple/contacts/anchor.h"
#include "souple/contacts/contact_law.h"
#include "souple/contacts/element_clearance.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/error.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace souple {
namespace {

constexpr std::size_t particle_grain = 1024;  // least number of particles that pays for a thread
constexpr std::size_t gap_chunk = 64;

/// Three perpendicular axes of which y is n.
Mat3d axes_around(const Vec3d& n) {
  const Vec3d other = std::abs(n.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1};
  const Vec3d x = normalized(other - n * dot(n, other));
  return {x, n, cross(x, n)};
}

/// Copies what ColliderContactKernels::project_again reads of some contacts.
void copy_plane_contacts(const kernels::ColliderContactColumns& from, std::span<const std::uint32_t> some,
                         const kernels::ColliderContactColumns& to) {
  for (std::size_t k = 0; k < some.size(); ++k) {
    const std::uint32_t c = some[k];
    to.particle[k] = from.particle[c];
    to.plane_gap[k] = from.plane_gap[c], to.slop[k] = from.slop[c], to.normal_sum[k] = from.normal_sum[c];
    to.static_friction[k] = from.static_friction[c], to.kinetic_friction[k] = from.kinetic_friction[c];
    for (int axis = 0; axis < 3; ++axis) {
      to.normal[axis][k] = from.normal[axis][c], to.tangent_sum[axis][k] = from.tangent_sum[axis][c];
      to.surface_motion[axis][k] = from.surface_motion[axis][c];
    }
  }
}

}  // namespace

void ColliderContacts::begin_step(const ContactInput& input, Threads& threads) {
  const std::vector<ContactObject>& objects = input.tables.objects;
  const std::vector<Collider>& colliders = input.tables.colliders;
  const ContactMaterialTable& materials = input.tables.against_colliders;
  if (!colliders.empty() && (materials.rows() < objects.size() || materials.columns() < colliders.size()))
    throw Error("ColliderContacts: the material table is smaller than objects x colliders; rebuild it");
  kernels_ = &kernels::find_collider_contact_kernels(instruction_set());
  colliders_ = colliders, objects_ = objects;
  radius_ = input.radius, element_radius_ = input.element_radius;
  materials_ = &materials;
  step_ = input.step;
  contacts_.resize(0);
  find_bodies();
  find_members();
  find_frames(input.particles);
  // Where a collider goes is known in the first substep.
  searched_ =
      std::none_of(bodies_.begin(), bodies_.end(), [](const Body& body) { return body.packed.moves; });
  if (searched_) find_candidates(input.particles, input.velocity, 0, threads);
}

void ColliderContacts::find_bodies() {
  bodies_.clear();
  for (std::uint32_t c = 0; c < colliders_.size(); ++c) {
    const Collider& collider = colliders_[c];
    if (!collider.enabled) continue;
    Body body(c, collider);
    body.before = body.after = pose_at(collider.motion, step_.time);
    body.curvature_radius = curvature_radius(collider.shape);
    bodies_.push_back(body);
  }
}

void ColliderContacts::find_members() {
  members_.particle.clear(), members_.object.clear();
  if (bodies_.empty()) return;
  for (std::uint32_t object = 0; object < objects_.size(); ++object) {
    if (!objects_[object].collides_with_colliders) continue;
    for (std::uint32_t i = objects_[object].begin; i < objects_[object].end; ++i)
      members_.particle.push_back(i), members_.object.push_back(object);
  }
}

void ColliderContacts::find_frames(const ParticleView& particles) {
  for (Body& body : bodies_) {
    find_frame(body, particles);
    body.set_pose(body.before, body.after);
  }
}

// A plane's origin is its point nearest to the first particle: floats are fine there, wherever the plane's own
// origin is.
void ColliderContacts::find_frame(Body& body, const ParticleView& particles) const {
  const Shape& shape = shape_of(body);
  body.origin = center_of(shape);
  body.axes = Mat3d::identity();
  if (!std::holds_alternative<Plane>(shape)) return;
  const Vec3d near = members_.particle.empty()
                         ? Vec3d{}
                         : body.after.to_local(particles.exact_position(members_.particle[0]));
  const SurfaceDistance below = surface_distance(shape, near);
  body.origin = near - below.normal * below.distance;
  body.axes = axes_around(below.normal);
}

void ColliderContacts::find_candidates(const ParticleView& particles, std::span<const Vec4f> velocity,
                                       float h, Threads& threads) {
  candidates_.particle.clear(), candidates_.object.clear(), candidates_.keeps.clear();
  distance_.resize(members_.particle.size());
  members_.margins.begin(members_.particle, radius_, {velocity, h, step_.dt, step_.gravity}, particles,
                         threads);
  find_groups(particles);
  const double largest_margin = double(members_.margins.largest());
  const kernels::ColliderParticles packed = packed_particles(particles);
  for (Body& body : bodies_) {
    if (body.packed.moves)
      body.margin.begin(bounding_ball(shape_of(body)), 3 * largest_margin, body.before, body.after,
                        double(step_.dt) / double(h));
    find_candidates_of(body, packed, threads);
  }
}

// Members of one object are contiguous.
void ColliderContacts::find_groups(const ParticleView& particles) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  groups_.clear();
  const std::size_t count = members_.particle.size();
  for (std::size_t m = 0; m < count;) {
    Group group{
        members_.object[m], m, m, {infinity, infinity, infinity}, {-infinity, -infinity, -infinity}, 0, 0};
    for (; m < count && members_.object[m] == group.object; ++m) {
      const std::uint32_t i = members_.particle[m];
      const Vec3d x = particles.exact_position(i);
      for (int axis = 0; axis < 3; ++axis) {
        group.lo[axis] = min(group.lo[axis], x[axis]);
        group.hi[axis] = max(group.hi[axis], x[axis]);
      }
      group.margin = max(group.margin, double(members_.margins[m]));
      group.keeps = max(group.keeps, double(radius_[i]) + 2 * double(element_radius_[i]));
    }
    group.end = m;
    groups_.push_back(group);
  }
}

// Many colliders are far from most objects: the ball around a collider against the box around an object. A particle keeps
// no more than its radius and that of its elements, see corner_distance.
bool ColliderContacts::may_reach(const Group& group, const Body& body, double body_margin) const {
  if (!materials_->collide(group.object, body.collider)) return false;
  const BoundingBall ball = bounding_ball(shape_of(body));
  const Vec3d center = body.after.to_world(ball.center);
  double square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double beyond = max(0.0, max(group.lo[axis] - center[axis], center[axis] - group.hi[axis]));
    square += beyond * beyond;
  }
  const double reach = 1.001 * (ball.radius + 3 * (group.margin + body_margin) + 2 * group.keeps);
  return !(square > reach * reach);
}

void ColliderContacts::find_candidates_of(Body& body, const kernels::ColliderParticles& particles,
                                          Threads& threads) {
  body.candidate_begin = candidates_.particle.size();
  const double body_margin = body.packed.moves ? double(body.margin.margin()) : 0;
  const bool goes_anywhere = !(body_margin < std::numeric_limits<double>::infinity());
  for (const Group& group : groups_) {
    if (!may_reach(group, body, body_margin)) continue;
    if (!goes_anywhere)
      threads.for_each(group.end - group.begin, particle_grain, [&](std::size_t begin, std::size_t end) {
        kernels_->distances(particles, body.packed, members_.particle.data(), group.begin + begin,
                            group.begin + end, distance_.data());
      });
    for (std::size_t m = group.begin; m < group.end; ++m) {
      const std::uint32_t i = members_.particle[m];
      const double keeps =
          corner_distance(double(radius_[i]), double(element_radius_[i]), body.curvature_radius);
      const auto reach = float(3 * (double(members_.margins[m]) + body_margin) + 2 * keeps);
      if (!goes_anywhere && !(distance_[m] <= reach)) continue;
      candidates_.particle.push_back(i);
      candidates_.object.push_back(group.object);
      candidates_.keeps.push_back(float(keeps));
    }
  }
  body.candidate_end = candidates_.particle.size();
}

bool ColliderContacts::needs_search(const ParticleView& particles, Threads& threads) {
  if (!std::exchange(searched_, true)) return true;
  if (members_.margins.any_left(members_.particle, *kernels_, particles, threads)) {
    find_frames(particles);
    return true;
  }
  return std::any_of(bodies_.begin(), bodies_.end(), [](const Body& body) { return body.leaves(); });
}

void ColliderContacts::refresh(const ParticleView& particles, const Substep& substep, double time,
                               Threads& threads) {
  last_h_ = substep.h;
  contacts_.resize(0);
  for (Body& body : bodies_) body.contact_begin = body.contact_end = 0;
  if (bodies_.empty()) return;
  for (Body& body : bodies_) body.follow(colliders_[body.collider].motion, time, substep.h);
  if (needs_search(particles, threads)) find_candidates(particles, {}, substep.h, threads);
  for (Body& body : bodies_) find_contacts(body, particles, threads);
}

// Relative motion of a particle and the body in the substep, in the body's frame [m].
Vec3f ColliderContacts::relative_motion(const Body& body, std::uint32_t particle,
                                        const ParticleView& particles) {
  return Vec3f(body.after.to_local(particles.exact_position(particle)) -
               body.before.to_local(particles.exact_start(particle)));
}

// All threads find the near particles; one thread then counts them in order. So contacts and their order do
// not depend on the number of threads.
void ColliderContacts::find_contacts(Body& body, const ParticleView& particles, Threads& threads) {
  const kernels::ColliderParticles packed = packed_particles(particles);
  distance_.resize(std::max(distance_.size(), candidates_.particle.size()));
  threads.for_each(
      body.candidate_end - body.candidate_begin, particle_grain, [&](std::size_t begin, std::size_t end) {
        kernels_->find(packed, body.packed, candidates_.particle.data(), candidates_.keeps.data(),
                       body.candidate_begin + begin, body.candidate_begin + end, distance_.data());
      });
  near_.clear();
  for (std::size_t k = body.candidate_begin; k < body.candidate_end; ++k)
    if (distance_[k] < std::numeric_limits<float>::infinity()) near_.push_back(static_cast<std::uint32_t>(k));
  body.contact_begin = contacts_.size();
  body.contact_end = contacts_.size() + near_.size();
  contacts_.resize(body.contact_end);
  const kernels::ColliderContactColumns columns = contacts_.columns();
  threads.for_each(near_.size(), grain(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t contact = body.contact_begin + k, candidate = near_[k];
      const ContactMaterialPair material = materials_->at(candidates_.object[candidate], body.collider);
      columns.particle[contact] = candidates_.particle[candidate];
      columns.distance[contact] = candidates_.keeps[candidate];
      columns.end_distance[contact] = distance_[candidate];
      columns.static_friction[contact] = material.static_friction;
      columns.kinetic_friction[contact] = material.kinetic_friction;
      if (material.kinetic_friction < material.static_friction)
        columns.kinetic_friction[contact] =
            kinetic_friction_at(material, relative_motion(body, columns.particle[contact], particles),
                                step_.sliding_threshold(last_h_));
      columns.restitution[contact] = material.restitution;
      columns.slop[contact] = step_.depenetration_speed(material.radius) * last_h_;
      if (step_.turn.empty()) continue;
      columns.share[contact] = objects_[candidates_.object[candidate]].rolls ? inverse_inertia_factor : 0.0f;
      columns.radius[contact] = radius_[candidates_.particle[candidate]];
      columns.rolling_friction[contact] = material.rolling_friction;
      for (float* const sum : columns.moment_sum) sum[contact] = 0;
    }
    kernels_->describe(packed, body.packed, columns, body.contact_begin + begin, body.contact_begin + end);
  });
}

kernels::ColliderContactLimits ColliderContacts::limits() const {
  return {.inverse_h = 1 / last_h_, .restitution_threshold = step_.restitution_threshold(last_h_)};
}

kernels::ColliderParticles ColliderContacts::rolling_particles(const ParticleView& particles) const {
  kernels::ColliderParticles packed = packed_particles(particles);
  packed.turn = step_.turn.empty() ? nullptr : &step_.turn.data()->x;
  return packed;
}

void ColliderContacts::project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
                               const Substep&) {
  const Body& body = bodies_[static_cast<std::size_t>(color)];
  kernels_->project(rolling_particles(particles), body.packed, contacts_.columns(),
                    body.contact_begin + begin, body.contact_begin + end);
}

std::uint32_t ColliderContacts::particle_of(int color, std::size_t index,
                                            const ParticleView& particles) const {
  const std::size_t c = bodies_[static_cast<std::size_t>(color)].contact_begin + index;
  return particles.first_movable(std::array{contacts_.columns().particle[c]});
}

void ColliderContacts::visit_overlaps(const std::function<void(std::uint32_t)>& f) const {
  const kernels::ColliderContactColumns columns = contacts_.columns();
  for (std::size_t c = 0; c < contacts_.size(); ++c)
    if (columns.slop[c] < 0) f(columns.particle[c]);
}

void ColliderContacts::take_some(std::span<const std::uint32_t> chosen, std::vector<std::uint32_t>& taken) {
  some_.clear();
  // At first enough for a contact of each particle with one collider.
  if (some_.capacity() < size()) some_.reserve(std::max(chosen.size(), 2 * size()));
  const kernels::ColliderContactColumns columns = contacts_.columns();
  for (std::uint32_t c = 0; c < contacts_.size(); ++c)
    if (chosen[columns.particle[c]] != unchosen) some_.push_back(c), taken.push_back(columns.particle[c]);
}

void ColliderContacts::project_some(const ParticleView& particles, bool again) {
  if (some_.empty()) return;
  if (!again) return project_exactly(particles);
  const kernels::ColliderContactColumns columns = taken_.columns();
  const kernels::ColliderParticles packed = packed_particles(particles);
  auto body = bodies_.begin();
  for (std::size_t k = 0, end = 0; k < some_.size(); k = end) {
    while (some_[k] >= body->contact_end) ++body;
    end = static_cast<std::size_t>(std::lower_bound(some_.begin(), some_.end(), body->contact_end) -
                                   some_.begin());
    kernels_->project_again(packed, columns, k, end);
  }
}

// Neighbors in order are projected together. Copies what project_again needs.
void ColliderContacts::project_exactly(const ParticleView& particles) {
  const kernels::ColliderContactColumns columns = contacts_.columns();
  const kernels::ColliderParticles packed = rolling_particles(particles);
  auto body = bodies_.begin();
  for (std::size_t k = 0, end = 0; k < some_.size(); k = end) {
    while (some_[k] >= body->contact_end) ++body;
    for (end = k + 1;
         end < some_.size() && some_[end] == some_[end - 1] + 1 && some_[end] < body->contact_end;)
      ++end;
    kernels_->project(packed, body->packed, columns, some_[k], some_[end - 1] + std::size_t{1});
  }
  if (taken_.size() < some_.size()) taken_.resize(some_.capacity());
  copy_plane_contacts(columns, some_, taken_.columns());
}

void ColliderContacts::put_back_some() {
  const kernels::ColliderContactColumns from = taken_.columns(), to = contacts_.columns();
  for (std::size_t k = 0; k < some_.size(); ++k) {
    to.normal_sum[some_[k]] = from.normal_sum[k];
    for (int axis = 0; axis < 3; ++axis) to.tangent_sum[axis][some_[k]] = from.tangent_sum[axis][k];
  }
  some_.clear();
}

void ColliderContacts::apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                         const Substep&, Threads& threads) {
  kernels::ColliderParticles packed = rolling_particles(particles);
  packed.velocity = velocity.empty() ? nullptr : &velocity.data()->x;
  const kernels::ColliderContactColumns columns = contacts_.columns();
  for (const Body& body : bodies_)
    threads.for_each(body.contact_end - body.contact_begin, grain(), [&](std::size_t begin, std::size_t end) {
      kernels_->apply_restitution(packed, body.packed, limits(), columns, body.contact_begin + begin,
                                  body.contact_begin + end);
    });
}

void ColliderContacts::append_impacts(const Substep& substep, std::vector<Impact>& out) const {
  const kernels::ColliderContactColumns columns = contacts_.columns();
  const float inverse_h = 1 / substep.h;
  const auto vector = [](float* const(&of)[3], std::size_t c) { return Vec3f{of[0][c], of[1][c], of[2][c]}; };
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Vec3f normal = vector(columns.normal, c);
    const float approach = -dot(normal, vector(columns.predicted, c)) * inverse_h;
    if (!bounces(columns.normal_sum[c], columns.restitution[c], approach,
                 step_.restitution_threshold(substep.h)))
      continue;
    out.push_back({columns.particle[c], Impact::collider, normal, approach, columns.restitution[c],
                   vector(columns.surface_motion, c) * inverse_h});
  }
}

void ColliderContacts::visit_impulses(const ParticleView& particles, const ImpulseFunction& f) const {
  const kernels::ColliderContactColumns columns = contacts_.columns();
  const auto vector = [](float* const(&of)[3], std::size_t c) { return Vec3f{of[0][c], of[1][c], of[2][c]}; };
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    if (!(columns.normal_sum[c] > 0)) continue;
    ContactImpulse impulse = Anchor<1>{{columns.particle[c]}, {1}}.impulse(
        vector(columns.normal, c) * columns.normal_sum[c] + vector(columns.tangent_sum, c),
        particles.inverse_mass(columns.particle[c]));
    impulse.by_collider = true;
    f(impulse);
  }
}

ContactReport ColliderContacts::report() const {
  const kernels::ColliderContactColumns columns = contacts_.columns();
  return report_of(contacts_.size(), columns.normal_sum, columns.depth);
}

/// Calls f(body, contact, C, surface point in the kernels' frame).
template <class Function>
void ColliderContacts::for_each_gap(const ParticleView& particles, const Function& f) const {
  const kernels::ColliderContactColumns columns = contacts_.columns();
  const kernels::ColliderParticles packed = packed_particles(particles);
  float C[gap_chunk], surface[3][gap_chunk];
  float* const surfaces[3] = {surface[0], surface[1], surface[2]};
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    for (std::size_t begin = body.contact_begin; begin < body.contact_end; begin += gap_chunk) {
      const std::size_t end = std::min(begin + gap_chunk, body.contact_end);
      kernels_->gaps(packed, body.packed, columns, begin, end, C, surfaces);
      for (std::size_t c = begin; c < end; ++c)
        f(b, c, C[c - begin], Vec3f{surface[0][c - begin], surface[1][c - begin], surface[2][c - begin]});
    }
  }
}

void ColliderContacts::events(const ParticleView& particles, std::vector<ContactPush>& out) const {
  const kernels::ColliderContactColumns columns = contacts_.columns();
  const float inverse_h = last_h_ > 0 ? 1 / last_h_ : 0.0f;
  for_each_gap(particles, [&](std::size_t b, std::size_t c, float, const Vec3f& surface) {
    if (!(columns.normal_sum[c] > 0)) return;
    const Body& body = bodies_[b];
    const std::uint32_t i = columns.particle[c];
    const float impulse = normal_impulse(columns.normal_sum[c], columns.restitution_velocity[c], inverse_h,
                                         particles.inverse_mass(i));
    const Vec3d point = body.after.to_world(body.origin + body.axes * Vec3d(surface));
    out.push_back({i,
                   body.collider,
                   Vec3f(point),
                   {columns.normal[0][c], columns.normal[1][c], columns.normal[2][c]},
                   impulse,
                   true});
  });
}

void ColliderContacts::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  for_each_gap(particles, [&](std::size_t b, std::size_t c, float C, const Vec3f&) {
    visitor({{&contacts_.columns().particle[c], 1}, static_cast<int>(b), 0, max(0.0f, -C)});
  });
}

void ColliderContacts::clear() {
  bodies_.clear();
  members_.particle.clear(), members_.object.clear();
  candidates_ = {};
  some_.clear();
  contacts_.resize(0);
}

std::size_t ColliderContacts::bytes() const {
  return bytes_of(bodies_, groups_, members_.particle, members_.object, candidates_.particle,
                  candidates_.object, candidates_.keeps, distance_, near_, some_) +
         contacts_.bytes() + taken_.bytes() + members_.margins.bytes();
}

}  // namespace souple
