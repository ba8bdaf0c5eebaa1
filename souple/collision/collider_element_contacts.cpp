#include "souple/collision/collider_element_contacts.h"

#include "souple/collision/contact_law.h"
#include "souple/collision/element_clearance.h"
#include "souple/collision/particle_position.h"
#include "souple/error.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <utility>

namespace souple {
namespace {

constexpr std::size_t element_grain = 256;  // least number of elements that pays for a thread
constexpr std::size_t search_grain = 8;     // least number of searches that pays for a thread
// Smallest elements that get contacts, as a part of a round shape's radius, or of the radius of another
// shape's bounding ball. Without this limit a fine cloth on a large table would pay for every triangle at the
// table's edges, ten times the rest of its step. With it, a cloth sinks into a ball by 0.2 % of the ball's
// radius at most.
constexpr double coarse_part = 0.05;

bool is_edge(const ColliderElementContacts::Element& element) {
  return element.particle[1] == element.particle[2];
}

/// A ball around an element.
struct Ball {
  Vec3d middle;
  double radius;
};

Ball ball_about(const std::array<Vec3d, 3>& x, bool edge) {
  const Vec3d middle = edge ? (x[0] + x[1]) * 0.5 : (x[0] + x[1] + x[2]) / 3.0;
  double squared = 0;
  for (const Vec3d& corner : x) squared = max(squared, length_squared(corner - middle));
  return {middle, sqrt(squared)};
}

}  // namespace

void ColliderElementContacts::set_elements(std::vector<Element> elements) {
  elements_ = std::move(elements);
  corners_.clear();
  objects_ = 0;
  largest_radius_ = 0;
  for (const Element& element : elements_) {
    for (const std::uint32_t i : element.particle) corners_.push_back({i, element.object});
    largest_radius_ = max(largest_radius_, element.radius);
    objects_ = std::max(objects_, element.object + 1);
  }
  const auto before = [](const Corner& a, const Corner& b) { return a.particle < b.particle; };
  const auto same = [](const Corner& a, const Corner& b) { return a.particle == b.particle; };
  std::sort(corners_.begin(), corners_.end(), before);
  corners_.erase(std::unique(corners_.begin(), corners_.end(), same), corners_.end());
  bodies_.clear();
  contacts_.clear();
  tested_.reserve(elements_.size());
  candidates_.reserve(elements_.size());
  contacts_.reserve(256);
  found_.resize(std::min<std::size_t>(elements_.size(), 256));
}

void ColliderElementContacts::begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                                         std::span<const float> radius, std::span<const Collider> colliders,
                                         const ContactMaterialTable& materials, const ContactStep& step,
                                         Threads& threads) {
  colliders_ = colliders, radius_ = radius;
  materials_ = &materials;
  step_ = step;
  contacts_.clear();
  find_bodies();
  if (bodies_.empty()) return;
  depenetrating_.assign(bodies_.size() * objects_, 0);
  for (Body& body : bodies_)
    if (!body.moves) find_depenetrating(body, particles, threads);
  find_candidates(particles, velocity, 0, threads);
}

// Planes are skipped: the deepest point of an element is one of its corners.
void ColliderElementContacts::find_bodies() {
  bodies_.clear();
  if (elements_.empty()) return;
  for (std::uint32_t c = 0; c < colliders_.size(); ++c) {
    const Collider& collider = colliders_[c];
    if (!collider.enabled || std::holds_alternative<Plane>(collider.shape)) continue;
    Body body;
    body.collider = c;
    body.moves = !collider.motion.is_static();
    body.ball = bounding_ball(collider.shape);
    const double curvature = curvature_radius(collider.shape);
    body.smallest_radius = curvature > 0 ? coarse_element_part * curvature : coarse_part * body.ball.radius;
    if (double(largest_radius_) < body.smallest_radius) continue;
    if (!body.moves) body.before = body.after = pose_at(collider.motion, step_.time);
    bodies_.push_back(body);
  }
}

float ColliderElementContacts::radius_of(const Element& element) const {
  return min(radius_[element.particle[0]], min(radius_[element.particle[1]], radius_[element.particle[2]]));
}

