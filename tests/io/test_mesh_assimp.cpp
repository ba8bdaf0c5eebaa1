#include "mesh_expect.h"
#include "souple/error.h"
#include "souple/mesh_files/mesh_animation.h"
#include "souple/mesh_files/mesh_message.h"

#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <sys/stat.h>
#include <utility>
#include <vector>

namespace souple::test_io_mesh_assimp {

// A square in two triangles, moved by its node, as glTF with its buffer inside the file.
const char* const square_gltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0,"name":"sheet","translation":[10,0,0]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAABAAIAAAACAAMA"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}]})";

const char* const square_off = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

using AssimpReader = AssimpTest;

TEST_F(AssimpReader, KeepsVerticesAndTheirOrder) {
  const TriangleMesh mesh = read_triangle_mesh(put("souple_square.gltf", square_gltf), {.scale = 2.0});
  ASSERT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.positions[2], Vec3d(22, 2, 0));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.groups.at("sheet"), (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(read_triangle_mesh(put("souple_square.off", square_off)).faces.size(), 1u);
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
TEST_F(AssimpReader, HeedsTheUnitOfFbx) {
  const TriangleMesh mesh = read_triangle_mesh(put("souple_cm.fbx", triangle_fbx("1")));
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_NEAR(mesh.positions[1].x, 1, 1e-6);
  EXPECT_NEAR(read_triangle_mesh(put("souple_m.fbx", triangle_fbx("100"))).positions[1].x, 100, 1e-4);
  EXPECT_NEAR(read_triangle_mesh(put("souple_in.fbx", triangle_fbx("2.54")), {.scale = 2}).positions[2].y,
              5.08, 1e-5);
}

std::string axis(const std::string& name, int value) {
  return "\t\tP: \"" + name + "\", \"int\", \"Integer\", \"\"," + std::to_string(value) + "\n";
}

std::string axes(int up, int up_sign, int front, int front_sign, int right, int right_sign) {
  return axis("UpAxis", up) + axis("UpAxisSign", up_sign) + axis("FrontAxis", front) +
         axis("FrontAxisSign", front_sign) + axis("CoordAxis", right) + axis("CoordAxisSign", right_sign);
}

// Points along the stated up axis come to lie along Y, points toward the stated front along Z.
TEST_F(AssimpReader, HeedsTheAxesOfFbx) {
  const auto corners = [&](const std::string& stated) {
    const TriangleMesh mesh = read_triangle_mesh(put("souple_axes.fbx", triangle_fbx("1", stated)));
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

TEST_F(AssimpReader, ReadsOneNodeOfSeveral) {
  const auto path = put("souple_node.gltf", square_gltf);
  EXPECT_EQ(read_triangle_mesh(path, {.node = "sheet"}).triangles.size(), 2u);
  expect_error([&] { read_triangle_mesh(path, {.node = "shirt"}); }, {"souple_node.gltf", "\"sheet\""});
}

TEST_F(AssimpReader, TurnsFailuresIntoErrors) {
  expect_error([&] { read_triangle_mesh(put("souple_bad.gltf", "{\"asset\":")); },
               {"souple_bad.gltf", "assimp"});
  expect_error([&] { read_triangle_mesh("souple_none.glb"); }, {"souple_none.glb", "no such file"});
}

// Files as they come from strangers: an Error in a sentence, never the end of this process.

std::string nodes_of(std::string_view nodes) {
  return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
         "version=\"1.4.1\">"
         "<library_visual_scenes><visual_scene id=\"s\">" +
         std::string(nodes) +
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene "
         "url=\"#s\"/></scene></COLLADA>";
}

std::string repeated(std::string_view text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

TEST_F(AssimpReader, SurvivesHostileFiles) {
  const std::size_t deep = 20000;
  const std::pair<const char*, std::string> hostile[] = {
      {"self.dae", nodes_of("<node id=\"n\"><instance_node url=\"#n\"/></node>")},
      {"mutual.dae", nodes_of("<node id=\"a\"><instance_node url=\"#b\"/></node>"
                              "<node id=\"b\"><instance_node url=\"#a\"/></node>")},
      {"deep.dae", nodes_of(repeated("<node>", deep) + repeated("</node>", deep))},
      {"deep.x3d",
       "<X3D><Scene>" + repeated("<Group>", deep) + repeated("</Group>", deep) + "</Scene></X3D>"},
      {"use.x3d", "<X3D><Scene><Group DEF=\"a\"><Group USE=\"a\"/></Group></Scene></X3D>"},
      {"inline.x3d", "<X3D><Scene><Inline url=\"souple_inline.x3d\"/></Scene></X3D>"},
      {"deep.gltf", std::string(200000, '[')},
      {"deep.fbx", "; FBX 7.3.0 project file\n" + repeated("A: {\n", 50000)},
      {"zero.fbx", std::string(20000, '\0')},
      {"zero.blend", std::string(20000, '\0')},
      {"zero.3ds", std::string(20000, '\0')},
      {"zero.glb", std::string(20000, '\0')},
  };
  for (const auto& file : hostile) {
    const auto& name = file.first;
    const auto& text = file.second;
    SCOPED_TRACE(name);
    expect_error([&] { read_triangle_mesh(put("souple_" + std::string(name), text)); }, {name, "assimp"});
  }
}

// assimp reads forty formats more, by readers of which a file of zeros makes several crash.
TEST_F(AssimpReader, ReadsListedFormatsOnly) {
  for (const char* const name : {"zero.lws", "zero.mot", "zero.ms3d", "zero.ifc"})
    expect_error([&] { read_triangle_mesh(put(name, std::string(20000, '\0'))); },
                 {name, "unknown extension", ".gltf"});
  // Nor by their content: this scene of LightWave would be read in spite of its name.
  expect_error([&] { read_triangle_mesh(put("souple_named.gltf", "LWSC\n3\n" + std::string(100, ' '))); },
               {"souple_named.gltf", "assimp"});
}

std::string with_buffer(const std::string& uri) {
  std::string text = square_gltf;
  const std::size_t begin = text.find("data:"), end = text.find('"', begin);
  return text.replace(begin, end - begin, uri);
}

TEST_F(AssimpReader, OpensRegularFilesBelowTheMeshOnly) {
  namespace fs = std::filesystem;
  const fs::path& top = folder;
  const fs::path inner = top / "mesh";
  fs::create_directories(inner / "below");
  std::string floats;
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f})
    floats.append(reinterpret_cast<const char*>(&x), sizeof(x));
  for (const std::uint16_t i : std::initializer_list<std::uint16_t>{0, 1, 2, 0, 2, 3})
    floats.append(reinterpret_cast<const char*>(&i), sizeof(i));
  for (const fs::path& file : {inner / "below" / "in.bin", top / "out.bin"})
    std::ofstream(file, std::ios::binary) << floats;
  fs::create_symlink(top / "out.bin", inner / "link.bin");
  fs::create_symlink("below/in.bin", inner / "inner.bin");
  ASSERT_EQ(mkfifo((inner / "pipe.bin").c_str(), 0600), 0);
  const auto read = [&](const std::string& uri) {
    return read_triangle_mesh(put("mesh/mesh.gltf", with_buffer(uri)));
  };
  EXPECT_EQ(read("below/in.bin").positions.size(), 4u);
  EXPECT_EQ(read("inner.bin").positions.size(), 4u);
  for (const std::string& uri :
       {std::string("../out.bin"), (top / "out.bin").string(), std::string("link.bin"),
        std::string("pipe.bin"), std::string("/dev/zero"), std::string("below/../../out.bin")}) {
    SCOPED_TRACE(uri);
    expect_error([&] { read(uri); }, {"mesh.gltf", "assimp"});
  }
}

TEST_F(AssimpReader, SaysWhereItsProgramIsMissing) {
  const auto path = put("souple_square.off", square_off);
  ASSERT_EQ(setenv("SOUPLE_MESH_READER", "/no/such/reader", 1), 0);
  expect_error([&] { read_triangle_mesh(path); },
               {"souple_square.off", "SOUPLE_MESH_READER", "/no/such/reader"});
  // A program that says nothing, and one that says nonsense.
  ASSERT_EQ(setenv("SOUPLE_MESH_READER", "/bin/true", 1), 0);
  expect_error([&] { read_triangle_mesh(path); }, {"souple_square.off", "breaks off"});
  ASSERT_EQ(setenv("SOUPLE_MESH_READER", "/bin/false", 1), 0);
  expect_error([&] { read_triangle_mesh(path); }, {"souple_square.off", "exit code 1"});
  ASSERT_EQ(unsetenv("SOUPLE_MESH_READER"), 0);
  EXPECT_EQ(read_triangle_mesh(path).positions.size(), 4u);
}

using WithoutAssimp = test::FolderTest;

TEST_F(WithoutAssimp, ItsPackageIsNamed) {
  if (mesh_import_has_assimp()) GTEST_SKIP() << "built with assimp";
  const auto path = put("a.gltf", square_gltf);
  expect_error([&] { read_triangle_mesh(path); }, {".gltf", "libassimp-dev"});
  expect_error([&] { read_mesh_animation(path); }, {".gltf", "libassimp-dev"});
}

// A damaged answer of the reader costs an Error. Damages each byte of a small one in turn.
TEST(MeshMessage, IsCheckedByteByByte) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.faces = {{0, 1, 2, 3}};
  mesh.uvs = {{0, 0}, {1, 1}};
  mesh.face_uvs = {{0, 1, 0, 1}};
  mesh.colors.assign(4, Vec3f{1, 0, 0});
  mesh.groups["left"] = {0, 3};
  mesh.appearance.materials = {"red"};
  mesh.appearance.face_materials = {0};
  mesh.appearance.normals = {{0, 0, 1}};
  mesh.appearance.face_normals = {{0, 0, 0, 0}};
  const std::string message = mesh_detail::message_of_mesh(mesh);
  const TriangleMesh same = mesh_detail::mesh_of_message(message, "message");
  EXPECT_EQ(same.positions, mesh.positions);
  EXPECT_EQ(same.groups, mesh.groups);
  EXPECT_EQ(same.face_uvs, mesh.face_uvs);
  EXPECT_TRUE(same.appearance == mesh.appearance);
  for (std::size_t i = 0; i < message.size(); ++i) {
    for (const char byte : {'\0', '\xff', '\x7f', '\x04'}) {
      std::string damaged = message;
      damaged[i] = byte;
      try {
        const TriangleMesh taken = mesh_detail::mesh_of_message(damaged, "message");
        for (const auto& [name, group] : taken.groups)
          for (const std::uint32_t vertex : group) ASSERT_LT(vertex, taken.positions.size()) << i;
        for (const Triangle& triangle : taken.triangles)
          for (const std::uint32_t vertex : triangle) ASSERT_LT(vertex, taken.positions.size()) << i;
      } catch (const Error&) {
      }
    }
    EXPECT_THROW(mesh_detail::mesh_of_message(message.substr(0, i), "message"), Error);
  }
}

}  // namespace souple::test_io_mesh_assimp
