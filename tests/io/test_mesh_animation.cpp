// Animations of mesh files against the formulas of glTF 2.0: skins, moving nodes, shapes.

#include "mesh_expect.h"
#include "souple/error.h"
#include "souple/io/animated_points.h"
#include "souple/mesh_files/mesh_animation.h"
#include "souple/mesh_files/mesh_message.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <fmt/core.h>

namespace souple::test_io_mesh_animation {

std::string base64(const std::string& bytes) {
  constexpr const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? std::uint32_t(std::uint8_t(bytes[i + k])) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k > bytes.size() ? '=' : letters[three >> (18 - 6 * k) & 63u];
  }
  return out;
}

/// Accessors of one buffer inside a glTF file.
class Buffer {
 public:
  std::string floats(const char* type, std::size_t width, const std::vector<float>& numbers) {
    std::string bytes;
    for (const float x : numbers) bytes.append(reinterpret_cast<const char*>(&x), sizeof(x));
    return add(bytes, 5126, type, numbers.size() / width);
  }
  std::string shorts(const char* type, std::size_t width, const std::vector<std::uint16_t>& numbers) {
    std::string bytes;
    for (const std::uint16_t x : numbers) bytes.append(reinterpret_cast<const char*>(&x), sizeof(x));
    return add(bytes, 5123, type, numbers.size() / width);
  }
  std::string json() const {
    return fmt::format(R"("buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}],)"
                       R"("bufferViews":[{}],"accessors":[{}])",
                       data_.size(), base64(data_), views_, accessors_);
  }

 private:
  std::string add(const std::string& bytes, int component, const char* type, std::size_t count) {
    const char* const comma = count_ == 0 ? "" : ",";
    views_ +=
        fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}}})", comma, data_.size(), bytes.size());
    accessors_ += fmt::format(R"({}{{"bufferView":{},"componentType":{},"count":{},"type":"{}"}})", comma,
                              count_, component, count, type);
    data_ += bytes;
    data_.resize((data_.size() + 3) / 4 * 4, '\0');
    return std::to_string(count_++);
  }

  std::string data_, views_, accessors_;
  int count_ = 0;
};

constexpr int arm_vertices = 5;
constexpr double arm_height(int i) {
  return 0.5 * i;
}
/// Weight of the forearm: 0 at the shoulder, 1 at the hand.
constexpr double arm_weight(int i) {
  return 0.25 * i;
}

