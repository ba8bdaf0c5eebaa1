#include "souple/fluid/fluid_bodies.h"

#include "souple/geometry/closest_point.h"

#include <algorithm>

namespace souple {

namespace {

// In units of the search radius.
constexpr float margin_share = 0.25f;  // margin of the candidate lists
constexpr float max_depth = 1.0f / 3;  // maximum depth inside a body at which a particle is still pushed out

Vec3f corner_mix(const Triangle& t, const Vec3f& weights, const std::vector<Vec3f>& at) {
  return at[t[0]] * weights.x + at[t[1]] * weights.y + at[t[2]] * weights.z;
}

Vec3f area_normal(const Triangle& t, const std::vector<Vec3f>& at) {
  return cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]);
}

}  // namespace

// --- positions of bodies -------------------------------------------------------------------------

void FluidBodies::update_state(const BoundaryMesh& mesh, State& state, const ParticleView& particles,
                               std::span<const float> mass) const {
  const std::size_t count = mesh.particles.size();
  state.start.resize(count);
  state.now.resize(count);
  state.vertex_inverse_mass.assign(count, 0);
  state.slopes.resize(count);
  for (std::size_t v = 0; v < count; ++v) {
    Vec3d before{}, after{};
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t i = mesh.particles[v][k];
      const auto weight = static_cast<double>(mesh.weights[v][k]);
      if (weight == 0) continue;
      before += (particles.exact_start(i) - origin_) * weight;
      after += (particles.exact_position(i) - origin_) * weight;
      state.vertex_inverse_mass[v] += mesh.weights[v][k] * mesh.weights[v][k] * particles.inverse_mass(i);
    }
    state.start[v] = Vec3f(before);
    state.now[v] = Vec3f(after);
  }
  state.movable = std::any_of(state.vertex_inverse_mass.begin(), state.vertex_inverse_mass.end(),
                              [](float g) { return g > 0; });
  state.inverse_mass = 0;
  if (!state.movable || mesh.compliance == BodyCompliance::per_vertex) return;
  Vec3d center{};
  double all = 0;
  for (std::uint32_t i = mesh.begin; i < mesh.end; ++i) {
    if (particles.inverse_mass(i) == 0) return;  // a fixed particle: the body does not move as a whole
    const auto m = static_cast<double>(mass[i]);
    center += (particles.exact_position(i) - origin_) * m;
    all += m;
  }
  center = center / all;
  Mat3d second{};
  for (std::uint32_t i = mesh.begin; i < mesh.end; ++i) {
    const Vec3d r = particles.exact_position(i) - origin_ - center;
    second = second + outer(r, r) * static_cast<double>(mass[i]);
  }
  const double t = trace(second);
  // A rod has no inertia about its axis: add a little, relative to the whole.
  const Mat3d inertia = Mat3d::identity() * (t * (1 + 1e-6)) - second;
  state.center = center;
  state.inverse_mass = 1 / all;
  state.inverse_inertia = t > 0 ? inverse(inertia) : Mat3d{};
}

void FluidBodies::begin_substep(const ParticleView& particles, std::span<const float> mass,
                                std::span<const Vec4f> positions, float search_radius, Threads& threads) {
  states_.resize(meshes_.size());
  for (std::size_t s = 0; s < meshes_.size(); ++s) update_state(meshes_[s], states_[s], particles, mass);
  if (!lists_are_valid(positions, threads)) find_candidates(positions, search_radius, threads);
}

// --- candidates ----------------------------------------------------------------------------------

bool FluidBodies::lists_are_valid(std::span<const Vec4f> positions, Threads& threads) {
  if (listed_.size() != positions.size()) return false;
  const auto moved = [&](std::size_t i) { return positions[i].xyz() - listed_[i].xyz(); };
  const float farthest = largest_motion_.from_origin(positions.size(), moved, threads);
  float farthest_vertex = 0;
  for (std::size_t s = 0; s < meshes_.size(); ++s) {
    const auto vertex_moved = [&](std::size_t v) { return states_[s].now[v] - listed_vertices_[s][v]; };
    farthest_vertex =
        max(farthest_vertex, largest_motion_.from_origin(states_[s].now.size(), vertex_moved, threads));
  }
  return farthest + farthest_vertex < listed_margin_;
}

