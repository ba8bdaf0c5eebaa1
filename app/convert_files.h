#pragma once

#include "souple/io/export_frames.h"

#include <cstdint>
#include <filesystem>
#include <string>

// Files that `souple convert` writes in the folder of its output: NAME.glb or a .glb per frame, NAME.usda alone or with
// a file per frame.

namespace souple::app {

/// How many files hold the frames.
enum class ConvertLayout { automatic, one_file, file_per_frame };

struct ConvertJob {
  ExportFrames& frames;
  std::filesystem::path cache, out;
  std::string name;  ///< of the run, and of its files
  ConvertLayout layout = ConvertLayout::automatic;
  bool constant = true;  ///< of ExportFrames::survey
  bool quiet = false;
};

/// Each returns the number of frames written: fewer than those of the run after an interrupt. Says first what it will
/// write. Files of an earlier conversion in the folder are replaced.
std::uint64_t convert_to_glb(const ConvertJob& job);
std::uint64_t convert_to_usda(const ConvertJob& job);

}  // namespace souple::app
