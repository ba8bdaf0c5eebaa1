#pragma once

#include "souple/contacts/kernels/collider_elements.h"
#include "souple/contacts/kernels/collider_surfaces.h"

// Include this only in translation units that are compiled for one instruction set. Every template here has
// the tag of its instruction set as an argument.

namespace souple::kernels {

/// Corners of a register of elements.
template <class Isa, int corners>
struct ElementPack {
  std::uint32_t first_float[corners][Isa::lanes];
  int count;

  SOUPLE_INLINE ElementPack(const ColliderElements& elements, std::size_t i, std::size_t end)
      : ElementPack(elements, Indices<Isa>(i, end)) {}
  SOUPLE_INLINE ElementPack(const ColliderElements& elements, const Indices<Isa>& indices)
      : count(indices.count) {
    for (int k = 0; k < corners; ++k)
      for (int lane = 0; lane < Isa::lanes; ++lane)
        first_float[k][lane] = elements.corner[k][indices.at[lane]];
  }
  SOUPLE_INLINE void load(const float* records, Vectors<Isa> (&x)[corners]) const {
    for (int k = 0; k < corners; ++k) x[k] = Records<Isa>(records, first_float[k]).components();
  }
};

template <class Isa>
SOUPLE_INLINE inline void write_points(const Vectors<Isa>& x, const Numbers<Isa>& path, float* records,
                                       const std::uint32_t* first_float) {
  Records<Isa> record;
  for (int axis = 0; axis < 3; ++axis) record.r[axis] = x[axis].v;
  record.r[3] = path.v;
  record.write(records, first_float);
}

template <class Isa>
[[gnu::flatten]] void place(const ColliderParticles& particles, const ColliderBody& body,
                            const std::uint32_t* particle, const std::uint32_t* rows, std::size_t begin,
                            std::size_t end, const ColliderFrameRecords& out) {
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const Indices<Isa> row(i, end, rows);
    std::uint32_t source[Isa::lanes], target[Isa::lanes];
    for (int lane = 0; lane < Isa::lanes; ++lane)
      source[lane] = particle[row.at[lane]], target[lane] = 4 * row.at[lane];
    const ParticlePack<Isa> pack(source, 0, Isa::lanes);
    const Motion<Isa> motion(particles, body, pack);
    const Numbers<Isa> path = length(motion.to - motion.from);
    write_points<Isa>(motion.from, path, out.from, target);
    write_points<Isa>(motion.to, path, out.to, target);
  }
}

/// The lowest point of an edge, at part `at` of it from its first end to its second.
template <class Isa>
struct LowestOnEdge {
  Numbers<Isa> at;
  Surface<Isa> surface;
  Numbers<Isa> lower;  ///< bound of the distance everywhere on the edge [m]
  Numbers<Isa> ends;   ///< distance of the nearer end [m]
};

