#include "io_test.h"
#include "recorded_world.h"
#include "souple/geometry/builders.h"
#include "souple/io/manifest.h"
#include "souple/io/mdd.h"
#include "souple/io/pc2.h"
#include "souple/io/recorder.h"
#include "souple/io/recorder_names.h"
#include "souple/mesh_files/mesh_file.h"
#include "souple/version.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <optional>
#include <sstream>

#include <gtest/gtest.h>

namespace souple::test::test_io_recorder {

constexpr double dt = 1.0 / 60;

class RecorderTest : public FolderTest {
 protected:
  /// All files of a folder by name; run.json without what the clock says.
  static std::vector<std::pair<std::string, std::string>> files_of(const std::filesystem::path& where) {
    std::vector<std::pair<std::string, std::string>> files;
    for (const auto& entry : std::filesystem::directory_iterator(where)) {
      std::string bytes = read_whole_file(entry.path());
      if (entry.path().filename() == "run.json") bytes.resize(bytes.find("\"timings\""));
      files.emplace_back(entry.path().filename().string(), std::move(bytes));
    }
    std::sort(files.begin(), files.end());
    return files;
  }
  static void expect_same_files(const std::filesystem::path& a, const std::filesystem::path& b) {
    const auto in_a = files_of(a), in_b = files_of(b);
    ASSERT_EQ(in_a.size(), in_b.size());
    for (std::size_t i = 0; i < in_a.size(); ++i) {
      EXPECT_EQ(in_a[i].first, in_b[i].first);
      EXPECT_TRUE(in_a[i].second == in_b[i].second) << in_a[i].first << " differs";
    }
  }
  bool has_parts() const {
    const auto all = std::filesystem::recursive_directory_iterator(folder);
    return std::any_of(begin(all), end(all),
                       [](const auto& entry) { return entry.path().extension() == ".part"; });
  }
  static const ManifestObject& object_of(const RunManifest& manifest, const std::string& name) {
    for (const auto& object : manifest.objects)
      if (object.name == name) return object;
    throw Error("no object " + name);
  }
};

const std::vector<CacheFormat> all_formats{CacheFormat::pc2, CacheFormat::mdd, CacheFormat::obj,
                                           CacheFormat::ply};

/// The caches hold what the world showed: every vertex of every frame, bit for bit, in user order.
TEST_F(RecorderTest, CachesHoldWhatTheWorldShowed) {
  World world = everything();
  const Shown shown =
      record(world, folder / "out", 7, {.formats = {CacheFormat::pc2, CacheFormat::mdd}, .frame_rate = 25});
  EXPECT_FALSE(has_parts());
  const std::vector<ObjectId> objects = world.objects();
  for (std::size_t o = 0; o < objects.size(); ++o) {
    Pc2Reader pc2(folder / "out" / (world.name(objects[o]) + ".pc2"));
    MddReader mdd(folder / "out" / (world.name(objects[o]) + ".mdd"));
    ASSERT_EQ(pc2.frames(), 7u);
    ASSERT_EQ(mdd.frames(), 7u);
    EXPECT_FLOAT_EQ(mdd.times()[6] - mdd.times()[0], 6 / 25.0f);
    ASSERT_EQ(pc2.points(), world.positions(objects[o]).size());
    std::vector<Vec3f> a(pc2.points()), b(pc2.points());
    for (std::size_t frame = 0; frame < 7; ++frame) {
      pc2.read(frame, a);
      mdd.read(frame, b);
      EXPECT_EQ(std::memcmp(a.data(), shown[frame][o].data(), a.size() * sizeof(Vec3f)), 0);
      EXPECT_EQ(std::memcmp(b.data(), shown[frame][o].data(), b.size() * sizeof(Vec3f)), 0);
    }
  }
}

/// The rest mesh has the vertices, order, faces, UVs and groups that the object was made from.
TEST_F(RecorderTest, RestMeshIsTheMeshThatWasGiven) {
  put("in.obj",
      "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 0 0 2\nv 1 0 2\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "g rim\nf 1/1 4/4 3/3 2/2\ng tail\nf 4/1 5/2 6/3\nf 4/1 6/3 3/4\n");
  const TriangleMesh given = read_triangle_mesh(folder / "in.obj");
  World world;
  world.add_cloth(given, {}, {.transform = {.translation = {0, 3, 0}}});
  { Recorder(world, folder / "out").capture(); }
  const TriangleMesh rest = read_triangle_mesh(folder / "out" / "cloth.obj");
  ASSERT_EQ(rest.positions.size(), given.positions.size());
  for (std::size_t i = 0; i < rest.positions.size(); ++i)
    EXPECT_EQ(rest.positions[i], given.positions[i] + Vec3d(0, 3, 0));
  EXPECT_EQ(rest.triangles, given.triangles);
  EXPECT_EQ(rest.faces, given.faces);
  EXPECT_EQ(rest.uvs, given.uvs);
  EXPECT_EQ(rest.face_uvs, given.face_uvs);
  EXPECT_EQ(rest.groups, given.groups);
}

/// Blender draws a rope's rest mesh as one line, and grains as points.
TEST_F(RecorderTest, RopesAreLinesAndGrainsArePoints) {
  World world = everything();
  { Recorder(world, folder / "out", {.formats = {CacheFormat::pc2, CacheFormat::ply}}).capture(); }
  const std::string rope = get("out/line.obj"), sand = get("out/sand.obj");
  // Blender 3.4 reads only the first segment of a longer line element.
  expect_words(rope, {"\nl 1 2\nl 2 3\nl 3 4\nl 4 5\nl 5 6\nl 6 7\n"});
  EXPECT_EQ(std::count(rope.begin(), rope.end(), 'v'), 7);
  EXPECT_EQ(std::count(sand.begin(), sand.end(), 'v'), 3);
  EXPECT_EQ(sand.find_first_of("fl"), std::string::npos);
  const std::string cloud = get("out/sand_0001.ply");
  expect_words(cloud, {"element vertex 3"});
  expect_words(cloud, {"property float vx"});
}

TEST_F(RecorderTest, SequencesHaveOneWholeMeshAFrame) {
  World world = everything();
  record(world, folder / "out", 3, {.formats = {CacheFormat::obj, CacheFormat::ply}});
  for (const char* file : {"out/flag_0003.obj", "out/flag_0003.ply"}) {
    const TriangleMesh mesh = read_triangle_mesh(folder / file);
    const auto now = world.positions(world.find_object("flag"));
    ASSERT_EQ(mesh.positions.size(), now.size()) << file;
    for (std::size_t i = 0; i < now.size(); ++i) EXPECT_EQ(Vec3f(mesh.positions[i]), now[i]) << file;
    EXPECT_EQ(mesh.triangles.size(), world.triangles(world.find_object("flag")).size()) << file;
  }
  EXPECT_FALSE(has("out/flag_0004.obj"));
  EXPECT_FALSE(has("out/flag.pc2"));
}

/// run.json tells what was run and which file is whose.
TEST_F(RecorderTest, ManifestTellsTheRun) {
  World world = everything();
  RecorderOptions options;
  options.frame_rate = 60;
  options.frames = 5;
  options.scene = R"({"souple": 1})";
  Recorder recorder(world, folder / "out", options);
  EXPECT_FALSE(read_manifest(folder / "out").complete);
  run(world, recorder, 5);
  recorder.finish();
  const RunManifest manifest = read_manifest(folder / "out");
  EXPECT_EQ(manifest.version, version);
  EXPECT_TRUE(manifest.complete);
  EXPECT_EQ(manifest.frames, 5u);
  expect_words(manifest.scene, {"souple"});
  expect_words(manifest.settings, {"\"substeps\":4"});
  expect_words(manifest.settings, {"\"mode\":\"small_steps\""});
  const ManifestObject& flag = object_of(manifest, "flag");
  EXPECT_EQ(flag.kind, "cloth");
  EXPECT_EQ(flag.points, 30u);
  EXPECT_EQ(flag.triangles, 40u);
  const std::vector<ManifestFile> files{{"obj", "flag.obj", 0}, {"pc2", "flag.pc2", 5}};
  EXPECT_EQ(flag.files, files);
  ASSERT_EQ(manifest.reports.size(), 5u);
  EXPECT_DOUBLE_EQ(manifest.reports[4].time, world.time());
  const NamedNumbers& values = manifest.reports[4].values;
  const auto strain =
      std::find_if(values.begin(), values.end(), [](const auto& v) { return v.first == "largest_strain"; });
  ASSERT_NE(strain, values.end());
  EXPECT_EQ(strain->second, world.report().largest_strain);
  EXPECT_EQ(manifest.reports[0].milliseconds.size(), stage_count);
}

/// A run is stopped after 4 frames by destruction (as Ctrl-C ends it) and resumed from a snapshot. The folder is, bit
/// for bit, that of the run that never stopped.
TEST_F(RecorderTest, ResumedRunEqualsUninterruptedRun) {
  World whole = everything(), first = everything();
  record(whole, folder / "a", 9, {.formats = all_formats, .frames = 9});
  {
    Recorder recorder(first, folder / "b", {.formats = all_formats, .frames = 9});
    run(first, recorder, 4);
  }
  EXPECT_FALSE(has_parts());
  EXPECT_FALSE(read_manifest(folder / "b").complete);
  EXPECT_EQ(Pc2Reader(folder / "b" / "line.pc2").frames(), 4u);

  World second = everything();
  second.restore(first.snapshot());
  Recorder recorder(second, folder / "b", {.formats = all_formats, .frames = 9, .resume_from = 4});
  EXPECT_EQ(recorder.frames(), 4u);
  run(second, recorder, 5);
  recorder.finish();
  expect_same_files(folder / "a", folder / "b");
}

/// Killed at frame 7, three frames after its checkpoint, its files still .part: the later frames are dropped.
TEST_F(RecorderTest, KilledRunIsResumedFromItsCheckpoint) {
  World whole = everything(), first = everything();
  record(whole, folder / "a", 9, {.formats = all_formats, .frames = 9});
  Snapshot snapshot;
  std::filesystem::create_directories(folder / "b");
  {
    Recorder recorder(first, folder / "c", {.formats = all_formats, .frames = 9});
    run(first, recorder, 4);
    snapshot = first.snapshot();
    recorder.save_manifest();
    run(first, recorder, 3);
    // A killed program leaves just what the disk has now.
    std::filesystem::copy(folder / "c", folder / "b", std::filesystem::copy_options::recursive);
  }
  EXPECT_TRUE(has("b/flag.pc2.part"));
  World second = everything();
  second.restore(snapshot);
  record(second, folder / "b", 5, {.formats = all_formats, .frames = 9, .resume_from = 4});
  expect_same_files(folder / "a", folder / "b");
}

TEST_F(RecorderTest, ResumeRefusesWhatDoesNotFit) {
  World world = everything();
  const RecorderOptions from_3{.resume_from = 3};
  expect_error([&] { Recorder(world, folder / "none", from_3); }, {"run.json"});
  record(world, folder / "out", 2);
  const auto before = files_of(folder / "out");
  expect_error([&] { Recorder(world, folder / "out", from_3); }, {"flag.pc2"});
  World other;
  other.add_cloth(grid(3, 3, 1), {}, {.name = "flag"});
  expect_error([&] { Recorder(other, folder / "out", {.resume_from = 1}); }, {"30 points"});
  World stranger;
  stranger.add_cloth(grid(3, 3, 1), {}, {.name = "who"});
  expect_error([&] { Recorder(stranger, folder / "out", {.resume_from = 1}); }, {"\"who\""});
  EXPECT_EQ(files_of(folder / "out"), before);
}

/// An object that comes later cannot be in a PC2, which begins at frame 1. It is an OBJ sequence with the run's
/// numbers.
TEST_F(RecorderTest, ObjectsThatComeAndGo) {
  World world;
  const ObjectId flag = world.add_cloth(grid(3, 3, 1), {}, {.name = "flag"});
  world.add_cloth(grid(3, 3, 1), {}, {.name = "stays"});
  put("late_0001.obj", "of an earlier run");
  Recorder recorder(world, folder);
  run(world, recorder, 2);
  world.remove(flag);
  world.add_cloth(grid(4, 4, 1), {}, {.name = "late"});
  run(world, recorder, 2);
  world.add_cloth(grid(5, 5, 1), {}, {.name = "flag"});
  run(world, recorder, 1);
  recorder.finish();

  EXPECT_EQ(Pc2Reader(folder / "flag.pc2").frames(), 2u);
  EXPECT_EQ(Pc2Reader(folder / "stays.pc2").frames(), 5u);
  EXPECT_FALSE(has("late.pc2"));
  EXPECT_FALSE(has("late_0001.obj"));
  EXPECT_FALSE(has("late_0002.obj"));
  EXPECT_EQ(read_triangle_mesh(folder / "late_0003.obj").positions.size(), 16u);
  EXPECT_EQ(read_triangle_mesh(folder / "flag_0005.obj").positions.size(), 25u);
  EXPECT_FALSE(has("flag_0004.obj"));
  ASSERT_EQ(recorder.notes().size(), 3u);
  expect_words(recorder.notes()[0], {"late_0003.obj"});
  expect_words(recorder.notes()[1], {"flag: was removed after frame 2"});
  expect_words(recorder.notes()[2], {"flag_0005.obj"});
  const RunManifest manifest = read_manifest(folder);
  EXPECT_EQ(manifest.notes, recorder.notes());
  const std::vector<ManifestFile> late{{"obj", "late_0003.obj", 3}};
  EXPECT_EQ(object_of(manifest, "late").files, late);
  const std::vector<ManifestFile> both{
      {"obj", "flag.obj", 0}, {"pc2", "flag.pc2", 2}, {"obj", "flag_0005.obj", 1}};
  EXPECT_EQ(object_of(manifest, "flag").files, both);
}

/// Removed and put back as it was between two frames: the caches simply go on.
TEST_F(RecorderTest, TheSameObjectAgainGoesOn) {
  World world;
  ObjectId flag = world.add_cloth(grid(3, 3, 1), {}, {.name = "flag"});
  Recorder recorder(world, folder);
  run(world, recorder, 2);
  world.remove(flag);
  flag = world.add_cloth(grid(3, 3, 1), {}, {.name = "flag"});
  run(world, recorder, 2);
  recorder.finish();
  EXPECT_EQ(Pc2Reader(folder / "flag.pc2").frames(), 4u);
  EXPECT_TRUE(recorder.notes().empty());
}

TEST_F(RecorderTest, HostileNamesStayInTheFolder) {
  World world;
  world.add_cloth(grid(3, 3, 1), {}, {.name = "../escape"});
  world.add_cloth(grid(3, 3, 1), {}, {.name = "a/b"});
  world.add_cloth(grid(3, 3, 1), {}, {.name = "a_b"});
  { Recorder(world, folder / "out").capture(); }
  EXPECT_EQ(count(), 0);
  EXPECT_TRUE(has("out/_._escape.pc2"));
  EXPECT_TRUE(has("out/a_b.pc2"));
  EXPECT_TRUE(has("out/a_b-2.pc2"));
  EXPECT_EQ(object_of(read_manifest(folder / "out"), "a/b").files[1].path, "a_b.pc2");
}

TEST_F(RecorderTest, FolderThatCannotBe) {
  const World world = everything();
  put("file", "mine");
  expect_error([&] { Recorder(world, folder / "file"); }, {"file"});
  expect_error([&] { Recorder(world, folder / "file" / "below"); }, {"below"});
  EXPECT_EQ(get("file"), "mine");
  // Not even root can write there.
  expect_error([&] { Recorder(world, "/proc/souple"); }, {"/proc/souple"});
  expect_error([&] { Recorder(world, folder / "out", {.formats = {}}); }, {"format"});
  expect_error([&] { Recorder(world, folder / "out", {.frame_rate = 0}); }, {"frame rate"});
  EXPECT_FALSE(has("out"));
}

/// A new run replaces an old one in its folder, also the tail of its longer sequences.
TEST_F(RecorderTest, NewRunReplacesAnOldOne) {
  const RecorderOptions options{.formats = {CacheFormat::pc2, CacheFormat::obj}};
  World world = everything();
  record(world, folder / "out", 5, options);
  World again = everything();
  {
    Recorder recorder(again, folder / "out", options);
    EXPECT_EQ(Pc2Reader(folder / "out" / "flag.pc2").frames(), 5u)
        << "the old one stays until the new is whole";
    run(again, recorder, 3);
  }
  EXPECT_EQ(Pc2Reader(folder / "out" / "flag.pc2").frames(), 3u);
  EXPECT_TRUE(has("out/flag_0003.obj"));
  EXPECT_FALSE(has("out/flag_0004.obj"));
}

/// The files of the last run that its manifest lists go, and no others. The user's notes stay, and a mesh whose name
/// looks like a frame beyond the last.
TEST_F(RecorderTest, NewRunRemovesTheFilesOfTheLast) {
  World world = everything();
  record(world, folder / "out", 5, {.formats = all_formats});
  put("out/notes.txt", "mine");
  put("out/flag_0006.obj", "mine");
  put("out/flag_best.obj", "mine");
  World again({.substeps = 4});
  again.add_cloth(grid(6, 5, 1), {}, {.name = "flag"});
  record(again, folder / "out", 2, {.formats = {CacheFormat::pc2}});
  std::vector<std::string> names;
  for (const auto& [name, bytes] : files_of(folder / "out")) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"flag.obj", "flag.pc2", "flag_0006.obj", "flag_best.obj",
                                             "notes.txt", "run.json"}));
}

