#include "souple/scene/overrides.h"

#include "souple/error.h"
#include "souple/scene/nearest.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/core.h>

namespace souple::scene_format {

namespace {

constexpr std::size_t max_parts = 16;

/// "objects[0].mesh" -> objects, 0, mesh
std::vector<std::string> split_path(std::string_view path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.' || c == '[') {
      parts.emplace_back();
    } else if (c != ']') {
      parts.back() += c;
    }
  }
  return parts;
}

/// The names that the reader will give to entries of a list of objects or colliders; other lists have no
/// names.
std::vector<std::string> names_of(const Json& list, const std::string& key) {
  std::set<std::string> used;
  std::map<std::string, int> next;  // number of a base: lower ones are taken
  std::vector<std::string> names(list.items.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Json* name = list.items[i].find("name");
    if (name != nullptr && name->is(Json::Kind::text)) used.insert(names[i] = name->text);
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Json* kind = list.items[i].find("kind");
    const std::string base = key == "colliders" ? "collider" : (kind != nullptr ? kind->text : "");
    if (!names[i].empty() || base.empty()) continue;
    names[i] = base;
    int& number = next.try_emplace(base, 2).first->second;
    while (!used.insert(names[i]).second) names[i] = fmt::format("{}{}", base, number++);
  }
  return names;
}

class Override {
 public:
  Override(const std::string& setting, std::string_view source) : setting_(setting), source_(source) {}

  void apply(Json& scene) const {
    const std::size_t equals = setting_.find('=');
    if (equals == std::string::npos || equals == 0) {
      fail("expected PATH=VALUE, such as substeps=20 or objects.flag.material.damping=0.1");
    }
    const std::vector<std::string> parts = split_path(setting_.substr(0, equals));
    if (parts.size() > max_parts) fail("the path has too many parts");
    Json* here = &scene;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].empty()) fail("the path has an empty part");
      here = &descend(*here, parts[i], i > 0 ? parts[i - 1] : "");
    }
    *here = value(setting_.substr(equals + 1));
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw Error(std::string(source_) + ": setting " + brief(Json::of(setting_)) + ": " + message);
  }

  Json& descend(Json& from, const std::string& part, const std::string& before) const {
    if (from.is(Json::Kind::array)) return from.items[index_of(from, part, before)];
    if (from.is(Json::Kind::null)) from = Json::object();  // created by a longer path
    if (!from.is(Json::Kind::object)) {
      fail(quoted(before) + " is " + brief(from) + ", which has no " + quoted(part) + " inside");
    }
    Json* present = from.find(part);
    return present != nullptr ? *present : from.set(part, Json{});
  }

  std::size_t index_of(const Json& list, const std::string& part, const std::string& key) const {
    std::vector<std::string> names = names_of(list, key);
    const auto named = std::find(names.begin(), names.end(), part);
    if (named != names.end()) return static_cast<std::size_t>(named - names.begin());
    const bool digits = part.size() <= 9 && part.find_first_not_of("0123456789") == std::string::npos;
    if (digits && std::stoul(part) < list.items.size()) return std::stoul(part);
    names.erase(std::remove(names.begin(), names.end(), ""), names.end());
    fail(fmt::format("{} has {} entries and none is called {}{}", quoted(key), list.items.size(),
                     quoted(part), suggestion(part, names)));
  }

  /// A message must stay on one line, whatever the user typed.
  static std::string quoted(const std::string& text) { return brief(Json::of(text)); }

  /// JSON, else the text itself: mode=xpbd needs no quotes.
  Json value(const std::string& text) const {
    try {
      return parse_json(text, source_);
    } catch (const Error&) {
      return Json::of(text);
    }
  }

  const std::string& setting_;
  std::string_view source_;
};

}  // namespace

void apply_override(Json& scene, const std::string& setting, std::string_view source) {
  Override(setting, source).apply(scene);
}

}  // namespace souple::scene_format
