#pragma once

#include "python/casters.h"

// One function for each part of the module.

namespace souple::python {

using py::literals::operator""_a;

class BoundWorld;
using WorldClass = py::class_<BoundWorld, std::shared_ptr<BoundWorld>>;

void bind_enums(py::module_& m);
void bind_motor_target(py::handle motor);
void bind_handles(py::module_& m);
void bind_settings(py::module_& m);
void bind_materials(py::module_& m);
void bind_shapes(py::module_& m);
void bind_meshes(py::module_& m);
void bind_objects(py::module_& m);
void bind_joints(py::module_& m);
void bind_ties(py::module_& m);
void bind_queries(py::module_& m);
void bind_reports(py::module_& m);
void bind_constraints(py::module_& m);

// Functions of World.
void bind_world_loop(WorldClass& world);
void bind_world_objects(WorldClass& world);
void bind_world_state(WorldClass& world);
void bind_world_arrays(WorldClass& world);
void bind_world_constraints(WorldClass& world);
void bind_world_joints(WorldClass& world);
void bind_world_colliders(WorldClass& world);
void bind_world_queries(WorldClass& world);

void bind_scene(py::module_& m);
void bind_recorder(py::module_& m);
void bind_surface(py::module_& m);
void bind_render(py::module_& m);

}  // namespace souple::python
