// Reader, schema and manual agree. All three come from one table; these tests compare their outputs.
#include "scene_test.h"
#include "tests/paths.h"

#include <functional>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

namespace souple::scene_test::test_scene_documents {

using nlohmann::json;

std::filesystem::path documents() {
  return source_path("docs");
}

TEST(Documents, AreUpToDate) {
  EXPECT_EQ(read_file(documents() / "scene.schema.json"), scene_schema())
      << "update it: souple info --schema > docs/scene.schema.json";
  EXPECT_EQ(read_file(documents() / "scene-format.md"), scene_manual())
      << "update it: souple info --scene-format > docs/scene-format.md";
}

/// Generates minimal scenes that the schema allows and that contain a wanted key, for the reader.
class Sampler {
 public:
  explicit Sampler(const json& schema) : definitions_(schema["$defs"]) {}

  json sample(const json& schema) const {
    if (schema.contains("$ref")) return sample_table(name_of(schema), "");
    if (schema.contains("const")) return schema["const"];
    if (schema.contains("enum")) return schema["enum"][0];
    if (schema.contains("oneOf")) return sample(schema["oneOf"][0]);
    const std::string type = schema["type"];
    if (type == "boolean") return true;
    if (type == "string") return schema.contains("pattern") ? "a" : "meshes/duck.obj";
    if (type == "array") {
      const std::size_t least = schema.value("minItems", std::size_t{0});
      json list = json::array();
      for (std::size_t i = 0; i < least; ++i) list.push_back(sample(schema["items"]));
      return list;
    }
    return sample_number(schema);
  }

  /// A table with its required keys and, unless empty, `wanted`.
  json sample_table(const std::string& name, const std::string& wanted) const {
    const json& table = definitions_.at(name);
    std::set<std::string> keys;
    for (const auto& key : table.value("required", json::array())) keys.insert(key);
    if (!wanted.empty()) keys.insert(wanted);
    if (table.contains("dependentRequired") && table["dependentRequired"].contains(wanted)) {
      for (const auto& key : table["dependentRequired"][wanted]) keys.insert(key);
    }
    for (const auto& rule : table.value("allOf", json::array())) complete(rule, keys);
    json made = json::object();
    for (const std::string& key : keys) made[key] = sample(table["properties"].at(key));
    return made;
  }

 private:
  static std::string name_of(const json& reference) {
    return reference["$ref"].get<std::string>().substr(std::string("#/$defs/").size());
  }

  /// oneOf of required keys: adds the first if none is present.
  static void complete(const json& rule, std::set<std::string>& keys) {
    bool none_allowed = false;
    for (const auto& choice : rule["oneOf"]) {
      none_allowed = none_allowed || choice.contains("not");
      if (choice.contains("required") && keys.count(choice["required"][0]) > 0) return;
    }
    if (!none_allowed) keys.insert(rule["oneOf"][0]["required"][0]);
  }

  static json sample_number(const json& schema) {
    const bool integer = schema["type"] == "integer";
    const double low = schema.contains("minimum") ? schema["minimum"].get<double>()
                                                  : schema["exclusiveMinimum"].get<double>();
    const double high = schema.contains("maximum") ? schema["maximum"].get<double>()
                                                   : schema["exclusiveMaximum"].get<double>();
    const bool one = low <= 1 && high >= 1 && !(schema.contains("exclusiveMaximum") && high == 1);
    const double value = one ? 1 : (low > 1 ? low : (low + high) / 2);  // the smallest mesh, not a large one
    return integer ? json(static_cast<std::int64_t>(value)) : json(value);
  }

  const json& definitions_;
};

/// The path of each table from the scene's root, as a function that wraps a value.
using Wrap = std::function<json(json)>;

void find_paths(const json& definitions, const Sampler& sampler, const std::string& name, const Wrap& wrap,
                std::map<std::string, Wrap>& paths) {
  if (!paths.emplace(name, wrap).second) return;
  for (const auto& [key, schema] : definitions[name]["properties"].items()) {
    json inner = schema;
    bool listed = false;
    if (inner.value("type", "") == "array") listed = true, inner = json(inner["items"]);
    const json choices = inner.contains("oneOf") ? inner["oneOf"] : json::array({inner});
    for (const json& choice : choices) {
      if (!choice.contains("$ref")) continue;
      const std::string below = choice["$ref"].get<std::string>().substr(8);
      const Wrap here = [&sampler, wrap, name, key = key, listed](json value) {
        json table = sampler.sample_table(name, key);
        table[key] = listed ? json::array({std::move(value)}) : std::move(value);
        return wrap(std::move(table));
      };
      find_paths(definitions, sampler, below, here, paths);
    }
  }
}

TEST(Documents, ReaderKnowsEveryKeyOfTheSchemaAndNoOther) {
  const json schema = json::parse(scene_schema());
  const Sampler sampler(schema);
  std::map<std::string, Wrap> paths;
  find_paths(
      schema["$defs"], sampler, "scene", [](json value) { return value; }, paths);
  EXPECT_EQ(paths.size(), schema["$defs"].size());
  for (const auto& [name, wrap] : paths) {
    for (const auto& [key, value] : schema["$defs"][name]["properties"].items()) {
      const std::string said = error_message(wrap(sampler.sample_table(name, key)).dump());
      EXPECT_EQ(said.find("unknown key"), std::string::npos) << name << "." << key << ": " << said;
    }
    json unknown = sampler.sample_table(name, "");
    unknown["no_key_is_called_so"] = 1;
    EXPECT_NE(error_message(wrap(unknown).dump()).find("no_key_is_called_so: unknown key"), std::string::npos)
        << name;
  }
}

/// The reader has the limits of the schema: it rejects values just outside.
TEST(Documents, RangesOfTheSchemaAreThoseOfTheReader) {
  const json schema = json::parse(scene_schema());
  const Sampler sampler(schema);
  std::map<std::string, Wrap> paths;
  find_paths(
      schema["$defs"], sampler, "scene", [](json value) { return value; }, paths);
  int numbers = 0;
  for (const auto& [name, wrap] : paths) {
    for (const auto& [key, value] : schema["$defs"][name]["properties"].items()) {
      const std::string type = value.value("type", "");
      if (type != "number" && type != "integer") continue;
      ++numbers;
      const double below = value.contains("minimum") ? value["minimum"].get<double>() - 1
                                                     : value["exclusiveMinimum"].get<double>();
      const double above = value.contains("maximum") ? value["maximum"].get<double>() + 1
                                                     : value["exclusiveMaximum"].get<double>();
      for (const double outside : {below, above}) {
        // Beyond 1e6 a float cannot represent a step of one; a tenth more works.
        const double x = std::abs(outside) > 1e6 ? outside * 1.1 : outside;
        json table = sampler.sample_table(name, key);
        table[key] = x;
        const std::string said = error_message(wrap(table).dump());
        EXPECT_NE(said.find(key + ": expected a"), std::string::npos)
            << name << "." << key << " = " << x << ": " << said;
      }
    }
  }
  EXPECT_GT(numbers, 80);
}

TEST(Documents, ManualExampleIsAScene) {
  const std::string manual = scene_manual();
  const std::size_t begin = manual.find("```json\n") + 8;
  EXPECT_EQ(error_message(manual.substr(begin, manual.find("```", begin) - begin)), "");
}

}  // namespace souple::scene_test::test_scene_documents