void FluidBodies::find_candidates(std::span<const Vec4f> positions, float search_radius, Threads& threads) {
  listed_.assign(positions.begin(), positions.end());
  listed_margin_ = margin_share * search_radius;
  listed_vertices_.resize(meshes_.size());
  found_.clear();
  order_.build(positions, search_radius, threads);
  for (std::uint32_t s = 0; s < meshes_.size(); ++s) {
    listed_vertices_[s] = states_[s].now;
    for (std::uint32_t t = 0; t < meshes_[s].triangles.size(); ++t)
      find_candidates_of(s, t, positions, search_radius + listed_margin_ + meshes_[s].half_thickness);
  }
  candidates_.fill(positions.size(), [&](const auto& add) {
    for (const Candidate& candidate : found_) add(candidate.particle, candidate);
  });
}

// Cells of the triangle's box, grown by the search radius; then the triangle's bounding ball.
void FluidBodies::find_candidates_of(std::uint32_t mesh, std::uint32_t triangle,
                                     std::span<const Vec4f> positions, float search_radius) {
  const Triangle& t = meshes_[mesh].triangles[triangle];
  const std::vector<Vec3f>& at = states_[mesh].now;
  const Vec3f middle = (at[t[0]] + at[t[1]] + at[t[2]]) * (1.0f / 3);
  float radius = 0;
  std::int32_t lo[3], hi[3];
  for (const std::uint32_t v : t) radius = std::max(radius, length(at[v] - middle));
  for (int axis = 0; axis < 3; ++axis) {
    const float least = std::min({at[t[0]][axis], at[t[1]][axis], at[t[2]][axis]}) - search_radius;
    const float most = std::max({at[t[0]][axis], at[t[1]][axis], at[t[2]][axis]}) + search_radius;
    lo[axis] = order_.cell(axis, least);
    hi[axis] = order_.cell(axis, most);
  }
  const float clear = (radius + search_radius) * (radius + search_radius);
  order_.for_each_in(lo, hi, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::uint32_t i = order_.order()[k];
      const Vec3f offset = positions[i].xyz() - middle;
      if (dot(offset, offset) < clear) found_.push_back({i, mesh, triangle});
    }
  });
}

// --- boundary planes -----------------------------------------------------------------------------

void FluidBodies::find(std::size_t i, std::size_t fluid, const Vec3f& x, const Vec3f& start,
                       float search_radius, std::vector<BoundaryPlane>& planes) const {
  static thread_local SurfacePlanes surface;
  const std::span<const Candidate> candidates = candidates_[i];
  for (auto c = candidates.begin(); c != candidates.end();) {
    const std::uint32_t s = c->mesh;
    surface.begin(search_radius + meshes_[s].half_thickness, search_radius);
    for (; c != candidates.end() && c->mesh == s; ++c) add_triangle(s, c->triangle, x, start, surface);
    if (collides_[fluid * meshes_.size() + s] == 0) continue;
    for (const SurfacePlane& found : surface.select()) add_plane(s, found, x, search_radius, planes);
  }
}

// Cloth may have fluid on both sides: a particle stays on the side where it was.
void FluidBodies::add_triangle(std::uint32_t mesh, std::uint32_t triangle, const Vec3f& x, const Vec3f& start,
                               SurfacePlanes& surface) const {
  const Triangle& t = meshes_[mesh].triangles[triangle];
  const std::vector<Vec3f>&now = states_[mesh].now, &before = states_[mesh].start;
  const TrianglePoint nearest =
      closest_on_triangle(Vec3d(x), Vec3d(now[t[0]]), Vec3d(now[t[1]]), Vec3d(now[t[2]]));
  const Vec3f weights{static_cast<float>(nearest.a), static_cast<float>(nearest.b),
                      static_cast<float>(nearest.c)};
  const Vec3f foot = corner_mix(t, weights, now) - x;
  if (dot(foot, foot) > surface.reach() * surface.reach()) return;
  const Vec3f normal = area_normal(t, now);
  const float size = length(normal);
  if (!(size > 0)) return;
  float side = 1;
  if (!meshes_[mesh].closed && dot(area_normal(t, before), start - corner_mix(t, weights, before)) < 0)
    side = -1;
  surface.add(triangle, {now[t[0]] - x, now[t[1]] - x, now[t[2]] - x}, weights, foot, normal * (side / size));
}