/// A folder without a manifest, or with another program's run.json, keeps all its files.
TEST_F(RecorderTest, NewRunLeavesAFolderThatItDoesNotKnow) {
  std::filesystem::create_directory(folder / "out");
  put("out/run.json", "{\"mine\": true}");
  put("out/sand.pc2", "mine");
  put("out/flag_0001.obj", "mine");
  World world({.substeps = 4});
  world.add_cloth(grid(6, 5, 1), {}, {.name = "flag"});
  record(world, folder / "out", 2, {.formats = {CacheFormat::pc2}});
  EXPECT_EQ(get("out/sand.pc2"), "mine");
  EXPECT_EQ(get("out/flag_0001.obj"), "mine");
}

/// Importers drop vertices without a face, and refuse a cache that has them: a tet mesh is written as its surface.
TEST_F(RecorderTest, TetMeshIsWrittenAsItsSurface) {
  World world({.substeps = 4});
  TetMesh bar = tet_bar(3, 3, 3, {0.3, 0.3, 0.3});
  bar.groups["corner"] = {0, 21};  // on the surface, and inside
  const ObjectId block = world.add_soft_body(bar, {}, {.name = "block"});
  std::vector<bool> on_surface(64, false);
  for (const Triangle& t : world.triangles(block))
    for (const std::uint32_t v : t) on_surface[v] = true;
  record(world, folder / "out", 2, {.formats = all_formats});
  std::vector<Vec3f> expected;
  for (std::uint32_t v = 0; v < 64; ++v)
    if (on_surface[v]) expected.push_back(world.positions(block)[v]);
  ASSERT_EQ(expected.size(), 56u);
  std::vector<Vec3f> found(56);
  Pc2Reader pc2(folder / "out" / "block.pc2");
  ASSERT_EQ(pc2.points(), 56u);
  pc2.read(1, found);
  EXPECT_EQ(found, expected);
  MddReader mdd(folder / "out" / "block.mdd");
  ASSERT_EQ(mdd.points(), 56u);
  mdd.read(1, found);
  EXPECT_EQ(found, expected);
  const TriangleMesh rest = read_triangle_mesh(folder / "out" / "block.obj");
  EXPECT_EQ(rest.positions.size(), 56u);
  EXPECT_EQ(rest.triangles.size(), world.triangles(block).size());
  EXPECT_EQ(rest.groups.at("corner"), std::vector<std::uint32_t>{0});
  for (const char* name : {"block_0002.obj", "block_0002.ply"}) {
    const TriangleMesh frame = read_triangle_mesh(folder / "out" / name);
    EXPECT_EQ(frame.triangles, rest.triangles) << name;
    ASSERT_EQ(frame.positions.size(), 56u) << name;
    for (std::size_t v = 0; v < 56; ++v) EXPECT_EQ(Vec3f(frame.positions[v]), expected[v]) << name;
  }
  EXPECT_EQ(object_of(read_manifest(folder / "out"), "block").points, 56u);
}

