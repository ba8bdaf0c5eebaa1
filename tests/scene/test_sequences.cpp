#include "souple/geometry/builders.h"
#include "souple/io/mdd.h"
#include "souple/io/pc2.h"
#include "souple/io/playback.h"
#include "souple/io/recorder.h"
#include "souple/scene/first_frame.h"
#include "souple/world/world.h"
#include "tests/expect_error.h"
#include "tests/folder_test.h"
#include "tests/scene/scene_test.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

namespace souple::scene_test::test_scene_sequences {

/// A body of unequal sides: 0.3 x 1.8 x 0.5 m, standing 0.9 m above the origin, without symmetry.
std::vector<Vec3d> body() {
  std::vector<Vec3d> points = box({0.3, 1.8, 0.5}, {2, 6, 3}).positions;
  for (Vec3d& x : points) x = {x.x * (1 + 0.2 * x.y), x.y + 0.9, x.z + 0.1 * x.y};
  return points;
}

template <class Change>
std::vector<Vec3f> frame_of(const Change& change) {
  std::vector<Vec3f> frame;
  for (const Vec3d& x : body()) frame.push_back(Vec3f(change(x)));
  return frame;
}

/// Y up as Blender's Z up: (x, -z, y).
Vec3d z_up(const Vec3d& x) {
  return {x.x, -x.z, x.y};
}

TEST(FirstFrame, ThatFitsIsNotRemarkedOn) {
  EXPECT_EQ(first_frame_remark(body(), frame_of([](const Vec3d& x) { return x; }), {}), "");
  EXPECT_EQ(first_frame_remark(body(), frame_of(z_up), {.up = UpAxis::z}), "");
  // Elsewhere, and bent: an animation may begin so.
  const auto bent = frame_of([](const Vec3d& x) { return x + Vec3d{0.1 * x.y * x.y + 20, 0, 3}; });
  EXPECT_EQ(first_frame_remark(body(), bent, {}), "");
}

TEST(FirstFrame, RotatedNamesTheUpAxis) {
  const std::string text = first_frame_remark(body(), frame_of(z_up), {});
  EXPECT_EQ(text, "is the mesh rotated by 90 degrees; add \"up\": \"z\" to the sequence");
  const auto x_up = frame_of([](const Vec3d& x) { return Vec3d{x.y, -x.x, x.z}; });
  EXPECT_NE(first_frame_remark(body(), x_up, {}).find("\"up\": \"x\""), std::string::npos);
  // Mesh and sequence are both read as Z up, but the sequence is Y up.
  const auto y_up = frame_of([](const Vec3d& x) { return x; });
  EXPECT_NE(first_frame_remark(body(), y_up, {.up = UpAxis::z}).find("\"up\": \"y\""), std::string::npos);
  const auto turned = frame_of([](const Vec3d& x) { return Vec3d{-x.x, x.y, -x.z}; });
  EXPECT_EQ(first_frame_remark(body(), turned, {}),
            "is the mesh rotated by 180 degrees; export the animation with the axes of the mesh");
}

TEST(FirstFrame, ScaledNamesTheScale) {
  const auto centimeters = frame_of([](const Vec3d& x) { return x * 100; });
  EXPECT_EQ(first_frame_remark(body(), centimeters, {}),
            "is the mesh 100 times as large; add \"scale\": 0.01 to the sequence");
  const auto both = frame_of([](const Vec3d& x) { return z_up(x) * 0.01; });
  EXPECT_EQ(
      first_frame_remark(body(), both, {.scale = 0.5}),
      "is the mesh rotated by 90 degrees and 0.005 times as large; add \"up\": \"z\", \"scale\": 100 to "
      "the sequence");
}

TEST(FirstFrame, OfOtherVerticesIsRemarkedOn) {
  std::vector<Vec3f> shuffled = frame_of([](const Vec3d& x) { return x; });
  for (std::size_t i = 0; i < shuffled.size(); ++i)
    std::swap(shuffled[i], shuffled[(i * 37) % shuffled.size()]);
  EXPECT_NE(first_frame_remark(body(), shuffled, {}).find("does not resemble the mesh"), std::string::npos);
}

class SequenceScene : public test::FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    std::ofstream obj(folder / "body.obj");
    for (const Vec3d& x : body()) obj << "v " << x.x << ' ' << x.y << ' ' << x.z << '\n';
    for (const Triangle& t : box({0.3, 1.8, 0.5}, {2, 6, 3}).triangles)
      obj << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    MddWriter mdd(folder / "body.mdd", body().size(), 2);
    const auto frame = frame_of([](const Vec3d& x) { return z_up(x) * 100; });
    mdd.append(0, frame);
    mdd.append(1, frame);
    mdd.finish();
  }

  /// The world of an object with this text beside its mesh; `warnings` gets what the builder warns of.
  World build(const std::string& text) {
    const std::string scene =
        R"({"souple": 1, "objects": [{"name": "body", "mesh": {"file": "body.obj"}, )" + text + "}]}";
    return build_world(parse_scene(scene, folder, "test.json"), [&](LogLevel level, std::string_view line) {
      if (level == LogLevel::warning) warnings.emplace_back(line);
    });
  }

  std::vector<std::string> warnings;
};

