#include "souple/error.h"
#include "souple/mesh_files/mesh_groups.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/tet_builder.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include <fmt/core.h>

namespace souple {

namespace {

using mesh_detail::TagIndex;
using mesh_detail::TextScanner;

/// First-order elements in the groups of a tet mesh.
struct ElementType {
  std::int64_t code;
  std::size_t nodes;
  int dimension;
};
constexpr std::array<ElementType, 4> kept_types = {{{15, 1, 0}, {1, 2, 1}, {2, 3, 2}, {4, 4, 3}}};
constexpr std::int64_t tet_code = 4;

// Volumes that are not tets of four nodes: without them the body would have holes.
constexpr std::array<std::int64_t, 14> other_volumes = {5, 6, 7, 11, 12, 13, 14, 17, 18, 19, 29, 30, 31, 92};

const ElementType* find_type(std::int64_t code) {
  const auto found = std::find_if(kept_types.begin(), kept_types.end(),
                                  [&](const ElementType& type) { return type.code == code; });
  return found == kept_types.end() ? nullptr : &*found;
}

using DimensionTag = std::pair<int, std::int64_t>;

class MshReader {
 public:
  MshReader(std::string_view text, const std::string& name) : scanner_(text, name, {}) {}

  TetMesh read() {
    const std::string_view first = scanner_.word_on_any_line();
    if (first != "$MeshFormat")
      scanner_.fail(scanner_.found(first), "\"$MeshFormat\", with which a Gmsh file begins");
    read_format();
    std::string_view section = scanner_.word_on_any_line();
    while (!section.empty()) {
      read_section(section);
      section = scanner_.word_on_any_line();
    }
    if (mesh_.tets.empty()) {
      scanner_.fail("no tet in the whole file",
                    "at least one; mesh in 3D, and save all or a physical volume");
    }
    mesh_.groups = groups_.finish();
    return std::move(mesh_);
  }

 private:
  void read_format() {
    const std::string_view version = scanner_.word_on_any_line();
    if (version != "2.2" && version != "4.1") {
      scanner_.fail("version " + scanner_.found(version), "2.2 or 4.1 (gmsh -format msh41)");
    }
    is_version_4_ = version == "4.1";
    if (scanner_.integer("file type") != 0) {
      scanner_.fail("a binary Gmsh file", "an ASCII one (gmsh -setnumber Mesh.Binary 0)");
    }
    scanner_.integer("data size");
    expect("$EndMeshFormat");
  }

  void expect(std::string_view keyword) {
    const std::string_view word = scanner_.word_on_any_line();
    if (word != keyword) scanner_.fail(scanner_.found(word), mesh_detail::quoted(keyword));
  }

  void read_section(std::string_view section) {
    if (section == "$PhysicalNames")
      read_physical_names();
    else if (section == "$Entities" && is_version_4_)
      read_entities();
    else if (section == "$Nodes")
      read_nodes();
    else if (section == "$Elements")
      read_elements();
    else if (section[0] == '$')
      return skip_section(section);
    else
      scanner_.fail(mesh_detail::quoted(section), "a section such as $Nodes");
    expect("$End" + std::string(section.substr(1)));
  }

  void skip_section(std::string_view section) {
    const std::string end = "$End" + std::string(section.substr(1));
    const std::size_t begin_line = scanner_.line();
    while (scanner_.next_line()) {
      if (scanner_.word() == end) return;
    }
    scanner_.fail_at(begin_line, mesh_detail::quoted(section) + " without an end", mesh_detail::quoted(end));
  }

  // DIMENSION TAG "NAME"
  void read_physical_names() {
    const std::size_t count = scanner_.count("number of physical names", 6);
    for (std::size_t i = 0; i < count; ++i) {
      const int dimension = read_dimension();
      const std::int64_t tag = scanner_.integer("tag of a physical group");
      std::string_view name = scanner_.rest_of_line();
      if (name.size() < 3 || name.front() != '"' || name.back() != '"')
        scanner_.fail(mesh_detail::quoted(name), "a name in quotes");
      name = name.substr(1, name.size() - 2);
      if (!physical_names_.emplace(DimensionTag{dimension, tag}, std::string(name)).second) {
        scanner_.fail(fmt::format("a second name of physical group {}", tag), "one name each");
      }
    }
  }

  int read_dimension() {
    const std::int64_t dimension = scanner_.integer("dimension");
    if (dimension < 0 || dimension > 3)
      scanner_.fail(fmt::format("{}", dimension), "a dimension from 0 to 3");
    return int(dimension);
  }