// The margins are those of ColliderContacts: a particle's radius plus twice its path in a step at its present
// speed and under gravity.
void ColliderElementContacts::find_candidates(const ParticleView& particles, std::span<const Vec4f> velocity,
                                              float h, Threads& threads) {
  candidates_.clear();
  broad_phase_position_.resize(particles.position.size());
  margin_.resize(particles.position.size());
  near_.resize(elements_.size());
  const float t = step_.dt;
  threads.for_each(corners_.size(), element_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const std::uint32_t i = corners_[c].particle;
      const float speed = h > 0 ? length(particles.moved(i)) / h : length(velocity[i].xyz());
      broad_phase_position_[i] = particle_position(particles, i);
      margin_[i] = 2 * t * (speed + step_.gravity * t) + radius_[i];
    }
  });
  for (Body& body : bodies_) {
    threads.for_each(elements_.size(), element_grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) near_[f] = is_candidate(body, f, particles) ? 1 : 0;
    });
    body.candidate_begin = candidates_.size();
    for (std::uint32_t f = 0; f < elements_.size(); ++f)
      if (near_[f] != 0) candidates_.push_back(f);
    body.candidate_end = candidates_.size();
  }
}

// A moving body may go anywhere within the step. So all elements that may need contacts with it are its
// candidates, and are tested in every substep.
bool ColliderElementContacts::is_candidate(const Body& body, std::size_t element,
                                           const ParticleView& particles) const {
  const Element& f = elements_[element];
  if (double(f.radius) < body.smallest_radius) return false;
  if (!materials_->collide(f.object, body.collider)) return false;
  const auto& [a, b, c] = f.particle;
  const Corners x{broad_phase_position_[a], broad_phase_position_[b], broad_phase_position_[c]};
  const Ball ball = ball_about(x, is_edge(f));
  if (!(particles.inverse_mass(a) > 0 || particles.inverse_mass(b) > 0 || particles.inverse_mass(c) > 0))
    return false;
  if (body.moves) return true;
  const double range = ball.radius + 3 * double(max(margin_[a], max(margin_[b], margin_[c])));
  const double clear = body.ball.radius + range;
  const Vec3d middle = body.after.to_local(ball.middle);
  if (!(length_squared(middle - body.ball.center) <= clear * clear)) return false;
  return surface_distance(shape_of(body), middle).distance <= range;
}

bool ColliderElementContacts::left_margins(const ParticleView& particles) const {
  return std::any_of(corners_.begin(), corners_.end(), [&](const Corner& corner) {
    const std::uint32_t i = corner.particle;
    const double margin = double(margin_[i]);
    return length_squared(particle_position(particles, i) - broad_phase_position_[i]) > margin * margin;
  });
}

void ColliderElementContacts::refresh(const ParticleView& particles, const Substep& substep, double time,
                                      Threads& threads) {
  contacts_.clear();
  last_h_ = substep.h;
  if (bodies_.empty()) return;
  for (Body& body : bodies_) {
    if (!body.moves) continue;
    const auto [before, after] =
        poses_between(colliders_[body.collider].motion, time, time + double(substep.h));
    body.before = before, body.after = after;
  }
  if (left_margins(particles)) find_candidates(particles, {}, substep.h, threads);
  for (Body& body : bodies_) {
    if (body.moves) find_depenetrating(body, particles, threads);
    find_contacts(body, particles, substep.h, threads);
  }
}

// All threads test the candidates; one thread then appends the contacts in order. So the contacts and their
// order do not depend on the number of threads.
void ColliderElementContacts::find_contacts(Body& body, const ParticleView& particles, float h,
                                            Threads& threads) {
  const std::size_t count = body.candidate_end - body.candidate_begin;
  const std::uint32_t* candidates = candidates_.data() + body.candidate_begin;
  if (near_.size() < count) near_.resize(count);
  threads.for_each(count, element_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      near_[k] = may_touch(body, elements_[candidates[k]], particles) ? 1 : 0;
  });
  tested_.clear();
  for (std::uint32_t k = 0; k < count; ++k)
    if (near_[k] != 0) tested_.push_back(candidates[k]);
  if (found_.size() < tested_.size()) found_.resize(2 * tested_.size());
  threads.for_each(tested_.size(), search_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      found_[k].touches = contact_of(body, elements_[tested_[k]], particles, h, found_[k]);
  });
  for (std::size_t k = 0; k < tested_.size(); ++k)
    if (found_[k].inside) depenetrating_of(body)[elements_[tested_[k]].object] = 1;
  body.contact_begin = contacts_.size();
  for (std::size_t k = 0; k < tested_.size(); ++k)
    if (found_[k].touches && !is_depenetrating(body, elements_[tested_[k]].object))
      contacts_.push_back(found_[k].contact);
  body.contact_end = contacts_.size();
}

