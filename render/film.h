#pragma once

#include "render/image.h"

#include <filesystem>
#include <memory>

namespace souple::render {

/// A film from pictures of one size: .mp4 (H.264), .gif, or a folder of PNG files NAME_0001.png, NAME being
/// the folder's, for any path without such an ending. Films are made by the program ffmpeg.
///
/// An .mp4 has even sides: an odd one gets its last row or column twice. A .gif has at most 50 pictures a
/// second, because players slow down faster ones: of a faster film every second picture is kept, or every
/// third, and so on.
class Film {
 public:
  /// Throws Error when ffmpeg is missing (with the package that brings it) or the file cannot be written.
  Film(std::filesystem::path file, double frame_rate);
  /// Finishes, silently; a film that failed or has no picture leaves nothing behind.
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// Throws Error when the size is not that of the first, or ffmpeg failed: with its last message.
  void add(const Image& image);
  /// The film is at its path from here on (before, it is NAME.part.mp4). Throws Error when it has no picture.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether the path means a film for ffmpeg: it ends in .mp4 or .gif, in small or capital letters.
bool is_film(const std::filesystem::path& file);

/// Whether the program ffmpeg can be found on PATH.
bool has_ffmpeg();

}  // namespace souple::render
