#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace souple::mesh_detail {

/// The largest coordinate a file may hold, so that no product of two leaves the floats.
constexpr double largest_coordinate = 1e18;

/// `text` in double quotes, cut to a readable length, what cannot be printed as '?'.
std::string quoted(std::string_view text);

/// `text` in small letters (ASCII only, whatever the locale).
std::string lower_case(std::string_view text);

/// The number that `word` is, all of it. False where it is none, or has no place in a double. NaN and
/// infinity are none. What is too small for a double is 0.
bool parse_real(std::string_view word, double& value);
bool parse_integer(std::string_view word, std::int64_t& value);

/// Walks over the words of a text in memory. A line ends with LF, CR LF or CR.
class TextScanner {
 public:
  struct Rules {
    bool comments = false;         ///< a word that begins with '#' hides the rest of its line
    bool continuations = false;    ///< a '\' before the end of a line joins the next to it
    bool bytes_in_errors = false;  ///< errors name a byte: the text stands between binary numbers
  };

  TextScanner(std::string_view text, const std::string& name, Rules rules, std::size_t first_line = 1,
              std::size_t first_offset = 0);

  /// The next word of this line; empty at its end.
  std::string_view word();
  /// The next word of this line or of a later one; empty at the end of the text.
  std::string_view word_on_any_line();
  /// What is left of this line, without the blanks around it.
  std::string_view rest_of_line();
  /// Moves to the start of the next line; false at the end of the text.
  bool next_line();

  bool at_end() const { return at_ == end_; }
  /// Bytes not read yet.
  std::size_t remaining() const { return std::size_t(end_ - at_); }
  /// Where the next byte stands in the file, whose first `first_offset` bytes stand before the text.
  std::size_t offset() const { return first_offset_ + std::size_t(at_ - begin_); }
  /// The line of the last word, from 1.
  std::size_t line() const { return line_; }

  /// The next word, anywhere, as a number; `what` says what it stands for in the Error.
  double real(const char* what) { return real_from(word_on_any_line(), what); }
  std::int64_t integer(const char* what) { return integer_from(word_on_any_line(), what); }
  /// An integer >= 0 that may count items of at least `bytes_each` bytes in the rest of the text.
  std::size_t count(const char* what, std::size_t bytes_each);
  /// A real within largest_coordinate.
  double coordinate(const char* what) { return coordinate_from(word_on_any_line(), what); }

  double real_from(std::string_view word, const char* what) const;
  double coordinate_from(std::string_view word, const char* what) const;
  std::int64_t integer_from(std::string_view word, const char* what) const;

  /// `word` for an error; where it is empty, "the end of the line" or "the end of the file".
  std::string found(std::string_view word) const;
  /// Throws Error "NAME:LINE: found FOUND, expected EXPECTED" (or "NAME: byte N: ...").
  [[noreturn]] void fail(std::string_view found, std::string_view expected) const;
  [[noreturn]] void fail_at(std::size_t line, std::string_view found, std::string_view expected) const;

 private:
  void skip_blanks();
  bool skip_line_end();
  bool at_continuation() const;

  const char* begin_;
  const char* at_;
  const char* end_;
  std::string name_;
  Rules rules_;
  std::size_t line_;
  std::size_t first_offset_;
};

}  // namespace souple::mesh_detail
