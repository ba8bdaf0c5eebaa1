// Sunlight that liquids refract onto the floor: where it goes, and that none is lost.
#include "gl_test.h"
#include "souple/surface/splat_shapes.h"
#include "souple/threads/threads.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace souple::render::test_render_caustics {

constexpr float spacing = 0.025f, depth = 0.4f, half = 0.7f;
constexpr int width = 160, height = 120;

/// Particles below a surface at this height, in a square pool.
template <class Height>
std::vector<Vec3f> pool(Height surface) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> moved(-0.1f * spacing, 0.1f * spacing);
  std::vector<Vec3f> centers;
  const int across = int(2 * half / spacing);
  for (int i = 0; i < across; ++i)
    for (int k = 0; k < across; ++k) {
      const float x = (float(i) + 0.5f) * spacing - half, z = (float(k) + 0.5f) * spacing - half;
      // Layers down from the surface, so that it is smooth.
      for (float y = surface(x, z) - spacing / 2; y > 0; y -= spacing)
        centers.push_back({x + moved(random), y, z + moved(random)});
    }
  return centers;
}

class Caustics : public GlTest {
 protected:
  /// Sunlight on the floor with caustics over that without, in the middle of the pool, row by row.
  template <class Height>
  std::vector<std::vector<double>> ratios(Height surface) {
    const std::vector<Vec3f> centers = pool(surface);
    SplatShapes shapes(spacing);
    shapes.build(centers, *make_threads(Threading::automatic, 2));
    Liquid liquid;
    liquid.key = 1;
    liquid.version = ++version_;
    liquid.centers = shapes.centers();
    liquid.ellipsoids = shapes.axes();
    liquid.spacing = spacing;
    liquid.radius = 0.75f * spacing;
    liquid.look.absorption = {};
    DrawList list;
    list.liquids.push_back(liquid);
    // The sun alone, from above.
    list.light.to_sun = {0.1f, 1, 0.05f};
    list.light.sky = list.light.horizon = list.light.floor = {0, 0, 0, 1};
    list.ground.color = list.ground.second = srgb(0xb0b0b0);
    list.ground.tile = 100;
    const Camera camera = camera_at({0, 3, 0.01f}, {}, 14);
    RenderOptions options{.ambient_occlusion = false, .samples = 4, .exposure = 0.25f, .tone_curve = false};
    const Image without = renderer().picture(list, camera, options, width, height);
    list.light.caustics = true;
    const Image with = renderer().picture(list, camera, options, width, height);
    std::vector<std::vector<double>> result;
    for (int y = 20; y < height - 20; ++y) {
      result.emplace_back();
      for (int x = 20; x < width - 20; ++x)
        result.back().push_back(linear(with.at(x, y)[1]) / linear(without.at(x, y)[1]));
    }
    return result;
  }
  static std::vector<double> all(const std::vector<std::vector<double>>& rows) {
    std::vector<double> values;
    for (const auto& row : rows) values.insert(values.end(), row.begin(), row.end());
    return values;
  }

 private:
  std::uint64_t version_ = 0;
};

TEST_F(Caustics, StillFlatWaterLightsTheFloorEvenlyAndAsBrightly) {
  const std::vector<double> values = all(ratios([](float, float) { return depth; }));
  EXPECT_NEAR(mean(values), 1, 0.1);
  EXPECT_LT(deviation(values), 0.1);
}

/// Waves of curvature c focus light. Under a crest of small slope the floor gets 1 / (1 - c depth (n - 1) / n) of the
/// light, here 2, under a trough 0.67.
TEST_F(Caustics, WavesDrawBrightLinesAlongTheirCrests) {
  constexpr float wave = 16, amplitude = 0.02f;
  const auto rows = ratios([](float x, float) { return depth + amplitude * std::cos(wave * x); });
  std::vector<double> values = all(rows);
  EXPECT_NEAR(mean(values), 1, 0.1) << "light is moved, not made";
  std::sort(values.begin(), values.end());
  EXPECT_GT(values[values.size() * 95 / 100], 1.5);
  EXPECT_LT(values[values.size() * 15 / 100], 0.8);
  // Lines run along z, from the top of the picture to its bottom.
  std::vector<double> columns(rows[0].size());
  for (const auto& row : rows)
    for (std::size_t x = 0; x < row.size(); ++x) columns[x] += row[x] / double(rows.size());
  std::vector<double> means;
  for (const auto& row : rows) means.push_back(mean(row));
  EXPECT_GT(deviation(columns), 5 * deviation(means));
}

TEST_F(Caustics, AreNotDrawnWithoutLiquids) {
  DrawList list;
  list.light.caustics = true;
  const Image with = renderer().picture(list, {}, {}, 40, 30);
  list.light.caustics = false;
  EXPECT_EQ(renderer().picture(list, {}, {}, 40, 30), with);
}

}  // namespace souple::render::test_render_caustics
