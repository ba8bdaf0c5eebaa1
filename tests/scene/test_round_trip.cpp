// Scenes read the values that the text contains, and writing preserves them.
#include "scene_test.h"

namespace souple::scene_test::test_scene_round_trip {

/// The manual's example, with a value for every sort of key.
TEST(Scene, ReadsEveryValueWhereItBelongs) {
  const SceneDescription scene = parse_scene(R"({
    "souple": 1, "frame_rate": 50, "frames": 100, "substeps": 7, "iterations": 3, "mode": "pbd",
    "integrator": "implicit_euler", "gravity": [0, -1.62, 0.5], "seed": 9007199254740991, "drag": 0.25,
    "measure_residuals": false, "sleeping": {"enabled": true, "speed": 0.25, "seconds": 2},
    "camera": {"from": [2, 1.5, 3], "to": [0, 0.5, 0], "fov": 35},
    "wind": {"velocity": [2, 0, -1], "gust": 0.3, "gust_period": 4, "air_density": 1.1},
    "objects": [
      {"name": "flag", "kind": "cloth", "mesh": {"grid": {"columns": 80, "rows": 48, "size": 2.0, "diagonals": "one_way"}},
       "transform": {"translate": [0, 2, 0], "rotate": [90, 0, 0], "scale": 1.5}, "velocity": [1, 2, 3],
       "angular_velocity": [4, 5, 6], "collision_groups": [0, 31], "collision_mask": [], "color": "#0aF0c8", "pressure": -20, "enclosed_volume": {"factor": 1.5, "compliance": 1e-6},
       "tethers": {"slack": 0.1}, "layer": 2, "wind_exposure": 0.25, "self_collision": "particles",
       "material": {"preset": "silk", "areal_density": 0.08, "stretch": "membrane", "bending": "dihedral"},
       "pins": [{"in_box": [[-1.01, 1, -1], [-0.99, 3, 1]]}, {"nearest": [1, 2, 3], "about": [0, 1, 0], "loop": true,
                 "keyframes": [{"time": 0}, {"time": 1, "translate": [1, 0, 0], "rotate": [0, 90, 0]}]}],
       "attachments": [{"vertices": [3, 1], "compliance": 0.001}]},
      {"name": "bar", "kind": "soft_body", "mesh": {"tet_bar": {"cells": [3, 2, 1], "size": [3, 2, 1]}},
       "material": {"young_modulus": 6e4, "poisson_ratio": 0.3, "model": "shape_matching"}, "self_collision": "surfaces"},
      {"name": "ball", "kind": "soft_body", "mesh": {"sphere": {"radius": 0.5, "subdivisions": 2}}, "lattice": {"cell_size": 0.1}},
      {"name": "line", "kind": "rope", "points": [[0, 1, 0], [1, 1, 0]], "segments": 40,
       "material": {"preset": "nylon", "radius": 0.006}},
      {"name": "sand", "kind": "grains", "box": {"lo": [0, 0, 0], "hi": [1, 2, 3], "spacing": 0.3, "jitter": 0.5}},
      {"name": "wheel", "kind": "obstacle", "mesh": {"torus": {"major_radius": 0.5, "minor_radius": 0.2}}, "color": "#102030",
       "transform": {"scale": 2}, "material": {"thickness": 0.01, "friction": 0.7, "restitution": 0.25}, "loop": true, "collision_groups": [2], "layer": 1,
       "keyframes": [{"time": 0}, {"time": 2, "translate": [0, 1, 0], "rotate": [0, 90, 0]}]},
      {"name": "duck", "kind": "obstacle", "mesh": {"file": "meshes/duck.obj", "scale": 0.01},
       "sequence": {"file": "meshes/duck.obj", "frame_rate": 24, "start_time": 0.5, "loop": true}}
    ],
    "colliders": [{"name": "floor", "shape": {"plane": {"normal": [0, 2, 0], "offset": 1}}, "friction": 0.75, "restitution": 0.5,
                   "collision_groups": [3], "collision_mask": [0, 1, 4]},
                  {"name": "pin", "shape": {"capsule": {"radius": 0.1, "half_height": 2, "center": [1, 0, 0]}},
                   "keyframes": [{"time": 0, "translate": [0, 0.3, 0]}, {"time": 1}], "loop": true},
                  {"name": "rock", "shape": {"signed_distance_field":
                    {"mesh": {"file": "meshes/duck.obj", "scale": 0.01}, "spacing": 0.02}}},
                  {"name": "ring", "show": false, "shape": {"signed_distance_field":
                    {"mesh": {"torus": {"major_radius": 1, "minor_radius": 0.25}}, "resolution": 24}}}],
    "pairs": [{"between": ["flag", "floor"], "friction": 0, "restitution": 1},
              {"between": ["flag", "flag"], "collide": false}],
    "connections": [{"from": {"object": "flag", "vertices": [0]}, "to": {"object": "line", "all": true},
                     "pairing": "nearest", "rest_length": 0, "compliance": 0.5, "until": 1.25}]
  })",
                                             scenes_folder(), "test.json");
  EXPECT_EQ(scene.frame_rate, 50);
  EXPECT_EQ(scene.frames, 100u);
  EXPECT_EQ(scene.settings.substeps, 7);
  EXPECT_EQ(scene.settings.iterations, 3);
  EXPECT_EQ(scene.settings.mode, Mode::pbd);
  EXPECT_EQ(scene.settings.integrator, Integrator::implicit_euler);
  EXPECT_EQ(scene.settings.gravity, Vec3f(0, -1.62f, 0.5f));
  EXPECT_EQ(scene.settings.seed, 9007199254740991u);
  EXPECT_EQ(scene.settings.drag, 0.25f);
  EXPECT_FALSE(scene.settings.measure_residuals);
  EXPECT_EQ(scene.settings.sleeping, (Sleeping{true, 0.25f, 2}));
  EXPECT_EQ(scene.camera.fov, 35);
  EXPECT_EQ(scene.settings.wind.velocity, Vec3f(2, 0, -1));
  EXPECT_EQ(scene.settings.wind.gust_period, 4);

  const auto& flag = std::get<ClothDescription>(scene.objects[0]);
  const auto& grid = std::get<GridMesh>(flag.mesh.source);
  EXPECT_EQ(grid.columns, 80);
  EXPECT_EQ(grid.rows, 48);
  EXPECT_EQ(grid.size, 2);
  EXPECT_EQ(grid.diagonals, Diagonals::one_way);
  EXPECT_EQ(flag.transform.rotate, Vec3d(90, 0, 0));
  EXPECT_EQ(flag.color, 0x0af0c8u);
  EXPECT_EQ(flag.transform.scale, 1.5);
  EXPECT_EQ(flag.velocity, Vec3f(1, 2, 3));
  EXPECT_EQ(flag.angular_velocity, Vec3f(4, 5, 6));
  EXPECT_EQ(flag.pressure, -20.0f);
  EXPECT_EQ(flag.enclosed_volume->factor, 1.5f);
  EXPECT_EQ(flag.tethers->slack, 0.1f);
  EXPECT_EQ(flag.wind_exposure, 0.25f);
  EXPECT_EQ(flag.self_collision, SelfCollision::particles);
  EXPECT_EQ(flag.material.areal_density, 0.08f);
  EXPECT_EQ(flag.material.stretch, StretchModel::membrane);
  EXPECT_EQ(flag.material.bending, BendingModel::dihedral);
  // Values of the preset that the scene does not override.
  EXPECT_EQ(flag.material.membrane_stiffness, material::silk.membrane_stiffness);
  EXPECT_EQ(std::get<Selector::InBox>(flag.pins[0].where.choice).hi, Vec3f(-0.99f, 3, 1));
  EXPECT_EQ(flag.pins[1].keyframes[1].rotate, Vec3d(0, 90, 0));
  EXPECT_TRUE(flag.pins[1].loop);
  EXPECT_EQ(std::get<Selector::Vertices>(flag.attachments[0].where.choice).indices,
            (std::vector<std::uint32_t>{3, 1}));
  EXPECT_EQ(flag.attachments[0].compliance, 0.001f);

  const auto& bar = std::get<SoftBodyDescription>(scene.objects[1]);
  EXPECT_EQ(std::get<TetBarMesh>(bar.mesh.source).cells, (std::array<int, 3>{3, 2, 1}));
  EXPECT_EQ(bar.material.model, SoftBodyModel::shape_matching);
  EXPECT_EQ(bar.self_collision, SelfCollision::surfaces);
  EXPECT_EQ(std::get<SoftBodyDescription>(scene.objects[2]).lattice->cell_size, 0.1);
  EXPECT_EQ(std::get<RopeDescription>(scene.objects[3]).material.radius, 0.006f);
  EXPECT_EQ(std::get<GrainsBox>(std::get<GrainsDescription>(scene.objects[4]).centers).hi, Vec3d(1, 2, 3));
  const auto& wheel = std::get<ObstacleDescription>(scene.objects[5]);
  EXPECT_EQ(kind_of(scene.objects[5]), ObjectKind::obstacle);
  EXPECT_EQ(wheel.material.thickness, 0.01f);
  EXPECT_EQ(wheel.material.friction, 0.7f);
  EXPECT_EQ(wheel.material.restitution, 0.25f);
  EXPECT_EQ(wheel.keyframes[1].rotate, Vec3d(0, 90, 0));
  EXPECT_TRUE(wheel.loop);
  const auto& duck = std::get<ObstacleDescription>(scene.objects[6]);
  EXPECT_EQ(duck.sequence->file, "meshes/duck.obj");
  EXPECT_EQ(duck.sequence->frame_rate, 24);
  EXPECT_EQ(duck.sequence->start_time, 0.5);
  EXPECT_TRUE(duck.sequence->loop);
  EXPECT_EQ(std::get<Plane>(scene.colliders[0].shape).offset, 1);
  EXPECT_EQ(std::get<Capsule>(scene.colliders[1].shape).center, Vec3f(1, 0, 0));
  EXPECT_TRUE(scene.colliders[1].loop);
  EXPECT_TRUE(scene.colliders[2].show);
  EXPECT_FALSE(scene.colliders[3].show);
  const auto& rock = std::get<SignedDistanceFieldDescription>(scene.colliders[2].shape);
  EXPECT_EQ(std::get<FileMesh>(rock.mesh.source).file, "meshes/duck.obj");
  EXPECT_EQ(rock.mesh.import.scale, 0.01);
  EXPECT_EQ(rock.spacing, 0.02);
  EXPECT_EQ(std::get<SignedDistanceFieldDescription>(scene.colliders[3].shape).resolution, 24);
  EXPECT_EQ(shape_name(scene.colliders[1].shape), "capsule");
  EXPECT_EQ(shape_name(scene.colliders[3].shape), "signed_distance_field");
  EXPECT_EQ(scene.pairs[0].restitution, 1);
  EXPECT_EQ(scene.pairs[0].friction, 0.0f);
  EXPECT_TRUE(scene.pairs[0].collide);
  EXPECT_FALSE(scene.pairs[1].collide);
  EXPECT_FALSE(scene.pairs[1].friction.has_value());
  EXPECT_EQ(flag.collision.groups, 0x80000001u);
  EXPECT_EQ(flag.collision.mask, 0u);
  EXPECT_EQ(bar.collision.mask, ~0u) << "all, if not given";
  EXPECT_EQ(flag.layer, 2);
  EXPECT_EQ(bar.layer, 0) << "none, if not given";
  EXPECT_EQ(wheel.layer, 1);
  EXPECT_EQ(wheel.collision.groups, 4u);
  EXPECT_EQ(scene.colliders[0].collision.groups, 8u);
  EXPECT_EQ(scene.colliders[0].collision.mask, 19u);
  EXPECT_EQ(scene.connections[0].pairing, Pairing::nearest);
  EXPECT_EQ(scene.connections[0].rest_length, 0.0f);
  EXPECT_EQ(scene.connections[0].until, 1.25);

  // Writing preserves all values.
  const SceneDescription again = parse_scene(to_json(scene), scenes_folder(), "again.json");
  EXPECT_EQ(to_json(again), to_json(scene));
  EXPECT_EQ(std::get<ClothDescription>(again.objects[0]).material.areal_density, 0.08f);
  EXPECT_EQ(again.settings.seed, scene.settings.seed);
}

