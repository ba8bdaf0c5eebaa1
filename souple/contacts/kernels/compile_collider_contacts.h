#pragma once

#include "souple/contacts/contact_law.h"
#include "souple/contacts/kernels/collider_surfaces.h"
#include "souple/contacts/kernels/rolling_balls.h"

// Include this only in translation units that are compiled for one instruction set. Every template here has
// the tag of its instruction set as an argument.

namespace souple::kernels {

template <class Isa>
SOUPLE_INLINE inline Numbers<Isa> inverse_masses(const ColliderParticles& particles,
                                                 const ParticlePack<Isa>& pack) {
  float w[Isa::lanes];
  for (int lane = 0; lane < Isa::lanes; ++lane) w[lane] = particles.position[pack.first_float[lane] + 3];
  return Numbers<Isa>::load(w);
}

template <class Isa>
[[gnu::flatten]] void distances(const ColliderParticles& particles, const ColliderBody& body,
                                const std::uint32_t* particle, std::size_t begin, std::size_t end,
                                float* distance) {
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ParticlePack<Isa> pack(particle, i, end);
    const Vectors<Isa> w = end_in_frame<Isa>(particles, body, pack);
    store<Isa>(surface_at<Isa>(body.shape, w, pack.count).distance, distance + i, pack.count);
  }
}

template <class Isa>
[[gnu::flatten]] void find(const ColliderParticles& particles, const ColliderBody& body,
                           const std::uint32_t* particle, const float* keeps, std::size_t begin,
                           std::size_t end, float* distance) {
  using T = Numbers<Isa>;
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ParticlePack<Isa> pack(particle, i, end);
    const Motion<Isa> motion(particles, body, pack);
    const T d = surface_at<Isa>(body.shape, motion.to, pack.count).distance;
    const T r = load<Isa>(keeps + i, pack.count), path = length(motion.to - motion.from);
    const auto near = d - r <= max(r, path) && inverse_masses<Isa>(particles, pack) > T(0.f);
    store<Isa>(select(near, d, T(__builtin_inff())), distance + i, pack.count);
  }
}

/// may_tunnel (sphere_cast.h).
template <class Isa>
SOUPLE_INLINE inline auto passes(const Numbers<Isa>& start, const Numbers<Isa>& end, const Numbers<Isa>& path,
                                 const Numbers<Isa>& r) {
  const Numbers<Isa> free = start + end;
  return end <= Numbers<Isa>(0.f) || path >= free || (path > r && path >= free - r - r);
}

/// The surface that a ball touches first, or, where it touches none, `hits` 0.
template <class Isa>
struct FirstTouch {
  Surface<Isa> surface;
  Vectors<Isa> point;  ///< center of the ball
  Numbers<Isa> hits;   ///< 1 or 0
};

/// sphere_cast (sphere_cast.h) for the lanes `casts`, which start outside.
template <class Isa>
SOUPLE_INLINE inline FirstTouch<Isa> first_touch(const ColliderShape& shape, const Surface<Isa>& start,
                                                 const Vectors<Isa>& from, const Vectors<Isa>& motion,
                                                 Numbers<Isa> r, typename Numbers<Isa>::Mask casts,
                                                 int count) {
  using T = Numbers<Isa>;
  constexpr int strides = 64;
  const T zero(0.f), one(1.f), path = length(motion), per_path = one / select(path > zero, path, one);
  FirstTouch<Isa> touch{start, from, one};
  const auto leaves = casts && start.distance <= r && dot(start.normal, motion) >= zero;
  if (shape.form == ColliderForm::field) {
    r = select(leaves, start.distance * T(0.5f), r);
  } else {
    touch.hits = select(leaves, zero, one);
  }
  casts = casts && start.distance > r;
  const T near_enough = (start.distance - r) * T(1e-4f) + r * T(1e-3f);
  T gone = zero;
  for (int stride = 0; stride < strides; ++stride) {
    const T free = touch.surface.distance - r;
    casts = casts && free > near_enough;
    if (!any_lane(casts)) break;
    gone = select(casts, gone + free, gone);
    touch.hits = select(casts && gone >= path, zero, touch.hits);
    casts = casts && gone < path;
    const Vectors<Isa> point = from + motion * (gone * per_path);
    const Surface<Isa> at = surface_at<Isa>(shape, point, count);
    touch.point = selected<Isa>(casts, point, touch.point);
    touch.surface = {select(casts, at.distance, touch.surface.distance),
                     selected<Isa>(casts, at.normal, touch.surface.normal)};
  }
  return touch;
}

