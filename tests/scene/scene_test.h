#pragma once

#include "souple/scene/scene.h"
#include "tests/expect_error.h"
#include "tests/paths.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::scene_test {

inline std::filesystem::path scenes_folder() {
  return source_path("scenes");
}

inline std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

inline std::vector<std::filesystem::path> shipped_scenes() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(scenes_folder())) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The error message of parsing `text`; empty if parsing succeeds.
inline std::string error_message(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return error_of([&] { parse_scene(text, scenes_folder(), "test.json", overrides); });
}

/// A scene of one object with these keys.
inline std::string with_object(const std::string& keys) {
  return R"({"souple": 1, "objects": [{)" + keys + "}]}";
}

/// One simple object of each kind.
inline const char* small_scene = R"({
  "souple": 1, "frames": 10,
  "objects": [
    {"name": "flag", "kind": "cloth", "mesh": {"grid": {"columns": 6, "rows": 5, "size": 1.0}},
     "transform": {"translate": [0, 2, 0], "rotate": [90, 0, 0]}, "material": {"preset": "silk", "damping": 0.25},
     "pins": [{"vertices": [0, 5]}]},
    {"kind": "soft_body", "mesh": {"tet_bar": {"cells": [2, 1, 1], "size": [0.2, 0.1, 0.1]}}},
    {"kind": "rope", "points": [[0, 1, 0], [1, 1, 0]], "segments": 8},
    {"kind": "grains", "grid": {"counts": [2, 3, 4]}, "transform": {"translate": [2, 1, 0]}}
  ],
  "colliders": [{"shape": {"plane": {}}}, {"name": "ball", "shape": {"sphere": {"radius": 0.3}}}]
})";

}  // namespace souple::scene_test
