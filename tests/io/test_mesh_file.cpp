#include "mesh_expect.h"
#include "souple/mesh_files/mesh_file.h"
#include "tests/folder_test.h"

#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace souple::test_io_mesh_file {

using MeshFile = test::FolderTest;

const std::string triangle = "v 1 2 3\nv 0 0 0\nv 0 1 0\nf 1 2 3\n";

TEST_F(MeshFile, ChoosesTheFormatByItsExtensionInAnyCase) {
  EXPECT_EQ(read_triangle_mesh(put("a.OBJ", triangle)).positions[0], Vec3d(1, 2, 3));
  expect_error([&] { read_triangle_mesh(put("a.Ply", triangle)); }, {"a.Ply:1:", "\"ply\""});
  expect_error([&] { read_triangle_mesh(put("a.txt", triangle)); },
               {"a.txt", "\".txt\"", ".obj, .ply, .stl"});
  expect_error([&] { read_triangle_mesh(put("a.msh", triangle)); }, {"a.msh", "tet mesh"});
  expect_error([&] { read_tet_mesh(put("a.obj", triangle)); }, {"a.obj", ".msh", ".node", ".vtk"});
}

TEST_F(MeshFile, ScalesAndTurnsUpright) {
  const auto path = put("a.obj", triangle);
  EXPECT_EQ(read_triangle_mesh(path, {.scale = 2.0}).positions[0], Vec3d(2, 4, 6));
  // Up becomes Y; a right-handed file stays right-handed.
  EXPECT_EQ(read_triangle_mesh(path, {.up = UpAxis::z}).positions[0], Vec3d(1, 3, -2));
  EXPECT_EQ(read_triangle_mesh(path, {.up = UpAxis::x}).positions[0], Vec3d(-2, 1, 3));
  for (double scale : {0.0, -1.0, std::nan(""), 1e300}) {
    expect_error([&] { read_triangle_mesh(path, {.scale = scale}); }, {"a.obj", "scale"});
  }
}

TEST_F(MeshFile, TurnsEveryFormatAndItsNormalsUpright) {
  const auto ply =
      put("a.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
          "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
          "1 2 3\n0 0 0\n0 1 0\n3 0 1 2\n");
  const auto stl = put("a.stl",
                       "solid s\nfacet normal 0 0 1\nouter loop\nvertex 1 2 3\nvertex 0 0 0\nvertex 0 1 0\n"
                       "endloop\nendfacet\nendsolid s\n");
  for (const auto& path : {ply, stl})
    EXPECT_EQ(read_triangle_mesh(path, {.scale = 2, .up = UpAxis::z}).positions[0], Vec3d(2, 6, -4)) << path;
  const auto obj = put("n.obj", triangle + "vn 0 0 1\nf 1//1 2//1 3//1\n");
  const std::vector<Vec3f> up{{0, 1, 0}};
  EXPECT_EQ(read_triangle_mesh(obj, {.scale = 2, .up = UpAxis::z}).appearance.normals, up);
}

TEST_F(MeshFile, ReadsOneObjectOfSeveral) {
  const auto path = put("two.obj",
                        "o Body\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n"
                        "o Shirt\nv 5 0 0\nv 6 0 0\nv 5 1 0\nv 6 1 0\nvt 1 1\n"
                        "g hem\nf 4/2 5/2 7/2 6/2\n");
  EXPECT_EQ(read_triangle_mesh(path).positions.size(), 7u);
  const TriangleMesh shirt = read_triangle_mesh(path, {.scale = 2, .node = "Shirt"});
  EXPECT_EQ(shirt.positions, (std::vector<Vec3d>{{10, 0, 0}, {12, 0, 0}, {10, 2, 0}, {12, 2, 0}}));
  EXPECT_EQ(shirt.triangles, (std::vector<Triangle>{{0, 1, 3}, {0, 3, 2}}));
  EXPECT_EQ(shirt.uvs, (std::vector<std::array<float, 2>>{{1, 1}}));
  EXPECT_EQ(shirt.groups.at("hem").size(), 4u);
  EXPECT_EQ(shirt.groups.count("Body"), 0u);
  expect_error([&] { read_triangle_mesh(path, {.node = "Shrit"}); },
               {"two.obj", "\"Shrit\"", "\"Body\", \"Shirt\""});
  expect_error([&] { read_triangle_mesh(put("a.obj", triangle), {.node = "Shirt"}); },
               {"a.obj", "names no objects"});
}

