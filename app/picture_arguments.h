#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

// Arguments of the command line that describe pictures. Every function throws Error that repeats the argument
// and names the expected form.

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

/// Values that are not set come from the scene.
struct CameraRequest {
  std::optional<Vec3f> from, to;  ///< m
  std::optional<float> fov;       ///< vertical [degrees]
  bool automatic = false;         ///< frame all objects
};
/// "from 1,2,3 to 0,1,0 fov 30", any part of it in any order, "auto", or nothing.
CameraRequest parse_camera(std::string_view text);

/// Selected frames out of 1 to `frames`, ascending, from "120", "last", "10-50", "10-last/5" or "all".
std::vector<std::uint64_t> parse_frames(std::string_view text, std::uint64_t frames);
/// The step of such an argument: 5 for "10-last/5", 1 where none is given.
std::uint64_t step_of_frames(std::string_view text);

}  // namespace souple::app
