#include "souple/scene/keys.h"
#include "souple/scene/scene.h"

#include <algorithm>
#include <map>

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

/// {"oneOf": [{"required": ["a"]}, {"required": ["b"]}]}; for "at most one" also neither.
Json one_of(const std::vector<std::string>& keys, bool none_allowed) {
  Json choices = Json::array();
  for (const std::string& key : keys) choices.items.push_back(Json::object({{"required", texts({key})}}));
  if (none_allowed) choices.items.push_back(Json::object({{"not", Json::object({{"anyOf", choices}})}}));
  return Json::object({{"oneOf", std::move(choices)}});
}

Json schema_of(const TableInfo& table) {
  Json schema = Json::object({{"description", Json::of(table.doc)},
                              {"type", Json::of("object")},
                              {"additionalProperties", Json::of(false)},
                              {"properties", properties_of(table)}});
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

// --- the page ----------------------------------------------------------------------------------------------

/// The tables that one key chooses from stand in one section: kinds of objects, their materials, their meshes.
struct Section {
  std::string name;
  std::vector<const TableInfo*> tables;
};

/// A key of one or of several tables of a section.
struct Row {
  std::string key, fallback, doc;
  std::vector<std::string> types, tables;
  std::vector<std::string> references;  ///< tables that a value contains
  bool is_table = false;                ///< a value is one table, not a list
};

void add_new(std::vector<std::string>& words, const std::string& word) {
  if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
}

std::string joined(const std::vector<std::string>& words, const char* between, const char* quote) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + (quote + word + quote);
  return out;
}

/// Adds the names of the tables that a schema refers to.
void add_references(const Json& schema, std::vector<std::string>& names) {
  if (const Json* reference = schema.find("$ref"))
    add_new(names, reference->text.substr(std::string_view("#/$defs/").size()));
  if (const Json* items = schema.find("items")) add_references(*items, names);
  if (const Json* choices = schema.find("oneOf"))
    for (const Json& choice : choices->items) add_references(choice, names);
}

Row row_of(const KeyInfo& key, const TableInfo& table) {
  Row row;
  row.key = key.name, row.doc = key.doc, row.types = {key.type}, row.tables = {table.name};
  if (key.required) row.fallback = "required";
  if (key.fallback) row.fallback = "`" + scene_format::dump_line(*key.fallback) + "`";
  for (const auto& [name, other] : table.needs)
    if (name == key.name) row.doc += ". Only with `" + other + "`";
  add_references(key.schema, row.references);
  row.is_table = key.schema.find("$ref") != nullptr;
  return row;
}

/// Adds a row of one table below the other rows of its key, or only its table to a row that says as much.
void add_row(const Row& row, std::vector<Row>& rows) {
  auto place = rows.end();
  for (auto it = rows.begin(); it != rows.end(); ++it) {
    if (it->key != row.key) continue;
    place = it + 1;
    const bool known = std::find(it->types.begin(), it->types.end(), row.types[0]) != it->types.end();
    const bool range = row.types[0].find("number") != std::string::npos;
    if (it->fallback != row.fallback || it->doc != row.doc || (range && !known)) continue;
    add_new(it->types, row.types[0]);
    add_new(it->tables, row.tables[0]);
    for (const std::string& name : row.references) add_new(it->references, name);
    return;
  }
  rows.insert(place, row);
}

std::vector<Row> rows_of(const Section& section) {
  std::vector<Row> rows;
  for (const TableInfo* table : section.tables)
    for (const KeyInfo& key : table->keys) add_row(row_of(key, *table), rows);
  return rows;
}

std::vector<std::string> rules_of(const TableInfo& table) {
  std::vector<std::string> rules;
  for (const auto& keys : table.exactly_one)
    rules.push_back("Exactly one of " + joined(keys, ", ", "`") + ".");
  for (const auto& keys : table.at_most_one)
    rules.push_back("At most one of " + joined(keys, ", ", "`") + ".");
  return rules;
}

/// The text of a key whose table has no section.
std::string doc_with_table(const std::string& doc, const TableInfo& table) {
  std::string out = table.doc.find(doc.substr(1)) == 1 ? table.doc : doc + ". " + table.doc;
  for (const std::string& rule : rules_of(table)) out += " " + rule;
  return out;
}

/// Lines about some tables of a section, each line once.
class Lines {
 public:
  void add(const std::string& line, const std::string& table) {
    for (auto& [known, tables] : lines_)
      if (known == line) return tables.push_back(table);
    lines_.push_back({line, {table}});
  }
  auto begin() const { return lines_.begin(); }
  auto end() const { return lines_.end(); }

 private:
  std::vector<std::pair<std::string, std::vector<std::string>>> lines_;
};

class Page {
 public:
  explicit Page(const scene_format::Format& format) {
    for (const auto& table : format.tables) sections_.push_back({table->name, {table.get()}});
    while (join_two() || join_alike()) continue;
    for (const Section& section : sections_)
      for (const Row& row : rows_of(section))
        for (const std::string& name : row.references)
          uses_[sections_[index_of(name)].name] += row.is_table ? 1 : 2;
  }

  std::string text() const {
    std::string out;
    for (const Section& section : sections_)
      if (!stands_in_row(section)) out += text_of(section);
    return out;
  }

