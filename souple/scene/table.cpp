#include "souple/scene/table.h"

#include <algorithm>

namespace souple::scene_format {

namespace {

/// Access functions only compute addresses; the object is not modified.
const void* member_of(Access access, const void* object) {
  return access(const_cast<void*>(object));
}

std::string quoted_list(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "\"" : ", \"") + word + "\"";
  return out;
}

/// Empty values are not shown as defaults.
bool is_informative(const Json& json) {
  switch (json.kind) {
    case Json::Kind::null:
    case Json::Kind::object:
      return false;
    case Json::Kind::text:
      return !json.text.empty();
    case Json::Kind::array:
      return !json.items.empty();
    default:
      return true;
  }
}

}  // namespace

// --- Key ---------------------------------------------------------------------------------------------------

Key::Key(std::string name, Access access, AnyCodecPtr codec, std::string doc, bool required)
    : name_(std::move(name)),
      access_(access),
      codec_(std::move(codec)),
      doc_(std::move(doc)),
      required_(required) {}

Json Key::written(const void* object) const {
  return codec_->write_any(member_of(access_, object));
}

void Key::read(const Json& json, const JsonPath& path, void* object) const {
  if (const Json* value = json.find(name_)) {
    codec_->read_any(*value, path.key(name_), access_(object));
  } else if (required_) {
    path.fail("the key \"" + name_ + "\" is missing: " + doc_);
  }
}

void Key::write(const void* object, const void* fallback, Json& json) const {
  Json value = written(object);
  const bool absent = value.is(Json::Kind::null) || (!required_ && value == written(fallback));
  if (!absent) json.set(name_, std::move(value));
}

void Key::describe(Format& format, const void* fallback, TableInfo& info) const {
  TypeInfo type = codec_->describe(format);
  KeyInfo key{name_, type.text, doc_, required_, std::nullopt, std::move(type.schema)};
  Json value = written(fallback);
  if (!required_ && is_informative(value)) key.fallback = std::move(value);
  info.keys.push_back(std::move(key));
}

// --- Choice ------------------------------------------------------------------------------------------------

std::vector<std::string> Choice::keys() const {
  std::vector<std::string> names;
  for (const Alternative& option : options_) names.push_back(option.name);
  return names;
}

void Choice::read(const Json& json, const JsonPath& path, void* object) const {
  const Alternative* chosen = nullptr;
  for (const Alternative& option : options_) {
    if (json.find(option.name) == nullptr) continue;
    if (chosen != nullptr) {
      path.fail("\"" + chosen->name + "\" and \"" + option.name + "\" exclude each other; keep one");
    }
    chosen = &option;
  }
  if (chosen == nullptr) path.fail("expected one of the keys " + quoted_list(keys()));
  chosen->codec->read_any(*json.find(chosen->name), path.key(chosen->name), chosen->emplace(access_(object)));
}

void Choice::write(const void* object, const void*, Json& json) const {
  for (const Alternative& option : options_) {
    const void* current = option.get(member_of(access_, object));
    if (current != nullptr) json.set(option.name, option.codec->write_any(current));
  }
}

void Choice::describe(Format& format, const void*, TableInfo& info) const {
  for (const Alternative& option : options_) {
    TypeInfo type = option.codec->describe(format);
    info.keys.push_back({option.name, type.text, option.doc, false, std::nullopt, std::move(type.schema)});
  }
  info.exactly_one.push_back(keys());
}

// --- Table -------------------------------------------------------------------------------------------------

std::vector<std::string> TableCore::keys() const {
  std::vector<std::string> names;
  for (const auto& entry : entries_) {
    for (std::string& name : entry->keys()) names.push_back(std::move(name));
  }
  return names;
}

void TableCore::add_key(const char* name, Access access, AnyCodecPtr codec, const char* doc, bool required) {
  entries_.push_back(std::make_unique<Key>(name, access, std::move(codec), doc, required));
}

