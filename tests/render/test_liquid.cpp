// Screen-space liquids, compared with bodies of known outline, surface and thickness.
#include "gl_test.h"
#include "ray_balls.h"
#include "render/display.h"
#include "souple/surface/splat_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace souple::render::test_render_liquid {

constexpr int width = 320, height = 240;
constexpr float spacing = 0.025f;

constexpr std::array<LiquidFilter, 2> filters{LiquidFilter::curvature_flow, LiquidFilter::narrow_range};
constexpr std::array<SplatShape, 2> splats{SplatShape::spheres, SplatShape::ellipsoids};

/// Particles on a lattice, each slightly displaced, where `inside` holds.
template <class Inside>
std::vector<Vec3f> fill(const Vec3f& lo, const Vec3f& hi, Inside inside, float jitter = 0.15f) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> moved(-jitter * spacing, jitter * spacing);
  std::vector<Vec3f> centers;
  for (float x = lo.x + spacing / 2; x < hi.x; x += spacing)
    for (float y = lo.y + spacing / 2; y < hi.y; y += spacing)
      for (float z = lo.z + spacing / 2; z < hi.z; z += spacing)
        if (inside(Vec3f{x, y, z}))
          centers.push_back({x + moved(random), y + moved(random), z + moved(random)});
  return centers;
}

/// The particles' cubes have the total volume of a ball with this radius about the origin.
std::vector<Vec3f> ball_of_particles(float radius) {
  return fill({-radius, -radius, -radius}, {radius, radius, radius},
              [&](const Vec3f& x) { return length(x) < radius; });
}

/// Particles in shells below the surface of a ball, each evenly spread (a spiral of golden angles), slightly displaced.
std::vector<Vec3f> drop_of_shells(float radius) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> moved(-0.05f * spacing, 0.05f * spacing);
  std::vector<Vec3f> centers;
  for (float r = radius - spacing / 2; r > 0; r -= spacing) {
    const int count = std::max(1, int(4 * float(pi) * r * r / (spacing * spacing)));
    for (int i = 0; i < count; ++i) {
      const float y = 1 - 2 * (float(i) + 0.5f) / float(count), angle = 2.399963f * float(i),
                  across = std::sqrt(1 - y * y);
      centers.push_back(Vec3f{across * std::cos(angle), y, across * std::sin(angle)} * r +
                        Vec3f{moved(random), moved(random), moved(random)});
    }
  }
  return centers;
}

Liquid liquid_of(std::span<const Vec3f> centers) {
  static std::uint64_t version = 0;
  Liquid liquid;
  liquid.key = 1;
  liquid.version = ++version;
  liquid.centers = centers;
  liquid.spacing = spacing;
  liquid.radius = 0.75f * spacing;
  liquid.pick = 5;
  return liquid;
}

/// The particles' ellipsoids, which this object stores.
class Ellipsoids {
 public:
  explicit Ellipsoids(std::span<const Vec3f> centers) : centers_(centers), shapes_(spacing) {
    shapes_.build(centers, *make_threads(Threading::automatic, 2));
  }
  Liquid liquid(SplatShape splat) const {
    Liquid liquid = liquid_of(centers_);
    if (splat == SplatShape::spheres) return liquid;
    liquid.centers = shapes_.centers();
    liquid.ellipsoids = shapes_.axes();
    return liquid;
  }

 private:
  std::span<const Vec3f> centers_;
  SplatShapes shapes_;
};

std::string name_of(SplatShape splat, LiquidFilter filter) {
  return std::string(splat_shape_name(splat)) + ", " + std::string(liquid_filter_name(filter));
}

/// Quantile: a fraction `part` of the values does not exceed it.
double quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values.at(std::size_t(part * double(values.size() - 1)));
}

class LiquidTest : public GlTest {
 protected:
  static DrawList with(const Liquid& liquid) {
    DrawList list = without_ground();
    list.liquids.push_back(liquid);
    return list;
  }
  static RenderOptions filtered(LiquidFilter filter, int steps = 0) {
    RenderOptions options = plain();
    options.liquid_filter = filter;
    options.liquid_steps = steps;
    return options;
  }
  /// Linear light of a liquid on an even floor, which gets all sunlight.
  static Image over_floor(const Ellipsoids& ellipsoids, const Vec3f& absorption, const Camera& camera) {
    DrawList list = with(ellipsoids.liquid(SplatShape::ellipsoids));
    list.ground = Ground{.height = 0, .tile = 100};
    list.liquids[0].look.absorption = absorption;
    list.liquids[0].casts_shadow = false;
    RenderOptions options = filtered(LiquidFilter::narrow_range);
    options.tone_curve = false;
    return renderer().picture(list, camera, options, width, height);
  }
  /// Surface points in a window around the center of the picture.
  static std::vector<Vec3f> surface_points(const LiquidImage& image, const Camera& camera, int reach_x,
                                           int reach_y) {
    std::vector<Vec3f> points;
    for (int y = image.height / 2 - reach_y; y <= image.height / 2 + reach_y; ++y)
      for (int x = image.width / 2 - reach_x; x <= image.width / 2 + reach_x; ++x) {
        const Ray ray = camera.ray(float(x) + 0.5f, float(y) + 0.5f, image.width, image.height);
        const float depth = image.depth[std::size_t(y * image.width + x)];
        points.push_back(ray.origin + ray.direction * (depth / dot(ray.direction, camera.forward())));
      }
    return points;
  }
};