/// An arm of two bones: the forearm bends by 90 degrees about Z in "bend" and by -90 in "wave", in a second. "rig" holds
/// the bones, twice as large and at x = 3. The arm's own node is elsewhere, which must not matter. The child "box" of the
/// forearm has no bones. "flag" is a triangle with a shape.
std::string arm_gltf(float seconds = 1) {
  Buffer b;
  std::vector<float> positions, weights;
  std::vector<std::uint16_t> joints;
  for (int i = 0; i < arm_vertices; ++i) {
    positions.insert(positions.end(), {i % 2 == 0 ? 0.f : 0.25f, float(arm_height(i)), 0.f});
    weights.insert(weights.end(), {float(1 - arm_weight(i)), float(arm_weight(i)), 0.f, 0.f});
    joints.insert(joints.end(), {0, 1, 0, 0});
  }
  const std::string arm = b.floats("VEC3", 3, positions), w = b.floats("VEC4", 4, weights),
                    j = b.shorts("VEC4", 4, joints),
                    arm_faces = b.shorts("SCALAR", 1, {0, 1, 2, 2, 1, 3, 2, 3, 4});
  const std::string inverse =
      b.floats("MAT4", 16, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,    // upper arm
                            1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1});  // forearm
  const std::string triangle = b.floats("VEC3", 3, {0, 0, 0, 1, 0, 0, 0, 1, 0}),
                    face = b.shorts("SCALAR", 1, {0, 1, 2}),
                    shape = b.floats("VEC3", 3, {0, 0, 0, 0, 0, 2, 0, 0, 0});
  const std::string times = b.floats("SCALAR", 1, {0, seconds}), weight = b.floats("SCALAR", 1, {0, 1}),
                    h = b.floats("VEC4", 4, {0, 0, 0, 1, 0, 0, float(std::sqrt(0.5)), float(std::sqrt(0.5))}),
                    back = b.floats("VEC4", 4,
                                    {0, 0, 0, 1, 0, 0, -float(std::sqrt(0.5)), float(std::sqrt(0.5))});
  const auto channel = [&](int sampler, int node, const char* path) {
    return fmt::format(R"({{"sampler":{},"target":{{"node":{},"path":"{}"}}}})", sampler, node, path);
  };
  const auto sampler = [&](const std::string& values) {
    return fmt::format(R"({{"input":{},"output":{}}})", times, values);
  };
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,3,5]}],"nodes":[
{"name":"rig","translation":[3,0,0],"scale":[2,2,2],"children":[1]},
{"name":"upper","children":[2]},
{"name":"fore","translation":[0,1,0],"children":[4]},
{"name":"arm","mesh":0,"skin":0,"translation":[0,70,0]},
{"name":"box","mesh":1,"translation":[0,1,0]},
{"name":"flag","mesh":2}],
"skins":[{"joints":[1,2],"inverseBindMatrices":)" +
         inverse + R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":)" + arm + R"(,"JOINTS_0":)" + j +
         R"(,"WEIGHTS_0":)" + w + R"(},"indices":)" + arm_faces +
         R"(}]},{"primitives":[{"attributes":{"POSITION":)" + triangle + R"(},"indices":)" + face +
         R"(}]},{"primitives":[{"attributes":{"POSITION":)" + triangle + R"(},"indices":)" + face +
         R"(,"targets":[{"POSITION":)" + shape +
         R"(}]}],"weights":[0]}],"animations":[{"name":"bend","samplers":[)" + sampler(h) + "," +
         sampler(weight) + R"(],"channels":[)" + channel(0, 2, "rotation") + "," + channel(1, 5, "weights") +
         R"(]},{"name":"wave","samplers":[)" + sampler(back) + R"(],"channels":[)" +
         channel(0, 2, "rotation") + "]}]," + b.json() + "}";
}

/// A point that the forearm moves: turned by `angle` about the elbow (0, 1, 0), then as the rig: 2 x + (3, 0, 0).
Vec3d with_forearm(const Vec3d& x, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), y = x.y - 1;
  return Vec3d{c * x.x - s * y, s * x.x + c * y + 1, x.z} * 2 + Vec3d{3, 0, 0};
}
Vec3d arm_vertex(int i, double angle) {
  const Vec3d x{i % 2 == 0 ? 0 : 0.25, arm_height(i), 0};
  const Vec3d upper = x * 2 + Vec3d{3, 0, 0};
  return upper * (1 - arm_weight(i)) + with_forearm(x, angle) * arm_weight(i);
}

constexpr double quarter_turn = 1.5707963267948966;

using MeshAnimationTest = AssimpTest;

TEST_F(MeshAnimationTest, SkinsNodesAndShapesFollowTheFormulas) {
  const auto path = put("souple_arm.gltf", arm_gltf());
  const MeshAnimation animation = read_mesh_animation(path, {.animation = "bend", .frame_rate = 8});
  ASSERT_EQ(animation.times.size(), 9u);
  ASSERT_EQ(animation.points, std::size_t(arm_vertices + 6));
  const TriangleMesh mesh = read_triangle_mesh(path);
  ASSERT_EQ(mesh.positions.size(), animation.points);
  const auto of = [&](const char* node) { return mesh.groups.at(node); };
  for (std::size_t frame = 0; frame < 9; ++frame) {
    const double time = double(frame) / 8, angle = time * quarter_turn;
    EXPECT_NEAR(animation.times[frame], time, 1e-12);
    const Vec3f* const x = &animation.positions[frame * animation.points];
    const auto expect_at = [&](std::uint32_t vertex, const Vec3d& expected) {
      EXPECT_LT(length(Vec3d(x[vertex]) - expected), 2e-6) << "vertex " << vertex << " of frame " << frame;
    };
    for (int i = 0; i < arm_vertices; ++i) expect_at(of("arm")[std::size_t(i)], arm_vertex(i, angle));
    // The box's node is 1 above the elbow.
    expect_at(of("box")[0], with_forearm({0, 2, 0}, angle));
    expect_at(of("box")[1], with_forearm({1, 2, 0}, angle));
    expect_at(of("flag")[1], {1, 0, 2 * time});
    expect_at(of("flag")[2], {0, 1, 0});
  }
}

