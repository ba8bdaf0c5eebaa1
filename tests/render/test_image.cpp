#include "../expect_error.h"
#include "../folder_test.h"
#include "render/color.h"
#include "render/contact_sheet.h"
#include "render/image.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::render {

namespace {

namespace fs = std::filesystem;

/// A picture like a rendered one: smooth gradients, a shaded ball, edges.
Image sample_picture(int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = (float(x) + 0.5f) / float(width), v = (float(y) + 0.5f) / float(height);
      Color color{0.5f + 0.3f * v, 0.6f + 0.2f * v, 0.9f - 0.2f * u};
      const float dx = (u - 0.5f) * float(width) / float(height), dy = v - 0.5f;
      const float inside = 0.09f - dx * dx - dy * dy;
      if (inside > 0) color = {0.8f * std::sqrt(inside) / 0.3f, 0.2f, 0.1f + u * 0.2f};
      const PackedColor packed = pack(color);
      for (int c = 0; c < 4; ++c) image.at(x, y)[c] = std::uint8_t(packed >> (8 * c));
    }
  }
  return image;
}

float luminance(const Color& c) {
  return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b;
}

}  // namespace

TEST(Color, PackedIsWhatADesignerWrote) {
  for (const std::uint32_t hex : {0x000000u, 0xffffffu, 0x123456u, 0x0a0b0cu, 0xc8c8c8u, 0xff7f01u}) {
    const PackedColor packed = pack(srgb(hex, 0.5f));
    EXPECT_EQ((packed & 0xff) << 16 | (packed & 0xff00) | (packed >> 16 & 0xff), hex);
    EXPECT_EQ(packed >> 24, 128u);
  }
  for (std::uint32_t gray = 0; gray < 256; ++gray) {
    EXPECT_EQ(pack(srgb(gray * 0x10101)) & 0xffffff, gray * 0x10101);
  }
}

TEST(Color, LinearLightFollowsTheStandard) {
  EXPECT_NEAR(srgb(0x808080).r, 0.21586, 1e-5);
  EXPECT_EQ(srgb(0xffffff), (Color{1, 1, 1, 1}));
  EXPECT_EQ(pack({2, -1, 0, 3}), 0xff0000ffu) << "clamped";
}

TEST(Color, HeatGrowsBrighterAllTheWay) {
  for (int i = 0; i < 100; ++i) {
    EXPECT_LT(luminance(heat(float(i) / 100)), luminance(heat(float(i + 1) / 100))) << i;
  }
  EXPECT_EQ(heat(-3), heat(0));
  EXPECT_EQ(heat(7), heat(1));
  EXPECT_EQ(heat(std::numeric_limits<float>::infinity()), heat(1));
  EXPECT_EQ(heat(std::nanf("")), srgb(0xff00ff));
  EXPECT_GT(heat(0).b, heat(0).r) << "blue";
  EXPECT_GT(heat(1).r, 4 * heat(1).b) << "yellow";
}

TEST(Color, PaletteRepeatsAfterEight) {
  std::set<PackedColor> seen;
  for (std::uint32_t i = 0; i < 8; ++i) seen.insert(pack(palette(i)));
  EXPECT_EQ(seen.size(), 8u);
  EXPECT_EQ(palette(3), palette(11));
}

using Png = test::FolderTest;

TEST_F(Png, ComesBackAsItWasWritten) {
  const Image image = sample_picture(123, 77);
  write_png(folder / "a.png", image);
  EXPECT_EQ(read_png(folder / "a.png"), image);
  write_png(folder / "b.png", image);
  EXPECT_EQ(get("a.png"), get("b.png"));
  EXPECT_FALSE(has("a.png.part"));
}

TEST_F(Png, OfOnePixel) {
  Image image(1, 1);
  image.pixels = {1, 2, 3, 255};
  for (const int palette : {0, 1, 256}) {
    write_png(folder / "a.png", image, palette);
    EXPECT_EQ(read_png(folder / "a.png"), image);
  }
}

