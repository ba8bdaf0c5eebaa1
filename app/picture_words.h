#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

// How pictures are asked for on the command line. Every function throws Error that repeats the word and says
// what was expected.

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

/// What is not given comes from the scene.
struct CameraWish {
  std::optional<Vec3f> from, to;  ///< m
  std::optional<float> fov;       ///< vertical [degrees]
  bool automatic = false;         ///< all objects fill the picture
};
/// "from 1,2,3 to 0,1,0 fov 30", any part of it in any order, "auto", or nothing.
CameraWish parse_camera(std::string_view text);

/// Which of the frames 1 to `frames` are meant, ascending: "120", "last", "10-50", "10-last/5", "all".
std::vector<std::uint64_t> parse_frames(std::string_view text, std::uint64_t frames);
/// The step of such a word: 5 of "10-last/5", 1 where none is given.
std::uint64_t step_of_frames(std::string_view text);

}  // namespace souple::app
