// Effects of scene keys: maps, sequences, tethers, gas, springs, pairs.
#include "scene_test.h"
#include "souple/io/mdd.h"
#include "souple/io/pc2.h"
#include "souple/world/world.h"
#include "tests/expect_error.h"
#include "tests/folder_test.h"

#include <algorithm>
#include <cmath>

namespace souple::scene_test::test_scene_behavior {

namespace fs = std::filesystem;

constexpr double g = 9.81;

class Behavior : public test::FolderTest {
 protected:
  World built(const std::string& text) const { return build_world(parse_scene(text, folder, "test.json")); }
  fs::path file(const std::string& name) const { return folder / name; }
};

constexpr int strip_rows = 17;
constexpr int first_lower_row = 9;  ///< rows 0 to 8 are the upper half: in the group, and red

/// A strip two vertices wide, from y = 0 down to -1, with rows 1/16 apart. Its upper half is a group and red;
/// all of it is half green.
void write_strip(const fs::path& path, double shift = 0) {
  std::ofstream obj(path);
  for (int row = 0; row < strip_rows; ++row) {
    for (int column = 0; column < 2; ++column)
      obj << "v " << column / 16.0 << ' ' << shift - row / 16.0 << " 0 " << (row < first_lower_row ? 1 : 0)
          << " 0.5 0\n";
  }
  for (int row = 0; row + 1 < strip_rows; ++row) {
    if (row == 0) obj << "g upper\n";
    if (row + 1 == first_lower_row) obj << "g lower\n";
    const int a = 2 * row + 1;
    obj << "f " << a << ' ' << a + 2 << ' ' << a + 3 << ' ' << a + 1 << '\n';
  }
}

void run(World& world, int frames) {
  for (int i = 0; i < frames; ++i) {
    const StepReport& report = world.step(1.0 / 60);
    ASSERT_TRUE(report.ok()) << report.message;
  }
}

std::span<const Vec3f> positions_of_only(const World& world) {
  return world.positions(world.objects()[0]);
}

// --- maps
// Equal tension on a strip whose upper half is three times stiffer.
std::string stretched_strip(const std::string& source) {
  return R"({"souple": 1, "gravity": [0, 0, 0], "objects": [{"kind": "cloth", "mesh": {"file": "strip.obj"},
    "material": {"areal_density": 1, "membrane_stiffness": 20, "bending": "none", "damping": 3},
    "maps": {"stiffness": {)" +
         source + R"(, "value": 3, "default": 1}},
    "pins": [{"vertices": [0, 1]},
             {"vertices": [32, 33], "keyframes": [{"time": 0}, {"time": 1, "translate": [0, -0.05, 0]}]}]}]})";
}

void expect_stiff_upper_half(World world) {
  run(world, 400);
  const auto x = positions_of_only(world);
  // Mean of both sides: all diagonals lean the same way, which makes the sides differ.
  const auto strain = [&](std::size_t from, std::size_t to) {
    const float apart = x[2 * from].y - x[2 * to].y + x[2 * from + 1].y - x[2 * to + 1].y;
    return static_cast<double>(apart) / (2 * static_cast<double>(to - from) / 16) - 1;
  };
  const double upper = strain(1, 8), lower = strain(9, 15);
  EXPECT_GT(upper, 0.02);
  EXPECT_NEAR(lower / upper, 3, 0.3) << upper << " and " << lower;
}

TEST_F(Behavior, StiffnessMapOfAGroupAndOfAColor) {
  write_strip(file("strip.obj"));
  for (const char* source : {R"("group": "upper")", R"("color": "red")"})
    expect_stiff_upper_half(built(stretched_strip(source)));
}

TEST_F(Behavior, ThicknessMapKeepsItsDistance) {
  write_strip(file("strip.obj"));
  World world = built(R"({"souple": 1, "objects": [{"kind": "cloth", "mesh": {"file": "strip.obj"},
    "transform": {"translate": [0, 0.05, 0], "rotate": [90, 0, 0]},
    "material": {"thickness": 0.02, "bending": "none", "membrane_stiffness": 50, "damping": 1},
    "maps": {"thickness": {"group": "upper", "value": 3, "default": 1}}}],
    "colliders": [{"shape": {"plane": {}}}]})");
  run(world, 120);
  const auto x = positions_of_only(world);
  EXPECT_NEAR(x[4].y, 0.03, 1e-3);   // half of 3 x 0.02
  EXPECT_NEAR(x[28].y, 0.01, 1e-3);  // half of 0.02
}

