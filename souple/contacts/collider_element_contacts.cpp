#include "souple/contacts/collider_element_contacts.h"

#include "souple/contacts/element_clearance.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace souple {
namespace {

constexpr std::size_t corner_grain = 1024;  // least number of particles that pays for a thread
constexpr std::size_t element_grain = 256;  // least number of elements that pays for a thread
// Smallest elements that get contacts, as a part of a round shape's radius, or of the radius of another
// shape's bounding ball. With it, a cloth sinks into a ball by 0.2 % of the ball's radius at most. Without it, cotton
// of 1 m and 60 x 60 vertices is stretched on a box's edges by 40 % instead of 10 %. Contacts of elements are not part
// of StretchedLinks. A frame also takes twice as long on a cylinder or field.
constexpr double coarse_part = 0.05;
// An element that is deeper inside than this part of its radius has not been pulled in: the collider has jumped.
constexpr float deep_part = 0.5f;
// In a signed distance field, a side of an element is divided into at most this many parts. A longer side is sampled
// more coarsely than the field.
constexpr int most_parts = 12;

bool is_edge(const ContactElement& element) {
  return element.particle[1] == element.particle[2];
}

}  // namespace

void ColliderElementContacts::set_elements(std::vector<Element> elements) {
  elements_ = std::move(elements);
  std::stable_partition(elements_.begin(), elements_.end(), [](const Element& e) { return !is_edge(e); });
  given_ = elements_.size();
  triangles_ = static_cast<std::size_t>(
      std::count_if(elements_.begin(), elements_.end(), [](const Element& e) { return !is_edge(e); }));
  append_edges_of_triangles();
  find_corners();
  bodies_.clear();
  contacts_.clear();
  contacts_.reserve(256);
}

// Each edge once, with the radius of its largest triangle.
void ColliderElementContacts::append_edges_of_triangles() {
  std::vector<Element> edges;
  edges.reserve(3 * triangles_);
  for (std::size_t t = 0; t < triangles_; ++t) {
    const Element& triangle = elements_[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(triangle.particle[k], triangle.particle[(k + 1) % 3]);
      edges.push_back({{a, b, b}, triangle.object, triangle.radius});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Element& a, const Element& b) {
    return a.particle != b.particle ? a.particle < b.particle : a.radius > b.radius;
  });
  const auto same = [](const Element& a, const Element& b) { return a.particle == b.particle; };
  edges.erase(std::unique(edges.begin(), edges.end(), same), edges.end());
  elements_.insert(elements_.end(), edges.begin(), edges.end());
  elements_.shrink_to_fit();
}

void ColliderElementContacts::find_corners() {
  corners_.all.clear();
  objects_ = 0;
  largest_radius_ = 0;
  for (const Element& element : elements_) {
    for (const std::uint32_t i : element.particle) corners_.all.push_back({i, element.object});
    largest_radius_ = max(largest_radius_, element.radius);
    objects_ = std::max(objects_, element.object + 1);
  }
  const auto before = [](const Corner& a, const Corner& b) { return a.particle < b.particle; };
  const auto same = [](const Corner& a, const Corner& b) { return a.particle == b.particle; };
  std::sort(corners_.all.begin(), corners_.all.end(), before);
  corners_.all.erase(std::unique(corners_.all.begin(), corners_.all.end(), same), corners_.all.end());
  corners_.particle.clear();
  for (const Corner& corner : corners_.all) corners_.particle.push_back(corner.particle);
  corners_.first_float.clear();
  for (const Element& element : elements_) {
    std::array<std::uint32_t, 3> first;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at =
          std::lower_bound(corners_.particle.begin(), corners_.particle.end(), element.particle[k]);
      first[k] = 4 * static_cast<std::uint32_t>(at - corners_.particle.begin());
    }
    corners_.first_float.push_back(first);
  }
  corners_.distance.resize(corners_.all.size());
  corners_.from.resize(corners_.all.size()), corners_.to.resize(corners_.all.size());
  corners_.all_rows.resize(corners_.all.size());
  std::iota(corners_.all_rows.begin(), corners_.all_rows.end(), 0u);
  corners_.is_row.assign(corners_.all.size(), 0);
}

