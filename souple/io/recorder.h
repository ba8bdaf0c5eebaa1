#pragma once

#include "souple/world/world.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace souple {

enum class CacheFormat { pc2, mdd, obj, ply };

struct RecorderOptions {
  std::vector<CacheFormat> formats{CacheFormat::pc2};
  double frame_rate = 60;    ///< frames a second
  std::uint64_t frames = 0;  ///< planned, 0 when unknown
  std::string scene{};       ///< the scene file's JSON text, embedded in run.json; may be empty
  /// > 0: continue the folder's caches after this many frames, dropping later ones.
  std::uint64_t resume_from = 0;
};

/// Writes what a world does into a folder that other programs open: run.json, and per object a rest mesh
/// NAME.obj with NAME.pc2 or NAME.mdd, or a sequence NAME_0001.obj / .ply. Files grow as NAME.part and are
/// renamed when complete. Vertices are in user order everywhere. A rope is a polyline in OBJ; grains are
/// vertices alone; in PLY both are points with velocities. Fluids, the number of whose particles changes, are
/// PLY whatever formats were asked for; so is their foam, all of it together: foam_0001.ply. Objects whose
/// names cannot be file names (`a/b`) get similar ones; run.json tells which file is whose. The world has to
/// outlive the recorder, in its place.
class Recorder {
 public:
  /// Creates the folder (a std::filesystem::path will do). Objects that files are started for are those of
  /// the world now. Throws Error when it cannot be written, or when resume_from does not fit what is there.
  Recorder(const World& world, const std::string& folder, const RecorderOptions& options = {});
  /// Finishes; a failure is swallowed, so call finish() to hear of it.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Appends the world's present state as the next frame. Throws Error when it cannot be written (disk full);
  /// the folder is then as after the frame before, and another try is allowed.
  ///
  /// An object that is removed during the run keeps the frames it has. One that is added later, or comes back
  /// with another topology, cannot be in a PC2 or MDD, which hold a fixed number of points from the first
  /// frame on: it is written as an OBJ sequence from then on, whose numbers are the run's frames.
  void capture();
  /// Writes run.json for the frames so far. It is also written now and then by capture, and by finish: call
  /// this before writing a checkpoint, so that a run that is killed later finds all its reports.
  void save_manifest();
  /// Closes all files and writes run.json. Further captures throw. run.json calls the run complete when it
  /// has the planned number of frames, or when none was planned.
  void finish();
  std::uint64_t frames() const;                   ///< captured so far, including resumed ones
  const std::vector<std::string>& notes() const;  ///< e.g. which object fell back to OBJ and why

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