/// Where the distance d to a convex shape is least on the edge from a to b. d is convex, so it is above its tangents.
/// They meet at
///
///   t = ((d_b - s_b t_b) - (d_a - s_a t_a)) / (s_a - s_b),   s: slope of d along the edge,
///
/// where they are a lower bound of d. The point t replaces the end on its side (Kelley 1960). Folds of d, such as at a
/// box's edge, are reached in one step. The search of a lane ends where d is known to `tolerance`, or is above `limit`.
template <class Isa>
SOUPLE_INLINE inline LowestOnEdge<Isa> lowest_on_edge(const ColliderShape& shape, const Vectors<Isa>& a,
                                                      const Vectors<Isa>& b, const Numbers<Isa>& limit,
                                                      const Numbers<Isa>& tolerance, int count) {
  using T = Numbers<Isa>;
  constexpr int steps = 8;
  const T zero(0.f), one(1.f);
  const Vectors<Isa> along = b - a;
  const Surface<Isa> at_a = surface_at<Isa>(shape, a, count), at_b = surface_at<Isa>(shape, b, count);
  T t_a = zero, t_b = one;
  T s_a = dot(at_a.normal, along), s_b = dot(at_b.normal, along);
  T base_a = at_a.distance, base_b = at_b.distance - s_b;  // of the tangents, at t = 0
  const auto nearer_a = at_a.distance <= at_b.distance;
  LowestOnEdge<Isa> low{
      select(nearer_a, zero, one),
      {select(nearer_a, at_a.distance, at_b.distance), selected<Isa>(nearer_a, at_a.normal, at_b.normal)},
      zero,
      zero};
  low.ends = low.lower = low.surface.distance;
  auto falls = s_a < zero && s_b > zero;
  for (int step = 0; step <= steps; ++step) {
    const T t = min(max((base_b - base_a) / select(falls, s_a - s_b, one), t_a), t_b);
    low.lower = select(falls, min(base_a + s_a * t, low.surface.distance), low.lower);
    falls = falls && low.surface.distance - low.lower > tolerance && low.lower <= limit;
    if (step == steps || !any_lane(falls)) break;
    const Surface<Isa> at = surface_at<Isa>(shape, a + along * t, count);
    const auto better = falls && at.distance < low.surface.distance;
    low.at = select(better, t, low.at);
    low.surface = {select(better, at.distance, low.surface.distance),
                   selected<Isa>(better, at.normal, low.surface.normal)};
    const T s = dot(at.normal, along), base = at.distance - s * t;
    const auto left = falls && s < zero, right = falls && s >= zero;
    t_a = select(left, t, t_a), s_a = select(left, s, s_a), base_a = select(left, base, base_a);
    t_b = select(right, t, t_b), s_b = select(right, s, s_b), base_b = select(right, base, base_b);
  }
  return low;
}

/// The point of a centrally symmetric shape that is farthest along the unit vector n.
template <class Isa>
SOUPLE_INLINE inline Vectors<Isa> farthest(const ColliderShape& shape, const Vectors<Isa>& n) {
  using T = Numbers<Isa>;
  const T radius(shape.radius);
  const Vectors<Isa> corner{with_sign<Isa>(T(shape.half_extents[0]), n.x),
                            with_sign<Isa>(T(shape.half_extents[1]), n.y),
                            with_sign<Isa>(T(shape.half_extents[2]), n.z)};
  switch (shape.form) {
    case ColliderForm::sphere:
      return n * radius;
    case ColliderForm::capsule:
      return n * radius + Vectors<Isa>{T(0.f), corner.y, T(0.f)};
    case ColliderForm::cylinder: {
      const T across = sqrt(n.x * n.x + n.z * n.z), scale = radius / select(across > T(0.f), across, T(1.f));
      return {n.x * scale, corner.y, n.z * scale};
    }
    case ColliderForm::box:
    case ColliderForm::plane:
    case ColliderForm::field:
      break;
  }
  return corner;
}

/// The shape's point s farthest along a triangle's normal, and the triangle's point below it.
template <class Isa>
struct LowestInside {
  Numbers<Isa> distance;  ///< lower bound of the triangle's distance; its own where `inside` [m]
  Vectors<Isa> normal, point;
  Numbers<Isa> weight[3];
  Numbers<Isa>
      inside;  ///< 1 where s is below the triangle, so that no point of it is nearer to the shape; else 0
};

