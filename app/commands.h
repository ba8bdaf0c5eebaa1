#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// The commands of the program. Each returns an ExitCode, or throws Error for bad input.

namespace souple::app {

struct RunOptions {
  std::string scene;  ///< a file or a shipped scene's name; empty with `resume`
  std::optional<std::uint32_t> frames, substeps, iterations;
  std::filesystem::path out;          ///< empty: out/NAME
  std::vector<std::string> formats;   ///< empty: pc2
  std::vector<std::string> settings;  ///< path=value
  std::filesystem::path resume;
  std::optional<std::uint32_t> checkpoint_every;
  bool quiet = false;
};
int run(const RunOptions& options);

int list(bool as_json);

int check(const std::string& scene, const std::vector<std::string>& settings);

enum class InfoPart { all, schema, scene_format };
int info(InfoPart part);

}  // namespace souple::app
