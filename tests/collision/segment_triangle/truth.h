#pragma once

#include "souple/collision/segment_triangle/segment_triangle.h"
#include "tests/collision/exact.h"

#include <algorithm>
#include <cmath>
#include <limits>

// Reference answers for segment-triangle tests, by exact arithmetic where needed.

namespace souple::test {

enum class Answer { crosses, misses, ambiguous };

/// An answer is unambiguous if it does not change when each volume changes by `Slack::volume` and the height by
/// `Slack::height`. That is the effect of `roundings` roundings of the products of three lengths in the test.
struct Truth {
  Answer answer = Answer::ambiguous;
  double t = 0;
  Vec3d weight{};
  double side = 0;
  double t_error = 0, weight_error = 0;  ///< errors of t and the weights from the slack
  bool was_doubtful = false;             ///< decided by GMP
};

/// Numbers of any type, as in segment_triangle.h.
template <class S>
struct Volumes {
  Vec3<S> edge;  ///< U, V, W
  S sum, height;

  Volumes(const Vec3<S>& o, const Vec3<S>& d, const Vec3<S>& first, const Vec3<S>& second,
          const Vec3<S>& third) {
    const Vec3<S> a = first - o, b = second - o, c = third - o;
    edge = {dot(d, cross(b, c)), dot(d, cross(c, a)), dot(d, cross(a, b))};
    sum = edge.x + edge.y + edge.z;
    height = dot(a, cross(b, c));
  }
};

struct Slack {
  long double volume, height;                ///< changes by moving the corners
  long double filter_volume, filter_height;  ///< errors of the filter's rounding
};

/// -1, 1, or 0 within the slack; sets `doubtful` where the filter cannot decide.
inline int sign_beyond(long double value, long double slack, long double rounding, bool& doubtful) {
  if (std::fabs(std::fabs(value) - slack) <= rounding) doubtful = true;
  return std::fabs(value) <= slack ? 0 : (value > 0 ? 1 : -1);
}
inline int sign_beyond(const Exact& value, long double slack, long double, bool&) {
  return abs(value) <= Exact(static_cast<double>(slack)) ? 0 : sgn(value);
}

template <class S>
Answer answer_of(const Volumes<S>& v, double max_t, const Slack& slack, bool& doubtful) {
  const auto volume_sign = [&](const S& value, double factor) {
    return sign_beyond(value, factor * slack.volume, factor * slack.filter_volume, doubtful);
  };
  const int edges[3] = {volume_sign(v.edge.x, 1), volume_sign(v.edge.y, 1), volume_sign(v.edge.z, 1)};
  const int least = std::min({edges[0], edges[1], edges[2]}), most = std::max({edges[0], edges[1], edges[2]});
  if (least < 0 && most > 0) return Answer::misses;

  const int side = volume_sign(v.sum, 3);
  const int ahead = sign_beyond(v.height, slack.height, slack.filter_height, doubtful);
  if (side != 0 && ahead == -side) return Answer::misses;
  bool within = true;
  if (std::isfinite(max_t)) {
    // Beyond the end where |height| > max_t |sum|, for any signs.
    const S left = S(abs(v.height)) - S(max_t) * S(abs(v.sum));
    const int beyond = sign_beyond(left, slack.height + 3 * max_t * slack.volume,
                                   slack.filter_height + 3 * max_t * slack.filter_volume, doubtful);
    if (beyond > 0) return Answer::misses;
    within = beyond < 0;
  }
  return least == most && least != 0 && ahead == side && within ? Answer::crosses : Answer::ambiguous;
}

template <class T>
long double largest(const Vec3<T>& v) {
  return static_cast<long double>(std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}));
}

/// The lengths that a test multiplies: d S L for tests that use edges, d S S for tests that use corners
/// alone. d is the direction's length, S the distance to the farthest corner and L the longest edge. Tests that use the
/// plane lose L^2 / |n| more. Their normal is not quite perpendicular to the edges of a sliver. At its far end the
/// plane is off by many times the sliver's width.
struct Lengths {
  bool corners_alone = false, by_plane = false;
};

template <class T>
Slack slack_of(const Segment<T>& segment, const Corners<T>& corners, const Lengths& lengths,
               double roundings) {
  const Vec3<T>&o = segment.origin, a = corners.a, b = corners.b, c = corners.c;
  const long double S = std::max({largest(a - o), largest(b - o), largest(c - o)});
  const long double L = std::max({largest(b - a), largest(c - b), largest(a - c)});
  const long double d = largest(segment.direction);
  const long double edge = lengths.corners_alone ? S : L;
  const Vec3<long double> e(Vec3<long double>(b) - Vec3<long double>(a)),
      f(Vec3<long double>(c) - Vec3<long double>(a));
  const long double n =
      std::max(largest(cross(e, f)), 1e-12L * L * L + std::numeric_limits<long double>::min());
  const long double thin = lengths.by_plane ? std::max(1.0L, L * L / n) : 1;
  const long double unit = static_cast<long double>(std::numeric_limits<T>::epsilon()) / 2;
  const long double filter = std::numeric_limits<long double>::epsilon() * 64;
  // The error of a product that underflows.
  const long double least = 8 * static_cast<long double>(std::numeric_limits<T>::denorm_min());
  return {roundings * thin * (unit * d * S * edge + least * (1 + d)),
          roundings * thin * (unit * S * L * L + least * (1 + S)), filter * d * S * S, filter * S * S * S};
}

/// `always_exact`: decides by GMP, doubtful or not.
template <class T>
Truth truth_of(const Segment<T>& segment, const Corners<T>& corners, const Slack& slack,
               bool always_exact = false) {
  using Filter = long double;
  const auto max_t = static_cast<double>(segment.max_t);
  const Volumes<Filter> v(Vec3<Filter>(segment.origin), Vec3<Filter>(segment.direction),
                          Vec3<Filter>(corners.a), Vec3<Filter>(corners.b), Vec3<Filter>(corners.c));
  Truth truth;
  truth.answer = answer_of(v, max_t, slack, truth.was_doubtful);
  if (truth.was_doubtful || always_exact) {
    const Volumes<Exact> e(exact(segment.origin), exact(segment.direction), exact(corners.a),
                           exact(corners.b), exact(corners.c));
    bool none = false;
    truth.answer = answer_of(e, max_t, slack, none);
  }
  if (truth.answer != Answer::crosses) return truth;
  const Filter inverse = 1 / v.sum, error = std::fabs(inverse);
  truth.t = static_cast<double>(v.height * inverse);
  truth.weight = {static_cast<double>(v.edge.x * inverse), static_cast<double>(v.edge.y * inverse),
                  static_cast<double>(v.edge.z * inverse)};
  truth.side = v.sum < 0 ? 1 : -1;
  truth.t_error =
      static_cast<double>((slack.height + 3 * std::fabs(v.height * inverse) * slack.volume) * error);
  truth.weight_error = static_cast<double>(4 * slack.volume * error);
  return truth;
}

}  // namespace souple::test
