#include "mesh_expect.h"
#include "souple/mesh_files/mesh_parse.h"

#include <vector>

namespace souple::test_io_mesh_tets {

using Indices = std::vector<std::uint32_t>;

double volume(const TetMesh& mesh, const Tet& t) {
  const Vec3d a = mesh.positions[t[0]];
  return dot(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a), mesh.positions[t[3]] - a) / 6.0;
}

/// Two tets over a square base, the second inside out in the file; each format tells the same mesh.
void expect_two_tets(const TetMesh& mesh) {
  ASSERT_EQ(mesh.positions.size(), 5u);
  EXPECT_EQ(mesh.positions[4], Vec3d(1, 1, 1));
  ASSERT_EQ(mesh.tets.size(), 2u);
  EXPECT_EQ(mesh.tets[0], (Tet{0, 1, 2, 3}));
  EXPECT_EQ(mesh.tets[1], (Tet{1, 4, 2, 3}));
  EXPECT_NEAR(volume(mesh, mesh.tets[0]), 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(volume(mesh, mesh.tets[1]), 1.0 / 3.0, 1e-15);
}

const std::string format_2 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string nodes_2 = "$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n7 1 1 1\n$EndNodes\n";
const std::string names = "$PhysicalNames\n2\n3 1 \"the body\"\n2 5 \"clamp\"\n$EndPhysicalNames\n";
const std::string elements_2 =
    "$Elements\n3\n1 2 2 5 1 10 20 30\n2 4 2 1 1 10 20 30 40\n3 4 2 9 1 20 7 40 30\n$EndElements\n";
const std::string format_4 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
const std::string entities_4 =
    "$Entities\n1 0 1 2\n1 0 0 0 0\n3 0 0 0 1 1 0 1 5 0\n1 0 0 0 1 1 1 1 1 1 3\n2 0 0 0 1 1 1 0 "
    "0\n$EndEntities\n";
const std::string nodes_4 =
    "$Nodes\n2 5 7 40\n2 3 0 3\n10\n20\n30\n0 0 0\n1 0 0\n0 1 0\n3 1 0 2\n40\n7\n0 0 1\n1 1 1\n$EndNodes\n";
const std::string elements_4 =
    "$Elements\n3 3 1 3\n2 3 2 1\n1 10 20 30\n3 1 4 1\n2 10 20 30 40\n3 2 4 1\n3 20 7 40 30\n$EndElements\n";

TetMesh msh(const std::string& text) {
  return parse_msh(text, "a.msh");
}

TEST(MshReader, ReadsVersion2) {
  const TetMesh mesh = msh(format_2 + names + nodes_2 + "$Comments\nhi\n$EndComments\n" + elements_2);
  expect_two_tets(mesh);
  EXPECT_EQ(mesh.groups.size(), 3u);
  EXPECT_EQ(mesh.groups.at("the body"), (Indices{0, 1, 2, 3}));
  EXPECT_EQ(mesh.groups.at("clamp"), (Indices{0, 1, 2}));
  EXPECT_EQ(mesh.groups.at("volume_9"), (Indices{1, 2, 3, 4}));
}

TEST(MshReader, ReadsVersion4) {
  const TetMesh mesh = msh(format_4 + names + entities_4 + nodes_4 + elements_4);
  expect_two_tets(mesh);
  EXPECT_EQ(mesh.groups.size(), 2u);
  EXPECT_EQ(mesh.groups.at("the body"), (Indices{0, 1, 2, 3}));
  EXPECT_EQ(mesh.groups.at("clamp"), (Indices{0, 1, 2}));
}

TEST(MshReader, NamesFileAndLineOfBadInput) {
  const auto elements = [](const std::string& line) {
    return format_2 + nodes_2 + "$Elements\n1\n" + line + "\n$EndElements\n";
  };
  expect_bad(
      msh,
      {{"", {"a.msh:1:", "$MeshFormat"}},
       {"$MeshFormat\n3.0 0 8\n", {"a.msh:2:", "3.0", "2.2 or 4.1"}},
       {"$MeshFormat\n4.1 1 8\n", {"a.msh:2:", "binary", "Mesh.Binary 0"}},
       {format_2 + "$Nodes\n1000000000\n1 0 0 0\n$EndNodes\n", {"a.msh:5:", "1000000000", "long enough"}},
       {format_4 + "$Nodes\n1 99999999 1 1\n", {"a.msh:5:", "99999999", "long enough"}},
       {format_2 + "$Nodes\n2\n1 0 0 0\n1 1 1 1\n$EndNodes\n", {"a.msh:", "node 1 twice"}},
       {format_2 + nodes_2, {"a.msh:", "no tet"}},
       {format_2 + elements_2, {"a.msh:4:", "$Nodes before"}},
       {elements("1 4 2 1 1 10 20 30 41"), {"a.msh:14:", "node 41"}},
       {elements("1 4 2 1 1 10 20 30 30"), {"a.msh:14:", "flat"}},
       {elements("1 4 2 1 1 10 20 30"), {"a.msh:15:", "$EndElements", "node of an element"}},
       {elements("1 5 2 1 1 10 20 30 40 7 10 20 30"), {"a.msh:14:", "type 5", "tets of four nodes"}},
       {elements("1 11 2 1 1 10 20 30 40 7 7 7 7 7 7"), {"a.msh:14:", "type 11"}},
       {format_2 + nodes_2 + "$Elements\n2\n1 4 0 10 20 30 40\n1 4 0 10 20 30 40\n$EndElements\n",
        {"a.msh:", "element 1 twice"}},
       {format_2 + "$Nodes\n1\n1 0 0 inf\n", {"a.msh:6:", "\"inf\""}},
       {format_2 + "$Other\n1\n", {"a.msh:4:", "$EndOther"}}});
}

const std::string node_1 =
    "# nodes\n5 3 1 0\n1 0 0 0 7\n2 1 0 0 7 # second\n3 0 1 0 7\n\n4 0 0 1 7\n5 1 1 1 7\n";
const std::string ele_1 = "2 4 1\n1 1 2 3 4 5\n2 2 5 4 3 6\n";

TetMesh tetgen(const std::string& nodes, const std::string& tets) {
  return parse_tetgen(nodes, "a.node", tets, "a.ele");
}

TEST(TetgenReader, ReadsIndicesFromOneAndFromZero) {
  const TetMesh mesh = tetgen(node_1, ele_1);
  expect_two_tets(mesh);
  EXPECT_EQ(mesh.groups.at("region_5"), (Indices{0, 1, 2, 3}));
  EXPECT_EQ(mesh.groups.at("region_6"), (Indices{1, 2, 3, 4}));
  expect_two_tets(
      tetgen("5 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1 1 1\n", "2 4 0\n0 0 1 2 3\n1 1 4 3 2\n"));
}

TEST(TetgenReader, NamesFileAndLineOfBadInput) {
  expect_error([] { tetgen("1 2 0 0\n1 0 0 0\n", ele_1); }, {"a.node:1:", "dimension 2"});
  expect_error([] { tetgen("900000000 3 0 0\n1 0 0 0\n", ele_1); }, {"a.node:1:", "900000000"});
  expect_error([] { tetgen("1 3 0 0\n2 0 0 0\n", ele_1); }, {"a.node:2:", "first index 2", "0 or 1"});
  expect_error([] { tetgen("2 3 0 0\n1 0 0 0\n1 0 0 0\n", ele_1); }, {"a.node:3:", "index 1", "2"});
  expect_error([] { tetgen("1 3 0 0\n1 0 0 0\n2 0 0 0\n", ele_1); }, {"a.node:3:", "counts 1 nodes"});
  expect_error([] { tetgen(node_1, "1 4 0\n1 1 2 3 6\n"); }, {"a.ele:2:", "node 6", "1 to 5"});
  expect_error([] { tetgen(node_1, "1 4 0\n1 0 2 3 4\n"); }, {"a.ele:2:", "node 0"});
  expect_error([] { tetgen(node_1, "1 4 0\n1 1 1 3 4\n"); }, {"a.ele:2:", "flat"});
  expect_error([] { tetgen(node_1, "1 10 0\n1 1 2 3 4\n"); }, {"a.ele:1:", "-o2"});
  expect_error([] { tetgen(node_1, "0 4 0\n"); }, {"a.ele:1:", "no tets"});
}

std::string vtk(const std::string& encoding, const std::string& rest) {
  return "# vtk DataFile Version 3.0\ntitle\n" + encoding + "\nDATASET UNSTRUCTURED_GRID\n" + rest;
}

TetMesh parse_grid(const std::string& bytes) {
  return parse_vtk(bytes, "a.vtk");
}

const std::string points_text = "POINTS 5 double\n0 0 0 1 0 0 0 1 0\n0 0 1 1 1 1\n";

TEST(VtkReader, ReadsAsciiClassicAndNew) {
  const std::string field = "FIELD FieldData 1\ntime 1 1 double\n0.5\n";
  const std::string cells =
      "CELLS 3 14\n3 0 1 2\n4 0 1 2 3\n4 1 4 3 2\nCELL_TYPES 3\n5\n10\n10\nPOINT_DATA 5\nanything";
  expect_two_tets(parse_grid(vtk("ASCII", field + points_text + cells)));
  const std::string meta = "METADATA\nINFORMATION 0\n\n";
  const std::string offsets =
      "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 1 4 3 2\n";
  expect_two_tets(parse_grid(vtk("ASCII", points_text + meta + offsets + "CELL_TYPES 2\n10 10\n")));
}

TEST(VtkReader, ReadsBinary) {
  const std::string points = "POINTS 5 float\n" +
                             bytes_of(true, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f) +
                             bytes_of(true, 0.f, 0.f, 1.f, 1.f, 1.f, 1.f) + "\n";
  const std::string types = "CELL_TYPES 2\n" + bytes_of(true, 10, 10) + "\n";
  const std::string classic = "CELLS 2 10\n" + bytes_of(true, 4, 0, 1, 2, 3, 4, 1, 4, 3, 2) + "\n";
  expect_two_tets(parse_grid(vtk("BINARY", points + classic + types)));
  using Wide = std::int64_t;
  const std::string offsets = "CELLS 3 8\nOFFSETS vtktypeint64\n" +
                              bytes_of(true, Wide(0), Wide(4), Wide(8)) + "\nCONNECTIVITY vtktypeint64\n" +
                              bytes_of(true, Wide(0), Wide(1), Wide(2), Wide(3)) +
                              bytes_of(true, Wide(1), Wide(4), Wide(3), Wide(2)) + "\n";
  expect_two_tets(parse_grid(vtk("BINARY", points + offsets + types)));
  expect_error([&] { parse_grid(vtk("BINARY", points.substr(0, 60))); }, {"a.vtk: byte ", "15"});
}

TEST(VtkReader, NamesFileAndPlaceOfBadInput) {
  const auto cells = [](const std::string& rest) { return vtk("ASCII", points_text + rest); };
  expect_bad(parse_grid,
             {{"hello", {"a.vtk:1:", "# vtk DataFile"}},
              {"# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n", {"a.vtk:4:", "POLYDATA"}},
              {vtk("ASCII", "POINTS 1000000000 float\n0 0 0\n"), {"a.vtk:5:", "1000000000", "long enough"}},
              {vtk("ASCII", "POINTS 4 half\n0 0 0\n 0 0 0 0 0 0"), {"a.vtk:5:", "\"half\""}},
              {vtk("ASCII", "POINTS 1 float\n0 0 x\n"), {"a.vtk:6:", "\"x\""}},
              {cells("CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 2\n10 10\n"), {"a.vtk:10:", "2 cell types"}},
              {cells("CELLS 1 5\n4 0 1 2 5\nCELL_TYPES 1\n10\n"), {"a.vtk", "cell 0 with point 5"}},
              {cells("CELLS 1 5\n4 0 1 2 2\nCELL_TYPES 1\n10\n"), {"a.vtk", "flat tet"}},
              {cells("CELLS 1 5\n5 0 1 2 3\nCELL_TYPES 1\n10\n"), {"a.vtk:9:", "0 whole cells"}},
              {cells("CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n10\n"), {"a.vtk", "without four points"}},
              {cells("CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n"), {"a.vtk", "no tet"}},
              {cells("CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n12\n"), {"a.vtk", "type 12", "type 10"}},
              {cells("CELLS 2 4\nOFFSETS int\n0 5\nCONNECTIVITY int\n0 1 2 3\n"), {"a.vtk:12:", "OFFSETS"}},
              {cells("CELLS 4 8\nOFFSETS int\n0 6 4 8\nCONNECTIVITY int\n0 1 2 3 1 4 3 2\n"),
               {"a.vtk:", "OFFSETS that do not ascend"}},
              {cells("NOTHING\n"), {"a.vtk:8:", "\"NOTHING\""}}});
}

}  // namespace souple::test_io_mesh_tets
