#include "souple/scene/scene.h"

#include "python/bind.h"
#include "python/bound_world.h"

#include <filesystem>
#include <pybind11/stl/filesystem.h>
#include <utility>

namespace souple::python {

namespace {

/// The text, folder and source of a scene: souple/scene.py makes a dict of the text.
py::tuple parts_of(const SceneDescription& scene) {
  return py::make_tuple(to_json(scene), scene.folder.string(), scene.source);
}

SceneDescription parsed(const std::string& text, const std::string& folder, const std::string& source,
                        const std::vector<std::string>& overrides) {
  return parse_scene(text, folder, source, overrides);
}

SceneLog log_of(const py::object& function) {
  if (function.is_none()) return {};
  const Callback callback(nullptr, "log function", require_callable(function, "build_world"));
  return
      [callback](LogLevel level, std::string_view words) { callback.call<void>(level, std::string(words)); };
}

std::shared_ptr<BoundWorld> build(const std::string& text, const std::string& folder,
                                  const std::string& source, const py::object& log) {
  const SceneLog to = log_of(log);
  PendingError raised;
  PendingError* const before = std::exchange(PendingError::outside_of_steps, &raised);
  std::shared_ptr<BoundWorld> world;
  try {
    const ReleasedGil released;
    world = std::make_shared<BoundWorld>(build_world(parsed(text, folder, source, {}), to));
  } catch (...) {
    PendingError::outside_of_steps = before;
    throw;
  }
  PendingError::outside_of_steps = before;
  raised.raise();
  return world;
}

}  // namespace

void bind_scene(py::module_& m) {
  m.def("_load_scene", [](const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    return parts_of(load_scene(file, overrides));
  });
  m.def("_parse_scene", [](const std::string& text, const std::string& folder, const std::string& source,
                           const std::vector<std::string>& overrides) {
    return parts_of(parsed(text, folder, source, overrides));
  });
  m.def("_build_world", &build);
  m.def("_add_to_world", [](const std::string& text, const std::string& folder, const std::string& source,
                            std::size_t object, BoundWorld& world) {
    const SceneDescription scene = parsed(text, folder, source, {});
    if (object >= scene.objects.size()) throw Error("add_to_world: the scene has no such object");
    add_to_world(scene, object, world.use("add_to_world"));
  });
  m.def("scene_schema", &scene_schema, "The JSON schema of scene files.");
  m.def("scene_manual", &scene_manual, "The manual page of scene files.");
}

}  // namespace souple::python