TEST_F(SequenceScene, IsComparedForObstaclesAndPins) {
  build(R"("kind": "obstacle", "sequence": {"file": "body.mdd"})");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0],
            "body: the first frame of body.mdd is the mesh rotated by 90 degrees and 100 times as large; add "
            "\"up\": \"z\", \"scale\": 0.01 to the sequence");
  build(R"("kind": "cloth", "pins": [{"all": true, "sequence": {"file": "body.mdd"}}])");
  EXPECT_EQ(warnings.size(), 2u);
}

TEST_F(SequenceScene, TakesItsOwnUpAndScale) {
  const std::string sequence = R"({"file": "body.mdd", "up": "z", "scale": 0.01})";
  for (const std::string& object :
       {R"("kind": "obstacle", "sequence": )" + sequence,
        R"("kind": "cloth", "pins": [{"all": true, "sequence": )" + sequence + "}]"}) {
    World world = build(object + R"(, "transform": {"rotate": [0, 90, 0], "translate": [1, 2, 3]})");
    EXPECT_TRUE(warnings.empty());
    const ObjectId id = world.find_object("body");
    const std::vector<Vec3f> before(world.positions(id).begin(), world.positions(id).end());
    world.step(1.0 / 60);
    for (std::size_t v = 0; v < before.size(); ++v)
      EXPECT_LT(length(world.positions(id)[v] - before[v]), 1e-5f) << v;
  }
}

// The cache of a tet mesh holds its surface; it can move what it holds.
TEST_F(SequenceScene, OfATetMeshMayHoldItsSurface) {
  const std::string bar = R"({"souple": 1, "objects": [{"name": "bar", "kind": "soft_body",
      "mesh": {"tet_bar": {"cells": [3, 3, 3], "size": [0.3, 0.3, 0.3]}}, "pins": [)";
  World world = build_world(parse_scene(bar + "]}]}", folder, "test.json"));
  const ObjectId object = world.find_object("bar");
  const std::vector<std::uint32_t> surface = recorded_vertices(world, object);
  ASSERT_EQ(surface.size(), 56u);
  Pc2Writer cache(folder / "bar.pc2", surface.size());
  std::vector<Vec3f> frame;
  frame.reserve(surface.size());
  for (const std::uint32_t v : surface) frame.push_back(world.positions(object)[v] + Vec3f{0, 1, 0});
  cache.append(frame);
  cache.finish();
  const auto pinned = [&](std::uint32_t vertex) {
    return bar + R"({"vertices": [)" + std::to_string(vertex) + R"(], "sequence": {"file": "bar.pc2"}}]}]})";
  };
  World moved = build_world(parse_scene(pinned(surface.back()), folder, "test.json"));
  const Vec3f before = world.positions(object)[surface.back()];
  moved.step(1.0 / 60);
  EXPECT_NEAR(moved.positions(object)[surface.back()].y, before.y + 1, 1e-5f);
  std::uint32_t inside = 0;
  while (std::find(surface.begin(), surface.end(), inside) != surface.end()) ++inside;
  expect_error([&] { build_world(parse_scene(pinned(inside), folder, "test.json")); },
               {"pins[0]: sequence: bar.pc2 has the 56 vertices on the surface"});
}

