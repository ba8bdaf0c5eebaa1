#include "app/view/simulation.h"

#include "app/scene_colors.h"
#include "souple/error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/core.h>

namespace souple::viewer {

namespace {

// Limits of one frame of the viewer: number of steps, and time [s] after which no further step starts. Where
// drawing dominates, a frame has to make many steps.
constexpr int max_steps = 20;
constexpr double time_for_steps = 0.025;

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::vector<std::uint32_t> without(std::vector<std::uint32_t> vertices, std::uint32_t vertex) {
  vertices.erase(std::remove(vertices.begin(), vertices.end(), vertex), vertices.end());
  return vertices;
}

bool holds(const std::vector<std::uint32_t>& vertices, std::uint32_t vertex) {
  return std::find(vertices.begin(), vertices.end(), vertex) != vertices.end();
}

}  // namespace

Simulation::Simulation(const std::filesystem::path& scene)
    : Simulation(load_scene(scene), scene.stem().string()) {}

Simulation::Simulation(SceneDescription scene, std::string name)
    : name_(std::move(name)), scene_(std::move(scene)), world_(build_world(scene_)) {
  start();
}

void Simulation::start() {
  clock_.restart();
  history_.clear();
  failure_.reset();
  steps_ = 0;
  pinned_at_start_.clear();
  for (const AnyObjectDescription& any : scene_.objects) {
    const ObjectDescription& object = common(any);
    std::vector<std::vector<std::uint32_t>>& of_object = pinned_at_start_.emplace_back();
    for (const PinDescription& pin : object.pins) {
      of_object.push_back(world_.select(world_.find_object(object.name), pin.where));
    }
  }
}

std::uint64_t Simulation::frame() const {
  return static_cast<std::uint64_t>(std::floor(world_.time() * scene_.frame_rate + 1e-6));
}

render::Subject Simulation::subject() const {
  render::Subject subject = render::subject_of(world_, generation_);
  subject.frame = steps_;
  app::add_colors(scene_, subject);
  return subject;
}

std::optional<render::Camera> Simulation::camera() const {
  return camera_of(scene_.camera);
}

// --- time ----------------------------------------------------------------------------------------

void Simulation::advance(double seconds) {
  if (!playing_) return;
  const double dt = 1 / scene_.frame_rate;
  clock_.tick(seconds);
  const Stopwatch watch;
  for (int steps = 0; playing_ && clock_.consume(dt); ++steps) {
    step(dt, scene_.settings.substeps);
    if (steps + 1 >= max_steps || watch.seconds() > time_for_steps) clock_.drop();
  }
}

void Simulation::step_frame() {
  set_playing(false);
  step(1 / scene_.frame_rate, scene_.settings.substeps);
}

void Simulation::step_fine() {
  set_playing(false);
  step(1 / scene_.frame_rate / scene_.settings.substeps, 1);
}

void Simulation::step(double dt, int substeps) {
  Settings settings = scene_.settings;
  settings.substeps = substeps;
  world_.set_settings(settings);
  const StepReport& report = world_.step(dt);
  ++steps_;
  history_.push_back(report.milliseconds);
  if (history_.size() > history_length) history_.pop_front();
  if (!report.ok()) record_failure();
}

void Simulation::record_failure() {
  const StepReport& report = world_.report();
  playing_ = false;
  Failure failure;
  failure.object = report.bad_object;
  failure.vertex = report.bad_vertex;
  const std::span<const Vec3f> positions = world_.positions(world_.find_object(report.bad_object));
  if (report.bad_vertex < positions.size()) failure.position = positions[report.bad_vertex];
  failure.message = fmt::format("object \"{}\", particle {} is no longer finite: {}", report.bad_object,
                                report.bad_vertex, advice(Flag::non_finite));
  failure_ = std::move(failure);
}

void Simulation::reset() {
  world_ = build_world(scene_);
  ++generation_;
  start();
}

void Simulation::set_playing(bool playing) {
  if (playing && !playing_) clock_.restart();
  playing_ = playing;
}

// --- changes -------------------------------------------------------------------------------------

void Simulation::set_settings(const Settings& settings) {
  world_.set_settings(settings);
  scene_.settings = settings;
}

template <class Description, class Material>
void Simulation::change_material(std::size_t object, const Material& material) {
  auto& description = std::get<Description>(scene_.objects.at(object));
  world_.set_material(world_.find_object(description.name), material);
  description.material = material;
  ++steps_;  // a radius is visible
}

void Simulation::set_material(std::size_t object, const MaterialDescription<ClothMaterial>& material) {
  change_material<ClothDescription>(object, material);
}
void Simulation::set_material(std::size_t object, const MaterialDescription<SoftBodyMaterial>& material) {
  change_material<SoftBodyDescription>(object, material);
}
void Simulation::set_material(std::size_t object, const MaterialDescription<RopeMaterial>& material) {
  change_material<RopeDescription>(object, material);
}
void Simulation::set_material(std::size_t object, const MaterialDescription<GrainsMaterial>& material) {
  change_material<GrainsDescription>(object, material);
}
void Simulation::set_material(std::size_t object, const MaterialDescription<FluidMaterial>& material) {
  change_material<FluidDescription>(object, material);
}
void Simulation::set_material(std::size_t object, const ObstacleMaterial& material) {
  change_material<ObstacleDescription>(object, material);
}

std::size_t Simulation::index_of(ObjectId object) const {
  const std::string& wanted = world_.name(object);
  for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
    if (common(scene_.objects[i]).name == wanted) return i;
  }
  throw Error(wanted + ": not an object of the scene");
}

bool Simulation::is_pinned(ObjectId object, std::uint32_t vertex) const {
  return holds(world_.pinned(object), vertex);
}

bool Simulation::toggle_pin(ObjectId object, std::uint32_t vertex) {
  const std::size_t index = index_of(object);
  ++steps_;
  if (is_pinned(object, vertex)) {
    world_.unpin(object, vertices({vertex}));
    remove_from_pins(index, vertex);
    return false;
  }
  world_.pin(object, vertices({vertex}));
  PinDescription pin;
  pin.where = vertices({vertex});
  common(scene_.objects[index]).pins.push_back(std::move(pin));
  pinned_at_start_[index].push_back({vertex});
  return true;
}

/// Removes a vertex from the scene's pins. A pin of several vertices keeps the others, listed one by one.
void Simulation::remove_from_pins(std::size_t object, std::uint32_t vertex) {
  std::vector<PinDescription>& pins = common(scene_.objects[object]).pins;
  std::vector<std::vector<std::uint32_t>>& pinned = pinned_at_start_[object];
  for (std::size_t i = pins.size(); i-- > 0;) {
    if (!holds(pinned[i], vertex)) continue;
    pinned[i] = without(pinned[i], vertex);
    pins[i].where = vertices(pinned[i]);
    if (!pinned[i].empty()) continue;
    pins.erase(pins.begin() + static_cast<std::ptrdiff_t>(i));
    pinned.erase(pinned.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void Simulation::set_camera(const render::Camera& camera) {
  scene_.camera = {Vec3d(camera.from), Vec3d(camera.to), static_cast<double>(camera.fov)};
}

std::string Simulation::scene_text() const {
  return to_json(scene_);
}

}  // namespace souple::viewer
