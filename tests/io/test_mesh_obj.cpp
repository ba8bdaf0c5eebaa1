#include "mesh_expect.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/mesh_write.h"

#include <chrono>
#include <ctime>
#include <vector>

namespace souple::test_io_mesh_obj {

using Indices = std::vector<std::uint32_t>;

TriangleMesh parse(const std::string& text) {
  return parse_obj(text, "a.obj");
}

std::vector<Vec3f> positions_of(const TriangleMesh& mesh) {
  std::vector<Vec3f> result;
  for (const Vec3d& p : mesh.positions) result.emplace_back(p);
  return result;
}

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ObjReader, KeepsVerticesTheirOrderAndUnusedOnes) {
  const TriangleMesh mesh =
      parse("# a comment\nv 1 2 3 # another\nv 1 2 3\nv -1.5e-3 +2 .5 1\nv 9 9 9\nf 1 2 3\n");
  ASSERT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.positions[0], mesh.positions[1]);
  EXPECT_EQ(mesh.positions[2], Vec3d(-1.5e-3, 2.0, 0.5));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_TRUE(mesh.faces.empty());
}

TEST(ObjReader, ReadsEveryFormOfAFaceCorner) {
  const std::string uv = "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n";
  for (const char* face : {"f 1 2 3", "f 1/1 2/2 3/3", "f 1//1 2//1 3//1", "f 1/1/1 2/2/1 3/3/1",
                           "f -4 -3 -2", "f -4/-3/-1 -3/-2/-1 -2/-1/-1"}) {
    const TriangleMesh mesh = parse(square + uv + face);
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}})) << face;
    if (std::string(face).find("/1 ") != std::string::npos &&
        std::string(face).find("//") == std::string::npos) {
      EXPECT_EQ(mesh.face_uvs, (std::vector<Indices>{{0, 1, 2}})) << face;
    }
  }
}

TEST(ObjReader, KeepsPolygonsAndCutsThemIntoFans) {
  const TriangleMesh mesh = parse("v 2 0 0\n" + square + "f 2 3 4 5\nf 1 2 3\n");
  EXPECT_EQ(mesh.faces, (std::vector<Indices>{{1, 2, 3, 4}, {0, 1, 2}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{1, 2, 3}, {1, 3, 4}, {0, 1, 2}}));
}

TEST(ObjReader, JoinsContinuedLinesAndTakesAnyLineEnd) {
  const std::string lines[] = {
      square + "f 1 2 \\\n 3 4\n", "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1 2\\\r\n 3 4",
      "v 0 0 0\rv 1 0 0\rv 1 1 0\rv 0 1 0\rf 1 2 3 4\r", "\xef\xbb\xbf" + square + "f 1 2 3 4"};
  for (const std::string& text : lines)
    EXPECT_EQ(parse(text).faces, (std::vector<Indices>{{0, 1, 2, 3}})) << text;
}

TEST(ObjReader, TakesFacesBeforeTheirVertices) {
  EXPECT_EQ(parse("f 1 2 3\n" + square).triangles, (std::vector<Triangle>{{0, 1, 2}}));
  expect_error([] { parse("#\nf 1 2 5\n" + square); }, {"a.obj:2:", "index 5", "at most 4"});
}

TEST(ObjReader, GivesGroupsTheVerticesOfTheirFaces) {
  const TriangleMesh mesh = parse(square +
                                  "v 5 5 5\no my body\ng left right\nf 3 2 1\ng right\nusemtl silk\nf 1 3 4\n"
                                  "g default\np 5\n");
  EXPECT_EQ(mesh.groups.size(), 4u);
  EXPECT_EQ(mesh.groups.at("left"), (Indices{0, 1, 2}));
  EXPECT_EQ(mesh.groups.at("right"), (Indices{0, 1, 2, 3}));
  EXPECT_EQ(mesh.groups.at("my body"), (Indices{0, 1, 2, 3, 4}));
  EXPECT_EQ(mesh.groups.at("material:silk"), (Indices{0, 2, 3, 4}));
}

TEST(ObjReader, ReadsVertexColors) {
  const TriangleMesh mesh = parse("v 0 0 0\nv 1 0 0 1 0.5 0\nv 1 1 0\nf 1 2 3\n");
  ASSERT_EQ(mesh.colors.size(), 3u);
  EXPECT_EQ(mesh.colors[1], Vec3f(1.0f, 0.5f, 0.0f));
  EXPECT_EQ(mesh.colors[2], Vec3f(1.0f, 1.0f, 1.0f));
}

