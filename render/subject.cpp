#include "render/subject.h"

#include "souple/objects/kind_traits.h"

#include <algorithm>

namespace souple::render {

void show_foam(Subject& subject, std::span<const Vec3f> foam) {
  const auto fluid = std::find_if(subject.bodies.begin(), subject.bodies.end(),
                                  [](const Body& body) { return traits_of(body.kind).flows; });
  if (fluid != subject.bodies.end()) fluid->foam = foam;
}

Subject subject_of(const World& world, std::uint64_t world_number) {
  Subject subject;
  for (const ObjectId id : world.objects()) {
    Body body;
    body.id = id.value;
    body.name = world.name(id);
    body.kind = world.kind(id);
    body.positions = world.positions(id);
    body.normals = world.normals(id);
    body.velocities = world.velocities(id);
    body.triangles = world.triangles(id);
    body.rest = world.mesh(id).positions;
    body.mesh = &world.mesh(id);
    body.radius = world.particle_radius(id);
    if (const auto* fluid = std::get_if<FluidMaterial>(&world.material(id))) body.density = fluid->density;
    subject.bodies.push_back(body);
  }
  show_foam(subject, world.foam().positions);
  for (const ColliderId id : world.colliders()) {
    const ColliderOptions& options = world.collider_options(id);
    ColliderBody collider{id.value, options.name, &world.shape(id), world.collider_pose(id)};
    if (!options.motion.is_static()) collider.motion = &options.motion;
    collider.time = world.time();
    subject.colliders.push_back(collider);
  }
  subject.frame = world.version();
  subject.topology = world_number;
  subject.world = &world;
  return subject;
}

}  // namespace souple::render
