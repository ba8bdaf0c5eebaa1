#include "mesh_expect.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/mesh_write.h"

#include <limits>
#include <vector>

namespace souple::test_io_mesh_ply {

using Indices = std::vector<std::uint32_t>;

TriangleMesh parse(const std::string& bytes) {
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
  const TriangleMesh mesh = parse(ascii_triangle);
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
    const TriangleMesh mesh = parse(bytes);
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
  const struct {
    std::string bytes;
    std::initializer_list<std::string> parts;
  } cases[] = {
      {"", {"a.ply:1:", "\"ply\""}},
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
       {"byte ", "finite"}}};
  for (const auto& bad : cases) {
    SCOPED_TRACE(bad.bytes);
    expect_error([&] { parse(bad.bytes); }, bad.parts);
  }
}

TEST(PlyReader, DoesNotBelieveAHeaderThatClaimsMoreThanTheFileHolds) {
  for (const char* format : {"ascii", "binary_little_endian"}) {
    const std::string elements =
        "element vertex 8000000000\nproperty float x\nproperty float y\nproperty float z\n";
    expect_error([&] { parse(header(format, elements) + "0 0 0\n"); }, {"8000000000", "long enough"});
    const std::string list = "element other 1\nproperty list uint double w\n";
    expect_error([&] { parse(header(format, list) + "4294967295"); }, {"long enough"});
  }
}

TEST(PlyWriter, ReadsBackAsItWas) {
  TriangleMesh mesh = parse_obj(
      "v 0.1 0 0 1 0 0.2\nv 1 0 0 0 0 0\nv 1 1 0 1 1 1\nv 0 1 0 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "f 1/1 2/2 3/3 4/4\nf 1/1 3/3 2/2\n",
      "a.obj");
  std::vector<Vec3f> positions;
  for (const Vec3d& p : mesh.positions) positions.emplace_back(p * 3.0);
  const TriangleMesh again = parse(ply_bytes(mesh, positions));
  for (std::size_t i = 0; i < positions.size(); ++i) EXPECT_EQ(Vec3f(again.positions[i]), positions[i]);
  EXPECT_EQ(again.faces, mesh.faces);
  EXPECT_EQ(again.triangles, mesh.triangles);
  EXPECT_EQ(again.uvs, mesh.uvs);
  EXPECT_EQ(again.face_uvs, mesh.face_uvs);
  EXPECT_EQ(again.colors, mesh.colors);
  const std::string moving = ply_bytes(mesh, positions, positions);
  EXPECT_NE(moving.find("property float vx\n"), std::string::npos);
  EXPECT_EQ(parse(moving).faces, mesh.faces);
  EXPECT_EQ(parse(moving).colors, mesh.colors);
  expect_error([&] { ply_bytes(mesh, positions, std::span(positions).first(2)); }, {"2 velocities"});
}

TEST(PlyWriter, WritesParticles) {
  const std::vector<Vec3f> points = {{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(parse(ply_bytes(points, points)).positions[1], Vec3d(4, 5, 6));
  EXPECT_EQ(parse(ply_bytes(points, {})).positions.size(), 2u);
  expect_error([&] { ply_bytes(points, std::span(points).first(1)); }, {"1 velocities"});
  const std::vector<std::uint8_t> kinds = {2, 1, 0};
  expect_error([&] { ply_bytes(points, points, kinds); }, {"3 kinds"});
}

}  // namespace souple::test_io_mesh_ply
