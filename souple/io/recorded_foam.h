#pragma once

#include "souple/io/manifest.h"
#include "souple/io/recorded_object.h"
#include "souple/io/sequence.h"
#include "souple/world/world.h"

#include <cstdint>
#include <string>

namespace souple {

/// The kind that run.json gives a world's foam, which is listed after the objects; also its name there.
inline constexpr const char* foam_kind_name = "foam";

/// Whether some fluid of a world foams, or has done so.
bool foams(const World& world);

/// Spray, foam and bubbles of a run, all of them together: a PLY a frame, with velocities.
class RecordedFoam {
 public:
  /// To begin after `before` frames, of which `kept` are those of an earlier run: 0, or all.
  RecordedFoam(const RecordingPlan& plan, std::string file_name, std::uint64_t before, std::uint64_t kept);

  void append(const World& world);
  /// Makes good an append that failed: as after `frames` frames.
  void drop_after(std::uint64_t frames);
  void finish() { writer_.finish(); }
  bool has_files() const { return writer_.frames() >= first_; }
  ManifestObject manifest() const;

 private:
  std::string file_name_;
  std::uint64_t first_;  // frame that has a file
  SequenceWriter writer_;
};

}  // namespace souple
