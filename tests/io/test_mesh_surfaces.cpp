#include "mesh_expect.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/mesh_write.h"

#include <chrono>
#include <ctime>
#include <limits>
#include <vector>

namespace souple::test_io_mesh_surfaces {

using Indices = std::vector<std::uint32_t>;

TriangleMesh obj(const std::string& text) {
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
      obj("# a comment\nv 1 2 3 # another\nv 1 2 3\nv -1.5e-3 +2 .5 1\nv 9 9 9\nf 1 2 3\n");
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
    const TriangleMesh mesh = obj(square + uv + face);
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}})) << face;
    if (std::string(face).find("/1 ") != std::string::npos &&
        std::string(face).find("//") == std::string::npos) {
      EXPECT_EQ(mesh.face_uvs, (std::vector<Indices>{{0, 1, 2}})) << face;
    }
  }
}

TEST(ObjReader, KeepsPolygonsAndCutsThemIntoFans) {
  const TriangleMesh mesh = obj("v 2 0 0\n" + square + "f 2 3 4 5\nf 1 2 3\n");
  EXPECT_EQ(mesh.faces, (std::vector<Indices>{{1, 2, 3, 4}, {0, 1, 2}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{1, 2, 3}, {1, 3, 4}, {0, 1, 2}}));
}

TEST(ObjReader, JoinsContinuedLinesAndTakesAnyLineEnd) {
  const std::string lines[] = {
      square + "f 1 2 \\\n 3 4\n", "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1 2\\\r\n 3 4",
      "v 0 0 0\rv 1 0 0\rv 1 1 0\rv 0 1 0\rf 1 2 3 4\r", "\xef\xbb\xbf" + square + "f 1 2 3 4"};
  for (const std::string& text : lines)
    EXPECT_EQ(obj(text).faces, (std::vector<Indices>{{0, 1, 2, 3}})) << text;
}

TEST(ObjReader, TakesFacesBeforeTheirVertices) {
  EXPECT_EQ(obj("f 1 2 3\n" + square).triangles, (std::vector<Triangle>{{0, 1, 2}}));
  expect_error([] { obj("#\nf 1 2 5\n" + square); }, {"a.obj:2:", "index 5", "at most 4"});
}

TEST(ObjReader, GivesGroupsTheVerticesOfTheirFaces) {
  const TriangleMesh mesh = obj(square +
                                "v 5 5 5\no my body\ng left right\nf 3 2 1\ng right\nusemtl silk\nf 1 3 4\n"
                                "g default\np 5\n");
  EXPECT_EQ(mesh.groups.size(), 4u);
  EXPECT_EQ(mesh.groups.at("left"), (Indices{0, 1, 2}));
  EXPECT_EQ(mesh.groups.at("right"), (Indices{0, 1, 2, 3}));
  EXPECT_EQ(mesh.groups.at("my body"), (Indices{0, 1, 2, 3, 4}));
  EXPECT_EQ(mesh.groups.at("material:silk"), (Indices{0, 2, 3, 4}));
}

TEST(ObjReader, ReadsVertexColors) {
  const TriangleMesh mesh = obj("v 0 0 0\nv 1 0 0 1 0.5 0\nv 1 1 0\nf 1 2 3\n");
  ASSERT_EQ(mesh.colors.size(), 3u);
  EXPECT_EQ(mesh.colors[1], Vec3f(1.0f, 0.5f, 0.0f));
  EXPECT_EQ(mesh.colors[2], Vec3f(1.0f, 1.0f, 1.0f));
}

TEST(ObjReader, NamesFileAndLineOfBadInput) {
  expect_bad(obj, {{"v 0 0\n", {"a.obj:1:", "2 numbers"}},
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
                   {std::string("v 0 0 0\0\n", 9), {"a.obj:1:", "\"0?\""}}});
}

TEST(ObjReader, TakesNumbersTooSmallForADoubleAsZero) {
  EXPECT_EQ(obj("v 1e-400 -1e-400 0\n").positions[0].x, 0.0);
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
  const TriangleMesh mesh = obj(text);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  RecordProperty("seconds", std::to_string(seconds));
  EXPECT_EQ(mesh.positions.size(), 1000000u);
  EXPECT_LT(seconds, 20.0);  // 0.6 measured on a busy machine; slack for sanitizers and busy machines
}