 private:
  std::size_t index_of(const std::string& table) const {
    const auto has = [&](const Section& section) {
      return std::any_of(section.tables.begin(), section.tables.end(),
                         [&](const TableInfo* one) { return one->name == table; });
    };
    return static_cast<std::size_t>(std::find_if(sections_.begin(), sections_.end(), has) -
                                    sections_.begin());
  }

  /// Joins two sections that one key of one section chooses from. False: no such two are left.
  bool join_two() {
    for (const Section& section : sections_) {
      std::map<std::string, std::size_t> first;
      for (const Row& row : rows_of(section)) {
        for (const std::string& name : row.references) {
          const std::size_t a = index_of(name), b = first.try_emplace(row.key, a).first->second;
          if (a == b) continue;
          join(std::min(a, b), std::max(a, b), row.key);
          return true;
        }
      }
    }
    return false;
  }
  /// Joins two sections with many equal rows, such as those of keys that select vertices.
  bool join_alike() {
    constexpr std::size_t many = 5;
    for (std::size_t b = 1; b < sections_.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        Section both = sections_[a];
        both.tables.insert(both.tables.end(), sections_[b].tables.begin(), sections_[b].tables.end());
        const std::size_t apart = rows_of(sections_[a]).size() + rows_of(sections_[b]).size();
        if (rows_of(both).size() + many > apart) continue;
        join(a, b, sections_[a].name);
        return true;
      }
    }
    return false;
  }
  void join(std::size_t into, std::size_t from, const std::string& key) {
    std::vector<const TableInfo*>& tables = sections_[into].tables;
    tables.insert(tables.end(), sections_[from].tables.begin(), sections_[from].tables.end());
    sections_.erase(sections_.begin() + static_cast<std::ptrdiff_t>(from));
    const bool taken = index_of(key) < sections_.size();
    sections_[into].name = taken ? sections_[into].tables[0]->name : key;
  }

  /// Keys of a small table stand below the only row that refers to it.
  bool stands_in_row(const Section& section) const {
    const auto uses = uses_.find(section.name);
    return section.tables.size() == 1 && section.tables[0]->keys.size() <= 6 && uses != uses_.end() &&
           uses->second == 1;
  }

  /// Links of a type, which name tables, as links to their sections.
  std::string linked(std::string type) const {
    for (std::size_t at = type.find("](#"); at != std::string::npos; at = type.find("](#", at + 1)) {
      const std::size_t begin = at + 3, end = type.find(')', begin);
      type.replace(begin, end - begin, sections_[index_of(type.substr(begin, end - begin))].name);
    }
    return type;
  }

  /// `outer`: tables to whose rows the section belongs; empty: all.
  void add_rows(const Section& section, const std::string& prefix, const std::vector<std::string>& outer,
                std::vector<Row>& out) const {
    for (Row row : rows_of(section)) {
      row.key = prefix + row.key;
      if (row.tables.size() == section.tables.size()) row.tables = outer;
      const Section* inner = row.references.size() == 1 ? &sections_[index_of(row.references[0])] : nullptr;
      const bool here = inner != nullptr && stands_in_row(*inner);
      if (here) row.types = {"object"}, row.doc = doc_with_table(row.doc, *inner->tables[0]);
      out.push_back(row);
      if (here) add_rows(*inner, row.key + ".", row.tables, out);
    }
  }

  std::string table_of(const Section& section) const {
    std::vector<Row> rows;
    add_rows(section, "", {}, rows);
    const bool of_some = section.tables.size() > 1;
    std::string out = "| key | value | default | meaning |";
    out += of_some ? " of |\n|---|---|---|---|---|\n" : "\n|---|---|---|---|\n";
    for (const Row& row : rows) {
      out += "| `" + row.key + "` | " + linked(joined(row.types, " or ", "")) + " | " + row.fallback + " | " +
             row.doc + " |";
      out += of_some ? " " + joined(row.tables, ", ", "") + " |\n" : "\n";
    }
    return out + "\n";
  }

  std::string text_of(const Section& section) const {
    std::string out = "## " + section.name + "\n\n";
    Lines docs, rules;
    for (const TableInfo* table : section.tables) {
      docs.add(table->doc, table->name);
      for (const std::string& rule : rules_of(*table)) rules.add(rule, table->name);
    }
    const bool one = section.tables.size() == 1;
    for (const auto& [doc, tables] : docs)
      out += one ? doc + "\n" : "- " + joined(tables, ", ", "`") + ": " + doc + "\n";
    out += "\n" + table_of(section);
    for (const auto& [rule, tables] : rules) {
      const bool of_all = tables.size() == section.tables.size();
      out += (of_all ? rule : joined(tables, ", ", "`") + ": " + rule) + "\n\n";
    }
    return out;
  }

  std::vector<Section> sections_;
  std::map<std::string, int> uses_;  ///< of sections, by name: rows that refer to one, lists twice
};

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

Tables name keys of inner objects as `--set` does: `wind.gust` is the key `gust` of the object `wind`. Where several kinds of
object stand in one table, its last column names those that have the key; where it is empty, all have it.

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
  return scene_format::dump_json(
      Json::object({{"$schema", Json::of("https://json-schema.org/draft/2020-12/schema")},
                    {"title", Json::of("Souple scene")},
                    {"$ref", Json::of("#/$defs/scene")},
                    {"$defs", std::move(definitions)}}));
}

std::string scene_manual() {
  std::string out = introduction;
  out += Page(scene_tables()).text();
  while (out.size() > 1 && out[out.size() - 2] == '\n') out.pop_back();
  return out;
}

}  // namespace souple
