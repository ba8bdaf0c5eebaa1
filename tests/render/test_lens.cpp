// Depth of field and motion blur, against the circle of confusion and the way of a ball.
#include "gl_test.h"
#include "render/display.h"
#include "render/moving_subject.h"

#include <array>
#include <cmath>
#include <vector>

namespace souple::render::test_render_lens {

constexpr int width = 480, height = 120;

/// Light of a small object before black: where it is, and how far it is spread across. [pixels]
struct Spot {
  double sum = 0, x = 0, variance = 0;
};

Spot spot_in(const Image& image) {
  Spot spot;
  double square = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double light = linear(image.at(x, y)[0]);
      spot.sum += light;
      spot.x += light * x;
      square += light * x * x;
    }
  spot.x /= spot.sum;
  spot.variance = square / spot.sum - spot.x * spot.x;
  return spot;
}

class LensTest : public GlTest {
 protected:
  static Camera camera() { return camera_at({0, 0, 4}, {}, 20); }
  static double pixels_per_meter(double depth) { return height / (2 * depth * std::tan(10 * pi / 180)); }
  /// Only the sun shines, from the eye.
  static void make_dark(DrawList& list) {
    list.ground.shown = false;
    list.light.to_sun = {0, 0, 1};
    list.light.sky = list.light.horizon = list.light.floor = {0, 0, 0, 1};
  }
  static RenderOptions options() {
    RenderOptions result = plain();
    result.samples = 64;
    result.tone_curve = false;
    result.exposure = 0.7f;
    return result;
  }
  /// A ball at this depth.
  Spot spot(float depth, const RenderOptions& options) {
    center_ = {0, 0, 4 - depth};
    DrawList list;
    make_dark(list);
    list.spheres.push_back({.key = 1,
                            .version = ++version_,
                            .centers = {&center_, 1},
                            .radius = 0.02f,
                            .look = {.color = srgb(0xffffff)}});
    return spot_in(renderer().picture(list, camera(), options, width, height));
  }

  Vec3f center_{};
  std::uint64_t version_ = 0;
};

/// A lens of diameter a in focus at f spreads a point at depth z over a disk of diameter a |1 - z / f| at its depth.
/// The variance of a disk of diameter c across is c^2 / 16.
TEST_F(LensTest, BlursByTheCircleOfConfusion) {
  RenderOptions sharp = options(), lens = options();
  lens.aperture = 0.15f;
  lens.focus = 4;
  for (const float depth : {2.5f, 4.0f, 6.0f}) {
    const Spot before = spot(depth, sharp), after = spot(depth, lens);
    EXPECT_NEAR(after.x, before.x, 0.3) << depth;
    const double spread = std::sqrt(16 * std::max(after.variance - before.variance, 0.0));
    const double circle =
        double(lens.aperture) * std::abs(1 - double(depth) / 4) * pixels_per_meter(double(depth));
    EXPECT_NEAR(spread, circle, 0.1 * circle + 0.5) << depth;
    if (depth == 4) {
      EXPECT_NEAR(after.variance, before.variance, 0.05 * before.variance);
    }
  }
}

/// A ball that moves across leaves a trace as long as its way while the shutter is open, up to where it is now. The
/// variance of a uniform trace of length l is l^2 / 12.
TEST_F(LensTest, BlursMovingBallsByTheirWay) {
  World world;
  GrainsMaterial material;
  material.radius = 0.02f;
  const std::array<Vec3d, 1> place{Vec3d{0.2, 0, 0}};
  const ObjectId grains = world.add_grains(place, material);
  world.set_velocities(grains, std::array<Vec3f, 1>{Vec3f{3, 0, 0}});
  const Subject subject = subject_of(world);
  SubjectDrawing drawing;
  const auto picture = [&](double exposure) {
    MovingSubject moving(subject, exposure);
    const auto list_at = [&](float time) -> const DrawList& {
      drawing.update(moving.at(time), {});
      make_dark(drawing.list());
      return drawing.list();
    };
    return spot_in(renderer().moving_picture(list_at, camera(), options(), width, height));
  };
  const Spot still = picture(0);
  for (const double exposure : {0.05, 0.1}) {
    const Spot moved = picture(exposure);
    const double way = 3 * exposure * pixels_per_meter(4);
    EXPECT_NEAR(std::sqrt(12 * (moved.variance - still.variance)), way, 0.1 * way);
    EXPECT_NEAR(moved.x, still.x - way / 2, 0.05 * way + 0.3);
    EXPECT_NEAR(moved.sum, still.sum, 0.05 * still.sum) << "the same light";
  }
}

TEST(MovingSubjects, MoveCollidersAlongTheirMotion) {
  World world;
  ColliderOptions options;
  options.motion = ColliderMotion::keyframes({{0, {0, 0, 0}, {}}, {2, {4, 0, 0}, {}}});
  world.add_collider(Sphere{{}, 0.5f}, options);
  world.step(1);
  const Subject subject = subject_of(world);
  MovingSubject moving(subject, 0.5);
  EXPECT_NEAR(moving.at(1).colliders[0].pose.translation.x, 2, 1e-12);
  const std::uint64_t frame = moving.at(0.5f).frame;
  EXPECT_NEAR(moving.at(0).colliders[0].pose.translation.x, 1, 1e-12);
  EXPECT_NE(moving.at(0).frame, frame);
}

}  // namespace souple::render::test_render_lens
