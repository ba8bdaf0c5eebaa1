#include "app/picture_arguments.h"

#include "souple/error.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>

#include <fmt/core.h>

namespace souple::app {

namespace {

[[noreturn]] void refuse(const char* option, std::string_view text, const std::string& expected) {
  throw Error(std::string(option) + " \"" + std::string(text) + "\": expected " + expected);
}

/// Parses the whole text as a number in [lowest, highest].
std::optional<std::uint64_t> whole_number(std::string_view text, std::uint64_t lowest,
                                          std::uint64_t highest) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool good = error == std::errc() && end == text.data() + text.size();
  if (!good || value < lowest || value > highest) return std::nullopt;
  return value;
}

/// "AxB", both in [1, highest].
std::optional<std::pair<int, int>> two_numbers(std::string_view text, std::uint64_t highest) {
  const std::size_t x = text.find('x');
  if (x == std::string_view::npos) return std::nullopt;
  const auto a = whole_number(text.substr(0, x), 1, highest);
  const auto b = whole_number(text.substr(x + 1), 1, highest);
  if (!a || !b) return std::nullopt;
  return std::pair(static_cast<int>(*a), static_cast<int>(*b));
}

/// Splits at spaces and commas.
std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> range(1);
  for (const char c : text) {
    const bool gap = c == ' ' || c == ',' || c == '\t';
    if (!gap) range.back() += c;
    if (gap && !range.back().empty()) range.emplace_back();
  }
  if (range.back().empty()) range.pop_back();
  return range;
}

std::optional<float> number(const std::string& word) {
  char* end = nullptr;
  const float value = std::strtof(word.c_str(), &end);
  if (word.empty() || *end != '\0' || !std::isfinite(value) || std::fabs(value) > 1e6f) return std::nullopt;
  return value;
}

constexpr const char* camera_arguments =
    "\"from X,Y,Z to X,Y,Z fov DEGREES\" or a part of it (meters; 1 < fov < 170), or \"auto\"";

/// Parses the words of --camera one after another.
class CameraReader {
 public:
  explicit CameraReader(std::string_view text) : text_(text), words_(words_of(text)) {}

  CameraRequest read() {
    CameraRequest request;
    if (words_.size() == 1 && words_[0] == "auto") {
      request.automatic = true;
      return request;
    }
    while (at_ < words_.size()) {
      const std::string& key = words_[at_++];
      if (key == "from" && !request.from) {
        request.from = point();
      } else if (key == "to" && !request.to) {
        request.to = point();
      } else if (key == "fov" && !request.fov) {
        request.fov = value();
        if (*request.fov <= 1 || *request.fov >= 170) fail();
      } else {
        fail();
      }
    }
    return request;
  }

 private:
  float value() {
    const std::optional<float> found = at_ < words_.size() ? number(words_[at_++]) : std::nullopt;
    if (!found) fail();
    return *found;
  }
  Vec3f point() {
    const float x = value(), y = value(), z = value();
    return {x, y, z};
  }
  [[noreturn]] void fail() const { refuse("--camera", text_, camera_arguments); }

  std::string_view text_;
  std::vector<std::string> words_;
  std::size_t at_ = 0;
};

[[noreturn]] void refuse_frames(std::string_view text) {
  refuse("--frames", text,
         "N, A-B, A-B/STEP, \"last\" or \"all\"; the first frame is 1, and B may be \"last\"");
}

struct FrameRange {
  std::string_view first, last;  ///< numbers, or "last"
  std::uint64_t step = 1;
};

FrameRange split_frames(std::string_view text) {
  if (text == "all") return {"1", "last"};
  FrameRange range{text, text};
  const std::size_t dash = text.find('-'), slash = text.find('/');
  if (slash != std::string_view::npos) {
    const auto step = whole_number(text.substr(slash + 1), 1, std::uint64_t(1) << 40);
    if (!step || dash == std::string_view::npos || dash > slash) refuse_frames(text);
    range.step = *step;
  }
  if (dash != std::string_view::npos) {
    range.first = text.substr(0, dash);
    range.last = text.substr(dash + 1, slash == std::string_view::npos ? slash : slash - dash - 1);
  }
  return range;
}

}  // namespace

PictureSize parse_size(std::string_view text) {
  const auto size = two_numbers(text, 8192);
  if (!size) refuse("--size", text, "WIDTHxHEIGHT in pixels, each from 1 to 8192, such as 1280x720");
  return {size->first, size->second};
}

SheetShape parse_sheet(std::string_view text) {
  const auto shape = two_numbers(text, 64);
  if (!shape) refuse("--sheet", text, "COLUMNSxROWS, each from 1 to 64, such as 4x3");
  return {shape->first, shape->second};
}

CameraRequest parse_camera(std::string_view text) {
  return CameraReader(text).read();
}

std::uint64_t step_of_frames(std::string_view text) {
  return split_frames(text).step;
}

std::vector<std::uint64_t> parse_frames(std::string_view text, std::uint64_t frames) {
  const FrameRange range = split_frames(text);
  const auto bound = [&](std::string_view word) {
    const auto value = word == "last" ? frames : whole_number(word, 1, std::uint64_t(1) << 40);
    if (!value) refuse_frames(text);
    if (*value > frames) refuse("--frames", text, fmt::format("frames from 1 to {}, the last frame", frames));
    return *value;
  };
  const std::uint64_t first = bound(range.first), last = bound(range.last);
  if (first > last) refuse("--frames", text, "a first frame that is not after the last");
  std::vector<std::uint64_t> chosen;
  for (std::uint64_t frame = first; frame <= last; frame += range.step) chosen.push_back(frame);
  return chosen;
}

}  // namespace souple::app