  // POINTS CURVES SURFACES VOLUMES, then a line each: TAG BOX COUNT PHYSICAL... [COUNT BOUNDARY...]
  void read_entities() {
    std::array<std::size_t, 4> counts{};
    for (std::size_t& count : counts) count = scanner_.count("number of entities", 10);
    for (int dimension = 0; dimension < 4; ++dimension) {
      for (std::size_t i = 0; i < counts[std::size_t(dimension)]; ++i) read_entity(dimension);
    }
  }

  void read_entity(int dimension) {
    const std::int64_t tag = scanner_.integer("tag of an entity");
    const int box_numbers = dimension == 0 ? 3 : 6;
    for (int i = 0; i < box_numbers; ++i) scanner_.real("box of an entity");
    const std::size_t count = scanner_.count("number of physical groups", 2);
    // A short file could otherwise demand any amount of memory.
    if (count > mesh_detail::most_groups_at_once)
      scanner_.fail(fmt::format("{} physical groups at once", count), "at most 16");
    std::vector<std::string> names;
    // A negative tag means the entity with reversed orientation.
    for (std::size_t i = 0; i < count; ++i)
      names.push_back(group_name(dimension, scanner_.integer("physical group")));
    if (!names.empty() && !entity_groups_.emplace(DimensionTag{dimension, tag}, std::move(names)).second) {
      scanner_.fail(fmt::format("a second entity {}", tag), "each entity once");
    }
    scanner_.rest_of_line();
  }

  std::string group_name(int dimension, std::int64_t tag) const {
    const auto named = physical_names_.find({dimension, tag < 0 && tag != INT64_MIN ? -tag : tag});
    if (named != physical_names_.end()) return named->second;
    constexpr std::array<const char*, 4> kinds = {"point_", "curve_", "surface_", "volume_"};
    return fmt::format("{}{}", kinds[std::size_t(dimension)], tag);
  }

  void read_nodes() {
    if (tags_.size() > 0) scanner_.fail("a second $Nodes", "one");
    if (is_version_4_)
      read_nodes_4();
    else
      read_nodes_2();
    std::int64_t duplicate = 0;
    if (!tags_.finish(duplicate)) scanner_.fail(fmt::format("node {} twice", duplicate), "each node once");
  }

  // COUNT, then lines TAG X Y Z
  void read_nodes_2() {
    const std::size_t count = node_count("number of nodes", 8);
    for (std::size_t i = 0; i < count; ++i) {
      tags_.add(scanner_.integer("tag of a node"));
      read_position();
    }
  }

  // BLOCKS COUNT MIN MAX, then blocks: DIMENSION ENTITY PARAMETRIC COUNT, a line per tag, a line per X Y Z [U
  // V W]
  void read_nodes_4() {
    const std::size_t blocks = scanner_.count("number of node blocks", 8);
    const std::size_t count = node_count("number of nodes", 8);
    scanner_.integer("smallest node tag");
    scanner_.integer("largest node tag");
    for (std::size_t block = 0; block < blocks; ++block) {
      read_dimension();
      scanner_.integer("entity of a node block");
      scanner_.integer("whether nodes are parametric");
      const std::size_t in_block = scanner_.count("nodes of a block", 8);
      if (in_block > count - mesh_.positions.size()) {
        scanner_.fail(fmt::format("{} nodes in a block", in_block),
                      fmt::format("no more in all than the {} that the section counts", count));
      }
      for (std::size_t i = 0; i < in_block; ++i) tags_.add(scanner_.integer("tag of a node"));
      for (std::size_t i = 0; i < in_block; ++i) read_position();
    }
    if (mesh_.positions.size() != count) {
      scanner_.fail(fmt::format("{} nodes", mesh_.positions.size()), fmt::format("{}, as counted", count));
    }
  }

  std::size_t node_count(const char* what, std::size_t bytes_each) {
    const std::size_t count = scanner_.count(what, bytes_each);
    if (count >= 0xffffffff) scanner_.fail(fmt::format("{} nodes", count), "fewer than 2^32 - 1");
    mesh_.positions.reserve(count);
    tags_.reserve(count);
    return count;
  }

  void read_position() {
    const double x = scanner_.coordinate("x"), y = scanner_.coordinate("y"), z = scanner_.coordinate("z");
    mesh_.positions.emplace_back(x, y, z);
    scanner_.rest_of_line();
  }

