#include "souple/fluid/sub_resolution_bodies.h"

#include <algorithm>

namespace souple {

namespace {

constexpr float radius_spacings = 2.5f;                             // R, in spacings
constexpr float kernel_integral = 8 * static_cast<float>(pi) / 15;  // of w, in units of R^3
constexpr float whole = 0.95f;       // smallest filled fraction of the kernel deep in a fluid, on a lattice
constexpr float max_push_ratio = 4;  // of a body's push over the fluid's
constexpr float ball_drag = 0.47f, across_drag = 1.2f, along_drag = 0.03f;

}  // namespace

template <class Function>
void SubResolutionBodies::for_bodies(Threads& threads, const Function& f) {
  threads.each(blocks_.size(), 1, [&](std::size_t k) {
    for (std::size_t b = k * block_size; b < std::min(bodies_.size(), (k + 1) * block_size); ++b) f(b);
  });
}

void SubResolutionBodies::update_states(const ParticleView& particles) {
  states_.resize(bodies_.size());
  blocks_.resize((bodies_.size() + block_size - 1) / block_size);
  for (Block& block : blocks_) block.near.clear();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const SubResolutionBody& body = bodies_[b];
    const Vec3d first = particles.exact_position(body.particles[0]) - origin_;
    const Vec3d second = particles.exact_position(body.particles[1]) - origin_;
    const Vec3f offset(second - first);
    const float size = length(offset);
    states_[b].at =
        Vec3f(first * static_cast<double>(body.weights[0]) + second * static_cast<double>(body.weights[1]));
    states_[b].axis = size > 0 ? offset * (1 / size) : Vec3f{};
  }
}

// Fluid particles within R, and the sum of their weights.
void SubResolutionBodies::find_near(std::size_t b, std::span<const Vec4f> x,
                                    std::span<const std::uint32_t> order, const LocalBoundary& local_boundary,
                                    const Smoothing& smoothing) {
  State& state = states_[b];
  std::vector<Near>& near = blocks_[b / block_size].near;
  state.begin = static_cast<std::uint32_t>(near.size());
  const float search_radius = radius_spacings * smoothing.spacing(),
              scale = 1 / (search_radius * search_radius);
  const auto weight = [&](const Vec3f& at) {
    const Vec3f offset = at - state.at;
    return 1 - dot(offset, offset) * scale;
  };
  std::int32_t lo[3], hi[3];
  for (int axis = 0; axis < 3; ++axis) {
    lo[axis] = order_.cell(axis, state.at[axis] - search_radius);
    hi[axis] = order_.cell(axis, state.at[axis] + search_radius);
  }
  float sum = 0, mirrored = 0;
  order_.for_each_in(lo, hi, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t c = begin; c < end; ++c) {
      const std::uint32_t k = order_.order()[c];
      const Vec3f at = x[k].xyz();
      const float w = weight(at);
      if (!(w > 0) || collides_[fluid_[order[k]] * objects_ + bodies_[b].object] == 0) continue;
      near.push_back({k, w});
      sum += w;
      for (const BoundaryPlane& plane : local_boundary.of(k))
        mirrored += std::max(0.0f, weight(at - plane.normal * (2 * (dot(plane.normal, at) - plane.offset))));
    }
  });
  state.end = static_cast<std::uint32_t>(near.size());
  for (std::size_t n = state.begin; n < state.end; ++n) near[n].share /= sum;
  state.near_sum = sum;
  state.sum = sum + mirrored;
}

// Space that other bodies fill around a body counts as fluid, not as air.
void SubResolutionBodies::find(std::span<const Vec4f> x, std::span<const std::uint32_t> order,
                               const LocalBoundary& local_boundary, const Smoothing& smoothing,
                               const ParticleView& particles, Threads& threads) {
  update_states(particles);
  const float search_radius = radius_spacings * smoothing.spacing();
  const float all = kernel_integral * search_radius * search_radius * search_radius;
  order_.build(x, search_radius, threads);
  for_bodies(threads, [&](std::size_t b) { find_near(b, x, order, local_boundary, smoothing); });
  inverse_volume_ = 1 / smoothing.volume();
  solid_.assign(x.size(), 0);
  burden_.assign(x.size(), 0);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const float part = bodies_[b].volume * states_[b].sum / all;
    for (const Near& n : near(b)) solid_[n.index] += part * n.share;
  }
  for (float& e : solid_) e = std::min(e, max_solid);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    State& state = states_[b];
    float fluid_part = 0;
    for (const Near& n : near(b)) fluid_part += n.share / (1 - solid_[n.index]);
    state.submerged = std::min(1.0f, smoothing.volume() * state.sum * fluid_part / (whole * all));
    const float part = state.submerged * bodies_[b].volume * inverse_volume_;
    for (const Near& n : near(b)) burden_[n.index] += part * n.share;
  }
}

