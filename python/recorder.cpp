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
      .fields<&O::formats, &O::frame_rate, &O::frames, &O::scene, &O::resume_from>();
  using R = BoundRecorder;
  py::class_<R>(m, "Recorder", doc("Recorder"))
      .def(py::init([](std::shared_ptr<BoundWorld> world, const std::filesystem::path& folder,
                       const std::optional<O>& options, const py::kwargs& kwargs) {
             return std::make_unique<R>(std::move(world), folder, with_keywords(options, kwargs, "Recorder"));
           }),
           "world"_a.none(false), "folder"_a, "options"_a = py::none(), doc("Recorder.__init__"))
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
      "world"_a, "object"_a, doc("recorded_vertices"));
}

py::list objects_of(const Playback& playback) {
  py::list objects;
  for (const Playback::Object& object : playback.objects())
    objects.append(namespace_of(
        "name"_a = object.name, "kind"_a = object.kind, "triangles"_a = to_array(object.triangles),
        "rest"_a = to_array(object.rest), "positions"_a = to_array(object.positions),
        "normals"_a = to_array(object.normals), "velocities"_a = to_array(object.velocities)));
  return objects;
}

}  // namespace

void bind_recorder(py::module_& m) {
  bind_recorder_class(m);
  py::class_<Playback>(m, "Playback", doc("Playback"))
      .def(py::init([](const std::filesystem::path& path) { return std::make_unique<Playback>(path); }),
           "path"_a, doc("Playback.__init__"))
      .def("frames", on_self(&Playback::frames), doc("Playback.frames"))
      .def(
          "time",
          [](const Playback& playback, std::uint64_t frame) {
            if (frame < 1 || frame > playback.frames()) throw Error("Playback.time: there is no such frame");
            return playback.time(frame);
          },
          "frame"_a, doc("Playback.time"))
      .def(
          "read",
          [](Playback& playback, std::uint64_t frame) {
            playback.read(frame);
            return objects_of(playback);
          },
          "frame"_a,
          "Reads a frame, in [1, frames()], and returns its objects: name, kind, triangles, rest, positions, "
          "normals, velocities.")
      .def("frame", on_self(&Playback::frame), doc("Playback.frame"))
      .def("objects", &objects_of, "The objects of the last frame read.");
}

}  // namespace souple::python