void ColliderElementContacts::begin_step(const ContactInput& input, Threads& threads) {
  colliders_ = input.tables.colliders, radius_ = input.radius;
  materials_ = &input.tables.against_colliders;
  kernels_ = &kernels::find_collider_element_kernels(instruction_set());
  particle_kernels_ = &kernels::find_collider_contact_kernels(instruction_set());
  step_ = input.step;
  contacts_.clear();
  find_bodies();
  if (bodies_.empty()) return;
  depenetrating_.assign(bodies_.size() * objects_, 0);
  searched_ = true;
  for (Body& body : bodies_) {
    if (body.packed.moves)
      searched_ = false;  // where it goes is known in the first substep
    else
      find_depenetrating(body, corners_.all, corners_.particle, input.particles, threads);
  }
  if (searched_) find_candidates(input.particles, input.velocity, 0, threads);
}

// Planes are skipped: the deepest point of an element is one of its corners.
void ColliderElementContacts::find_bodies() {
  bodies_.clear();
  if (elements_.empty()) return;
  for (std::uint32_t c = 0; c < colliders_.size(); ++c) {
    const Collider& collider = colliders_[c];
    if (!collider.enabled || std::holds_alternative<Plane>(collider.shape)) continue;
    Body body(c, collider);
    body.is_field = std::holds_alternative<SignedDistanceField>(collider.shape);
    const double curvature = curvature_radius(collider.shape);
    const double smallest =
        curvature > 0 ? coarse_element_part * curvature : coarse_part * bounding_ball(collider.shape).radius;
    if (double(largest_radius_) < smallest) continue;
    body.smallest_radius = float(smallest);
    body.origin = center_of(collider.shape);
    if (body.is_field) {
      body.packed.shape.sample = nullptr;  // the grid reaches farther than any contact
      const float side = 2 * largest_radius_, spacing = body.packed.shape.grid.spacing;
      body.parts = static_cast<int>(min(side / spacing, float(most_parts - 1))) + 1;
      body.gap = max(spacing, side / float(body.parts));
    }
    if (!body.packed.moves) {
      const RigidPose pose = pose_at(collider.motion, step_.time);
      body.set_pose(pose, pose);
    }
    bodies_.push_back(body);
  }
}

float ColliderElementContacts::radius_of(const Element& element) const {
  return min(radius_[element.particle[0]], min(radius_[element.particle[1]], radius_[element.particle[2]]));
}

// Positions of corners in the body's frame.
void ColliderElementContacts::place(const Body& body, std::span<const std::uint32_t> rows,
                                    const ParticleView& particles, Threads& threads) {
  const kernels::ColliderParticles packed = packed_particles(particles);
  threads.for_each(rows.size(), corner_grain, [&](std::size_t begin, std::size_t end) {
    kernels_->place(packed, body.packed, corners_.particle.data(), rows.data(), begin, end,
                    {&corners_.from.data()->x, &corners_.to.data()->x});
  });
}

void ColliderElementContacts::find_candidates(const ParticleView& particles, std::span<const Vec4f> velocity,
                                              float h, Threads& threads) {
  corners_.margins.begin(corners_.particle, radius_, {velocity, h, step_.dt, step_.gravity}, particles,
                         threads);
  candidates_.resize(0);
  corners_.rows.clear();
  corners_.near.clear(), corners_.near_particle.clear();
  for (Body& body : bodies_) {
    if (body.packed.moves) {
      const double near = 3 * double(corners_.margins.largest()) + 2 * double(largest_radius_);
      body.margin.begin(bounding_ball(colliders_[body.collider].shape), near, body.before, body.after,
                        double(step_.dt) / double(h));
      find_near_corners(body, particles, threads);
    }
    find_candidates_of(body, particles, threads);
    find_rows(body);
  }
  const Candidates all = candidates_.columns();
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    all.u[c] = all.v[c] = 1 / 3.f;
    all.travel[c] = std::numeric_limits<float>::infinity(), all.clear_for[c] = 0;
  }
}

