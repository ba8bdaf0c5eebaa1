#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/io/manifest.h"
#include "souple/io/mdd.h"
#include "souple/io/pc2.h"
#include "souple/io/recorder.h"
#include "souple/io/sequence.h"
#include "souple/objects/handles.h"
#include "souple/objects/kind_traits.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace souple {

class World;

/// Folder and formats of a run's recording.
struct RecordingPlan {
  std::filesystem::path folder;
  std::vector<CacheFormat> formats;
  double frame_rate = 60;
  std::uint64_t frames = 0;  ///< planned, 0 when unknown
};

/// The properties of an object that determine its files, apart from positions.
struct RecordedShape {
  ObjectKind kind = ObjectKind::cloth;
  std::uint64_t points = 0;  ///< in the files
  /// The object's vertices in the files, ascending; empty: all. A tet mesh is written as its surface: importers
  /// drop vertices without a face, and then a cache has too many points.
  std::vector<std::uint32_t> vertices;
  TriangleMesh mesh;     ///< of these vertices, without normals; without faces for ropes and grains
  std::string topology;  ///< the end of its OBJ files: faces, or the segments of a rope
};

/// The files of one object, identified by its name, in a run.
class RecordedObject {
 public:
  /// Starts the files of `plan` for all frames of the run.
  RecordedObject(const RecordingPlan& plan, const World& world, ObjectId object, std::string file_name);

  /// Continues the files of an earlier run after `frames` frames.
  struct Resume {
    std::uint64_t frames;
    std::uint64_t points;  ///< number of points at its start; it varies for fluids
  };
  RecordedObject(const RecordingPlan& plan, const World& world, ObjectId object, std::string file_name,
                 const Resume& resume);

  /// For an object added after `frames` frames: sequences only.
  struct Late {
    std::uint64_t frames;
  };
  RecordedObject(const RecordingPlan& plan, const World& world, ObjectId object, std::string file_name,
                 const Late& late);

  RecordedObject(const RecordedObject&) = delete;
  RecordedObject& operator=(const RecordedObject&) = delete;

  const std::string& name() const { return name_; }
  ObjectId object() const { return object_; }
  bool present() const { return present_; }
  /// Continues with another object of this name after `frames` frames. Returns false if its topology differs,
  /// so that a sequence replaces the caches.
  bool take_over(const World& world, ObjectId object, std::uint64_t frames);

  /// Writes frame number `frame`; the first is 1.
  void append(const World& world, std::uint64_t frame);
  /// Undoes a failed append: restores the state after `frames` frames.
  void drop_after(std::uint64_t frames);
  /// The object was removed: completes its caches.
  void leave();
  /// Removes the files from the start of a run, when another of its files could not be written.
  void discard();
  /// Renames .part files; removes files without frames.
  void finish();

  /// Writes the rest mesh again if a resumed run lacks it, and returns true. Ropes and grains have moved since: their
  /// mesh shows the world as it is.
  bool restore_rest_mesh(const World& world) const;
  /// Number of vertices in the files that belong to no face, of an object that has faces.
  std::size_t loose_vertices() const;
  /// Name of the next file of its sequences.
  std::string next_file() const;
  ManifestObject manifest() const;

 private:
  /// One file per frame; `skipped` numbers have none.
  struct Sequence {
    std::string extension;
    std::uint64_t first;  ///< number of the first file; 0: none yet
    std::uint64_t skipped;
    SequenceWriter writer;
  };
  RecordedObject(const RecordingPlan& plan, std::string name, ObjectId object, std::string file_name,
                 std::shared_ptr<RecordedShape> shape);

  bool wants(CacheFormat format) const;
  std::filesystem::path path(const char* extension) const;
  void write_rest_mesh(const World& world) const;
  /// The values of the vertices in the files; `buffer` holds them if these are not all.
  std::span<const Vec3f> written(std::span<const Vec3f> values, std::vector<Vec3f>& buffer) const;
  void add_sequence(const char* extension, std::uint64_t kept);
  void begin_late(std::uint64_t frames);
  void close_caches();

  RecordingPlan plan_;
  std::string name_, file_name_;
  ObjectId object_;
  bool present_ = true;
  bool has_rest_mesh_ = false;
  bool caches_open_ = true;               ///< PC2 and MDD, which end with the object
  std::shared_ptr<RecordedShape> shape_;  ///< shared with the sequence writers
  std::optional<Pc2Writer> pc2_;
  std::optional<MddWriter> mdd_;
  std::vector<Sequence> sequences_;
  std::vector<Vec3f> positions_, velocities_;  ///< of `written`
  ManifestObject first_shape_;                 ///< points and triangles of the object in the caches
};

/// Whether the object has the topology described by `known`.
bool same_topology(const World& world, ObjectId object, const ManifestObject& known);

}  // namespace souple
