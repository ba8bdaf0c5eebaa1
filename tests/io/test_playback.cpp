#include "io_test.h"
#include "recorded_world.h"
#include "souple/geometry/builders.h"
#include "souple/io/manifest.h"
#include "souple/io/particle_file.h"
#include "souple/io/playback.h"
#include "souple/io/recorder.h"
#include "souple/world/world.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace souple::test::test_io_playback {

constexpr double dt = 1.0 / 60;

using Shown = std::vector<std::vector<std::vector<Vec3f>>>;  // by frame, object

class PlaybackTest : public FolderTest {
 protected:
  static void run(World& world, Recorder& recorder, int frames, Shown& shown) {
    for (int i = 0; i < frames; ++i) {
      world.step(dt);
      recorder.capture();
      shown.emplace_back();
      for (const ObjectId object : world.objects())
        shown.back().emplace_back(world.positions(object).begin(), world.positions(object).end());
    }
  }
  /// Everything, recorded for `frames` frames in FOLDER/out; returns what was shown.
  Shown record(const std::vector<CacheFormat>& formats, int frames) const {
    World world = everything();
    Recorder recorder(world, folder / "out", {.formats = formats});
    Shown shown;
    run(world, recorder, frames, shown);
    recorder.finish();
    return shown;
  }
  static void expect_shows(Playback& playback, std::uint64_t frame, const Shown& shown) {
    playback.read(frame);
    EXPECT_EQ(playback.frame(), frame);
    ASSERT_EQ(playback.objects().size(), shown[frame - 1].size());
    for (std::size_t o = 0; o < playback.objects().size(); ++o) {
      const std::vector<Vec3f>& x = playback.objects()[o].positions;
      ASSERT_EQ(x.size(), shown[frame - 1][o].size());
      EXPECT_EQ(std::memcmp(x.data(), shown[frame - 1][o].data(), x.size() * sizeof(Vec3f)), 0)
          << playback.objects()[o].name << " in frame " << frame;
    }
  }
};

/// OBJ text is the shortest that reads back to the same float: all formats are exact.
TEST_F(PlaybackTest, ShowsWhatTheWorldShowedInAnyOrder) {
  for (const CacheFormat format : {CacheFormat::pc2, CacheFormat::mdd, CacheFormat::obj, CacheFormat::ply}) {
    std::filesystem::remove_all(folder / "out");
    const Shown shown = record({format}, 12);
    Playback playback(folder / "out");
    EXPECT_EQ(playback.frames(), 12u);
    EXPECT_EQ(playback.frame(), 0u);
    for (const std::uint64_t frame : {12u, 1u, 7u, 7u, 2u, 11u, 3u}) expect_shows(playback, frame, shown);
  }
}

TEST_F(PlaybackTest, MeshesAndNormalsAreThoseOfTheWorld) {
  for (const CacheFormat format : {CacheFormat::pc2, CacheFormat::ply}) {
    std::filesystem::remove_all(folder / "out");
    World world = everything();
    {
      Recorder recorder(world, folder / "out", {.formats = {format}});
      Shown unused;
      run(world, recorder, 3, unused);
    }
    Playback playback(folder / "out" / "run.json");
    playback.read(3);
    const std::vector<ObjectId> objects = world.objects();
    ASSERT_EQ(playback.objects().size(), objects.size());
    for (std::size_t o = 0; o < objects.size(); ++o) {
      const Playback::Object& object = playback.objects()[o];
      EXPECT_EQ(object.name, world.name(objects[o]));
      EXPECT_EQ(object.kind, kind_name(world.kind(objects[o])));
      const auto triangles = world.triangles(objects[o]);
      EXPECT_EQ(object.triangles, std::vector<Triangle>(triangles.begin(), triangles.end()));
      EXPECT_EQ(object.rest.size(), object.positions.size());
      const auto normals = world.normals(objects[o]);
      ASSERT_EQ(object.normals.size(), normals.size());
      for (std::size_t i = 0; i < normals.size(); ++i) EXPECT_EQ(object.normals[i], normals[i]);
    }
    if (format == CacheFormat::pc2) {
      for (std::size_t i = 0; i < playback.objects()[0].rest.size(); ++i)
        EXPECT_EQ(Vec3f(playback.objects()[0].rest[i]), Vec3f(world.mesh(objects[0]).positions[i]));
    }
    EXPECT_NEAR(playback.time(3), world.time(), 1e-12);
    EXPECT_NEAR(playback.time(1), dt, 1e-12);
  }
}