TEST(ObjReader, NamesFileAndLineOfBadInput) {
  const struct {
    std::string text;
    std::initializer_list<std::string> parts;
  } cases[] = {{"v 0 0\n", {"a.obj:1:", "2 numbers"}},
               {"v 0 0 0\nv 0 zero 0\n", {"a.obj:2:", "\"zero\"", "a number"}},
               {"v 0 0 nan\n", {"a.obj:1:", "\"nan\""}},
               {"v 0 0 1e400\n", {"a.obj:1:", "1e400"}},
               {"v 0 0 1e30\n", {"a.obj:1:", "within 1e18"}},
               {"v 0,5 0 0\n", {"a.obj:1:", "0,5"}},
               {"v 0 0 0 255 0 0\n", {"a.obj:1:", "255", "from 0 to 1"}},
               {square + "f 1 2\n", {"a.obj:5:", "2 corners"}},
               {square + "f 0 1 2\n", {"a.obj:5:", "index 0"}},
               {square + "f 1 2 -5\n", {"a.obj:5:", "-5", "4"}},
               {square + "f 1 2 \\\n 99999999999999999999\n", {"a.obj:6:", "999"}},
               {square + "f 1 2 4294967296\n", {"a.obj:5:", "4294967296"}},
               {square + "f 1/ 2 3\n", {"a.obj:5:", "\"1/\""}},
               {square + "vt 0 0\nf 1/1 2 3\n", {"a.obj:6:", "UV"}},
               {square + "f 1/2 2/2 3/2\nvt 0 0\n", {"a.obj:5:", "index 2", "at most 1"}},
               {square + "face 1 2 3\n", {"a.obj:5:", "\"face\"", "keyword"}},
               {"g a b c d e f g h i j k l m n o p q\n", {"a.obj:1:", "16"}},
               {"", {"a.obj:1:", "no vertex"}},
               {std::string("v 0 0 0\0\n", 9), {"a.obj:1:", "\"0?\""}}};
  for (const auto& bad : cases) {
    SCOPED_TRACE(bad.text);
    expect_error([&] { parse(bad.text); }, bad.parts);
  }
}

TEST(ObjReader, TakesNumbersTooSmallForADoubleAsZero) {
  EXPECT_EQ(parse("v 1e-400 -1e-400 0\n").positions[0].x, 0.0);
}

TEST(ObjReader, ReadsAMillionVerticesInSeconds) {
  std::string text;
  const int columns = 1000, rows = 1000;
  for (int i = 0; i < columns * rows; ++i) {
    text += "v " + std::to_string(i % columns) + ".125 " + std::to_string(i / columns) + ".0625 0.333333\n";
  }
  for (int i = 0; i < columns * (rows - 1) - 1; ++i) {
    const std::string a = std::to_string(i + 1), b = std::to_string(i + 2),
                      c = std::to_string(i + 1 + columns);
    text += "f " + a + "//1 " + b + "//1 " + c + "//1\n";
  }
  const auto start = std::chrono::steady_clock::now();
  const TriangleMesh mesh = parse(text);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  RecordProperty("seconds", std::to_string(seconds));
  EXPECT_EQ(mesh.positions.size(), 1000000u);
  EXPECT_LT(seconds, 20.0);  // 0.6 measured on a busy machine; slack for sanitizers and busy machines
}

TEST(ObjReader, DoesNotSlowDownWithTheSquareOfLongInput) {
  std::string groups = square, line = square + "f";
  for (int i = 0; i < 100000; ++i) groups += "g a" + std::to_string(i % 1000) + "\nf 1 2 3\n";
  for (int i = 0; i < 1000000; ++i) line += " 1";
  EXPECT_EQ(parse(groups).groups.size(), 1000u);
  EXPECT_EQ(parse(line).faces[0].size(), 1000000u);
}

TEST(ObjWriter, ReadsBackAsItWas) {
  const TriangleMesh mesh =
      parse(square +
            "v 0.1 1e-30 16777216\nv 7 7 7\nvt 0.1 0.2\nvt 1 0\nvt 1 1\no body\nf 1/1 2/2 3/3\n"
            "g left right\nf 1 3 4 5\ng left\nf 2/1 3/2 5/3\ng none\np 6\n");
  const TriangleMesh again = parse(obj_text(mesh, positions_of(mesh)));
  EXPECT_EQ(positions_of(again), positions_of(mesh));
  EXPECT_EQ(again.triangles, mesh.triangles);
  EXPECT_EQ(again.faces, mesh.faces);
  EXPECT_EQ(again.uvs, mesh.uvs);
  EXPECT_EQ(again.face_uvs, mesh.face_uvs);
  EXPECT_EQ(again.groups, mesh.groups);
}

