#pragma once

#include "souple/io/recorder.h"
#include "souple/scene/scene.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace souple {

/// What a stopped run has to know to go on, beside the state of its world. Kept in checkpoints as text.
struct RunRecord {
  std::string name;    ///< of the scene, e.g. "flag"
  std::string source;  ///< how messages call the scene
  std::string folder;  ///< absolute: where its meshes are
  std::string scene;   ///< JSON text, overrides applied
  std::vector<CacheFormat> formats;
  std::uint32_t checkpoint_every = 0;  ///< frames; 0: only when interrupted
  std::string surface;                 ///< how fluids are meshed meanwhile; empty: they are not
};

std::string run_record_text(const RunRecord& record);
/// Throws Error, which names `source`.
RunRecord parse_run_record(std::string_view text, std::string_view source);

/// "pc2", "mdd", "obj", "ply", in the order of CacheFormat.
const std::vector<std::pair<std::string, CacheFormat>>& cache_formats();

}  // namespace souple
