#include "souple/io/recorder.h"

#include "python/bind.h"
#include "python/bound_world.h"
#include "souple/io/playback.h"

#include <filesystem>
#include <pybind11/stl/filesystem.h>

namespace souple::python {

namespace {

/// A recorder, and the world that it records.
class BoundRecorder {
 public:
  BoundRecorder(std::shared_ptr<BoundWorld> world, const std::filesystem::path& folder,
                const RecorderOptions& options)
      : world_(std::move(world)), recorder_(world_->use("Recorder"), folder, options) {}
  Recorder& use(const char* function) {
    world_->use(function);
    return recorder_;
  }

 private:
  std::shared_ptr<BoundWorld> world_;
  Recorder recorder_;
};

void bind_recorder_class(py::module_& m) {
  using O = RecorderOptions;
  Struct<O>(m, "RecorderOptions")
      .field<&O::formats>("formats")
      .field<&O::frame_rate>("frame_rate")
      .field<&O::frames>("frames")
      .field<&O::scene>("scene")
      .field<&O::resume_from>("resume_from");
  using R = BoundRecorder;
  py::class_<R>(m, "Recorder", doc("Recorder"))
      .def(py::init([](std::shared_ptr<BoundWorld> world, const std::filesystem::path& folder,
                       const std::optional<O>& options, const py::kwargs& kwargs) {
             return std::make_unique<R>(std::move(world), folder, with_keywords(options, kwargs, "Recorder"));
           }),
           py::arg("world").none(false), py::arg("folder"), py::arg("options") = py::none(),
           doc("Recorder.__init__"))
      .def(
          "capture", [](R& r) { r.use("capture").capture(); }, doc("Recorder.capture"))
      .def(
          "save_manifest", [](R& r) { r.use("save_manifest").save_manifest(); },
          doc("Recorder.save_manifest"))
      .def(
          "finish", [](R& r) { r.use("finish").finish(); }, doc("Recorder.finish"))
      .def(
          "frames", [](R& r) { return r.use("frames").frames(); }, doc("Recorder.frames"))
      .def(
          "notes", [](R& r) { return r.use("notes").notes(); }, doc("Recorder.notes"))
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](R& r, const py::args&) { r.use("finish").finish(); });
  m.def(
      "recorded_vertices",
      [](BoundWorld& world, ObjectId object) {
        return recorded_vertices(world.use("recorded_vertices"), object);
      },
      py::arg("world"), py::arg("object"), doc("recorded_vertices"));
}

py::list objects_of(const Playback& playback) {
  py::list objects;
  for (const Playback::Object& object : playback.objects())
    objects.append(namespace_of(
        py::arg("name") = object.name, py::arg("kind") = object.kind,
        py::arg("triangles") = to_array(object.triangles), py::arg("rest") = to_array(object.rest),
        py::arg("positions") = to_array(object.positions), py::arg("normals") = to_array(object.normals),
        py::arg("velocities") = to_array(object.velocities)));
  return objects;
}

}  // namespace

void bind_recorder(py::module_& m) {
  bind_recorder_class(m);
  py::class_<Playback>(m, "Playback", doc("Playback"))
      .def(py::init([](const std::filesystem::path& path) { return std::make_unique<Playback>(path); }),
           py::arg("path"), doc("Playback.__init__"))
      .def("frames", on_self(&Playback::frames), doc("Playback.frames"))
      .def(
          "time",
          [](const Playback& playback, std::uint64_t frame) {
            if (frame < 1 || frame > playback.frames()) throw Error("Playback.time: there is no such frame");
            return playback.time(frame);
          },
          py::arg("frame"), doc("Playback.time"))
      .def(
          "read",
          [](Playback& playback, std::uint64_t frame) {
            playback.read(frame);
            return objects_of(playback);
          },
          py::arg("frame"),
          "Reads a frame, in [1, frames()], and returns its objects: name, kind, triangles, rest, positions, "
          "normals, velocities.")
      .def("frame", on_self(&Playback::frame), doc("Playback.frame"))
      .def("objects", &objects_of, "The objects of the last frame read.");
}

}  // namespace souple::python