// Weights are those of nearest_on_triangle (nearest.h). A plane that cuts the shape may do so beside its triangle, or
// far from where the triangle enters it. Then the surface around the point counts, if the point is inside the shape.
template <class Isa>
SOUPLE_INLINE inline LowestInside<Isa> lowest_inside(const ColliderShape& shape, const Vectors<Isa> (&x)[3],
                                                     const Numbers<Isa>& r, int count) {
  using T = Numbers<Isa>;
  const T zero(0.f), one(1.f);
  const Vectors<Isa> across = cross(x[1] - x[0], x[2] - x[0]);
  const T area = length(across);
  const auto wide = area > zero;
  const T scale = with_sign<Isa>(one / select(wide, area, one), dot(across, x[0]));
  LowestInside<Isa> low;
  low.normal = across * scale;
  const Vectors<Isa> s = farthest<Isa>(shape, low.normal);
  low.distance = dot(low.normal, x[0] - s);
  const Vectors<Isa> a = x[0] - s, b = x[1] - s, c = x[2] - s;
  const T va = dot(across, cross(b, c)), vb = dot(across, cross(c, a)), vc = dot(across, cross(a, b));
  const T sum = va + vb + vc;
  const auto inside = wide && va >= zero && vb >= zero && vc >= zero && sum > zero;
  low.inside = select(inside, one, zero);
  const T divisor = select(inside, sum, one);
  low.weight[0] = va / divisor, low.weight[1] = vb / divisor, low.weight[2] = vc / divisor;
  low.point = s + low.normal * low.distance;
  const auto cuts = inside && low.distance < zero;
  if (!any_lane(cuts)) return low;
  const Surface<Isa> at = surface_at<Isa>(shape, low.point, count);
  low.inside = select(cuts && at.distance > zero, zero, low.inside);
  const auto deep = cuts && at.distance <= zero && low.distance < -r;
  low.distance = select(deep, at.distance, low.distance);
  low.normal = selected<Isa>(deep, at.normal, low.normal);
  return low;
}

/// Whether all corners stay above one flat side of the shape, or inside below it, while they move by at most a third of
/// `reach`. There d is linear.
template <class Isa, int corners>
SOUPLE_INLINE inline auto above_one_side(const ColliderShape& shape, const Vectors<Isa> (&x)[corners],
                                         const Numbers<Isa>& reach) {
  using T = Numbers<Isa>;
  const T rim = -reach, below = reach * T(-1 / 3.f);
  auto above = T(0.f) > T(1.f);
  const auto add = [&](const auto& height, const auto& beyond) {
    T lowest[2] = {height(x[0], 1.f), height(x[0], -1.f)}, widest = beyond(x[0]);
    for (int k = 1; k < corners; ++k) {
      lowest[0] = min(lowest[0], height(x[k], 1.f)), lowest[1] = min(lowest[1], height(x[k], -1.f));
      widest = max(widest, beyond(x[k]));
    }
    above = above || (widest <= rim && max(lowest[0], lowest[1]) >= below);
  };
  if (shape.form == ColliderForm::box) {
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const T h(shape.half_extents[axis]), h_u(shape.half_extents[u]), h_v(shape.half_extents[v]);
      add([&](const Vectors<Isa>& p, float sign) { return p[axis] * T(sign) - h; },
          [&](const Vectors<Isa>& p) { return max(abs(p[u]) - h_u, abs(p[v]) - h_v); });
    }
  } else if (shape.form == ColliderForm::cylinder) {
    const T h(shape.half_extents[1]), radius(shape.radius);
    add([&](const Vectors<Isa>& p, float sign) { return p.y * T(sign) - h; },
        [&](const Vectors<Isa>& p) { return sqrt(p.x * p.x + p.z * p.z) - radius; });
  }
  return above;
}

/// Whether all corners stay beside a part of the shape that is straight along one axis. A point inside a triangle is
/// then never the nearest one.
template <class Isa>
SOUPLE_INLINE inline auto along_straight_part(const ColliderShape& shape, const Vectors<Isa> (&x)[3],
                                              const Numbers<Isa>& reach) {
  using T = Numbers<Isa>;
  auto straight = T(0.f) > T(1.f);
  for (int axis = 0; axis < 3; ++axis) {
    const bool round = shape.form == ColliderForm::capsule || shape.form == ColliderForm::cylinder;
    if (shape.form != ColliderForm::box && !(round && axis == 1)) continue;
    const T widest = max(abs(x[0][axis]), max(abs(x[1][axis]), abs(x[2][axis])));
    straight = straight || widest <= T(shape.half_extents[axis]) - reach;
  }
  return straight;
}