// The mesh itself, read without an animation, has the pose of the file's nodes.
TEST_F(MeshAnimationTest, BeginsWithTheMesh) {
  const auto path = put("souple_arm.gltf", arm_gltf());
  const TriangleMesh mesh = read_triangle_mesh(path, {.node = "arm"});
  const MeshAnimation animation = read_mesh_animation(path, {.animation = "wave", .node = "arm"});
  ASSERT_EQ(animation.points, std::size_t(arm_vertices));
  for (std::size_t i = 0; i < animation.points; ++i)
    EXPECT_LT(length(Vec3d(animation.positions[i]) - mesh.positions[i]), 1e-6) << i;
  const Vec3f* const last = &animation.positions[animation.positions.size() - animation.points];
  for (int i = 0; i < arm_vertices; ++i)
    EXPECT_LT(length(Vec3d(last[i]) - arm_vertex(i, -quarter_turn)), 2e-6) << i;
}

TEST_F(MeshAnimationTest, DrivesAnimatedPoints) {
  const auto path = put("souple_arm_7.gltf", arm_gltf());
  AnimatedPoints points(path, {.frame_rate = 1000, .start_time = 2, .animation = "bend", .node = "arm"});
  EXPECT_NEAR(points.end_time(), 3, 1e-12);
  std::vector<Vec3f> x(points.points());
  for (const double time : {2.1, 2.5, 2.9}) {
    points.evaluate(time, x);
    for (int i = 0; i < arm_vertices; ++i)
      EXPECT_LT(length(Vec3d(x[std::size_t(i)]) - arm_vertex(i, (time - 2) * quarter_turn)), 3e-6);
  }
}

TEST_F(MeshAnimationTest, SaysWhatIsWrong) {
  const auto path = put("souple_arm.gltf", arm_gltf());
  expect_error([&] { read_mesh_animation(path); }, {"souple_arm.gltf", "2 animations", "\"bend\", \"wave\""});
  expect_error([&] { read_mesh_animation(path, {.animation = "walk"}); }, {"\"walk\"", "\"bend\", \"wave\""});
  expect_error([&] { read_mesh_animation(path, {.animation = "bend", .node = "leg"}); }, {"\"leg\""});
  for (const double rate : {0.0, -1.0, 1e6, std::nan("")})
    expect_error([&] { read_mesh_animation(path, {.animation = "bend", .frame_rate = rate}); },
                 {"frame rate"});
  expect_error([&] { read_mesh_animation("souple_none.glb"); }, {"souple_none.glb", "no such file"});
  expect_error([&] { read_mesh_animation("souple_none.obj"); }, {"souple_none.obj", ".glb"});
  expect_error([&] { read_mesh_animation(put("souple_still.off", "OFF\n0 0 0\n")); }, {".glb"});
  expect_error([&] { read_mesh_animation(put("souple_bad.gltf", "{")); }, {"souple_bad.gltf", "assimp"});
  expect_error([&] { AnimatedPoints("a.pc2x", {.animation = "bend"}); }, {"a.pc2x", ".glb"});
  // Without its animations.
  std::string still = arm_gltf();
  const std::size_t begin = still.find("\"animations\""), end = still.find("\"buffers\"");
  still.erase(begin, end - begin);
  expect_error([&] { read_mesh_animation(put("souple_still.gltf", still)); }, {"holds no animation"});
}

