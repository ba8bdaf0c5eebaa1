#pragma once

#include "render/image.h"

#include <filesystem>
#include <memory>

namespace souple::render {

/// A film from pictures of one size: .mp4 (H.264), .gif, or, for any other path, a folder of PNG files
/// NAME_0001.png with the folder's NAME. The program ffmpeg encodes films.
///
/// An .mp4 needs even sides: an odd one gets its last row or column twice. A .gif has at most 50 pictures per
/// second, because players slow down faster ones: of a faster film every second picture, or every third, and
/// so on, is kept.
class Film {
 public:
  /// Throws Error if ffmpeg is missing (the message names its package) or the file cannot be written.
  Film(std::filesystem::path file, double frame_rate);
  /// Finishes and ignores failures; a failed film, or one without pictures, leaves no file.
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// Throws Error if the size differs from the first picture's, or with ffmpeg's last message if ffmpeg
  /// failed.
  void add(const Image& image);
  /// Renames the film from NAME.part.mp4 to its path. Throws Error if it has no picture.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether the path is that of a film for ffmpeg: it ends in .mp4 or .gif, in any letter case.
bool is_film(const std::filesystem::path& file);

/// Whether the program ffmpeg is on PATH.
bool has_ffmpeg();

}  // namespace souple::render
