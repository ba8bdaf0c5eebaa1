#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/fluid/emitter.h"
#include "souple/geometry/lattice.h"
#include "souple/objects/object_options.h"
#include "souple/world/world.h"

namespace souple::python {

void bind_objects(py::module_& m) {
  Struct<GivenMass>(m, "GivenMass")
      .field<&GivenMass::mass>("mass")
      .field<&GivenMass::center>("center")
      .field<&GivenMass::inertia>("inertia");
  Struct<RigidPart>(m, "RigidPart")
      .field<&RigidPart::shape>("shape")
      .field<&RigidPart::pose>("pose")
      .field<&RigidPart::density>("density");
  Struct<ObjectOptions>(m, "ObjectOptions")
      .field<&ObjectOptions::name>("name")
      .field<&ObjectOptions::transform>("transform")
      .field<&ObjectOptions::velocity>("velocity")
      .field<&ObjectOptions::angular_velocity>("angular_velocity")
      .field<&ObjectOptions::stiffness_map>("stiffness_map")
      .field<&ObjectOptions::thickness_map>("thickness_map")
      .field<&ObjectOptions::self_collision>("self_collision")
      .field<&ObjectOptions::layer>("layer")
      .field<&ObjectOptions::max_particles>("max_particles")
      .field<&ObjectOptions::given_mass>("given_mass")
      .field<&ObjectOptions::collision_groups>("collision_groups")
      .field<&ObjectOptions::collision_mask>("collision_mask");
  Struct<ColliderOptions>(m, "ColliderOptions")
      .field<&ColliderOptions::friction>("friction")
      .field<&ColliderOptions::restitution>("restitution")
      .field<&ColliderOptions::kinetic_friction>("kinetic_friction")
      .field<&ColliderOptions::name>("name")
      .field<&ColliderOptions::motion>("motion")
      .field<&ColliderOptions::collision_groups>("collision_groups")
      .field<&ColliderOptions::collision_mask>("collision_mask")
      .field<&ColliderOptions::sensor>("sensor");
  Struct<LatticeOptions>(m, "LatticeOptions")
      .field<&LatticeOptions::cell_size>("cell_size")
      .field<&LatticeOptions::cells>("cells");
  Struct<Emitter>(m, "Emitter")
      .field<&Emitter::position>("position")
      .field<&Emitter::direction>("direction")
      .field<&Emitter::radius>("radius")
      .field<&Emitter::speed>("speed")
      .field<&Emitter::start>("start")
      .field<&Emitter::end>("end")
      .field<&Emitter::motion>("motion");
  Struct<Drain>(m, "Drain")
      .field<&Drain::shape>("shape")
      .field<&Drain::pose>("pose")
      .field<&Drain::rate>("rate")
      .field<&Drain::start>("start")
      .field<&Drain::end>("end");
  Struct<VertexRef>(m, "VertexRef").field<&VertexRef::object>("object").field<&VertexRef::vertex>("vertex");
  Result<Carrier>(m, "Carrier")
      .field<&Carrier::particle>("particle")
      .field<&Carrier::weight>("weight")
      .field<&Carrier::inverse_mass>("inverse_mass")
      .field<&Carrier::position>("position");
  Result<RigidBodyState>(m, "RigidBodyState")
      .field<&RigidBodyState::pose>("pose")
      .field<&RigidBodyState::velocity>("velocity")
      .field<&RigidBodyState::angular_velocity>("angular_velocity")
      .field<&RigidBodyState::mass>("mass")
      .field<&RigidBodyState::inertia>("inertia")
      .field<&RigidBodyState::kinematic>("kinematic");
  Result<ForcePoint>(m, "ForcePoint")
      .field<&ForcePoint::object>("object")
      .field<&ForcePoint::vertex>("vertex")
      .field<&ForcePoint::position>("position")
      .field<&ForcePoint::velocity>("velocity")
      .field<&ForcePoint::mass>("mass")
      .field<&ForcePoint::time>("time");
}

}  // namespace souple::python
