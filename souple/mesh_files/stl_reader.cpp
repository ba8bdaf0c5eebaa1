#include "souple/files/file.h"
#include "souple/mesh_files/mesh_bytes.h"
#include "souple/mesh_files/mesh_groups.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/mesh_text.h"

#include <fmt/core.h>

namespace souple {

namespace {

using mesh_detail::ByteScanner;
using mesh_detail::TextScanner;

constexpr std::size_t header_bytes = 80;
constexpr std::size_t triangle_bytes = 50;
constexpr std::size_t most_triangles = 0xffffffff / 3;

/// The count of a binary STL determines its length. Otherwise a file is text if a facet (or the
/// end) follows its first line "solid NAME".
bool is_ascii(std::string_view bytes, const std::string& name) {
  if (bytes.size() >= header_bytes + 4) {
    const std::uint64_t count =
        ByteScanner(bytes.substr(header_bytes), name, false).read<std::uint32_t>("the number of triangles");
    if (bytes.size() == header_bytes + 4 + count * triangle_bytes) return false;
  }
  TextScanner scanner(bytes, name, {});
  if (lower_case(scanner.word_on_any_line().substr(0, 16)) != "solid") return false;
  // Too short for a binary file: let the text's errors name the line.
  if (bytes.size() < header_bytes + 4) return true;
  scanner.next_line();
  const std::string second = lower_case(scanner.word_on_any_line().substr(0, 16));
  return second == "facet" || second == "endsolid";
}

void append_triangle(TriangleMesh& mesh) {
  const auto last = std::uint32_t(mesh.positions.size());
  mesh.triangles.push_back({last - 3, last - 2, last - 1});
}

class AsciiReader {
 public:
  AsciiReader(std::string_view text, const std::string& name) : scanner_(text, name, {}) {}

  TriangleMesh read() {
    std::string word = next();
    do {
      if (word != "solid") scanner_.fail(scanner_.found(word), "\"solid\"");
      read_solid();
      word = next();
    } while (!word.empty());
    if (mesh_.positions.empty()) scanner_.fail("no facet in the whole file", "at least one");
    mesh_.groups = groups_.finish();
    return std::move(mesh_);
  }

 private:
  std::string next() { return lower_case(scanner_.word_on_any_line()); }

  void expect(const char* keyword) {
    const std::string_view word = scanner_.word_on_any_line();
    if (lower_case(word) != keyword) {
      scanner_.fail(scanner_.found(word), '"' + std::string(keyword) + '"');
    }
  }

  void read_solid() {
    const std::string solid(scanner_.rest_of_line());
    const std::size_t begin = mesh_.positions.size();
    while (true) {
      const std::string_view word = scanner_.word_on_any_line();
      const std::string keyword = lower_case(word);
      if (keyword == "endsolid") break;
      if (keyword != "facet") scanner_.fail(scanner_.found(word), "\"facet\" or \"endsolid\"");
      read_facet();
    }
    scanner_.rest_of_line();
    if (solid.empty()) return;
    std::vector<std::uint32_t>& group = groups_[solid];
    for (std::size_t i = begin; i < mesh_.positions.size(); ++i) group.push_back(std::uint32_t(i));
  }

  void read_facet() {
    // Many writers store normals of zero length or NaN: computes normals from the corners.
    expect("normal");
    for (int i = 0; i < 3; ++i) {
      if (scanner_.word().empty()) scanner_.fail(scanner_.found({}), "three numbers of the normal");
    }
    expect("outer");
    expect("loop");
    if (mesh_.triangles.size() == most_triangles)
      scanner_.fail("too many facets", "fewer than 2^32 vertices");
    for (int i = 0; i < 3; ++i) {
      expect("vertex");
      const double x = scanner_.coordinate("x"), y = scanner_.coordinate("y"), z = scanner_.coordinate("z");
      mesh_.positions.emplace_back(x, y, z);
    }
    append_triangle(mesh_);
    expect("endloop");
    expect("endfacet");
  }

  TextScanner scanner_;
  TriangleMesh mesh_;
  mesh_detail::GroupBuilder groups_;
};

TriangleMesh read_binary(std::string_view bytes, const std::string& name) {
  ByteScanner scanner(bytes, name, false);
  scanner.skip(header_bytes, "the 80 bytes that begin a binary STL (it is no ASCII one)");
  const auto count = scanner.read<std::uint32_t>("the number of triangles");
  scanner.require_room(count, triangle_bytes, "triangles");
  if (scanner.remaining() != std::size_t(count) * triangle_bytes) {
    scanner.fail(
        fmt::format("{} bytes", scanner.remaining()),
        fmt::format("{}, 50 for each of its {} triangles", std::size_t(count) * triangle_bytes, count));
  }
  if (count == 0) scanner.fail("no triangle", "at least one");
  if (count > most_triangles) scanner.fail(fmt::format("{} triangles", count), "fewer than 2^32 vertices");
  TriangleMesh mesh;
  mesh.positions.reserve(3 * std::size_t(count));
  mesh.triangles.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    scanner.skip(12, "a normal");
    for (int corner = 0; corner < 3; ++corner) {
      const float x = scanner.real32("x"), y = scanner.real32("y"), z = scanner.real32("z");
      mesh.positions.emplace_back(double(x), double(y), double(z));
    }
    append_triangle(mesh);
    scanner.skip(2, "the attribute of a triangle");
  }
  return mesh;
}

}  // namespace

TriangleMesh parse_stl(std::string_view bytes, const std::string& name) {
  return is_ascii(bytes, name) ? AsciiReader(bytes, name).read() : read_binary(bytes, name);
}

}  // namespace souple