TEST(Scene, EmptyOneHasTheDefaultsOfTheLibrary) {
  const SceneDescription scene = parse_scene(R"({"souple": 1})", ".", "test.json");
  const Settings defaults;
  EXPECT_EQ(scene.settings.substeps, defaults.substeps);
  EXPECT_EQ(scene.settings.gravity, defaults.gravity);
  EXPECT_EQ(to_json(scene), "{\"souple\": 1}\n");
}

TEST(Scene, NamesWhatHasNoNameAsTheWorldDoes) {
  const SceneDescription scene = parse_scene(R"({"souple": 1, "objects": [
      {"kind": "rope", "points": [[0, 0, 0], [1, 0, 0]]},
      {"kind": "rope", "points": [[0, 0, 0], [1, 0, 0]], "name": "rope2"},
      {"kind": "rope", "points": [[0, 0, 0], [1, 0, 0]]}],
      "colliders": [{"shape": {"plane": {}}}, {"shape": {"plane": {}}}]})",
                                             ".", "test.json");
  EXPECT_EQ(common(scene.objects[0]).name, "rope");
  EXPECT_EQ(common(scene.objects[2]).name, "rope3");
  EXPECT_EQ(scene.colliders[1].name, "collider2");
}

TEST(Scene, ShippedOnesReadAndRoundTrip) {
  const auto files = shipped_scenes();
  EXPECT_GE(files.size(), 10u);
  for (const auto& file : files) {
    SCOPED_TRACE(file.filename().string());
    const SceneDescription scene = load_scene(file);
    EXPECT_FALSE(scene.description.empty());
    EXPECT_FALSE(scene.objects.empty());
    EXPECT_GE(scene.frames, 240u);
    EXPECT_LE(scene.frames, 300u);
    const std::string text = to_json(scene);
    EXPECT_NE(text.find("\"camera\""), std::string::npos) << "says from where it is seen";
    EXPECT_EQ(to_json(parse_scene(text, scene.folder, "again.json")), text);
  }
}

}  // namespace souple::scene_test::test_scene_round_trip
