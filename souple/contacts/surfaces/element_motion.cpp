#include "souple/contacts/surfaces/element_motion.h"

#include "souple/collision/continuous.h"
#include "souple/collision/nearest.h"

namespace souple {

Motion motion_of(const NearPair& pair, const ParticleView& particles) {
  const auto& i = pair.particle;
  Motion motion;
  const Vec3f moved = particles.moved(i[0]);
  for (std::size_t k = 1; k < 4; ++k) {
    motion.p[k] = particles.difference(i[k], i[0]);
    motion.x[k] = motion.p[k] - (particles.moved(i[k]) - moved);
  }
  return motion;
}

float safe_time(const Motion& motion, bool edges) {
  Moving4 moving;
  for (std::size_t k = 0; k < 4; ++k) moving.x[k] = Vec3d(motion.x[k]), moving.p[k] = Vec3d(motion.p[k]);
  const double time = edges ? edge_edge_time(moving, 0) : vertex_triangle_time(moving, 0);
  return static_cast<float>(time);
}

bool has_normal(const NearPair& pair, const Motion& motion, float toi, bool edges,
                const ParticleView& particles) {
  Vec3f at[4];
  for (std::size_t k = 1; k < 4; ++k) at[k] = motion.x[k] + (motion.p[k] - motion.x[k]) * toi;
  float c[4] = {1, 0, 0, 0};
  if (edges) {
    float s = 0, t = 0;
    nearest_on_edges(at[0], at[1], at[2], at[3], s, t);
    c[0] = 1 - s, c[1] = s, c[2] = t - 1, c[3] = -t;
  } else {
    float weight[3];
    nearest_on_triangle(at[0], at[1], at[2], at[3], weight);
    for (std::size_t k = 0; k < 3; ++k) c[k + 1] = -weight[k];
  }
  float inverse_mass = 0;
  for (std::size_t k = 0; k < 4; ++k) inverse_mass += particles.inverse_mass(pair.particle[k]) * c[k] * c[k];
  return inverse_mass > 0 && length(at[1] * c[1] + at[2] * c[2] + at[3] * c[3]) > 0;
}

}  // namespace souple