void ColliderElementContacts::find_candidates_of(Body& body, const ParticleView& particles,
                                                 Threads& threads) {
  const std::size_t first = candidates_.size(), count = body.is_field ? given_ : elements_.size();
  candidates_.resize(first + count);
  const Candidates all = candidates_.columns();
  std::size_t last = first;
  const float body_margin = body.packed.moves ? body.margin.margin() : 0;
  body.candidate_begin = first;
  for (std::uint32_t e = 0; e < count; ++e) {
    const Element& element = elements_[e];
    if (element.radius < body.smallest_radius) continue;
    if (!materials_->collide(element.object, body.collider)) continue;
    const auto& [i, j, k] = element.particle;
    if (!(particles.inverse_mass(i) > 0 || particles.inverse_mass(j) > 0 || particles.inverse_mass(k) > 0))
      continue;
    const auto& row = corners_.first_float[e];
    const MotionMargins& margins = corners_.margins;
    const float margin = max(margins[row[0] / 4], max(margins[row[1] / 4], margins[row[2] / 4]));
    all.element[last] = e, all.radius[last] = radius_of(element),
    all.reach[last] = 3 * (margin + body_margin);
    for (std::size_t n = 0; n < 3; ++n) all.corner[n][last] = row[n];
    ++last;
  }
  candidates_.resize(last);
  if (body_margin < std::numeric_limits<float>::infinity()) {
    place(body, corners_.all_rows, particles, threads);
    const kernels::ColliderFrameRecords records{&corners_.from.data()->x, &corners_.to.data()->x};
    const auto test = [&](auto kernel, std::size_t from, std::size_t to) {
      threads.for_each(to - from, element_grain, [&](std::size_t begin, std::size_t end) {
        kernel(body.packed, records, all.elements(0), all.reach, from + begin, from + end, all.near);
      });
    };
    const std::size_t middle = body.is_field ? last : first_edge(first);
    test(kernels_->near_triangles, first, middle);
    test(kernels_->near_edges, middle, last);
    keep_near(first);
  }
  body.triangle_end = first_edge(first);
  body.candidate_end = candidates_.size();
}

void ColliderElementContacts::keep_near(std::size_t begin) {
  const Candidates all = candidates_.columns();
  std::size_t kept = begin;
  for (std::size_t c = begin; c < candidates_.size(); ++c)
    if (all.near[c] > 0) candidates_.copy(c, kept++);
  candidates_.resize(kept);
}

std::size_t ColliderElementContacts::first_edge(std::size_t candidate) const {
  const std::uint32_t* const element = candidates_.columns().element;
  return static_cast<std::size_t>(
      std::lower_bound(element + candidate, element + candidates_.size(), triangles_) - element);
}

void ColliderElementContacts::find_rows(Body& body) {
  const Candidates all = candidates_.columns();
  body.row_begin = corners_.rows.size();
  for (std::size_t c = body.candidate_begin; c < body.candidate_end; ++c) {
    for (const std::uint32_t* const column : all.corner) {
      const std::uint32_t row = column[c] / 4;
      if (corners_.is_row[row] != 0) continue;
      corners_.is_row[row] = 1;
      corners_.rows.push_back(row);
    }
  }
  body.row_end = corners_.rows.size();
  for (std::size_t r = body.row_begin; r < body.row_end; ++r) corners_.is_row[corners_.rows[r]] = 0;
}

void ColliderElementContacts::find_near_corners(Body& body, const ParticleView& particles, Threads& threads) {
  const kernels::ColliderParticles packed = packed_particles(particles);
  threads.for_each(corners_.all.size(), corner_grain, [&](std::size_t begin, std::size_t end) {
    particle_kernels_->distances(packed, body.packed, corners_.particle.data(), begin, end,
                                 corners_.distance.data());
  });
  body.near_corner_begin = corners_.near.size();
  for (std::size_t c = 0; c < corners_.all.size(); ++c) {
    if (!(corners_.distance[c] <= 3 * (corners_.margins[c] + body.margin.margin()))) continue;
    corners_.near.push_back(corners_.all[c]);
    corners_.near_particle.push_back(corners_.particle[c]);
  }
  body.near_corner_end = corners_.near.size();
}

bool ColliderElementContacts::needs_search(const ParticleView& particles, Threads& threads) {
  if (!std::exchange(searched_, true)) return true;
  return corners_.margins.any_left(corners_.particle, *particle_kernels_, particles, threads) ||
         std::any_of(bodies_.begin(), bodies_.end(), [](const Body& body) { return body.leaves(); });
}