// A vertex may be in more groups than a `g` line may name.
const char* const looks = R"(mtllib a b.mtl
mtllib more.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
vn 0 0 2
vn 0 3 4
f 1//1 2//1 3//-1
s 3
usemtl Red cloth
f 1 3 4
s off
usemtl blue
f 1//2 2//2 4//2
usemtl Red cloth
f 2//9 3//1 4//1
)";

TEST(ObjReader, KeepsMaterialsSmoothingAndNormals) {
  const FaceAppearance a = parse_obj(looks, "looks.obj").appearance;
  EXPECT_EQ(a.material_files, (std::vector<std::string>{"a b.mtl", "more.mtl"}));
  EXPECT_EQ(a.materials, (std::vector<std::string>{"Red cloth", "blue"}));
  EXPECT_EQ(a.face_materials, (std::vector<std::uint32_t>{FaceAppearance::no_material, 0, 1, 0}));
  EXPECT_EQ(a.smoothing, (std::vector<std::uint32_t>{0, 3, 0, 0}));
  EXPECT_EQ(a.normals, (std::vector<Vec3f>{{0, 0, 1}, {0, 0.6f, 0.8f}}));
  // -1 is the last normal so far; there is no ninth, and a face with a missing normal has none.
  EXPECT_EQ(a.face_normals, (std::vector<std::vector<std::uint32_t>>{{0, 0, 1}, {}, {1, 1, 1}, {}}));
  EXPECT_EQ(parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "plain.obj").appearance, FaceAppearance{});
}

TEST(ObjWriter, KeepsMaterialsSmoothingAndNormals) {
  const TriangleMesh mesh = parse_obj(looks, "looks.obj");
  const std::vector<Vec3f> positions(mesh.positions.begin(), mesh.positions.end());
  const TriangleMesh back = parse_obj(obj_text(mesh, positions), "back.obj");
  EXPECT_EQ(back.appearance, mesh.appearance);
  EXPECT_EQ(back.groups, mesh.groups);
}

TEST(ObjWriter, KeepsEveryGroupOfAFaceInMany) {
  std::string text = square + "o body\nusemtl silk\n";
  for (int i = 0; i < 20; ++i) text += "g a" + std::to_string(i) + "\nf 1 2 3\n";
  const TriangleMesh mesh = parse(text);
  EXPECT_EQ(mesh.groups.size(), 22u);
  EXPECT_EQ(parse(obj_text(mesh, positions_of(mesh))).groups, mesh.groups);
}

// Quadratic in the groups, four times as many take sixteen times as long.
TEST(ObjWriter, TimeIsLinearInTheGroupsOfOneTriangle) {
  const auto processor_time = [](int count) {
    TriangleMesh mesh = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    mesh.triangles.assign(std::size_t(count), mesh.triangles.front());
    for (int i = 0; i < count; ++i) mesh.groups["g" + std::to_string(i)] = {0, 1, 2};
    const std::clock_t start = std::clock();
    const std::string text = obj_text(mesh, positions_of(mesh));
    const std::clock_t end = std::clock();
    EXPECT_EQ(parse(text).groups, mesh.groups);
    return double(end - start) / CLOCKS_PER_SEC;
  };
  processor_time(1000);
  EXPECT_LT(processor_time(60000), 9 * processor_time(15000));
}

TEST(ObjWriter, KeepsAGroupCalledDefault) {
  const TriangleMesh mesh = parse(square + "o default\nf 1 2 3\n");
  EXPECT_EQ(parse(obj_text(mesh, positions_of(mesh))).groups.count("default_"), 1u);
}

TEST(ObjWriter, WritesTheGivenPositionsShortest) {
  const TriangleMesh mesh = parse(square + "f 1 2 3 4\n");
  const std::vector<Vec3f> moved = {{0.1f, -2.0f, 1e-20f}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_EQ(obj_text(mesh, moved), "v 0.1 -2 1e-20\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  expect_error([&] { obj_text(mesh, std::span(moved).first(3)); }, {"3 positions", "expected 4"});
}

}  // namespace souple::test_io_mesh_obj
