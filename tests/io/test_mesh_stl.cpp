#include "mesh_expect.h"
#include "souple/mesh_files/mesh_parse.h"

#include <vector>

namespace souple::test_io_mesh_stl {

TriangleMesh parse(const std::string& bytes) {
  return parse_stl(bytes, "a.stl");
}

const std::string facet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1.5 0\n endloop\nendfacet\n";

std::string binary(std::string title, std::uint32_t claimed, int triangles) {
  title.resize(80, ' ');
  std::string bytes = title + bytes_of(false, claimed);
  for (int i = 0; i < triangles; ++i) {
    bytes +=
        bytes_of(false, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.5f, float(i), std::uint16_t(0));
  }
  return bytes;
}

TEST(StlReader, ReadsAsciiInAnyCase) {
  std::string capitals =
      "solid part one\n" + facet + facet + "endsolid part one\nsolid two\n" + facet + "endsolid two\n";
  const TriangleMesh mesh = parse(capitals);
  EXPECT_EQ(mesh.positions.size(), 9u);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}));
  EXPECT_EQ(mesh.groups.at("part one").size(), 6u);
  EXPECT_EQ(mesh.groups.at("two").front(), 6u);
  for (char& c : capitals) c = c >= 'a' && c <= 'z' ? char(c - 32) : c;
  EXPECT_EQ(parse(capitals).positions, mesh.positions);
}

TEST(StlReader, ReadsBinaryEvenIfItBeginsWithSolid) {
  for (const char* title : {"anything", "solid part", "solid part\nfacet normal"}) {
    const TriangleMesh mesh = parse(binary(title, 3, 3));
    ASSERT_EQ(mesh.positions.size(), 9u) << title;
    EXPECT_EQ(mesh.positions[8], Vec3d(0, 1.5, 2));
  }
}

TEST(StlReader, NamesFileAndPlaceOfBadInput) {
  expect_error([] { parse("solid a\n" + facet + "facets\n"); }, {"a.stl:9:", "\"facets\"", "endsolid"});
  expect_error([] { parse("solid a\n" + facet); }, {"a.stl:9:", "end of the file"});
  expect_error([] { parse("solid\nfacet normal 0 0 1 outer loop vertex 0 0 nan"); }, {"a.stl:2:", "\"nan\""});
  expect_error([] { parse("solid a\nendsolid a\n"); }, {"a.stl:3:", "no facet"});
  expect_error([] { parse(""); }, {"a.stl: byte 0", "80 bytes"});
  expect_error([] { parse(binary("x", 4000000000u, 1)); }, {"a.stl: byte 84", "4000000000", "at most 1"});
  expect_error([] { parse(binary("solid x", 1, 2)); }, {"a.stl: byte 84", "100 bytes", "50"});
  expect_error([] { parse(binary("x", 0, 0)); }, {"a.stl", "no triangle"});
}

}  // namespace souple::test_io_mesh_stl
