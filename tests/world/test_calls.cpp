#include "souple/solver/custom_constraint.h"
#include "tests/expect_error.h"
#include "tests/paths.h"
#include "tests/world/scene.h"

#include <atomic>
#include <fstream>
#include <functional>
#include <memory>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Every function of World, called from every function that a world calls, with valid, stale and moved-from handles. Meant
// for the sanitizers: a release build runs it too and sees what is refused.

namespace souple::test_world_calls {

/// Handles with which a world's functions are called.
struct Handles {
  ObjectId cloth, grains, fluid, obstacle, rigid_body, closed, kinematic;
  ColliderId collider;
  EmitterId emitter;
  DrainId drain;
  ProjectorId projector;
  CallbackId callback;
  ForceFieldId field;
  JointId joint;
  TieId tie;
};

/// Handles that no object of a world has.
Handles stale() {
  constexpr std::uint32_t gone = 0x7ffffffe;
  return {{gone}, {gone}, {gone}, {gone}, {gone}, {gone}, {gone}, {gone},
          {gone}, {gone}, {gone}, {gone}, {gone}, {gone}, {gone}};
}

/// Lines of the table in world.h.
enum class Line { reads, queries, reads_results, stages, nowhere, step };

struct Function {
  const char* name;
  Line line;
  std::function<void(World&, const Handles&)> call;
};

std::vector<Vec3f> some(const World& world, ObjectId id) {
  return std::vector<Vec3f>(world.positions(id).begin(), world.positions(id).end());
}

TriangleMesh closed_mesh() {
  return sphere(1, 0.2);
}

Transform at(const Vec3d& translation) {
  return {translation, {}, 1};
}

DebugDraw drawing_constraints(std::function<void()> draw) {
  DebugDraw result;
  result.constraint = [draw = std::move(draw)](const DebugConstraint&) { draw(); };
  return result;
}

void nothing(World&) {}

/// Every declaration of world.h, overloads one by one; EveryFunctionIsListed compares.
const std::vector<Function>& functions() {
  using W = World&;
  using H = const Handles&;
  const auto no_force = [](const ForcePoint&) { return Vec3f{}; };
  static const std::vector<Function> all = {
      {"step", Line::step, [](W w, H) { w.step(0.01); }},
      {"report", Line::reads, [](W w, H) { (void)w.report(); }},
      {"prepare", Line::nowhere, [](W w, H) { w.prepare(); }},
      {"time", Line::reads, [](W w, H) { (void)w.time(); }},
      {"settings", Line::reads, [](W w, H) { (void)w.settings(); }},
      {"set_settings", Line::nowhere, [](W w, H) { w.set_settings({}); }},
      {"set_job_system", Line::nowhere, [](W w, H) { w.set_job_system(nullptr); }},
      {"before", Line::stages, [](W w, H) { w.before(Stage::solve, nothing); }},
      {"after", Line::stages, [](W w, H) { w.after(Stage::solve, nothing); }},
      {"remove", Line::stages, [](W w, H h) { w.remove(h.callback); }},
      {"add_cloth", Line::nowhere, [](W w, H) { w.add_cloth(grid(2, 2, 1)); }},
      {"add_soft_body", Line::nowhere, [](W w, H) { w.add_soft_body(tet_bar(1, 1, 1, {1, 1, 1})); }},
      {"add_soft_body", Line::nowhere,
       [](W w, H) { w.add_soft_body(closed_mesh(), SoftBodyMaterial{}, LatticeOptions{}); }},
      {"add_rope", Line::nowhere, [](W w, H) { w.add_rope(std::vector<Vec3d>{{9, 0, 0}, {9, 1, 0}}, 2); }},
      {"add_grains", Line::nowhere, [](W w, H) { w.add_grains(std::vector<Vec3d>{{9, 9, 9}}); }},
      {"add_fluid", Line::nowhere,
       [](W w, H h) { w.add_fluid(std::vector<Vec3d>{{7, 7, 7}}, w.fluid_material(h.fluid)); }},
      {"add_fluid", Line::nowhere,
       [](W w, H h) { w.add_fluid(closed_mesh(), w.fluid_material(h.fluid), {.transform = at({5, 5, 5})}); }},
      {"add_obstacle", Line::nowhere, [](W w, H) { w.add_obstacle(closed_mesh()); }},
      {"add_rigid_body", Line::nowhere, [](W w, H) { w.add_rigid_body(closed_mesh()); }},
      {"add_rigid_body", Line::nowhere, [](W w, H) { w.add_rigid_body(Sphere{}); }},
      {"remove", Line::nowhere, [](W w, H h) { w.remove(h.cloth); }},
      {"add_joint", Line::nowhere,
       [](W w, H h) { w.add_joint({}, h.rigid_body, joint::Hinge{}, {.point = {1, 0, 0}}); }},
      {"add_joint", Line::nowhere, [](W w, H h) { w.add_joint({}, h.rigid_body, joint::Hinge{}); }},
      {"remove", Line::nowhere, [](W w, H h) { w.remove(h.joint); }},
      {"set_joint", Line::stages, [](W w, H h) { w.set_joint(h.joint, joint::Ball{.damping = 1}); }},
      {"joint_kind", Line::reads, [](W w, H h) { (void)w.joint_kind(h.joint); }},
      {"joint_report", Line::queries, [](W w, H h) { (void)w.joint_report(h.joint); }},
      {"joints", Line::reads, [](W w, H) { (void)w.joints(); }},
      {"find_joint", Line::reads, [](W w, H) { (void)w.find_joint("ball"); }},
      {"add_tie", Line::nowhere,
       [](W w, H h) { w.add_tie(h.grains, h.rigid_body, {.point = {0, 1, 0}}); }},
      {"stitch", Line::nowhere, [](W w, H h) { w.stitch(h.cloth, vertices({0}), h.rigid_body, 100, {}); }},
      {"remove", Line::nowhere, [](W w, H h) { w.remove(h.tie); }},
      {"tie_report", Line::queries, [](W w, H h) { (void)w.tie_report(h.tie); }},
      {"ties", Line::reads, [](W w, H) { (void)w.ties(); }},
      {"surface_point", Line::reads, [](W w, H h) { (void)w.surface_point(h.cloth, {}); }},
      {"objects", Line::reads, [](W w, H) { (void)w.objects(); }},
      {"contains", Line::reads, [](W w, H h) { (void)w.contains(h.cloth); }},
      {"find_object", Line::reads, [](W w, H) { (void)w.find_object("cloth"); }},
      {"name", Line::reads, [](W w, H h) { (void)w.name(h.cloth); }},
      {"kind", Line::reads, [](W w, H h) { (void)w.kind(h.cloth); }},
      {"set_material", Line::nowhere, [](W w, H h) { w.set_material(h.cloth, ClothMaterial{}); }},
      {"material", Line::reads, [](W w, H h) { (void)w.material(h.cloth); }},
      {"cloth_material", Line::reads, [](W w, H h) { (void)w.cloth_material(h.cloth); }},
      {"soft_body_material", Line::reads,
       [](W w, H h) { w.contains(h.cloth) ? (void)0 : (void)w.soft_body_material(h.cloth); }},
      {"rope_material", Line::reads,
       [](W w, H h) { w.contains(h.cloth) ? (void)0 : (void)w.rope_material(h.cloth); }},
      {"grains_material", Line::reads, [](W w, H h) { (void)w.grains_material(h.grains); }},
      {"obstacle_material", Line::reads, [](W w, H h) { (void)w.obstacle_material(h.obstacle); }},
      {"add_rigid_body", Line::nowhere,
       [](W w, H) { w.add_rigid_body(std::vector<RigidPart>{{Sphere{}, {}, {}}}); }},
      {"set_kinematic", Line::nowhere, [](W w, H h) { w.set_kinematic(h.rigid_body, false); }},
      {"is_kinematic", Line::reads, [](W w, H h) { (void)w.is_kinematic(h.rigid_body); }},
      {"move_body", Line::nowhere, [](W w, H h) { w.move_body(h.kinematic, at({0, 9, 0})); }},
      {"set_body_velocity", Line::stages, [](W w, H h) { w.set_body_velocity(h.rigid_body, {}, {}); }},
      {"rigid_body", Line::reads, [](W w, H h) { (void)w.rigid_body(h.rigid_body); }},
      {"rigid_body_material", Line::reads, [](W w, H h) { (void)w.rigid_body_material(h.rigid_body); }},
      {"fluid_material", Line::reads, [](W w, H h) { (void)w.fluid_material(h.fluid); }},
      {"set_collision_groups", Line::nowhere, [](W w, H h) { w.set_collision_groups(h.cloth, 3); }},
      {"collision_groups", Line::reads, [](W w, H h) { (void)w.collision_groups(h.cloth); }},
      {"collision_mask", Line::reads, [](W w, H h) { (void)w.collision_mask(h.cloth); }},
      {"self_collision", Line::reads, [](W w, H h) { (void)w.self_collision(h.cloth); }},
      {"set_layer", Line::nowhere, [](W w, H h) { w.set_layer(h.cloth, 1); }},
      {"layer", Line::reads, [](W w, H h) { (void)w.layer(h.cloth); }},
      {"set_motion", Line::nowhere, [](W w, H h) { w.set_motion(h.obstacle, {}); }},
      {"motion", Line::reads, [](W w, H h) { (void)w.motion(h.obstacle); }},
      {"positions", Line::reads, [](W w, H h) { (void)w.positions(h.cloth); }},
      {"velocities", Line::reads, [](W w, H h) { (void)w.velocities(h.cloth); }},
      {"angular_velocities", Line::reads, [](W w, H h) { (void)w.angular_velocities(h.grains); }},
      {"normals", Line::reads, [](W w, H h) { (void)w.normals(h.cloth); }},
      {"triangles", Line::reads, [](W w, H h) { (void)w.triangles(h.cloth); }},
      {"mesh", Line::reads, [](W w, H h) { (void)w.mesh(h.cloth); }},
      {"total_mass", Line::reads, [](W w, H h) { (void)w.total_mass(h.cloth); }},
      {"tet_statistics", Line::reads, [](W w, H h) { (void)w.tet_statistics(h.cloth); }},
      {"pressures", Line::reads_results, [](W w, H h) { (void)w.pressures(h.fluid); }},
      {"foam", Line::reads_results, [](W w, H) { (void)w.foam(); }},
      {"particle_radius", Line::reads, [](W w, H h) { (void)w.particle_radius(h.cloth); }},
      {"set_positions", Line::stages, [](W w, H h) { w.set_positions(h.cloth, some(w, h.cloth)); }},
      {"set_velocities", Line::stages,
       [](W w, H h) { w.set_velocities(h.cloth, std::vector<Vec3f>(some(w, h.cloth).size())); }},
      {"set_angular_velocities", Line::stages,
       [](W w, H h) { w.set_angular_velocities(h.grains, std::vector<Vec3f>(some(w, h.grains).size())); }},
      {"teleport", Line::stages, [](W w, H h) { w.teleport(h.cloth, at({0, 0.01, 0})); }},
      {"apply_impulse", Line::stages, [](W w, H h) { w.apply_impulse(h.cloth, vertices({1}), {}); }},
      {"apply_impulse", Line::stages, [](W w, H h) { w.apply_impulse(h.rigid_body, Vec3f{}, Vec3f{}); }},
      {"apply_angular_impulse", Line::stages,
       [](W w, H h) { w.apply_angular_impulse(h.rigid_body, Vec3f{}); }},
      {"select", Line::reads, [](W w, H h) { (void)w.select(h.cloth, vertices({1})); }},
      {"pin", Line::stages, [](W w, H h) { w.pin(h.cloth, vertices({2})); }},
      {"unpin", Line::stages, [](W w, H h) { w.unpin(h.cloth, vertices({2, 3})); }},
      {"pinned", Line::reads, [](W w, H h) { (void)w.pinned(h.cloth); }},
      {"move_pins", Line::nowhere, [](W w, H h) { w.move_pins(h.cloth, vertices({0}), Transform{}); }},
      {"move_pins", Line::nowhere,
       [](W w, H h) {
         w.move_pins(h.cloth, std::vector<std::uint32_t>{0}, std::vector<Vec3f>{{0, 1, 0}});
       }},
      {"attach", Line::nowhere, [](W w, H h) { w.attach(h.cloth, vertices({1})); }},
      {"connect", Line::nowhere,
       [](W w, H h) {
         w.connect(std::vector<std::pair<VertexRef, VertexRef>>{{{h.cloth, 4}, {h.closed, 0}}}, -1);
       }},
      {"add_tethers", Line::nowhere, [](W w, H h) { w.add_tethers(h.cloth); }},
      {"set_pressure", Line::nowhere, [](W w, H h) { w.set_pressure(h.closed, 1); }},
      {"set_enclosed_volume", Line::nowhere, [](W w, H h) { w.set_enclosed_volume(h.closed, 1); }},
      {"add_projector", Line::nowhere, [](W w, H) { w.add_projector(std::make_unique<CustomProjector>()); }},
      {"remove", Line::nowhere, [](W w, H h) { w.remove(h.projector); }},
      {"projector", Line::nowhere, [](W w, H h) { (void)w.projector(h.projector); }},
      {"particle", Line::reads, [](W w, H h) { (void)w.particle(h.cloth, 1); }},
      {"carriers", Line::reads, [](W w, H h) { (void)w.carriers(h.cloth, 1); }},
      {"add_collider", Line::nowhere, [](W w, H) { w.add_collider(Sphere{}, {.motion = ColliderMotion::fixed(at({9, 9, 9}))}); }},
      {"remove", Line::nowhere, [](W w, H h) { w.remove(h.collider); }},
      {"set_collider", Line::nowhere, [](W w, H h) { w.set_collider(h.collider, Sphere{}, {}); }},
      {"move_collider", Line::nowhere, [](W w, H h) { w.move_collider(h.collider, at({0, -5, 0})); }},
      {"colliders", Line::reads, [](W w, H) { (void)w.colliders(); }},
      {"shape", Line::reads, [](W w, H h) { (void)w.shape(h.collider); }},
      {"collider_options", Line::reads, [](W w, H h) { (void)w.collider_options(h.collider); }},
      {"collider_pose", Line::queries, [](W w, H h) { (void)w.collider_pose(h.collider); }},
      {"find_collider", Line::reads, [](W w, H) { (void)w.find_collider("collider"); }},
      {"add_emitter", Line::nowhere, [](W w, H h) { w.add_emitter(h.fluid, {}); }},
      {"set_emitter", Line::nowhere, [](W w, H h) { w.set_emitter(h.emitter, {}); }},
      {"remove", Line::nowhere, [](W w, H h) { w.remove(h.emitter); }},
      {"add_drain", Line::nowhere, [](W w, H) { w.add_drain({.shape = Sphere{.radius = 0.1f}, .pose = at({0, -9, 0})}); }},
      {"remove", Line::nowhere, [](W w, H h) { w.remove(h.drain); }},
      {"leave_out_covered", Line::nowhere, [](W w, H) { w.leave_out_covered(); }},
      {"fluid_force", Line::reads_results, [](W w, H h) { (void)w.fluid_force(h.collider); }},
      {"set_pair", Line::nowhere, [](W w, H) { w.set_pair("cloth", "collider", 0.5f, 0); }},
      {"set_collide", Line::nowhere, [](W w, H) { w.set_collide("cloth", "collider", false); }},
      {"add_force_field", Line::stages,
       [](W w, H) {
         w.add_force_field([](const Vec3f&, const Vec3f&, float, double) { return Vec3f{}; });
       }},
      {"add_force_field", Line::stages, [no_force](W w, H) { w.add_force_field(no_force); }},
      {"remove", Line::stages, [](W w, H h) { w.remove(h.field); }},
      {"clear_force_fields", Line::stages, [](W w, H) { w.clear_force_fields(); }},
      {"contacts", Line::reads_results, [](W w, H) { (void)w.contacts(); }},
      {"track_contacts", Line::nowhere, [](W w, H) { w.track_contacts(true); }},
      {"contact_pairs", Line::reads, [](W w, H) { (void)w.contact_pairs(); }},
      {"set_user_data", Line::stages, [](W w, H h) { w.set_user_data(h.cloth, 7); }},
      {"set_user_data", Line::stages, [](W w, H h) { w.set_user_data(h.collider, 7); }},
      {"user_data", Line::reads, [](W w, H h) { (void)w.user_data(h.cloth); }},
      {"user_data", Line::reads, [](W w, H h) { (void)w.user_data(h.collider); }},
      {"set_wind", Line::nowhere, [](W w, H) { w.set_wind({.velocity = {1, 0, 0}}); }},
      {"set_wind_exposure", Line::stages, [](W w, H h) { w.set_wind_exposure(h.cloth, 0.5f); }},
      {"wind_exposure", Line::reads, [](W w, H h) { (void)w.wind_exposure(h.cloth); }},
      {"set_log", Line::stages, [](W w, H) { w.set_log({}); }},
      {"is_asleep", Line::reads, [](W w, H h) { (void)w.is_asleep(h.cloth); }},
      {"wake", Line::stages, [](W w, H h) { w.wake(h.cloth); }},
      {"ray_cast", Line::queries, [](W w, H) { (void)w.ray_cast({0, 5, 0}, {0, -1, 0}); }},
      {"ray_cast_all", Line::queries, [](W w, H) { (void)w.ray_cast_all({0, 5, 0}, {0, -1, 0}); }},
      {"sphere_cast", Line::queries, [](W w, H) { (void)w.sphere_cast({0, 5, 0}, 0.1f, {0, -1, 0}); }},
      {"closest_point", Line::queries, [](W w, H) { (void)w.closest_point({0, 5, 0}); }},
      {"overlap", Line::queries, [](W w, H) { (void)w.overlap(Sphere{}); }},
      {"count_crossings", Line::reads, [](W w, H h) { (void)w.count_crossings(h.cloth); }},
      {"kinetic_energy", Line::reads, [](W w, H h) { (void)w.kinetic_energy(h.cloth); }},
      {"potential_energy", Line::reads, [](W w, H h) { (void)w.potential_energy(h.cloth); }},
      {"elastic_energy", Line::reads_results, [](W w, H) { (void)w.elastic_energy(); }},
      {"unconverged_energy", Line::reads_results, [](W w, H) { (void)w.unconverged_energy(0.01); }},
      {"momentum", Line::reads, [](W w, H h) { (void)w.momentum(h.cloth); }},
      {"center_of_mass", Line::reads, [](W w, H h) { (void)w.center_of_mass(h.cloth); }},
      {"debug_draw", Line::reads_results,
       [](W w, H) {
         w.debug_draw({.constraint = [](const DebugConstraint&) {},
                       .contact = [](const DebugContact&) {},
                       .particle = [](const DebugParticle&) {},
                       .joint = [](const DebugJoint&) {},
                       .tet_edge = [](const Vec3f&, const Vec3f&) {}});
       }},
      {"snapshot", Line::reads_results, [](W w, H) { (void)w.snapshot(); }},
      {"restore", Line::nowhere, [](W w, H) { w.restore(w.snapshot()); }},
      {"hash", Line::reads, [](W w, H) { (void)w.hash(); }},
      {"version", Line::reads, [](W w, H) { (void)w.version(); }},
      {"time_projections", Line::nowhere, [](W w, H) { (void)w.time_projections(0.01, 1); }},
      {"time_solve", Line::nowhere, [](W w, H) { (void)w.time_solve(0.01, 1); }},
      {"memory", Line::reads_results, [](W w, H) { (void)w.memory(); }},
  };
  return all;
}

/// The names of the public functions that world.h declares, each as often as it is declared.
std::multiset<std::string> declared_functions() {
  std::ifstream file(source_path("souple/world/world.h"));
  std::stringstream text;
  text << file.rdbuf();
  std::string code = std::regex_replace(text.str(), std::regex("//[^\n]*"), "");
  code = code.substr(code.find("class World {"));
  code = code.substr(0, code.find(" private:"));
  code = code.substr(code.find("World& operator=(World&&) noexcept;"));
  std::multiset<std::string> names;
  const std::regex declaration(R"(([a-z_]+)\([^;]*\)( const)?;)");
  for (std::sregex_iterator it(code.begin(), code.end(), declaration), end; it != end; ++it)
    if ((*it)[1] != "operator") names.insert((*it)[1]);
  return names;
}

/// Calls a function; returns what it refused, empty if it did not. Other exceptions than Error fail.
std::string refused(const Function& function, World& world, const Handles& handles) {
  try {
    function.call(world, handles);
  } catch (const Error& error) {
    EXPECT_GT(std::string(error.what()).size(), 10u) << function.name;
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << function.name << " threw " << error.what();
  }
  return {};
}

/// A place from which a world calls the user.
enum class Place {
  nowhere,
  stage,
  field,
  pin,
  attachment,
  collider,
  obstacle,
  emitter,
  log,
  constraint,
  projector,
  jobs
};

/// A world that calls `meddle` from one place.
struct Meddled {
  explicit Meddled(Place from) : place(from) { build(); }
  Meddled(const Meddled&) = delete;
  Meddled& operator=(const Meddled&) = delete;
  ~Meddled() { armed = false; }