TEST_F(SequenceScene, SizesOfOtherUnitsAreRemarkedOn) {
  build(R"("kind": "obstacle", "transform": {"scale": 100})");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("body: is 180 m large; if it should not be, set \"scale\" of its mesh"),
            std::string::npos)
      << warnings[0];
  build(R"("kind": "obstacle", "transform": {"scale": 0.0004})");
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[1].find("0.00072 m large"), std::string::npos) << warnings[1];
  build(R"("kind": "obstacle")");
  EXPECT_EQ(warnings.size(), 2u);
}

// Obstacles of scene files: motion by sequences, collisions, and messages about invalid sequences.

namespace fs = std::filesystem;

constexpr int frames = 25;  // the last frame equals the first

/// Radius factor of a sphere that pulsates once in 24 frames.
double breath(double frame) {
  return 0.8 + 0.2 * std::cos(2 * std::numbers::pi * frame / (frames - 1));
}

std::vector<Vec3f> breathing(int frame) {
  std::vector<Vec3f> points;
  for (const Vec3d& x : sphere(2, 0.5).positions) points.push_back(Vec3f(x * breath(frame)));
  return points;
}

class ObstacleScene : public test::FolderTest {
 protected:
  fs::path file(const std::string& name) const { return folder / name; }

  void write_pc2(int count = frames) const {
    Pc2Writer writer(file("breath.pc2"), breathing(0).size());
    for (int frame = 0; frame < count; ++frame) writer.append(breathing(frame));
    writer.finish();
  }
  void write_mdd() const {
    MddWriter writer(file("breath.mdd"), breathing(0).size(), frames);
    for (int frame = 0; frame < frames; ++frame) writer.append(frame / 24.0, breathing(frame));
    writer.finish();
  }
  void write_obj() const {
    for (int frame = 0; frame < frames; ++frame) {
      char name[32];
      std::snprintf(name, sizeof name, "breath_%04d.obj", frame + 1);
      std::ofstream obj(file(name));
      obj.precision(9);
      for (const Vec3f& x : breathing(frame)) obj << "v " << x.x << ' ' << x.y << ' ' << x.z << '\n';
      obj << "f 1 2 3\n";
    }
  }

  /// A ball of radius 1 m at height 2 m that follows a file, and further keys of the scene.
  std::string text(const std::string& sequence, const std::string& more = "") const {
    return R"({"souple": 1, "objects": [{"name": "ball", "kind": "obstacle",
      "mesh": {"sphere": {"radius": 0.5, "subdivisions": 2}},
      "transform": {"translate": [0, 2, 0], "scale": 2}, "material": {"thickness": 0.02},
      "sequence": {"file": ")" +
           sequence + R"(", "frame_rate": 24, "loop": true}})" + more + "]}";
  }
  World built(const std::string& scene) const { return build_world(parse_scene(scene, folder, "test.json")); }
};

double radius_at(double time) {
  const double frame = std::fmod(time * 24, frames - 1), before = std::floor(frame);
  return breath(before) + (breath(before + 1) - breath(before)) * (frame - before);
}

TEST_F(ObstacleScene, EverySortOfFileIsFollowed) {
  write_pc2(), write_mdd(), write_obj();
  for (const char* name : {"breath.pc2", "breath.mdd", "breath_0001.obj", "."}) {
    SCOPED_TRACE(name);
    World world = built(text(name));
    const ObjectId ball = world.find_object("ball");
    for (int i = 1; i <= 100; ++i) {
      world.step(0.013);
      const auto positions = world.positions(ball);
      for (std::size_t v = 0; v < positions.size(); v += 31)
        ASSERT_NEAR(length(Vec3d(positions[v]) - Vec3d{0, 2, 0}), radius_at(0.013 * i), 1e-5) << i;
    }
    EXPECT_NEAR(radius_at(1.5), 0.6, 1e-9);
  }
}

