#pragma once

#include "app/picture_arguments.h"
#include "render/image.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace souple::app {

enum class OutputKind { picture, sheet, film, folder };

/// The kind of output that a path (and --sheet) selects. Throws Error for unknown extensions.
OutputKind output_kind(const std::filesystem::path& out, bool sheet);

/// Output for pictures. Files appear complete: a film and a sheet when they are finished.
class PictureSink {
 public:
  virtual ~PictureSink() = default;
  virtual void add(const render::Image& image, std::uint64_t frame) = 0;
  virtual void finish() = 0;
};

struct SinkRequest {
  OutputKind kind = OutputKind::picture;
  std::filesystem::path out;
  std::string name;              ///< base name of the pictures in a folder: NAME_0012.png
  double film_rate = 60;         ///< pictures per second
  std::uint64_t film_bytes = 0;  ///< largest size of a .webp; 0: any
  SheetShape sheet;
  int colors = 0;  ///< colors of a picture, at most 256; 0: all
};
/// Throws Error, before the first picture, when the output cannot be written or ffmpeg is missing.
std::unique_ptr<PictureSink> open_sink(const SinkRequest& request);

}  // namespace souple::app
