#include "render/film.h"
#include "tests/expect_error.h"
#include "tests/folder_test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Films are checked with ffprobe and ffmpeg, which decode them like a player. ffmpeg reads no animated WebP: webpinfo,
// webpmux and dwebp do.

namespace souple::render::test_render_film {

namespace fs = std::filesystem;

class Films : public test::FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    path_before_ = std::getenv("PATH");
  }
  void TearDown() override {
    setenv("PATH", path_before_.c_str(), 1);
    FolderTest::TearDown();
  }

  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder)) found.insert(entry.path().filename().string());
    return found;
  }

  /// Creates a program of that name, and puts it first on the PATH.
  void put_first_on_path(const std::string& name, const std::string& script) {
    fs::create_directories(folder / "bin");
    std::ofstream(folder / "bin" / name) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(folder / "bin" / name, fs::perms::owner_all);
    setenv("PATH", ((folder / "bin").string() + ":" + path_before_).c_str(), 1);
  }

  std::string path_before_;
};

#define NEEDS_FFMPEG \
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed"

#define NEEDS_WEBP                                           \
  if (std::system("webpinfo -version >/dev/null 2>&1") != 0) \
  GTEST_SKIP() << "install the Debian package "              \
                  "webp"

std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* const pipe = popen(command.c_str(), "r");
  std::array<char, 4096> piece{};
  for (std::size_t n = 0; (n = fread(piece.data(), 1, piece.size(), pipe)) > 0;) text.append(piece.data(), n);
  pclose(pipe);
  return text;
}

/// "width,height,rate,frames"
std::string probe(const fs::path& film) {
  return output_of(
      "ffprobe -v error -count_frames -select_streams v -show_entries "
      "stream=width,height,r_frame_rate,nb_read_frames -of csv=p=0 '" +
      film.string() + "'");
}

/// The pixels of all frames as a player shows them.
std::string decoded(const fs::path& film) {
  return output_of("ffmpeg -v error -i '" + film.string() + "' -f rawvideo -pix_fmt rgba pipe:1");
}

/// Four fields of one color each, which are permuted at every step.
Image fields(int width, int height, int step) {
  constexpr std::array<std::array<std::uint8_t, 3>, 4> colors{
      {{200, 30, 40}, {40, 160, 60}, {30, 60, 190}, {230, 220, 210}}};
  Image image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto field = static_cast<std::size_t>(2 * (2 * y / height) + 2 * x / width + step) % 4;
      std::uint8_t* const pixel = image.at(x, y);
      for (std::size_t i = 0; i < 3; ++i) pixel[i] = colors[field][i];
      pixel[3] = 255;
    }
  }
  return image;
}

void make_film(const fs::path& file, double rate, int frames, int width = 64, int height = 48) {
  Film film(file, rate);
  for (int i = 0; i < frames; ++i) film.add(fields(width, height, i));
  film.finish();
}

const std::uint8_t* frame_of(const std::string& pixels, std::size_t frame, std::size_t width,
                             std::size_t height) {
  return reinterpret_cast<const std::uint8_t*>(pixels.data()) + frame * 4 * width * height;
}

/// Largest difference at the centers of the four fields.
int worst_in_fields(const std::uint8_t* pixels, int width, const Image& expected) {
  int worst = 0;
  for (const int y : {expected.height / 4, 3 * expected.height / 4}) {
    for (const int x : {expected.width / 4, 3 * expected.width / 4}) {
      const std::uint8_t* const found = pixels + std::ptrdiff_t{4} * (y * width + x);
      for (int i = 0; i < 3; ++i)
        worst = std::max(worst, std::abs(int(found[i]) - int(expected.at(x, y)[i])));
    }
  }
  return worst;
}

TEST_F(Films, Mp4HasEveryPictureInItsColors) {
  NEEDS_FFMPEG;
  make_film(folder / "a.mp4", 24, 10);
  EXPECT_EQ(probe(folder / "a.mp4"), "64,48,24/1,10\n");
  EXPECT_EQ(names(), std::set<std::string>{"a.mp4"});
  const std::string pixels = decoded(folder / "a.mp4");
  ASSERT_EQ(pixels.size(), 10u * 4 * 64 * 48);
  for (int i = 0; i < 10; ++i) {
    const std::uint8_t* const frame = frame_of(pixels, static_cast<std::size_t>(i), 64, 48);
    EXPECT_LE(worst_in_fields(frame, 64, fields(64, 48, i)), 6) << "frame " << i;
  }
}