void FluidBodies::add_plane(std::uint32_t mesh, const SurfacePlane& found, const Vec3f& x,
                            float search_radius, std::vector<BoundaryPlane>& planes) const {
  const Triangle& t = meshes_[mesh].triangles[found.triangle];
  const State& state = states_[mesh];
  BoundaryPlane plane;
  plane.normal = found.normal;
  plane.motion = corner_mix(t, found.weights, state.now) - corner_mix(t, found.weights, state.start);
  plane.mesh = mesh;
  plane.triangle = found.triangle;
  plane.weights = found.weights;
  plane.share = found.share;
  follow(plane);
  // Deep inside a body a particle ignores it: the direction out is ambiguous there.
  const float apart = dot(plane.normal, x) - plane.offset;
  if (apart < search_radius && apart > -max_depth * search_radius && plane.share > 0) planes.push_back(plane);
}

void FluidBodies::follow(BoundaryPlane& plane) const {
  if (plane.mesh == BoundaryPlane::none) return;
  plane.offset =
      dot(plane.normal, point(plane, states_[plane.mesh].now)) + meshes_[plane.mesh].half_thickness;
}

Vec3f FluidBodies::point(const BoundaryPlane& plane, const std::vector<Vec3f>& vertices) const {
  return corner_mix(meshes_[plane.mesh].triangles[plane.triangle], plane.weights, vertices);
}

// --- response of bodies --------------------------------------------------------------------------

void FluidBodies::find_response(const LocalBoundary& local_boundary, std::span<const Vec4f> x,
                                CoarsePressure& coarse) {
  for (State& state : states_) {
    std::fill(state.slopes.begin(), state.slopes.end(), 0.0f);
    state.slope_sum = 0;
  }
  coarse.begin_movers(meshes_.size());
  for (std::size_t s = 0; s < meshes_.size(); ++s)
    if (states_[s].inverse_mass > 0) coarse.set_mover(s, states_[s].inverse_mass, states_[s].inverse_inertia);
  for (const std::uint32_t k : local_boundary.near()) {
    for (const BoundaryPlane& plane : local_boundary.of(k)) {
      if (plane.mesh == BoundaryPlane::none) continue;
      State& state = states_[plane.mesh];
      if (!state.movable) continue;
      const float slope = length(plane.slope);
      if (state.inverse_mass > 0) {
        state.slope_sum += slope;
        coarse.add_contact(plane.mesh, k, x[k], Vec3d(plane.slope),
                           cross(Vec3d(point(plane, state.now)) - state.center, Vec3d(plane.slope)));
        continue;
      }
      const Triangle& t = meshes_[plane.mesh].triangles[plane.triangle];
      for (int c = 0; c < 3; ++c) state.slopes[t[static_cast<std::size_t>(c)]] += plane.weights[c] * slope;
    }
  }
}

void FluidBodies::add_response(std::span<const BoundaryPlane> planes, BoundarySums& sums) const {
  for (const BoundaryPlane& plane : planes) {
    if (plane.mesh == BoundaryPlane::none) continue;
    const State& state = states_[plane.mesh];
    const float slope = length(plane.slope);
    if (state.inverse_mass > 0) {
      sums.response += slope * state.slope_sum * static_cast<float>(state.inverse_mass);
      continue;
    }
    const Triangle& t = meshes_[plane.mesh].triangles[plane.triangle];
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = t[static_cast<std::size_t>(c)];
      const float response = slope * plane.weights[c] * state.vertex_inverse_mass[v] * state.slopes[v];
      sums.response += response;
      sums.local_response += response;
    }
  }
}

