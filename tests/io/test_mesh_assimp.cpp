#include "mesh_expect.h"
#include "souple/mesh_files/mesh_file.h"

#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace souple {
namespace {

std::filesystem::path write(const std::string& name, const std::string& text) {
  auto path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

// A square in two triangles, moved by its node, as glTF with its buffer inside the file.
const char* const square_gltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0,"name":"sheet","translation":[10,0,0]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAABAAIAAAACAAMA"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}]})";

const char* const square_off = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

TEST(AssimpReader, KeepsVerticesAndTheirOrder) {
  if (!mesh_import_has_assimp()) {
    expect_error([] { read_triangle_mesh(write("souple_square.gltf", square_gltf)); },
                 {".gltf", "libassimp-dev"});
    return;
  }
  const TriangleMesh mesh = read_triangle_mesh(write("souple_square.gltf", square_gltf), {.scale = 2.0});
  ASSERT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.positions[2], Vec3d(22, 2, 0));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.groups.at("sheet"), (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(read_triangle_mesh(write("souple_square.off", square_off)).faces.size(), 1u);
}

// A triangle (0, 0, 0), (100, 0, 0), (0, 100, 0) whose unit is `centimeters`, as ASCII FBX; `axes`: further settings.
std::string triangle_fbx(const std::string& centimeters, const std::string& axes = "") {
  return "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7300\n}\n"
         "GlobalSettings:  {\n\tVersion: 1000\n\tProperties70:  {\n" +
         axes + "\t\tP: \"UnitScaleFactor\", \"double\", \"Number\", \"\"," + centimeters +
         "\n\t}\n}\n"
         "Objects:  {\n\tGeometry: 1000, \"Geometry::\", \"Mesh\" {\n"
         "\t\tVertices: *9 {\n\t\t\ta: 0,0,0,100,0,0,0,100,0\n\t\t}\n"
         "\t\tPolygonVertexIndex: *3 {\n\t\t\ta: 0,1,-3\n\t\t}\n\t\tGeometryVersion: 124\n\t}\n"
         "\tModel: 2000, \"Model::sheet\", \"Mesh\" {\n\t\tVersion: 232\n\t}\n}\n"
         "Connections:  {\n\tC: \"OO\",2000,0\n\tC: \"OO\",1000,2000\n}\n";
}

// Blender, Maya and 3ds Max write centimeters: 100 units are a meter.
TEST(AssimpReader, HeedsTheUnitOfFbx) {
  if (!mesh_import_has_assimp()) GTEST_SKIP() << "built without assimp";
  const TriangleMesh mesh = read_triangle_mesh(write("souple_cm.fbx", triangle_fbx("1")));
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_NEAR(mesh.positions[1].x, 1, 1e-6);
  EXPECT_NEAR(read_triangle_mesh(write("souple_m.fbx", triangle_fbx("100"))).positions[1].x, 100, 1e-4);
  EXPECT_NEAR(read_triangle_mesh(write("souple_in.fbx", triangle_fbx("2.54")), {.scale = 2}).positions[2].y,
              5.08, 1e-5);
}

std::string axis(const std::string& name, int value) {
  return "\t\tP: \"" + name + "\", \"int\", \"Integer\", \"\"," + std::to_string(value) + "\n";
}

std::string axes(int up, int up_sign, int front, int front_sign, int right, int right_sign) {
  return axis("UpAxis", up) + axis("UpAxisSign", up_sign) + axis("FrontAxis", front) +
         axis("FrontAxisSign", front_sign) + axis("CoordAxis", right) + axis("CoordAxisSign", right_sign);
}

// What lies along the stated up comes to lie along Y, what faces the stated front along Z.
TEST(AssimpReader, HeedsTheAxesOfFbx) {
  if (!mesh_import_has_assimp()) GTEST_SKIP() << "built without assimp";
  const auto corners = [](const std::string& stated) {
    const TriangleMesh mesh = read_triangle_mesh(write("souple_axes.fbx", triangle_fbx("1", stated)));
    return std::pair(mesh.positions.at(1), mesh.positions.at(2));  // the file's X and Y
  };
  const auto expect_axes = [&](const std::string& stated, const Vec3d& x, const Vec3d& y) {
    const auto [of_x, of_y] = corners(stated);
    EXPECT_LT(length(of_x - x), 1e-6) << stated;
    EXPECT_LT(length(of_y - y), 1e-6) << stated;
  };
  expect_axes("", {1, 0, 0}, {0, 1, 0});
  expect_axes(axes(1, 1, 2, 1, 0, 1), {1, 0, 0}, {0, 1, 0});    // Maya, Blender
  expect_axes(axes(2, 1, 1, -1, 0, 1), {1, 0, 0}, {0, 0, -1});  // 3ds Max
  expect_axes(axes(2, 1, 0, 1, 1, 1), {0, 0, 1}, {1, 0, 0});    // Unreal: X to the front
  expect_axes(axes(0, 1, 2, 1, 1, -1), {0, 1, 0}, {-1, 0, 0});  // X up
  expect_axes(axes(1, -1, 2, 1, 0, -1), {-1, 0, 0}, {0, -1, 0});
  expect_axes(axis("UpAxis", 2), {1, 0, 0}, {0, 0, -1});  // no front: as "up": "z"
  expect_axes(axis("UpAxis", 0), {0, 1, 0}, {-1, 0, 0});
  expect_axes(axis("UpAxis", 7), {1, 0, 0}, {0, 1, 0});
}

TEST(AssimpReader, ReadsOneNodeOfSeveral) {
  if (!mesh_import_has_assimp()) GTEST_SKIP() << "built without assimp";
  const auto path = write("souple_node.gltf", square_gltf);
  EXPECT_EQ(read_triangle_mesh(path, {.node = "sheet"}).triangles.size(), 2u);
  expect_error([&] { read_triangle_mesh(path, {.node = "shirt"}); }, {"souple_node.gltf", "\"sheet\""});
}

TEST(AssimpReader, TurnsFailuresIntoErrors) {
  if (!mesh_import_has_assimp()) GTEST_SKIP() << "built without assimp";
  expect_error([] { read_triangle_mesh(write("souple_bad.gltf", "{\"asset\":")); },
               {"souple_bad.gltf", "assimp"});
  expect_error([] { read_triangle_mesh("souple_none.glb"); }, {"souple_none.glb", "no such file"});
}

}  // namespace
}  // namespace souple