TEST_F(Behavior, PinWeightOfAGroup) {
  write_strip(file("strip.obj"));
  World world = built(R"({"souple": 1, "objects": [{"kind": "cloth", "mesh": {"file": "strip.obj"},
    "maps": {"pin_weight": {"group": "upper", "value": 1}}}]})");
  std::vector<std::uint32_t> upper;
  for (std::uint32_t i = 0; i < 2u * first_lower_row; ++i) upper.push_back(i);
  EXPECT_EQ(world.pinned(world.objects()[0]), upper);
  run(world, 30);
  EXPECT_EQ(positions_of_only(world)[16].y, -0.5f);
}

TEST_F(Behavior, HalfAPinWeightIsASpring) {
  write_strip(file("strip.obj"));
  // Green is 0.5 everywhere, so each vertex has a spring of 0.05 m/N. The springs together carry the weight;
  // edges only redistribute it.
  World world = built(R"({"souple": 1, "substeps": 20, "drag": 4, "objects": [{"kind": "cloth",
    "mesh": {"file": "strip.obj"}, "material": {"areal_density": 2, "membrane_stiffness": 100, "air_drag": 0},
    "maps": {"pin_weight": {"color": "green", "value": 1, "default": 0, "compliance": 0.05}}}]})");
  const ObjectId strip = world.objects()[0];
  const std::vector<Vec3f> before(positions_of_only(world).begin(), positions_of_only(world).end());
  run(world, 300);
  const auto after = positions_of_only(world);
  double sag = 0;
  for (std::size_t i = 0; i < after.size(); ++i) sag += static_cast<double>(before[i].y - after[i].y);
  EXPECT_NEAR(sag / 0.05, world.total_mass(strip) * g, 0.02 * world.total_mass(strip) * g);
}

// --- sequences
constexpr int sequence_frames = 3;
constexpr double sequence_rise = 0.1;  ///< per frame [m]

std::vector<Vec3f> strip_points(double shift) {
  std::vector<Vec3f> points;
  for (int row = 0; row < strip_rows; ++row) {
    for (int column = 0; column < 2; ++column)
      points.push_back(Vec3f(Vec3d{column / 16.0, shift - row / 16.0, 0}));
  }
  return points;
}

// Ten frames per second, from 0.5 s on. The mesh is scaled by 2 and rotated so that its Y becomes Z.
World with_sequence(const fs::path& folder, const std::string& name) {
  return build_world(parse_scene(R"({"souple": 1, "gravity": [0, 0, 0], "objects": [{"kind": "cloth",
    "mesh": {"file": "strip.obj", "scale": 2}, "transform": {"translate": [1, 2, 3], "rotate": [90, 0, 0]},
    "material": {"membrane_stiffness": 100},
    "pins": [{"vertices": [0, 1], "sequence": {"file": ")" +
                                     name + R"(", "frame_rate": 10, "start_time": 0.5}}]}]})",
                                 folder, "test.json"));
}

void expect_sequence_motion(World world) {
  const auto risen = [&] { return static_cast<double>(positions_of_only(world)[0].z) - 3; };
  EXPECT_NEAR(positions_of_only(world)[1].x, 1 + 2 / 16.0, 1e-6);
  run(world, 30);  // 0.5 s
  EXPECT_NEAR(risen(), 0, 1e-5);
  run(world, 6);  // one frame of the sequence
  EXPECT_NEAR(risen(), 2 * sequence_rise, 1e-4);
  run(world, 3);  // halfway to the next
  EXPECT_NEAR(risen(), 3 * sequence_rise, 1e-4);
  run(world, 30);  // after the last
  EXPECT_NEAR(risen(), 4 * sequence_rise, 1e-4);
}

