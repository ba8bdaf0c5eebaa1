#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace souple::app {

/// An argument of --set: a path of the scene with the values that it takes.
struct SweepSetting {
  std::string path;
  std::vector<std::string> values;  ///< as --set of `souple run` takes them; at least one
};

/// Parses "PATH=VALUE" as `souple run` does, "PATH=A:B:N" (N numbers from A to B in equal steps), "PATH=A:B:logN"
/// (in equal factors), or "PATH=A,B,C". A value that is JSON, such as [0,-1,0], is one value. Throws Error.
SweepSetting parse_sweep_setting(const std::string& argument);

/// All combinations of the values of some settings, as runs 1, 2, ...: values of the last setting change first.
class SweepPlan {
 public:
  /// Throws Error where a path is given twice, where no setting has several values, or for more than `most_runs`.
  explicit SweepPlan(const std::vector<std::string>& arguments);

  static constexpr std::uint64_t most_runs = 100000;

  std::uint64_t runs() const { return runs_; }
  const std::vector<SweepSetting>& settings() const { return settings_; }
  /// Arguments for load_scene.
  std::vector<std::string> settings_of(std::uint64_t run) const;
  /// Path and value of each setting with several values.
  std::vector<std::pair<std::string, std::string>> values_of(std::uint64_t run) const;
  /// "wind.velocity.0=5 substeps=20": the same in a line.
  std::string label_of(std::uint64_t run) const;
  /// "velocity.0=5 substeps=20", for pictures.
  std::string short_label_of(std::uint64_t run) const;

 private:
  const std::string& value_of(std::size_t setting, std::uint64_t run) const;

  std::vector<SweepSetting> settings_;
  std::uint64_t runs_ = 1;
};

}  // namespace souple::app
