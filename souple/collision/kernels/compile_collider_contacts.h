#pragma once

#include "souple/collision/contact_law.h"
#include "souple/collision/kernels/collider_contacts.h"
#include "souple/collision/kernels/registers.h"

// Include this only in translation units that are compiled for one instruction set. Every template here has
// the tag of its instruction set as an argument.

namespace souple::kernels {

/// Distance from a surface and its gradient.
template <class Isa>
struct Surface {
  Numbers<Isa> distance;
  Vectors<Isa> normal;
};

/// The first floats of the records of a register of particles.
template <class Isa>
struct ParticlePack {
  std::uint32_t first_float[Isa::lanes];
  int count;

  SOUPLE_INLINE ParticlePack(const std::uint32_t* particle, std::size_t i, std::size_t end) {
    const Indices<Isa> indices(i, end);
    count = indices.count;
    for (int lane = 0; lane < Isa::lanes; ++lane) first_float[lane] = 4 * particle[indices.at[lane]];
  }
};

template <class Isa>
SOUPLE_INLINE inline Vectors<Isa> vector_of(const float (&v)[3]) {
  return {Numbers<Isa>(v[0]), Numbers<Isa>(v[1]), Numbers<Isa>(v[2])};
}
template <class Isa>
SOUPLE_INLINE inline Vectors<Isa> product(const float (&column)[3][3], const Vectors<Isa>& v) {
  return vector_of<Isa>(column[0]) * v.x + vector_of<Isa>(column[1]) * v.y + vector_of<Isa>(column[2]) * v.z;
}

/// w = R^T ((x - o) - o' + q)
template <class Isa>
SOUPLE_INLINE inline Vectors<Isa> to_frame(const ColliderFrame& frame, const Vectors<Isa>& x,
                                           const Vectors<Isa>& q) {
  const Vectors<Isa> d = (x - vector_of<Isa>(frame.origin)) - vector_of<Isa>(frame.origin_rest) + q;
  return {dot(vector_of<Isa>(frame.axis[0]), d), dot(vector_of<Isa>(frame.axis[1]), d),
          dot(vector_of<Isa>(frame.axis[2]), d)};
}

/// Positions of a register of particles in the frames of a body at the substep's start and end, and their motion
/// in the world.
template <class Isa>
struct Motion {
  Vectors<Isa> from, to, moved;

