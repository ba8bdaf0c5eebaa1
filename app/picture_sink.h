#pragma once

#include "app/picture_words.h"
#include "render/image.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace souple::app {

enum class OutputKind { picture, sheet, film, folder };

/// The output kind for a path and --sheet. Throws Error for unsupported endings.
OutputKind output_kind(const std::filesystem::path& out, bool sheet);

/// Destination of pictures. Files appear completely: a film and a sheet when they are finished.
class PictureSink {
 public:
  virtual ~PictureSink() = default;
  virtual void add(const render::Image& image, std::uint64_t frame) = 0;
  virtual void finish() = 0;
};

struct SinkWish {
  OutputKind kind = OutputKind::picture;
  std::filesystem::path out;
  std::string name;       ///< prefix of the pictures in a folder: NAME_0012.png
  double film_rate = 60;  ///< pictures per second
  SheetShape sheet;
  int colors = 0;  ///< colors of a picture's palette, at most 256; 0: full color
};
/// Throws Error, before any picture, if the destination cannot be written or ffmpeg is missing.
std::unique_ptr<PictureSink> open_sink(const SinkWish& wish);

}  // namespace souple::app
