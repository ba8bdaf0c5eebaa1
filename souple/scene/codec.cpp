#include "souple/scene/codec.h"

#include <algorithm>
#include <charconv>
#include <cstdio>

#include <fmt/core.h>

namespace souple::scene_format {

template class Number<double>;
template class Number<float>;
template class Number<int>;
template class Number<std::uint32_t>;
template class Vector3<double>;
template class Vector3<float>;
template CodecPtr<double> number(const Range& range);
template CodecPtr<float> number(const Range& range);
template CodecPtr<int> number(const Range& range);
template CodecPtr<std::uint32_t> number(const Range& range);
template CodecPtr<Vec3d> vector3(const Range& range);
template CodecPtr<Vec3f> vector3(const Range& range);

namespace {

/// A key may contain any characters; a message must stay on one line.
std::string printable(std::string_view key) {
  constexpr std::size_t max_length = 60;
  std::string out(key.substr(0, max_length));
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return key.size() > max_length ? out + "..." : out;
}

}  // namespace

std::string JsonPath::to_string() const {
  std::string path;
  std::vector<const JsonPath*> chain;
  for (const JsonPath* part = this; part->parent_ != nullptr; part = part->parent_) chain.push_back(part);
  for (auto part = chain.rbegin(); part != chain.rend(); ++part) {
    if ((*part)->name_.empty()) {
      path += fmt::format("[{}]", (*part)->index_);
    } else {
      path += (path.empty() ? "" : ".") + printable((*part)->name_);
    }
  }
  return path;
}

void JsonPath::fail(const std::string& message) const {
  const std::string where = to_string();
  throw Error(reading_->source + ": " + (where.empty() ? "" : where + ": ") + message);
}

void JsonPath::fail_length(std::size_t min_count, std::size_t max_count, std::size_t found) const {
  fail(fmt::format("expected a list of {} to {} entries, found {}", min_count, max_count, found));
}

std::string Range::text(const std::string& noun) const {
  const std::string low = number_text(lowest), high = number_text(highest);
  if (lowest == 0 && open_low) return noun + " > 0 and " + (open_high ? "< " : "<= ") + high;
  return noun + (open_low ? " > " : " from ") + low + (open_high ? " to below " : " to ") + high;
}

Json Range::schema(const char* type) const {
  return Json::object({{"type", Json::of(type)},
                       {open_low ? "exclusiveMinimum" : "minimum", Json::of(lowest)},
                       {open_high ? "exclusiveMaximum" : "maximum", Json::of(highest)}});
}

Json list_schema(Json item, std::size_t min_count, std::size_t max_count) {
  Json schema = Json::object({{"type", Json::of("array")}, {"items", std::move(item)}});
  if (min_count > 0) schema.set("minItems", Json::whole(static_cast<std::int64_t>(min_count)));
  schema.set("maxItems", Json::whole(static_cast<std::int64_t>(max_count)));
  return schema;
}

namespace {

/// Characters (Unicode code points) of valid UTF-8, as JSON Schema's maxLength counts them.
std::size_t count_characters(std::string_view text) {
  return std::size_t(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

Json string_schema(std::size_t max_length) {
  return Json::object({{"type", Json::of("string")}, {"maxLength", Json::whole(std::int64_t(max_length))}});
}

class Boolean : public Codec<bool> {
 public:
  void read(const Json& json, const JsonPath& path, bool& value) const override {
    if (!json.is(Json::Kind::boolean)) path.unexpected("true or false", json);
    value = json.boolean;
  }
  Json write(const bool& value) const override { return Json::of(value); }
  TypeInfo describe(Format&) const override {
    return {"true or false", Json::object({{"type", Json::of("boolean")}})};
  }
};

class Text : public Codec<std::string> {
 public:
  explicit Text(std::size_t max_length) : max_length_(max_length) {}
  void read(const Json& json, const JsonPath& path, std::string& value) const override {
    if (!json.is(Json::Kind::text)) path.unexpected("text in quotes", json);
    if (count_characters(json.text) > max_length_) {
      path.fail(fmt::format("expected at most {} characters of text, found {}", max_length_, brief(json)));
    }
    value = json.text;
  }
  Json write(const std::string& value) const override { return Json::of(value); }
  TypeInfo describe(Format&) const override { return {"text", string_schema(max_length_)}; }

 private:
  std::size_t max_length_;
};

class HexColor : public Codec<std::uint32_t> {
 public:
  void read(const Json& json, const JsonPath& path, std::uint32_t& value) const override {
    const std::string_view text = json.text;
    const bool shaped = json.is(Json::Kind::text) && text.size() == 7 && text[0] == '#';
    std::uint32_t read = 0;
    if (!shaped || std::from_chars(text.data() + 1, text.data() + 7, read, 16).ptr != text.data() + 7)
      path.unexpected("a color such as \"#d04a3f\" (red, green and blue, as in HTML)", json);
    value = read;
  }
  Json write(const std::uint32_t& value) const override {
    char text[8];
    std::snprintf(text, sizeof(text), "#%06x", value & 0xffffffu);
    return Json::of(text);
  }
  TypeInfo describe(Format&) const override {
    Json schema = string_schema(7);
    schema.set("pattern", Json::of("^#[0-9A-Fa-f]{6}$"));
    return {"\"#rrggbb\"", schema};
  }
};

class Name : public Codec<std::string> {
 public:
  void read(const Json& json, const JsonPath& path, std::string& value) const override {
    if (!json.is(Json::Kind::text) || !valid(json.text)) path.unexpected(expected, json);
    value = json.text;
  }
  Json write(const std::string& value) const override { return Json::of(value); }
  TypeInfo describe(Format&) const override {
    Json schema = string_schema(64);
    schema.set("minLength", Json::whole(1));
    schema.set("pattern", Json::of("^[A-Za-z0-9_\\-\\u0080-\\uffff]+$"));
    return {"name", schema};
  }

 private:
  static constexpr const char* expected = "a name of letters, digits, _ and -, 1 to 64 characters";
  static bool valid(const std::string& name) {
    return !name.empty() && count_characters(name) <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
      const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
      return letter || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
             static_cast<unsigned char>(c) >= 0x80;
    });
  }
};

class File : public Codec<std::string> {
 public:
  explicit File(bool or_folder) : or_folder_(or_folder) {}
  void read(const Json& json, const JsonPath& path, std::string& value) const override {
    const bool usable = json.is(Json::Kind::text) && !json.text.empty() &&
                        count_characters(json.text) <= max_length &&
                        json.text.find('\0') == std::string::npos;
    if (!usable) path.unexpected("a file's name", json);
    if (path.reading().files_exist) require_file(path, json);
    value = json.text;
  }
  Json write(const std::string& value) const override { return Json::of(value); }
  TypeInfo describe(Format&) const override {
    return {std::string(or_folder_ ? "file or folder" : "file") + ", relative to the scene's folder",
            string_schema(max_length)};
  }