/// A resumed run of a tet mesh has the bytes of an uninterrupted one.
TEST_F(RecorderTest, TetMeshGoesOn) {
  const auto block = [] {
    World world({.substeps = 4});
    world.add_soft_body(tet_bar(3, 3, 3, {0.3, 0.3, 0.3}), {}, {.name = "block", .velocity = {1, 0, 0}});
    return world;
  };
  World whole = block();
  record(whole, folder / "whole", 6, {.formats = all_formats, .frames = 6});
  World first = block();
  record(first, folder / "out", 4, {.formats = all_formats, .frames = 6});
  World second = block();
  for (int i = 0; i < 3; ++i) second.step(dt);
  record(second, folder / "out", 3, {.formats = all_formats, .frames = 6, .resume_from = 3});
  expect_same_files(folder / "out", folder / "whole");
}

TEST_F(RecorderTest, AFolderHasOneRecorderAtATime) {
  World world({.substeps = 2});
  world.add_cloth(grid(4, 4, 1), {}, {.name = "sheet"});
  Recorder first(world, folder / "out", {.frames = 2});
  expect_error([&] { const Recorder second(world, folder / "out"); }, {"another souple is writing there"});
  for (int i = 0; i < 2; ++i) {
    world.step(1.0 / 60);
    first.capture();
  }
  first.finish();
  EXPECT_EQ(std::filesystem::file_size(folder / "out" / "sheet.pc2"), 32u + 2 * 16 * 12);
  { const Recorder second(world, folder / "out"); }
  const Recorder third(world, folder / "out");
}

