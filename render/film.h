#pragma once

#include "render/image.h"

#include <filesystem>
#include <functional>
#include <memory>

namespace souple::render {

/// A film from pictures of equal size: .mp4 (H.264), .gif, or, for any path without such an extension, a
/// folder of PNG files NAME_0001.png, where NAME is the folder's name. The program ffmpeg encodes films.
///
/// An .mp4 has even sides: at an odd size the last row or column is doubled. A .gif has at most 50 pictures a
/// second, because players slow down faster ones: of a faster film it keeps every second picture, or every
/// third, and so on.
class Film {
 public:
  /// Whether the user has asked to stop.
  using Interrupted = std::function<bool()>;

  /// Throws Error when ffmpeg is missing (and names its package) or the file cannot be written. Once `interrupted`
  /// returns true, an ffmpeg that neither reads nor computes for two seconds is ended, and the film has failed;
  /// without it the film waits for any ffmpeg.
  Film(std::filesystem::path file, double frame_rate, Interrupted interrupted = {});
  /// Finishes the film without exceptions; a film that failed or has no picture leaves no file.
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// Throws Error when the size differs from the first picture's, or, with ffmpeg's last message, when ffmpeg
  /// failed.
  void add(const Image& image);
  /// Moves the film from NAME.part.mp4 to its path. Throws Error when it has no picture.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether the path is a film for ffmpeg: it ends in .mp4 or .gif, in lower or upper case.
bool is_film(const std::filesystem::path& file);

/// Whether the program ffmpeg can be found on PATH.
bool has_ffmpeg();

}  // namespace souple::render
