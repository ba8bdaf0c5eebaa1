#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

// Command-line options of pictures. Every function throws Error with the invalid word and the expected one.

namespace souple::app {

struct PictureSize {
  int width = 0, height = 0;  ///< pixels
};
/// "1280x720"; each side in [1, 8192].
PictureSize parse_size(std::string_view text);

struct SheetShape {
  int columns = 0, rows = 0;
};
/// "4x3"; each side in [1, 64].
SheetShape parse_sheet(std::string_view text);

/// Camera options; empty ones come from the scene.
struct CameraWish {
  std::optional<Vec3f> from, to;  ///< m
  std::optional<float> fov;       ///< vertical [degrees]
  bool automatic = false;         ///< fit all objects into the picture
};
/// "from 1,2,3 to 0,1,0 fov 30", any of its parts in any order, "auto", or an empty text.
CameraWish parse_camera(std::string_view text);

/// The selected frames of 1 to `frames`, ascending: "120", "last", "10-50", "10-last/5", "all".
std::vector<std::uint64_t> parse_frames(std::string_view text, std::uint64_t frames);
/// The step of a frame selection: 5 for "10-last/5"; 1 by default.
std::uint64_t step_of_frames(std::string_view text);

}  // namespace souple::app
