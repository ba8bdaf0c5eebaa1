#include "souple/io/material_file.h"

#include <algorithm>
#include <locale>
#include <sstream>

namespace souple {

namespace {

/// Reads a number in [0, 1]; returns whether there is one.
bool read_share(std::istream& in, float& value) {
  double number = 0;
  if (!(in >> number)) return false;
  value = static_cast<float>(std::clamp(number, 0.0, 1.0));
  return true;
}

}  // namespace

std::map<std::string, FileMaterial> parse_materials(std::string_view text) {
  std::map<std::string, FileMaterial> materials;
  FileMaterial* current = nullptr;
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with('\r')) line.pop_back();
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    std::string key;
    words >> key;
    if (key == "newmtl") {
      std::string name;
      std::getline(words >> std::ws, name);
      current = &materials[name];
    } else if (key == "Kd" && current != nullptr) {
      Vec3f color;
      if (read_share(words, color.x) && read_share(words, color.y) && read_share(words, color.z))
        current->color = color;
    } else if (key == "d" && current != nullptr) {
      float opacity = 1;
      if (read_share(words, opacity)) current->opacity = opacity;
    }
  }
  return materials;
}

}  // namespace souple