template <class Isa>
[[gnu::flatten]] void describe(const ColliderParticles& particles, const ColliderBody& body,
                               const ColliderContactColumns& out, std::size_t begin, std::size_t end) {
  using T = Numbers<Isa>;
  const T zero(0.f), one(1.f);
  const Vectors<Isa> none{zero, zero, zero};
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ParticlePack<Isa> pack(out.particle, i, end);
    const int count = pack.count;
    const Motion<Isa> motion(particles, body, pack);
    const Surface<Isa> start = surface_at<Isa>(body.shape, motion.from, count);
    const T r = load<Isa>(out.distance + i, count), d_end = load<Isa>(out.end_distance + i, count);
    const T overlap = start.distance - r;
    const auto inside = start.distance <= zero;
    const auto fast = passes<Isa>(start.distance, d_end, length(motion.to - motion.from), r);
    FirstTouch<Isa> touch{start, motion.from, one};
    const auto casts = fast && start.distance > zero;
    if (body.shape.form != ColliderForm::plane && any_lane(casts))
      touch = first_touch<Isa>(body.shape, start, motion.from, motion.to - motion.from, r, casts, count);
    store<Isa>(select(inside, one, select(fast, touch.hits, zero)), out.fixed_plane + i, count);
    store<Isa>(dot(touch.surface.normal, touch.point) - touch.surface.distance, out.plane_offset + i, count);
    const T slop = min(zero, overlap + load<Isa>(out.slop + i, count));
    store<Isa>(select(overlap < zero, slop, zero), out.slop + i, count);
    store3<Isa>(touch.surface.normal, out.start_normal, i, count);
    store3<Isa>(product<Isa>(body.after.axis, motion.to - motion.from), out.predicted, i, count);
    store3<Isa>(none, out.tangent_sum, i, count);
    store3<Isa>(none, out.normal, i, count);
    store3<Isa>(none, out.surface_motion, i, count);
    for (float* const column : {out.normal_sum, out.restitution_velocity, out.depth})
      store<Isa>(zero, column + i, count);
  }
}

/// C, and the surface below a particle in the frame.
template <class Isa>
struct Gap {
  Numbers<Isa> C;
  Vectors<Isa> normal, surface;

  SOUPLE_INLINE Gap(const ColliderBody& body, const ColliderContactColumns& columns, const Vectors<Isa>& w,
                    std::size_t i, int count) {
    using T = Numbers<Isa>;
    const T zero(0.f);
    normal = load3<Isa>(columns.start_normal, i, count);
    const auto fixed = load<Isa>(columns.fixed_plane + i, count) > zero;
    T distance = dot(normal, w) - load<Isa>(columns.plane_offset + i, count);
    const Surface<Isa> at = surface_at<Isa>(body.shape, w, count);
    const auto on_plane = fixed || at.distance <= zero;
    distance = select(on_plane, distance, at.distance);
    normal = selected<Isa>(on_plane, normal, at.normal);
    C = distance - load<Isa>(columns.distance + i, count);
    surface = w - normal * distance;
  }
};

/// Rotation of balls relative to the body, times the radius [m].
template <class Isa>
SOUPLE_INLINE inline Vectors<Isa> relative_rotation(const RollingBalls<Isa>& balls, const ColliderBody& body,
                                                    const ColliderContactColumns& columns, std::size_t i,
                                                    int count) {
  if (!body.moves) return balls.turned;
  return balls.turned - vector_of<Isa>(body.rotation) * load<Isa>(columns.radius + i, count);
}

//   dn = max(slop - C, -N)                        N, the normal sum: never negative, later iterations may reduce it
//   t  = (I - n n^T) (p - x - surface motion)     tangential displacement relative to the surface
//   T' = T - t                                    T, the tangent sum, cancels t; beyond mu_s N it is cut to mu_k N
template <class Isa>
[[gnu::flatten]] void project(const ColliderParticles& particles, const ColliderBody& body,
                              const ColliderContactColumns& columns, std::size_t begin, std::size_t end) {
  using T = Numbers<Isa>;
  const T zero(0.f);
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ParticlePack<Isa> pack(columns.particle, i, end);
    const int count = pack.count;
    const Motion<Isa> motion(particles, body, pack);
    const Gap<Isa> gap(body, columns, motion.to, i, count);
    const T slop = load<Isa>(columns.slop + i, count);
    ContactSums<T> sums = load_sums<Isa>(columns, i, count);
    const Vectors<Isa> n = product<Isa>(body.after.axis, gap.normal);
    Vectors<Isa> moved = motion.moved;
    store3<Isa>(n, columns.normal, i, count);
    store<Isa>(gap.C - dot(n, moved), columns.plane_gap + i, count);
    const auto acts = slop > gap.C || sums.normal_sum > zero;
    if (!any_lane(acts)) continue;
    if (body.moves) {
      const Vectors<Isa> carried = product<Isa>(body.turn, gap.surface) + vector_of<Isa>(body.shift);
      moved -= carried;
      store3<Isa>(selected<Isa>(acts, carried, load3<Isa>(columns.surface_motion, i, count)),
                  columns.surface_motion, i, count);
    }
    const ContactSums<T> before = sums;
    const Vectors<Isa> change = solve_pack<Isa>(
        sums, acts, gap.C, slop, n, moved, particles.turn, columns, pack.first_float, i, count,
        [&](const auto& balls) { return relative_rotation<Isa>(balls, body, columns, i, count); });
    store_sums<Isa>(selected_sums<Isa>(acts, sums, before), columns, i, count);
    add_to_records<Isa>(particles.corrected, pack.first_float,
                        selected<Isa>(acts, change, {zero, zero, zero}));
  }
}