/// A ball of 20 spacings about the origin, compared with the exact ball.
class BallOfParticles : public LiquidTest {
 protected:
  struct Compared {
    double area = 0;                                 ///< covered area over that of the ball
    std::vector<double> thickness_errors, too_deep;  ///< relative; m
  };
  Compared compare(SplatShape splat, LiquidFilter filter) {
    image_ =
        renderer().liquid_image(with(ellipsoids_.liquid(splat)), camera_, filtered(filter), width, height);
    Compared result;
    int covered = 0, expected = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto i = std::size_t(y * width + x);
        const BallHit hit = cast(ball_, camera_, x + 0.5, y + 0.5, width, height);
        covered += image_.depth[i] > 0;
        expected += hit.ball == 0;
        const Vec3d away = hit.point;  // from the center
        if (hit.ball < 0 || away.z < 0.6 * double(radius_)) continue;
        const double chord = -2 * dot(normalized(hit.point - Vec3d(camera_.from)), away);
        result.thickness_errors.push_back(std::abs(double(image_.thickness[i]) / chord - 1));
        result.too_deep.push_back(double(image_.depth[i]) - hit.depth);
      }
    result.area = double(covered) / expected;
    return result;
  }
  /// Pixels of each row that the liquid covers, as the mean of many samples.
  std::vector<double> covered_rows(Liquid liquid, int columns, int rows) {
    liquid.look.absorption = {1e6f, 1e6f, 1e6f};
    liquid.look.refractive_index = 1;  // reflects nothing
    DrawList list = with(liquid);
    list.light.sky = list.light.horizon = list.light.floor = {0.9f, 0.9f, 0.9f};
    list.light.sun = 0;
    RenderOptions options = filtered(LiquidFilter::narrow_range);
    options.samples = 8;
    options.tone_curve = false;
    const Image image = renderer().picture(list, camera_, options, columns, rows);
    const double bright = linear(image.at(2, 2)[1]);
    std::vector<double> covered(static_cast<std::size_t>(rows));
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) covered[std::size_t(y)] += 1 - linear(image.at(x, y)[1]) / bright;
    return covered;
  }

  float radius_ = 0.5f;
  std::vector<Vec3f> centers_ = ball_of_particles(radius_);
  Ellipsoids ellipsoids_{centers_};
  Camera camera_ = camera_at({0, 0, 3}, {}, 30);
  std::array<Ball, 1> ball_{Ball{{}, double(radius_)}};
  LiquidImage image_;
};

TEST_F(BallOfParticles, HasTheOutlineAndThicknessOfTheBall) {
  std::vector<double> rough;
  for (const SplatShape splat : splats) {
    for (const LiquidFilter filter : {LiquidFilter::none, filters[0], filters[1]}) {
      const std::string where = name_of(splat, filter);
      Compared compared = compare(splat, filter);
      // The outermost centers lie on the ball, so the balls around them extend beyond it: by 3.75 % of its
      // radius.
      EXPECT_NEAR(compared.area, 1, 0.06) << where;
      const auto middle = std::size_t(height / 2 * width + width / 2);
      EXPECT_NEAR(image_.thickness[middle], 2 * radius_, 0.04f * radius_) << where;
      EXPECT_LT(quantile(compared.thickness_errors, 0.99), 0.06) << where;
      if (filter == LiquidFilter::none) rough.push_back(deviation(compared.too_deep) / double(spacing));
      if (filter == LiquidFilter::none && splat == SplatShape::spheres) continue;
      // All but a few points where the view passes deep between particles.
      for (double& error : compared.too_deep) error = std::abs(error);
      EXPECT_LT(quantile(compared.too_deep, 0.98), 0.75 * double(spacing)) << where;
    }
  }
  // Without smoothing. Ellipsoids leave the steps of a ball cut out of a lattice.
  EXPECT_GT(rough[0], 0.2) << "beads";
  EXPECT_LT(rough[1], 0.5 * rough[0]);
  EXPECT_LT(rough[1], 0.16);
}