// Lattices of density x have a V sum W above x, because a particle counts itself. The two terms lie between cubic
// lattices that are stretched along one axis and along all three.
float SubResolutionBodies::displaced_density(std::size_t index) const {
  const float e = solid_[index];
  return e - e * (0.08f + 0.1f * e);
}

std::span<const Vec3f> SubResolutionBodies::apply_pressure(std::span<const Vec4f> x,
                                                           std::span<const Vec3f> moved,
                                                           const ParticleView& particles) {
  given_.assign(x.size(), Vec3f{});
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const SubResolutionBody& body = bodies_[b];
    float mass = 0;
    for (const Near& n : near(b)) mass += n.share / x[n.index].w;
    float part = states_[b].submerged * body.volume * inverse_volume_;
    if (part * mass > max_push_ratio * body.mass) part = max_push_ratio * body.mass / mass;
    Vec3f push{};
    for (const Near& n : near(b)) {
      const Vec3f given = moved[n.index] * (part * n.share / ((1 + burden_[n.index]) * x[n.index].w));
      given_[n.index] += given;
      push += given;
    }
    for (std::size_t c = 0; c < 2; ++c) {
      const std::uint32_t p = body.particles[c];
      if (body.weights[c] > 0) particles.correct(p, push * (body.weights[c] * particles.inverse_mass(p)));
    }
  }
  return given_;
}

// The drag impulse without other bodies and without the reaction of either side. `across` bounds its
// coefficient.
void SubResolutionBodies::find_drag(std::size_t b, const FluidView& fluid,
                                    std::span<const std::uint32_t> order, std::span<const float> viscosity,
                                    float h, std::span<const Vec4f> velocity) {
  const SubResolutionBody& body = bodies_[b];
  State& state = states_[b];
  Vec3f u{};
  float mass = 0, mu = 0;
  for (const Near& n : near(b)) {
    u += fluid.v[n.index].xyz() * n.share;
    mass += n.share / fluid.x[n.index].w;
    mu += n.share * viscosity[fluid_[order[n.index]]];
  }
  for (std::size_t c = 0; c < 2; ++c) u -= velocity[body.particles[c]].xyz() * body.weights[c];
  const float rho = mass / fluid.smoothing.volume(), r = body.radius, l = body.length;
  const auto circle = static_cast<float>(pi);
  const float scale = h * state.submerged;
  if (l == 0) {
    state.across = scale * (6 * circle * mu * r + 0.5f * rho * ball_drag * circle * r * r * length(u));
    state.pull = u * state.across;
    return;
  }
  const Vec3f along = state.axis * dot(state.axis, u), across = u - along;
  state.across = scale * (4 * circle * mu * l + rho * across_drag * r * l * length(across));
  const float slide = scale * (2 * circle * mu * l + rho * along_drag * r * l * length(along));
  state.pull = across * state.across + along * slide;
  state.across = std::max(state.across, slide);
}

void SubResolutionBodies::drag(const FluidView& fluid, std::span<const std::uint32_t> order,
                               std::span<const float> viscosity, float h, std::span<Vec4f> velocity,
                               std::span<const Vec4f> inverse_mass, Threads& threads) {
  for_bodies(threads, [&](std::size_t b) { find_drag(b, fluid, order, viscosity, h, velocity); });
  coupling_.assign(velocity.size(), 0);
  fluid_coupling_.assign(fluid.size(), 0);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const float k = states_[b].across;
    for (const Near& n : near(b)) fluid_coupling_[n.index] += n.share * k;
    for (std::size_t c = 0; c < 2; ++c) coupling_[bodies_[b].particles[c]] += bodies_[b].weights[c] * k;
  }
  for_bodies(threads, [&](std::size_t b) {
    float bound = 0, fluid_bound = 0;
    for (const std::uint32_t p : bodies_[b].particles)
      bound = std::max(bound, coupling_[p] * inverse_mass[p].w);
    for (const Near& n : near(b))
      fluid_bound = std::max(fluid_bound, fluid_coupling_[n.index] * fluid.x[n.index].w);
    states_[b].pull = states_[b].pull * (1 / (1 + bound + fluid_bound));
  });
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Vec3f& pull = states_[b].pull;
    for (std::size_t c = 0; c < 2; ++c) {
      const std::uint32_t p = bodies_[b].particles[c];
      velocity[p].set_xyz(velocity[p].xyz() + pull * (bodies_[b].weights[c] * inverse_mass[p].w));
    }
    for (const Near& n : near(b))
      fluid.v[n.index].set_xyz(fluid.v[n.index].xyz() - pull * (n.share * fluid.x[n.index].w));
  }
}

}  // namespace souple