  void meddle(Place from) const {
    if (armed && place == from && action) action();
  }
  Transform motion(Place from) const {
    meddle(from);
    return at({0, -3, 0});
  }
  Target target(Place from) const {
    return [this, from](std::uint32_t, double) {
      meddle(from);
      return Vec3d{0, 1, 0};
    };
  }
  void build();

  const Place place;
  std::function<void()> action;
  std::atomic<bool> armed{false};
  std::unique_ptr<JobSystem> jobs;
  World world{{.substeps = 2}};
  Handles handles;
};

/// One constraint that moves nothing and meddles in each of its functions.
class MeddlingProjector final : public Projector {
 public:
  MeddlingProjector(const Meddled& meddled, std::uint32_t particle)
      : meddled_(meddled), particle_(particle) {}
  std::string_view kind() const override { return meddle(), "meddling"; }
  std::size_t size() const override { return meddle(), 1; }
  void prepare(std::size_t) override { meddle(); }
  int color_count() const override { return meddle(), 1; }
  std::size_t color_size(int) const override { return meddle(), 1; }
  void begin_substep(const ParticleView&, const Substep&) override { meddle(); }
  void project(int, std::size_t, std::size_t, const ParticleView&, const Substep&) override { meddle(); }
  Residual residual(const ParticleView&, Threads*) const override { return meddle(), Residual{}; }
  void visit(const ParticleView&, const ConstraintVisitor& visitor) const override {
    meddle();
    visitor({{&particle_, 1}});
  }
  void erase_particles(std::uint32_t, std::uint32_t) override { meddle(); }

