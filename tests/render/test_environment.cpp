// Light from panoramas: the file format, and pictures of balls in surroundings of known radiance.
#include "../expect_error.h"
#include "../folder_test.h"
#include "gl_test.h"
#include "render/environment.h"
#include "render/hdr.h"
#include "render/sky.h"

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace souple::render::test_render_environment {

using Rgbe = std::array<std::uint8_t, 4>;

class HdrFile : public test::FolderTest {
 protected:
  static std::string header(int width, int height, const std::string& more = "") {
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + more + "\n-Y " + std::to_string(height) + " +X " +
           std::to_string(width) + "\n";
  }
  static std::string flat(const std::vector<Rgbe>& pixels) {
    std::string bytes;
    for (const Rgbe& pixel : pixels) bytes.append(pixel.begin(), pixel.end());
    return bytes;
  }
  /// A row with run lengths: runs where at least three bytes are equal, otherwise single bytes.
  static std::string packed(const std::vector<Rgbe>& row) {
    std::string bytes{2, 2, char(row.size() / 256), char(row.size() % 256)};
    for (std::size_t c = 0; c < 4; ++c)
      for (std::size_t x = 0; x < row.size();) {
        std::size_t end = x + 1;
        while (end < row.size() && end - x < 127 && row[end][c] == row[x][c]) ++end;
        const bool run = end - x > 2;
        bytes += char(run ? 128 + (end - x) : 1);
        bytes += char(row[x][c]);
        x = run ? end : x + 1;
      }
    return bytes;
  }
  Panorama read(const std::string& bytes) const { return read_hdr(put("a.hdr", bytes)); }
};

TEST_F(HdrFile, PixelsAreMantissasTimesAPowerOfTwo) {
  const Panorama found = read(header(2, 1) + flat({{128, 64, 0, 129}, {200, 10, 255, 0}}));
  ASSERT_EQ(found.width, 2);
  EXPECT_EQ(found.at(0, 0), (Vec3f{1, 0.5f, 0}));
  EXPECT_EQ(found.at(1, 0), Vec3f{}) << "exponent 0 is black";
  EXPECT_EQ(read(header(1, 1, "EXPOSURE=4\n") + flat({{128, 64, 0, 129}})).at(0, 0),
            (Vec3f{0.25f, 0.125f, 0}));
}

TEST_F(HdrFile, RowsWithRunLengthsEqualFlatOnes) {
  std::mt19937 random(3);
  const int width = 300, height = 5;
  std::vector<Rgbe> pixels;
  for (int i = 0; i < width * height; ++i) {
    const auto value = std::uint8_t(3 + random() % (i % 100 < 50 ? 1 : 200));
    pixels.push_back({value, std::uint8_t(value / 2), 9, std::uint8_t(120 + value % 9)});
  }
  std::string runs = header(width, height);
  for (int y = 0; y < height; ++y)
    runs += packed({pixels.begin() + y * width, pixels.begin() + (y + 1) * width});
  EXPECT_LT(runs.size(), flat(pixels).size());
  EXPECT_EQ(read(runs).radiance, read(header(width, height) + flat(pixels)).radiance);
  // An older form: (1, 1, 1, n) repeats the last pixel n times.
  EXPECT_EQ(read(header(4, 1) + flat({{128, 64, 0, 129}, {1, 1, 1, 3}})).at(3, 0), (Vec3f{1, 0.5f, 0}));
}

TEST_F(HdrFile, LargeOnesAreAveraged) {
  const int width = 4100, height = 2050;
  std::string bytes = header(width, height);
  const std::string row = packed(std::vector<Rgbe>(width, Rgbe{128, 64, 32, 129}));
  for (int y = 0; y < height; ++y) bytes += row;
  const Panorama found = read(bytes);
  EXPECT_LE(found.width, 2048);
  EXPECT_LE(found.height, 1024);
  for (const Vec3f& light : found.radiance) ASSERT_LT(length(light - Vec3f{1, 0.5f, 0.25f}), 1e-4f);
}

TEST_F(HdrFile, DamagedFilesGiveASentence) {
  const std::string good = header(8, 2) + packed(std::vector<Rgbe>(8, Rgbe{9, 8, 7, 128})) +
                           packed(std::vector<Rgbe>(8, Rgbe{1, 2, 3, 128}));
  EXPECT_NO_THROW(read(good));
  for (std::size_t length = 0; length < good.size(); ++length)
    expect_error([&] { read(good.substr(0, length)); }, {"a.hdr"});
  expect_error([&] { read(good.substr(0, good.size() - 1)); }, {"a.hdr", "incomplete"});
  expect_error([&] { read("\x89PNG\r\n\x1a\n and more"); }, {"a.hdr", "not a Radiance picture"});
  expect_error([&] { read(header(1000000, 1)); }, {"a.hdr", "16384"});
  expect_error([&] { read(header(8, 2000000000)); }, {"a.hdr", "16384"});
  expect_error([&] { read("#?RADIANCE\n\n-Y 99999999999999999999 +X 8\n"); }, {"a.hdr", "16384"});
  expect_error([&] { read("#?RADIANCE\n\n+X 8 -Y 8\n"); }, {"a.hdr", "-Y 512 +X 1024"});
  expect_error([&] { read("#?RADIANCE\n\n-Y 0 +X 8\n"); }, {"a.hdr", "-Y 512 +X 1024"});
  expect_error([&] { read("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd"); },
               {"xyze", "32-bit_rle_rgbe"});
  expect_error([&] { read("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\nabcd"); }, {"EXPOSURE", "above 0"});
  // Run lengths: of 0, beyond the row, of another row's length; a repetition before the first pixel.
  const std::string start = header(8, 1) + std::string("\x02\x02\0\x08", 4);
  expect_error([&] { read(start + std::string("\0\x01", 2)); }, {"a.hdr", "run lengths"});
  expect_error([&] { read(start + "\xff\x01"); }, {"a.hdr", "run lengths"});
  expect_error([&] { read(start + "\x09too many"); }, {"a.hdr", "run lengths"});
  expect_error([&] { read(header(8, 1) + std::string("\x02\x02\0\x09", 4)); }, {"a.hdr", "length"});
  expect_error([&] { read(header(4, 1) + "\x01\x01\x01\x03"); }, {"a.hdr", "run lengths"});
  expect_error([&] { read_hdr(folder / "missing.hdr"); }, {"missing.hdr", "opened"});
  // Any byte may be wrong: a sentence, or a picture.
  std::mt19937 random(5);
  for (int i = 0; i < 1000; ++i) {
    std::string bad = good;
    for (int k = 0; k < 3; ++k) bad[random() % bad.size()] = char(random());
    try {
      read(bad);
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("a.hdr"), std::string::npos);
    }
  }
}

