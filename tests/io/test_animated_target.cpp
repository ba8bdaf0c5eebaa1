#include "io_test.h"
#include "souple/geometry/builders.h"
#include "souple/io/animated_target.h"
#include "souple/io/mdd.h"
#include "souple/io/pc2.h"

#include <cmath>
#include <utility>

namespace souple::test::test_io_animated_target {

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
  expect_says(report.message, "3 points, none for vertex 4");
  expect_says(error_of([] { (void)animated_target(nullptr); }), "null");
}

}  // namespace souple::test::test_io_animated_target