  void read_elements() {
    if (mesh_.positions.empty()) scanner_.fail("$Elements", "$Nodes before it");
    if (has_elements_) scanner_.fail("a second $Elements", "one");
    has_elements_ = true;
    if (is_version_4_)
      read_elements_4();
    else
      read_elements_2();
    std::int64_t duplicate = 0;
    if (!element_tags_.finish(duplicate)) {
      scanner_.fail(fmt::format("element {} twice", duplicate), "each element once");
    }
  }

  // COUNT, then lines TAG TYPE COUNT PHYSICAL GEOMETRIC ... NODE...
  void read_elements_2() {
    const std::size_t count = scanner_.count("number of elements", 8);
    for (std::size_t i = 0; i < count; ++i) {
      element_tags_.add(scanner_.integer("tag of an element"));
      const std::int64_t code = scanner_.integer("type of an element");
      const ElementType* type = checked_type(code);
      const std::size_t tag_count = scanner_.count("number of tags", 2);
      std::int64_t physical = 0;
      for (std::size_t tag = 0; tag < tag_count; ++tag) {
        const std::int64_t value = scanner_.integer("tag of an element");
        if (tag == 0) physical = value;
      }
      if (type == nullptr) {
        scanner_.rest_of_line();
        continue;
      }
      std::vector<std::uint32_t>* group =
          physical == 0 ? nullptr : &groups_[group_name(type->dimension, physical)];
      read_element(*type, {&group, group == nullptr ? 0u : 1u});
    }
  }

  // BLOCKS COUNT MIN MAX, then blocks: DIMENSION ENTITY TYPE COUNT, lines TAG NODE...
  void read_elements_4() {
    const std::size_t blocks = scanner_.count("number of element blocks", 8);
    scanner_.count("number of elements", 4);
    scanner_.integer("smallest element tag");
    scanner_.integer("largest element tag");
    for (std::size_t block = 0; block < blocks; ++block) {
      const int dimension = read_dimension();
      const std::int64_t entity = scanner_.integer("entity of an element block");
      const std::int64_t code = scanner_.integer("type of an element");
      const std::size_t count = scanner_.count("elements of a block", 4);
      const ElementType* type = count == 0 ? nullptr : checked_type(code);
      if (type != nullptr && type->dimension != dimension) {
        scanner_.fail(fmt::format("elements of type {} in an entity of dimension {}", code, dimension),
                      fmt::format("dimension {}", type->dimension));
      }
      std::vector<std::vector<std::uint32_t>*> groups;
      const auto named = entity_groups_.find({dimension, entity});
      if (named != entity_groups_.end()) {
        for (const std::string& name : named->second) groups.push_back(&groups_[name]);
      }
      for (std::size_t i = 0; i < count; ++i) {
        element_tags_.add(scanner_.integer("tag of an element"));
        if (type == nullptr)
          scanner_.rest_of_line();
        else
          read_element(*type, groups);
      }
    }
  }

  const ElementType* checked_type(std::int64_t code) const {
    if (std::find(other_volumes.begin(), other_volumes.end(), code) != other_volumes.end()) {
      scanner_.fail(fmt::format("a volume element of Gmsh type {}", code),
                    "tets of four nodes only (type 4, order 1)");
    }
    return find_type(code);
  }

  void read_element(const ElementType& type, std::span<std::vector<std::uint32_t>* const> groups) {
    Tet corners{};
    for (std::size_t i = 0; i < type.nodes; ++i) {
      const std::int64_t tag = scanner_.integer("node of an element");
      corners[i] = tags_.find(tag);
      if (corners[i] == TagIndex::none)
        scanner_.fail(fmt::format("node {}", tag), "a node that $Nodes lists");
    }
    if (type.code == tet_code && !mesh_detail::append_oriented(mesh_, corners)) {
      scanner_.fail("a flat tet", "a tet with a volume");
    }
    for (std::vector<std::uint32_t>* group : groups) {
      group->insert(group->end(), corners.begin(), corners.begin() + std::ptrdiff_t(type.nodes));
    }
    scanner_.rest_of_line();
  }

  TextScanner scanner_;
  bool is_version_4_ = false;
  bool has_elements_ = false;
  TetMesh mesh_;
  TagIndex tags_, element_tags_;
  std::map<DimensionTag, std::string> physical_names_;
  std::map<DimensionTag, std::vector<std::string>> entity_groups_;
  mesh_detail::GroupBuilder groups_;
};

}  // namespace

TetMesh parse_msh(std::string_view text, const std::string& name) {
  return MshReader(text, name).read();
}

}  // namespace souple
