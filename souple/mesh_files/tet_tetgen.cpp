#include "souple/error.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/tet_builder.h"

#include <fmt/core.h>

namespace souple {

namespace {

using mesh_detail::TextScanner;

class TetgenReader {
 public:
  TetgenReader(std::string_view node_text, const std::string& node_name, std::string_view ele_text,
               const std::string& ele_name)
      : nodes_(node_text, node_name, {.comments = true}), tets_(ele_text, ele_name, {.comments = true}) {}

  TetMesh read() {
    read_nodes();
    read_tets();
    mesh_.groups = groups_.finish();
    return std::move(mesh_);
  }

 private:
  // COUNT 3 ATTRIBUTES MARKERS, then lines INDEX X Y Z [ATTRIBUTE ...] [MARKER]
  void read_nodes() {
    const std::size_t count = nodes_.count("number of nodes", 8);
    const std::int64_t dimension = nodes_.integer("dimension of the nodes");
    if (dimension != 3) nodes_.fail(fmt::format("dimension {}", dimension), "dimension 3");
    nodes_.rest_of_line();
    if (count == 0) nodes_.fail("no nodes", "at least four");
    if (count >= 0xffffffff) nodes_.fail(fmt::format("{} nodes", count), "fewer than 2^32 - 1");
    mesh_.positions.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t index = nodes_.integer("index of a node");
      if (i == 0 && index != 0 && index != 1) nodes_.fail(fmt::format("first index {}", index), "0 or 1");
      if (i == 0) first_ = index;
      if (index != first_ + std::int64_t(i)) {
        nodes_.fail(fmt::format("index {}", index),
                    fmt::format("{}, the next node", first_ + std::int64_t(i)));
      }
      const double x = nodes_.coordinate("x"), y = nodes_.coordinate("y"), z = nodes_.coordinate("z");
      mesh_.positions.emplace_back(x, y, z);
      nodes_.rest_of_line();
    }
    expect_end(nodes_, fmt::format("the end, since the first line counts {} nodes", count));
  }

  // COUNT 4 ATTRIBUTES, then lines INDEX A B C D [REGION]
  void read_tets() {
    const std::size_t count = tets_.count("number of tets", 10);
    const std::int64_t corners = tets_.integer("nodes per tet");
    if (corners != 4) {
      tets_.fail(fmt::format("{} nodes per tet", corners), "4 (run tetgen without -o2)");
    }
    const std::string_view attributes = tets_.word();
    const bool has_regions =
        !attributes.empty() && tets_.integer_from(attributes, "number of attributes") > 0;
    tets_.rest_of_line();
    if (count == 0) tets_.fail("no tets", "at least one");
    mesh_.tets.reserve(count);
    for (std::size_t i = 0; i < count; ++i) read_tet(i, has_regions);
    expect_end(tets_, fmt::format("the end, since the first line counts {} tets", count));
  }

  void read_tet(std::size_t i, bool has_regions) {
    const std::int64_t index = tets_.integer("index of a tet");
    if (index != first_ + std::int64_t(i)) {
      tets_.fail(fmt::format("index {}", index), fmt::format("{}, the next tet", first_ + std::int64_t(i)));
    }
    Tet tet{};
    for (std::uint32_t& corner : tet) {
      const std::int64_t node = tets_.integer("node of a tet");
      const std::int64_t last = first_ + std::int64_t(mesh_.positions.size()) - 1;
      if (node < first_ || node > last) {
        tets_.fail(fmt::format("node {}", node), fmt::format("{} to {}", first_, last));
      }
      corner = std::uint32_t(node - first_);
    }
    if (!mesh_detail::append_oriented(mesh_, tet)) {
      tets_.fail(fmt::format("the flat tet {}", index), "a tet with a volume");
    }
    if (has_regions) {
      const auto region = std::int64_t(tets_.coordinate_from(tets_.word(), "region of a tet"));
      std::vector<std::uint32_t>& group = groups_[fmt::format("region_{}", region)];
      group.insert(group.end(), tet.begin(), tet.end());
    }
    tets_.rest_of_line();
  }

  static void expect_end(TextScanner& scanner, const std::string& expected) {
    const std::string_view word = scanner.word_on_any_line();
    if (!word.empty()) scanner.fail(scanner.found(word), expected);
  }

  TextScanner nodes_, tets_;
  TetMesh mesh_;
  mesh_detail::GroupBuilder groups_;
  std::int64_t first_ = 0;
};

}  // namespace

TetMesh parse_tetgen(std::string_view node_text, const std::string& node_name, std::string_view ele_text,
                     const std::string& ele_name) {
  return TetgenReader(node_text, node_name, ele_text, ele_name).read();
}

}  // namespace souple
