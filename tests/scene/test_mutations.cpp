// Reading a mutated scene gives a scene or an Error.
#include "scene_test.h"
#include "souple/world/world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace souple::scene_test::test_scene_mutations {

/// Small changes of the text, like those of users and damaged files.
class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string mutate(std::string text) {
    for (std::size_t edits = 1 + pick(4); edits > 0; --edits) edit(text);
    return text;
  }

  /// Replaces numbers by other numbers: most scenes parse, some cannot be built.
  std::string retune(std::string text) {
    static const std::vector<std::string> numbers = {"-1", "0", "1e-30", "1e-6", "0.01", "0.5", "1",
                                                     "2",  "3", "7",     "20",   "90",   "1e5", "1e30"};
    for (std::size_t edits = 1 + pick(4); edits > 0; --edits) {
      const std::size_t begin = text.find_first_of("-0123456789", pick(text.size()));
      if (begin == std::string::npos) continue;
      const std::size_t end = std::min(text.find_first_not_of("-.e0123456789", begin), text.size());
      text.replace(begin, end - begin, numbers[pick(numbers.size())]);
    }
    return text;
  }

 private:
  std::size_t pick(std::size_t count) { return random_() % count; }

  void edit(std::string& text) {
    static const std::vector<std::string> pieces = {"null",
                                                    "true",
                                                    "-1",
                                                    "0",
                                                    "1e308",
                                                    "1e-320",
                                                    "-0.0",
                                                    "99999999999999999999",
                                                    "\"\"",
                                                    "[]",
                                                    "{}",
                                                    "{\"a\":1}",
                                                    "\"vertices\"",
                                                    "\"preset\": \"silk\",",
                                                    "[[[[",
                                                    "}",
                                                    "]",
                                                    ",",
                                                    ":",
                                                    "\"",
                                                    "\\",
                                                    "\\u0000",
                                                    "\xff",
                                                    "1.5",
                                                    "[1, 2, 3]",
                                                    "\"kind\": \"rope\",",
                                                    "\"kind\": \"grains\",",
                                                    "\"name\": \"flag\",",
                                                    "\n"};
    if (text.empty()) text = "{}";
    const std::size_t at = pick(text.size()), length = std::min(pick(20), text.size() - at);
    switch (pick(7)) {
      case 0:
        text[at] = static_cast<char>(pick(256));
        return;
      case 1:
        text.erase(at, length);
        return;
      case 2:
        text.insert(at, pieces[pick(pieces.size())]);
        return;
      case 3:
        text.insert(pick(text.size()), text.substr(at, length));
        return;
      default:
        replace_value(text, at, pieces[pick(pieces.size())]);
    }
  }

  /// The value after the next colon.
  static void replace_value(std::string& text, std::size_t at, const std::string& piece) {
    const std::size_t colon = text.find(':', at);
    if (colon == std::string::npos) return;
    const std::size_t end = text.find_first_of(",}]\n", colon);
    text.replace(colon + 1, std::min(end, text.size()) - colon - 1, piece);
  }

  std::mt19937 random_;
};

TEST(Mutations, OfOverridesGiveASceneOrAnError) {
  Mutator mutator(2);
  const std::vector<std::string> settings = {"substeps=20", "objects.flag.material.damping=0.1",
                                             "objects[0].transform.translate=[0,3,0]", "wind.gust=0.5",
                                             "colliders.ball.shape={\"plane\": {}}"};
  int refused = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::string setting = mutator.mutate(settings[static_cast<std::size_t>(i) % settings.size()]);
    const std::string said = error_message(small_scene, {setting});
    if (!said.empty()) ++refused;
    ASSERT_EQ(said.find('\n'), std::string::npos) << said;
  }
  EXPECT_GT(refused, 166);
}

/// Every feature of scenes, as small as possible.
const char* const full_scene = R"({
  "souple": 1, "frames": 2, "substeps": 2, "wind": {"velocity": [1, 0, 0], "gust": 0.5}, "drag": 0.1, "fluid": {"iterations": 2},
  "objects": [
    {"name": "ball", "kind": "cloth", "mesh": {"sphere": {"radius": 0.2, "subdivisions": 1}}, "pressure": 5,
     "material": {"preset": "silk", "stretch": "membrane", "bending": "dihedral"},
     "enclosed_volume": {"factor": 1.2, "compliance": 0.1}, "tethers": {"slack": 0.1}, "pins": [{"nearest": [0, 1, 0]}]},
    {"name": "duck", "kind": "soft_body", "mesh": {"file": "meshes/duck.obj", "scale": 0.01}, "lattice": {"cells": 40},
     "maps": {"stiffness": {"group": "head", "value": 2}, "pin_weight": {"group": "beak", "value": 0.5}}},
    {"name": "box", "kind": "soft_body", "mesh": {"tet_bar": {"cells": 2, "size": [1, 1, 1]}},
     "material": {"model": "shape_matching", "density": 10}, "transform": {"translate": [0, 3, 0]}},
    {"name": "rope", "kind": "rope", "points": [[0, 1, 0], [1, 1, 0]], "segments": 5, "attachments":
     [{"vertices": [0], "compliance": 0.1, "keyframes": [{"time": 0}, {"time": 1, "rotate": [0, 90, 0]}], "about": [1, 1, 1]}]},
    {"name": "sand", "kind": "grains", "box": {"lo": [0, 0, 0], "hi": [0.1, 0.1, 0.1], "jitter": 0.5}},
    {"name": "water", "kind": "fluid", "box": {"lo": [0, 0, 0], "hi": [0.1, 0.1, 0.1]}, "material": {"preset": "oil",
     "surface_tension": 0.05, "vorticity": 0.1, "air_drag": 0.4}, "velocity": [1, 0, 0]},
    {"name": "wall", "kind": "obstacle", "mesh": {"file": "meshes/duck.obj", "scale": 0.01}, "material": {"thickness": 0.01},
     "transform": {"translate": [5, 0, 0]}, "keyframes": [{"time": 0}, {"time": 1, "rotate": [0, 90, 0]}], "loop": true}],
  "colliders": [{"name": "pole", "shape": {"capsule": {"radius": 0.1, "half_height": 1}}, "transform": {"rotate": [9, 0, 0]}}],
  "pairs": [{"between": ["sand", "pole"], "friction": 0.1}],
  "connections": [{"from": {"object": "rope", "vertices": [5]}, "to": {"object": "box", "all": true}, "pairing": "nearest"}]
})";

