#pragma once

#include "souple/error.h"
#include "souple/math/vec3.h"
#include "souple/scene/json.h"
#include "souple/scene/nearest.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

// A codec defines one kind of JSON value: reading into C++, writing back, and its description in the schema
// and the manual. So reader, writer, schema and manual cannot disagree.

namespace souple::scene_format {

/// Context of the scene being read.
struct Reading {
  std::string source;          ///< name of the scene in messages
  std::filesystem::path base;  ///< base folder of relative files
  bool files_exist = true;     ///< whether files must exist
};

/// Path of a value in a scene. Lives on the reader's stack; the text is built only for messages.
class JsonPath {
 public:
  explicit JsonPath(const Reading& reading) : reading_(&reading) {}
  JsonPath key(std::string_view name) const { return JsonPath(*this, name, 0); }
  JsonPath item(std::size_t index) const { return JsonPath(*this, {}, index); }

  const Reading& reading() const { return *reading_; }
  /// `objects[2].material.density`
  std::string to_string() const;
  /// Throws Error: `file: path: message`.
  [[noreturn]] void fail(const std::string& message) const;
  [[noreturn]] void unexpected(const std::string& expected, const Json& found) const {
    fail("expected " + expected + ", found " + brief(found));
  }
  [[noreturn]] void fail_length(std::size_t min_count, std::size_t max_count, std::size_t found) const;

 private:
  JsonPath(const JsonPath& parent, std::string_view name, std::size_t index)
      : reading_(parent.reading_), parent_(&parent), name_(name), index_(index) {}

  const Reading* reading_;
  const JsonPath* parent_ = nullptr;
  std::string_view name_;
  std::size_t index_ = 0;
};

/// Description of a key for the manual and the schema.
struct KeyInfo {
  std::string name, type, doc;
  bool required = false;
  std::optional<Json> fallback;  ///< default value
  Json schema;
};

/// Description of a JSON object for the manual and the schema.
struct TableInfo {
  std::string name, doc;
  std::vector<KeyInfo> keys;
  std::vector<std::vector<std::string>> exactly_one, at_most_one;  ///< rules for these lists of keys
  std::vector<std::pair<std::string, std::string>> needs;          ///< the first key requires the second
};

struct Format {
  std::vector<std::unique_ptr<TableInfo>> tables;
};

struct TypeInfo {
  std::string text;  ///< type in the manual, Markdown
  Json schema;
};

/// A codec with its type erased, for tables: templates per key would cost half a minute of compilation.
class AnyCodec {
 public:
  virtual ~AnyCodec() = default;
  virtual void read_any(const Json& json, const JsonPath& path, void* value) const = 0;
  virtual Json write_any(const void* value) const = 0;
  /// Adds the tables that the type refers to.
  virtual TypeInfo describe(Format& format) const = 0;
};
using AnyCodecPtr = std::shared_ptr<const AnyCodec>;

template <class T>
class Codec : public AnyCodec {
 public:
  virtual void read(const Json& json, const JsonPath& path, T& value) const = 0;
  virtual Json write(const T& value) const = 0;
  void read_any(const Json& json, const JsonPath& path, void* value) const final {
    read(json, path, *static_cast<T*>(value));
  }
  Json write_any(const void* value) const final { return write(*static_cast<const T*>(value)); }
};
template <class T>
using CodecPtr = std::shared_ptr<const Codec<T>>;

// --- numbers ---------------------------------------------------------------------------------------------

/// Allowed numbers. Every range is bounded: a huge number is a typing error.
struct Range {
  double lowest, highest;
  bool open_low = false;   ///< excludes `lowest`
  bool open_high = false;  ///< excludes `highest`

  bool contains(double x) const {
    return (open_low ? x > lowest : x >= lowest) && (open_high ? x < highest : x <= highest);
  }
  /// `number > 0 and <= 1000`
  std::string text(const std::string& noun) const;
  Json schema(const char* type) const;
};
constexpr Range positive(double highest) {
  return {0, highest, true, false};
}
constexpr Range from_zero(double highest) {
  return {0, highest};
}
constexpr Range within(double lowest, double highest) {
  return {lowest, highest};
}
/// From zero to below `highest`.
constexpr Range below(double highest) {
  return {0, highest, false, true};
}
/// Either sign, for coordinates and speeds.
constexpr Range signed_range(double highest) {
  return {-highest, highest};
}

template <class T>
class Number : public Codec<T> {
 public:
  explicit Number(const Range& range) : range_(range) {}