/// x, in pixels, of the left and the right end of a row of the ellipsoids' outline, exactly. The ray through x is
/// a + b x. In the space in which an ellipsoid is the unit ball around c, it meets it between the roots of a quadratic:
/// (c . d)^2 >= |d|^2 (|c|^2 - 1).
std::array<double, 2> ends_of_row(const Liquid& liquid, const Camera& camera, double y, int columns,
                                  int rows) {
  const Vec3d forward = normalized(Vec3d(camera.to) - Vec3d(camera.from));
  const Vec3d right = normalized(cross(forward, Vec3d{0, 1, 0})), up = cross(right, forward);
  const double pixel = 2 * std::tan(double(camera.fov) * pi / 360) / rows;
  const Vec3d start = forward + up * ((0.5 * rows - y) * pixel) - right * (0.5 * columns * pixel);
  std::array<double, 2> ends{1e9, -1e9};
  for (std::size_t i = 0; i < liquid.centers.size(); ++i) {
    const Mat3d axes(liquid.ellipsoids[i]);
    if (std::abs(determinant(axes)) < 1e-12) continue;
    const Mat3d to_ball = inverse(axes);
    const Vec3d c = to_ball * (Vec3d(liquid.centers[i]) - Vec3d(camera.from));
    const Vec3d a = to_ball * start, b = to_ball * (right * pixel);
    const double outside = length_squared(c) - 1, ca = dot(c, a), cb = dot(c, b);
    const double q2 = cb * cb - outside * length_squared(b), q1 = ca * cb - outside * dot(a, b),
                 q0 = ca * ca - outside * length_squared(a), root = q1 * q1 - q2 * q0;
    if (root < 0) continue;
    const double one = (-q1 + std::sqrt(root)) / q2, other = (-q1 - std::sqrt(root)) / q2;
    ends = {std::min(ends[0], std::min(one, other)), std::max(ends[1], std::max(one, other))};
  }
  return ends;
}

/// The outline of a picture against that of the ellipsoids themselves, in every row: smoothing moves no edge.
TEST_F(BallOfParticles, HasASilhouetteWithinAPixelOfItsEllipsoids) {
  constexpr int columns = 960, rows = 720;
  const Liquid liquid = ellipsoids_.liquid(SplatShape::ellipsoids);
  for (const LiquidFilter filter : {LiquidFilter::none, LiquidFilter::narrow_range}) {
    const LiquidImage image = renderer().liquid_image(with(liquid), camera_, filtered(filter), columns, rows);
    double worst = 0, sum = 0;
    int count = 0;
    for (int y = 0; y < rows; ++y) {
      const float* row = &image.depth[std::size_t(y * columns)];
      const auto first = std::find_if(row, row + columns, [](float depth) { return depth > 0; });
      if (first == row + columns) continue;
      int last = columns - 1;
      while (row[last] == 0) --last;
      const auto [left, right] = ends_of_row(liquid, camera_, y + 0.5, columns, rows);
      // A pixel is covered where its center is; the edge is half a pixel before it on average.
      for (const double off : {double(first - row) - left, right - double(last + 1)}) {
        worst = std::max(worst, std::abs(off));
        sum += std::abs(off);
        ++count;
      }
    }
    EXPECT_GT(count, 800);
    EXPECT_LT(worst, 1) << "pixels, " << liquid_filter_name(filter);
    EXPECT_LT(sum / count, 0.3) << "pixels, " << liquid_filter_name(filter);
  }
}

/// Averages many samples: a black liquid before an even sky leaves as much light in each row as its ellipsoids leave
/// free.
TEST_F(BallOfParticles, CoversTheShareOfEachPixelThatItsEllipsoidsCover) {
  const Liquid liquid = ellipsoids_.liquid(SplatShape::ellipsoids);
  const std::vector<double> covered = covered_rows(liquid, width, height);
  double worst = 0, sum = 0;
  int count = 0;
  for (int y = 0; y < height; ++y) {
    double expected = 0;
    constexpr int lines = 16;
    for (int i = 0; i < lines; ++i) {
      const auto [left, right] = ends_of_row(liquid, camera_, y + (i + 0.5) / lines, width, height);
      expected += std::max(right - left, 0.0) / lines;
    }
    if (expected < 10) continue;  // the top and the bottom of the ball
    const double off = std::abs(covered[std::size_t(y)] - expected) / 2;
    worst = std::max(worst, off);
    sum += off;
    ++count;
  }
  EXPECT_GT(count, 100);
  EXPECT_LT(worst, 0.4) << "pixels at each end of a row";
  EXPECT_LT(sum / count, 0.1);
}