TEST_F(ObstacleScene, ABallThatBreathesKeepsAClothOutside) {
  write_pc2();
  World world = built(text("breath.pc2", R"(, {"name": "cloth", "kind": "cloth",
      "mesh": {"grid": {"columns": 21, "rows": 21, "size": 2.4}}, "transform": {"translate": [0, 3.05, 0]},
      "material": {"preset": "cotton", "thickness": 0.02, "friction": 1}})"));
  const ObjectId cloth = world.find_object("cloth");
  // Flat triangles of the ball are inside the sphere of their corners.
  double inner = 1;
  const TriangleMesh mesh = sphere(2, 1);
  for (const Triangle& t : mesh.triangles)
    inner = std::min(inner, length(mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3);
  for (int frame = 1; frame <= 90; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    const double radius = inner * radius_at(frame / 60.0);
    for (const Vec3f& x : world.positions(cloth))
      ASSERT_GT(length(Vec3d(x) - Vec3d{0, 2, 0}), radius + 0.01) << frame;
    ASSERT_EQ(report.flags & ~static_cast<std::uint32_t>(Flag::large_strain), 0u) << report.message;
  }
  // The object rests on the ball.
  EXPECT_FALSE(world.contacts().empty());
  EXPECT_GT(world.center_of_mass(cloth).y, 1.6);
}

TEST_F(ObstacleScene, ARunKeepsItsMotion) {
  write_pc2();
  World world = built(text("breath.pc2"));
  const ObjectId ball = world.find_object("ball");
  std::vector<std::vector<Vec3f>> seen;
  {
    Recorder recorder(world, file("run"));
    for (int frame = 0; frame < 5; ++frame) {
      world.step(1.0 / 60);
      recorder.capture();
      seen.emplace_back(world.positions(ball).begin(), world.positions(ball).end());
    }
    recorder.finish();
  }
  Playback playback(file("run"));
  ASSERT_EQ(playback.frames(), 5u);
  ASSERT_EQ(playback.objects().size(), 1u);
  EXPECT_EQ(playback.objects()[0].kind, "obstacle");
  EXPECT_EQ(playback.objects()[0].triangles.size(), world.triangles(ball).size());
  for (std::uint64_t frame = 1; frame <= 5; ++frame) {
    playback.read(frame);
    EXPECT_EQ(playback.objects()[0].positions, seen[frame - 1]);
  }
}

TEST_F(ObstacleScene, WhatIsBadIsSaidInOneLine) {
  write_pc2();
  const auto expect = [&](const std::string& scene, std::initializer_list<std::string> words) {
    const std::string said = error_of([&] { built(scene); });
    expect_words(said, words);
    EXPECT_EQ(said.find('\n'), std::string::npos);
  };
  expect(text("none.pc2"), {"test.json", "objects[0].sequence.file", "none.pc2"});
  Pc2Writer small(file("small.pc2"), 5);
  small.append(std::vector<Vec3f>(5));
  small.finish();
  expect(text("small.pc2"), {"test.json", "objects[0]", "sequence", "small.pc2", "5 vertices", "162"});
  fs::resize_file(file("breath.pc2"), fs::file_size(file("breath.pc2")) - 100);
  expect(text("breath.pc2"), {"test.json", "objects[0]", "sequence", "breath.pc2"});
  write_obj();
  std::ofstream(file("breath_0007.obj")) << "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";
  for (const char* name : {"breath_0001.obj", "."})
    expect(text(name), {"test.json", "objects[0]", "sequence", "breath_0007.obj", "3 vertices"});
  std::ofstream(file("breath_0007.obj")) << "v 0 0 zero\n";
  expect(text("."), {"test.json", "objects[0]", "sequence", "breath_0007.obj"});
  std::ofstream(file("other_0001.obj")) << "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";
  expect(text("."), {"objects[0]", "sequence", "several", "breath_0001.obj", "other_0001.obj"});
  fs::create_directories(file("empty"));
  expect(text("empty"), {"objects[0]", "sequence", "empty", "no sequence", "NAME_0001.obj"});
  expect(with_object(R"("kind": "obstacle", "mesh": {"sphere": {"radius": 1}}, "pins": [])"),
         {"objects[0].pins", "belongs to a cloth"});
  expect(with_object(R"("kind": "obstacle", "mesh": {"sphere": {"radius": 1}}, "loop": true)"),
         {"objects[0].loop", "keyframes"});
}

}  // namespace souple::scene_test::test_scene_sequences
