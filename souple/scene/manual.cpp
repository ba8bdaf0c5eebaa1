#include "souple/scene/keys.h"

namespace souple {

namespace {

using scene_format::Json;
using scene_format::KeyInfo;
using scene_format::TableInfo;

Json texts(const std::vector<std::string>& list) {
  Json json = Json::array();
  for (const std::string& text : list) json.items.push_back(Json::of(text));
  return json;
}

Json properties_of(const TableInfo& table) {
  Json properties = Json::object();
  for (const KeyInfo& key : table.keys) {
    Json schema = key.schema;
    // Next to a $ref, which draft 2020-12 allows.
    schema.set("description", Json::of(key.doc));
    if (key.fallback) schema.set("default", *key.fallback);
    properties.set(key.name, std::move(schema));
  }
  return properties;
}

Json requires_key(const std::string& key) {
  Json json = Json::object();
  json.set("required", texts({key}));
  return json;
}

/// {"oneOf": [{"required": ["a"]}, {"required": ["b"]}]}; for "at most one" also neither key.
Json one_of(const std::vector<std::string>& keys, bool none_allowed) {
  Json choices = Json::array();
  Json any = Json::array();
  for (const std::string& key : keys) {
    choices.items.push_back(requires_key(key));
    any.items.push_back(requires_key(key));
  }
  if (none_allowed) {
    Json neither = Json::object();
    Json inner = Json::object();
    inner.set("anyOf", std::move(any));
    neither.set("not", std::move(inner));
    choices.items.push_back(std::move(neither));
  }
  Json json = Json::object();
  json.set("oneOf", std::move(choices));
  return json;
}

Json schema_of(const TableInfo& table) {
  Json schema = Json::object();
  schema.set("description", Json::of(table.doc));
  schema.set("type", Json::of("object"));
  schema.set("additionalProperties", Json::of(false));
  schema.set("properties", properties_of(table));
  std::vector<std::string> required;
  for (const KeyInfo& key : table.keys) {
    if (key.required) required.push_back(key.name);
  }
  if (!required.empty()) schema.set("required", texts(required));
  Json rules = Json::array();
  for (const auto& keys : table.exactly_one) rules.items.push_back(one_of(keys, false));
  for (const auto& keys : table.at_most_one) rules.items.push_back(one_of(keys, true));
  if (!rules.items.empty()) schema.set("allOf", std::move(rules));
  if (!table.needs.empty()) {
    Json needs = Json::object();
    for (const auto& [key, other] : table.needs) needs.set(key, texts({other}));
    schema.set("dependentRequired", std::move(needs));
  }
  return schema;
}

std::string key_row(const KeyInfo& key) {
  const std::string fallback =
      key.required ? "required" : (key.fallback ? "`" + scene_format::dump_line(*key.fallback) + "`" : "");
  return "| `" + key.name + "` | " + key.type + " | " + fallback + " | " + key.doc + " |\n";
}

std::string joined(const std::vector<std::string>& keys) {
  std::string out;
  for (const std::string& key : keys) out += (out.empty() ? "`" : ", `") + key + "`";
  return out;
}

std::string section(const TableInfo& table) {
  std::string out = "## " + table.name + "\n\n" + table.doc + "\n\n";
  out += "| key | value | default | meaning |\n|---|---|---|---|\n";
  for (const KeyInfo& key : table.keys) out += key_row(key);
  out += "\n";
  for (const auto& keys : table.exactly_one) out += "Exactly one of " + joined(keys) + ".\n\n";
  for (const auto& keys : table.at_most_one) out += "At most one of " + joined(keys) + ".\n\n";
  for (const auto& [key, other] : table.needs) out += "`" + key + "` only together with `" + other + "`.\n\n";
  return out;
}

constexpr const char* introduction = R"(# Scene files

<!-- Generated from the reader's tables (souple/scene/keys.cpp) by `souple info --scene-format`; do not edit. -->

A scene is one JSON file: its objects, their materials, and the settings of the simulation. Units are meters,
kilograms and seconds; angles are in degrees; Y is up, axes are right-handed. File names are relative to the
scene's folder.

```json
{
  "souple": 1,
  "frames": 120,
  "objects": [
    { "name": "flag", "kind": "cloth",
      "mesh": { "grid": { "columns": 40, "rows": 24, "size": 2 } },
      "transform": { "translate": [0, 2, 0], "rotate": [90, 0, 0] },
      "material": { "preset": "silk", "bending_stiffness": 1e-6 },
      "pins": [ { "in_box": [[-1.01, 1, -1], [-0.99, 3, 1]] } ] }
  ],
  "wind": { "velocity": [4, 0, 1], "gust": 0.3 }
}
```

Reading is strict. An unknown key, a duplicate key, a wrong type or a value out of range is an error. Its message
names the file, the path inside it and the value, and suggests the nearest key. JSON only: no comments, no
trailing commas.

The command line can change any value: `--set substeps=20`, `--set objects.flag.material.damping=0.1`,
`--set objects[0].transform.translate=[0,3,0]`. A list entry is given by its `name`, or by its index from 0.

`souple check SCENE` reads a scene and lists its contents. [scene.schema.json](scene.schema.json) is a JSON schema,
with which editors complete and check scenes while you type.

)";

scene_format::Format scene_tables() {
  scene_format::Format format;
  scene_format::scene_codec()->describe(format);
  return format;
}

}  // namespace

std::string scene_schema() {
  Json definitions = Json::object();
  for (const auto& table : scene_tables().tables) definitions.set(table->name, schema_of(*table));
  Json schema = Json::object();
  schema.set("$schema", Json::of("https://json-schema.org/draft/2020-12/schema"));
  schema.set("title", Json::of("Souple scene"));
  schema.set("$ref", Json::of("#/$defs/scene"));
  schema.set("$defs", std::move(definitions));
  return scene_format::dump_json(schema);
}

std::string scene_manual() {
  std::string out = introduction;
  for (const auto& table : scene_tables().tables) out += section(*table);
  while (out.size() > 1 && out[out.size() - 2] == '\n') out.pop_back();
  return out;
}

}  // namespace souple