void ColliderElementContacts::refresh(const ParticleView& particles, const Substep& substep, double time,
                                      Threads& threads) {
  contacts_.clear();
  last_h_ = substep.h;
  if (bodies_.empty()) return;
  for (Body& body : bodies_) body.follow(colliders_[body.collider].motion, time, substep.h);
  if (needs_search(particles, threads)) find_candidates(particles, {}, substep.h, threads);
  for (Body& body : bodies_) {
    if (body.packed.moves) {
      const std::size_t first = body.near_corner_begin, count = body.near_corner_end - first;
      find_depenetrating(body, std::span(corners_.near).subspan(first, count),
                         std::span(corners_.near_particle).subspan(first, count), particles, threads);
    }
    find_contacts(body, particles, substep.h, threads);
  }
}

// Where a collider has jumped into an object, contacts of the corners (ColliderContacts) move them out
// slowly. Contacts of elements at the same time would tear the object. They wait until no corner is inside by more than
// its radius, and no element deeply. (A small overlap of elements is no reason to wait. Edges pull stretched cloth over
// them by some millimeters at impact, and it would then stay inside.)
void ColliderElementContacts::find_depenetrating(Body& body, std::span<const Corner> corners,
                                                 std::span<const std::uint32_t> particle,
                                                 const ParticleView& particles, Threads& threads) {
  std::uint8_t* const depenetrating = depenetrating_of(body);
  std::fill_n(depenetrating, objects_, std::uint8_t{0});
  kernels::ColliderBody at_start = body.packed;
  at_start.after = at_start.before;
  kernels::ColliderParticles start = packed_particles(particles);
  start.moving = start.start;
  threads.for_each(corners.size(), corner_grain, [&](std::size_t begin, std::size_t end) {
    particle_kernels_->distances(start, at_start, particle.data(), begin, end, corners_.distance.data());
  });
  for (std::size_t c = 0; c < corners.size(); ++c)
    if (corners_.distance[c] < -radius_[corners[c].particle]) depenetrating[corners[c].object] = 1;
}

// All threads test the candidates; one thread then appends the contacts in order. So the contacts and their
// order do not depend on the number of threads.
void ColliderElementContacts::find_contacts(Body& body, const ParticleView& particles, float h,
                                            Threads& threads) {
  body.contact_begin = body.contact_end = contacts_.size();
  if (body.candidate_begin == body.candidate_end) return;
  place(body, std::span(corners_.rows).subspan(body.row_begin, body.row_end - body.row_begin), particles,
        threads);
  find_touches(body, threads);
  const Candidates all = candidates_.columns();
  std::uint8_t* const depenetrating = depenetrating_of(body);
  for (std::size_t c = body.candidate_begin; c < body.candidate_end; ++c) {
    const Element& element = elements_[all.element[c]];
    const float depth = max(all.radius[c], deep_part * element.radius);
    if (all.touch.start_distance[c] < -depth) depenetrating[element.object] = 1;
  }
  for (std::size_t c = body.candidate_begin; c < body.candidate_end; ++c) {
    if (!(all.touch.touches[c] > 0) || depenetrating[elements_[all.element[c]].object] != 0) continue;
    Contact contact{};
    if (contact_of(body, all, c, particles, h, contact)) contacts_.push_back(contact);
  }
  body.contact_end = contacts_.size();
}

void ColliderElementContacts::find_touches(const Body& body, Threads& threads) {
  const Candidates all = candidates_.columns();
  const auto elements = all.elements(float(element_clearance_part));
  const kernels::ColliderFrameRecords records{&corners_.from.data()->x, &corners_.to.data()->x};
  const std::size_t first = body.candidate_begin, middle = body.triangle_end, last = body.candidate_end;
  if (body.is_field) return find_touches_of_field(body, threads);
  threads.for_each(middle - first, element_grain, [&](std::size_t begin, std::size_t end) {
    kernels_->find_triangles(body.packed, records, elements, first + begin, first + end, all.touch);
  });
  threads.for_each(last - middle, element_grain, [&](std::size_t begin, std::size_t end) {
    kernels_->find_edges(body.packed, records, elements, middle + begin, middle + end, all.touch);
  });
}

