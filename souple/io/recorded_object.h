#pragma once

#include "souple/io/manifest.h"
#include "souple/io/mdd.h"
#include "souple/io/pc2.h"
#include "souple/io/recorder.h"
#include "souple/io/sequence.h"
#include "souple/world/world.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace souple {

/// Where and how all objects of a run are recorded.
struct RecordingPlan {
  std::filesystem::path folder;
  std::vector<CacheFormat> formats;
  double frame_rate = 60;
  std::uint64_t frames = 0;  ///< planned, 0 when unknown
};

/// What of an object decides how its files look; positions aside.
struct RecordedShape {
  ObjectKind kind = ObjectKind::cloth;
  std::uint64_t points = 0;
  TriangleMesh mesh;     ///< no faces for ropes and grains
  std::string topology;  ///< the end of its OBJ files: faces, or the rope's line
};

/// The files of one object (one name) of a run.
class RecordedObject {
 public:
  /// Starts the files that `plan` asks for, to hold all frames of the run.
  RecordedObject(const RecordingPlan& plan, const World& world, ObjectId object, std::string file_name);

  /// Takes up the files of an earlier run after `frames` frames.
  struct Resume {
    std::uint64_t frames;
    std::uint64_t points;  ///< that it began with: of a fluid their number changes
  };
  RecordedObject(const RecordingPlan& plan, const World& world, ObjectId object, std::string file_name,
                 const Resume& resume);

  /// For an object that joins after `frames` frames: sequences only.
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
  /// Another object of this name, with this shape, takes over after `frames` frames. Returns false when the
  /// caches could not go on and a sequence was begun instead.
  bool take_over(const World& world, ObjectId object, std::uint64_t frames);

  /// Frame number `frame`, 1 the first.
  void append(const World& world, std::uint64_t frame);
  /// Makes good an append that failed: as after `frames` frames.
  void drop_after(std::uint64_t frames);
  /// The object is gone: its caches are complete.
  void leave();
  /// Renames what is .part; what holds no frame is removed.
  void finish();

  /// Of its sequences.
  std::string next_file() const;
  ManifestObject manifest() const;

 private:
  /// One file a frame; `skipped` numbers have none.
  struct Sequence {
    std::string extension;
    std::uint64_t first;  ///< number, 0 when there is none yet
    std::uint64_t skipped;
    SequenceWriter writer;
  };
  RecordedObject(const RecordingPlan& plan, std::string name, ObjectId object, std::string file_name,
                 std::shared_ptr<RecordedShape> shape);

  bool wants(CacheFormat format) const;
  std::filesystem::path path(const char* extension) const;
  void write_rest_mesh(const World& world) const;
  void add_sequence(const char* extension, std::uint64_t kept);
  void begin_late(std::uint64_t frames);
  void close_caches();

  RecordingPlan plan_;
  std::string name_, file_name_;
  ObjectId object_;
  bool present_ = true;
  bool has_rest_mesh_ = false;
  bool caches_open_ = true;               ///< the PC2 and MDD, which end where the object does
  std::shared_ptr<RecordedShape> shape_;  ///< shared with what writes the sequences
  std::optional<Pc2Writer> pc2_;
  std::optional<MddWriter> mdd_;
  std::vector<Sequence> sequences_;
  ManifestObject first_shape_;  ///< points and triangles of the object that the caches hold
};

/// `name` has the topology that `known` tells of.
bool same_topology(const World& world, ObjectId object, const ManifestObject& known);

}  // namespace souple
