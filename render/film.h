#pragma once

#include "render/ffmpeg.h"
#include "render/image.h"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace souple::render {

/// A film from pictures of equal size: .mp4 (H.264), .gif or .webp, encoded by the program ffmpeg.
///
/// An .mp4 has even sides: at an odd size the last row or column is doubled. A .gif and a .webp repeat forever.
class Film {
 public:
  using Interrupted = Ffmpeg::Interrupted;

  /// Throws Error when ffmpeg is missing (and names its package) or has no encoder for a .webp. Throws it as well when
  /// the file cannot be written, is no film, or would have more than `highest_rate` pictures a second. Once `interrupted`
  /// returns true, an ffmpeg that neither reads nor computes for two seconds is ended, and the film has failed. Without
  /// it the film waits for any ffmpeg. `max_bytes` is the largest size of a .webp, whose quality is chosen to fit; 0:
  /// quality 75, any size.
  Film(std::filesystem::path file, double frame_rate, Interrupted interrupted = {},
       std::uint64_t max_bytes = 0);
  /// Finishes the film without exceptions; a film that failed or has no picture leaves no file.
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// Throws Error when the size differs from the first picture's, or, with ffmpeg's last message, when ffmpeg
  /// failed.
  void add(const Image& image);
  /// Moves the film from NAME.part.mp4 to its path. Throws Error when it has no picture, or does not fit into
  /// `max_bytes` at the lowest quality.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether the path is a film for ffmpeg: it ends in .mp4, .gif or .webp, in lower or upper case.
bool is_film(const std::filesystem::path& file);

/// Pictures a second that browsers show at most: 50 of a .gif, 60 of a .webp; of an .mp4 infinity.
double highest_rate(const std::filesystem::path& film);

}  // namespace souple::render
