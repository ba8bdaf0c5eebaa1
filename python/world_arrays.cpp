#include "python/bind.h"
#include "python/bound_world.h"
#include "souple/queries/kept_memory.h"

namespace souple::python {

namespace {

using Getter = std::span<const Vec3f> (World::*)(ObjectId) const;

/// Owner of an array's memory, and the array's origin.
struct Origin {
  std::shared_ptr<const void> memory;
  std::uint64_t world;
  ObjectId object;
  Getter getter;
  std::span<const Vec3f> points;
};
constexpr const char* capsule_name = "souple.origin";

/// A view of the world's own data, which lives as long as the view.
py::array array_of(BoundWorld& world, ObjectId object, Getter getter, const char* name) {
  const std::span<const Vec3f> points = (world.use(name).*getter)(object);
  if (points.empty()) return to_array(points);
  auto origin = std::make_unique<Origin>(Origin{keep(points), world.number(), object, getter, points});
  const py::capsule base(origin.get(), capsule_name, [](PyObject* capsule) {
    delete static_cast<Origin*>(PyCapsule_GetPointer(capsule, capsule_name));
  });
  origin.release();
  return view_of(points.data(), points.size(), "f4", 3, base);
}

/// The origin of an array or of a view of it; null if it is none of ours.
const Origin* origin_of(py::handle array) {
  py::object base = py::reinterpret_borrow<py::object>(array);
  while (py::isinstance<py::array>(base)) base = base.attr("base");
  if (PyCapsule_IsValid(base.ptr(), capsule_name) == 0) return nullptr;
  return static_cast<const Origin*>(PyCapsule_GetPointer(base.ptr(), capsule_name));
}

bool is_current(BoundWorld& world, const py::array& array) {
  const World& used = world.use("is_current");
  const Origin* const origin = origin_of(array);
  if (origin == nullptr && array.size() == 0) return true;  // shows nothing, as of a fluid without particles
  if (origin == nullptr)
    throw Error(
        "is_current: expected an array that positions, velocities, normals or angular_velocities returned");
  if (origin->world != world.number() || !used.contains(origin->object)) return false;
  const std::span<const Vec3f> now = (used.*(origin->getter))(origin->object);
  return now.data() == origin->points.data() && now.size() == origin->points.size();
}

void def_array(WorldClass& world, const char* name, Getter getter, const char* text) {
  world.def(
      name,
      [getter, name](BoundWorld& self, ObjectId object) { return array_of(self, object, getter, name); },
      "object"_a, text);
}

}  // namespace

void bind_world_arrays(WorldClass& world) {
  def_array(world, "positions", &World::positions,
            "Positions of the vertices in user order, (n, 3), float32 [m]: a read-only view of the world's "
            "data. A later call "
            "brings the same memory up to date; copy() keeps values.");
  def_array(world, "velocities", &World::velocities, "Velocities of the vertices, like positions [m/s].");
  def_array(world, "normals", &World::normals,
            "Unit normals of the vertices, like positions; empty without triangles.");
  def_array(
      world, "angular_velocities", &World::angular_velocities,
      "Angular velocity of each grain about its center, like positions [rad/s]; empty for other kinds.");
  world
      .def(
          "triangles",
          [](BoundWorld& self, ObjectId object) { return to_array(self.use("triangles").triangles(object)); },
          "object"_a, "Vertex indices of the triangles, (n, 3), uint32: a copy.")
      .def("is_current", &is_current, "array"_a,
           "Whether an array that positions, velocities, normals or angular_velocities returned, or a slice "
           "of it, still shows "
           "its object. False once the object was removed, or its number of vertices changed: the array then "
           "keeps its last "
           "values. Brings the array up to date.");
}

}  // namespace souple::python
