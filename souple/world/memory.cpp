#include "souple/world/memory.h"

#include "souple/fluid/stage/fluid_foam.h"
#include "souple/fluid/stage/fluids.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/queries/caches.h"
#include "souple/solver/facets.h"
#include "souple/stages/sleeping.h"
#include "souple/stages/ties.h"
#include "souple/stages/user_constraint.h"
#include "souple/state/bytes.h"
#include "souple/world/call_scope.h"
#include "souple/world/contact_state.h"
#include "souple/world/impl.h"
#include "souple/world/prepare.h"
#include "souple/world/step_scratch.h"
#include "souple/world/world.h"

namespace souple {
namespace {

template <class Item>
std::size_t nested_bytes(const std::vector<std::vector<Item>>& lists) {
  std::size_t sum = bytes_of(lists);
  for (const std::vector<Item>& list : lists) sum += bytes_of(list);
  return sum;
}

std::size_t bytes_of_mesh(const TriangleMesh& mesh) {
  std::size_t sum =
      bytes_of(mesh.positions, mesh.triangles, mesh.uvs, mesh.colors) + nested_bytes(mesh.faces) +
      nested_bytes(mesh.face_uvs) +
      bytes_of(mesh.appearance.face_materials, mesh.appearance.smoothing, mesh.appearance.normals) +
      nested_bytes(mesh.appearance.face_normals);
  for (const auto& [name, indices] : mesh.groups) sum += name.capacity() + bytes_of(indices);
  return sum;
}

std::size_t bytes_of_motion(const ObstacleMotion& motion) {
  return nested_bytes(motion.sequence.frames) + bytes_of(motion.sequence.times);
}

/// Maps between vertices and particles, and the triangles over particles.
std::size_t bytes_of_maps(const Object& object) {
  std::size_t sum = bytes_of(object.particle_of, object.vertex_of, object.surface, object.triangle_source,
                             object.per_particle.stiffness, object.per_particle.thickness,
                             object.per_particle.outside, object.pins);
  if (object.embedding)
    sum += bytes_of(object.embedding->vertices, object.embedding->weights, object.embedding->tets);
  return sum;
}

void add_constraints(const WorldState& world, MemoryReport& report) {
  const auto add = [&](Projector& projector) {
    const MemoryFacet* const memory = projector.facets().memory;
    const std::size_t bytes = memory != nullptr ? memory->bytes() : 0;
    for (MemoryReport::Part& part : report.simulation)
      if (part.name == projector.kind()) {
        part.bytes += bytes;
        return;
      }
    report.simulation.push_back({std::string(projector.kind()), bytes});
  };
  for (const auto& projector : world.constraints.object_projectors) add(*projector);
  for (const UserConstraint& user_constraint : world.constraints.users) add(*user_constraint.projector);
  if (!world.constraints.ties->empty()) add(*world.constraints.ties);
}

void add_objects(const WorldState& world, MemoryReport& report) {
  std::size_t meshes = 0, rest = 0, maps = 0, mirrors = 0, motions = 0;
  for (const auto& object : world.objects) {
    meshes += bytes_of_mesh(object->mesh) + bytes_of(object->tets.positions, object->tets.tets);
    rest += bytes_of(object->rest);
    motions += bytes_of_motion(object->motion);
    maps += sizeof(Object) + bytes_of_maps(*object);
  }
  for (const auto& [id, mirror] : world.caches->mirrors)
    mirrors += sizeof mirror + mirror.triangles_of.bytes() +
               bytes_of(mirror.position_records, mirror.area_normals) +
               (mirror.positions.capacity() + mirror.velocities.capacity() + mirror.normals.capacity() +
                mirror.angular_velocities.capacity()) *
                   sizeof(Vec3f);
  report.objects.push_back({"meshes", meshes});
  report.objects.push_back({"rest positions", rest});
  report.objects.push_back({"motions of obstacles", motions});
  report.objects.push_back({"maps from vertices to particles", maps});
  report.objects.push_back({"mirrors of positions and normals", mirrors});
  const std::size_t queries = world.caches->query_index.bytes();
  if (queries > 0) report.objects.push_back({"box trees of queries", queries});
  std::size_t fields = 0;
  for (const ColliderRecord& record : world.colliders)
    if (const auto* field = std::get_if<SignedDistanceField>(&record.shape)) fields += field->bytes();
  if (fields > 0) report.objects.push_back({"signed distance fields", fields});
}

}  // namespace

MemoryReport World::memory() {
  WorldState& world = state();
  const CallScope call(*world.calls, "memory", From::stages);
  if (!world.current.running) bring_up_to_date(world);
  const Particles& p = world.particles;
  MemoryReport report;
  report.particles = p.size();
  report.simulation.push_back(
      {"particles", bytes_of(p.position, p.offset, p.start, p.velocity, p.mass, p.radius, p.contact_margin,
                             p.spin, p.turn, world.object_of)});
  report.simulation.push_back(
      {"last valid state", bytes_of(world.current.last_valid.position, world.current.last_valid.offset,
                                    world.current.last_valid.velocity, world.current.last_valid.spin)});
  report.simulation.push_back(
      {"forces and predictions", bytes_of(world.scratch->motion.predicted, world.scratch->motion.air_thirds,
                                          world.scratch->rigid_sums, world.scratch->links) +
                                     world.scratch->angular_momentum.bytes()});
  add_constraints(world, report);
  report.simulation.push_back(
      {"contacts", world.contact->contacts.bytes() + world.scratch->sleep->proximity.bytes()});
  if (const std::size_t foam = world.fluids->foam().bytes(); foam > 0)
    report.simulation.push_back({"foam", foam});
  add_objects(world, report);
  return report;
}

}  // namespace souple
