#include "souple/queries/object_sums.h"

#include "souple/contacts/contact_law.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/object.h"

#include <algorithm>

namespace souple {

double kinetic_energy(const QueryView& view, const Object& object) {
  double sum = 0;
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    sum += 0.5 * static_cast<double>(view.particles.mass[i]) *
           length_squared(Vec3d(view.particles.velocity[i].xyz()));
  if (!object.traits().rolls) return sum;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const std::vector<float>& map = object.per_particle.thickness;
    const auto r =
        static_cast<double>(contact_radius(object.material) * (map.empty() ? 1.0f : map[i - object.begin]));
    const double inertia =
        static_cast<double>(view.particles.mass[i]) * r * r / static_cast<double>(inverse_inertia_factor);
    sum += 0.5 * inertia * length_squared(Vec3d(view.particles.spin[i].xyz()));
  }
  return sum;
}

double potential_energy(const QueryView& view, const Object& object, const Vec3f& gravity) {
  double sum = 0;
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    sum -=
        static_cast<double>(view.particles.mass[i]) * dot(Vec3d(gravity), view.particles.exact_position(i));
  return sum;
}

Vec3d momentum(const QueryView& view, const Object& object) {
  Vec3d sum;
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    sum += Vec3d(view.particles.velocity[i].xyz()) * static_cast<double>(view.particles.mass[i]);
  return sum;
}

Vec3d center_of_mass(const QueryView& view, const Object& object) {
  Vec3d sum;
  double mass = 0;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const auto m = static_cast<double>(view.particles.mass[i]);
    sum += view.particles.exact_position(i) * m;
    mass += m;
  }
  if (mass > 0) return sum / mass;
  for (std::uint32_t i = object.begin; i < object.end; ++i) sum += view.particles.exact_position(i);
  return sum / std::max(1u, object.particle_count());
}

}  // namespace souple
