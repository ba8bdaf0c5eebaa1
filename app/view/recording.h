#pragma once

#include "app/cache_subject.h"
#include "app/view/clock.h"
#include "app/view/session.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace souple::viewer {

/// Playback of a finished run from its folder, at its frame rate or frame by frame.
class Recording : public Session {
 public:
  /// Throws Error if `path` is no run's folder or the run has no frame.
  explicit Recording(const std::filesystem::path& path);

  const std::string& name() const override { return name_; }
  const std::string& description() const override { return description_; }
  double frame_rate() const override { return rate_; }
  double time() const override { return cache_.playback().time(frame()); }
  std::uint64_t frame() const override { return cache_.playback().frame(); }
  render::Subject subject() const override { return subject_; }
  std::optional<render::Camera> camera() const override;

  /// Stops at the last frame; throws Error if a file can no longer be read.
  void advance(double seconds) override;
  void step_frame() override;
  void step_fine() override;
  void reset() override;
  /// Starts over if the last frame is shown.
  void set_playing(bool playing) override;
  bool playing() const override { return playing_; }
  double speed() const override { return clock_.speed(); }
  const std::optional<Trouble>& trouble() const override { return trouble_; }

  std::uint64_t frames() const { return cache_.frames(); }
  /// Shows a frame in [1, frames()], clamped. Throws Error.
  void seek(std::uint64_t frame);

 private:
  std::string name_, description_;
  double rate_ = 60;
  app::CacheSubject cache_;
  render::Subject subject_;
  Clock clock_;
  bool playing_ = true;
  std::optional<Trouble> trouble_;  // always empty
};

}  // namespace souple::viewer
