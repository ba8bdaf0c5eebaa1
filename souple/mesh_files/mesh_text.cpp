#include "souple/mesh_files/mesh_text.h"

#include "souple/error.h"
#include "souple/mesh_files/number_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/core.h>

namespace souple::mesh_detail {

namespace {

constexpr std::size_t longest_quote = 16;

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}

}  // namespace

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (char c : text.substr(0, longest_quote)) result += (c >= ' ' && c <= '~') ? c : '?';
  if (text.size() > longest_quote) result += "...";
  return result + "\"";
}

bool parse_real(std::string_view word, double& value) {
  if (!word.empty() && word[0] == '+') word.remove_prefix(1);
  if (word.empty() || word[0] == '+') return false;
  const bool negative = word[0] == '-';
  if (negative) word.remove_prefix(1);
  if (word.empty() || word[0] == '-') return false;
  if (!parse_unsigned_real(word, value)) return false;
  if (negative) value = -value;
  return true;
}

bool parse_integer(std::string_view word, std::int64_t& value) {
  if (!word.empty() && word[0] == '+') {
    word.remove_prefix(1);
    if (!word.empty() && word[0] == '-') return false;
  }
  const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && !word.empty() && rest == word.data() + word.size();
}

TextScanner::TextScanner(std::string_view text, const std::string& name, Rules rules, std::size_t first_line,
                         std::size_t first_offset)
    : begin_(text.data()),
      at_(text.data()),
      end_(text.data() + text.size()),
      name_(name),
      rules_(rules),
      line_(first_line),
      first_offset_(first_offset) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (text.substr(0, byte_order_mark.size()) == byte_order_mark) at_ += byte_order_mark.size();
}

bool TextScanner::at_continuation() const {
  return rules_.continuations && *at_ == '\\' && at_ + 1 != end_ && is_line_end(at_[1]);
}

bool TextScanner::skip_line_end() {
  if (at_ == end_ || !is_line_end(*at_)) return false;
  const bool two = *at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n';
  at_ += two ? 2 : 1;
  ++line_;
  return true;
}

void TextScanner::skip_blanks() {
  while (at_ != end_) {
    if (is_blank(*at_)) {
      ++at_;
    } else if (at_continuation()) {
      ++at_;
      skip_line_end();
    } else {
      break;
    }
  }
  if (rules_.comments && at_ != end_ && *at_ == '#') {
    while (at_ != end_ && !is_line_end(*at_)) ++at_;
  }
}

std::string_view TextScanner::word() {
  skip_blanks();
  const char* begin = at_;
  while (at_ != end_ && !is_blank(*at_) && !is_line_end(*at_) && !at_continuation()) ++at_;
  return {begin, std::size_t(at_ - begin)};
}

std::string_view TextScanner::word_on_any_line() {
  std::string_view result = word();
  while (result.empty() && skip_line_end()) result = word();
  return result;
}

std::string_view TextScanner::rest_of_line() {
  while (at_ != end_ && is_blank(*at_)) ++at_;
  const char* begin = at_;
  while (at_ != end_ && !is_line_end(*at_)) ++at_;
  const char* end = at_;
  while (end != begin && is_blank(end[-1])) --end;
  return {begin, std::size_t(end - begin)};
}

bool TextScanner::next_line() {
  while (at_ != end_ && !is_line_end(*at_)) ++at_;
  skip_line_end();
  return at_ != end_;
}

double TextScanner::real_from(std::string_view word, const char* what) const {
  double value = 0.0;
  if (!parse_real(word, value)) fail(found(word), std::string("a number (") + what + ")");
  return value;
}

double TextScanner::coordinate_from(std::string_view word, const char* what) const {
  const double value = real_from(word, what);
  if (std::abs(value) > largest_coordinate) {
    fail(found(word), std::string("a number within 1e18 (") + what + ")");
  }
  return value;
}

std::int64_t TextScanner::integer_from(std::string_view word, const char* what) const {
  std::int64_t value = 0;
  if (!parse_integer(word, value)) fail(found(word), std::string("an integer (") + what + ")");
  return value;
}

std::size_t TextScanner::count(const char* what, std::size_t bytes_each) {
  const std::int64_t value = integer(what);
  if (value < 0) fail(fmt::format("{}", value), fmt::format("an integer >= 0 ({})", what));
  require_room(std::uint64_t(value), bytes_each, what);
  return std::size_t(value);
}

void TextScanner::require_room(std::uint64_t count, std::size_t bytes_each, const char* what) const {
  // The last item of a text needs no blank after it.
  const std::size_t room = (remaining() + 1) / bytes_each;
  if (count > room) {
    fail(fmt::format("{} ({})", count, what),
         fmt::format("at most {}, for which the file is long enough; it is cut short or its count is wrong",
                     room));
  }
}

std::string TextScanner::found(std::string_view word) const {
  if (!word.empty()) return quoted(word);
  return at_end() ? "the end of the file" : "the end of the line";
}

void TextScanner::fail(std::string_view found, std::string_view expected) const {
  fail_at(line_, found, expected);
}

void TextScanner::fail_at(std::size_t line, std::string_view found, std::string_view expected) const {
  const std::string place =
      rules_.bytes_in_errors ? fmt::format(": byte {}", offset()) : fmt::format(":{}", line);
  throw Error(fmt::format("{}{}: found {}, expected {}", name_, place, found, expected));
}

}  // namespace souple::mesh_detail