/// A drop whose particles lie in shells, as those of a drop at rest do, against the circle of its outline. A ball of
/// radius r at distance d appears as wide as r / sqrt(d^2 - r^2). Particles are 7.6 pixels apart.
TEST_F(BallOfParticles, ADropHasASilhouetteWithinAPixelOfTheCircle) {
  constexpr int columns = 640, rows = 480;
  const std::vector<Vec3f> centers = drop_of_shells(radius_);
  const Ellipsoids ellipsoids(centers);
  const std::vector<double> covered = covered_rows(ellipsoids.liquid(SplatShape::ellipsoids), columns, rows);
  const double tangent = std::tan(double(camera_.fov) * pi / 360);
  const double circle = double(radius_) / std::sqrt(9 - double(radius_ * radius_)) / tangent * rows / 2;
  double worst = 0, sum = 0;
  int count = 0;
  for (int y = 0; y < rows; ++y) {
    const double up = y + 0.5 - rows / 2.0;
    if (std::abs(up) > 0.9 * circle) continue;
    const double off = std::abs(std::hypot(covered[std::size_t(y)] / 2, up) - circle);
    worst = std::max(worst, off);
    sum += off;
    ++count;
  }
  EXPECT_GT(count, 250);
  EXPECT_LT(worst, 1) << "pixels";
  EXPECT_LT(sum / count, 0.4);
}

class FlatPool : public LiquidTest {
 protected:
  struct Seen {
    std::vector<double> heights;  ///< m
    std::vector<double> up;       ///< of the normals
  };
  /// The surface around the center of the picture.
  Seen look(const Vec3f& from, SplatShape splat, LiquidFilter filter) {
    const Camera camera = camera_at(from, {0, 0.15f, 0}, 20);
    const LiquidImage image =
        renderer().liquid_image(with(ellipsoids_.liquid(splat)), camera, filtered(filter), width, height);
    const int reach_x = 40, reach_y = 12, across = 2 * reach_x + 1;
    const std::vector<Vec3f> points = surface_points(image, camera, reach_x, reach_y);
    Seen seen;
    for (int y = 0; y + 1 < 2 * reach_y + 1; ++y)
      for (int x = 0; x + 1 < across; ++x) {
        const Vec3f& a = points[std::size_t(y * across + x)];
        const Vec3f& b = points[std::size_t(y * across + x + 1)];
        const Vec3f& c = points[std::size_t((y + 1) * across + x)];
        seen.heights.push_back(double(a.y));
        seen.up.push_back(double(std::abs(normalized(cross(b - a, c - a)).y)));
      }
    return seen;
  }

  std::vector<Vec3f> centers_ =
      fill({-0.8f, 0, -0.8f}, {0.8f, 0.15f, 0.8f}, [](const Vec3f&) { return true; });
  Ellipsoids ellipsoids_{centers_};
};

// From above, and at a grazing angle of 11 degrees.
constexpr std::array<Vec3f, 2> places{Vec3f{0, 1.4f, 1.4f}, Vec3f{0.2f, 0.45f, 1.5f}};

TEST_F(FlatPool, IsFlatWhenSmoothed) {
  for (const Vec3f& from : places)
    for (const SplatShape splat : splats) {
      const double rough = deviation(look(from, splat, LiquidFilter::none).heights);
      for (const LiquidFilter filter : filters) {
        const Seen seen = look(from, splat, filter);
        const std::string where = name_of(splat, filter) + ", from " + std::to_string(from.y);
        EXPECT_NEAR(mean(seen.heights), 0.15, 0.35 * double(spacing)) << where;
        EXPECT_LT(deviation(seen.heights), 0.1 * double(spacing)) << where;
        EXPECT_LT(deviation(seen.heights), (splat == SplatShape::spheres ? 0.6 : 1.0) * rough) << where;
        EXPECT_GT(mean(seen.up), 0.985) << where;
      }
    }
}

TEST_F(FlatPool, IsAllButFlatAsEllipsoids) {
  const double d = double(spacing);
  for (const Vec3f& from : places) {
    const Seen spheres = look(from, SplatShape::spheres, LiquidFilter::none);
    const Seen ellipsoids = look(from, SplatShape::ellipsoids, LiquidFilter::none);
    EXPECT_GT(deviation(spheres.heights), 0.05 * d) << "balls are not a plane";
    EXPECT_LT(deviation(ellipsoids.heights), 0.4 * deviation(spheres.heights));
    EXPECT_LT(deviation(ellipsoids.heights), 0.05 * d);
    EXPECT_NEAR(mean(ellipsoids.heights), 0.15, 0.15 * d) << "half a spacing above the topmost particles";
    EXPECT_GT(mean(ellipsoids.up), mean(spheres.up));
  }
}