/// Lower bound of a triangle's distance: that of a ball around it.
template <class Isa>
SOUPLE_INLINE inline Numbers<Isa> ball_distance(const ColliderShape& shape, const Vectors<Isa> (&x)[3],
                                                int count) {
  using T = Numbers<Isa>;
  const Vectors<Isa> middle = (x[0] + x[1] + x[2]) * T(1 / 3.f);
  const T squared =
      max(length_squared(x[0] - middle), max(length_squared(x[1] - middle), length_squared(x[2] - middle)));
  return surface_at<Isa>(shape, middle, count).distance - sqrt(squared);
}

template <class Isa>
[[gnu::flatten]] void near_edges(const ColliderBody& body, const ColliderFrameRecords& records,
                                 const ColliderElements& elements, const float* reach, std::size_t begin,
                                 std::size_t end, float* near) {
  using T = Numbers<Isa>;
  const T zero(0.f), one(1.f);
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ElementPack<Isa, 2> pack(elements, i, end);
    Vectors<Isa> x[2];
    pack.load(records.to, x);
    const T range = load<Isa>(reach + i, pack.count);
    const LowestOnEdge<Isa> low = lowest_on_edge<Isa>(body.shape, x[0], x[1], range, range, pack.count);
    const auto flat = above_one_side<Isa, 2>(body.shape, x, range);
    store<Isa>(select(low.lower <= range, select(flat, zero, one), zero), near + i, pack.count);
  }
}

template <class Isa>
[[gnu::flatten]] void near_triangles(const ColliderBody& body, const ColliderFrameRecords& records,
                                     const ColliderElements& elements, const float* reach, std::size_t begin,
                                     std::size_t end, float* near) {
  using T = Numbers<Isa>;
  const T zero(0.f), one(1.f);
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ElementPack<Isa, 3> pack(elements, i, end);
    Vectors<Isa> x[3];
    pack.load(records.to, x);
    const T range = load<Isa>(reach + i, pack.count);
    const auto far = ball_distance<Isa>(body.shape, x, pack.count) > range ||
                     above_one_side<Isa, 3>(body.shape, x, range) ||
                     along_straight_part<Isa>(body.shape, x, range);
    store<Isa>(select(far, zero, one), near + i, pack.count);
  }
}

template <class Isa, int corners>
SOUPLE_INLINE inline Numbers<Isa> longest_path(const Vectors<Isa> (&from)[corners],
                                               const Vectors<Isa> (&to)[corners]) {
  Numbers<Isa> squared = length_squared(to[0] - from[0]);
  for (int k = 1; k < corners; ++k) squared = max(squared, length_squared(to[k] - from[k]));
  return sqrt(squared);
}

/// Distances of a search [m]. `target`: distance that the deepest point keeps; it touches when it is `close` to that.
/// `sag`: least depth below the corners that needs a contact.
template <class Isa>
struct TouchRule {
  Numbers<Isa> r, target, close, tolerance, sag;

  SOUPLE_INLINE TouchRule(const Numbers<Isa>& radius, float clearance_part) : r(radius) {
    using T = Numbers<Isa>;
    target = r * T(clearance_part);
    close = r * T(0.25f);
    tolerance = r * T(0.1f);
    sag = r * T(0.8f * (1 - clearance_part));
  }
};

// Conservative advancement: an element cannot touch before it has moved by its free distance. Corners move on
// straight lines in the collider's frame. After 16 advances an element is taken to touch where it is.
constexpr int most_advances = 16;