void TableCore::add_choice(Access access, std::vector<Alternative> options) {
  entries_.push_back(std::make_unique<Choice>(access, std::move(options)));
}

void TableCore::read_object(const Json& json, const JsonPath& path, void* object) const {
  if (!json.is(Json::Kind::object)) path.unexpected("an object: { ... }", json);
  reject_unknown_keys(json, path);
  if (before_) before_(json, path, object);
  for (const auto& entry : entries_) entry->read(json, path, object);
  for (const auto& [key, other] : needs_) {
    if (json.find(key) != nullptr && json.find(other) == nullptr) {
      path.key(key).fail("is valid only together with \"" + other + "\"");
    }
  }
  for (const auto& [key, other] : excludes_) {
    if (json.find(key) != nullptr && json.find(other) != nullptr) {
      path.fail("\"" + key + "\" and \"" + other + "\" exclude each other; keep one");
    }
  }
  for (const auto& rule : rules_) rule(object, path);
}

Json TableCore::write_object(const void* object, const void* fallback) const {
  Json json = Json::object();
  for (const auto& entry : entries_) entry->write(object, fallback, json);
  return json;
}

TypeInfo TableCore::describe_object(Format& format, const void* fallback) const {
  TypeInfo type{"[" + name_ + "](#" + name_ + ")", Json::object({{"$ref", Json::of("#/$defs/" + name_)}})};
  for (const auto& table : format.tables) {
    if (table->name == name_) return type;
  }
  TableInfo& info = *format.tables.emplace_back(std::make_unique<TableInfo>());
  info.name = name_;
  info.doc = doc_;
  for (const auto& entry : entries_) entry->describe(format, fallback, info);
  for (const auto& [key, other] : excludes_) info.at_most_one.push_back({key, other});
  info.needs = needs_;
  return type;
}

void TableCore::reject_unknown_keys(const Json& json, const JsonPath& path) const {
  const std::vector<std::string> known = keys();
  for (const Member& member : json.members) {
    if (std::find(known.begin(), known.end(), member.key) != known.end()) continue;
    std::string hint;
    for (const auto& [key, owner] : foreign_) {
      if (key == member.key && hint.empty()) hint = "; it belongs to " + owner;
    }
    if (hint.empty()) hint = suggestion(member.key, known);
    path.key(member.key).fail("unknown key (its value is " + brief(member.value) + ")" + hint);
  }
}

// --- Kinds -------------------------------------------------------------------------------------------------

void KindsCore::read_kind(const Json& json, const JsonPath& path, void* variant) const {
  if (!json.is(Json::Kind::object)) path.unexpected("an object: { ... }", json);
  std::vector<std::string> known;
  for (const Alternative& option : kinds_) known.push_back(option.name);
  const Json* kind = json.find("kind");
  if (kind == nullptr) path.fail("the key \"kind\" is missing; expected one of " + quoted_list(known));
  for (const Alternative& option : kinds_) {
    if (kind->is(Json::Kind::text) && kind->text == option.name) {
      option.codec->read_any(json, path, option.emplace(variant));
      return;
    }
  }
  const std::string word = kind->is(Json::Kind::text) ? kind->text : "";
  path.key("kind").fail("no kind is called " + brief(*kind) + suggestion(word, known));
}

Json KindsCore::write_kind(const void* variant) const {
  for (const Alternative& option : kinds_) {
    if (const void* current = option.get(variant)) return option.codec->write_any(current);
  }
  return {};
}

TypeInfo KindsCore::describe_kinds(Format& format) const {
  std::string texts;
  Json any = Json::array();
  for (const Alternative& option : kinds_) {
    TypeInfo one = option.codec->describe(format);
    texts += (texts.empty() ? "" : " or ") + one.text;
    any.items.push_back(std::move(one.schema));
  }
  return {texts, Json::object({{"oneOf", std::move(any)}})};
}

}  // namespace souple::scene_format