 private:
  void meddle() const { meddled_.meddle(Place::projector); }
  const Meddled& meddled_;
  std::uint32_t particle_;
};

class MeddlingJobs final : public JobSystem {
 public:
  explicit MeddlingJobs(const Meddled& meddled) : meddled_(meddled) {}
  int workers() const override { return meddled_.meddle(Place::jobs), 2; }
  void run(std::size_t count, RangeFunction job) override {
    meddled_.meddle(Place::jobs);
    for (std::size_t i = 0; i < count; ++i) job(i, i + 1);
  }

 private:
  const Meddled& meddled_;
};

void Meddled::build() {
  handles.cloth = world.add_cloth(grid(3, 3, 1), {}, {.name = "cloth", .transform = at({0, 1, 0})});
  handles.closed = world.add_cloth(closed_mesh(), {}, {.transform = at({3, 1, 0})});
  handles.grains = world.add_grains(std::vector<Vec3d>{{-3, 1, 0}, {-3, 2, 0}});
  handles.fluid =
      world.add_fluid(std::vector<Vec3d>{{0, 1, 4}, {0, 1.1, 4}}, {.spacing = 0.1f}, {.max_particles = 500});
  ObstacleMotion motion_of_obstacle;
  motion_of_obstacle.pose = ColliderMotion::callback([this](double) { return motion(Place::obstacle); });
  ObjectOptions above{.transform = {.translation = {30, 30, 30}}};
  handles.rigid_body = world.add_rigid_body(Sphere{}, {}, above);
  handles.joint = world.add_joint({}, handles.rigid_body, joint::Ball{}, {.point = {30, 31, 30}});
  above.transform.translation = {60, 30, 30};
  handles.kinematic = world.add_rigid_body(Sphere{}, {}, above);
  world.set_kinematic(handles.kinematic, true);
  handles.obstacle = world.add_obstacle(closed_mesh(), {}, std::move(motion_of_obstacle));
  const auto motion_of_collider =
      ColliderMotion::callback([this](double) { return motion(Place::collider); });
  handles.collider = world.add_collider(Sphere{}, {.name = "collider", .motion = motion_of_collider});
  world.add_collider(Sphere{}, {.motion = motion_of_collider, .sensor = true});
  Emitter emitter{.position = {0, 5, 4}, .radius = 0.1f, .speed = 1};
  emitter.motion = ColliderMotion::callback([this](double) { return motion(Place::emitter); });
  handles.tie = world.add_tie(handles.grains, {}, {.point = {-3, 1, 0}});
  handles.emitter = world.add_emitter(handles.fluid, emitter);
  handles.drain = world.add_drain({.shape = Sphere{.radius = 0.1f}, .pose = at({0, -8, 0})});
  world.pin(handles.cloth, vertices({0}), target(Place::pin));
  world.attach(handles.cloth, vertices({8}), target(Place::attachment));
  auto custom = std::make_unique<CustomProjector>();
  custom->add(
      std::make_shared<CallbackConstraint>(std::vector<std::uint32_t>{world.particle(handles.cloth, 5)},
                                           [this](std::span<const Vec3f>, std::span<Vec3f> g) {
                                             meddle(Place::constraint);
                                             g[0] = {0, 1, 0};
                                             return 0.0f;
                                           }));
  world.add_projector(std::move(custom));
  handles.projector =
      world.add_projector(std::make_unique<MeddlingProjector>(*this, world.particle(handles.cloth, 6)));
  handles.field = world.add_force_field([this](const ForcePoint&) {
    meddle(Place::field);
    return Vec3f{};
  });
  handles.callback = world.before(Stage::solve, nothing);
  for (const Stage stage : {Stage::broad_phase, Stage::integrate, Stage::fluids, Stage::contacts,
                            Stage::solve, Stage::finish, Stage::velocity, Stage::foam}) {
    world.before(stage, [this](World&) { meddle(Place::stage); });
    world.after(stage, [this](World&) { meddle(Place::stage); });
  }
  world.set_log([this](LogLevel, std::string_view) { meddle(Place::log); });
  if (place == Place::jobs) world.set_job_system((jobs = std::make_unique<MeddlingJobs>(*this)).get());
  if (place == Place::log)
    world.add_force_field([](const ForcePoint&) -> Vec3f { throw std::runtime_error("x"); });
}

/// Makes the world call its user outside a step as well.
void use(World& world, const Handles& handles) {
  (void)world.ray_cast({0, 5, 0}, {0, -1, 0});
  (void)world.overlap(Sphere{});
  (void)world.elastic_energy();
  world.debug_draw(drawing_constraints([] {}));
  (void)world.memory();
  world.set_motion(handles.obstacle, ObstacleMotion(world.motion(handles.obstacle)));
  TriangleMesh odd = grid(3, 3, 1);
  std::swap(odd.triangles[2][0], odd.triangles[2][1]);
  (void)world.add_cloth(odd, {}, {.transform = at({20, 0, 0})});
  (void)world.time_solve(0.01, 1);
  world.add_projector(std::make_unique<CustomProjector>());
  world.remove(handles.grains);
}

class EachPlace : public testing::TestWithParam<Place> {};

// The first three times that the world calls the place, and then at every tenth, so that each part of a step is met.
TEST_P(EachPlace, CallsEveryFunctionWithoutHarm) {
  const Place place = GetParam();
  for (const bool valid : {true, false}) {
    Meddled meddled(place);
    World& world = meddled.world;
    const Handles handles = valid ? meddled.handles : stale();
    bool there = valid;  // what the handles mean
    int calls = 0, depth = 0;
    std::set<std::string> wrong;
    std::atomic<bool> busy{false};
    meddled.action = [&] {
      if (depth > 0) {  // a query asks a motion, which queries
        if (depth > 1) return;
        ++depth;
        for (const Function& function : functions())
          if (function.line == Line::queries || function.line == Line::nowhere)
            if (refused(function, world, handles).empty()) wrong.insert(function.name);
        --depth;
        return;
      }
      if (calls++ > 3 && calls % 10 != 0) return;
      if (busy.exchange(true)) return;
      ++depth;
      const bool is_stage = place == Place::stage;
      for (const Function& function : functions()) {
        const std::string words = refused(function, world, handles);
        const bool allowed = function.line == Line::reads || function.line == Line::queries ||
                             (is_stage && function.line != Line::nowhere);
        if (function.line == Line::step) continue;
        if (!allowed && words.empty()) wrong.insert(std::string(function.name) + " is accepted");
        // Handles of a callback are stale after the first removal; outside a step a motion may run within a query.
        if (allowed && there && !words.empty() && std::string(function.name) != "remove" &&
            function.line != Line::queries)
          wrong.insert(words);
      }
      --depth;
      busy = false;
    };
    meddled.armed = true;
    const StepReport& report = world.step(0.01);
    EXPECT_GT(calls, 0);
    EXPECT_NE(report.message.find("called step"), std::string::npos) << report.message;
    world.step(0.01);
    there = false;  // some are removed
    use(world, meddled.handles);
    world.step(0.01);
    EXPECT_NEAR(world.time(), 0.03, 1e-9);
    for (const std::string& words : wrong) ADD_FAILURE() << words;
  }
}

INSTANTIATE_TEST_SUITE_P(Calls, EachPlace,
                         testing::Values(Place::stage, Place::field, Place::pin, Place::attachment,
                                         Place::collider, Place::obstacle, Place::emitter, Place::log,
                                         Place::constraint, Place::projector, Place::jobs));

TEST(Calls, EveryFunctionIsListed) {
  std::multiset<std::string> listed;
  for (const Function& function : functions()) listed.insert(function.name);
  const std::multiset<std::string> declared = declared_functions();
  for (const std::string& name : declared)
    EXPECT_EQ(listed.count(name), declared.count(name)) << name << ": a function of world.h is missing here";
  EXPECT_EQ(listed.size(), declared.size());
}

// Each on a world of its own, which then makes a step.
TEST(Calls, EveryFunctionWorksOrRefusesBetweenSteps) {
  for (const Function& function : functions())
    for (const bool valid : {true, false}) {
      Meddled meddled(Place::nowhere);
      const std::string words = refused(function, meddled.world, valid ? meddled.handles : stale());
      if (valid) {
        EXPECT_EQ(words, "") << function.name;
      }
      EXPECT_TRUE(meddled.world.step(0.01).ok()) << function.name;
    }
}

TEST(Calls, EveryFunctionOfAMovedWorldRefuses) {
  Meddled meddled(Place::nowhere);
  const World taken = std::move(meddled.world);
  for (const Function& function : functions()) {
    if (function.line == Line::step) continue;
    EXPECT_NE(refused(function, meddled.world, meddled.handles), "") << function.name;
  }
  EXPECT_NE(meddled.world.step(0.01).message.find("moved from"), std::string::npos);
  meddled.world = World();
  EXPECT_TRUE(meddled.world.step(0.01).ok());
}

TEST(Calls, WhatDebugDrawCallsMayOnlyRead) {
  Meddled meddled(Place::nowhere);
  meddled.world.step(0.01);
  int calls = 0;
  const auto meddle = [&] {
    if (calls++ > 3) return;
    expect_error([&] { meddled.world.remove(meddled.handles.cloth); }, {"remove", "is calling"});
    meddled.world.positions(meddled.handles.cloth);
  };
  meddled.world.debug_draw(drawing_constraints(meddle));
  EXPECT_GT(calls, 0);
}

// A step never throws, and neither does adding an object whose mesh is repaired.
TEST(Calls, WhatTheLogThrowsIsReported) {
  World world;
  world.set_log([](LogLevel, std::string_view) { throw std::runtime_error("disk full"); });
  TriangleMesh odd = grid(3, 3, 1);
  std::swap(odd.triangles[2][0], odd.triangles[2][1]);
  world.add_cloth(odd);
  StepReport report = world.step(0.01);
  EXPECT_TRUE(report.has(Flag::callback_failed));
  EXPECT_NE(report.message.find("the log function threw: disk full"), std::string::npos) << report.message;
  EXPECT_FALSE(world.step(0.01).has(Flag::callback_failed));
  world.before(Stage::solve, [](World&) { throw std::runtime_error("stage trouble"); });
  report = world.step(0.01);
  EXPECT_NE(report.message.find("stage trouble"), std::string::npos) << report.message;
  EXPECT_NE(report.message.find("disk full"), std::string::npos) << report.message;
}

}  // namespace souple::test_world_calls