template <class Isa>
[[gnu::flatten]] void find_edges(const ColliderBody& body, const ColliderFrameRecords& records,
                                 const ColliderElements& elements, std::size_t begin, std::size_t end,
                                 const ColliderElementTouches& out) {
  using T = Numbers<Isa>;
  const T zero(0.f), one(1.f), half(0.5f);
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ElementPack<Isa, 2> pack(elements, i, end);
    Vectors<Isa> from[2], to[2];
    pack.load(records.from, from), pack.load(records.to, to);
    const TouchRule<Isa> rule(load<Isa>(elements.radius + i, pack.count), elements.clearance_part);
    const T path = longest_path<Isa, 2>(from, to), limit = rule.r + path;
    const auto search = [&](const T& part) SOUPLE_INLINE {
      return lowest_on_edge<Isa>(body.shape, from[0] + (to[0] - from[0]) * part,
                                 from[1] + (to[1] - from[1]) * part, limit, rule.tolerance, pack.count);
    };
    LowestOnEdge<Isa> low = search(zero);
    store<Isa>(low.surface.distance, out.start_distance + i, pack.count);
    auto touches = low.lower <= limit;
    T advanced = zero, part = zero;
    auto moves = touches;
    for (int advance = 0; advance < most_advances; ++advance) {
      const T free = max(low.lower, half * low.surface.distance) - rule.target;
      moves = moves && low.surface.distance - rule.target > rule.close && free > rule.close && part < one;
      if (!any_lane(moves)) break;
      advanced = select(moves, advanced + free, advanced);
      part = select(moves, select(advanced < path, advanced / select(path > zero, path, one), one), part);
      const LowestOnEdge<Isa> next = search(part);
      low.at = select(moves, next.at, low.at);
      low.surface = {select(moves, next.surface.distance, low.surface.distance),
                     selected<Isa>(moves, next.surface.normal, low.surface.normal)};
      low.lower = select(moves, next.lower, low.lower);
      low.ends = select(moves, next.ends, low.ends);
    }
    touches = touches && (low.surface.distance <= rule.r || (moves && part < one)) &&
              low.ends - low.surface.distance > rule.sag;
    store<Isa>(select(touches, one, zero), out.touches + i, pack.count);
    if (!any_lane(touches)) continue;
    const Vectors<Isa> a = from[0] + (to[0] - from[0]) * part, b = from[1] + (to[1] - from[1]) * part;
    const Vectors<Isa> point = a * (one - low.at) + b * low.at;
    store<Isa>(one - low.at, out.weight[0] + i, pack.count);
    store<Isa>(low.at, out.weight[1] + i, pack.count);
    store<Isa>(zero, out.weight[2] + i, pack.count);
    store3<Isa>(low.surface.normal, out.normal, i, pack.count);
    store<Isa>(dot(low.surface.normal, point) - low.surface.distance, out.plane_offset + i, pack.count);
  }
}