// A field's surface has bumps, so an element is sampled at about the field's spacing, when it is new or has moved by
// that since. Otherwise the search starts at the deepest point of the last substep. An element whose lowest sample is
// far from the surface is left out until it has moved as far.
void ColliderElementContacts::find_touches_of_field(const Body& body, Threads& threads) {
  const Candidates all = candidates_.columns();
  const float spacing = body.packed.shape.grid.spacing;
  for (float* const column : {all.touch.touches, all.touch.start_distance})
    std::fill(column + body.candidate_begin, column + body.candidate_end, 0.0f);
  stale_.clear(), near_.clear();
  for (std::size_t c = body.candidate_begin; c < body.candidate_end; ++c) {
    const auto path_of = [&](std::size_t k) { return corners_.from[all.corner[k][c] / 4].w; };
    const float path = max(path_of(0), max(path_of(1), path_of(2)));
    all.clear_for[c] -= path;
    if (all.clear_for[c] > 0) continue;
    near_.push_back(static_cast<std::uint32_t>(c));
    all.travel[c] += path;
    all.limit[c] = all.radius[c] + path;
    if (!(all.travel[c] <= spacing)) stale_.push_back(static_cast<std::uint32_t>(c));
  }
  const auto elements = all.elements(float(element_clearance_part));
  const kernels::ColliderFrameRecords records{&corners_.from.data()->x, &corners_.to.data()->x};
  const kernels::ColliderFieldSearch search{all.u, all.v, all.lower, all.limit, body.parts, body.gap};
  threads.for_each(stale_.size(), element_grain, [&](std::size_t begin, std::size_t end) {
    kernels_->sample_field_elements(body.packed, records, elements, search, stale_.data(), begin, end);
  });
  for (const std::uint32_t c : stale_) {
    all.clear_for[c] = all.lower[c] - all.limit[c];
    all.travel[c] = all.clear_for[c] > 0 ? std::numeric_limits<float>::infinity() : 0;
  }
  std::erase_if(near_, [&](std::uint32_t c) { return all.clear_for[c] > 0; });
  threads.for_each(near_.size(), element_grain, [&](std::size_t begin, std::size_t end) {
    kernels_->find_in_field(body.packed, records, elements, search, near_.data(), begin, end, all.touch);
  });
}

bool ColliderElementContacts::contact_of(const Body& body, const Candidates& all, std::size_t candidate,
                                         const ParticleView& particles, float h, Contact& contact) const {
  const Element& element = elements_[all.element[candidate]];
  contact.anchor.particle = element.particle;
  Vec3d start, end;
  for (std::size_t k = 0; k < 3; ++k) {
    const float w = all.touch.weight[k][candidate];
    const std::uint32_t i = element.particle[k];
    contact.anchor.weight[k] = w;
    start += particles.exact_start(i) * double(w);
    end += particles.exact_position(i) * double(w);
  }
  contact.inverse_mass = contact.anchor.inverse_mass(particles);
  Vec3d n;
  for (int axis = 0; axis < 3; ++axis) n[axis] = double(all.touch.normal[axis][candidate]);
  const double offset = double(all.touch.plane_offset[candidate]) + dot(n, body.origin);
  const double target = element_clearance_part * double(all.radius[candidate]);
  contact.target = float(target);
  contact.material = materials_->at(element.object, body.collider);
  contact.normal = Vec3f(body.after.rotation * n);
  contact.start_gap = float(dot(n, body.after.to_local(start)) - offset - target);
  contact.predicted = Vec3f(body.after.rotation * (body.after.to_local(end) - body.before.to_local(start)));
  if (body.packed.moves) contact.surface_motion = Vec3f(end - body.before.to_world(body.after.to_local(end)));
  contact.material.kinetic_friction = kinetic_friction_at(
      contact.material, Vec3f(end - start) - contact.surface_motion, step_.sliding_threshold(h));
  const double overlap = double(all.touch.start_distance[candidate]) - target;
  contact.slop =
      overlap < 0 ? float(min(0.0, overlap + double(step_.depenetration_speed(contact.material.radius) * h)))
                  : 0.0f;
  return contact.inverse_mass > 0;
}

// The plane is fixed within the substep, so C changes by the point's motion along the normal.
float ColliderElementContacts::gap(const Contact& contact, const ParticleView& particles) {
  return contact.start_gap + dot(contact.normal, contact.anchor.moved(particles));
}

void ColliderElementContacts::project(int, std::size_t begin, std::size_t end, const ParticleView& particles,
                                      const Substep&) {
  for (std::size_t c = begin; c < end; ++c) project_one(contacts_[c], particles);
}

