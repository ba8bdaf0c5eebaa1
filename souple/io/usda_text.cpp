#include "souple/io/usda_text.h"

#include <algorithm>
#include <iterator>

#include <fmt/core.h>

namespace souple::usda {

namespace {

/// "[", the text of each item, "]".
template <class Items, class Put>
std::string list(const Items& items, const Put& put) {
  std::string text = "[";
  const char* between = "";
  for (const auto& item : items) {
    text += between;
    put(std::back_inserter(text), item);
    between = ", ";
  }
  return text += "]";
}

}  // namespace

std::string exact(std::span<const Vec3f> values) {
  return list(values, [](auto out, const Vec3f& x) { fmt::format_to(out, "({}, {}, {})", x.x, x.y, x.z); });
}

std::string rounded(std::span<const Vec3f> values, int digits) {
  return list(values, [digits](auto out, const Vec3f& x) {
    // Without 0: the sign of zeros would only make them longer.
    fmt::format_to(out, "({:.{}g}, {:.{}g}, {:.{}g})", x.x + 0, digits, x.y + 0, digits, x.z + 0, digits);
  });
}

std::string pairs(std::span<const std::array<float, 2>> values) {
  return list(values, [](auto out, const auto& uv) { fmt::format_to(out, "({}, {})", uv[0], uv[1]); });
}

std::string integers(std::span<const std::uint32_t> values) {
  return list(values, [](auto out, std::uint32_t value) { fmt::format_to(out, "{}", value); });
}

std::string repeated(std::size_t count, std::uint32_t value) {
  const std::vector<std::uint32_t> values(count, value);
  return integers(values);
}

std::string extent(std::span<const Vec3f> positions, float radius) {
  Vec3f lo{}, hi{};
  if (!positions.empty()) lo = hi = positions[0];
  for (const Vec3f& x : positions) {
    lo = {std::min(lo.x, x.x), std::min(lo.y, x.y), std::min(lo.z, x.z)};
    hi = {std::max(hi.x, x.x), std::max(hi.y, x.y), std::max(hi.z, x.z)};
  }
  const Vec3f around{radius, radius, radius};
  const std::array<Vec3f, 2> box{lo - around, hi + around};
  return exact(box);
}

std::string string_text(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    const bool control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    result += control ? ' ' : c;
  }
  return result += '"';
}

std::string PrimNames::add(std::string_view name) {
  std::string stem;
  for (const char c : name) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    const bool digit = c >= '0' && c <= '9';
    if (digit && stem.empty()) stem = "_";
    stem += letter || digit ? c : '_';
  }
  if (stem.empty()) stem = "_";
  std::string result = stem;
  for (int copy = 2; !taken_.insert(result).second; ++copy) result = fmt::format("{}_{}", stem, copy);
  return result;
}

}  // namespace souple::usda
