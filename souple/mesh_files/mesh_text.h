#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace souple::mesh_detail {

/// The largest valid coordinate in a file: a product of two fits into a float.
constexpr double largest_coordinate = 1e18;

/// `text` in double quotes, truncated to a readable length, with '?' for unprintable characters.
std::string quoted(std::string_view text);

/// Parses the whole `word` as a number. Returns false if it is none, is NaN or infinite, or exceeds the range
/// of a double. A number too small for a double becomes 0.
bool parse_real(std::string_view word, double& value);
bool parse_integer(std::string_view word, std::int64_t& value);

/// Reads the words of a text in memory. A line ends with LF, CR LF or CR.
class TextScanner {
 public:
  struct Rules {
    bool comments = false;       ///< a word that begins with '#' starts a comment up to the end of the line
    bool continuations = false;  ///< a '\' at the end of a line joins it with the next line
    bool bytes_in_errors =
        false;  ///< errors give a byte offset instead of a line: text between binary numbers
  };

  TextScanner(std::string_view text, const std::string& name, Rules rules, std::size_t first_line = 1,
              std::size_t first_offset = 0);

  /// The next word of this line; empty at its end.
  std::string_view word();
  /// The next word of this line or of a later one; empty at the end of the text.
  std::string_view word_on_any_line();
  /// The rest of this line, without surrounding blanks.
  std::string_view rest_of_line();
  /// Moves to the start of the next line; false at the end of the text.
  bool next_line();

  bool at_end() const { return at_ == end_; }
  /// Number of unread bytes.
  std::size_t remaining() const { return std::size_t(end_ - at_); }
  /// Offset of the next byte in the file; the text begins at `first_offset`.
  std::size_t offset() const { return first_offset_ + std::size_t(at_ - begin_); }
  /// The line of the last word, from 1.
  std::size_t line() const { return line_; }

  /// The next word of any line as a number; `what` names it in the Error.
  double real(const char* what) { return real_from(word_on_any_line(), what); }
  std::int64_t integer(const char* what) { return integer_from(word_on_any_line(), what); }
  /// An integer >= 0 that may count items of at least `bytes_each` bytes in the rest of the text.
  std::size_t count(const char* what, std::size_t bytes_each);
  /// Throws Error unless the rest of the text can hold `count` items of at least `bytes_each`.
  void require_room(std::uint64_t count, std::size_t bytes_each, const char* what) const;
  /// A real within largest_coordinate.
  double coordinate(const char* what) { return coordinate_from(word_on_any_line(), what); }

  double real_from(std::string_view word, const char* what) const;
  double coordinate_from(std::string_view word, const char* what) const;
  std::int64_t integer_from(std::string_view word, const char* what) const;

  /// `word` for an error message; if it is empty, "the end of the line" or "the end of the file".
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