  void read(const Json& json, const JsonPath& path, T& value) const override {
    const std::string noun = std::is_integral_v<T> ? "a whole number" : "a number";
    if (!json.is(Json::Kind::number)) path.unexpected(range_.text(noun), json);
    const bool whole = !std::is_integral_v<T> || std::floor(json.number) == json.number;
    if (!whole || !range_.contains(json.number)) path.unexpected(range_.text(noun), json);
    const T converted = static_cast<T>(json.number);
    // A float may round to an excluded bound.
    if (!range_.contains(static_cast<double>(converted))) path.unexpected(range_.text(noun), json);
    value = converted;
  }
  Json write(const T& value) const override {
    if constexpr (std::is_integral_v<T>) {
      return Json::whole(static_cast<std::int64_t>(value));
    } else {
      return Json::of(value);
    }
  }
  TypeInfo describe(Format&) const override {
    return {range_.text(std::is_integral_v<T> ? "whole number" : "number"),
            range_.schema(std::is_integral_v<T> ? "integer" : "number")};
  }

 private:
  Range range_;
};
template <class T>
CodecPtr<T> number(const Range& range) {
  return std::make_shared<Number<T>>(range);
}

/// The schema of a list with this number of items.
Json list_schema(Json item, std::size_t min_count, std::size_t max_count);

template <class T>
class Vector3 : public Codec<Vec3<T>> {
 public:
  explicit Vector3(const Range& range) : number_(range), range_(range) {}

  void read(const Json& json, const JsonPath& path, Vec3<T>& value) const override {
    if (!json.is(Json::Kind::array) || json.items.size() != 3) path.unexpected("[x, y, z]", json);
    Vec3<T> read{};
    for (std::size_t i = 0; i < 3; ++i) number_.read(json.items[i], path.item(i), read[static_cast<int>(i)]);
    value = read;
  }
  Json write(const Vec3<T>& value) const override {
    return Json::array({Json::of(value.x), Json::of(value.y), Json::of(value.z)});
  }
  TypeInfo describe(Format&) const override {
    const Json schema = list_schema(range_.schema("number"), 3, 3);
    const bool plain = range_.lowest < 0;
    return {plain ? "[x, y, z]" : "[x, y, z], each a " + range_.text("number"), schema};
  }

 private:
  Number<T> number_;
  Range range_;
};
template <class T>
CodecPtr<Vec3<T>> vector3(const Range& range) {
  return std::make_shared<Vector3<T>>(range);
}

// Compiled once, in codec.cpp: every table uses some of these.
extern template class Number<double>;
extern template class Number<float>;
extern template class Number<int>;
extern template class Number<std::uint32_t>;
extern template class Vector3<double>;
extern template class Vector3<float>;
extern template CodecPtr<double> number(const Range& range);
extern template CodecPtr<float> number(const Range& range);
extern template CodecPtr<int> number(const Range& range);
extern template CodecPtr<std::uint32_t> number(const Range& range);
extern template CodecPtr<Vec3d> vector3(const Range& range);
extern template CodecPtr<Vec3f> vector3(const Range& range);

// --- text ------------------------------------------------------------------------------------------------

CodecPtr<bool> boolean();
/// Any text of at most this number of characters.
CodecPtr<std::string> text(std::size_t max_length = 1000);
/// "#rrggbb", sRGB as in HTML, to 0xRRGGBB.
CodecPtr<std::uint32_t> color();
/// The name of an object or collider, also used in file names: letters, digits, _ and -, at most 64 characters.
CodecPtr<std::string> name();
/// An existing file, relative to the scene.
CodecPtr<std::string> file();
/// An existing file or folder, relative to the scene.
CodecPtr<std::string> file_or_folder();
/// One word of the list `known`; `noun` names its kind in messages, e.g. "preset".
CodecPtr<std::string> word(std::string noun, std::vector<std::string> known);

template <class E>
class Enumeration : public Codec<E> {
 public:
  explicit Enumeration(std::vector<std::pair<std::string, E>> words) : words_(std::move(words)) {}

  void read(const Json& json, const JsonPath& path, E& value) const override {
    for (const auto& [text, meaning] : words_) {
      if (json.is(Json::Kind::text) && json.text == text) {
        value = meaning;
        return;
      }
    }
    std::vector<std::string> known;
    for (const auto& entry : words_) known.push_back(entry.first);
    const std::string best = json.is(Json::Kind::text) ? nearest_word(json.text, known) : "";
    path.fail("expected " + list() + ", found " + brief(json) +
              (best.empty() ? "" : "; did you mean \"" + best + "\"?"));
  }
  Json write(const E& value) const override {
    for (const auto& [text, meaning] : words_) {
      if (meaning == value) return Json::of(text);
    }
    return {};
  }
  TypeInfo describe(Format&) const override {
    Json words = Json::array();
    for (const auto& entry : words_) words.items.push_back(Json::of(entry.first));
    return {list(), Json::object({{"enum", std::move(words)}})};
  }