TEST_F(Png, AlphaIsDropped) {
  Image image(1, 1);
  image.pixels = {10, 20, 30, 40};
  write_png(folder / "a.png", image);
  EXPECT_EQ(read_png(folder / "a.png").pixels, (std::vector<std::uint8_t>{10, 20, 30, 255}));
}

TEST_F(Png, APaletteMakesItSmallAndKeepsItsColors) {
  const Image image = sample_picture(480, 320);
  write_png(folder / "full.png", image);
  write_png(folder / "small.png", image, 128);
  write_png(folder / "again.png", image, 128);
  EXPECT_EQ(get("small.png"), get("again.png"));
  EXPECT_LT(fs::file_size(folder / "small.png"), 60'000u);
  const Image reduced = read_png(folder / "small.png");
  std::set<std::uint32_t> colors;
  for (std::size_t i = 0; i < reduced.pixels.size(); i += 4) {
    colors.insert(
        std::uint32_t(reduced.pixels[i] << 16 | reduced.pixels[i + 1] << 8 | reduced.pixels[i + 2]));
  }
  EXPECT_LE(colors.size(), 128u);
  // At low resolution the pictures are equal: dithering preserves the mean of every neighborhood.
  const Image a = downscale(image, 60, 40), b = downscale(reduced, 60, 40);
  int worst = 0;
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const int difference = a.pixels[i] - b.pixels[i];
    worst = std::max(worst, std::abs(difference));
    sum += difference;
  }
  EXPECT_LE(worst, 8);
  EXPECT_NEAR(sum / double(a.pixels.size()), 0, 0.5);
}

TEST_F(Png, FewColorsStayExact) {
  Image image(64, 64);
  const std::vector<PackedColor> colors{0xff102030, 0xffa0b0c0, 0xff00ff80};
  for (std::size_t i = 0; i < 4096; ++i) {
    for (std::size_t c = 0; c < 4; ++c) image.pixels[4 * i + c] = std::uint8_t(colors[i * i % 3] >> (8 * c));
  }
  write_png(folder / "a.png", image, 16);
  EXPECT_EQ(read_png(folder / "a.png"), image);
}

TEST_F(Png, SaysWhatIsWrong) {
  const Image image = sample_picture(8, 8);
  const fs::path nowhere = folder / "missing" / "a.png";
  expect_error([&] { write_png(nowhere, image); }, {"no folder", "missing"});
  expect_error([&] { write_png(folder / "a.png", Image{}); }, {"0 x 0"});
  expect_error([&] { write_png(folder / "a.png", image, 300); }, {"300"});
  EXPECT_TRUE(fs::is_empty(folder)) << "no partial file is left";
  expect_error([&] { read_png(folder / "none.png"); }, {"none.png"});
  put("text.png", "this is no picture");
  expect_error([&] { read_png(folder / "text.png"); }, {"not a PNG"});
}

TEST_F(Png, DamageAnywhereIsAnErrorOrAPicture) {
  write_png(folder / "a.png", sample_picture(40, 30));
  const std::string good = get("a.png");
  int errors = 0;
  for (std::size_t i = 0; i < good.size(); i += 7) {
    std::string bad = good;
    bad[i] = char(bad[i] ^ 0x55);
    if (i % 2 == 0) bad.resize(i);
    try {
      read_png(put("bad.png", bad));
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, int(good.size() / 7 / 2));
}

TEST(Downscale, MixesLightNotNumbers) {
  Image checker(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      for (int c = 0; c < 3; ++c) checker.at(x, y)[c] = (x + y) % 2 == 0 ? 255 : 0;
      checker.at(x, y)[3] = 255;
    }
  }
  const Image half = downscale(checker, 32, 32);
  for (std::size_t i = 0; i < half.pixels.size(); i += 4) ASSERT_EQ(half.pixels[i], 188);  // half the light
  EXPECT_EQ(downscale(checker, 64, 64), checker);
}