TEST_F(Films, Mp4OfOddSizesRepeatsTheEdge) {
  NEEDS_FFMPEG;
  make_film(folder / "odd.mp4", 30, 3, 63, 47);
  EXPECT_EQ(probe(folder / "odd.mp4"), "64,48,30/1,3\n");
  const std::string pixels = decoded(folder / "odd.mp4");
  ASSERT_EQ(pixels.size(), 3u * 4 * 64 * 48);
  const std::uint8_t* const corner = frame_of(pixels, 1, 64, 48) - 4;
  EXPECT_NEAR(corner[0], 230, 8);  // not black
  make_film(folder / "dot.mp4", 30, 2, 1, 1);
  EXPECT_EQ(probe(folder / "dot.mp4"), "2,2,30/1,2\n");
}

TEST_F(Films, GifShowsTheVeryColors) {
  NEEDS_FFMPEG;
  make_film(folder / "a.gif", 25, 8, 63, 47);
  EXPECT_EQ(probe(folder / "a.gif"), "63,47,25/1,8\n");
  EXPECT_EQ(names(), std::set<std::string>{"a.gif"});
  const std::string pixels = decoded(folder / "a.gif");
  ASSERT_EQ(pixels.size(), 8u * 4 * 63 * 47);
  for (int i = 0; i < 8; ++i) {
    const std::uint8_t* const frame = frame_of(pixels, static_cast<std::size_t>(i), 63, 47);
    EXPECT_LE(worst_in_fields(frame, 63, fields(63, 47, i)), 3) << "frame " << i;
  }
}

/// Output of webpinfo for a film.
struct WebpInfo {
  std::string canvas, loops;   ///< "64 x 48", "0": forever
  std::vector<int> durations;  ///< of each picture [ms]
  bool errors = false;
};

std::vector<std::string> values(const std::string& text, const std::string& key) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (const std::size_t at = line.find(key); at != std::string::npos)
      found.push_back(line.substr(at + key.size()));
  return found;
}

WebpInfo webp_info(const fs::path& film) {
  const std::string text = output_of("webpinfo '" + film.string() + "'");
  WebpInfo info;
  for (const std::string& value : values(text, "Canvas size ")) info.canvas = value;
  for (const std::string& value : values(text, "Loop count      : ")) info.loops = value;
  for (const std::string& value : values(text, "Duration: ")) info.durations.push_back(std::stoi(value));
  info.errors = text.find("No error detected") == std::string::npos;
  return info;
}

/// A frame of a .webp that covers the whole picture, such as the first.
std::string decoded_webp(const fs::path& film, int frame) {
  const fs::path one = film.string() + ".one";
  output_of("webpmux -get frame " + std::to_string(frame) + " '" + film.string() + "' -o '" + one.string() +
            "' 2>/dev/null");
  std::string pixels = output_of("dwebp -quiet -bmp '" + one.string() +
                                 "' -o - | ffmpeg -v error -i pipe:0 "
                                 "-f rawvideo -pix_fmt rgba pipe:1");
  fs::remove(one);
  return pixels;
}

TEST_F(Films, WebpHasEveryPictureAndRepeatsForever) {
  NEEDS_FFMPEG;
  NEEDS_WEBP;
  make_film(folder / "a.webp", 20, 7, 63, 47);
  const WebpInfo info = webp_info(folder / "a.webp");
  EXPECT_FALSE(info.errors);
  EXPECT_EQ(info.canvas, "63 x 47");
  EXPECT_EQ(info.loops, "0");
  EXPECT_EQ(info.durations, std::vector<int>(7, 50));
  EXPECT_EQ(names(), std::set<std::string>{"a.webp"});
  const std::string pixels = decoded_webp(folder / "a.webp", 1);
  ASSERT_EQ(pixels.size(), 4u * 63 * 47);
  EXPECT_LE(worst_in_fields(frame_of(pixels, 0, 63, 47), 63, fields(63, 47, 0)), 12);
}

TEST_F(Films, FastWebpKeepsItsSpeed) {
  NEEDS_FFMPEG;
  NEEDS_WEBP;
  make_film(folder / "a.webp", 60, 5);
  const std::vector<int> durations = webp_info(folder / "a.webp").durations;
  ASSERT_EQ(durations.size(), 5u);
  for (const int duration : durations) EXPECT_NEAR(duration, 1000.0 / 60, 1);
}

