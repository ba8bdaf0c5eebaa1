#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace souple {

/// Selects vertices of an object. API, scenes and program use the same four words, and `all`.
struct Selector {
  struct All {};
  struct Vertices {
    std::vector<std::uint32_t> indices;  ///< user order
  };
  struct InBox {
    Vec3f lo, hi;  ///< world space at the time of the call [m]; includes its boundary
  };
  struct Nearest {
    Vec3f point;  ///< m
  };
  struct Group {
    std::string name;
  };
  std::variant<All, Vertices, InBox, Nearest, Group> choice;
};

inline Selector all() {
  return {Selector::All{}};
}
inline Selector vertices(std::vector<std::uint32_t> indices) {
  return {Selector::Vertices{std::move(indices)}};
}
inline Selector in_box(const Vec3f& lo, const Vec3f& hi) {
  return {Selector::InBox{lo, hi}};
}
inline Selector nearest(const Vec3f& point) {
  return {Selector::Nearest{point}};
}
inline Selector group(std::string name) {
  return {Selector::Group{std::move(name)}};
}

}  // namespace souple