// Where a collider has jumped into an object, contacts of the corners (ColliderContacts) move them out
// slowly. Contacts of elements at the same time would tear the object, so they wait until no corner is
// inside.
void ColliderElementContacts::find_depenetrating(Body& body, const ParticleView& particles,
                                                 Threads& threads) {
  std::uint8_t* const depenetrating = depenetrating_of(body);
  std::fill_n(depenetrating, objects_, std::uint8_t{0});
  near_.resize(max(near_.size(), corners_.size()));
  threads.for_each(corners_.size(), element_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Vec3d x = body.before.to_local(particle_start_position(particles, corners_[c].particle));
      const double range = body.ball.radius;
      near_[c] = length_squared(x - body.ball.center) < range * range &&
                         surface_distance(shape_of(body), x).distance < 0
                     ? 1
                     : 0;
    }
  });
  for (std::size_t c = 0; c < corners_.size(); ++c)
    if (near_[c] != 0) depenetrating[corners_[c].object] = 1;
}

ColliderElementContacts::Corners ColliderElementContacts::corners(const RigidPose& pose,
                                                                  const Element& element,
                                                                  const ParticleView& particles,
                                                                  bool start) const {
  Corners x;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t i = element.particle[k];
    x[k] = pose.to_local(start ? particle_start_position(particles, i) : particle_position(particles, i));
  }
  return x;
}

// Upper bound of an element's depth below its lowest corner, where d is convex: with the middle m and the
// corner x that is lowest along n(m),
//   d(x) - (d(m) + n(m) . (x - m)).
// It is 0 where the surface below the element is flat.
double ColliderElementContacts::sag(const Shape& shape, const Corners& x, const Vec3d& middle,
                                    const SurfaceDistance& at_middle) {
  std::size_t low = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (dot(at_middle.normal, x[k] - x[low]) < 0) low = k;
  return surface_distance(shape, x[low]).distance - at_middle.distance -
         dot(at_middle.normal, x[low] - middle);
}

// The distance d to a convex shape is a convex function. On the whole path of the element it is at least
//   d(m) + min_k n(m) . (x_k - m),   m the middle, x_k the corners at the path's start and end.
// An element also needs no contact if its sag is so small that its corners' contacts suffice. Each test takes
// one distance query. For shapes that are not convex both tests are good guesses.
bool ColliderElementContacts::may_touch(const Body& body, const Element& element,
                                        const ParticleView& particles) const {
  const Corners x = corners(body.before, element, particles, true);
  const bool edge = is_edge(element);
  const Ball ball = ball_about(x, edge);
  const double r = double(radius_of(element)), range = 2 * (ball.radius + r);
  if (!body.moves) {
    double max_motion = 0;
    for (const std::uint32_t i : element.particle)
      max_motion = max(max_motion, double(length(particles.moved(i))));
    const double clear = body.ball.radius + range + max_motion;
    if (!(length_squared(ball.middle - body.ball.center) <= clear * clear)) return false;
  }
  const Shape& shape = shape_of(body);
  const SurfaceDistance surface = surface_distance(shape, ball.middle);
  const Corners to = corners(body.after, element, particles, false);
  double lowest = 0, path = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    lowest =
        min(lowest, min(dot(surface.normal, x[k] - ball.middle), dot(surface.normal, to[k] - ball.middle)));
    path = max(path, length_squared(to[k] - x[k]));
  }
  if (surface.distance > range + sqrt(path) || surface.distance + lowest >= 1.2 * element_clearance_part * r)
    return false;
  const double min_sag = 0.8 * (1 - element_clearance_part) * r;
  if (sag(shape, x, ball.middle, surface) > min_sag) return true;
  if (path <= r * r) return false;
  const Vec3d middle = ball_about(to, edge).middle;
  return sag(shape, to, middle, surface_distance(shape, middle)) > min_sag;
}