std::size_t product(const std::array<int, 3>& n) {
  return static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1]) * static_cast<std::size_t>(n[2]);
}

/// Estimated number of particles: one number may request millions.
std::size_t size_of(const MeshDescription& mesh) {
  if (const auto* grid = std::get_if<GridMesh>(&mesh.source)) return product({grid->columns, grid->rows, 1});
  if (const auto* sphere = std::get_if<SphereMesh>(&mesh.source))
    return std::size_t{10} << (2 * sphere->subdivisions);
  if (const auto* bar = std::get_if<TetBarMesh>(&mesh.source)) return product(bar->cells);
  if (const auto* ball = std::get_if<TetBallMesh>(&mesh.source))
    return (std::size_t{10} << (2 * ball->subdivisions)) * static_cast<std::size_t>(ball->layers);
  return 1000;
}
std::size_t size_of(const ClothDescription& cloth) {
  return size_of(cloth.mesh);
}
std::size_t size_of(const SoftBodyDescription& body) {
  return size_of(body.mesh) + (body.lattice ? body.lattice->cells : 0);
}
std::size_t size_of(const ObstacleDescription& obstacle) {
  return size_of(obstacle.mesh);
}
std::size_t size_of(const RopeDescription& rope) {
  return rope.segments;
}
std::size_t size_of(const GrainsDescription& grains) {
  if (const auto* grid = std::get_if<GrainsGrid>(&grains.centers)) return product(grid->counts);
  const auto* box = std::get_if<GrainsBox>(&grains.centers);
  if (box == nullptr) return 1;
  const Vec3d across = (box->hi - box->lo) / (2 * static_cast<double>(grains.material.radius));
  const double count = std::fabs(across.x * across.y * across.z);
  return count < 1e9 ? static_cast<std::size_t>(count) : std::size_t{1000000000};
}

std::size_t size_of(const FluidDescription& fluid) {
  const auto* box = std::get_if<FluidBox>(&fluid.filling);
  if (box == nullptr) return 1000;
  const Vec3d across = (box->hi - box->lo) / static_cast<double>(fluid.material.spacing);
  const double count =
      4 * std::fabs(across.x * across.y * across.z);  // one particle costs as much as a few others
  return count < 1e9 ? static_cast<std::size_t>(count) : std::size_t{1000000000};
}

std::size_t size_of(const RigidBodyDescription& body) {
  const auto* mesh = std::get_if<MeshDescription>(&body.solid);
  return mesh == nullptr ? 1000 : size_of(*mesh);
}

/// Small enough to build a thousand times. Larger scenes may be valid, but are not tested.
bool is_small(const SceneDescription& scene) {
  if (scene.settings.substeps > 20 || scene.settings.iterations > 20) return false;
  return std::all_of(scene.objects.begin(), scene.objects.end(), [](const AnyObjectDescription& object) {
    return std::visit([](const auto& o) { return size_of(o); }, object) <= 5000;
  });
}

TEST(Mutations, BuildAWorldOrGiveAnError) {
  for (const char* seed : {small_scene, full_scene}) {
    World world = build_world(parse_scene(seed, scenes_folder(), "seed.json"));
    EXPECT_TRUE(world.step(1.0 / 60).ok());
  }
  Mutator mutator(3);
  int stepped = 0, refused = 0;
  for (int i = 0; i < 200; ++i) {
    const std::string text = mutator.retune(i % 3 == 0 ? small_scene : full_scene);
    try {
      const SceneDescription scene = parse_scene(text, scenes_folder(), "mutated.json");
      if (!is_small(scene)) continue;
      World world = build_world(scene);
      world.step(1 / scene.frame_rate);  // may become non-finite, and then reports it
      ++stepped;
    } catch (const Error& error) {
      ASSERT_EQ(std::string(error.what()).find("mutated.json"), 0u) << error.what() << "\n" << text;
      ++refused;
    }
  }
  EXPECT_GT(stepped, 33);
  EXPECT_GT(refused, 33);
}

}  // namespace souple::scene_test::test_scene_mutations
