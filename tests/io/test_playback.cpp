#include "io_test.h"
#include "recorded_world.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/fill.h"
#include "souple/io/manifest.h"
#include "souple/io/particle_file.h"
#include "souple/io/playback.h"
#include "souple/io/recorder.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace souple::test::test_io_playback {

constexpr double dt = 1.0 / 60;

class PlaybackTest : public FolderTest {
 protected:
  /// Everything, recorded for `frames` frames in FOLDER/out; returns what was shown.
  Shown record_everything(const std::vector<CacheFormat>& formats, int frames) const {
    World world = everything();
    return record(world, folder / "out", frames, {.formats = formats});
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
    const Shown shown = record_everything({format}, 12);
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
    record(world, folder / "out", 3, {.formats = {format}});
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
  const Shown shown = record(world, folder, 5, {.frames = 100});
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
      std::filesystem::remove_all(folder / "killed");
      std::filesystem::remove_all(folder / "out");
      Recorder recorder(world, folder / "out", {.formats = {format}, .frames = 100});
      const Shown shown = run(world, recorder, frames);
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
  record_everything({CacheFormat::pc2}, 9);
  World world = everything();
  Recorder recorder(world, folder / "out", {.frames = 100});
  const Shown shown = run(world, recorder, 3);
  Playback playback(folder / "out");
  EXPECT_EQ(playback.frames(), 3u);
  for (const std::uint64_t frame : {1u, 3u}) expect_shows(playback, frame, shown);
}

TEST_F(PlaybackTest, ObjectsComeAndGo) {
  World world;
  const ObjectId flag = world.add_cloth(grid(3, 3, 1), {}, {.name = "flag"});
  world.add_cloth(grid(3, 4, 1), {}, {.name = "stays"});
  Recorder recorder(world, folder);
  run(world, recorder, 2);
  world.remove(flag);
  world.add_cloth(grid(4, 4, 1), {}, {.name = "late"});
  const Shown shown = run(world, recorder, 2);
  world.add_cloth(grid(5, 5, 1), {}, {.name = "flag"});
  run(world, recorder, 1);
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
  EXPECT_EQ(playback.objects()[2].positions, shown[0][1]);
}

// Whatever formats were asked for: the number of a fluid's particles may change.
TEST_F(PlaybackTest, FluidsArePointsWithVelocities) {
  World world({.substeps = 2});
  const std::vector<Vec3d> centers{{0, 1, 0}, {0.02, 1, 0}, {0, 1.02, 0}};
  const ObjectId water = world.add_fluid(centers, {}, {.name = "water"});
  const Shown shown = record(world, folder / "out", 3, {.formats = {CacheFormat::pc2, CacheFormat::obj}});
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
    record(world, folder / "out", 3, {.formats = {CacheFormat::pc2}});
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
  expect_error([&] { playback.read(1); }, {"no frames"});
}

TEST_F(PlaybackTest, FramesThatAreNotThereAreRefused) {
  record_everything({CacheFormat::pc2}, 3);
  Playback playback(folder / "out");
  expect_error([&] { playback.read(0); }, {"frames 1 to 3"});
  expect_error([&] { playback.read(4); }, {"frames 1 to 3"});
}

TEST_F(PlaybackTest, MissingFilesAreNamed) {
  expect_error([&] { Playback(folder / "nowhere"); }, {"nowhere"});
  record_everything({CacheFormat::pc2}, 3);
  for (const char* file : {"run.json", "flag.obj", "flag.pc2", "sand.pc2"}) {
    std::filesystem::rename(folder / "out" / file, folder / "aside");
    expect_error([&] { Playback(folder / "out"); }, {file});
    std::filesystem::rename(folder / "aside", folder / "out" / file);
  }
  EXPECT_EQ(Playback(folder / "out").frames(), 3u);

  std::filesystem::remove_all(folder / "out");
  record_everything({CacheFormat::obj}, 3);
  for (const char* file : {"flag_0001.obj", "flag_0002.obj", "flag_0003.obj"}) {
    std::filesystem::rename(folder / "out" / file, folder / "aside");
    expect_error([&] { Playback(folder / "out"); }, {"flag_0001.obj"});
    std::filesystem::rename(folder / "aside", folder / "out" / file);
  }
}

TEST_F(PlaybackTest, FilesOfAnotherRunAreRefused) {
  record_everything({CacheFormat::pc2}, 3);
  const std::string cloth = get("out/flag.pc2"), mesh = get("out/flag.obj");
  put("out/flag.pc2", get("out/sand.pc2"));
  expect_error([&] { Playback(folder / "out"); }, {"3 points"});
  put("out/flag.pc2", cloth);
  put("out/flag.obj", get("out/sand.obj"));
  expect_error([&] { Playback(folder / "out"); }, {"3 vertices"});
  put("out/flag.obj", mesh);
  const std::string run = get("out/run.json");
  std::string other = run;
  other.replace(other.find("\"pc2\""), 5, "\"abc\"");
  put("out/run.json", other);
  expect_error([&] { Playback(folder / "out"); }, {"\"abc\""});
}

/// Every cut of every file is refused by its name, or harmless (a line end less).
TEST_F(PlaybackTest, CutFilesNeverCrash) {
  record_everything({CacheFormat::pc2, CacheFormat::ply}, 2);
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
        expect_words(error.what(), {std::filesystem::path(file).filename().string()});
      }
    }
    put(file, whole);
  }
}

