#pragma once

#include "souple/objects/handles.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace souple {

class World;

enum class CacheFormat { pc2, mdd, obj, ply };

struct RecorderOptions {
  std::vector<CacheFormat> formats{CacheFormat::pc2};
  double frame_rate = 60;    ///< frames per second
  std::uint64_t frames = 0;  ///< planned, 0 when unknown
  std::string scene{};       ///< the scene file's JSON text, embedded in run.json; may be empty
  /// > 0: continue the folder's caches after this many frames and remove later frames.
  std::uint64_t resume_from = 0;
  bool locked = false;  ///< the caller holds the OutputLock of the folder
};

/// The vertices of an object that its files hold, ascending. For a soft body made of tets these are the vertices on its
/// surface, for other objects all. Importers drop vertices without a face and then refuse a cache that has them.
std::vector<std::uint32_t> recorded_vertices(const World& world, ObjectId object);

/// Records a world into a folder for other programs: run.json, and per object a rest mesh NAME.obj with
/// NAME.pc2 or NAME.mdd, or a sequence NAME_0001.obj / .ply. Files grow as NAME.part and are renamed when
/// complete. Vertices are in user order; of a soft body made of tets, those on its surface. In OBJ a rope is a
/// line element per segment and grains are bare vertices; in PLY both are points with velocities. Fluids have a varying number of particles and are always PLY; so is their
/// common foam: foam_0001.ply. Objects whose names cannot be file names (`a/b`) get similar names; run.json
/// lists the files of each object. The world must outlive the recorder, at its address.
class Recorder {
 public:
  /// Creates the folder (a std::filesystem::path converts too) and starts files for the world's current
  /// objects. Removes the files that the manifest of the folder's last run lists, and no others. Holds the folder's OutputLock until `finish`. Throws Error if another recorder or program writes
  /// there, the folder cannot be written, or resume_from does not match its content.
  Recorder(const World& world, const std::string& folder, const RecorderOptions& options = {});
  /// Finishes and ignores failures; call finish() to get them.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Appends the world's current state as the next frame. Throws Error if it cannot be written (disk full);
  /// the folder then has the state after the previous frame, and capture may be repeated.
  ///
  /// An object removed during the run keeps its frames. PC2 and MDD hold a fixed number of points from the
  /// first frame on. So an object that is added later, or returns with another topology, is written as an OBJ sequence,
  /// numbered by the run's frames.
  void capture();
  /// Writes run.json for the frames so far. `capture` does so at intervals, `finish` at the end. Call this
  /// before writing a checkpoint, so that all reports survive if the run is killed later.
  void save_manifest();
  /// Closes all files and writes run.json. Further captures throw. run.json marks the run complete if it has
  /// the planned number of frames or if none was planned.
  void finish();
  std::uint64_t frames() const;                   ///< captured so far, including resumed ones
  const std::vector<std::string>& notes() const;  ///< e.g. which object fell back to OBJ and why

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