/// Light from the floor of a pool goes up at the refracted angle: its way is depth / cos t with sin t = cos(elevation) /
/// index. At an elevation of 30 degrees this also holds close to the back of the pool, which reflects totally.
TEST_F(FlatPool, IsAsDarkAtItsBackAsInItsMiddle) {
  const float elevation = float(pi) / 6, depth = 0.15f;
  const Camera camera =
      camera_at({0, depth + 8 * std::sin(elevation), 8 * std::cos(elevation)}, {0, depth, 0}, 14);
  const auto picture = [&](const Vec3f& absorption) { return over_floor(ellipsoids_, absorption, camera); };
  const Vec3f absorption{4, 2, 1};
  const Image wet = picture(absorption), clear = picture({}), black = picture({99, 99, 99});
  const double sine = std::cos(double(elevation)) / 1.33, way = double(depth) / std::sqrt(1 - sine * sine);
  for (const float z : {0.3f, 0.0f, -0.3f, -0.5f, -0.6f, -0.66f}) {
    std::array<double, 3> left{}, all{};
    for (const float x : {-0.4f, -0.2f, 0.0f, 0.2f, 0.4f}) {
      const auto at = camera.project({x, depth, z}, width, height);
      for (std::size_t c = 0; c < 3; ++c) {
        const auto light = [&](const Image& image) { return linear(image.at(int(at->x), int(at->y))[c]); };
        left[c] += light(wet) - light(black);
        all[c] += light(clear) - light(black);
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const double of_color = c == 0 ? 4 : (c == 1 ? 2 : 1);
      EXPECT_NEAR(left[c] / all[c], std::exp(-of_color * way), 0.05) << "z " << z << ", color " << c;
    }
  }
}

/// The surface of a wavy pool does not depend on the number of pixels.
TEST_F(LiquidTest, SurfaceDoesNotDependOnTheSizeOfThePicture) {
  const auto below_waves = [](const Vec3f& x) { return x.y < 0.2f + 0.03f * std::sin(12 * x.x + 7 * x.z); };
  const std::vector<Vec3f> centers = fill({-0.8f, 0, -0.8f}, {0.8f, 0.3f, 0.8f}, below_waves);
  const Camera camera = camera_at({0.3f, 1, 1.6f}, {0, 0.2f, 0}, 22);
  for (const LiquidFilter filter : filters) {
    const DrawList list = with(liquid_of(centers));
    const LiquidImage small = renderer().liquid_image(list, camera, filtered(filter), 240, 180);
    const LiquidImage large = renderer().liquid_image(list, camera, filtered(filter), 720, 540);
    std::vector<double> differences;
    for (int y = 60; y < 120; ++y)
      for (int x = 60; x < 180; ++x) {
        const float a = small.depth[std::size_t(y * 240 + x)];
        const float b = large.depth[std::size_t((3 * y + 1) * 720 + 3 * x + 1)];
        if (a > 0 && b > 0) differences.push_back(double(a - b));
      }
    ASSERT_GT(differences.size(), 60 * 100u);
    EXPECT_LT(std::abs(quantile(differences, 0.5)), 0.05 * double(spacing)) << liquid_filter_name(filter);
    // Excludes the edges where waves hide other waves.
    for (double& difference : differences) difference = std::abs(difference);
    EXPECT_LT(quantile(differences, 0.95), 0.15 * double(spacing)) << liquid_filter_name(filter);
  }
}

/// More steps of the same flow smooth equally far.
TEST_F(LiquidTest, StepsDoNotChangeHowFarTheSurfaceIsSmoothed) {
  const auto below_waves = [](const Vec3f& x) { return x.y < 0.2f + 0.03f * std::sin(30 * x.x); };
  const std::vector<Vec3f> centers = fill({-0.8f, 0, -0.8f}, {0.8f, 0.3f, 0.8f}, below_waves);
  const Camera camera = camera_at({0, 1.6f, 1.2f}, {0, 0.2f, 0}, 22);
  std::vector<double> spread;
  for (const int steps : {20, 40, 80}) {
    const LiquidImage image = renderer().liquid_image(
        with(liquid_of(centers)), camera, filtered(LiquidFilter::curvature_flow, steps), width, height);
    std::vector<double> heights;
    for (const Vec3f& x : surface_points(image, camera, 60, 40)) heights.push_back(double(x.y));
    spread.push_back(deviation(heights));
  }
  EXPECT_NEAR(spread[1] / spread[0], 1, 0.1);
  EXPECT_NEAR(spread[2] / spread[1], 1, 0.1);
}

class LiquidAndBall : public LiquidTest {
 protected:
  LiquidAndBall() : centers_(ball_of_particles(0.5f)), camera_(camera_at({0, 0, 4}, {}, 25)) {}

  /// The color at the center of the picture with an opaque ball at this depth, in linear light.
  std::array<double, 3> middle(float z, bool wet, const Vec3f& absorption = {1.5f, 1.5f, 1.5f}) {
    position_ = {0, 0, z};
    DrawList list = without_ground();
    list.spheres.push_back({.key = 2,
                            .version = ++version_,
                            .centers = {&position_, 1},
                            .radius = 0.2f,
                            .look = {.color = srgb(0xb0b0b0)}});
    list.light.to_sun = {0, 1, 0.4f};
    if (wet) {
      Liquid liquid = liquid_of(centers_);
      liquid.look.absorption = absorption;
      list.liquids.push_back(liquid);
    }
    RenderOptions options = filtered(LiquidFilter::narrow_range);
    options.tone_curve = false;
    const Image image = renderer().picture(list, camera_, options, width, height);
    const std::uint8_t* pixel = image.at(width / 2, height / 2);
    return {linear(pixel[0]), linear(pixel[1]), linear(pixel[2])};
  }

  std::vector<Vec3f> centers_;
  Camera camera_;
  Vec3f position_{};
  std::uint64_t version_ = 0;
};

TEST_F(LiquidAndBall, WhatStandsBeforeALiquidHidesIt) {
  const auto dry = middle(0.8f, false), wet = middle(0.8f, true);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(wet[c], dry[c]);
}

/// Beer-Lambert law, with 2 % of the light reflected at the surface.
TEST_F(LiquidAndBall, WhatIsBehindOrInsideIsDimmedByTheWayInTheLiquid) {
  struct Case {
    float z, way;
  };
  for (const Case& c : {Case{-1, 1}, Case{0, 0.3f}, Case{0.1f, 0.2f}}) {
    const auto wet = middle(c.z, true), clear = middle(c.z, true, {}),
               black = middle(c.z, true, {99, 99, 99});
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT(black[k], 0.06) << c.z;
      EXPECT_NEAR((wet[k] - black[k]) / (clear[k] - black[k]), std::exp(-1.5 * double(c.way)), 0.05) << c.z;
    }
  }
}