constexpr int side = 120;

/// A panorama of 64 x 32 pixels, by a function of the direction.
template <class Radiance>
Panorama panorama_of(Radiance radiance) {
  Panorama result{64, 32, {}};
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x) {
      const double polar = (y + 0.5) * pi / result.height, around = (x + 0.5) * 2 * pi / result.width - pi;
      result.radiance.push_back(radiance(Vec3f(
          Vec3d{std::sin(polar) * std::sin(around), std::cos(polar), -std::sin(polar) * std::cos(around)})));
    }
  return result;
}

Panorama even(float value) {
  return panorama_of([&](const Vec3f&) { return Vec3f{value, value, value}; });
}
/// Light from the half around `axis` only.
Panorama one_sided(const Vec3f& axis) {
  return panorama_of([&](const Vec3f& direction) {
    const float value = dot(direction, axis) > 0 ? 1.0f : 0.0f;
    return Vec3f{value, value, value};
  });
}

class EnvironmentPicture : public GlTest {
 protected:
  EnvironmentPicture() {
    list_ = without_ground();
    list_.spheres.push_back(
        {.key = 1, .centers = {&center_, 1}, .radius = 1, .look = {.color = srgb(0xffffff), .roughness = 1}});
  }
  void surround(const Panorama& panorama, const EnvironmentOptions& options = {}) {
    list_.light.environment = std::make_shared<Environment>(panorama, options);
  }
  Image picture() {
    RenderOptions options = plain();
    options.tone_curve = false;
    return renderer().picture(list_, camera_at({0, 0, 6}, {}, 30), options, side, side);
  }
  /// Green light at a point of the picture; 0 is its middle, 1 the ball's outline.
  double light(float x, float y) {
    const float radius = side / 2 / (6 * std::tan(float(pi) / 12));  // nearly
    const Image image = picture();
    return linear(image.at(int(side / 2 + x * radius), int(side / 2 - y * radius))[1]);
  }

  Vec3f center_{};
  DrawList list_;
};

TEST(Environments, LightFromAllSidesIsReflectedWholeByWhite) {
  const Environment environment(even(0.7f), {.strength = 2});
  for (const Vec3f& n : {Vec3f{0, 1, 0}, Vec3f{0, -1, 0}, Vec3f{1, 0, 0}, normalized(Vec3f{-1, 1, 0.5f})})
    EXPECT_NEAR(irradiance_at(environment.irradiance(), n).y, 1.4, 0.005);
}