void FluidBodies::displace(const LocalBoundary& local_boundary, std::span<const float> change) {
  pushes_.assign(meshes_.size(), {});
  for (const std::uint32_t k : local_boundary.near()) {
    for (const BoundaryPlane& plane : local_boundary.of(k)) {
      if (!is_movable(plane)) continue;
      State& state = states_[plane.mesh];
      const Vec3f push = plane.slope * -change[k];
      if (state.inverse_mass > 0) {
        const Vec3d arm = Vec3d(point(plane, state.now)) - state.center;
        pushes_[plane.mesh].force += Vec3d(push);
        pushes_[plane.mesh].torque += cross(arm, Vec3d(push));
        continue;
      }
      const Triangle& t = meshes_[plane.mesh].triangles[plane.triangle];
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t v = t[static_cast<std::size_t>(c)];
        state.now[v] += push * (plane.weights[c] * state.vertex_inverse_mass[v]);
      }
    }
  }
  for (std::size_t s = 0; s < meshes_.size(); ++s) {
    State& state = states_[s];
    if (!(state.inverse_mass > 0)) continue;
    const Vec3f moved(pushes_[s].force * state.inverse_mass),
        turned(state.inverse_inertia * pushes_[s].torque);
    const Vec3f center(state.center);
    for (Vec3f& x : state.now) x += moved + cross(turned, x - center);
  }
}

void FluidBodies::apply(const LocalBoundary& local_boundary, const ParticleView& particles) const {
  for (const std::uint32_t k : local_boundary.near()) {
    for (const BoundaryPlane& plane : local_boundary.of(k)) {
      if (!is_movable(plane)) continue;
      for_carriers(plane, [&](std::uint32_t i, float share) {
        particles.correct(i, plane.push_sum * (-share * particles.inverse_mass(i)));
      });
    }
  }
}

FluidBodies::Carriers FluidBodies::carriers_of(const BoundaryPlane& plane) const {
  Carriers carriers;
  for_carriers(plane, [&](std::uint32_t i, float share) {
    const auto begin = carriers.particle.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(carriers.count);
    const auto known = std::find(begin, end, i);
    const auto k = static_cast<std::size_t>(known - begin);
    if (known == end) carriers.particle[carriers.count++] = i;
    carriers.share[k] += share;
  });
  return carriers;
}

//   C = n . (x_i - sum_c share_c x_c) - half_thickness - radius >= 0
//   s = -C / (w_i + sum_c share_c^2 w_c),   dx_i = w_i s n,   dx_c = -share_c w_c s n
void FluidBodies::keep_apart(const BoundaryPlane& plane, std::uint32_t i, const Vec3f& x, float radius,
                             const ParticleView& particles) const {
  const Vec3f& n = plane.normal;
  if (dot(n, x) - plane.offset > 2 * radius) return;
  // The plane extends beyond its triangle: only in front of the triangle the body is known to be there.
  const Vec3f along = cross(n, x - point(plane, states_[plane.mesh].now));
  if (dot(along, along) > radius * radius) return;
  const Carriers carriers = carriers_of(plane);
  Vec3d offset = particles.exact_position(i);
  float w = particles.inverse_mass(i);
  for (std::size_t c = 0; c < carriers.count; ++c) {
    const float share = carriers.share[c];
    offset -= particles.exact_position(carriers.particle[c]) * static_cast<double>(share);
    w += share * share * particles.inverse_mass(carriers.particle[c]);
  }
  const float C = dot(n, Vec3f(offset)) - meshes_[plane.mesh].half_thickness - radius;
  if (C >= 0 || !(w > 0)) return;
  const Vec3f push = n * (-C / w);
  particles.correct(i, push * particles.inverse_mass(i));
  for (std::size_t c = 0; c < carriers.count; ++c)
    particles.correct(carriers.particle[c],
                      push * (-carriers.share[c] * particles.inverse_mass(carriers.particle[c])));
}

}  // namespace souple