TEST_F(LiquidAndBall, EachColorIsAbsorbedByItsOwnRate) {
  const auto clear = middle(-1, true, {}), amber = middle(-1, true, {0.1f, 0.6f, 3});
  EXPECT_NEAR(amber[0] / clear[0], std::exp(-0.1), 0.05);
  EXPECT_NEAR(amber[1] / clear[1], std::exp(-0.6), 0.06);
  EXPECT_LT(amber[2], 0.2 * clear[2]);
}

/// A wedge of liquid on the floor, seen from straight above. The floor's light goes through its depth, which grows from
/// 0 to 0.5 m. The Beer-Lambert law dims it, also where the wedge is as thin as a particle.
TEST_F(LiquidTest, AWedgeDarkensTheFloorByItsDepth) {
  constexpr float slope = 0.4f;
  const std::vector<Vec3f> centers =
      fill({0, 0, -0.6f}, {1.25f, 0.5f, 0.6f}, [&](const Vec3f& x) { return x.y < slope * x.x; });
  const Ellipsoids wedge(centers);
  const Camera camera = camera_at({0.6f, 6, 0}, {0.6f, 0, 0}, 14);
  const auto picture = [&](const Vec3f& absorption) { return over_floor(wedge, absorption, camera); };
  const Image wet = picture({3, 1.5f, 0.5f}), clear = picture({}), black = picture({99, 99, 99});
  const auto color_at = [&](const Image& image, double x) {
    Vec3d sum{};
    for (const float z : {-0.2f, -0.1f, 0.0f, 0.1f, 0.2f}) {
      const auto at = camera.project({float(x), 0, z}, width, height);
      const std::uint8_t* p = image.at(int(at->x), int(at->y));
      sum += Vec3d{linear(p[0]), linear(p[1]), linear(p[2])};
    }
    return sum;
  };
  for (const double x : {0.15, 0.3, 0.5, 0.7, 0.9, 1.05}) {
    const double depth = double(slope) * x;
    const Vec3d dark = color_at(black, x), left = color_at(wet, x) - dark, all = color_at(clear, x) - dark;
    EXPECT_NEAR(left.x / all.x, std::exp(-3 * depth), 0.025) << x;
    EXPECT_NEAR(left.y / all.y, std::exp(-1.5 * depth), 0.025) << x;
    EXPECT_NEAR(left.z / all.z, std::exp(-0.5 * depth), 0.025) << x;
  }
}