/// A half of the sky at radiance 1: a surface that faces it gets all of it, one at right angles half.
TEST(Environments, LightOfAHalfFallsByTheAngle) {
  const Environment environment(one_sided({1, 0, 0}), {});
  EXPECT_NEAR(irradiance_at(environment.irradiance(), {1, 0, 0}).y, 1, 0.02);
  EXPECT_NEAR(irradiance_at(environment.irradiance(), {0, 1, 0}).y, 0.5, 0.02);
  EXPECT_NEAR(irradiance_at(environment.irradiance(), {0, 0, -1}).y, 0.5, 0.02);
  EXPECT_NEAR(irradiance_at(environment.irradiance(), {-1, 0, 0}).y, 0, 0.02);
}

TEST(Environments, TurnCounterclockwiseSeenFromAbove) {
  const Environment turned(one_sided({1, 0, 0}), {.rotation = float(pi / 2)});
  EXPECT_NEAR(irradiance_at(turned.irradiance(), {0, 0, -1}).y, 1, 0.02) << "from +X to -Z";
  EXPECT_EQ(turned.radiance(normalized(Vec3f{0.1f, 0, -1})).y, 1);
  EXPECT_EQ(turned.radiance(normalized(Vec3f{0.1f, 0, 1})).y, 0);
}

/// A white, rough ball reflects all light, and 1.6 % more at its surface.
TEST_F(EnvironmentPicture, EvenLightShowsAWhiteBallEvenly) {
  surround(even(0.5f));
  for (const auto& [x, y] : {std::array{0.0f, 0.0f}, std::array{0.8f, 0.0f}, std::array{0.0f, 0.8f},
                             std::array{-0.5f, -0.5f}, std::array{0.0f, -0.8f}})
    EXPECT_NEAR(light(x, y), 0.508, 0.01) << x << ' ' << y;
  EXPECT_NEAR(light(1.3f, 0), 0.5, 0.005) << "behind the ball";
}

TEST_F(EnvironmentPicture, LightComesFromTheSideOfThePanorama) {
  surround(one_sided({1, 0, 0}));
  EXPECT_GT(light(0.8f, 0), 0.8);
  EXPECT_LT(light(-0.8f, 0), 0.2);
  surround(one_sided({1, 0, 0}), {.rotation = float(pi)});
  EXPECT_GT(light(-0.8f, 0), 0.8);
  EXPECT_LT(light(0.8f, 0), 0.2);
}

TEST_F(EnvironmentPicture, IsSeenBehindTheSceneUnlessItIsOnlyLight) {
  surround(one_sided({1, 0, 0}));
  EXPECT_NEAR(light(1.5f, 0), 1, 0.01);
  EXPECT_NEAR(light(-1.5f, 0), 0, 0.01);
  list_.light.environment = nullptr;
  const double procedural = light(-1.5f, 0);
  surround(one_sided({1, 0, 0}), {.background = false});
  EXPECT_NEAR(light(-1.5f, 0), procedural, 0.01);
  EXPECT_GT(light(0.8f, 0), 0.8) << "it lights";
}

/// A mirror ball shows the surroundings: sharply if it is smooth, blurred if it is rough.
TEST_F(EnvironmentPicture, MirrorsAreAsBlurredAsTheyAreRough) {
  surround(panorama_of([](const Vec3f& d) { return d.y > 0 ? Vec3f{1, 1, 1} : Vec3f{}; }));
  list_.spheres[0].look.metalness = 1;
  list_.spheres[0].look.roughness = 0.1f;
  EXPECT_GT(light(0, 0.2f), 0.9);
  EXPECT_LT(light(0, -0.2f), 0.1);
  list_.spheres[0].look.roughness = 0.7f;
  EXPECT_LT(light(0, 0.05f), 0.75);
  EXPECT_GT(light(0, -0.05f), 0.2);
  EXPECT_GT(light(0, 0.6f), 2 * light(0, -0.6f));
}

/// The sun of the options casts shadows; without one there are none.
TEST_F(EnvironmentPicture, TheSunIsThatOfItsOptions) {
  surround(even(0.2f));
  const double without = light(0, 0);
  surround(even(0.2f), {.sun = 2});
  EXPECT_GT(light(0, 0), without + 0.1);
}

}  // namespace souple::render::test_render_environment