// The point q = sum_k w_k x_k, its distance d and normal n, and the gap of Frank and Wolfe,
//   g = max_k n . (q - x_k).
// Where d is convex, d - g is a lower bound of the element's distance. So the search for an element farther
// than `limit` ends early.
ColliderElementContacts::Deepest ColliderElementContacts::evaluate(const Shape& shape, const Corners& x,
                                                                   const std::array<double, 3>& weight) {
  Deepest at{weight, x[0] * weight[0] + x[1] * weight[1] + x[2] * weight[2], {}, 0};
  at.surface = surface_distance(shape, at.point);
  for (const Vec3d& corner : x) at.gap = max(at.gap, dot(at.surface.normal, at.point - corner));
  return at;
}

// The lowest point between the points with weights a and b, where d is convex: bisection of the slope of d,
// which may be discontinuous.
ColliderElementContacts::Deepest ColliderElementContacts::deepest_between(const Shape& shape,
                                                                          const Corners& x,
                                                                          const std::array<double, 3>& a,
                                                                          const std::array<double, 3>& b) {
  constexpr int bisections = 12;
  const auto at = [&](const std::array<double, 3>& w) { return x[0] * w[0] + x[1] * w[1] + x[2] * w[2]; };
  const Vec3d start = at(a), direction = at(b) - start;
  double falls = 0, rises = 1;
  for (int half = 0; half < bisections; ++half) {
    const double middle = 0.5 * (falls + rises);
    const Vec3d n = surface_distance(shape, start + direction * middle).normal;
    (dot(n, direction) < 0 ? falls : rises) = middle;
  }
  const double s = falls == 0 ? 0 : (rises == 1 ? 1 : 0.5 * (falls + rises));
  return evaluate(shape, x, {a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s, a[2] + (b[2] - a[2]) * s});
}

// f(w_2) = min over w_1 of d is convex where d is. So a golden-section search finds the minimum of any such
// d, even at the fold of d along a box's edge, which methods that follow the gradient do not reach.
ColliderElementContacts::Deepest ColliderElementContacts::deepest_by_sections(const Shape& shape,
                                                                              const Corners& x) {
  constexpr int sections = 16;
  constexpr double golden = 0.6180339887498949;
  const auto row = [&](double w) { return deepest_between(shape, x, {1 - w, 0, w}, {0, 1 - w, w}); };
  double lo = 0, hi = 1;
  Deepest low = row(1 - golden), high = row(golden);
  for (int section = 0; section < sections; ++section) {
    const bool keep_low = low.surface.distance <= high.surface.distance;
    (keep_low ? hi : lo) = keep_low ? lo + golden * (hi - lo) : hi - golden * (hi - lo);
    (keep_low ? high : low) = keep_low ? low : high;
    (keep_low ? low : high) = row(keep_low ? hi - golden * (hi - lo) : lo + golden * (hi - lo));
  }
  return low.surface.distance <= high.surface.distance ? low : high;
}

// min over w of d(sum_k w_k x_k),  w_k >= 0, sum_k w_k = 1:  along the chords through each corner in turn.
// (The steps of Frank and Wolfe, which Macklin et al. take, are chords too, but only towards the corner that
// is lowest along the gradient, and never back: on a triangle of half a meter the result of 12 such steps was
// wrong by centimeters.) If the chords do not converge, sections finish the search.
ColliderElementContacts::Deepest ColliderElementContacts::deepest(const Shape& shape, const Corners& x,
                                                                  double limit, double tolerance) {
  constexpr int rounds = 3;
  if (x[1] == x[2]) return deepest_between(shape, x, {1, 0, 0}, {0, 1, 0});
  Deepest best = evaluate(shape, x, {1 / 3.0, 1 / 3.0, 1 / 3.0});
  const auto done = [&] { return best.surface.distance - best.gap > limit || best.gap <= tolerance; };
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (done()) return best;
      const double rest = 1 - best.weight[k];
      if (!(rest > 1e-9)) continue;
      std::array<double, 3> corner{}, across = best.weight;
      corner[k] = 1;
      for (double& w : across) w /= rest;
      across[k] = 0;
      const Deepest next = deepest_between(shape, x, corner, across);
      if (next.surface.distance < best.surface.distance) best = next;
    }
  }
  if (done()) return best;
  const Deepest found = deepest_by_sections(shape, x);
  return found.surface.distance < best.surface.distance ? found : best;
}

