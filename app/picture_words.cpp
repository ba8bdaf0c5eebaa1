#include "app/picture_words.h"

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

/// Parses the whole text as an integer in [lowest, highest].
std::optional<std::uint64_t> whole_number(std::string_view text, std::uint64_t lowest,
                                          std::uint64_t highest) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool good = error == std::errc() && end == text.data() + text.size();
  if (!good || value < lowest || value > highest) return std::nullopt;
  return value;
}

/// Parses "AxB", both in [1, highest].
std::optional<std::pair<int, int>> two_numbers(std::string_view text, std::uint64_t highest) {
  const std::size_t x = text.find('x');
  if (x == std::string_view::npos) return std::nullopt;
  const auto a = whole_number(text.substr(0, x), 1, highest);
  const auto b = whole_number(text.substr(x + 1), 1, highest);
  if (!a || !b) return std::nullopt;
  return std::pair(static_cast<int>(*a), static_cast<int>(*b));
}

/// The words between spaces and commas.
std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    const bool gap = c == ' ' || c == ',' || c == '\t';
    if (!gap) words.back() += c;
    if (gap && !words.back().empty()) words.emplace_back();
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

std::optional<float> number(const std::string& word) {
  char* end = nullptr;
  const float value = std::strtof(word.c_str(), &end);
  if (word.empty() || *end != '\0' || !std::isfinite(value) || std::fabs(value) > 1e6f) return std::nullopt;
  return value;
}

constexpr const char* camera_words =
    "\"from X,Y,Z to X,Y,Z fov DEGREES\" or a part of it (meters; 1 < fov < 170), or \"auto\"";

/// Parses the words of a camera in order.
class CameraReader {
 public:
  explicit CameraReader(std::string_view text) : text_(text), words_(words_of(text)) {}

  CameraWish read() {
    CameraWish wish;
    if (words_.size() == 1 && words_[0] == "auto") {
      wish.automatic = true;
      return wish;
    }
    while (at_ < words_.size()) {
      const std::string& key = words_[at_++];
      if (key == "from" && !wish.from) {
        wish.from = point();
      } else if (key == "to" && !wish.to) {
        wish.to = point();
      } else if (key == "fov" && !wish.fov) {
        wish.fov = value();
        if (*wish.fov <= 1 || *wish.fov >= 170) fail();
      } else {
        fail();
      }
    }
    return wish;
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
  [[noreturn]] void fail() const { refuse("--camera", text_, camera_words); }

  std::string_view text_;
  std::vector<std::string> words_;
  std::size_t at_ = 0;
};

[[noreturn]] void refuse_frames(std::string_view text) {
  refuse("--frames", text,
         "N, A-B, A-B/STEP, \"last\" or \"all\"; the first frame is 1, and B may be \"last\"");
}

struct FrameWords {
  std::string_view first, last;  ///< numbers, or "last"
  std::uint64_t step = 1;
};

FrameWords split_frames(std::string_view text) {
  if (text == "all") return {"1", "last"};
  FrameWords words{text, text};
  const std::size_t dash = text.find('-'), slash = text.find('/');
  if (slash != std::string_view::npos) {
    const auto step = whole_number(text.substr(slash + 1), 1, std::uint64_t(1) << 40);
    if (!step || dash == std::string_view::npos || dash > slash) refuse_frames(text);
    words.step = *step;
  }
  if (dash != std::string_view::npos) {
    words.first = text.substr(0, dash);
    words.last = text.substr(dash + 1, slash == std::string_view::npos ? slash : slash - dash - 1);
  }
  return words;
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

CameraWish parse_camera(std::string_view text) {
  return CameraReader(text).read();
}

std::uint64_t step_of_frames(std::string_view text) {
  return split_frames(text).step;
}

std::vector<std::uint64_t> parse_frames(std::string_view text, std::uint64_t frames) {
  const FrameWords words = split_frames(text);
  const auto bound = [&](std::string_view word) {
    const auto value = word == "last" ? frames : whole_number(word, 1, std::uint64_t(1) << 40);
    if (!value) refuse_frames(text);
    if (*value > frames)
      refuse("--frames", text, fmt::format("frames from 1 to {}: there are no more", frames));
    return *value;
  };
  const std::uint64_t first = bound(words.first), last = bound(words.last);
  if (first > last) refuse("--frames", text, "the first frame before the last");
  std::vector<std::uint64_t> chosen;
  for (std::uint64_t frame = first; frame <= last; frame += words.step) chosen.push_back(frame);
  return chosen;
}

}  // namespace souple::app
