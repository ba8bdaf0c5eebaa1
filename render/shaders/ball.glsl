// The ball (or, with ELLIPSOIDS, the ellipsoid) of a splat, and its intersection with the ray through a
// pixel.
flat in vec3 ball_center;  // in view space
#ifdef ELLIPSOIDS
flat in mat3 to_unit_ball;  // from view space, about the center
#else
flat in float ball_radius;
#endif
in vec2 plane_point;

// Points on the ray are origin + t direction: inside while |t - foot| < half_length.
struct Chord {
  vec3 direction;
  float foot;
  vec3 off;  // from the center to the foot; for an ellipsoid, in its unit ball
  float half_squared;  // negative: the ray misses
};

Chord chord_of_ball() {
  bool parallel = frame.projection[3][3] == 1.0;
  vec3 origin = parallel ? vec3(plane_point, 0.0) : vec3(0.0);
  Chord chord;
  chord.direction = parallel ? vec3(0.0, 0.0, -1.0) : normalize(vec3(plane_point, -1.0));
  // Both hits lie at equal distances from the foot of the perpendicular. The usual b * b - c would lose
  // precision for small and distant balls.
  vec3 to_center = ball_center - origin;
#ifdef ELLIPSOIDS
  vec3 d = to_unit_ball * chord.direction, c = to_unit_ball * to_center;
  float stretch = dot(d, d);
  chord.foot = dot(c, d) / stretch;
  chord.off = chord.foot * d - c;
  chord.half_squared = (1.0 - dot(chord.off, chord.off)) / stretch;
#else
  chord.foot = dot(to_center, chord.direction);
  chord.off = chord.foot * chord.direction - to_center;
  chord.half_squared = ball_radius * ball_radius - dot(chord.off, chord.off);
#endif
  return chord;
}

// z and w in clip space of a point at z in view space.
vec2 clip_depth(float z) {
  return vec2(frame.projection[2][2] * z + frame.projection[3][2], frame.projection[2][3] * z + frame.projection[3][3]);
}