template <class Isa>
[[gnu::flatten]] void project_again(const ColliderParticles& particles, const ColliderContactColumns& columns,
                                    std::size_t begin, std::size_t end) {
  using T = Numbers<Isa>;
  const T nothing(-0.f);  // what is added to it keeps its sign
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ParticlePack<Isa> pack(columns.particle, i, end);
    const int count = pack.count;
    Vectors<Isa> moved = Records<Isa>(particles.moving, pack.first_float).components();
    moved -= Records<Isa>(particles.start, pack.first_float).components();
    const Vectors<Isa> n = load3<Isa>(columns.normal, i, count);
    const T C = load<Isa>(columns.plane_gap + i, count) + dot(n, moved);
    const T slop = load<Isa>(columns.slop + i, count);
    ContactSums<T> sums = load_sums<Isa>(columns, i, count);
    const auto acts = slop > C || sums.normal_sum > T(0.f);
    if (!any_lane(acts)) continue;
    const ContactSums<T> before = sums;
    const Vectors<Isa> change = solve_contact(
        sums, C, slop, n, moved - load3<Isa>(columns.surface_motion, i, count),
        load<Isa>(columns.static_friction + i, count), load<Isa>(columns.kinetic_friction + i, count));
    store_sums<Isa>(selected_sums<Isa>(acts, sums, before), columns, i, count);
    add_to_records<Isa>(particles.corrected, pack.first_float,
                        selected<Isa>(acts, change, {nothing, nothing, nothing}));
  }
}

template <class Isa>
[[gnu::flatten]] void apply_restitution(const ColliderParticles& particles, const ColliderBody& body,
                                        const ColliderContactLimits& limits,
                                        const ColliderContactColumns& columns, std::size_t begin,
                                        std::size_t end) {
  using T = Numbers<Isa>;
  const T zero(0.f), inverse_h(limits.inverse_h);
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ParticlePack<Isa> pack(columns.particle, i, end);
    const int count = pack.count;
    const ContactSums<T> sums = load_sums<Isa>(columns, i, count);
    const auto acts = sums.normal_sum > zero;
    if (!any_lane(acts)) continue;
    const Vectors<Isa> n = load3<Isa>(columns.normal, i, count);
    const Vectors<Isa> v = Records<Isa>(particles.velocity, pack.first_float).components();
    const Vectors<Isa> u = v - load3<Isa>(columns.surface_motion, i, count) * inverse_h;
    const T approach = -dot(n, load3<Isa>(columns.predicted, i, count)) * inverse_h;
    const auto [change, restitution_velocity] = restitute_pack<Isa>(
        sums, acts, n, u, approach, limits, particles.turn, columns, pack.first_float, i, count,
        [&](const auto& balls) { return relative_rotation<Isa>(balls, body, columns, i, count); });
    add_to_records<Isa>(particles.velocity, pack.first_float,
                        selected<Isa>(acts, change, {zero, zero, zero}));
    store<Isa>(select(acts, restitution_velocity, zero), columns.restitution_velocity + i, count);
    const Gap<Isa> gap(body, columns, end_in_frame<Isa>(particles, body, pack), i, count);
    store<Isa>(select(acts, max(zero, -gap.C), zero), columns.depth + i, count);
  }
}

template <class Isa>
void gaps(const ColliderParticles& particles, const ColliderBody& body, const ColliderContactColumns& columns,
          std::size_t begin, std::size_t end, float* C, float* const* surface) {
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ParticlePack<Isa> pack(columns.particle, i, end);
    const Gap<Isa> gap(body, columns, end_in_frame<Isa>(particles, body, pack), i, pack.count);
    store<Isa>(gap.C, C + (i - begin), pack.count);
    for (int axis = 0; surface && axis < 3; ++axis)
      store<Isa>(gap.surface[axis], surface[axis] + (i - begin), pack.count);
  }
}

template <class Isa>
bool left(const ColliderParticles& particles, const std::uint32_t* particle, const float* const (&at)[3],
          const float* margin, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ParticlePack<Isa> pack(particle, i, end);
    Vectors<Isa> x = Records<Isa>(particles.position, pack.first_float).components();
    x -= {load<Isa>(at[0] + i, pack.count), load<Isa>(at[1] + i, pack.count),
          load<Isa>(at[2] + i, pack.count)};
    x += Records<Isa>(particles.moving, pack.first_float).components();
    const Numbers<Isa> m = load<Isa>(margin + i, pack.count);
    if (any_lane(length_squared(x) > m * m)) return true;
  }
  return false;
}

template <class Isa>
const ColliderContactKernels& collider_contact_kernels() {
  static constexpr ColliderContactKernels kernels{distances<Isa>, find<Isa>,          describe<Isa>,
                                                  project<Isa>,   project_again<Isa>, apply_restitution<Isa>,
                                                  gaps<Isa>,      left<Isa>};
  return kernels;
}

}  // namespace souple::kernels
