#include "souple/contacts/surfaces/round_contacts.h"

#include "souple/collision/nearest.h"
#include "souple/contacts/surfaces/surface_narrow_phase.h"
#include "souple/intersections/intersection_resolver.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <utility>

namespace souple {
namespace {

// A cylinder lies on its side where the product of its axis and the normal is below this.
constexpr float most_inclined = 0.1f;

Vec3f start_difference(const ParticleView& particles, std::uint32_t i, std::uint32_t j) {
  return particles.difference(i, j) - (particles.moved(i) - particles.moved(j));
}

bool may_meet_triangles(const ElementSurfaces& surfaces, std::uint32_t a) {
  for (std::uint32_t b = 0; b < surfaces.size(); ++b)
    if (!surfaces[b].triangles.empty() && surfaces.collides_with_other(a, b)) return true;
  return false;
}

}  // namespace

struct RoundContacts::Input {
  const ElementPairs& pairs;
  const SurfaceNarrowPhase& narrow_phase;
  const ParticleView& particles;
  std::span<const float> radius, contact_margin;
  const IntersectionResolver* resolver;
};

/// A point of a triangle and the point on the axis nearest to it.
struct RoundContacts::Touch {
  NearPair triangle;  ///< after the body's first particle
  float weight[3];    ///< of its corners
  Vec3f corner[3];    ///< at the start [m]
  float along_axis;   ///< from 0 to 1
};

void RoundContacts::build(const ElementSurfaces& surfaces) {
  bodies_.clear(), contacts_.clear(), fast_.clear();
  body_of_.assign(surfaces.size(), no_surface);
  for (std::uint32_t a = 0; a < surfaces.size(); ++a) {
    if (!(surfaces[a].round.radius > 0) || !may_meet_triangles(surfaces, a)) continue;
    body_of_[a] = static_cast<std::uint32_t>(bodies_.size());
    Body& body = bodies_.emplace_back();
    body.surface = a, body.shape = surfaces[a].round;
    for (std::uint32_t& i : body.shape.particle) i += surfaces[a].begin;
    body.near.reserve(256);
  }
  marks_.assign(bodies_.empty() ? 0 : surfaces.particle_count(), 0);
  mark_ = 0;
  if (!bodies_.empty()) contacts_.reserve(256), fast_.reserve(16);
}

void RoundContacts::raise_margins(const ElementSurfaces& surfaces, std::span<float> contact_margin) const {
  for (const Body& body : bodies_)
    for (std::uint32_t i = surfaces[body.surface].begin; i < surfaces[body.surface].end; ++i)
      contact_margin[i] = max(contact_margin[i], body.shape.sagitta);
}

void RoundContacts::find(const ElementPairs& pairs, const SurfaceNarrowPhase& narrow_phase,
                         const ParticleView& particles, std::span<const float> radius,
                         std::span<const float> contact_margin, const IntersectionResolver* resolver,
                         std::vector<PairToi>& found) {
  contacts_.clear();
  if (bodies_.empty()) return;
  const Input input{pairs, narrow_phase, particles, radius, contact_margin, resolver};
  choose_pairs(input, found);
  for (Body& body : bodies_)
    if (!body.near.empty()) find_near(input, body);
}

// Whether the elements of a pair face each other across the round surface.
bool RoundContacts::may_replace(const Body& body, const NearPair& pair, bool edges,
                                const ParticleView& particles) const {
  if (!body.shape.is_cylinder) return true;
  const auto& i = pair.particle;
  const Vec3f n = edges ? cross(particles.difference(i[1], i[0]), particles.difference(i[3], i[2]))
                        : cross(particles.difference(i[2], i[1]), particles.difference(i[3], i[1]));
  Vec3f axis;
  for (std::size_t k = 1; k < 4; ++k)
    axis += particles.difference(body.shape.particle[k], body.shape.particle[0]) *
            (body.shape.axis[1][k] - body.shape.axis[0][k]);
  return abs(dot(n, axis)) < most_inclined * length(n) * length(axis);
}

void RoundContacts::choose_pairs(const Input& input, std::vector<PairToi>& found) {
  const ElementSurfaces& surfaces = input.pairs.surfaces();
  for (Body& body : bodies_) body.near.clear();
  fast_.clear();
  // Calls f(body, other surface, pair, whether the body is the first side) for pairs with a round body.
  const auto with_body = [&](const PairToi& contact, const auto& f) {
    const NearPair& pair = input.pairs.pair(contact.pair);
    const std::uint32_t one = surfaces.of(pair.particle[0]), other = surfaces.of(pair.particle[3]);
    if (body_of_[one] != no_surface && !surfaces[other].triangles.empty())
      return f(body_of_[one], other, pair, true);
    if (body_of_[other] != no_surface && !surfaces[one].triangles.empty())
      return f(body_of_[other], one, pair, false);
    return false;
  };
  for (const PairToi& contact : found)
    with_body(contact, [&](std::uint32_t body, std::uint32_t other, const NearPair&, bool) {
      if (contact.toi < 1) fast_.push_back({body, other});
      return true;
    });
  std::sort(fast_.begin(), fast_.end());
  const auto is_replaced = [&](const PairToi& contact) {
    return with_body(contact, [&](std::uint32_t b, std::uint32_t other, const NearPair& pair, bool first) {
      const bool edges = input.pairs.are_edges(contact.pair);
      if (std::binary_search(fast_.begin(), fast_.end(), std::array{b, other}) ||
          !may_replace(bodies_[b], pair, edges, input.particles))
        return false;
      const std::size_t sides = edges ? 2 : 1;
      for (std::size_t k = first ? sides : 0; k < (first ? 4 : sides); ++k)
        bodies_[b].near.push_back(pair.particle[k]);
      return true;
    });
  };
  found.erase(std::remove_if(found.begin(), found.end(), is_replaced), found.end());
}

std::array<float, 4> RoundContacts::Body::weights(const Vec3f& point) const {
  const Vec3f w(to_weights * Vec3d(point));
  return {1 - w.x - w.y - w.z, w.x, w.y, w.z};
}

void RoundContacts::place(Body& body, const ParticleView& particles, bool at_end) {
  const auto& i = body.shape.particle;
  Vec3f x[4];
  for (std::size_t k = 0; k < 4; ++k)
    x[k] = at_end ? particles.difference(i[k], i[0]) : start_difference(particles, i[k], i[0]);
  for (std::size_t end = 0; end < 2; ++end) {
    body.ends[end] = body.moved[end] = {};
    for (std::size_t k = 0; k < 4; ++k) {
      body.ends[end] += x[k] * body.shape.axis[end][k];
      body.moved[end] += particles.moved(i[k]) * body.shape.axis[end][k];
    }
  }
  body.to_weights = inverse(Mat3d{Vec3d(x[1]), Vec3d(x[2]), Vec3d(x[3])});
  body.at_end = at_end;
}

// A triangle is met at its first particle that is near.
void RoundContacts::find_near(const Input& input, Body& body) {
  place(body, input.particles, false);
  ++mark_;
  const ElementSurfaces& surfaces = input.pairs.surfaces();
  std::size_t count = 0;
  for (const std::uint32_t i : body.near)
    if (std::exchange(marks_[i], mark_) != mark_) body.near[count++] = i;
  body.near.resize(count);
  const auto is_earlier = [&](std::uint32_t j, std::uint32_t i) { return j < i && marks_[j] == mark_; };
  const auto may_touch = [&](std::uint32_t i) {
    return !surfaces.is_joined_to(i, body.surface) &&
           !(input.resolver && input.resolver->may_exempt(i, body.surface));
  };
  for (const std::uint32_t i : body.near)
    input.narrow_phase.owners().for_each_triangle_at(i, [&](std::uint32_t j, std::uint32_t k) {
      if (!is_earlier(j, i) && !is_earlier(k, i) && may_touch(i) && may_touch(j) && may_touch(k))
        touch_triangle(input, body, {i, j, k});
    });
}

void RoundContacts::touch_triangle(const Input& input, const Body& body,
                                   const std::array<std::uint32_t, 3>& triangle) {
  const std::uint32_t origin = body.shape.particle[0];
  Touch touch{{{origin, triangle[0], triangle[1], triangle[2]}}, {}, {}, 0};
  Vec3f(&x)[3] = touch.corner;
  for (std::size_t k = 0; k < 3; ++k) x[k] = start_difference(input.particles, triangle[k], origin);
  const bool is_ball = body.ends[0] == body.ends[1];
  for (std::size_t end = 0; end < (is_ball ? 1 : 2); ++end) {
    touch.along_axis = static_cast<float>(end);
    nearest_on_triangle(body.ends[end], x[0], x[1], x[2], touch.weight);
    add(input, body, touch);
  }
  if (is_ball) return;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    float along_edge = 0;
    nearest_on_edges(body.ends[0], body.ends[1], x[k], x[next], touch.along_axis, along_edge);
    if (!(touch.along_axis > 0 && touch.along_axis < 1)) continue;
    touch.weight[k] = 1 - along_edge, touch.weight[next] = along_edge, touch.weight[(k + 2) % 3] = 0;
    add(input, body, touch);
  }
}