/// An FBX of a triangle with two shapes. "A" moves it by 5 along z and has keys at 0 and 1 s, with the weights 0 and 1.
/// "B" has three keys of 0. assimp lists per key only the shapes that have one at its time.
std::string shapes_fbx() {
  const auto shape = [](int id, const char* name, const char* by) {
    return fmt::format(
        "Geometry: {}, \"Geometry::{}\", \"Shape\" {{\nIndexes: *3 {{\na: 0,1,2\n}}\nVertices: *9 {{\na: "
        "{},{},{}\n}}\nNormals: *9 {{\na: 0,0,0,0,0,0,0,0,0\n}}\n}}\n",
        id, name, by, by, by);
  };
  const auto channel = [](int id, const char* name) {
    return fmt::format(
        "Deformer: {}, \"SubDeformer::{}\", \"BlendShapeChannel\" {{\nDeformPercent: 0\nFullWeights: *1 "
        "{{\na: 100\n}}\n}}\n",
        id, name);
  };
  const auto curve = [](int id, const char* times, const char* values, int keys) {
    return fmt::format(
        "AnimationCurve: {}, \"AnimCurve::\", \"\" {{\nKeyTime: *{} {{\na: {}\n}}\nKeyValueFloat: *{} {{\na: "
        "{}\n}}\n}}\n",
        id, keys, times, keys, values);
  };
  const char* const node = "AnimationCurveNode: {}, \"AnimCurveNode::DeformPercent\", \"\" {{\n}}\n";
  return "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}\n"
         "GlobalSettings:  {\nProperties70:  {\nP: \"UnitScaleFactor\", \"double\", \"Number\", \"\",100\n"
         "P: \"TimeMode\", \"enum\", \"\", \"\",11\n}\n}\nObjects:  {\n"
         "Geometry: 100, \"Geometry::Mesh\", \"Mesh\" {\nVertices: *9 {\na: 0,0,0,1,0,0,0,1,0\n}\n"
         "PolygonVertexIndex: *3 {\na: 0,1,-3\n}\n}\n" +
         shape(101, "A", "0,0,5") + shape(102, "B", "7,0,0") +
         "Model: 200, \"Model::Tri\", \"Mesh\" {\n}\nDeformer: 300, \"Deformer::\", \"BlendShape\" {\n}\n" +
         channel(301, "A") + channel(302, "B") +
         "AnimationStack: 400, \"AnimStack::Take\", \"\" {\nProperties70:  {\nP: \"LocalStart\", \"KTime\", "
         "\"Time\", \"\",0\n"
         "P: \"LocalStop\", \"KTime\", \"Time\", \"\",46186158000\n}\n}\nAnimationLayer: 401, "
         "\"AnimLayer::Base\", \"\" {\n}\n" +
         fmt::format(fmt::runtime(node), 402) + fmt::format(fmt::runtime(node), 403) +
         curve(404, "0,46186158000", "0,100", 2) + curve(405, "0,23093079000,46186158000", "0,0,0", 3) +
         "}\nConnections:  {\nC: \"OO\",200,0\nC: \"OO\",100,200\nC: \"OO\",300,100\nC: \"OO\",301,300\nC: "
         "\"OO\",302,300\n"
         "C: \"OO\",101,301\nC: \"OO\",102,302\nC: \"OO\",401,400\nC: \"OO\",402,401\nC: \"OO\",403,401\n"
         "C: \"OP\",402,301, \"DeformPercent\"\nC: \"OP\",403,302, \"DeformPercent\"\n"
         "C: \"OP\",404,402, \"d|DeformPercent\"\nC: \"OP\",405,403, \"d|DeformPercent\"\n}\n";
}

TEST_F(MeshAnimationTest, ShapesOfAnFbxHaveKeysOfTheirOwn) {
  const MeshAnimation animation =
      read_mesh_animation(put("souple_shapes.fbx", shapes_fbx()), {.frame_rate = 4});
  ASSERT_EQ(animation.times.size(), 5u);
  ASSERT_EQ(animation.points, 3u);
  for (std::size_t frame = 0; frame < 5; ++frame) {
    const Vec3f x = animation.positions[frame * 3];
    EXPECT_NEAR(x.z, 5 * double(frame) / 4, 1e-6) << frame;
    EXPECT_EQ(x.x, 0) << frame;
  }
}

std::string with(std::string text, const std::string& old, const std::string& next) {
  EXPECT_NE(text.find(old), std::string::npos) << old;
  for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old, at + next.size()))
    text.replace(at, old.size(), next);
  return text;
}