/// Ctrl-C finishes the files it has.
TEST_F(PlaybackTest, AStoppedRunPlaysAsFarAsItGoes) {
  World world = everything();
  Shown shown;
  {
    Recorder recorder(world, folder, {.frames = 100});
    run(world, recorder, 5, shown);
  }
  Playback playback(folder);
  EXPECT_FALSE(playback.manifest().complete);
  EXPECT_EQ(playback.frames(), 5u);
  expect_shows(playback, 5, shown);
}

/// Killed, it leaves .part files, and a manifest that is behind them or knows of no frame at all.
TEST_F(PlaybackTest, AKilledRunPlaysAsFarAsItGoes) {
  for (const int frames : {5, 21}) {
    for (const CacheFormat format : {CacheFormat::pc2, CacheFormat::mdd}) {
      World world = everything();
      Shown shown;
      std::filesystem::remove_all(folder / "killed");
      std::filesystem::remove_all(folder / "out");
      Recorder recorder(world, folder / "out", {.formats = {format}, .frames = 100});
      run(world, recorder, frames, shown);
      std::filesystem::copy(folder / "out", folder / "killed");
      // One cache had got the next frame, and half of the one after.
      std::ofstream grown(
          folder / "killed" / (format == CacheFormat::pc2 ? "sand.pc2.part" : "sand.mdd.part"),
          std::ios::binary | std::ios::app);
      grown << std::string(50, 'x');
      grown.close();
      Playback playback(folder / "killed");
      ASSERT_EQ(playback.frames(), static_cast<std::uint64_t>(frames));
      for (const std::uint64_t frame : {5u, 1u}) expect_shows(playback, frame, shown);
      expect_shows(playback, playback.frames(), shown);
      EXPECT_NEAR(playback.time(playback.frames()), world.time(), 1e-9);
    }
  }
}

/// Leftovers of an older, longer run in the same folder are not taken for this one's.
TEST_F(PlaybackTest, AnOlderRunInTheFolderIsNotPlayed) {
  record({CacheFormat::pc2}, 9);
  World world = everything();
  Shown shown;
  Recorder recorder(world, folder / "out", {.frames = 100});
  run(world, recorder, 3, shown);
  Playback playback(folder / "out");
  EXPECT_EQ(playback.frames(), 3u);
  for (const std::uint64_t frame : {1u, 3u}) expect_shows(playback, frame, shown);
}

TEST_F(PlaybackTest, ObjectsComeAndGo) {
  World world;
  const ObjectId flag = world.add_cloth(grid(3, 3, 1), {}, {.name = "flag"});
  world.add_cloth(grid(3, 4, 1), {}, {.name = "stays"});
  Recorder recorder(world, folder);
  Shown shown;
  run(world, recorder, 2, shown);
  world.remove(flag);
  world.add_cloth(grid(4, 4, 1), {}, {.name = "late"});
  run(world, recorder, 2, shown);
  world.add_cloth(grid(5, 5, 1), {}, {.name = "flag"});
  run(world, recorder, 1, shown);
  recorder.finish();

  Playback playback(folder);
  ASSERT_EQ(playback.frames(), 5u);
  const auto count = [&](std::uint64_t frame, std::size_t object) {
    playback.read(frame);
    const Playback::Object& o = playback.objects()[object];
    EXPECT_EQ(o.normals.size(), o.positions.size());
    for (const Triangle& t : o.triangles)
      for (const std::uint32_t v : t) {
        EXPECT_LT(v, o.rest.size());
      }
    return o.positions.size();
  };
  for (const int round : {0, 1}) {  // back and forth
    EXPECT_EQ(count(2, 0), 9u) << round;
    EXPECT_EQ(playback.objects()[0].triangles.size(), 8u);
    EXPECT_EQ(count(5, 0), 25u);
    EXPECT_EQ(playback.objects()[0].triangles.size(), 32u);
    EXPECT_EQ(playback.objects()[0].rest.size(), 25u);
    EXPECT_EQ(count(3, 0), 0u);
    EXPECT_EQ(playback.objects()[0].rest.size(), 9u);
    EXPECT_EQ(count(2, 1), 12u);
    EXPECT_EQ(count(5, 1), 12u);
    EXPECT_EQ(count(2, 2), 0u);
    EXPECT_EQ(count(3, 2), 16u);
  }
  EXPECT_EQ(playback.objects()[2].positions, shown[2][1]);
}

