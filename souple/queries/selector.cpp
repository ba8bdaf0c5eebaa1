#include "souple/queries/selector.h"

#include <utility>

namespace souple {

Selector all() {
  return {Selector::All{}};
}

Selector vertices(std::vector<std::uint32_t> indices) {
  return {Selector::Vertices{std::move(indices)}};
}

Selector in_box(const Vec3f& lo, const Vec3f& hi) {
  return {Selector::InBox{lo, hi}};
}

Selector nearest(const Vec3f& point) {
  return {Selector::Nearest{point}};
}

Selector group(std::string name) {
  return {Selector::Group{std::move(name)}};
}

}  // namespace souple