TEST_F(Behavior, PinsFollowFiles) {
  write_strip(file("strip.obj"));
  Pc2Writer pc2(file("moved.pc2"), std::uint64_t{2} * strip_rows);
  MddWriter mdd(file("moved.mdd"), std::uint64_t{2} * strip_rows, sequence_frames);
  for (int frame = 0; frame < sequence_frames; ++frame) {
    const std::vector<Vec3f> points = strip_points(frame * sequence_rise);
    pc2.append(points);
    mdd.append(frame / 10.0, points);
    write_strip(file("moved_000" + std::to_string(frame + 1) + ".obj"), frame * sequence_rise);
  }
  pc2.finish();
  mdd.finish();
  for (const char* name : {"moved.pc2", "moved.mdd", "moved_0001.obj"})
    expect_sequence_motion(with_sequence(folder, name));
}

TEST_F(Behavior, SequenceOfAnotherMeshIsRefused) {
  write_strip(file("strip.obj"));
  Pc2Writer writer(file("moved.pc2"), 5);
  writer.append(std::vector<Vec3f>(5));
  writer.finish();
  expect_error([&] { with_sequence(folder, "moved.pc2"); }, {"test.json: objects[0].pins[0]", "34"});
}

// --- tethers
double longest_rope(World world) {
  double longest = 0;
  for (int i = 0; i < 240; ++i) {
    run(world, 1);
    const auto x = positions_of_only(world);
    longest = std::max(longest, static_cast<double>(length(x.back() - x.front())));
  }
  return longest;
}

TEST_F(Behavior, TethersHoldALimpRope) {
  const auto rope = [](const std::string& more) {
    return with_object(R"("kind": "rope", "points": [[0, 2, 0], [0, 1, 0]], "segments": 20,
        "material": {"radius": 0.01, "young_modulus": 1e4, "damping": 1}, "pins": [{"vertices": [0]}])" +
                       more);
  };
  // Its weight stretches it by rho g L^2 / (2 E) = 0.54 m at rest, and first by nearly twice as much.
  EXPECT_GT(longest_rope(built(rope(""))), 1.8);
  EXPECT_NEAR(longest_rope(built(rope(R"(, "tethers": {"slack": 0.05})"))), 1.05, 0.005);
}

// --- gas
/// The sphere's radius: mean distance of the vertices from their mean.
double radius_after(World world, int frames) {
  run(world, frames);
  const auto x = positions_of_only(world);
  Vec3d center;
  for (const Vec3f& p : x) center += Vec3d(p) / static_cast<double>(x.size());
  double radius = 0;
  for (const Vec3f& p : x) radius += length(Vec3d(p) - center) / static_cast<double>(x.size());
  return radius;
}

std::string balloon(const std::string& more) {
  return R"({"souple": 1, "gravity": [0, 0, 0], "substeps": 20, "drag": 2, "objects": [{"kind": "cloth",
    "mesh": {"sphere": {"radius": 0.5, "subdivisions": 2}},
    "material": {"areal_density": 0.5, "membrane_stiffness": 100, "bending": "none", "air_drag": 0})" +
         more + "}]}";
}

TEST_F(Behavior, PressureBlowsUp) {
  EXPECT_NEAR(radius_after(built(balloon("")), 120), 0.5, 1e-3);
  // Small strain of a membrane with nu = 1/3, which edge springs have: dR / R = P R (1 - nu) / (2 Y) = 0.033.
  // Finite strain and the coarse mesh add to it.
  const double swollen = radius_after(built(balloon(R"(, "pressure": 20)")), 300) / 0.5 - 1;
  EXPECT_GT(swollen, 0.025);
  EXPECT_LT(swollen, 0.045);
  EXPECT_LT(radius_after(built(balloon(R"(, "pressure": -5)")), 10), 0.4999) << "suction";
}

TEST_F(Behavior, EnclosedVolumeIsKept) {
  const double swollen = radius_after(built(balloon(R"(, "enclosed_volume": {"factor": 1.331})")), 120) / 0.5;
  EXPECT_NEAR(swollen, 1.1, 0.005);
}

