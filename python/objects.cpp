#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/fluid/emitter.h"
#include "souple/geometry/lattice.h"
#include "souple/objects/object_options.h"
#include "souple/world/world.h"

namespace souple::python {

void bind_objects(py::module_& m) {
  Struct<GivenMass>(m, "GivenMass").fields<&GivenMass::mass, &GivenMass::center, &GivenMass::inertia>();
  Struct<RigidPart>(m, "RigidPart").fields<&RigidPart::shape, &RigidPart::pose, &RigidPart::density>();
  Struct<ObjectOptions>(m, "ObjectOptions")
      .fields<&ObjectOptions::name, &ObjectOptions::transform, &ObjectOptions::velocity,
              &ObjectOptions::angular_velocity, &ObjectOptions::stiffness_map, &ObjectOptions::thickness_map,
              &ObjectOptions::self_collision, &ObjectOptions::layer, &ObjectOptions::max_particles,
              &ObjectOptions::given_mass, &ObjectOptions::collision_groups, &ObjectOptions::collision_mask>();
  Struct<ColliderOptions>(m, "ColliderOptions")
      .fields<&ColliderOptions::friction, &ColliderOptions::restitution, &ColliderOptions::kinetic_friction,
              &ColliderOptions::name, &ColliderOptions::motion, &ColliderOptions::collision_groups,
              &ColliderOptions::collision_mask, &ColliderOptions::sensor>();
  Struct<LatticeOptions>(m, "LatticeOptions").fields<&LatticeOptions::cell_size, &LatticeOptions::cells>();
  Struct<Emitter>(m, "Emitter")
      .fields<&Emitter::position, &Emitter::direction, &Emitter::radius, &Emitter::speed, &Emitter::start,
              &Emitter::end, &Emitter::motion>();
  Struct<Drain>(m, "Drain").fields<&Drain::shape, &Drain::pose, &Drain::rate, &Drain::start, &Drain::end>();
  Struct<VertexRef>(m, "VertexRef").fields<&VertexRef::object, &VertexRef::vertex>();
  Result<Carrier>(m, "Carrier")
      .fields<&Carrier::particle, &Carrier::weight, &Carrier::inverse_mass, &Carrier::position>();
  Result<RigidBodyState>(m, "RigidBodyState")
      .fields<&RigidBodyState::pose, &RigidBodyState::velocity, &RigidBodyState::angular_velocity,
              &RigidBodyState::mass, &RigidBodyState::inertia, &RigidBodyState::kinematic>();
  Result<ForcePoint>(m, "ForcePoint")
      .fields<&ForcePoint::object, &ForcePoint::vertex, &ForcePoint::position, &ForcePoint::velocity,
              &ForcePoint::mass, &ForcePoint::time>();
}

}  // namespace souple::python