std::uint32_t ColliderElementContacts::particle_of(int, std::size_t index,
                                                   const ParticleView& particles) const {
  return particles.first_movable(contacts_[index].anchor.particle);
}

// As ColliderContacts::project, for a point of an element.
void ColliderElementContacts::project_one(Contact& contact, const ParticleView& particles) {
  const Vec3f motion = contact.anchor.moved(particles);
  const float C = contact.start_gap + dot(contact.normal, motion);
  if (!(contact.slop > C) && !(contact.sums.normal_sum > 0)) return;
  const Vec3f change = solve_contact(contact.sums, C, contact.slop, contact.normal,
                                     motion - contact.surface_motion, contact.material);
  contact.anchor.correct(particles, change, contact.inverse_mass);
}

void ColliderElementContacts::apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                                const Substep& substep, Threads&) {
  for (Contact& contact : contacts_) apply_restitution_to(contact, particles, velocity, substep.h);
}

// As ColliderContacts::apply_restitution.
void ColliderElementContacts::apply_restitution_to(Contact& contact, const ParticleView& particles,
                                                   std::span<Vec4f> velocity, float h) const {
  if (!(contact.sums.normal_sum > 0)) return;
  const Vec3f u = contact.anchor.velocity(velocity) - contact.surface_motion * (1 / h);
  const float inverse_h = 1 / h;
  const auto [change, restitution_velocity] =
      solve_restitution(contact.sums, contact.normal, u, -dot(contact.normal, contact.predicted) * inverse_h,
                        step_.restitution_threshold(h), contact.material, inverse_h);
  contact.restitution_velocity = restitution_velocity;
  contact.anchor.accelerate(velocity, particles, change, contact.inverse_mass);
  contact.depth = max(0.0f, -gap(contact, particles));
}

void ColliderElementContacts::visit_impulses(const ParticleView&, const ImpulseFunction& f) const {
  for (const Contact& contact : contacts_) {
    if (!(contact.sums.normal_sum > 0)) continue;
    ContactImpulse impulse = contact.anchor.impulse(
        contact.normal * contact.sums.normal_sum + contact.sums.tangent_sum, contact.inverse_mass);
    impulse.by_collider = true;
    f(impulse);
  }
}

ContactReport ColliderElementContacts::report() const {
  return report_of(contacts_);
}

void ColliderElementContacts::events(const ParticleView& particles, std::vector<ContactPush>& out) const {
  const float inverse_h = last_h_ > 0 ? 1 / last_h_ : 0.0f;
  for (const Body& body : bodies_) {
    for (std::size_t c = body.contact_begin; c < body.contact_end; ++c) {
      const Contact& contact = contacts_[c];
      if (!(contact.sums.normal_sum > 0)) continue;
      const auto& [particle, weight] = contact.anchor;
      const auto heaviest = std::max_element(weight.begin(), weight.end());
      const auto k = static_cast<std::size_t>(heaviest - weight.begin());
      Vec3d point;
      for (std::size_t j = 0; j < 3; ++j) point += particles.exact_position(particle[j]) * double(weight[j]);
      const auto C = double(gap(contact, particles));
      const Vec3d n(contact.normal);
      const float impulse = normal_impulse(contact.sums.normal_sum, contact.restitution_velocity, inverse_h,
                                           contact.inverse_mass);
      out.push_back({particle[k], body.collider, Vec3f(point - n * (C + double(contact.target))), Vec3f(n),
                     impulse, true});
    }
  }
}

void ColliderElementContacts::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  for (const Contact& contact : contacts_) {
    const auto& particle = contact.anchor.particle;
    const std::size_t corners = particle[1] == particle[2] ? 2 : 3;
    visitor({{particle.data(), corners}, 0, 0, max(0.0f, -gap(contact, particles))});
  }
}

std::size_t ColliderElementContacts::bytes() const {
  return bytes_of(elements_, corners_.all, corners_.particle, corners_.first_float, bodies_,
                  corners_.distance, corners_.from, corners_.to, corners_.all_rows, corners_.is_row,
                  corners_.rows, corners_.near, corners_.near_particle, stale_, near_, contacts_) +
         corners_.margins.bytes() + candidates_.bytes();
}

}  // namespace souple