void RoundContacts::add(const Input& input, const Body& body, const Touch& touch) {
  const ParticleView& particles = input.particles;
  const std::span<const float> radius = input.radius, margin = input.contact_margin;
  const std::uint32_t* const corner = touch.triangle.particle + 1;
  const Vec3f center = body.on_axis(touch.along_axis);
  Vec3f q, q_moved;
  float thickness = 0, speculative = 0;
  unsigned on_border = 0;
  for (unsigned k = 0; k < 3; ++k) {
    q += touch.corner[k] * touch.weight[k], q_moved += particles.moved(corner[k]) * touch.weight[k];
    thickness = max(thickness, radius[corner[k]]), speculative = max(speculative, margin[corner[k]]);
    if (!(touch.weight[k] > 0)) on_border |= 1u << k;
  }
  thickness += radius[body.shape.particle[0]];
  const Vec3f way = center - q;
  const float distance = length(way);
  if (!(distance > 0)) return;
  const Vec3f n = way * (1 / distance);
  const float gap = distance - body.shape.radius - thickness;
  const float approach =
      -dot(n, (body.moved[0] * (1 - touch.along_axis) + body.moved[1] * touch.along_axis) - q_moved);
  speculative = max(speculative, margin[body.shape.particle[0]] - body.shape.sagitta);
  if (!(gap - approach < speculative_part * thickness + speculative)) return;
  if (body.shape.is_cylinder && abs(dot(n, normalized(body.ends[1] - body.ends[0]))) > most_inclined) return;
  if (!input.narrow_phase.owners().is_owner(touch.triangle, on_border,
                                            {particles, touch.triangle.particle[0], center, true}))
    return;
  const std::uint32_t other = input.pairs.surfaces().of(corner[0]);
  const std::array<float, 4> w = body.weights(center - n * body.shape.radius);
  const auto& i = body.shape.particle;
  Contact contact;
  contact.anchor = {{i[0], i[1], i[2], i[3], corner[0], corner[1], corner[2]},
                    {w[0], w[1], w[2], w[3], -touch.weight[0], -touch.weight[1], -touch.weight[2]}};
  contact.body = static_cast<std::uint32_t>(&body - bodies_.data());
  contact.along_axis = touch.along_axis, contact.normal = n;
  contact.inverse_mass = contact.anchor.inverse_mass(particles);
  if (!(contact.inverse_mass > 0)) return;
  const Vec3f moved = contact.anchor.moved(particles);
  contact.base = gap - approach - dot(n, moved);
  contact.slop = gap < 0 ? min(0.0f, gap + input.narrow_phase.release(body.surface, other)) : 0.0f;
  contact.approach = approach, contact.thickness = thickness;
  contact.material = input.narrow_phase.material(body.surface, other, moved);
  contacts_.push_back(contact);
}

