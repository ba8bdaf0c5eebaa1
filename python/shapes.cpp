#include "souple/collision/shapes.h"

#include "python/bind.h"
#include "python/bound_world.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/collision/collider_motion.h"
#include "souple/objects/obstacle_motion.h"

namespace souple::python {

namespace {

void bind_field(py::module_& m) {
  using F = SignedDistanceField;
  py::class_<F>(m, "SignedDistanceField", doc("SignedDistanceField"))
      .def(py::init([](TriangleMesh mesh, double spacing) {  // a copy: another thread may change the caller's
             const ReleasedGil released;
             return std::make_unique<F>(mesh, spacing);
           }),
           "mesh"_a, "spacing"_a, doc("SignedDistanceField.__init__"))
      .def_static("spacing_of", &F::spacing_of, "mesh"_a, "resolution"_a,
                  doc("SignedDistanceField.spacing_of"))
      .def("spacing", on_self(&F::spacing), "Spacing of the grid [m].")
      .def("lo", on_self(&F::lo), doc("SignedDistanceField.lo"))
      .def("hi", on_self(&F::hi), doc("SignedDistanceField.lo"))
      .def("positions", on_self(&F::positions), doc("SignedDistanceField.positions"))
      .def("triangles", on_self(&F::triangles), doc("SignedDistanceField.positions"))
      .def("bytes", on_self(&F::bytes), doc("SignedDistanceField.bytes"));
}

void bind_motion(py::module_& m) {
  Struct<PoseKey>(m, "PoseKey").fields<&PoseKey::time, &PoseKey::translation, &PoseKey::rotation>();
  using M = ColliderMotion;
  py::class_<M>(m, "ColliderMotion", doc("ColliderMotion"))
      .def(py::init(), doc("ColliderMotion.__init__"))
      .def_static("fixed", &M::fixed, "pose"_a, "A pose that stays.")
      .def_static(
          "keyframes",
          [](std::vector<PoseKey> keys, bool loop) { return M::keyframes(std::move(keys), loop); }, "keys"_a,
          "loop"_a = false, doc("ColliderMotion.keyframes"))
      .def_static("callback", &motion_of, "callback"_a, doc("ColliderMotion.callback"))
      // Evaluates a copy: its function may replace the motion.
      .def(
          "at", [](const M& motion, double time) { return M(motion).at(time); }, "time"_a,
          doc("ColliderMotion.at"))
      .def(
          "jumps", [](const M& motion, double from, double to) { return M(motion).jumps(from, to); },
          "from_"_a, "to"_a, doc("ColliderMotion.jumps"))
      .def("is_static", on_self(&M::is_static), doc("ColliderMotion.is_static"))
      .def("keys", on_self(&M::keys), doc("ColliderMotion.keys"))
      .def("loops", on_self(&M::loops), "Whether the keys repeat.")
      .def("__copy__", [](const M& motion) { return motion; })
      .def("__deepcopy__", [](const M& motion, const py::object&) { return motion; });
  Struct<MeshSequence>(m, "MeshSequence")
      .fields<&MeshSequence::frames, &MeshSequence::frame_rate, &MeshSequence::times,
              &MeshSequence::start_time, &MeshSequence::loop>();
  Struct<ObstacleMotion>(m, "ObstacleMotion").fields<&ObstacleMotion::pose, &ObstacleMotion::sequence>();
}

}  // namespace

void bind_shapes(py::module_& m) {
  Struct<Plane>(m, "Plane").fields<&Plane::normal, &Plane::offset>();
  Struct<Sphere>(m, "Sphere").fields<&Sphere::center, &Sphere::radius>();
  Struct<Box>(m, "Box").fields<&Box::center, &Box::half_extents>();
  Struct<Capsule>(m, "Capsule").fields<&Capsule::center, &Capsule::radius, &Capsule::half_height>();
  Struct<Cylinder>(m, "Cylinder").fields<&Cylinder::center, &Cylinder::radius, &Cylinder::half_height>();
  bind_field(m);
  bind_motion(m);
  m.def("is_convex", &is_convex, "shape"_a, doc("is_convex"));
  m.def("shape_name", &shape_name, "shape"_a, doc("shape_name"));
}

}  // namespace souple::python