 private:
  void require_file(const JsonPath& path, const Json& json) const {
    const std::filesystem::path file = path.reading().base / json.text;
    std::error_code error;
    if (!or_folder_ && std::filesystem::is_directory(file, error)) {
      path.fail("expected a file, but " + brief(json) + " is a folder: " + file.string());
    }
    if (!std::filesystem::exists(file, error)) {
      path.fail("file " + brief(json) + " not found; looked for " + file.string());
    }
  }
  static constexpr std::size_t max_length = 1000;
  bool or_folder_;
};

class Word : public Codec<std::string> {
 public:
  Word(std::string noun, std::vector<std::string> known) : noun_(std::move(noun)), known_(std::move(known)) {}

  void read(const Json& json, const JsonPath& path, std::string& value) const override {
    if (!json.is(Json::Kind::text)) path.unexpected("the name of a " + noun_, json);
    if (std::find(known_.begin(), known_.end(), json.text) == known_.end()) {
      path.fail("unknown " + noun_ + " " + brief(json) + suggestion(json.text, known_));
    }
    value = json.text;
  }
  Json write(const std::string& value) const override { return Json::of(value); }
  TypeInfo describe(Format&) const override {
    Json words = Json::array();
    std::string listed;
    for (const std::string& word : known_) {
      words.items.push_back(Json::of(word));
      listed += (listed.empty() ? "\"" : ", \"") + word + "\"";
    }
    return {noun_ + ": " + listed, Json::object({{"enum", std::move(words)}})};
  }

 private:
  std::string noun_;
  std::vector<std::string> known_;
};

}  // namespace

CodecPtr<bool> boolean() {
  return std::make_shared<Boolean>();
}
CodecPtr<std::string> text(std::size_t max_length) {
  return std::make_shared<Text>(max_length);
}
CodecPtr<std::uint32_t> color() {
  return std::make_shared<HexColor>();
}
CodecPtr<std::string> name() {
  return std::make_shared<Name>();
}
CodecPtr<std::string> file() {
  return std::make_shared<File>(false);
}
CodecPtr<std::string> file_or_folder() {
  return std::make_shared<File>(true);
}
CodecPtr<std::string> word(std::string noun, std::vector<std::string> known) {
  return std::make_shared<Word>(std::move(noun), std::move(known));
}

}  // namespace souple::scene_format