TEST(ObjReader, DoesNotSlowDownWithTheSquareOfLongInput) {
  std::string groups = square, line = square + "f";
  for (int i = 0; i < 100000; ++i) groups += "g a" + std::to_string(i % 1000) + "\nf 1 2 3\n";
  for (int i = 0; i < 1000000; ++i) line += " 1";
  EXPECT_EQ(obj(groups).groups.size(), 1000u);
  EXPECT_EQ(obj(line).faces[0].size(), 1000000u);
}

TEST(ObjWriter, ReadsBackAsItWas) {
  const TriangleMesh mesh =
      obj(square +
          "v 0.1 1e-30 16777216\nv 7 7 7\nvt 0.1 0.2\nvt 1 0\nvt 1 1\no body\nf 1/1 2/2 3/3\n"
          "g left right\nf 1 3 4 5\ng left\nf 2/1 3/2 5/3\ng none\np 6\n");
  const TriangleMesh again = obj(obj_text(mesh, positions_of(mesh)));
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
  const TriangleMesh mesh = obj(text);
  EXPECT_EQ(mesh.groups.size(), 22u);
  EXPECT_EQ(obj(obj_text(mesh, positions_of(mesh))).groups, mesh.groups);
}

// Quadratic in the groups, four times as many take sixteen times as long.
TEST(ObjWriter, TimeIsLinearInTheGroupsOfOneTriangle) {
  const auto processor_time = [](int count) {
    TriangleMesh mesh = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    mesh.triangles.assign(std::size_t(count), mesh.triangles.front());
    for (int i = 0; i < count; ++i) mesh.groups["g" + std::to_string(i)] = {0, 1, 2};
    const std::clock_t start = std::clock();
    const std::string text = obj_text(mesh, positions_of(mesh));
    const std::clock_t end = std::clock();
    EXPECT_EQ(obj(text).groups, mesh.groups);
    return double(end - start) / CLOCKS_PER_SEC;
  };
  processor_time(1000);
  EXPECT_LT(processor_time(60000), 9 * processor_time(15000));
}

TEST(ObjWriter, KeepsAGroupCalledDefault) {
  const TriangleMesh mesh = obj(square + "o default\nf 1 2 3\n");
  EXPECT_EQ(obj(obj_text(mesh, positions_of(mesh))).groups.count("default_"), 1u);
}