/// A file that becomes bad while it plays gives an Error and shows nothing, and the next frame plays.
TEST_F(PlaybackTest, ABadFrameIsLeftOut) {
  const Shown shown = record_everything({CacheFormat::pc2}, 3);
  const std::string good = get("out/flag.pc2");
  std::string bytes = good;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(&bytes[32 + 12 * 30 + 12 * 7], &nan, sizeof nan);  // point 7 of the second frame
  put("out/flag.pc2", bytes);
  Playback playback(folder / "out");
  playback.read(1);
  expect_error([&] { playback.read(2); }, {"flag.pc2: frame 2: point 7"});
  EXPECT_EQ(playback.frame(), 0u);
  for (const Playback::Object& object : playback.objects()) EXPECT_TRUE(object.positions.empty());
  expect_shows(playback, 3, shown);

  record_everything({CacheFormat::obj}, 3);
  Playback sequence(folder / "out");
  sequence.read(1);
  std::filesystem::remove(folder / "out" / "sand_0002.obj");
  expect_error([&] { sequence.read(2); }, {"sand_0002.obj"});
}

class RecordedFoamTest : public FolderTest {
 protected:
  /// Water thrown at a wall.
  static World splash(float foam = 1) {
    World world({.substeps = 4});
    world.add_collider(Plane{});
    world.add_collider(Plane{{-1, 0, 0}, -0.3f});
    world.add_fluid(fill({-0.25, 0, -0.15}, {0.15, 0.2, 0.15}, 0.05), {.spacing = 0.05f, .foam = foam},
                    {.name = "water", .velocity = {4, 0, 0}});
    return world;
  }
};

TEST_F(RecordedFoamTest, IsReadBackFrameByFrame) {
  World world = splash();
  std::vector<std::vector<Vec3f>> foam;
  std::vector<std::vector<std::uint8_t>> kinds;
  {
    Recorder recorder(world, folder / "out", {.frames = 12});
    for (int frame = 0; frame < 12; ++frame) {
      world.step(dt);
      recorder.capture();
      foam.emplace_back(world.foam().positions.begin(), world.foam().positions.end());
      kinds.emplace_back();
      for (const FoamKind kind : world.foam().kinds) kinds.back().push_back(static_cast<std::uint8_t>(kind));
    }
  }
  EXPECT_GT(foam.back().size(), 20);
  EXPECT_NE(kinds.back(), std::vector<std::uint8_t>(kinds.back().size(), 0));
  EXPECT_TRUE(has("out/foam_0001.ply"));
  const RunManifest manifest = read_manifest(folder / "out");
  ASSERT_EQ(manifest.objects.size(), 2);
  EXPECT_EQ(manifest.objects[1].kind, "foam");
  EXPECT_EQ(manifest.objects[1].files, (std::vector<ManifestFile>{{"ply", "foam_0001.ply", 12}}));
  Playback playback(folder / "out");
  for (const std::uint64_t frame : {12u, 1u, 7u}) {
    playback.read(frame);
    EXPECT_EQ(playback.objects()[1].kind, "foam");
    EXPECT_EQ(playback.objects()[1].positions, foam[frame - 1]);
    EXPECT_EQ(playback.objects()[1].velocities.size(), foam[frame - 1].size());
    EXPECT_EQ(playback.objects()[1].foam_kinds, kinds[frame - 1]);
  }
}

TEST_F(RecordedFoamTest, WhereThereIsNoneNoFileIsWritten) {
  World world = splash(0);
  record(world, folder / "out", 3);
  EXPECT_EQ(read_manifest(folder / "out").objects.size(), 1);
  EXPECT_FALSE(has("out/foam_0001.ply"));
}

// Switched on in the middle of a run, its files have the run's numbers.
TEST_F(RecordedFoamTest, MayBeginLater) {
  World world = splash(0);
  {
    Recorder recorder(world, folder / "out");
    run(world, recorder, 2);
    world.set_material(world.find_object("water"), FluidMaterial{.spacing = 0.05f, .foam = 1});
    run(world, recorder, 4);
  }
  EXPECT_FALSE(has("out/foam_0002.ply"));
  EXPECT_TRUE(has("out/foam_0003.ply"));
  Playback playback(folder / "out");
  playback.read(2);
  EXPECT_TRUE(playback.objects()[1].positions.empty());
  playback.read(6);
  EXPECT_EQ(playback.objects()[1].positions.size(), world.foam().positions.size());
}

TEST_F(RecordedFoamTest, GoesOnWithAResumedRun) {
  World straight = splash(), first = splash(), second = splash();
  record(straight, folder / "a", 9, {.frames = 9});
  record(first, folder / "b", 5, {.frames = 9});
  second.restore(first.snapshot());
  record(second, folder / "b", 4, {.frames = 9, .resume_from = 5});
  for (const char* name : {"foam_0001.ply", "foam_0005.ply", "foam_0006.ply", "foam_0009.ply"})
    EXPECT_EQ(get(std::string("a/") + name), get(std::string("b/") + name)) << name;
  const RunManifest manifest = read_manifest(folder / "b");
  EXPECT_EQ(manifest.objects, read_manifest(folder / "a").objects);
}

}  // namespace souple::test::test_io_playback
