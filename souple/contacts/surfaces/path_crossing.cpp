#include "souple/contacts/surfaces/path_crossing.h"

namespace souple {

PathCrossing find_path_crossing(const CrossingTest& test, const NearPair& pair, float thickness,
                                const ParticleView& particles) {
  const std::uint32_t v = pair.particle[0], a = pair.particle[1], b = pair.particle[2], c = pair.particle[3];
  float inverse_mass = 0;
  for (const std::uint32_t i : pair.particle) inverse_mass += particles.inverse_mass(i);
  if (!(inverse_mass > 0)) return {};
  // Not from differences of positions: all triangles of a rigid mesh must see the same path, to the bit.
  const Vec3f moved = particles.moved(v);
  const Vec3f path = moved - (particles.moved(a) + particles.moved(b) + particles.moved(c)) * (1.0f / 3);
  const auto start = [&](std::uint32_t i) {
    return particles.difference(i, v) - (particles.moved(i) - moved);
  };
  const Corners<float> corners{start(a), start(b), start(c)};
  const Vec3f twice_area = cross(corners.b - corners.a, corners.c - corners.a);
  const float size = length(twice_area);
  if (!(size > 0)) return {};
  Crossing<float> crossing = test.in_float({{}, path}, corners);
  const float before = -dot(twice_area, corners.a), after = dot(twice_area, path - corners.a);
  if (crossing.side == 0 && before * after > 0) {
    const Vec3f down = twice_area * ((before > 0 ? -thickness : thickness) / size);
    crossing = test.in_float({{}, path + down}, corners);
  }
  if (crossing.side == 0) return {};
  return {true, crossing.weight, twice_area * (crossing.side / size)};
}

}  // namespace souple
