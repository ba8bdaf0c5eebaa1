#pragma once

#include "souple/io/manifest.h"
#include "souple/io/recorded_object.h"
#include "souple/io/sequence.h"

#include <cstdint>
#include <string>
#include <vector>

namespace souple {

class World;

/// Kind and name of a world's foam in run.json, where it follows the objects.
inline constexpr const char* foam_kind_name = "foam";

/// Whether a fluid of the world produces foam, or did so earlier.
bool foams(const World& world);

/// The spray, foam and bubbles of all fluids of a run: a PLY per frame, with velocities and kinds.
class RecordedFoam {
 public:
  /// Begins after `before` frames; `kept` of them, 0 or all, belong to an earlier run.
  RecordedFoam(const RecordingPlan& plan, std::string file_name, std::uint64_t before, std::uint64_t kept);

  RecordedFoam(const RecordedFoam&) = delete;
  RecordedFoam& operator=(const RecordedFoam&) = delete;

  void append(const World& world);
  /// Undoes a failed append: restores the state after `frames` frames.
  void drop_after(std::uint64_t frames);
  void finish() { writer_.finish(); }
  bool has_files() const { return writer_.frames() >= first_; }
  ManifestObject manifest() const;

 private:
  std::string file_name_;
  std::uint64_t first_;              // first frame with a file
  std::vector<std::uint8_t> kinds_;  // FoamKind of each point of the frame that is written
  SequenceWriter writer_;
};

}  // namespace souple
