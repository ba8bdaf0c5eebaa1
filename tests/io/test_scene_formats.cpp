#include "io_test.h"
#include "souple/files/endian.h"
#include "souple/geometry/builders.h"
#include "souple/io/glb_model.h"
#include "souple/io/glb_run.h"
#include "souple/io/material_file.h"
#include "souple/io/split_mesh.h"
#include "souple/io/usda_run.h"
#include "souple/io/usda_text.h"

#include <cstdio>
#include <utility>

#include <gtest/gtest.h>

// Details that the program's own tests (tests/app/test_cli_convert.py), which read whole files back, do not see.

namespace souple::test::test_io_scene_formats {

std::uint32_t number_at(const std::string& bytes, std::size_t offset) {
  return load<ByteOrder::little, std::uint32_t>(reinterpret_cast<const std::byte*>(bytes.data() + offset));
}

TEST(GlbModel, ChunksArePadded) {
  for (std::size_t letters = 0; letters < 4; ++letters) {
    GlbModel model;
    model.name = std::string(letters, 'n');
    model.add_scalars(std::vector<float>{1, 2, 3});
    const std::string bytes = model.bytes();
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(number_at(bytes, 8), bytes.size());
    const std::uint32_t json = number_at(bytes, 12);
    EXPECT_EQ(json % 4, 0u);
    EXPECT_EQ(number_at(bytes, 20 + json), 12u);
    EXPECT_EQ(bytes.size(), 20 + json + 8 + 12);
  }
}

TEST(GlbModel, NamesMustBeUtf8) {
  GlbModel model;
  model.name = "\xff";
  expect_error([&] { (void)model.bytes(); }, {"is not UTF-8"});
}

/// A point that stays and one that moves.
std::vector<ExportObject> two_points(const std::vector<Vec3f>& still, const std::vector<Vec3f>& moving) {
  static const TriangleMesh none;
  std::vector<ExportObject> objects(2);
  for (ExportObject& object : objects)
    object.shape = ExportShape::grains, object.kind = "grains", object.mesh = &none;
  objects[0].name = "still", objects[0].positions = still;
  objects[1].name = "moving", objects[1].positions = moving;
  return objects;
}

TEST(GlbClip, ObjectsAtRestHaveNoTargets) {
  GlbClip clip("run");
  const std::vector<Vec3f> still{{1, 2, 3}}, here{{0, 0, 0}}, there{{0, 1, 0}};
  clip.add(0.1, two_points(still, here));
  clip.add(0.2, two_points(still, there));
  clip.add(0.3, two_points(still, here));
  const std::string bytes = std::move(clip).bytes();
  const auto count = [&](const char* word) {
    std::size_t found = 0;
    for (std::size_t at = bytes.find(word); at != std::string::npos; at = bytes.find(word, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("\"targets\""), 1u);
  EXPECT_EQ(count("\"channels\""), 1u);
  EXPECT_NE(bytes.find("[\"frame 2\",\"frame 3\"]"), std::string::npos);
}

TEST(UsdaText, NamesArePrimNames) {
  usda::PrimNames names;
  EXPECT_EQ(names.add("ball"), "ball");
  EXPECT_EQ(names.add("ball"), "ball_2");
  EXPECT_EQ(names.add("7-up"), "_7_up");
  EXPECT_EQ(names.add(""), "_");
  EXPECT_EQ(names.add("\xc3\xbc"), "__");
}

TEST(UsdaText, ValuesReadBackToTheSameFloats) {
  const std::vector<Vec3f> values{{0.1f, -1e-20f, 123456.789f}};
  const std::string text = usda::exact(values);
  float x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(text.c_str(), "[(%f, %f, %f)]", &x, &y, &z), 3) << text;
  EXPECT_EQ(Vec3f(x, y, z), values[0]);
  EXPECT_EQ(usda::rounded(values, 3), "[(0.1, -1e-20, 1.23e+05)]");
  EXPECT_EQ(usda::exact({}), "[]");
  EXPECT_EQ(usda::extent(std::vector<Vec3f>{{1, 2, 3}, {0, 5, 3}}, 1), "[(-1, 1, 2), (2, 6, 4)]");
  EXPECT_EQ(usda::string_text("a\"b\\\n"), "\"a\\\"b\\\\ \"");
}

// A value that stays is written where it begins and ends, so that readers that interpolate see no change.
TEST(UsdaRun, SamplesOfAPauseAreItsEnds) {
  UsdaRun::Options options{.run = "run", .frame_rate = 24, .frames = 5};
  const std::vector<Vec3f> still{{1, 2, 3}}, here{{0, 0, 0}}, there{{0, 1, 0}};
  UsdaRun usda(options, two_points(still, here));
  for (std::uint64_t frame = 1; frame <= 5; ++frame)
    usda.add(frame, two_points(still, frame < 4 ? here : there));
  const std::string stage = usda.stage();
  expect_words(stage, {"point3f[] positions = [(1, 2, 3)]\n"});
  const std::size_t begin = stage.find("point3f[] positions.timeSamples");
  ASSERT_NE(begin, std::string::npos);
  std::string samples = stage.substr(begin, stage.find('}', begin) - begin);
  std::erase(samples, ' ');
  EXPECT_EQ(samples,
            "point3f[]positions.timeSamples={\n1:[(0,0,0)],\n3:[(0,0,0)],\n4:[(0,1,0)],\n5:[(0,1,0)],\n");
}

TEST(UsdaRun, ObjectsWhoseNamesBecomeEqualKeepTheirMaterials) {
  const std::vector<Vec3f> point{{1, 2, 3}};
  std::vector<ExportObject> objects = two_points(point, point);
  objects[0].name = "a-b", objects[0].look.color = {0, 1, 0};
  objects[1].name = "a_b", objects[1].look.color = {1, 0, 0};
  UsdaRun usda({.run = "run", .frame_rate = 24, .frames = 1}, objects);
  usda.add(1, objects);
  const std::string stage = usda.stage();
  expect_words(stage, {"inputs:diffuseColor = (0, 1, 0)"});
  expect_words(stage, {"inputs:diffuseColor = (1, 0, 0)"});
}

/// A roof of two quads with a seam of UVs at its ridge 1-4, and two materials.
TriangleMesh roof() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {0, 0, 1}, {1, 1, 1}, {2, 0, 1}};
  mesh.faces = {{0, 3, 4, 1}, {1, 4, 5, 2}};
  mesh.triangles = {{0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}};
  mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  mesh.face_uvs = {{0, 1, 2, 3}, {0, 1, 2, 3}};
  mesh.appearance.materials = {"red", "blue"};
  mesh.appearance.face_materials = {1, 0};
  mesh.groups["left"] = {0, 1, 3, 4};
  return mesh;
}