// --- springs and pairs
TEST_F(Behavior, AttachmentsAreSpringsOfTheirCompliance) {
  World world = built(with_object(R"("kind": "grains", "points": [[0, 1, 0], [1, 1, 0]],
      "material": {"radius": 0.05, "density": 1000},
      "attachments": [{"vertices": [0], "compliance": 0.01}, {"vertices": [1]}])"));
  const double mass = 1000 * 4 * 3.14159265 / 3 * 0.05 * 0.05 * 0.05;
  double mean = 0;
  const int frames = 600;
  for (int i = 0; i < frames; ++i) {
    run(world, 1);
    mean += (1 - static_cast<double>(positions_of_only(world)[0].y)) / frames;
  }
  EXPECT_NEAR(mean, mass * g * 0.01, 0.05 * mass * g * 0.01);
  EXPECT_NEAR(positions_of_only(world)[1].y, 1, 1e-4);
}

TEST_F(Behavior, PairsDecideFrictionAndRestitution) {
  const auto grain = [&](const std::string& start, const std::string& pair) {
    return built(R"({"souple": 1, "substeps": 20, "objects": [{"name": "puck", "kind": "grains",)" + start +
                 R"(, "material": {"radius": 0.05, "friction": 2, "rolling_friction": 10, "restitution": 0}}],
      "colliders": [{"name": "floor", "shape": {"plane": {}}, "friction": 2}],
      "pairs": [{"between": ["puck", "floor"], )" +
                 pair + "}]}");
  };
  // Slides v^2 / (2 mu g) = 0.2548 m with the pair's friction of 0.2; with the material's it would be 0.0255
  // m.
  World sliding = grain(R"("points": [[0, 0.05, 0]], "velocity": [1, 0, 0])", R"("friction": 0.2)");
  run(sliding, 120);
  EXPECT_NEAR(positions_of_only(sliding)[0].x, 1 / (2 * 0.2 * g), 0.005);
  // Bounces to e^2 of its initial height.
  World bouncing = grain(R"("points": [[0, 1.05, 0]])", R"("friction": 0, "restitution": 0.5)");
  run(bouncing, 29);  // falls for 0.45 s
  double top = 0;
  for (int i = 0; i < 30; ++i) {
    run(bouncing, 1);
    top = std::max(top, static_cast<double>(positions_of_only(bouncing)[0].y) - 0.05);
  }
  EXPECT_NEAR(top, 0.25, 0.02);
}

// Slides v^2 / (2 mu g) with the kinetic coefficient, of the material or of the pair.
TEST_F(Behavior, KineticFrictionBrakesWhatSlides) {
  const std::string objects = R"({"souple": 1, "substeps": 20, "objects": [{"name": "puck", "kind": "cloth",
      "mesh": {"grid": {"columns": 3, "rows": 3, "size": 0.2}}, "velocity": [1, 0, 0], "transform": {"translate": [0, 0.0051, 0]},
      "material": {"thickness": 0.01, "friction": 2, "kinetic_friction": )";
  const std::string floor = R"(}}], "colliders": [{"name": "floor", "shape": {"plane": {}}, "friction": 2,
      "kinetic_friction": )";
  for (const std::string& scene :
       {objects + "0.2" + floor + "0.2}]}",
        objects + "1" + floor + R"(1}], "pairs": [{"between": ["puck", "floor"], "friction": 2,
            "kinetic_friction": 0.2}]})"}) {
    World world = built(scene);
    const double start = static_cast<double>(positions_of_only(world)[4].x);
    run(world, 90);
    EXPECT_NEAR(static_cast<double>(positions_of_only(world)[4].x) - start, 1 / (2 * 0.2 * g), 0.008);
  }
}

