#include "souple/scene/json.h"

#include "souple/error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <fmt/core.h>
// The only file of this folder that includes nlohmann's header, which takes seconds to compile.
#include <nlohmann/json.hpp>

namespace souple::scene_format {

namespace {

constexpr std::size_t max_depth = 64;
constexpr std::size_t max_keys = 1000;  // of one object; the search for duplicates is quadratic

std::string line_and_column(std::string_view text, std::size_t position) {
  position = std::min(position, text.size());
  const std::string_view before = text.substr(0, position);
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  const std::size_t start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
  return fmt::format("{}:{}", line, std::max<std::size_t>(position - start, 1));
}

/// nlohmann writes "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while ..."
std::string reason_of(std::string what) {
  const std::size_t bracket = what.find("] ");
  if (bracket != std::string::npos) what.erase(0, bracket + 2);
  const std::size_t position = what.find(": ");
  if (what.rfind("parse error", 0) == 0 && position != std::string::npos) what.erase(0, position + 2);
  for (char& c : what) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  constexpr std::size_t max_length = 200;
  if (what.size() > max_length) what = what.substr(0, max_length) + "...";
  return what;
}

/// Builds the tree; rejects duplicate keys and excessive depth.
class Builder : public nlohmann::json_sax<nlohmann::json> {
 public:
  Builder(std::string_view text, std::string_view source) : text_(text), source_(source) {}

  Json take() { return std::move(root_); }