TEST(SplitMesh, CopiesVerticesAtSeamsOnly) {
  const TriangleMesh mesh = roof();
  const SplitMesh split = split_mesh(mesh);
  EXPECT_EQ(split.source_vertices, 6u);
  EXPECT_EQ(split.copies, (std::vector<std::uint32_t>{1, 4}));
  ASSERT_EQ(split.parts.size(), 2u);
  EXPECT_EQ(split.parts[0].material, 1u);
  EXPECT_EQ(split.parts[1].material, 0u);
  std::size_t next = 0;
  for (const SplitMesh::Part& part : split.parts) {
    for (const Triangle& t : part.triangles) {
      Triangle source{};
      for (std::size_t i = 0; i < 3; ++i) source[i] = split.source(t[i]);
      EXPECT_EQ(source, mesh.triangles[next]) << next;
      ++next;
    }
  }
  EXPECT_EQ(next, 4u);
  // The corner of the second face at vertex 1 has the UV of its first corner.
  EXPECT_EQ(split.uvs[1], (std::array<float, 2>{1, 0}));
  EXPECT_EQ(split.uvs[6], (std::array<float, 2>{0, 0}));
  const std::vector<Vec3f> spread =
      split.spread(std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {5, 0, 0}});
  EXPECT_EQ(spread.back().x, 4);
}

TEST(SplitMesh, AMeshWithoutSeamsKeepsItsVertices) {
  const TriangleMesh mesh = grid(5, 4, 1);
  const SplitMesh split = split_mesh(mesh);
  EXPECT_TRUE(split.copies.empty());
  ASSERT_EQ(split.parts.size(), 1u);
  EXPECT_EQ(split.parts[0].material, FaceAppearance::no_material);
  EXPECT_EQ(split.parts[0].triangles, mesh.triangles);
}

TEST(SplitMesh, AGroupHoldsTheFacesInsideIt) {
  const TriangleMesh mesh = roof();
  EXPECT_EQ(faces_of_group(mesh, mesh.groups.at("left")), (std::vector<std::uint32_t>{0}));
}

TEST(SplitMesh, SharpEdgesAreNotSmooth) {
  const TriangleMesh ball = sphere(2, 0.5), crate = box({1, 1, 1}, 2);
  EXPECT_TRUE(is_smooth(ball.positions, ball.triangles));
  EXPECT_FALSE(is_smooth(crate.positions, crate.triangles));
}

TEST(MaterialFile, ReadsColorsAndOpacities) {
  const auto materials = parse_materials(
      "# a comment\nKd 1 1 1\nnewmtl Blue cloth\r\nNs 10\nKd 0 0.25 7\nd 0.5\nmap_Kd wood.png\nnewmtl "
      "plain\nKd 1 x 0\nd\n");
  ASSERT_EQ(materials.size(), 2u);
  EXPECT_EQ(materials.at("Blue cloth").color, Vec3f(0, 0.25f, 1));
  EXPECT_EQ(materials.at("Blue cloth").opacity, 0.5f);
  EXPECT_EQ(materials.at("plain").color, Vec3f(0.8f, 0.8f, 0.8f));
  EXPECT_EQ(materials.at("plain").opacity, 1);
  EXPECT_TRUE(parse_materials("").empty());
}

}  // namespace souple::test::test_io_scene_formats
