#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace souple::scene_format {

struct Member;

/// A JSON value. Members keep the order of the file; a parsed object has no duplicate keys.
struct Json {
  enum class Kind { null, boolean, number, text, array, object };

  Kind kind = Kind::null;
  bool boolean = false;
  double number = 0;
  bool integral = false;  ///< the number was written without a fraction or exponent
  std::string text;
  std::vector<Json> items;
  std::vector<Member> members;

  static Json of(bool value);
  static Json of(double value);
  /// The shortest decimal that parses to this float.
  static Json of(float value);
  static Json whole(std::int64_t value);
  static Json of(std::string value);
  static Json of(const char* value);
  static Json array();
  static Json array(std::vector<Json> items);
  static Json object();
  static Json object(std::vector<Member> members);

  bool is(Kind wanted) const { return kind == wanted; }
  /// The member of this name, or nullptr.
  const Json* find(std::string_view key) const;
  Json* find(std::string_view key);
  /// Appends a member, or replaces the member of this name.
  Json& set(std::string key, Json value);
};

struct Member {
  std::string key;
  Json value;
};

/// Values are equal if their text is equal.
bool operator==(const Json& a, const Json& b);

/// Parses one JSON text strictly: UTF-8, no comments, no trailing commas or garbage, no duplicate keys. It may be at
/// most 64 levels deep, with numbers within the range of double. Throws Error: `source:line:column: ...`.
Json parse_json(std::string_view text, std::string_view source);

/// Writes JSON on several lines, with short values on one line. Ends with a line feed.
std::string dump_json(const Json& value);
/// Writes JSON on one line.
std::string dump_line(const Json& value);
/// `dump_line`, truncated for messages.
std::string brief(const Json& value);
std::string number_text(double value);

}  // namespace souple::scene_format