TEST_F(LiquidTest, IsPickedAsItsBallsAre) {
  const std::vector<Vec3f> centers = ball_of_particles(0.3f);
  const Camera camera = camera_at({0.4f, 0.3f, 2}, {}, 25);
  const DrawList liquids = with(liquid_of(centers));
  DrawList spheres = without_ground();
  Spheres balls;
  balls.key = 4;
  balls.centers = centers;
  balls.radius = liquids.liquids[0].radius;
  balls.pick = 5;
  spheres.spheres.push_back(balls);
  const PickImage a = renderer().pick_image(liquids, camera, width, height);
  const PickImage b = renderer().pick_image(spheres, camera, width, height);
  EXPECT_EQ(a.pick, b.pick);
  EXPECT_EQ(a.element, b.element);
  EXPECT_EQ(a.depth, b.depth);
  const Picked picked = renderer().pick(liquids, camera, width / 2, height / 2, width, height);
  EXPECT_EQ(picked.pick, 5u);
  EXPECT_LT(length(picked.point - centers[picked.element]), 1.01f * balls.radius);
}

TEST_F(LiquidTest, ThrowsALightShadowInItsColor) {
  const std::vector<Vec3f> centers = ball_of_particles(0.3f);
  Liquid liquid = liquid_of(centers);
  liquid.look.absorption = {4, 1, 0.2f};
  DrawList list;
  list.ground.height = -0.6f;
  list.ground.second = list.ground.color;
  list.light.to_sun = {0.8f, 1, 0};
  const Camera camera = camera_at({-0.4f, 2.5f, 2.5f}, {-0.4f, -0.6f, 0}, 40);
  const RenderOptions options{.ambient_occlusion = false, .tone_curve = false};
  const auto color_at = [&](const Image& image, const Vec3f& point) {
    const auto at = camera.project(point, width, height);
    const std::uint8_t* p = image.at(int(at->x), int(at->y));
    return std::array<double, 3>{linear(p[0]), linear(p[1]), linear(p[2])};
  };
  const Vec3f shadow{-0.48f, -0.6f, 0}, lit{-0.48f, -0.6f, -0.8f};
  list.liquids.push_back(liquid);
  const Image wet = renderer().picture(list, camera, options, width, height);
  DrawList solid = list;
  solid.liquids.clear();
  solid.spheres.push_back({.key = 11, .centers = centers, .radius = liquid.radius});
  const Image dry = renderer().picture(solid, camera, options, width, height);
  const auto dim = color_at(wet, shadow), bright = color_at(wet, lit), dark = color_at(dry, shadow);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_LT(dim[c], 0.93 * bright[c]) << c;
    if (c > 0) {
      EXPECT_GT(dim[c], 1.1 * dark[c]) << c;
    }
  }
  EXPECT_LT(dim[0] / bright[0], 0.8 * dim[2] / bright[2]) << "the liquid absorbs red most";
  list.liquids[0].casts_shadow = false;
  const Image none = renderer().picture(list, camera, options, width, height);
  EXPECT_NEAR(color_at(none, shadow)[0], bright[0], 0.05);
}

TEST_F(LiquidTest, EllipsoidsAreSeenAsTheyAre) {
  // From a large distance along z: the outline of an ellipsoid with half axes 0.5, 0.2 is that of the
  // ellipse.
  const std::array<Vec3f, 1> center{Vec3f{0.1f, -0.1f, 0}};
  const float turn = 0.5f, c = std::cos(turn), s = std::sin(turn);
  const std::array<Mat3f, 1> axes{Mat3f{{0.5f * c, 0.5f * s, 0}, {-0.2f * s, 0.2f * c, 0}, {0, 0, 0.3f}}};
  Liquid liquid = liquid_of(center);
  liquid.ellipsoids = axes;
  const Camera camera = camera_at({0, 0, 30}, {}, 3);
  const LiquidImage image =
      renderer().liquid_image(with(liquid), camera, filtered(LiquidFilter::none), width, height);
  int wrong = 0, inside = 0;
  float worst = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Ray ray = camera.ray(float(x) + 0.5f, float(y) + 0.5f, width, height);
      const Vec3f at = ray.origin + ray.direction * (-ray.origin.z / ray.direction.z) - center[0];
      const float u = (c * at.x + s * at.y) / 0.5f, v = (-s * at.x + c * at.y) / 0.2f;
      const float off = u * u + v * v;
      if (std::abs(off - 1) < 0.06f) continue;
      const float depth = image.depth[std::size_t(y * width + x)];
      wrong += (off < 1) != (depth > 0);
      if (off < 1) {
        ++inside;
        worst = std::max(worst, std::abs(depth - 30 + 0.3f * std::sqrt(1 - off)));
      }
    }
  EXPECT_EQ(wrong, 0);
  EXPECT_LT(worst, 0.01f) << "m";
  EXPECT_GT(inside, 2000);
}