// assimp finds bones and animated nodes by their names, and knows one skin of a mesh.
TEST_F(MeshAnimationTest, WhatAssimpWouldMixUpIsRefused) {
  const auto two = put("souple_two.gltf", with(arm_gltf(), R"("name":"rig")", R"("name":"fore")"));
  expect_error([&] { read_mesh_animation(two, {.animation = "bend"}); }, {"souple_two.gltf", "\"fore\""});
  expect_error([&] { read_triangle_mesh(two); }, {"souple_two.gltf", "\"fore\""});
  const auto twice = put("souple_twice.gltf", with(arm_gltf(), R"("mesh":1)", R"("mesh":0)"));
  expect_error([&] { read_triangle_mesh(twice); }, {"souple_twice.gltf", "2 nodes"});
}

TEST_F(MeshAnimationTest, KeysThatAreNotFiniteAreRefused) {
  for (const float end : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    const auto path = put("souple_endless.gltf", arm_gltf(end));
    expect_error([&] { read_mesh_animation(path, {.animation = "bend"}); },
                 {"souple_endless.gltf", "not finite"});
  }
}

// The weights that a mesh states apply where no animation moves them.
TEST_F(MeshAnimationTest, StatedWeightsOfShapesApply) {
  const auto path = put("souple_weights.gltf", with(arm_gltf(), R"("weights":[0])", R"("weights":[0.5])"));
  const TriangleMesh mesh = read_triangle_mesh(path, {.node = "flag"});
  EXPECT_NEAR(mesh.positions[1].z, 1, 1e-6);
  const MeshAnimation wave = read_mesh_animation(path, {.animation = "wave", .node = "flag"});
  EXPECT_NEAR(wave.positions[1].z, 1, 1e-6);
}

TEST_F(MeshAnimationTest, ANumberedFileAloneIsNoSequence) {
  const std::string one = with(arm_gltf(), R"({"name":"wave",)", R"({"name":"bend",)");
  const std::size_t second = one.rfind(R"(,{"name":"bend",)"), end = one.find("\"buffers\"");
  const auto path = put("souple_hero2.gltf", one.substr(0, second) + "]," + one.substr(end));
  AnimatedPoints points(path, {.node = "arm"});
  EXPECT_NEAR(points.end_time(), 1, 1e-12);
}

TEST_F(MeshAnimationTest, Loops) {
  const auto path = put("souple_arm.gltf", arm_gltf());
  AnimatedPoints points(path, {.start_time = 2, .animation = "bend", .node = "arm", .loop = true});
  std::vector<Vec3f> x(points.points()), later(points.points());
  points.evaluate(2.25, x);
  points.evaluate(5.25, later);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT(length(x[i] - later[i]), 1e-6f) << i;
}

TEST_F(MeshAnimationTest, TooLongAnimationsAreRefused) {
  const std::string days = arm_gltf(1e6f);
  expect_error(
      [&] { read_mesh_animation(put("souple_days.gltf", days), {.animation = "bend", .frame_rate = 1e5}); },
      {"souple_days.gltf", "1 GiB"});
}

TEST(MeshMessage, AnimationsAreCheckedByteByByte) {
  const MeshAnimation animation{2, {0, 0.5}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}};
  const std::string message = mesh_detail::message_of_animation(animation);
  const MeshAnimation same = mesh_detail::animation_of_message(message, "message");
  EXPECT_EQ(same.points, 2u);
  EXPECT_EQ(same.times, animation.times);
  EXPECT_EQ(same.positions, animation.positions);
  EXPECT_THROW(mesh_detail::mesh_of_message(message, "message"), Error);
  for (std::size_t i = 0; i < message.size(); ++i) {
    for (const char byte : {'\0', '\xff', '\x7f', '\x04'}) {
      std::string damaged = message;
      damaged[i] = byte;
      try {
        const MeshAnimation taken = mesh_detail::animation_of_message(damaged, "message");
        ASSERT_EQ(taken.positions.size(), taken.points * taken.times.size());
      } catch (const Error&) {
      }
    }
    EXPECT_THROW(mesh_detail::animation_of_message(message.substr(0, i), "message"), Error);
  }
}

}  // namespace souple::test_io_mesh_animation
