#pragma once

#include "app/cache_subject.h"
#include "app/view/clock.h"
#include "app/view/session.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace souple::viewer {

/// A finished run, played from its folder: at its frame rate, or frame by frame.
class Recording : public Session {
 public:
  /// Throws Error when the folder is not that of a run, or holds no frame.
  explicit Recording(const std::filesystem::path& path);

  const std::string& name() const override { return name_; }
  const std::string& description() const override { return description_; }
  double frame_rate() const override { return rate_; }
  double time() const override { return cache_.playback().time(frame()); }
  std::uint64_t frame() const override { return cache_.playback().frame(); }
  render::Subject subject() const override { return subject_; }
  std::optional<render::Camera> camera() const override;

  /// Stops at the last frame; throws Error when a file cannot be read.
  void advance(double seconds) override;
  void step_frame() override;
  void step_fine() override;
  void step_back() override;
  void reset() override;
  /// At the last frame, starts again from the first.
  void set_playing(bool playing) override;
  bool playing() const override { return playing_; }
  double speed() const override { return clock_.speed(); }
  const std::optional<Failure>& failure() const override { return failure_; }

  std::uint64_t frames() const { return cache_.frames(); }
  /// Shows a frame in [1, frames()]; other numbers are clamped. Throws Error.
  void seek(std::uint64_t frame);

 private:
  std::string name_, description_;
  double rate_ = 60;
  app::CacheSubject cache_;
  render::Subject subject_;
  Clock clock_;
  bool playing_ = true;
  std::optional<Failure> failure_;  // a recording cannot fail
};

}  // namespace souple::viewer
