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
           py::arg("mesh"), py::arg("spacing"), doc("SignedDistanceField.__init__"))
      .def_static("spacing_of", &F::spacing_of, py::arg("mesh"), py::arg("resolution"),
                  doc("SignedDistanceField.spacing_of"))
      .def("spacing", on_self(&F::spacing), "Spacing of the grid [m].")
      .def("lo", on_self(&F::lo), doc("SignedDistanceField.lo"))
      .def("hi", on_self(&F::hi), doc("SignedDistanceField.lo"))
      .def("positions", on_self(&F::positions), doc("SignedDistanceField.positions"))
      .def("triangles", on_self(&F::triangles), doc("SignedDistanceField.positions"))
      .def("bytes", on_self(&F::bytes), doc("SignedDistanceField.bytes"));
}

void bind_motion(py::module_& m) {
  Struct<PoseKey>(m, "PoseKey")
      .field<&PoseKey::time>("time")
      .field<&PoseKey::translation>("translation")
      .field<&PoseKey::rotation>("rotation");
  using M = ColliderMotion;
  py::class_<M>(m, "ColliderMotion", doc("ColliderMotion"))
      .def(py::init(), doc("ColliderMotion.__init__"))
      .def_static("fixed", &M::fixed, py::arg("pose"), "A pose that stays.")
      .def_static(
          "keyframes",
          [](std::vector<PoseKey> keys, bool loop) { return M::keyframes(std::move(keys), loop); },
          py::arg("keys"), py::arg("loop") = false, doc("ColliderMotion.keyframes"))
      .def_static("callback", &motion_of, py::arg("callback"), doc("ColliderMotion.callback"))
      // Evaluates a copy: its function may replace the motion.
      .def(
          "at", [](const M& motion, double time) { return M(motion).at(time); }, py::arg("time"),
          doc("ColliderMotion.at"))
      .def(
          "jumps", [](const M& motion, double from, double to) { return M(motion).jumps(from, to); },
          py::arg("from_"), py::arg("to"), doc("ColliderMotion.jumps"))
      .def("is_static", on_self(&M::is_static), doc("ColliderMotion.is_static"))
      .def("keys", on_self(&M::keys), doc("ColliderMotion.keys"))
      .def("loops", on_self(&M::loops), "Whether the keys repeat.")
      .def("__copy__", [](const M& motion) { return motion; })
      .def("__deepcopy__", [](const M& motion, const py::object&) { return motion; });
  Struct<MeshSequence>(m, "MeshSequence")
      .field<&MeshSequence::frames>("frames")
      .field<&MeshSequence::frame_rate>("frame_rate")
      .field<&MeshSequence::times>("times")
      .field<&MeshSequence::start_time>("start_time")
      .field<&MeshSequence::loop>("loop");
  Struct<ObstacleMotion>(m, "ObstacleMotion")
      .field<&ObstacleMotion::pose>("pose")
      .field<&ObstacleMotion::sequence>("sequence");
}

}  // namespace

void bind_shapes(py::module_& m) {
  Struct<Plane>(m, "Plane").field<&Plane::normal>("normal").field<&Plane::offset>("offset");
  Struct<Sphere>(m, "Sphere").field<&Sphere::center>("center").field<&Sphere::radius>("radius");
  Struct<Box>(m, "Box").field<&Box::center>("center").field<&Box::half_extents>("half_extents");
  Struct<Capsule>(m, "Capsule")
      .field<&Capsule::center>("center")
      .field<&Capsule::radius>("radius")
      .field<&Capsule::half_height>("half_height");
  Struct<Cylinder>(m, "Cylinder")
      .field<&Cylinder::center>("center")
      .field<&Cylinder::radius>("radius")
      .field<&Cylinder::half_height>("half_height");
  bind_field(m);
  bind_motion(m);
  m.def("is_convex", &is_convex, py::arg("shape"), doc("is_convex"));
  m.def("shape_name", &shape_name, py::arg("shape"), doc("shape_name"));
}

}  // namespace souple::python