void RoundContacts::project(std::size_t c, const ParticleView& particles) {
  Contact& contact = contacts_[c];
  const Vec3f moved = contact.anchor.moved(particles);
  const float C = contact.base + dot(contact.normal, moved);
  if (!(contact.slop > C || contact.sums.normal_sum > 0)) return;
  const Vec3f change = solve_contact(contact.sums, C, contact.slop, contact.normal, moved, contact.material);
  contact.anchor.correct(particles, change, contact.inverse_mass);
}

// While the body rolled, the material that touched left the surface. Velocities are those of the material that touches now.
void RoundContacts::apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                      const kernels::ContactLimits& limits) {
  for (Contact& contact : contacts_) {
    contact.restitution_velocity = contact.depth = 0;
    if (!(contact.sums.normal_sum > 0)) continue;
    Body& body = bodies_[contact.body];
    if (!body.at_end) place(body, particles, true);
    Anchor<7> anchor = contact.anchor;
    const std::array<float, 4> w =
        body.weights(body.on_axis(contact.along_axis) - contact.normal * body.shape.radius);
    std::copy(w.begin(), w.end(), anchor.weight.begin());
    const auto [change, restitution_velocity] = solve_restitution(
        contact.sums, contact.normal, anchor.velocity(velocity), contact.approach * limits.inverse_h,
        limits.restitution_threshold, contact.material, limits.inverse_h);
    anchor.accelerate(velocity, particles, change, contact.inverse_mass);
    contact.restitution_velocity = restitution_velocity;
    contact.depth = max(0.0f, -contact.gap(particles));
  }
}

std::size_t RoundContacts::bytes() const {
  std::size_t sum = bytes_of(bodies_, body_of_, fast_, marks_, contacts_);
  for (const Body& body : bodies_) sum += bytes_of(body.near);
  return sum;
}

}  // namespace souple