/// Blender drops vertices without a face, and then refuses the cache: the run says so.
TEST_F(RecorderTest, NotesVerticesWithoutAFace) {
  World world({.substeps = 4});
  TriangleMesh sheet = grid(4, 4, 1);
  sheet.positions.push_back({0, 3, 0});
  world.add_cloth(sheet, {}, {.name = "sheet"});
  world.add_cloth(grid(4, 4, 1), {}, {.name = "whole", .transform = {.translation = {3, 0, 0}}});
  const Recorder recorder(world, folder / "out");
  ASSERT_EQ(recorder.notes().size(), 1u);
  expect_words(recorder.notes()[0], {"sheet: 1 of its vertices belong to no face; Blender drops them"});
}

/// Normals of a mesh turn with its transform; frames have none.
TEST_F(RecorderTest, KeepsTheAppearanceOfAMesh) {
  TriangleMesh sheet = grid(2, 2, 1);
  sheet.appearance.materials = {"red"};
  sheet.appearance.face_materials = {0, FaceAppearance::no_material};
  sheet.appearance.smoothing = {1, 1};
  sheet.appearance.normals = {{0, 1, 0}};
  sheet.appearance.face_normals = {{0, 0, 0}, {}};
  sheet.appearance.material_files = {(folder / "sheet.mtl").string()};
  World world({.substeps = 4});
  constexpr double quarter = 1.5707963267948966;
  world.add_cloth(sheet, {},
                  {.name = "sheet", .transform = {.rotation = Quatd::from_euler_xyz({quarter, 0, 0})}});
  { Recorder(world, folder / "out", {.formats = {CacheFormat::pc2, CacheFormat::obj}}).capture(); }
  expect_words(get("out/sheet.obj"), {"mtllib ../sheet.mtl\n"});
  FaceAppearance rest = read_triangle_mesh(folder / "out" / "sheet.obj").appearance;
  ASSERT_EQ(rest.normals.size(), 1u);
  EXPECT_LT(length(rest.normals[0] - Vec3f{0, 0, 1}), 1e-6f);
  EXPECT_EQ(rest.face_normals, sheet.appearance.face_normals);
  FaceAppearance frame = read_triangle_mesh(folder / "out" / "sheet_0001.obj").appearance;
  EXPECT_TRUE(frame.normals.empty());
  EXPECT_EQ(rest.material_files, sheet.appearance.material_files);
  EXPECT_EQ(frame.material_files, sheet.appearance.material_files);
  for (const FaceAppearance& found : {rest, frame}) {
    EXPECT_EQ(found.materials, sheet.appearance.materials);
    EXPECT_EQ(found.face_materials, sheet.appearance.face_materials);
    EXPECT_EQ(found.smoothing, sheet.appearance.smoothing);
  }
}

