#pragma once

#include "app/cache_subject.h"
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

  std::uint64_t frames() const { return cache_.frames(); }
  /// Shows a frame in [1, frames()]; other numbers are clamped. Throws Error.
  void seek(std::uint64_t frame);

 private:
  std::string description_;
  double rate_ = 60;
  app::CacheSubject cache_;
  render::Subject subject_;
};

}  // namespace souple::viewer