// The distance of the triangle's plane is a lower bound of the triangle's. If the plane is closer but the lowest point
// is not inside, the triangle advances by a sixteenth of its path. The point may be inside later.
template <class Isa>
[[gnu::flatten]] void find_triangles(const ColliderBody& body, const ColliderFrameRecords& records,
                                     const ColliderElements& elements, std::size_t begin, std::size_t end,
                                     const ColliderElementTouches& out) {
  using T = Numbers<Isa>;
  const T zero(0.f), one(1.f);
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const ElementPack<Isa, 3> pack(elements, i, end);
    Vectors<Isa> from[3], to[3], x[3];
    pack.load(records.from, from), pack.load(records.to, to);
    const TouchRule<Isa> rule(load<Isa>(elements.radius + i, pack.count), elements.clearance_part);
    const T path = longest_path<Isa, 3>(from, to), least = max(path * T(1.f / most_advances), rule.r);
    store<Isa>(zero, out.touches + i, pack.count), store<Isa>(rule.r, out.start_distance + i, pack.count);
    const auto close = ball_distance<Isa>(body.shape, from, pack.count) <= rule.r + path;
    if (!any_lane(close)) continue;
    LowestInside<Isa> low = lowest_inside<Isa>(body.shape, from, rule.r, pack.count);
    store<Isa>(select(close && low.inside > zero, low.distance, rule.r), out.start_distance + i, pack.count);
    const T limit = rule.r + path;
    const auto may_touch = close && low.distance <= limit, overlaps = low.inside > zero;
    auto moves = may_touch;
    T advanced = zero, part = zero;
    for (int k = 0; k < 3; ++k) x[k] = from[k];
    for (int advance = 0; advance < most_advances; ++advance) {
      const T free = low.distance - rule.target;
      moves = moves && (low.inside <= zero || free > rule.close) && part < one;
      if (!any_lane(moves)) break;
      const T step = select(low.inside > zero, free, max(free, least));
      advanced = select(moves, advanced + step, advanced);
      part = select(moves, select(advanced < path, advanced / select(path > zero, path, one), one), part);
      for (int k = 0; k < 3; ++k) x[k] = from[k] + (to[k] - from[k]) * part;
      const LowestInside<Isa> next = lowest_inside<Isa>(body.shape, x, rule.r, pack.count);
      low.distance = select(moves, next.distance, low.distance);
      low.normal = selected<Isa>(moves, next.normal, low.normal);
      low.point = selected<Isa>(moves, next.point, low.point);
      for (int k = 0; k < 3; ++k) low.weight[k] = select(moves, next.weight[k], low.weight[k]);
      low.inside = select(moves, next.inside, low.inside);
    }
    auto touches = may_touch && low.inside > zero && (low.distance <= rule.r || (moves && part < one)) &&
                   (low.distance >= -limit || overlaps);
    T corners = zero;
    if (any_lane(touches)) {
      corners = surface_at<Isa>(body.shape, x[0], pack.count).distance;
      for (int k = 1; k < 3; ++k)
        corners = min(corners, surface_at<Isa>(body.shape, x[k], pack.count).distance);
    }
    touches = touches && corners - low.distance > rule.sag;
    store<Isa>(select(touches, one, zero), out.touches + i, pack.count);
    if (!any_lane(touches)) continue;
    for (int k = 0; k < 3; ++k) store<Isa>(low.weight[k], out.weight[k] + i, pack.count);
    store3<Isa>(low.normal, out.normal, i, pack.count);
    store<Isa>(dot(low.normal, low.point) - low.distance, out.plane_offset + i, pack.count);
  }
}

/// A point x_0 + u (x_1 - x_0) + v (x_2 - x_0) of an element, and a field's surface there.
template <class Isa>
struct FieldPoint {
  Numbers<Isa> u, v;
  Surface<Isa> surface;
};

/// An element in a field, with the inverse of its metric; for edges, v is not used.
template <class Isa>
struct FieldElement {
  Vectors<Isa> origin, along_u, along_v;
  Numbers<Isa> uu, uv, vv;

  SOUPLE_INLINE FieldElement(const Vectors<Isa> (&from)[3], const Vectors<Isa> (&to)[3],
                             const Numbers<Isa>& part) {
    using T = Numbers<Isa>;
    const T zero(0.f), one(1.f);
    Vectors<Isa> x[3];
    for (int k = 0; k < 3; ++k) x[k] = from[k] + (to[k] - from[k]) * part;
    origin = x[0], along_u = x[1] - x[0], along_v = x[2] - x[0];
    const T a = dot(along_u, along_u), b = dot(along_u, along_v), c = dot(along_v, along_v);
    const T determinant = a * c - b * b;
    const auto wide = determinant > a * c * T(1e-6f);
    const T scale = one / select(wide, determinant, one);
    uu = select(wide, c * scale, select(a > zero, one / select(a > zero, a, one), zero));
    uv = select(wide, -b * scale, zero);
    vv = select(wide, a * scale, zero);
  }
  SOUPLE_INLINE Vectors<Isa> at(const Numbers<Isa>& u, const Numbers<Isa>& v) const {
    return origin + along_u * u + along_v * v;
  }
};

