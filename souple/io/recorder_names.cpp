#include "souple/io/recorder_names.h"

#include "souple/files/file.h"

#include <algorithm>

#include <fmt/core.h>

namespace souple {

namespace {

constexpr std::size_t longest_name = 100;  // bytes; file systems allow 255, including suffixes

bool is_safe(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= 0x20 && byte != 0x7f && std::string_view("/\\:*?\"<>|").find(c) == std::string_view::npos;
}

/// Truncates to `longest` bytes, between two characters of UTF-8.
std::string cut(std::string text, std::size_t longest) {
  if (text.size() <= longest) return text;
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;
  text.resize(end);
  return text;
}

bool ends_like_a_frame(const std::string& text) {
  std::size_t at = text.size();
  while (at > 0 && text[at - 1] >= '0' && text[at - 1] <= '9') --at;
  return text.size() - at >= 4 && at > 0 && text[at - 1] == '_';
}

}  // namespace

std::string safe_file_name(std::string_view name) {
  std::string safe(name);
  std::replace_if(
      safe.begin(), safe.end(), [](char c) { return !is_safe(c); }, '_');
  safe = cut(std::move(safe), longest_name);
  if (safe.empty()) safe = "object";
  if (safe.front() == '.') safe.front() = '_';
  // Windows removes trailing dots and blanks.
  if (safe.back() == '.' || safe.back() == ' ') safe.back() = '_';
  if (ends_like_a_frame(safe)) safe += '_';
  return safe;
}

std::string FileNames::add(std::string_view name) {
  const std::string base = safe_file_name(name);
  std::string free = base;
  for (int number = 2; !taken_.insert(lower_case(free)).second; ++number)
    free = fmt::format("{}-{}", base, number);
  return free;
}

}  // namespace souple
