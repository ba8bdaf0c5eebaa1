#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/queries/query.h"
#include "souple/queries/selector.h"

namespace souple::python {

namespace {

std::string text_of(const Selector& selector) {
  static constexpr const char* words[] = {"all()", "vertices(...)", "in_box(...)", "nearest(...)",
                                          "group(...)"};
  return words[selector.choice.index()];
}

void bind_selectors(py::module_& m) {
  py::class_<Selector>(m, "Selector", doc("Selector")).def("__repr__", &text_of);
  m.def("all", &all, "Selects all vertices.");
  m.def("vertices", &vertices, py::arg("indices"), "Selects vertices by index, in user order.");
  m.def("in_box", &in_box, py::arg("lo"), py::arg("hi"),
        "Selects the vertices in a box of the world, at the time of the call; includes its boundary [m].");
  m.def("nearest", &nearest, py::arg("point"), "Selects the vertex nearest to a point of the world [m].");
  m.def("group", &group, py::arg("name"), "Selects the vertices of a group of the mesh.");
}

}  // namespace

void bind_queries(py::module_& m) {
  bind_selectors(m);
  Struct<QueryFilter>(m, "QueryFilter")
      .field<&QueryFilter::groups>("groups")
      .field<&QueryFilter::kinds>("kinds")
      .field<&QueryFilter::only>("only")
      .field<&QueryFilter::except>("except_")
      .field<&QueryFilter::except_colliders>("except_colliders")
      .field<&QueryFilter::objects>("objects")
      .field<&QueryFilter::colliders>("colliders")
      .field<&QueryFilter::sensors>("sensors");
  Result<Hit>(m, "Hit")
      .field<&Hit::found>("found")
      .field<&Hit::object>("object")
      .field<&Hit::collider>("collider")
      .field<&Hit::is_collider>("is_collider")
      .field<&Hit::vertex>("vertex")
      .field<&Hit::triangle>("triangle")
      .field<&Hit::point>("point")
      .field<&Hit::distance>("distance")
      .field<&Hit::normal>("normal");
  Result<Overlap>(m, "Overlap")
      .field<&Overlap::object>("object")
      .field<&Overlap::collider>("collider")
      .field<&Overlap::is_collider>("is_collider")
      .field<&Overlap::vertices>("vertices");
  Result<ContactEvent>(m, "ContactEvent")
      .field<&ContactEvent::object>("object")
      .field<&ContactEvent::other>("other")
      .field<&ContactEvent::vertex>("vertex")
      .field<&ContactEvent::other_vertex>("other_vertex")
      .field<&ContactEvent::other_is_collider>("other_is_collider")
      .field<&ContactEvent::point>("point")
      .field<&ContactEvent::normal>("normal")
      .field<&ContactEvent::impulse>("impulse")
      .field<&ContactEvent::object_id>("object_id")
      .field<&ContactEvent::other_id>("other_id")
      .field<&ContactEvent::collider_id>("collider_id");
  Result<ContactPair>(m, "ContactPair")
      .field<&ContactPair::object>("object")
      .field<&ContactPair::other>("other")
      .field<&ContactPair::collider>("collider")
      .field<&ContactPair::is_collider>("is_collider")
      .field<&ContactPair::is_sensor>("is_sensor")
      .field<&ContactPair::phase>("phase")
      .field<&ContactPair::impulse>("impulse")
      .field<&ContactPair::point>("point")
      .field<&ContactPair::normal>("normal");
  m.def("kind_bit", &kind_bit, py::arg("kind"), doc("kind_bit"));
}

}  // namespace souple::python