TEST(Downscale, CoversPixelsInPart) {
  // 3 to 2: each result covers one pixel and half of the middle one.
  Image image(3, 1);
  image.pixels = {255, 0, 0, 255, 0, 0, 0, 255, 0, 0, 255, 255};
  const Image two = downscale(image, 2, 1);
  EXPECT_EQ(two.at(0, 0)[0], 213);  // 2/3 of the light
  EXPECT_EQ(two.at(0, 0)[2], 0);
  EXPECT_EQ(two.at(1, 0)[0], 0);
  EXPECT_EQ(two.at(1, 0)[2], 213);
  EXPECT_THROW(downscale(image, 4, 1), Error);
  EXPECT_THROW(downscale(image, 0, 1), Error);
}

TEST(Paste, CutsOffWhatLiesOutside) {
  Image page(4, 4), stamp(2, 2);
  stamp.pixels.assign(stamp.pixels.size(), 9);
  paste(stamp, page, 3, -1);
  paste(stamp, page, -5, 0);
  paste(stamp, page, 0, 9);
  int stamped = 0;
  for (std::size_t i = 0; i < page.pixels.size(); i += 4) stamped += page.pixels[i] == 9;
  EXPECT_EQ(stamped, 1);
  EXPECT_EQ(page.at(3, 0)[0], 9);
}

TEST(ContactSheet, LaysPicturesOutRowByRow) {
  std::vector<Image> pictures;
  for (std::uint8_t i = 0; i < 5; ++i) {
    Image& picture = pictures.emplace_back(10, 6);
    picture.pixels.assign(picture.pixels.size(), i);
  }
  const Image page = contact_sheet(pictures, 3, 2);
  const int gap = (page.width - 30) / 2;
  EXPECT_GE(gap, 1);
  EXPECT_EQ(page.height, 12 + gap);
  EXPECT_EQ(page.at(0, 0)[0], 0);
  EXPECT_EQ(page.at(10 + gap, 5)[0], 1);
  EXPECT_EQ(page.at(10 + gap, 6 + gap)[0], 4);
  EXPECT_EQ(page.at(page.width - 1, page.height - 1)[0], 255) << "the unused cell";
  EXPECT_EQ(page.at(10, 0)[0], 255) << "the gap";
}

TEST(ContactSheet, RefusesWhatDoesNotFit) {
  const std::vector<Image> pictures{Image(4, 4), Image(4, 5)};
  EXPECT_THROW(contact_sheet(pictures, 2, 1), Error);
  EXPECT_THROW(contact_sheet(std::span(pictures).first(1), 0, 1), Error);
  EXPECT_THROW(contact_sheet(pictures, 1, 1), Error);
  EXPECT_THROW(contact_sheet({}, 1, 1), Error);
}

TEST(ContactSheet, ShowsFirstLastAndEvenlyBetween) {
  using Frames = std::vector<std::uint64_t>;
  EXPECT_EQ(sheet_frames(100, 1), Frames{100});
  EXPECT_EQ(sheet_frames(100, 2), (Frames{1, 100}));
  EXPECT_EQ(sheet_frames(13, 4), (Frames{1, 5, 9, 13}));
  EXPECT_EQ(sheet_frames(3, 12), (Frames{1, 2, 3}));
  EXPECT_EQ(sheet_frames(0, 12), Frames{});
  EXPECT_EQ(sheet_frames(12, 0), Frames{});
  EXPECT_EQ(sheet_frames(1, 1), Frames{1});
  for (std::uint64_t frames = 1; frames < 60; ++frames) {
    for (std::size_t cells = 2; cells < 15; ++cells) {
      const Frames chosen = sheet_frames(frames, cells);
      EXPECT_EQ(chosen.size(), std::min<std::size_t>(frames, cells));
      EXPECT_EQ(chosen.front(), 1u);
      EXPECT_EQ(chosen.back(), frames);
      for (std::size_t i = 1; i < chosen.size(); ++i) EXPECT_GT(chosen[i], chosen[i - 1]);
    }
  }
}

}  // namespace souple::render
