#pragma once

#include "souple/io/recorder.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace souple {

/// Data to resume a stopped run, besides the state of its world. Stored in checkpoints as text.
struct RunRecord {
  std::string name;    ///< of the scene, e.g. "flag"
  std::string source;  ///< name of the scene in messages
  std::string folder;  ///< absolute path of the scene's folder
  std::string scene;   ///< JSON text, overrides applied
  std::vector<CacheFormat> formats;
  std::uint32_t checkpoint_every = 0;  ///< frames; 0: only when interrupted
  std::string surface;                 ///< meshing method of fluids during the run; empty: none
};

std::string run_record_text(const RunRecord& record);
/// Throws Error with `source` in its message.
RunRecord parse_run_record(std::string_view text, std::string_view source);

/// "pc2", "mdd", "obj", "ply", in the order of CacheFormat.
const std::vector<std::pair<std::string, CacheFormat>>& cache_formats();

}  // namespace souple