/// Descends from a point to a lower one: steps of some length along the slope of d within the element, halved where they lead up.
/// The search of a lane ends where a step gains less than `tolerance`.
template <class Isa>
SOUPLE_INLINE inline void descend(const ColliderShape& shape, const FieldElement<Isa>& element,
                                  Numbers<Isa> length_of_step, const Numbers<Isa>& tolerance, int count,
                                  FieldPoint<Isa>& low) {
  using T = Numbers<Isa>;
  constexpr int steps = 4;
  const T zero(0.f), one(1.f), half(0.5f);
  low.surface = surface_at<Isa>(shape, element.at(low.u, low.v), count);
  auto searches = zero <= one;
  for (int step = 0; step < steps; ++step) {
    const T slope_u = dot(low.surface.normal, element.along_u),
            slope_v = dot(low.surface.normal, element.along_v);
    const T du = -(element.uu * slope_u + element.uv * slope_v),
            dv = -(element.uv * slope_u + element.vv * slope_v);
    const T slope = sqrt(max(zero - (du * slope_u + dv * slope_v), zero));
    searches = searches && slope * length_of_step > tolerance;
    if (!any_lane(searches)) return;
    const T scale = length_of_step / select(searches, slope, one);
    T u = max(low.u + du * scale, zero), v = max(low.v + dv * scale, zero);
    const T beyond = max((u + v - one) * half, zero);
    u = min(max(u - beyond, zero), one), v = min(max(v - beyond, zero), one - u);
    const Surface<Isa> at = surface_at<Isa>(shape, element.at(u, v), count);
    const auto better = searches && at.distance < low.surface.distance;
    low.u = select(better, u, low.u), low.v = select(better, v, low.v);
    low.surface = {select(better, at.distance, low.surface.distance),
                   selected<Isa>(better, at.normal, low.surface.normal)};
    length_of_step = select(better, length_of_step, length_of_step * half);
  }
}

/// Scatters values of lanes before the end.
template <class Isa>
SOUPLE_INLINE inline void scatter(const Numbers<Isa>& a, float* column, const Indices<Isa>& indices) {
  float lanes[Isa::lanes];
  a.store(lanes);
  for (int lane = 0; lane < indices.count; ++lane) column[indices.at[lane]] = lanes[lane];
}

// The lowest of points that divide the element's sides into parts.
template <class Isa>
[[gnu::flatten]] void sample_field_elements(const ColliderBody& body, const ColliderFrameRecords& records,
                                            const ColliderElements& elements,
                                            const ColliderFieldSearch& search, const std::uint32_t* list,
                                            std::size_t begin, std::size_t end) {
  using T = Numbers<Isa>;
  const T zero(0.f);
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const Indices<Isa> indices(i, end, list);
    const ElementPack<Isa, 3> pack(elements, indices);
    Vectors<Isa> from[3];
    pack.load(records.from, from);
    const FieldElement<Isa> element(from, from, zero);
    const T limit = gather<Isa>(search.limit, indices.at);
    T lowest = ball_distance<Isa>(body.shape, from, pack.count), u(1 / 3.f), v(1 / 3.f);
    const auto near = lowest <= limit;
    scatter<Isa>(lowest, search.lower, indices);
    if (!any_lane(near)) continue;
    const T bound = lowest;
    lowest = T(__builtin_inff());
    const auto parts = static_cast<float>(search.parts);
    for (int k = 0; k <= search.parts; ++k) {
      for (int j = 0; j + k <= search.parts; ++j) {
        const T at_u(static_cast<float>(k) / parts), at_v(static_cast<float>(j) / parts);
        const T d = surface_at<Isa>(body.shape, element.at(at_u, at_v), pack.count).distance;
        const auto better = d < lowest;
        lowest = select(better, d, lowest), u = select(better, at_u, u), v = select(better, at_v, v);
      }
    }
    scatter<Isa>(select(near, max(bound, lowest - T(search.gap)), bound), search.lower, indices);
    scatter<Isa>(u, search.u, indices), scatter<Isa>(v, search.v, indices);
  }
}

