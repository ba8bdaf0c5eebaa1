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

/// What a path (and --sheet) ask for. Throws Error for endings that are none of ours.
OutputKind output_kind(const std::filesystem::path& out, bool sheet);

/// Where pictures go. Files appear whole: a film and a sheet when they are finished.
class PictureSink {
 public:
  virtual ~PictureSink() = default;
  virtual void add(const render::Image& image, std::uint64_t frame) = 0;
  virtual void finish() = 0;
};

struct SinkWish {
  OutputKind kind = OutputKind::picture;
  std::filesystem::path out;
  std::string name;       ///< of the pictures in a folder: NAME_0012.png
  double film_rate = 60;  ///< pictures a second
  SheetShape sheet;
  int colors = 0;  ///< of pictures, at most 256; 0: all
};
/// Throws Error, before there is any picture, when nothing can be written there or ffmpeg is missing.
std::unique_ptr<PictureSink> open_sink(const SinkWish& wish);

}  // namespace souple::app
