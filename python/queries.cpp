#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/queries/query.h"
#include "souple/queries/selector.h"

namespace souple::python {

namespace {

std::string selector_text(const Selector& selector) {
  static constexpr const char* words[] = {"all()", "vertices(...)", "in_box(...)", "nearest(...)",
                                          "group(...)"};
  return words[selector.choice.index()];
}

void bind_selectors(py::module_& m) {
  py::class_<Selector>(m, "Selector", doc("Selector")).def("__repr__", &selector_text);
  m.def("all", &all, "Selects all vertices.");
  m.def("vertices", &vertices, "indices"_a, "Selects vertices by index, in user order.");
  m.def("in_box", &in_box, "lo"_a, "hi"_a,
        "Selects the vertices in a box of the world, at the time of the call; includes its boundary [m].");
  m.def("nearest", &nearest, "point"_a, "Selects the vertex nearest to a point of the world [m].");
  m.def("group", &group, "name"_a, "Selects the vertices of a group of the mesh.");
}

}  // namespace

void bind_queries(py::module_& m) {
  bind_selectors(m);
  Struct<QueryFilter>(m, "QueryFilter")
      .fields<&QueryFilter::groups, &QueryFilter::kinds, &QueryFilter::only>()
      .field<&QueryFilter::except>("except_")
      .fields<&QueryFilter::except_colliders, &QueryFilter::objects, &QueryFilter::colliders,
              &QueryFilter::sensors>();
  Result<Hit>(m, "Hit")
      .fields<&Hit::found, &Hit::object, &Hit::collider, &Hit::is_collider, &Hit::vertex, &Hit::triangle,
              &Hit::point, &Hit::distance, &Hit::normal>();
  Result<Overlap>(m, "Overlap")
      .fields<&Overlap::object, &Overlap::collider, &Overlap::is_collider, &Overlap::vertices>();
  Result<ContactEvent>(m, "ContactEvent")
      .fields<&ContactEvent::object, &ContactEvent::other, &ContactEvent::vertex, &ContactEvent::other_vertex,
              &ContactEvent::other_is_collider, &ContactEvent::point, &ContactEvent::normal,
              &ContactEvent::impulse, &ContactEvent::object_id, &ContactEvent::other_id,
              &ContactEvent::collider_id>();
  Result<ContactPair>(m, "ContactPair")
      .fields<&ContactPair::object, &ContactPair::other, &ContactPair::collider, &ContactPair::is_collider,
              &ContactPair::is_sensor, &ContactPair::phase, &ContactPair::impulse, &ContactPair::point,
              &ContactPair::normal>();
  m.def("kind_bit", &kind_bit, "kind"_a, doc("kind_bit"));
}

}  // namespace souple::python