TEST_F(MeshFile, FindsMaterialFilesBesideIt) {
  const auto path = put("m.obj", "mtllib sub/m.mtl\n" + triangle);
  EXPECT_EQ(read_triangle_mesh(path).appearance.material_files,
            std::vector<std::string>{(folder / "sub/m.mtl").string()});
}

TEST_F(MeshFile, NamesAFileThatIsNotThere) {
  expect_error([&] { read_triangle_mesh(folder / "none.obj"); }, {"none.obj", "no such file"});
  std::filesystem::create_directory(folder / "b.obj");
  expect_error([&] { read_triangle_mesh(folder / "b.obj"); }, {"b.obj", "is a folder"});
  expect_error([&] { read_triangle_mesh(put("c.obj", "")); }, {"c.obj:1:", "no vertex"});
}

TEST_F(MeshFile, ReadsTetgenByEitherName) {
  const auto node = put("a.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 2\n");
  expect_error([&] { read_tet_mesh(node); }, {"a.ele", "no such file"});
  const auto ele = put("a.ele", "1 4 0\n0 0 1 2 3\n");
  for (const auto& path : {node, ele}) {
    const TetMesh mesh = read_tet_mesh(path, {.scale = 0.5});
    EXPECT_EQ(mesh.tets, (std::vector<Tet>{{0, 1, 2, 3}}));
    EXPECT_EQ(mesh.positions[3], Vec3d(0, 0, 1));
  }
}

double enclosed_volume(const TriangleMesh& mesh) {
  double six_volumes = 0.0;
  for (const Triangle& t : mesh.triangles) {
    six_volumes += dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]]));
  }
  return six_volumes / 6.0;
}

TEST(ShippedMeshes, SurfacesAreClosedAndWoundOutward) {
  const std::filesystem::path folder = SOUPLE_SHIPPED_MESHES;
  for (const char* name : {"duck.obj", "star.obj"}) {
    const TriangleMesh mesh = read_triangle_mesh(folder / name, {.scale = 0.01});
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const Triangle& t : mesh.triangles) {
      for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(edges.emplace(t[i], t[(i + 1) % 3]).second) << name;
    }
    for (const auto& [a, b] : edges) EXPECT_EQ(edges.count({b, a}), 1u) << name;
    EXPECT_GT(enclosed_volume(mesh), 0.05) << name;
    EXPECT_GE(mesh.groups.size(), 4u) << name;  // its parts, and the whole
  }
}

TEST(ShippedMeshes, TheBeamHasItsVolumeAndItsEnds) {
  const TetMesh mesh = read_tet_mesh(std::filesystem::path(SOUPLE_SHIPPED_MESHES) / "beam.msh");
  double volume = 0.0;
  for (const Tet& t : mesh.tets) {
    const Vec3d a = mesh.positions[t[0]];
    volume += dot(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a), mesh.positions[t[3]] - a) / 6.0;
  }
  EXPECT_NEAR(volume, 0.8 * 0.2 * 0.2, 1e-12);
  EXPECT_EQ(mesh.groups.at("bar").size(), 81u);
  for (std::uint32_t i : mesh.groups.at("left")) EXPECT_EQ(mesh.positions[i].x, 0.0);
  EXPECT_EQ(mesh.groups.at("right").size(), 9u);
}

}  // namespace souple::test_io_mesh_file