TEST_F(LiquidTest, BallsAsEllipsoidsAreBalls) {
  const std::vector<Vec3f> centers = ball_of_particles(0.2f);
  Liquid liquid = liquid_of(centers);
  const Camera camera = camera_at({0.3f, 0.5f, 1}, {}, 60);
  const LiquidImage balls =
      renderer().liquid_image(with(liquid), camera, filtered(LiquidFilter::none), width, height);
  const std::vector<Mat3f> axes(centers.size(), Mat3f::identity() * liquid.radius);
  liquid.ellipsoids = axes;
  ++liquid.version;
  liquid.key = 77;
  const LiquidImage ellipsoids =
      renderer().liquid_image(with(liquid), camera, filtered(LiquidFilter::none), width, height);
  int differ = 0;
  for (std::size_t i = 0; i < balls.depth.size(); ++i)
    differ += std::abs(balls.depth[i] - ellipsoids.depth[i]) > 1e-3f * liquid.radius;
  EXPECT_LE(differ, 5) << "pixels on an edge";
}

TEST_F(LiquidTest, FoamIsWhiteAndHiddenByWhatIsBeforeIt) {
  const std::vector<Vec3f> bubbles =
      fill({-0.2f, -0.2f, -0.2f}, {0.2f, 0.2f, 0.2f}, [](const Vec3f&) { return true; });
  Foam foam;
  foam.key = 1;
  foam.centers = bubbles;
  foam.radius = 0.02f;
  DrawList list = without_ground();
  const Vec3f place{0, 0, -1};
  list.spheres.push_back(
      {.key = 3, .centers = {&place, 1}, .radius = 0.5f, .look = {.color = srgb(0x101010)}});
  const Camera camera = camera_at({0, 0, 3}, {}, 25);
  const auto middle = [&] {
    return linear(renderer().picture(list, camera, plain(), width, height).at(width / 2, height / 2)[1]);
  };
  const double bare = middle();
  list.foams.push_back(foam);
  EXPECT_GT(middle(), bare + 0.2);
  const Vec3f before{0, 0, 1};
  list.spheres[0].centers = {&before, 1};
  ++list.spheres[0].version;
  const double front = middle();
  list.foams.clear();
  EXPECT_EQ(front, middle());
}

TEST_F(LiquidTest, PicturesOfManySamplesAreTheSameEachTime) {
  const std::vector<Vec3f> centers = ball_of_particles(0.3f);
  DrawList list = with(liquid_of(centers));
  list.ground = Ground{.height = -0.3f};
  const Camera camera = camera_at({0.4f, 0.6f, 2}, {}, 30);
  const RenderOptions options{.samples = 4};
  const Image a = renderer().picture(list, camera, options, width / 2, height / 2);
  const Image b = renderer().picture(list, camera, options, width / 2, height / 2);
  EXPECT_EQ(a.pixels, b.pixels);
  // And equals the picture of one sample.
  const Image one = renderer().picture(list, camera, {}, width / 2, height / 2);
  double difference = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) difference += std::abs(a.pixels[i] - one.pixels[i]);
  EXPECT_LT(difference / double(a.pixels.size()), 2);
}

TEST_F(LiquidTest, BadParticlesAreNotDrawn) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Vec3f> centers = ball_of_particles(0.2f);
  const Camera camera = camera_at({0, 0, 2}, {}, 30);
  const Image good = renderer().picture(with(liquid_of(centers)), camera, plain(), width, height);
  centers.push_back({nan, 0, 0});
  centers.push_back({0, std::numeric_limits<float>::infinity(), 0});
  const Image bad = renderer().picture(with(liquid_of(centers)), camera, plain(), width, height);
  EXPECT_EQ(good.pixels, bad.pixels);
  EXPECT_NO_THROW(renderer().picture(with(liquid_of({})), camera, plain(), width, height));
}

TEST_F(LiquidTest, IsSeenFromInsideWithoutHarm) {
  const std::vector<Vec3f> centers = ball_of_particles(0.4f);
  const Camera camera = camera_at({0, 0, 0.1f}, {0, 0, -1}, 60);
  const LiquidImage image = renderer().liquid_image(with(liquid_of(centers)), camera, plain(), 80, 60);
  EXPECT_NEAR(image.thickness[std::size_t{30} * 80 + 40], 0.5f, 0.03f);
}

TEST(LiquidColors, AreThoseOfLightThatHasGoneThatFar) {
  const Vec3f absorption = absorption_of({0.5f, 1, 0, 1}, 0.2f);
  EXPECT_NEAR(std::exp(-absorption.x * 0.2f), 0.5f, 1e-5f);
  EXPECT_EQ(absorption.y, 0);
  EXPECT_TRUE(std::isfinite(absorption.z));
}

}  // namespace souple::render::test_render_liquid