/// Stripes that move, over a pattern that no encoder predicts.
Image stripes(int step) {
  Image image(160, 120);
  std::uint32_t random = 1;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      random = random * 1664525 + 1013904223;
      std::uint8_t* const pixel = image.at(x, y);
      for (int i = 0; i < 3; ++i) {
        const int light = (x + 5 * step) / 7 % 2 == 0 ? 200 : 40 * i;
        pixel[i] = static_cast<std::uint8_t>(light + static_cast<int>(random >> (24 + i)) % 40);
      }
      pixel[3] = 255;
    }
  }
  return image;
}

TEST_F(Films, WebpFitsIntoItsBytesAtTheHighestQuality) {
  NEEDS_FFMPEG;
  const auto make = [&](const char* name, std::uint64_t bytes) {
    Film film(folder / name, 10, {}, bytes);
    for (int i = 0; i < 6; ++i) film.add(stripes(i));
    film.finish();
    return fs::file_size(folder / name);
  };
  const std::uint64_t any = make("any.webp", 0);
  std::uint64_t before = 0;
  for (const std::uint64_t bytes : {any * 7 / 10, any * 9 / 10}) {
    const std::uint64_t found = make("a.webp", bytes);
    EXPECT_LE(found, bytes);
    EXPECT_GT(found, bytes * 8 / 10) << "a higher quality would fit too";
    EXPECT_GT(found, before);
    before = found;
  }
  fs::remove(folder / "a.webp");
  expect_error([&] { make("a.webp", 500); },
               {"a.webp", "6 pictures of 160x120", "lowest quality", "500 allowed"});
  expect_error([&] { Film(folder / "a.mp4", 10, {}, 500); }, {"a.mp4", ".webp"});
  EXPECT_EQ(names(), std::set<std::string>{"any.webp"});
}

TEST_F(Films, WithoutItsEncoderAWebpIsRefusedAtOnce) {
  put_first_on_path("ffmpeg", "cat > /dev/null; echo \"Unknown encoder 'libwebp_anim'\" >&2; exit 1");
  expect_error([&] { Film(folder / "a.webp", 30); },
               {"a.webp", "no working encoder libwebp_anim", "Unknown encoder", "Debian package ffmpeg"});
  EXPECT_EQ(names(), std::set<std::string>{"bin"});
}

TEST_F(Films, TwiceTheSameBytes) {
  NEEDS_FFMPEG;
  for (const char* extension : {".mp4", ".gif", ".webp"}) {
    make_film(folder / (std::string("a") + extension), 30, 12);
    make_film(folder / (std::string("b") + extension), 30, 12);
    EXPECT_EQ(get(std::string("a") + extension), get(std::string("b") + extension)) << extension;
  }
}

TEST_F(Films, NamesAreNotReadByAnyShell) {
  NEEDS_FFMPEG;
  for (const std::string name :
       {"-y.mp4", "a:b.mp4", "a b'$(touch x)\";%03d.mp4", "CAPITALS.MP4", "%d.gif"}) {
    make_film(folder / name, 30, 2);
    EXPECT_EQ(names(), std::set<std::string>{name});
    fs::rename(folder / name, folder / "plain");
    EXPECT_NE(probe(folder / "plain").find(",2\n"), std::string::npos) << name;
    fs::remove(folder / "plain");
  }
}

TEST_F(Films, OtherNamesAndFasterFilmsAreRefused) {
  EXPECT_FALSE(is_film("film"));
  EXPECT_FALSE(is_film("mp4"));
  expect_error([&] { Film(folder / "film", 60); }, {"film", ".mp4, .gif or .webp"});
  expect_error([&] { Film(folder / "a.gif", 60); }, {"a.gif", "60", "at most 50"});
}

TEST_F(Films, SizesMayNotChange) {
  NEEDS_FFMPEG;
  Film film(folder / "a.mp4", 30);
  film.add(fields(64, 48, 0));
  expect_error([&] { film.add(fields(64, 50, 0)); }, {"64x48", "64x50"});
}