// A grain falls through it as through nothing, and the world says when it does.
TEST_F(Behavior, ASensorPushesNothingAndIsTold) {
  World world = built(R"({"souple": 1, "objects": [{"name": "puck", "kind": "grains", "points": [[0, 1, 0]]}],
      "colliders": [{"name": "gate", "shape": {"plane": {}}, "sensor": true}]})");
  world.track_contacts(true);
  bool overlapped = false;
  for (int i = 0; i < 60; ++i) {
    run(world, 1);
    for (const ContactPair& pair : world.contact_pairs()) overlapped = overlapped || pair.is_sensor;
  }
  EXPECT_TRUE(overlapped);
  EXPECT_NEAR(static_cast<double>(positions_of_only(world)[0].y), 1 - g / 2, 0.1);
}

TEST_F(Behavior, GroupsAndPairsDecideWhatMeets) {
  const auto height = [&](const std::string& object, const std::string& collider,
                          const std::string& collide) {
    World world = built(
        R"({"souple": 1, "objects": [{"name": "puck", "kind": "grains", "points": [[0, 0.05, 0]],
        "material": {"radius": 0.05})" +
        object + R"(}], "colliders": [{"name": "floor", "shape": {"plane": {}})" + collider +
        R"(}], "pairs": [{"between": ["puck", "floor"], "collide": )" + collide + R"(, "friction": 1}]})");
    run(world, 60);
    return positions_of_only(world)[0].y;
  };
  EXPECT_NEAR(height("", "", "true"), 0.05f, 1e-3f);
  EXPECT_LT(height("", "", "false"), -1);
  EXPECT_LT(height(R"(, "collision_groups": [1])", R"(, "collision_mask": [0])", "true"), -1);
  EXPECT_LT(height(R"(, "collision_mask": [2])", "", "true"), -1);
  EXPECT_NEAR(height(R"(, "collision_groups": [1])", R"(, "collision_mask": [1, 7])", "true"), 0.05f, 1e-3f);
}

// A drop and a grain drift with the wind that reaches them: drag c brings them to its velocity as 1 - exp(-c t).
TEST_F(Behavior, WindReachesEachObjectByItsExposure) {
  const std::string grain = R"("kind": "grains", "points": [[0, 0, 0]], "material": {"radius": 0.01})";
  const std::string drop =
      R"("kind": "fluid", "points": [[5, 0, 0]], "material": {"spacing": 0.02, "air_drag": 1000})";
  World world = built(
      R"({"souple": 1, "substeps": 20, "gravity": [0, 0, 0], "drag": 2,
    "wind": {"velocity": [3, 0, 0]}, "objects": [{"name": "open", )" +
      grain + R"(}, {"name": "half", "wind_exposure": 0.5, "transform": {"translate": [0, 1, 0]}, )" + grain +
      R"(}, {"name": "still", "wind_exposure": 0, "transform": {"translate": [0, 2, 0]}, )" + grain +
      R"(}, {"name": "spray", )" + drop +
      R"(}, {"name": "draft", "wind_exposure": 2, "transform": {"translate": [0, 1, 0]}, )" + drop + "}]}");
  EXPECT_EQ(world.wind_exposure(world.find_object("half")), 0.5f);
  run(world, 60);
  const auto speed = [&](const char* name) { return world.velocities(world.find_object(name))[0].x; };
  EXPECT_NEAR(speed("open"), 3 * (1 - std::exp(-2)), 0.05);
  EXPECT_NEAR(speed("half"), speed("open") / 2, 1e-5);
  EXPECT_EQ(speed("still"), 0);
  EXPECT_NEAR(speed("spray"), 3, 0.05);
  EXPECT_NEAR(speed("draft"), 6, 0.05);
}

TEST_F(Behavior, WhatLiesFallsAsleepWhenTheSceneSaysSo) {
  for (const char* sleeping : {"", R"("sleeping": {"enabled": true, "seconds": 0.25},)"}) {
    World world =
        built(std::string(R"({"souple": 1, )") + sleeping + R"("objects": [{"name": "puck", "kind": "grains",
        "points": [[0, 0.05, 0]], "material": {"radius": 0.05}}],
        "colliders": [{"name": "floor", "shape": {"plane": {}}}]})");
    run(world, 30);
    EXPECT_EQ(world.is_asleep(world.find_object("puck")), *sleeping != 0);
  }
}

}  // namespace souple::scene_test::test_scene_behavior