  bool null() override { return add(Json{}); }
  bool boolean(bool value) override { return add(Json::of(value)); }
  bool number_integer(number_integer_t value) override { return add_integer(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) override { return add_integer(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t&) override { return add(Json::of(value)); }
  bool string(string_t& value) override { return add(Json::of(std::move(value))); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    Json& object = *open_.back();
    if (object.find(name) != nullptr) {
      throw Error(std::string(source_) + ": " + path_to(name) +
                  ": the key appears twice; keep one of the two");
    }
    if (object.members.size() >= max_keys) {
      throw Error(fmt::format("{}: {}: more than {} keys in one object", source_, path_to(name), max_keys));
    }
    key_ = std::move(name);
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    throw Error(std::string(source_) + ":" + line_and_column(text_, position) +
                ": not JSON: " + reason_of(error.what()));
  }

 private:
  bool add_integer(double value) {
    Json json = Json::of(value);
    json.integral = true;
    return add(std::move(json));
  }

  bool add(Json value) {
    append(std::move(value));
    return true;
  }

  bool open(Json value) {
    if (open_.size() >= max_depth) {
      throw Error(
          fmt::format("{}: nested deeper than {} levels; a scene needs fewer than 10", source_, max_depth));
    }
    // Addresses of open containers are stable: only the innermost one grows.
    open_.push_back(&append(std::move(value)));
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  Json& append(Json value) {
    if (open_.empty()) return root_ = std::move(value);
    Json& parent = *open_.back();
    if (parent.is(Json::Kind::array)) return parent.items.emplace_back(std::move(value));
    return parent.members.emplace_back(Member{std::move(key_), std::move(value)}).value;
  }

  std::string path_to(const std::string& name) const {
    std::string path;
    for (std::size_t level = 0; level < open_.size(); ++level) {
      const Json& container = *open_[level];
      if (container.is(Json::Kind::array)) {
        path += fmt::format("[{}]", container.items.size() - 1);
      } else {
        const std::string& here = level + 1 < open_.size() ? container.members.back().key : name;
        path += (path.empty() ? "" : ".") + here;
      }
    }
    return path;
  }

  std::string_view text_, source_;
  Json root_;
  std::string key_;
  std::vector<Json*> open_;
};

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void write_line(const Json& value, std::string& out) {
  switch (value.kind) {
    case Json::Kind::null:
      out += "null";
      return;
    case Json::Kind::boolean:
      out += value.boolean ? "true" : "false";
      return;
    case Json::Kind::number:
      out += number_text(value.number);
      return;
    case Json::Kind::text:
      out += quoted(value.text);
      return;
    case Json::Kind::array: {
      const char* between = "";
      out += "[";
      for (const Json& item : value.items) out += between, write_line(item, out), between = ", ";
      out += "]";
      return;
    }
    case Json::Kind::object: {
      const char* between = "";
      out += "{";
      for (const Member& member : value.members) {
        out += between + quoted(member.key) + ": ";
        write_line(member.value, out);
        between = ", ";
      }
      out += "}";
      return;
    }
  }
}

/// Short values without objects in lists fit on one line.
bool fits_line(const Json& value, const std::string& line) {
  constexpr std::size_t max_width = 100;
  const bool plain = std::none_of(value.items.begin(), value.items.end(),
                                  [](const Json& item) { return item.is(Json::Kind::object); });
  return line.size() <= max_width && plain;
}

void write_lines(const Json& value, const std::string& indent, std::string& out) {
  std::string line;
  write_line(value, line);
  const bool container = value.is(Json::Kind::array) || value.is(Json::Kind::object);
  if (!container || fits_line(value, line)) {
    out += line;
    return;
  }
  const std::string inner = indent + "  ";
  const char* between = "\n";
  out += value.is(Json::Kind::array) ? "[" : "{";
  for (const Json& item : value.items) {
    out += between + inner;
    write_lines(item, inner, out);
    between = ",\n";
  }
  for (const Member& member : value.members) {
    out += between + inner + quoted(member.key) + ": ";
    write_lines(member.value, inner, out);
    between = ",\n";
  }
  out += "\n" + indent + (value.is(Json::Kind::array) ? "]" : "}");
}

/// The decimal with the fewest digits that parses to the same float.
double shortest_decimal(float value) {
  for (int digits = 6; digits <= 9; ++digits) {
    char text[40];
    // Printed and parsed in the same locale, so a decimal comma does no harm.
    std::snprintf(text, sizeof(text), "%.*g", digits, static_cast<double>(value));
    const double decimal = std::strtod(text, nullptr);
    if (static_cast<float>(decimal) == value) return decimal;
  }
  return static_cast<double>(value);
}

}  // namespace

Json Json::of(bool value) {
  Json json;
  json.kind = Kind::boolean;
  json.boolean = value;
  return json;
}

Json Json::of(double value) {
  Json json;
  json.kind = Kind::number;
  json.number = value;
  return json;
}

Json Json::of(float value) {
  return of(shortest_decimal(value));
}

Json Json::whole(std::int64_t value) {
  Json json = of(static_cast<double>(value));
  json.integral = true;
  return json;
}

Json Json::of(std::string value) {
  Json json;
  json.kind = Kind::text;
  json.text = std::move(value);
  return json;
}

Json Json::of(const char* value) {
  return of(std::string(value));
}

Json Json::array() {
  return array(std::vector<Json>{});
}

Json Json::array(std::vector<Json> items) {
  Json json;
  json.kind = Kind::array;
  json.items = std::move(items);
  return json;
}

Json Json::object() {
  return object(std::vector<Member>{});
}

Json Json::object(std::vector<Member> members) {
  Json json;
  json.kind = Kind::object;
  json.members = std::move(members);
  return json;
}

const Json* Json::find(std::string_view key) const {
  return const_cast<Json*>(this)->find(key);
}

Json* Json::find(std::string_view key) {
  for (Member& member : members) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

Json& Json::set(std::string key, Json value) {
  if (Json* present = find(key)) return *present = std::move(value);
  return members.emplace_back(Member{std::move(key), std::move(value)}).value;
}

bool operator==(const Json& a, const Json& b) {
  return dump_line(a) == dump_line(b);
}

Json parse_json(std::string_view text, std::string_view source) {
  Builder builder(text, source);
  nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take();
}

std::string dump_json(const Json& value) {
  std::string out;
  write_lines(value, "", out);
  return out + "\n";
}

std::string dump_line(const Json& value) {
  std::string out;
  write_line(value, out);
  return out;
}

std::string brief(const Json& value) {
  constexpr std::size_t max_length = 60;
  std::string text = dump_line(value);
  if (text.size() <= max_length) return text;
  std::size_t end = max_length;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80)
    --end;  // not inside a UTF-8 character
  return text.substr(0, end) + "...";
}

std::string number_text(double value) {
  if (value == 0 && std::signbit(value)) return "-0.0";
  constexpr double exact = 9007199254740992.0;  // 2^53
  if (value >= -exact && value <= exact && value == static_cast<double>(static_cast<std::int64_t>(value))) {
    return fmt::format("{}", static_cast<std::int64_t>(value));
  }
  return nlohmann::json(value).dump();
}

}  // namespace souple::scene_format