// The deepest point alone advances to the touch, where the search descends again.
template <class Isa>
[[gnu::flatten]] void find_in_field(const ColliderBody& body, const ColliderFrameRecords& records,
                                    const ColliderElements& elements, const ColliderFieldSearch& search,
                                    const std::uint32_t* list, std::size_t begin, std::size_t end,
                                    const ColliderElementTouches& out) {
  using T = Numbers<Isa>;
  const T zero(0.f), one(1.f), spacing(body.shape.grid.spacing);
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const Indices<Isa> indices(i, end, list);
    const ElementPack<Isa, 3> pack(elements, indices);
    const int count = pack.count;
    Vectors<Isa> from[3], to[3];
    pack.load(records.from, from), pack.load(records.to, to);
    const TouchRule<Isa> rule(gather<Isa>(elements.radius, indices.at), elements.clearance_part);
    const T path = longest_path<Isa, 3>(from, to), limit = rule.r + path;
    const T length_of_step = min(max(path + path, spacing * T(0.125f)), spacing * T(0.5f));
    FieldPoint<Isa> low{gather<Isa>(search.u, indices.at), gather<Isa>(search.v, indices.at), {}};
    descend<Isa>(body.shape, FieldElement<Isa>(from, to, zero), length_of_step, rule.tolerance, count, low);
    scatter<Isa>(low.surface.distance, out.start_distance, indices);
    const auto may_touch = low.surface.distance <= limit;
    auto moves = may_touch;
    T advanced = zero, part = zero, distance = low.surface.distance;
    for (int advance = 0; advance < most_advances; ++advance) {
      const T free = distance * T(0.75f) - rule.target;
      moves = moves && distance - rule.target > rule.close && free > rule.close && part < one;
      if (!any_lane(moves)) break;
      advanced = select(moves, advanced + free, advanced);
      part = select(moves, select(advanced < path, advanced / select(path > zero, path, one), one), part);
      const Vectors<Isa> point = FieldElement<Isa>(from, to, part).at(low.u, low.v);
      distance = select(moves, surface_at<Isa>(body.shape, point, count).distance, distance);
    }
    const FieldElement<Isa> at_touch(from, to, part);
    const auto moved = part > zero;
    if (any_lane(moved)) {
      FieldPoint<Isa> next = low;
      descend<Isa>(body.shape, at_touch, length_of_step, rule.tolerance, count, next);
      low.u = select(moved, next.u, low.u), low.v = select(moved, next.v, low.v);
      low.surface = {select(moved, next.surface.distance, low.surface.distance),
                     selected<Isa>(moved, next.surface.normal, low.surface.normal)};
    }
    scatter<Isa>(low.u, search.u, indices), scatter<Isa>(low.v, search.v, indices);
    auto touches = may_touch && (low.surface.distance <= rule.r || (moves && part < one));
    if (any_lane(touches)) {
      T corners = surface_at<Isa>(body.shape, at_touch.at(zero, zero), count).distance;
      corners = min(corners, surface_at<Isa>(body.shape, at_touch.at(one, zero), count).distance);
      corners = min(corners, surface_at<Isa>(body.shape, at_touch.at(zero, one), count).distance);
      touches = touches && corners - low.surface.distance > rule.sag;
    }
    scatter<Isa>(select(touches, one, zero), out.touches, indices);
    if (!any_lane(touches)) continue;
    scatter<Isa>(one - low.u - low.v, out.weight[0], indices);
    scatter<Isa>(low.u, out.weight[1], indices), scatter<Isa>(low.v, out.weight[2], indices);
    for (int axis = 0; axis < 3; ++axis) scatter<Isa>(low.surface.normal[axis], out.normal[axis], indices);
    scatter<Isa>(dot(low.surface.normal, at_touch.at(low.u, low.v)) - low.surface.distance, out.plane_offset,
                 indices);
  }
}

template <class Isa>
const ColliderElementKernels& collider_element_kernels() {
  static constexpr ColliderElementKernels kernels{place<Isa>,          near_edges<Isa>,
                                                  near_triangles<Isa>, find_edges<Isa>,
                                                  find_triangles<Isa>, sample_field_elements<Isa>,
                                                  find_in_field<Isa>};
  return kernels;
}

}  // namespace souple::kernels