// Conservative advancement: an element cannot touch before it has moved by its free distance. Corners move on
// straight lines in the collider's frame. After 16 advances an element is taken to touch where it is.
bool ColliderElementContacts::contact_of(const Body& body, const Element& element,
                                         const ParticleView& particles, float h, Found& found) const {
  Contact& contact = found.contact;
  const Shape& shape = shape_of(body);
  const Corners from = corners(body.before, element, particles, true);
  const Corners to = corners(body.after, element, particles, false);
  double path = 0;
  for (std::size_t k = 0; k < 3; ++k) path = max(path, length(to[k] - from[k]));
  const double r = double(radius_of(element)), target = element_clearance_part * r;
  Deepest low = deepest(shape, from, r + path, 0.1 * r);
  const double overlap = low.surface.distance - target;
  found.inside = low.surface.distance < -r;
  double advanced = 0;
  for (int iteration = 0; iteration < 16; ++iteration) {
    const double free = max(low.surface.distance - low.gap, 0.5 * low.surface.distance) - target;
    if (low.surface.distance - target <= 1e-3 * r || free <= 1e-3 * r) break;
    advanced += free;
    const double part = advanced < path ? advanced / path : 1.0;
    Corners x;
    for (std::size_t k = 0; k < 3; ++k) x[k] = from[k] + (to[k] - from[k]) * part;
    low = deepest(shape, x, r + path, 0.1 * r);
    if (part < 1) continue;
    if (low.surface.distance > r) return false;
    break;
  }
  contact = {};
  contact.particle = element.particle;
  Vec3d predicted;
  for (std::size_t k = 0; k < 3; ++k) {
    const double w = low.weight[k];
    if (w > 0.999) return false;  // the corner's own contact suffices
    contact.weight[k] = float(w);
    predicted += (to[k] - from[k]) * w;
    contact.inverse_mass += float(w * w) * particles.inverse_mass(element.particle[k]);
  }
  contact.target = float(target);
  contact.material = materials_->at(element.object, body.collider);
  contact.normal = low.surface.normal;
  contact.plane_offset = dot(low.surface.normal, low.point) - low.surface.distance;
  contact.predicted = Vec3f(body.after.rotation * predicted);
  contact.slop = overlap < 0 ? float(min(0.0, overlap + double(step_.depenetration_speed * h))) : 0.0f;
  return contact.inverse_mass > 0;
}

double ColliderElementContacts::gap(const Body& body, const Contact& contact,
                                    const ParticleView& particles) const {
  Vec3d point;
  for (std::size_t k = 0; k < 3; ++k)
    point += particle_position(particles, contact.particle[k]) * double(contact.weight[k]);
  return dot(contact.normal, body.after.to_local(point)) - contact.plane_offset - double(contact.target);
}

Vec3f ColliderElementContacts::moved(const Contact& contact, const ParticleView& particles) {
  Vec3f sum;
  for (std::size_t k = 0; k < 3; ++k) sum += particles.moved(contact.particle[k]) * contact.weight[k];
  return sum;
}

// The point moves by `change` if corner k moves by change w_k / m_k / sum_j (w_j^2 / m_j).
void ColliderElementContacts::correct(const Contact& contact, const ParticleView& particles,
                                      const Vec3f& change) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t i = contact.particle[k];
    const float factor = contact.weight[k] * particles.inverse_mass(i) / contact.inverse_mass;
    if (factor > 0) particles.correct(i, change * factor);
  }
}

void ColliderElementContacts::project(int, std::size_t begin, std::size_t end, const ParticleView& particles,
                                      const Substep&) {
  for (const Body& body : bodies_)
    for (std::size_t c = max(begin, body.contact_begin); c < min(end, body.contact_end); ++c)
      project_one(body, contacts_[c], particles);
}

// As ColliderContacts::project_one, for a point of an element.
void ColliderElementContacts::project_one(const Body& body, Contact& contact,
                                          const ParticleView& particles) const {
  const auto C = static_cast<float>(gap(body, contact, particles));
  if (!(contact.slop > C) && !(contact.normal_sum > 0)) return;
  if (body.moves) {
    Vec3d point;
    for (std::size_t k = 0; k < 3; ++k)
      point += particle_position(particles, contact.particle[k]) * double(contact.weight[k]);
    contact.surface_motion = Vec3f(point - body.before.to_world(body.after.to_local(point)));
  }
  const Vec3f n(body.after.rotation * contact.normal);
  ContactSums<float> sums{contact.normal_sum, contact.tangent_sum};
  correct(contact, particles,
          solve_contact(sums, C, contact.slop, n, moved(contact, particles) - contact.surface_motion,
                        contact.material));
  contact.normal_sum = sums.normal_sum;
  contact.tangent_sum = sums.tangent_sum;
}