TEST_F(Films, AnUnfinishedFilmIsFinishedAndAnEmptyOneIsNot) {
  NEEDS_FFMPEG;
  {
    Film film(folder / "a.mp4", 30);
    film.add(fields(64, 48, 0));
    EXPECT_FALSE(fs::exists(folder / "a.mp4"));
  }
  EXPECT_EQ(probe(folder / "a.mp4"), "64,48,30/1,1\n");
  { Film film(folder / "b.gif", 30); }
  {
    Film film(folder / "c.mp4", 30);
    expect_error([&] { film.finish(); }, {"c.mp4"});
  }
  EXPECT_EQ(names(), std::set<std::string>{"a.mp4"});
}

TEST_F(Films, WithoutFfmpegThePackageIsNamed) {
  for (const char* path : {"/nonexistent", "", ":"}) {
    setenv("PATH", path, 1);
    EXPECT_FALSE(has_ffmpeg());
    for (const char* name : {"a.mp4", "a.webp"})
      expect_error([&] { Film(folder / name, 30); }, {"Debian package ffmpeg"});
  }
  EXPECT_TRUE(names().empty());
}

TEST_F(Films, WhatFfmpegComplainsOfIsPassedOn) {
  put_first_on_path("ffmpeg", "echo first >&2; echo Unknown encoder libx264 >&2; exit 1");
  const std::string old = "an older film";
  std::ofstream(folder / "a.mp4") << old;
  {
    Film film(folder / "a.mp4", 30);
    // The pipe may accept some pictures before the failure is detected.
    expect_error(
        [&] {
          for (int i = 0; i < 1000; ++i) film.add(fields(640, 480, i));
        },
        {"a.mp4", "ffmpeg failed", "Unknown encoder libx264"});
  }
  EXPECT_EQ(names(), (std::set<std::string>{"a.mp4", "bin"}));
  EXPECT_EQ(get("a.mp4"), old);
}

TEST_F(Films, AnFfmpegThatIsKilledIsNotSilent) {
  put_first_on_path("ffmpeg", "cat > /dev/null; kill -9 $$");
  Film film(folder / "a.mp4", 30);
  film.add(fields(64, 48, 0));
  expect_error([&] { film.finish(); }, {"signal 9"});
  EXPECT_FALSE(fs::exists(folder / "a.mp4"));
}

/// A user interrupts the program while ffmpeg neither reads nor ends: it is ended, and nothing of the film is left.
TEST_F(Films, AnFfmpegThatHangsIsEndedAfterAnInterrupt) {
  put_first_on_path("ffmpeg", "sleep 1000");
  {
    Film film(folder / "a.mp4", 30, [] { return true; });
    expect_error(
        [&] {
          for (int i = 0; i < 1000; ++i) film.add(fields(640, 480, i));
        },
        {"a.mp4", "ffmpeg failed", "did nothing"});
  }
  put_first_on_path("ffmpeg", "cat > /dev/null; sleep 1000");
  {
    bool stopped = false;
    Film film(folder / "a.gif", 30, [&] { return stopped; });
    for (int i = 0; i < 20; ++i) film.add(fields(640, 480, i));
    stopped = true;
    expect_error([&] { film.finish(); }, {"a.gif", "did nothing"});
  }
  EXPECT_EQ(names(), std::set<std::string>{"bin"});
}

/// One that is slow after an interrupt, but works, completes its film.
TEST_F(Films, AnFfmpegThatWorksIsWaitedForAfterAnInterrupt) {
  put_first_on_path(
      "ffmpeg",
      "cat > /dev/null; for i in 1 2 3 4 5 6; do sleep 0.5; : $(seq 1000); done; for f; do :; done; "
      "echo film > ${f#file:}");
  Film film(folder / "a.mp4", 30, [] { return true; });
  film.add(fields(64, 48, 0));
  film.finish();
  EXPECT_EQ(get("a.mp4"), "film\n");
}

TEST_F(Films, WhereNothingCanBeWrittenIsSaidAtOnce) {
  NEEDS_FFMPEG;
  std::ofstream(folder / "file") << "mine";
  expect_error([&] { Film(folder / "file/a.mp4", 30); }, {"file"});
  fs::create_directories(folder / "folder.mp4");
  expect_error([&] { Film(folder / "folder.mp4", 30); }, {"folder.mp4", "is a folder"});
  expect_error([&] { Film(folder / "a.mp4", 0); }, {"frame rate"});
  expect_error([&] { Film(folder / "a.mp4", std::nan("")); }, {"frame rate"});
}

}  // namespace souple::render::test_render_film