// Whatever formats were asked for: the number of a fluid's particles may change.
TEST_F(PlaybackTest, FluidsArePointsWithVelocities) {
  World world({.substeps = 2});
  const std::vector<Vec3d> centers{{0, 1, 0}, {0.02, 1, 0}, {0, 1.02, 0}};
  const ObjectId water = world.add_fluid(centers, {}, {.name = "water"});
  Recorder recorder(world, folder / "out", {.formats = {CacheFormat::pc2, CacheFormat::obj}});
  Shown shown;
  run(world, recorder, 3, shown);
  recorder.finish();
  EXPECT_FALSE(has("out/water.pc2") || has("out/water.obj") || has("out/water_0001.obj"));
  EXPECT_TRUE(has("out/water_0003.ply"));
  Playback playback(folder / "out");
  for (const std::uint64_t frame : {3u, 1u, 2u}) expect_shows(playback, frame, shown);
  playback.read(3);
  const Playback::Object& object = playback.objects().front();
  EXPECT_EQ(object.kind, "fluid");
  ASSERT_EQ(object.velocities.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(object.velocities[i], world.velocities(water)[i]);
}

// One, two and no particles: what a fluid with a source and a drain leaves.
TEST_F(PlaybackTest, FluidsMayHaveOtherNumbersOfParticlesInEachFrame) {
  {
    World world({.substeps = 2});
    const std::vector<Vec3d> centers{{0, 1, 0}, {0.02, 1, 0}, {0, 1.02, 0}};
    world.add_fluid(centers, {}, {.name = "water"});
    Recorder recorder(world, folder / "out", {.formats = {CacheFormat::pc2}});
    Shown ignored;
    run(world, recorder, 3, ignored);
    recorder.finish();
  }
  const std::vector<Vec3f> points{{1, 2, 3}, {4, 5, 6}};
  put("out/water_0001.ply", particle_bytes(ParticleFormat::ply, std::span(points).first(1), {}));
  put("out/water_0002.ply", particle_bytes(ParticleFormat::ply, points, points));
  put("out/water_0003.ply", particle_bytes(ParticleFormat::ply, {}, {}));
  Playback playback(folder / "out");
  for (const std::uint64_t frame : {2u, 1u, 3u, 2u}) {
    playback.read(frame);
    const Playback::Object& object = playback.objects().front();
    EXPECT_EQ(object.positions.size(), frame % 3);
    EXPECT_EQ(object.velocities.size(), frame == 2 ? 2u : 0u);
  }
}

TEST_F(PlaybackTest, ARunOfNoFramesHasNone) {
  World world = everything();
  { Recorder recorder(world, folder); }
  Playback playback(folder);
  EXPECT_EQ(playback.frames(), 0u);
  EXPECT_EQ(playback.objects()[0].triangles.size(), 40u);
  expect_says(error_of([&] { playback.read(1); }), "no frames");
}

TEST_F(PlaybackTest, FramesThatAreNotThereAreRefused) {
  record({CacheFormat::pc2}, 3);
  Playback playback(folder / "out");
  expect_says(error_of([&] { playback.read(0); }), "frames 1 to 3");
  expect_says(error_of([&] { playback.read(4); }), "frames 1 to 3");
}

TEST_F(PlaybackTest, MissingFilesAreNamed) {
  expect_says(error_of([&] { Playback(folder / "nowhere"); }), "nowhere");
  record({CacheFormat::pc2}, 3);
  for (const char* file : {"run.json", "flag.obj", "flag.pc2", "sand.pc2"}) {
    std::filesystem::rename(folder / "out" / file, folder / "aside");
    expect_says(error_of([&] { Playback(folder / "out"); }), file);
    std::filesystem::rename(folder / "aside", folder / "out" / file);
  }
  EXPECT_EQ(Playback(folder / "out").frames(), 3u);

  std::filesystem::remove_all(folder / "out");
  record({CacheFormat::obj}, 3);
  for (const char* file : {"flag_0001.obj", "flag_0002.obj", "flag_0003.obj"}) {
    std::filesystem::rename(folder / "out" / file, folder / "aside");
    expect_says(error_of([&] { Playback(folder / "out"); }), "flag_0001.obj");
    std::filesystem::rename(folder / "aside", folder / "out" / file);
  }
}

TEST_F(PlaybackTest, FilesOfAnotherRunAreRefused) {
  record({CacheFormat::pc2}, 3);
  const std::string cloth = get("out/flag.pc2"), mesh = get("out/flag.obj");
  put("out/flag.pc2", get("out/sand.pc2"));
  expect_says(error_of([&] { Playback(folder / "out"); }), "3 points");
  put("out/flag.pc2", cloth);
  put("out/flag.obj", get("out/sand.obj"));
  expect_says(error_of([&] { Playback(folder / "out"); }), "3 vertices");
  put("out/flag.obj", mesh);
  const std::string run = get("out/run.json");
  std::string other = run;
  other.replace(other.find("\"pc2\""), 5, "\"abc\"");
  put("out/run.json", other);
  expect_says(error_of([&] { Playback(folder / "out"); }), "\"abc\"");
}

/// Every cut of every file is refused by its name, or harmless (a line end less).
TEST_F(PlaybackTest, CutFilesNeverCrash) {
  record({CacheFormat::pc2, CacheFormat::ply}, 2);
  for (const char* file : {"out/run.json", "out/flag.obj", "out/flag.pc2", "out/flag_0001.ply"}) {
    const std::string whole = get(file);
    for (std::size_t size = 0; size + 2 < whole.size(); size += 1 + whole.size() / 97) {
      put(file, whole.substr(0, size));
      try {
        Playback playback(folder / "out");
        playback.read(1);
        EXPECT_EQ(std::string(file), "out/flag_0001.ply")
            << size;  // the PC2 is played, the PLY not looked at
      } catch (const Error& error) {
        expect_says(error.what(), std::filesystem::path(file).filename().string());
      }
    }
    put(file, whole);
  }
}

/// A file that becomes bad while it plays gives an Error and shows nothing, and the next frame plays.
TEST_F(PlaybackTest, ABadFrameIsLeftOut) {
  const Shown shown = record({CacheFormat::pc2}, 3);
  const std::string good = get("out/flag.pc2");
  std::string bytes = good;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(&bytes[32 + 12 * 30 + 12 * 7], &nan, sizeof nan);  // point 7 of the second frame
  put("out/flag.pc2", bytes);
  Playback playback(folder / "out");
  playback.read(1);
  const std::string words = error_of([&] { playback.read(2); });
  expect_says(words, "flag.pc2: frame 2: point 7");
  EXPECT_EQ(playback.frame(), 0u);
  for (const Playback::Object& object : playback.objects()) EXPECT_TRUE(object.positions.empty());
  expect_shows(playback, 3, shown);

  record({CacheFormat::obj}, 3);
  Playback sequence(folder / "out");
  sequence.read(1);
  std::filesystem::remove(folder / "out" / "sand_0002.obj");
  expect_says(error_of([&] { sequence.read(2); }), "sand_0002.obj");
}

}  // namespace souple::test::test_io_playback