/// A run without a frame leaves no empty cache, which Blender would refuse.
TEST_F(RecorderTest, NoFrameNoCache) {
  const World world = everything();
  { const Recorder recorder(world, folder / "out", {.formats = all_formats}); }
  EXPECT_FALSE(has_parts());
  EXPECT_FALSE(has("out/flag.pc2"));
  EXPECT_FALSE(has("out/flag.mdd"));
  const std::vector<ManifestFile> rest{{"obj", "flag.obj", 0}};
  EXPECT_EQ(object_of(read_manifest(folder / "out"), "flag").files, rest);
}

/// The disk fills up in the middle of a frame. That frame is in no file, and once there is room the run goes on.
TEST_F(RecorderTest, FullDiskLeavesTheFrameBefore) {
  World world;
  world.add_cloth(grid(4, 4, 1), {}, {.name = "small"});
  world.add_cloth(grid(40, 40, 1), {}, {.name = "large"});
  std::optional<Recorder> recorder;
  recorder.emplace(world, folder, RecorderOptions{.formats = {CacheFormat::pc2, CacheFormat::mdd}});
  run(world, *recorder, 2);
  world.step(dt);
  {
    const FileSizeLimit limit(32 + 2 * 1600 * 12 + 100);
    expect_error([&] { recorder->capture(); }, {"large"});
  }
  EXPECT_EQ(recorder->frames(), 2u);
  recorder->capture();
  recorder->finish();
  for (const char* name : {"small", "large"}) {
    Pc2Reader pc2(folder / (std::string(name) + ".pc2"));
    ASSERT_EQ(pc2.frames(), 3u);
    EXPECT_EQ(MddReader(folder / (std::string(name) + ".mdd")).frames(), 3u);
    std::vector<Vec3f> last(pc2.points());
    pc2.read(2, last);
    const auto now = world.positions(world.find_object(name));
    EXPECT_EQ(std::memcmp(last.data(), now.data(), now.size_bytes()), 0);
  }
}

