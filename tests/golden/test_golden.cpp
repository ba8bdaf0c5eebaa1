#include "golden_file.h"
#include "souple/error.h"
#include "souple/objects/joint_options.h"
#include "souple/rigid/joints/joint.h"
#include "souple/scene/scene.h"
#include "souple/world/world.h"
#include "tests/paths.h"
#include "trace.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

// Every shipped scene runs 90 frames, 40 with fluids, which take longest, and all 300 in a slow test. Runs are calm,
// and equal bit for bit to tests/golden.json and the trace in tests/golden/trace. Compared are the hashes of a few
// frames, and the codes of these frames and of the last one. Only where one differs the scene runs again, with every
// frame compared with its trace.
//   SOUPLE_GOLDEN_UPDATE=1   rewrites both, from all 300 frames (script/golden --update)
//   SOUPLE_GOLDEN_FRAMES=30  stops there; what comes later is not looked at. Not for slow tests
//   SOUPLE_GOLDEN_FLUID_FRAMES=30  the same for scenes with fluids alone

namespace souple::test::test_golden_golden {

namespace fs = std::filesystem;

constexpr int all_frames = 300;
constexpr int usual_frames = 90;
constexpr int usual_fluid_frames = 40;
constexpr int hashed_frames[] = {1, 30, all_frames};
constexpr const char* how_to_update = "; script/golden --update rewrites it";

const fs::path source_folder = source_path();
const fs::path golden_path = source_folder / "tests" / "golden.json";
const fs::path trace_folder = source_folder / "tests" / "golden" / "trace";

int frames_of(const char* variable, int usual) {
  const char* limit = std::getenv(variable);
  return limit ? std::clamp(std::atoi(limit), 1, all_frames) : usual;
}

bool updating() {
  const char* update = std::getenv("SOUPLE_GOLDEN_UPDATE");
  return update && std::string(update) == "1";
}

bool is_hashed(int frame) {
  return std::find(std::begin(hashed_frames), std::end(hashed_frames), frame) != std::end(hashed_frames);
}

int frames_to_run(const SceneDescription& scene) {
  if (updating()) return all_frames;
  const bool fluid = std::any_of(scene.objects.begin(), scene.objects.end(),
                                 [](const auto& object) { return kind_of(object) == ObjectKind::fluid; });
  const int frames = frames_of("SOUPLE_GOLDEN_FRAMES", usual_frames);
  return fluid ? std::min(frames, frames_of("SOUPLE_GOLDEN_FLUID_FRAMES", usual_fluid_frames)) : frames;
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(source_folder / "scenes")) {
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Energies that may move a scene, besides its own; watched from frame to frame.
class Energies {
 public:
  Energies(const World& world, const SceneDescription& scene)
      : world_(world), wind_(world.settings().wind), start_(sum()) {
    for (const AnyObjectDescription& object : scene.objects) {
      const auto* cloth = std::get_if<ClothDescription>(&object);
      if (cloth && cloth->pressure) pressures_[cloth->name] = static_cast<double>(*cloth->pressure);
      if (const auto* fluid = std::get_if<FluidDescription>(&object)) find_largest_share(*fluid);
    }
    remember();
  }

  /// After each frame of dt seconds.
  void watch(double dt) {
    const std::vector<Vec3d> before = driven_;
    remember();
    for (std::size_t i = 0; i < std::min(driven_.size(), before.size()); ++i)
      driven_speed_ = std::max(driven_speed_, length(driven_[i] - before[i]) / dt);
    emitted_ += static_cast<double>(world_.report().fluid.emitted);
    watch_motors();
  }

  double kinetic() const { return sum().kinetic; }

  /// No motion can hold more kinetic energy [J] than these sources give. They are kinetic and elastic energy at the
  /// start, the work of weight, and pressure times the largest volume it can have made. Pins and colliders may give a
  /// mass twice their speed (an elastic bounce), wind its own speed. Emitters add the energy of their fluid, and motors
  /// of joints their largest force times the path.
  double bound() const {
    const Sum now = sum();
    const double gust = length(Vec3d(wind_.velocity)) * (1 + static_cast<double>(wind_.gust));
    return start_.kinetic + start_.elastic + motor_work_ + emitted_ * kinetic_share_ +
           std::max(0.0, start_.potential + emitted_ * potential_share_ - now.potential) + pressure_work() +
           0.5 * now.mass * (4 * driven_speed_ * driven_speed_ + gust * gust);
  }

 private:
  struct Sum {
    double kinetic = 0, potential = 0, elastic = 0, mass = 0;
  };

  Sum sum() const {
    Sum total;
    for (const ObjectId object : world_.objects()) {
      total.kinetic += world_.kinetic_energy(object);
      total.potential += world_.potential_energy(object);
      total.mass += world_.total_mass(object);
    }
    total.elastic = world_.elastic_energy();
    return total;
  }

  /// Energy of a particle from the scene's strongest and highest emitters.
  void find_largest_share(const FluidDescription& fluid) {
    const double mass = double{fluid.material.density} * std::pow(double{fluid.material.spacing}, 3);
    for (const EmitterDescription& emitter : fluid.emitters) {
      kinetic_share_ = std::max(kinetic_share_, 0.5 * mass * double{emitter.speed} * double{emitter.speed});
      const Vec3d g(world_.settings().gravity);
      const double inflow = 2 * double{fluid.material.spacing};  // in which nothing falls
      const double fallen = -dot(g, Vec3d(emitter.position)) + length(g) * inflow;
      potential_share_ = std::max(potential_share_, mass * fallen);
    }
  }

  double pressure_work() const {
    double work = 0;
    for (const auto& [name, pascals] : pressures_) {
      Vec3d lo{1e30, 1e30, 1e30}, hi{-1e30, -1e30, -1e30};
      for (const Vec3f& x : world_.positions(world_.find_object(name))) {
        for (int k = 0; k < 3; ++k) {
          lo[k] = std::min(lo[k], static_cast<double>(x[k]));
          hi[k] = std::max(hi[k], static_cast<double>(x[k]));
        }
      }
      work += std::abs(pascals) * (hi.x - lo.x) * (hi.y - lo.y) * (hi.z - lo.z);
    }
    return work;
  }

  /// Motors of hinges, the only ones in shipped scenes.
  void watch_motors() {
    for (const JointId id : world_.joints()) {
      const auto* hinge = std::get_if<joint::Hinge>(&world_.joint_kind(id));
      if (!hinge || !hinge->rotation.motor) continue;
      const double angle = world_.joint_report(id).coordinate[0];
      motor_work_ += hinge->rotation.motor->max_force * std::abs(angle - angles_[id.value]);
      angles_[id.value] = angle;
    }
  }

  /// Where pins and colliders are; of a turning collider also a point a meter off its center.
  void remember() {
    driven_.clear();
    for (const ObjectId object : world_.objects()) {
      const auto positions = world_.positions(object);
      for (const std::uint32_t vertex : world_.pinned(object)) driven_.push_back(Vec3d(positions[vertex]));
    }
    for (const ColliderId collider : world_.colliders()) {
      const Transform pose = world_.collider_pose(collider);
      for (const Vec3d& point : {Vec3d{}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
        driven_.push_back(pose.point(point));
    }
  }

  const World& world_;
  Wind wind_;
  Sum start_;
  std::map<std::string, double> pressures_;
  std::vector<Vec3d> driven_;
  std::map<std::uint32_t, double> angles_;          ///< of motors [rad]
  double motor_work_ = 0;                           ///< at most [J]
  double driven_speed_ = 0;                         ///< the largest so far [m/s]
  double emitted_ = 0;                              ///< particles so far
  double kinetic_share_ = 0, potential_share_ = 0;  ///< of each [J]
};

/// Energy [J] of fluids besides weight. Their surface stores sigma times the area of a cube of it, cut up a little.
/// Compression stores p C V. [J]
double stored_in_fluids(const World& world) {
  double stored = 0;
  for (const ObjectId object : world.objects()) {
    if (world.kind(object) != ObjectKind::fluid) continue;
    const FluidMaterial& material = world.fluid_material(object);
    const double volume = double(world.positions(object).size()) * std::pow(double{material.spacing}, 3);
    const FluidReport& report = world.report().fluid;
    stored += 2 * double{material.surface_tension} * 6 * std::cbrt(volume * volume) +
              report.largest_pressure * report.mean_density_error * volume;
  }
  return stored;
}

/// The farthest vertex from the origin [m].
double farthest(const World& world) {
  double largest = 0;
  for (const ObjectId object : world.objects()) {
    for (const Vec3f& x : world.positions(object)) {
      const double distance = static_cast<double>(length(x));
      if (!(distance <= largest)) largest = distance;  // NaN as well
    }
  }
  return largest;
}

/// Results of a run that are compared.
struct RunResults {
  FrameHashes hashes;
  std::map<int, FrameCodes> codes;  ///< of the hashed frames and the last one; of all when updating
};

fs::path trace_path(const std::string& scene) {
  return trace_folder / (scene + ".txt");
}

void remove_what_is_gone(std::map<std::string, FrameHashes>& golden) {
  const std::vector<std::string> shipped = scene_names();
  for (auto entry = golden.begin(); entry != golden.end();) {
    const bool gone = std::find(shipped.begin(), shipped.end(), entry->first) == shipped.end();
    if (gone) fs::remove(trace_path(entry->first));
    entry = gone ? golden.erase(entry) : std::next(entry);
  }
}

void update_golden(const std::string& scene, const RunResults& run) {
  auto golden = read_golden(golden_path);
  remove_what_is_gone(golden);
  golden[scene] = run.hashes;
  write_golden(golden_path, golden);
  Trace trace;
  for (const auto& [frame, codes] : run.codes) append(trace, codes);
  write_trace(trace_path(scene), trace);
}

void expect_hashes(const std::string& scene, const FrameHashes& hashes) {
  const auto golden = read_golden(golden_path);
  const auto known = golden.find(scene);
  ASSERT_NE(known, golden.end()) << scene
                                 << " has no hashes in tests/golden.json: run script/golden --update";
  for (const auto& [frame, hash] : hashes) {
    const auto expected = known->second.find(frame);
    ASSERT_NE(expected, known->second.end()) << "tests/golden.json has no frame " << frame << " of " << scene;
    EXPECT_EQ(hash_text(hash), hash_text(expected->second))
        << scene << ", frame " << frame
        << ": results changed. If that is meant, run script/golden --update and say why in the commit";
  }
}

/// The first of the coded frames that differs.
std::optional<int> first_differing_frame(const Trace& trace, const RunResults& run) {
  for (const auto& [frame, codes] : run.codes) {
    if (difference_in(trace, frame, codes)) return frame;
  }
  return std::nullopt;
}

/// Runs a scene that changed once more, up to frame `last` at most, and says where it leaves its trace.
std::string where_it_changed(const SceneDescription& scene, const Trace& trace, const RunResults& run,
                             int last) {
  World world = build_world(scene);
  int frame = 0;
  bool repeated = true;  // as far as this run was coded the first time
  const auto next = [&] {
    world.step(1 / scene.frame_rate);
    FrameCodes codes = codes_of(world);
    const auto before = run.codes.find(++frame);
    if (before != run.codes.end()) repeated = repeated && before->second == codes;
    return codes;
  };
  const auto difference = first_difference(trace, last, next);
  if (!repeated) {
    return fmt::format("not deterministic: a second run differs from the first one in frame {} or before; {}",
                       frame, difference ? "it " + difference_text(*difference) : "it agrees with the trace");
  }
  if (difference) return difference_text(*difference);
  return fmt::format("frames 1-{} agree with the trace, which was not written with tests/golden.json{}", last,
                     how_to_update);
}

void expect_trace(const std::string& name, const SceneDescription& scene, const RunResults& run,
                  bool same_hashes) {
  const std::string file = "tests/golden/trace/" + name + ".txt";
  ASSERT_TRUE(fs::exists(trace_path(name))) << "there is no " << file << how_to_update;
  Trace trace;
  try {
    trace = read_trace(trace_path(name));
  } catch (const Error& error) {
    FAIL() << "tests/golden/trace/" << error.what() << how_to_update;
  }
  ASSERT_EQ(trace.frames(), all_frames) << file << " has another number of frames" << how_to_update;
  const std::string changes = changes_of_objects(trace, run.codes.begin()->second);
  EXPECT_EQ(changes, "") << name << ": its objects are not those of " << file << how_to_update;
  const std::optional<int> differs = first_differing_frame(trace, run);
  if (same_hashes && !differs) return;
  if (same_hashes && is_hashed(*differs)) {
    ADD_FAILURE() << name << ": in frame " << *differs << " the hash is that of tests/golden.json, but "
                  << file << " is out of date" << how_to_update;
    return;
  }
  const int last = differs.value_or(run.codes.rbegin()->first);
  ADD_FAILURE() << name << ": " << where_it_changed(scene, trace, run, last);
}

void expect_unchanged(const std::string& name, const SceneDescription& scene, const RunResults& run) {
  expect_hashes(name, run.hashes);
  expect_trace(name, scene, run, !testing::Test::HasFailure());
}

void expect_calm_and_unchanged(const std::string& name, const SceneDescription& scene, int last) {
  World world = build_world(scene);
  Energies energies(world, scene);
  const double dt = 1 / scene.frame_rate;
  RunResults run;
  double worst = 0;
  for (int frame = 1; frame <= last; ++frame) {
    const StepReport& report = world.step(dt);
    ASSERT_TRUE(report.ok()) << "frame " << frame << ": " << report.message;
    energies.watch(dt);
    const double kinetic = energies.kinetic(), bound = energies.bound() + stored_in_fluids(world);
    worst = std::max(worst, kinetic / std::max(bound, 1e-300));
    ASSERT_LE(kinetic, 1.02 * bound + 1e-6) << "frame " << frame << ": kinetic energy [J] from nowhere";
    ASSERT_LT(farthest(world), 100) << "frame " << frame << ": something flies away [m]";
    if (is_hashed(frame)) run.hashes[frame] = world.hash();
    if (is_hashed(frame) || frame == last || updating()) run.codes[frame] = codes_of(world);
  }
  testing::Test::RecordProperty("largest_share_of_energy_bound", std::to_string(worst));
  if (updating()) {
    update_golden(name, run);
  } else {
    expect_unchanged(name, scene, run);
  }
}

SceneDescription shipped(const std::string& name) {
  return load_scene(source_folder / "scenes" / (name + ".json"));
}

class GoldenScene : public testing::TestWithParam<std::string> {};

TEST_P(GoldenScene, IsCalmAndUnchanged) {
  const SceneDescription scene = shipped(GetParam());
  expect_calm_and_unchanged(GetParam(), scene, frames_to_run(scene));
}

TEST_P(GoldenScene, IsCalmAndUnchangedToTheEndSlow) {
  if (updating()) GTEST_SKIP() << "the other test rewrites all frames";
  expect_calm_and_unchanged(GetParam(), shipped(GetParam()), all_frames);
}

INSTANTIATE_TEST_SUITE_P(Shipped, GoldenScene, testing::ValuesIn(scene_names()),
                         [](const auto& tested) { return tested.param; });

}  // namespace souple::test::test_golden_golden