void ColliderElementContacts::apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                                const Substep& substep) {
  for (const Body& body : bodies_)
    for (std::size_t c = body.contact_begin; c < body.contact_end; ++c)
      apply_restitution_to(body, contacts_[c], particles, velocity, substep.h);
}

// As ColliderContacts::apply_restitution_to.
void ColliderElementContacts::apply_restitution_to(const Body& body, Contact& contact,
                                                   const ParticleView& particles, std::span<Vec4f> velocity,
                                                   float h) const {
  if (!(contact.normal_sum > 0)) return;
  const Vec3f n(body.after.rotation * contact.normal);
  Vec3f v;
  for (std::size_t k = 0; k < 3; ++k) v += velocity[contact.particle[k]].xyz() * contact.weight[k];
  const Vec3f u = v - contact.surface_motion * (1 / h);
  const float inverse_h = 1 / h;
  const auto [change, restitution_velocity] = solve_restitution(
      {contact.normal_sum, contact.tangent_sum}, n, u, -dot(n, contact.predicted) * inverse_h,
      2 * step_.gravity * h, contact.material, inverse_h);
  contact.restitution_velocity = restitution_velocity;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t i = contact.particle[k];
    const float factor = contact.weight[k] * particles.inverse_mass(i) / contact.inverse_mass;
    if (factor > 0) velocity[i].set_xyz(velocity[i].xyz() + change * factor);
  }
  contact.depth = max(0.0f, float(-gap(body, contact, particles)));
}

ContactReport ColliderElementContacts::report() const {
  return report_of(contacts_);
}

void ColliderElementContacts::events(const ParticleView& particles, std::vector<ContactPush>& out) const {
  const float inverse_h = last_h_ > 0 ? 1 / last_h_ : 0.0f;
  for (const Body& body : bodies_) {
    for (std::size_t c = body.contact_begin; c < body.contact_end; ++c) {
      const Contact& contact = contacts_[c];
      if (!(contact.normal_sum > 0)) continue;
      const auto heaviest = std::max_element(contact.weight.begin(), contact.weight.end());
      const auto k = static_cast<std::size_t>(heaviest - contact.weight.begin());
      Vec3d point;
      for (std::size_t j = 0; j < 3; ++j)
        point += particle_position(particles, contact.particle[j]) * double(contact.weight[j]);
      const double C = gap(body, contact, particles);
      const Vec3d n = body.after.rotation * contact.normal;
      const float impulse =
          (contact.normal_sum * inverse_h + contact.restitution_velocity) / contact.inverse_mass;
      out.push_back({contact.particle[k], body.collider, Vec3f(point - n * (C + double(contact.target))),
                     Vec3f(n), impulse});
    }
  }
}

Residual ColliderElementContacts::residual(const ParticleView& particles) const {
  Residual result;
  result.count = contacts_.size();
  for (const Body& body : bodies_) {
    for (std::size_t c = body.contact_begin; c < body.contact_end; ++c) {
      const double violation = max(0.0, -gap(body, contacts_[c], particles));
      result.largest = max(result.largest, violation);
      result.sum += violation;
    }
  }
  return result;
}

void ColliderElementContacts::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  for (const Body& body : bodies_) {
    for (std::size_t c = body.contact_begin; c < body.contact_end; ++c) {
      const Contact& contact = contacts_[c];
      const std::size_t corners = contact.particle[1] == contact.particle[2] ? 2 : 3;
      const double C = gap(body, contact, particles);
      visitor({{contact.particle.data(), corners}, 0, 0, static_cast<float>(max(0.0, -C))});
    }
  }
}

/// Removes all elements, because their particles may no longer exist: call set_elements again.
void ColliderElementContacts::erase_particles(std::uint32_t, std::uint32_t) {
  set_elements({});
}

std::size_t ColliderElementContacts::bytes() const {
  return bytes_of(elements_, corners_, bodies_, broad_phase_position_, margin_, near_, candidates_, tested_,
                  found_, contacts_);
}

}  // namespace souple