 private:
  std::string list() const {
    std::string out;
    for (std::size_t i = 0; i < words_.size(); ++i) {
      if (i > 0) out += i + 1 == words_.size() ? " or " : ", ";
      out += "\"" + words_[i].first + "\"";
    }
    return out;
  }
  std::vector<std::pair<std::string, E>> words_;
};
template <class E>
CodecPtr<E> enumeration(std::vector<std::pair<std::string, E>> words) {
  return std::make_shared<Enumeration<E>>(std::move(words));
}

/// A value that cannot change; `expected` names it in messages.
template <class T>
class Constant : public Codec<T> {
 public:
  Constant(Json value, std::string expected) : value_(std::move(value)), expected_(std::move(expected)) {}
  void read(const Json& json, const JsonPath& path, T&) const override {
    if (!(json == value_)) path.unexpected(expected_, json);
  }
  Json write(const T&) const override { return value_; }
  TypeInfo describe(Format&) const override { return {dump_line(value_), Json::object({{"const", value_}})}; }

 private:
  Json value_;
  std::string expected_;
};

template <class T>
CodecPtr<T> constant(Json value, std::string expected) {
  return std::make_shared<Constant<T>>(std::move(value), std::move(expected));
}

// --- lists -----------------------------------------------------------------------------------------------

template <class T>
class List : public Codec<std::vector<T>> {
 public:
  List(CodecPtr<T> item, std::size_t min_count, std::size_t max_count)
      : item_(std::move(item)), min_count_(min_count), max_count_(max_count) {}

  void read(const Json& json, const JsonPath& path, std::vector<T>& value) const override {
    if (!json.is(Json::Kind::array)) path.unexpected("a list: [ ... ]", json);
    if (json.items.size() < min_count_ || json.items.size() > max_count_) {
      path.fail_length(min_count_, max_count_, json.items.size());
    }
    std::vector<T> read(json.items.size());
    for (std::size_t i = 0; i < read.size(); ++i) item_->read(json.items[i], path.item(i), read[i]);
    value = std::move(read);
  }
  Json write(const std::vector<T>& value) const override {
    Json json = Json::array();
    for (const T& item : value) json.items.push_back(item_->write(item));
    return json;
  }
  TypeInfo describe(Format& format) const override {
    const TypeInfo item = item_->describe(format);
    return {"list of " + item.text, list_schema(item.schema, min_count_, max_count_)};
  }

 private:
  CodecPtr<T> item_;
  std::size_t min_count_, max_count_;
};
template <class T>
CodecPtr<std::vector<T>> list(CodecPtr<T> item, std::size_t min_count = 0, std::size_t max_count = 1000000) {
  return std::make_shared<List<T>>(std::move(item), min_count, max_count);
}

/// A list of n items. `expected` names it in messages, `text` in the manual.
template <class T, std::size_t n>
class Array : public Codec<std::array<T, n>> {
 public:
  Array(CodecPtr<T> item, std::string expected, std::string text)
      : item_(std::move(item)), expected_(std::move(expected)), text_(std::move(text)) {}
  void read(const Json& json, const JsonPath& path, std::array<T, n>& value) const override {
    if (!json.is(Json::Kind::array) || json.items.size() != n) path.unexpected(expected_, json);
    for (std::size_t i = 0; i < n; ++i) item_->read(json.items[i], path.item(i), value[i]);
  }
  Json write(const std::array<T, n>& value) const override {
    Json json = Json::array();
    for (const T& item : value) json.items.push_back(item_->write(item));
    return json;
  }
  TypeInfo describe(Format& format) const override {
    return {text_, list_schema(item_->describe(format).schema, n, n)};
  }

 private:
  CodecPtr<T> item_;
  std::string expected_, text_;
};

/// A key that may be absent; std::nullopt if so.
template <class T>
class Optional : public Codec<std::optional<T>> {
 public:
  explicit Optional(CodecPtr<T> inner) : inner_(std::move(inner)) {}
  void read(const Json& json, const JsonPath& path, std::optional<T>& value) const override {
    T read{};
    inner_->read(json, path, read);
    value = std::move(read);
  }
  Json write(const std::optional<T>& value) const override { return value ? inner_->write(*value) : Json{}; }
  TypeInfo describe(Format& format) const override { return inner_->describe(format); }

 private:
  CodecPtr<T> inner_;
};
template <class T>
CodecPtr<std::optional<T>> maybe(CodecPtr<T> inner) {
  return std::make_shared<Optional<T>>(std::move(inner));
}

}  // namespace souple::scene_format