TEST_F(RecorderTest, NothingIsCapturedAfterTheEnd) {
  World world = everything();
  Recorder recorder(world, folder);
  run(world, recorder, 1);
  recorder.finish();
  recorder.finish();
  expect_error([&] { recorder.capture(); }, {"finished"});
}

TEST(RecorderNames, NoNameLeadsOutOfTheFolder) {
  const std::string control("a\nb\0c\x7f", 6);
  for (const std::string& name : {std::string("../../etc/passwd"), std::string(".."), std::string("."),
                                  std::string("/root"), std::string("a\\b"), std::string("c:"), std::string(),
                                  std::string("..\\.."), control, std::string("~/x")}) {
    const std::string safe = safe_file_name(name);
    EXPECT_FALSE(safe.empty()) << name;
    EXPECT_EQ(std::filesystem::path(safe).filename(), safe) << name;
    EXPECT_NE(safe.front(), '.') << name;
    for (const char c : safe) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) << name;
  }
  EXPECT_EQ(safe_file_name("flag"), "flag");
  EXPECT_EQ(safe_file_name("été"), "été");
}

/// A very long name is cut between two characters, never inside one.
TEST(RecorderNames, LongNamesAreCut) {
  std::string longest = "x";
  for (int i = 0; i < 200; ++i) longest += "é";
  const std::string safe = safe_file_name(longest);
  EXPECT_EQ(safe.size(), 99u);
  EXPECT_EQ(longest.compare(0, safe.size(), safe), 0);
}

TEST(RecorderNames, NamesThatBecomeTheSameDiffer) {
  FileNames names;
  EXPECT_EQ(names.add("a/b"), "a_b");
  EXPECT_EQ(names.add("a_b"), "a_b-2");
  EXPECT_EQ(names.add("A_B"), "A_B-3");
  EXPECT_EQ(names.add("a_b-2"), "a_b-2-2");
}

/// The rest mesh of "ball_0007" would be a frame of the sequence "ball".
TEST(RecorderNames, NoNameLooksLikeAFrame) {
  EXPECT_EQ(safe_file_name("ball_0007"), "ball_0007_");
  EXPECT_EQ(safe_file_name("ball_07"), "ball_07");
}

}  // namespace souple::test::test_io_recorder