  SOUPLE_INLINE Motion(const ColliderParticles& particles, const ColliderBody& body,
                       const ParticlePack<Isa>& pack) {
    const Vectors<Isa> x = Records<Isa>(particles.position, pack.first_float).components();
    const Vectors<Isa> start = Records<Isa>(particles.start, pack.first_float).components();
    const Vectors<Isa> zero{0.f, 0.f, 0.f};
    if (particles.position == particles.moving) {
      moved = x - start;
      from = to_frame<Isa>(body.before, start, zero), to = to_frame<Isa>(body.after, x, zero);
      return;
    }
    const Vectors<Isa> q = Records<Isa>(particles.moving, pack.first_float).components();
    moved = q - start;
    from = to_frame<Isa>(body.before, x, start), to = to_frame<Isa>(body.after, x, q);
  }
};

template <class Isa>
SOUPLE_INLINE inline Vectors<Isa> end_in_frame(const ColliderParticles& particles, const ColliderBody& body,
                                               const ParticlePack<Isa>& pack) {
  const Vectors<Isa> x = Records<Isa>(particles.position, pack.first_float).components();
  const bool plain = particles.position == particles.moving;
  const Vectors<Isa> zero{0.f, 0.f, 0.f};
  return to_frame<Isa>(body.after, x,
                       plain ? zero : Records<Isa>(particles.moving, pack.first_float).components());
}

template <class Isa>
SOUPLE_INLINE inline Vectors<Isa> selected(typename Numbers<Isa>::Mask mask, const Vectors<Isa>& a,
                                           const Vectors<Isa>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

/// The surface at distance `radius` around a point. `fallback`: the normal at that point itself.
template <class Isa>
SOUPLE_INLINE inline Surface<Isa> around_point(const Vectors<Isa>& offset, float radius,
                                               const Vectors<Isa>& fallback) {
  using T = Numbers<Isa>;
  const T l = length(offset);
  const auto away = l > T(0.f);
  return {l - T(radius), selected<Isa>(away, offset * (T(1.f) / select(away, l, T(1.f))), fallback)};
}

template <class Isa>
SOUPLE_INLINE inline Numbers<Isa> with_sign(const Numbers<Isa>& a, const Numbers<Isa>& sign) {
  return select(sign < Numbers<Isa>(0.f), -a, a);
}

/// Outside: the vector beyond the faces. Inside: the nearest face.
template <class Isa>
SOUPLE_INLINE inline Surface<Isa> box_surface(const ColliderShape& shape, const Vectors<Isa>& w) {
  using T = Numbers<Isa>;
  const T zero(0.f), one(1.f);
  const Vectors<Isa> depth{abs(w.x) - T(shape.half_extents[0]), abs(w.y) - T(shape.half_extents[1]),
                           abs(w.z) - T(shape.half_extents[2])};
  const Vectors<Isa> beyond{max(depth.x, zero), max(depth.y, zero), max(depth.z, zero)};
  const T l = length(beyond);
  const auto outside = l > zero;
  const T inverse = one / select(outside, l, one);
  const T deepest = max(depth.x, max(depth.y, depth.z));
  const auto is_x = depth.x >= deepest, is_y = depth.y >= deepest;
  const Vectors<Isa> face{select(is_x, one, zero), select(is_x, zero, select(is_y, one, zero)),
                          select(is_x, zero, select(is_y, zero, one))};
  const Vectors<Isa> n = selected<Isa>(outside, beyond * inverse, face);
  return {select(outside, l, deepest),
          {with_sign<Isa>(n.x, w.x), with_sign<Isa>(n.y, w.y), with_sign<Isa>(n.z, w.z)}};
}

template <class Isa>
SOUPLE_INLINE inline Surface<Isa> cylinder_surface(const ColliderShape& shape, const Vectors<Isa>& w) {
  using T = Numbers<Isa>;
  const T zero(0.f), one(1.f);
  const T from_axis = sqrt(w.x * w.x + w.z * w.z);
  const auto off_axis = from_axis > zero;
  const T inverse = one / select(off_axis, from_axis, one);
  const T x = select(off_axis, w.x * inverse, one), z = select(off_axis, w.z * inverse, zero);
  const T side = from_axis - T(shape.radius), end = abs(w.y) - T(shape.half_extents[1]);
  const T beyond_side = max(side, zero), beyond_end = max(end, zero);
  const T l = sqrt(beyond_side * beyond_side + beyond_end * beyond_end);
  const auto outside = l > zero, at_side = side > end;
  const T per_l = one / select(outside, l, one);
  const T radial = select(outside, beyond_side * per_l, select(at_side, one, zero));
  const T axial = select(outside, beyond_end * per_l, select(at_side, zero, one));
  return {select(outside, l, max(side, end)), {x * radial, with_sign<Isa>(axial, w.y), z * radial}};
}

template <class Isa>
SOUPLE_INLINE inline Surface<Isa> field_surface(const ColliderShape& shape, const Vectors<Isa>& w,
                                                int count) {
  float x[3][Isa::lanes], d[Isa::lanes], n[3][Isa::lanes];
  for (int axis = 0; axis < 3; ++axis) w[axis].store(x[axis]);
  shape.sample(shape.field, count, {x[0], x[1], x[2]}, d, {n[0], n[1], n[2]});
  for (int lane = count; lane < Isa::lanes; ++lane) {
    d[lane] = d[count - 1];
    for (auto& component : n) component[lane] = component[count - 1];
  }
  using T = Numbers<Isa>;
  return {T::load(d), {T::load(n[0]), T::load(n[1]), T::load(n[2])}};
}

template <class Isa>
SOUPLE_INLINE inline Surface<Isa> surface_at(const ColliderShape& shape, const Vectors<Isa>& w, int count) {
  using T = Numbers<Isa>;
  const T zero(0.f), one(1.f);
  switch (shape.form) {
    case ColliderForm::plane:
      return {w.y, {zero, one, zero}};
    case ColliderForm::sphere:
      return around_point<Isa>(w, shape.radius, {zero, one, zero});
    case ColliderForm::capsule: {
      const T h(shape.half_extents[1]);
      return around_point<Isa>({w.x, w.y - max(-h, min(h, w.y)), w.z}, shape.radius, {one, zero, zero});
    }
    case ColliderForm::box:
      return box_surface<Isa>(shape, w);
    case ColliderForm::cylinder:
      return cylinder_surface<Isa>(shape, w);
    case ColliderForm::field:
      break;
  }
  return field_surface<Isa>(shape, w, count);
}

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

template <class Isa>
SOUPLE_INLINE inline Vectors<Isa> load3(float* const (&column)[3], std::size_t i, int count) {
  return {load<Isa>(column[0] + i, count), load<Isa>(column[1] + i, count), load<Isa>(column[2] + i, count)};
}
template <class Isa>
SOUPLE_INLINE inline void store3(const Vectors<Isa>& v, float* const (&column)[3], std::size_t i, int count) {
  for (int axis = 0; axis < 3; ++axis) store<Isa>(v[axis], column[axis] + i, count);
}

template <class Isa>
[[gnu::flatten]] void describe(const ColliderParticles& particles, const ColliderBody& body,
                               const ColliderContactLimits& limits, const ColliderContactColumns& out,
                               std::size_t begin, std::size_t end) {
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
    store<Isa>(select(inside, one, select(fast, T(2.f), zero)), out.fixed_plane + i, count);
    store<Isa>(dot(start.normal, motion.from) - start.distance, out.plane_offset + i, count);
    store<Isa>(select(overlap < zero, min(zero, overlap + T(limits.depenetration)), zero), out.slop + i,
               count);
    store3<Isa>(start.normal, out.start_normal, i, count);
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

// dn = max(slop - C, -N)                        N, the normal sum: never negative, later iterations may reduce it
// t  = (I - n n^T) (p - x - surface motion)     tangential displacement relative to the surface
// T' = T - t                                    T, the tangent sum, cancels t; beyond mu_s N it is cut to mu_k N
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
    ContactSums<T> sums{load<Isa>(columns.normal_sum + i, count), load3<Isa>(columns.tangent_sum, i, count)};
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
    const Vectors<Isa> change =
        solve_contact(sums, gap.C, slop, n, moved, load<Isa>(columns.static_friction + i, count),
                      load<Isa>(columns.kinetic_friction + i, count));
    store<Isa>(select(acts, sums.normal_sum, before.normal_sum), columns.normal_sum + i, count);
    store3<Isa>(selected<Isa>(acts, sums.tangent_sum, before.tangent_sum), columns.tangent_sum, i, count);
    Records<Isa> records(particles.corrected, pack.first_float);
    records.transpose();
    for (int axis = 0; axis < 3; ++axis)
      records.r[axis] = (Numbers<Isa>(records.r[axis]) + select(acts, change[axis], zero)).v;
    records.write(particles.corrected, pack.first_float);
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
    const ContactSums<T> sums{load<Isa>(columns.normal_sum + i, count),
                              load3<Isa>(columns.tangent_sum, i, count)};
    const auto acts = sums.normal_sum > zero;
    if (!any_lane(acts)) continue;
    const Vectors<Isa> n = load3<Isa>(columns.normal, i, count);
    Records<Isa> records(particles.velocity, pack.first_float);
    records.transpose();
    const Vectors<Isa> v{T(records.r[0]), T(records.r[1]), T(records.r[2])};
    const Vectors<Isa> u = v - load3<Isa>(columns.surface_motion, i, count) * inverse_h;
    const auto [change, restitution_velocity] =
        solve_restitution(sums, n, u, -dot(n, load3<Isa>(columns.predicted, i, count)) * inverse_h,
                          T(limits.restitution_threshold), load<Isa>(columns.restitution + i, count),
                          load<Isa>(columns.static_friction + i, count),
                          load<Isa>(columns.kinetic_friction + i, count), inverse_h);
    for (int axis = 0; axis < 3; ++axis)
      records.r[axis] = (Numbers<Isa>(records.r[axis]) + select(acts, change[axis], zero)).v;
    records.write(particles.velocity, pack.first_float);
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
  const bool plain = particles.position == particles.moving;
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ParticlePack<Isa> pack(particle, i, end);
    Vectors<Isa> x = Records<Isa>(particles.position, pack.first_float).components();
    x -= {load<Isa>(at[0] + i, pack.count), load<Isa>(at[1] + i, pack.count),
          load<Isa>(at[2] + i, pack.count)};
    if (!plain) x += Records<Isa>(particles.moving, pack.first_float).components();
    const Numbers<Isa> m = load<Isa>(margin + i, pack.count);
    if (any_lane(length_squared(x) > m * m)) return true;
  }
  return false;
}

template <class Isa>
const ColliderContactKernels& collider_contact_kernels() {
  static constexpr ColliderContactKernels kernels{
      distances<Isa>, find<Isa>, describe<Isa>, project<Isa>, apply_restitution<Isa>, gaps<Isa>, left<Isa>};
  return kernels;
}

}  // namespace souple::kernels
