// Obstacles of scene files: motion by sequences, collisions, and messages about invalid sequences.
#include "scene_test.h"
#include "souple/geometry/builders.h"
#include "souple/io/mdd.h"
#include "souple/io/pc2.h"
#include "souple/io/playback.h"
#include "souple/io/recorder.h"
#include "souple/world/world.h"
#include "tests/expect_error.h"
#include "tests/folder_test.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace souple::scene_test::test_scene_obstacle {

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
    expect_error([&] { built(scene); }, words);
    try {
      built(scene);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
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

}  // namespace souple::scene_test::test_scene_obstacle
