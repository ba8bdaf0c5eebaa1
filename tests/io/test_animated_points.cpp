#include "io_test.h"
#include "souple/geometry/builders.h"
#include "souple/io/animated_points.h"
#include "souple/io/animated_target.h"
#include "souple/io/mdd.h"
#include "souple/io/pc2.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

namespace souple::test::test_io_animated_points {

/// A mesh file of these tests: x y z of each vertex.
std::vector<Vec3f> read_plain(const std::filesystem::path& path) {
  std::istringstream text(read_whole_file(path));
  std::vector<Vec3f> positions;
  for (Vec3f p; text >> p.x >> p.y >> p.z;) positions.push_back(p);
  return positions;
}

class AnimatedPointsTest : public FolderTest {
 protected:
  /// x of the first point at a time.
  static float x(AnimatedPoints& points, double time) {
    std::vector<Vec3f> positions(points.points());
    points.evaluate(time, positions);
    return positions[0].x;
  }
  void put_mdd(const std::vector<double>& times, float last_x = 7) const {
    MddWriter writer(folder / "a.mdd", 1, 0);
    for (std::size_t i = 0; i < times.size(); ++i) {
      const std::vector<Vec3f> at = {{i + 1 == times.size() ? last_x : static_cast<float>(i), 0, 0}};
      writer.append(times[i], at);
    }
    writer.finish();
  }
};

/// A point that moves at 3 m/s along x from 1 m, in the three formats: the same motion comes back.
TEST_F(AnimatedPointsTest, AllFormatsPlayTheSameMotion) {
  Pc2Writer pc2(folder / "a.pc2", 1, {.start_frame = 1, .sample_rate = 2});
  MddWriter mdd(folder / "a.mdd", 1, 0);
  for (int frame = 0; frame <= 10; frame += 2) {
    const std::vector<Vec3f> at = {{1 + 3 * static_cast<float>(frame) / 20, 0, 0}};
    pc2.append(at);
    mdd.append(frame / 20.0, at);
    put("a_" + std::to_string(1001 + frame) + ".obj", std::to_string(at[0].x) + " 0 0");
  }
  pc2.finish();
  mdd.finish();
  for (const char* name : {"a.pc2", "a.mdd", "a_1001.obj"}) {
    AnimatedPoints points(folder / name, {.frame_rate = 20, .start_time = 0.25}, read_plain);
    EXPECT_DOUBLE_EQ(points.start_time(), 0.25);
    EXPECT_NEAR(points.end_time(), 0.75, 1e-7);
    EXPECT_EQ(x(points, 0), 1) << "stands still before";
    EXPECT_NEAR(x(points, 9), 2.5, 1e-6) << "stands still after";
    // There and back: the order of the times must not matter.
    for (const double time : {0.25, 0.26, 0.35, 0.5, 0.7499, 0.3, 0.74})
      EXPECT_NEAR(x(points, time), 1 + 3 * (time - 0.25), 1e-5) << name << " at " << time;
  }
}

TEST_F(AnimatedPointsTest, HitsItsFramesExactly) {
  put_mdd({0, 0.5, 2}, 0.1f);
  AnimatedPoints points(folder / "a.mdd", {});
  EXPECT_EQ(x(points, 0.5), 1);
  EXPECT_EQ(x(points, 2), 0.1f);
}

TEST_F(AnimatedPointsTest, BadAnimationsAreErrors) {
  const auto open = [&](const char* name) { AnimatedPoints(folder / name, {}, read_plain); };
  put_mdd({});
  expect_error([&] { open("a.mdd"); }, {"holds no frame"});
  put_mdd({0, 1, 1});
  expect_error([&] { open("a.mdd"); }, {"frame 2"});
  put_mdd({0, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_THROW(open("a.mdd"), Error);
  EXPECT_THROW(open("none.pc2"), Error);
  expect_error([&] { AnimatedPoints(folder / "a_1.obj", {}); }, {".pc2, a .mdd"});
  expect_error([&] { AnimatedPoints(folder / "a.pc2", {.frame_rate = 0}); }, {"frame rate"});
}

TEST_F(AnimatedPointsTest, BadFramesAreErrorsWhenTheirTimeComes) {
  put_mdd({0, 1, 2}, std::numeric_limits<float>::infinity());
  AnimatedPoints points(folder / "a.mdd", {});
  EXPECT_EQ(x(points, 0.5), 0.5f);
  expect_error([&] { x(points, 1.5); }, {"point 0 of frame 2"});
  EXPECT_EQ(x(points, 0.5), 0.5f);

  put("b_1.obj", "0 0 0");
  put("b_2.obj", "0 0 0 1 1 1");
  AnimatedPoints meshes(folder / "b_1.obj", {.frame_rate = 1}, read_plain);
  expect_error([&] { x(meshes, 0.5); }, {"has 2 vertices"});
  std::vector<Vec3f> two(2);
  EXPECT_THROW(meshes.evaluate(0, two), Error);
}

constexpr double rate = 30;
constexpr int last = 30;

/// A cloth whose rim is driven by an animation that was written to a file: swinging, rising, each vertex its own
/// way.
class AnimatedTargetTest : public FolderTest {
 protected:
  const TriangleMesh mesh = grid(5, 4, 1);

  std::vector<Vec3f> moved(int frame) const {
    const double t = frame / rate;
    std::vector<Vec3f> positions;
    for (const Vec3d& x : mesh.positions)
      positions.push_back(Vec3f(x + Vec3d{0.2 * std::sin(3 * t) * (1 + x.x), 0.3 * t, 0.1 * x.z * t}));
    return positions;
  }
  /// Every captured frame finds the driven vertices at the file's positions, whatever the formats' rounding.
  void expect_followed(AnimatedPoints points) const {
    const std::vector<std::uint32_t> driven{0, 4, 7, 19};
    World world;
    const ObjectId cloth = world.add_cloth(mesh);
    world.pin(cloth, vertices(driven), animated_target(std::make_shared<AnimatedPoints>(std::move(points))));
    for (int frame = 1; frame <= last; ++frame) {
      const StepReport& report = world.step(1 / rate);
      EXPECT_FALSE(report.has(Flag::callback_failed)) << report.message;
      const auto expected = moved(frame);
      for (const std::uint32_t v : driven)
        EXPECT_LT(length(world.positions(cloth)[v] - expected[v]), 2e-6f)
            << "vertex " << v << ", frame " << frame;
    }
    // The rest is dragged along, not left behind: 0.3 m up in a second.
    EXPECT_GT(length(world.positions(cloth)[9] - Vec3f(mesh.positions[9])), 0.05f);
  }
};

TEST_F(AnimatedTargetTest, PinsFollowAnMdd) {
  MddWriter writer(folder / "a.mdd", mesh.positions.size(), 0);
  for (int frame = 0; frame <= last; ++frame) writer.append(frame / rate, moved(frame));
  writer.finish();
  expect_followed(AnimatedPoints(folder / "a.mdd", {}));
}

/// An animation with too few points is told in the step's report, and the pin stays where it is.
TEST_F(AnimatedTargetTest, TooFewPointsAreReported) {
  Pc2Writer writer(folder / "a.pc2", 3);
  writer.append(frame_of(3, 0));
  writer.finish();
  const auto points = std::make_shared<AnimatedPoints>(folder / "a.pc2", AnimatedPoints::Options());
  World world;
  const ObjectId cloth = world.add_cloth(mesh);
  world.pin(cloth, vertices({4}), animated_target(points));
  const StepReport& report = world.step(1 / rate);
  EXPECT_TRUE(report.has(Flag::callback_failed));
  expect_words(report.message, {"3 points, none for vertex 4"});
  expect_error([] { (void)animated_target(nullptr); }, {"null"});
}

}  // namespace souple::test::test_io_animated_points
