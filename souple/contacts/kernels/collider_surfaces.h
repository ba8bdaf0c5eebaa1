#pragma once

#include "souple/contacts/kernels/collider_contacts.h"
#include "souple/simd/registers.h"

// Particles in a collider's frame, and the distance and normal of its surface there, a register at a time. Include
// this only in translation units that are compiled for one instruction set. Every template here has the tag of its
// instruction set as an argument.

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
    const Vectors<Isa> q = Records<Isa>(particles.moving, pack.first_float).components();
    moved = q - start;
    from = to_frame<Isa>(body.before, x, start), to = to_frame<Isa>(body.after, x, q);
  }
};

template <class Isa>
SOUPLE_INLINE inline Vectors<Isa> end_in_frame(const ColliderParticles& particles, const ColliderBody& body,
                                               const ParticlePack<Isa>& pack) {
  const Vectors<Isa> x = Records<Isa>(particles.position, pack.first_float).components();
  return to_frame<Isa>(body.after, x, Records<Isa>(particles.moving, pack.first_float).components());
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

/// The whole part of numbers that are not negative.
template <class Isa>
SOUPLE_INLINE inline typename Isa::Mask whole_part(const Numbers<Isa>& a) {
  if constexpr (Isa::lanes == 1) {
    return static_cast<int>(a.v);
  } else {
    return __builtin_convertvector(a.v, typename Isa::Mask);
  }
}
template <class Isa>
SOUPLE_INLINE inline Numbers<Isa> number_of(const typename Isa::Mask& a) {
  if constexpr (Isa::lanes == 1) {
    return Numbers<Isa>(static_cast<float>(a));
  } else {
    return Numbers<Isa>(__builtin_convertvector(a, typename Isa::Vector));
  }
}

/// Distances of a register of points at the corners of their cells.
template <class Isa>
struct CellPack {
  static constexpr int block_cells = 8, block_side = block_cells + 1;
  float distance[8][Isa::lanes];  ///< [z][y][x] [m]
  Vectors<Isa> at;                ///< position in the cell, 0 to 1
  bool any_outside;               ///< of the grid
  Numbers<Isa> outside;           ///< 1 or 0

  SOUPLE_INLINE CellPack(const ColliderGrid& grid, const Vectors<Isa>& w) {
    using T = Numbers<Isa>;
    using Whole = typename Isa::Mask;
    const T zero(0.f), one(1.f), per_spacing(1 / grid.spacing);
    Whole block[3], cell[3];
    Vectors<Isa> in_block;
    auto inside = zero <= one;
    for (int axis = 0; axis < 3; ++axis) {
      const int cells = grid.blocks[axis] * block_cells;
      const T most(static_cast<float>(cells)), last(static_cast<float>(cells - 1));
      const T c = (w[axis] - T(grid.origin[axis])) * per_spacing;
      inside = inside && c >= zero && c <= most;
      const T within = select(c >= zero, min(c, most), zero);  // 0 for NaN
      const Whole i = whole_part<Isa>(min(within, last));
      block[axis] = i >> 3, cell[axis] = i & 7;
      at[axis] = within - number_of<Isa>(i);
      in_block[axis] = (within - number_of<Isa>(block[axis] << 3)) * T(1.f / block_cells);
    }
    outside = select(inside, zero, one);
    any_outside = any_lane(outside > zero);
    const Whole blocks = (block[2] * grid.blocks[1] + block[1]) * grid.blocks[0] + block[0];
    const Whole corners = (block[2] * (grid.blocks[1] + 1) + block[1]) * (grid.blocks[0] + 1) + block[0];
    const Whole points = (cell[2] * block_side + cell[1]) * block_side + cell[0];
    fetch(grid, &blocks, &corners, &points, in_block);
  }

 private:
  SOUPLE_INLINE void fetch(const ColliderGrid& grid, const void* blocks, const void* corners,
                           const void* points, const Vectors<Isa>& in_block) {
    std::int32_t block[Isa::lanes], corner[Isa::lanes], point[Isa::lanes];
    __builtin_memcpy(block, blocks, sizeof block), __builtin_memcpy(corner, corners, sizeof corner);
    __builtin_memcpy(point, points, sizeof point);
    float coarse[Isa::lanes];
    bool any_coarse = false;
    for (int lane = 0; lane < Isa::lanes; ++lane) {
      const std::int32_t slot = grid.slot[block[lane]];
      constexpr std::ptrdiff_t side = block_side, block_points = side * side * side;
      const float* first = grid.points + (slot < 0 ? 0 : slot * block_points + point[lane]);
      std::ptrdiff_t row = side, layer = side * side;
      if (slot < 0) {
        row = grid.blocks[0] + 1, layer = row * (grid.blocks[1] + 1);
        first = grid.corners + corner[lane];
        any_coarse = true;
      }
      coarse[lane] = slot < 0 ? 1.f : 0.f;
      for (int k = 0; k < 8; ++k) distance[k][lane] = first[(k & 1) + (k >> 1 & 1) * row + (k >> 2) * layer];
    }
    if (any_coarse) at = selected<Isa>(Numbers<Isa>::load(coarse) > Numbers<Isa>(0.f), in_block, at);
  }
};

/// Beyond the grid: a lower bound of the distance, max(|w - c|, d - |w - c|). Here d is the distance at the nearest
/// point c of the grid's box, which contains the surface.
template <class Isa>
SOUPLE_INLINE inline Surface<Isa> beyond_grid(const ColliderGrid& grid, const Vectors<Isa>& w,
                                              const Surface<Isa>& at_box) {
  using T = Numbers<Isa>;
  Vectors<Isa> offset;
  for (int axis = 0; axis < 3; ++axis) {
    const T lo(grid.origin[axis]),
        hi(grid.origin[axis] + static_cast<float>(grid.blocks[axis] * 8) * grid.spacing);
    offset[axis] = w[axis] - min(max(w[axis], lo), hi);
  }
  const T beyond = length(offset), zero(0.f), one(1.f);
  const auto outside = beyond > zero;
  return {select(outside, max(beyond, at_box.distance - beyond), at_box.distance),
          selected<Isa>(outside, offset * (one / select(outside, beyond, one)), at_box.normal)};
}

/// Trilinear in a cell, as SignedDistanceField::at; the normal is the direction of its gradient.
template <class Isa>
[[gnu::noinline]] Surface<Isa> field_surface(const ColliderShape& shape, const Vectors<Isa>& w, int count) {
  using T = Numbers<Isa>;
  const CellPack<Isa> cell(shape.grid, w);
  const auto between = [](const T& a, const T& b, const T& s) { return a + (b - a) * s; };
  const auto& [x, y, z] = cell.at;
  T along[4], slope[4];
  for (int k = 0; k < 4; ++k) {
    const T a = T::load(cell.distance[2 * k]), b = T::load(cell.distance[2 * k + 1]);
    along[k] = between(a, b, x), slope[k] = b - a;
  }
  const T low = between(along[0], along[1], y), high = between(along[2], along[3], y);
  const Vectors<Isa> gradient{between(between(slope[0], slope[1], y), between(slope[2], slope[3], y), z),
                              between(along[1] - along[0], along[3] - along[2], z), high - low};
  const T steep = length(gradient);
  const auto sloped = steep > T(1e-9f);
  Surface<Isa> result{between(low, high, z),
                      selected<Isa>(sloped, gradient * (T(1.f) / select(sloped, steep, T(1.f))),
                                    Vectors<Isa>{T(0.f), T(1.f), T(0.f)})};
  if (!cell.any_outside) return result;
  if (!shape.sample) return beyond_grid<Isa>(shape.grid, w, result);
  float p[3][Isa::lanes], d[Isa::lanes], n[3][Isa::lanes], outside[Isa::lanes];
  result.distance.store(d), cell.outside.store(outside);
  for (int axis = 0; axis < 3; ++axis) w[axis].store(p[axis]), result.normal[axis].store(n[axis]);
  for (int lane = 0; lane < count; ++lane)
    if (outside[lane] > 0)
      shape.sample(shape.field, 1, {p[0] + lane, p[1] + lane, p[2] + lane}, d + lane,
                   {n[0] + lane, n[1] + lane, n[2] + lane});
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

}  // namespace souple::kernels