TEST(ObjWriter, WritesTheGivenPositionsShortest) {
  const TriangleMesh mesh = obj(square + "f 1 2 3 4\n");
  const std::vector<Vec3f> moved = {{0.1f, -2.0f, 1e-20f}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_EQ(obj_text(mesh, moved), "v 0.1 -2 1e-20\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  expect_error([&] { obj_text(mesh, std::span(moved).first(3)); }, {"3 positions", "expected 4"});
}

TriangleMesh ply(const std::string& bytes) {
  return parse_ply(bytes, "a.ply");
}

std::string header(const std::string& format, const std::string& rest) {
  return "ply\nformat " + format + " 1.0\ncomment mine\n" + rest + "end_header\n";
}

const std::string triangle_elements =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\n";
const std::string ascii_triangle = header("ascii", triangle_elements) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

TEST(PlyReader, ReadsAscii) {
  const TriangleMesh mesh = ply(ascii_triangle);
  EXPECT_EQ(mesh.positions[1], Vec3d(1, 0, 0));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(PlyReader, ReadsEveryTypeInBothByteOrders) {
  for (const bool big : {false, true}) {
    // Faces first, an unknown element between, unknown properties around those wanted.
    const std::string bytes =
        header(big ? "binary_big_endian" : "binary_little_endian",
               "element face 2\nproperty uchar flag\nproperty list ushort uint vertex_index\nproperty list "
               "int double w\n"
               "element extra 2\nproperty list char float a\nproperty short b\n"
               "element vertex 4\nproperty int8 q\nproperty double x\nproperty short y\nproperty uint32 z\n"
               "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\nproperty "
               "float t\n") +
        bytes_of(big, std::uint8_t(7), std::uint16_t(3), 0u, 1u, 2u, std::int32_t(1), 0.5) +
        bytes_of(big, std::uint8_t(7), std::uint16_t(4), 0u, 1u, 2u, 3u, std::int32_t(0)) +
        bytes_of(big, std::int8_t(2), 1.0f, 2.0f, std::int16_t(3)) +
        bytes_of(big, std::int8_t(0), std::int16_t(3)) + [&] {
          std::string vertices;
          for (int i = 0; i < 4; ++i) {
            vertices +=
                bytes_of(big, std::int8_t(-1), 0.1 * i, std::int16_t(-300 * i), std::uint32_t(3000000000u),
                         std::uint8_t(255), std::uint8_t(0), std::uint8_t(51), 0.25f, 0.75f);
          }
          return vertices;
        }();
    const TriangleMesh mesh = ply(bytes);
    ASSERT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.positions[3], Vec3d(0.1 * 3, -900.0, 3e9));
    EXPECT_EQ(mesh.colors[3], Vec3f(1.0f, 0.0f, 0.2f));
    EXPECT_EQ(mesh.faces, (std::vector<Indices>{{0, 1, 2}, {0, 1, 2, 3}}));
    EXPECT_EQ(mesh.face_uvs, mesh.faces);
    EXPECT_EQ(mesh.uvs[2], (std::array<float, 2>{0.25f, 0.75f}));
  }
}

TEST(PlyReader, NamesFileAndPlaceOfBadInput) {
  const std::string binary = header("binary_little_endian", triangle_elements);
  const std::string positions = bytes_of(false, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f);
  expect_bad(
      ply,
      {{"", {"a.ply:1:", "\"ply\""}},
       {"ply\nformat ascii 2.0\n", {"a.ply:2:", "2.0"}},
       {"ply\nformat text 1.0\n", {"a.ply:2:", "\"text\""}},
       {"ply\nformat ascii 1.0\nelement vertex 1\n", {"a.ply:4:", "end of the file", "end_header"}},
       {"ply\nformat ascii 1.0\nelement vertex -1\n", {"a.ply:3:", "-1"}},
       {"ply\nformat ascii 1.0\nproperty float x\n", {"a.ply:3:", "element before"}},
       {"ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n", {"a.ply:4:", "\"half\""}},
       {header("ascii", "element vertex 1\nproperty float x\n") + "1\n", {"a.ply:", "without x, y or z"}},
       {header("ascii", triangle_elements) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
        {"a.ply:14:", "index 3", "0 to 2"}},
       {header("ascii", triangle_elements) + "0 0 0\n1 0 0\n0 1 0\n2 0 1\n", {"a.ply:14:", "2 corners"}},
       {header("ascii", triangle_elements) + "0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n", {"a.ply:12:", "\"x\""}},
       {header("ascii", triangle_elements) + "0 0 0\n1 0 0\n0 1 0\n3 0 1", {"a.ply:14:", "corners"}},
       {binary + positions + bytes_of(false, std::uint8_t(3), 0, 1, 5), {"byte ", "index 5"}},
       {binary + positions + bytes_of(false, std::uint8_t(3), 0, 1), {"byte ", "3 (corners of a face)"}},
       {binary + positions.substr(0, 30), {"byte ", "3 (vertex)"}},
       {binary + bytes_of(false, 0.f, 0.f, std::numeric_limits<float>::infinity()) + positions,
        {"byte ", "finite"}}});
}

TEST(PlyReader, DoesNotBelieveAHeaderThatClaimsMoreThanTheFileHolds) {
  for (const char* format : {"ascii", "binary_little_endian"}) {
    const std::string elements =
        "element vertex 8000000000\nproperty float x\nproperty float y\nproperty float z\n";
    expect_error([&] { ply(header(format, elements) + "0 0 0\n"); }, {"8000000000", "long enough"});
    const std::string list = "element other 1\nproperty list uint double w\n";
    expect_error([&] { ply(header(format, list) + "4294967295"); }, {"long enough"});
  }
}

TEST(PlyWriter, ReadsBackAsItWas) {
  TriangleMesh mesh = parse_obj(
      "v 0.1 0 0 1 0 0.2\nv 1 0 0 0 0 0\nv 1 1 0 1 1 1\nv 0 1 0 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "f 1/1 2/2 3/3 4/4\nf 1/1 3/3 2/2\n",
      "a.obj");
  std::vector<Vec3f> positions;
  for (const Vec3d& p : mesh.positions) positions.emplace_back(p * 3.0);
  const TriangleMesh again = ply(ply_bytes(mesh, positions));
  for (std::size_t i = 0; i < positions.size(); ++i) EXPECT_EQ(Vec3f(again.positions[i]), positions[i]);
  EXPECT_EQ(again.faces, mesh.faces);
  EXPECT_EQ(again.triangles, mesh.triangles);
  EXPECT_EQ(again.uvs, mesh.uvs);
  EXPECT_EQ(again.face_uvs, mesh.face_uvs);
  EXPECT_EQ(again.colors, mesh.colors);
  const std::string moving = ply_bytes(mesh, positions, positions);
  EXPECT_NE(moving.find("property float vx\n"), std::string::npos);
  EXPECT_EQ(ply(moving).faces, mesh.faces);
  EXPECT_EQ(ply(moving).colors, mesh.colors);
  expect_error([&] { ply_bytes(mesh, positions, std::span(positions).first(2)); }, {"2 velocities"});
}

TEST(PlyWriter, WritesParticles) {
  const std::vector<Vec3f> points = {{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(ply(ply_bytes(points, points)).positions[1], Vec3d(4, 5, 6));
  EXPECT_EQ(ply(ply_bytes(points, {})).positions.size(), 2u);
  expect_error([&] { ply_bytes(points, std::span(points).first(1)); }, {"1 velocities"});
  const std::vector<std::uint8_t> kinds = {2, 1, 0};
  expect_error([&] { ply_bytes(points, points, kinds); }, {"3 kinds"});
}

TriangleMesh stl(const std::string& bytes) {
  return parse_stl(bytes, "a.stl");
}

const std::string facet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1.5 0\n endloop\nendfacet\n";

std::string binary_stl(std::string title, std::uint32_t claimed, int triangles) {
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
  const TriangleMesh mesh = stl(capitals);
  EXPECT_EQ(mesh.positions.size(), 9u);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}));
  EXPECT_EQ(mesh.groups.at("part one").size(), 6u);
  EXPECT_EQ(mesh.groups.at("two").front(), 6u);
  for (char& c : capitals) c = c >= 'a' && c <= 'z' ? char(c - 32) : c;
  EXPECT_EQ(stl(capitals).positions, mesh.positions);
}

TEST(StlReader, ReadsBinaryEvenIfItBeginsWithSolid) {
  for (const char* title : {"anything", "solid part", "solid part\nfacet normal"}) {
    const TriangleMesh mesh = stl(binary_stl(title, 3, 3));
    ASSERT_EQ(mesh.positions.size(), 9u) << title;
    EXPECT_EQ(mesh.positions[8], Vec3d(0, 1.5, 2));
  }
}

TEST(StlReader, NamesFileAndPlaceOfBadInput) {
  expect_error([] { stl("solid a\n" + facet + "facets\n"); }, {"a.stl:9:", "\"facets\"", "endsolid"});
  expect_error([] { stl("solid a\n" + facet); }, {"a.stl:9:", "end of the file"});
  expect_error([] { stl("solid\nfacet normal 0 0 1 outer loop vertex 0 0 nan"); }, {"a.stl:2:", "\"nan\""});
  expect_error([] { stl("solid a\nendsolid a\n"); }, {"a.stl:3:", "no facet"});
  expect_error([] { stl(""); }, {"a.stl: byte 0", "80 bytes"});
  expect_error([] { stl(binary_stl("x", 4000000000u, 1)); }, {"a.stl: byte 84", "4000000000", "at most 1"});
  expect_error([] { stl(binary_stl("solid x", 1, 2)); }, {"a.stl: byte 84", "100 bytes", "50"});
  expect_error([] { stl(binary_stl("x", 0, 0)); }, {"a.stl", "no triangle"});
}

}  // namespace souple::test_io_mesh_surfaces
