#include "app/view/simulation.h"

#include "app/check_pictures.h"
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
    : Session(std::move(name)), scene_(std::move(scene)), world_(build_world(scene_)) {
  app::check_pictures(scene_);
  start();
}

/// Without the objects that were thrown.
void Simulation::forget_thrown(SceneDescription& scene) const {
  const auto was_thrown = [&](const AnyObjectDescription& object) {
    return thrown_.count(common(object).name) > 0;
  };
  scene.objects.erase(std::remove_if(scene.objects.begin(), scene.objects.end(), was_thrown),
                      scene.objects.end());
}

void Simulation::start() {
  past_.clear();
  setup_.reset();
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
  if (!past_.shown() && past_.is_due()) keep_state();
  past_.move_on();
  Settings settings = scene_.settings;
  settings.substeps = substeps;
  world_.set_settings(settings);
  failure_.reset();
  const StepReport& report = world_.step(dt);
  if (!report.ok()) record_failure();
  if (report.outcome == StepOutcome::refused) return;
  past_.count_step();
  ++steps_;
  history_.push_back(report.milliseconds);
  if (history_.size() > history_length) history_.pop_front();
}

void Simulation::record_failure() {
  const StepReport& report = world_.report();
  playing_ = false;
  failure_.emplace();
  failure_->message = report.message;
  if (report.outcome != StepOutcome::diverged) return;
  Failure& failure = *failure_;
  failure.object = report.bad_object;
  failure.vertex = report.bad_vertex;
  const std::span<const Vec3f> positions = world_.positions(world_.find_object(report.bad_object));
  if (report.bad_vertex < positions.size()) failure.position = positions[report.bad_vertex];
  failure.message = fmt::format("object \"{}\", particle {} is no longer finite: {}", report.bad_object,
                                report.bad_vertex, advice(Flag::non_finite));
}

void Simulation::reset() {
  SceneDescription scene = scene_;
  forget_thrown(scene);
  world_ = build_world(scene);
  scene_ = std::move(scene);
  thrown_.clear();
  ++generation_;
  start();
}

void Simulation::set_playing(bool playing) {
  if (playing && !playing_) clock_.restart();
  playing_ = playing;
}

// --- the past ------------------------------------------------------------------------------------

void Simulation::keep_state() {
  PastState state{world_.time(), world_.snapshot(), {}};
  state.bytes = state.snapshot.bytes.size();
  if (!setup_) {
    setup_ = std::make_shared<const Setup>(Setup{scene_, thrown_, pinned_at_start_, edits_});
    state.bytes += bytes_of(*setup_);
  }
  state.setup = setup_;
  past_.add(std::move(state));
}

void Simulation::step_back() {
  set_playing(false);
  const std::size_t now = state();
  if (now > 0) return rewind(now - 1);
  if (past_.size() == 0 || past_.at(0).time == 0) throw Error("this is the start");
  throw Error(fmt::format("the viewer keeps no state before {:.4g} s: snapshots of {:.3g} s take {:.3g} MB",
                          past_.at(0).time, past_.at(past_.size() - 1).time - past_.at(0).time,
                          static_cast<double>(past_.bytes()) / 1e6));
}

void Simulation::rewind(std::size_t i) {
  set_playing(false);
  if (past_.shown() == i || (!past_.shown() && i >= past_.size())) return;
  if (!past_.shown()) {
    // The way forth to the present.
    const std::size_t before = past_.size();
    keep_state();
    i -= std::min(i, before + 1 - past_.size());  // dropped for it
  }
  const PastState& state = past_.at(i);
  set_setup(state.setup);
  world_.set_settings(scene_.settings);
  world_.restore(state.snapshot);
  past_.show(i);
  failure_.reset();
  ++steps_;
}

void Simulation::limit_past(std::size_t max_bytes) {
  past_ = Past(max_bytes);
}

/// Makes the world that the setup describes, except for its state.
void Simulation::set_setup(std::shared_ptr<const Setup> setup) {
  if (setup == setup_) return;
  if (!remove_later_objects(*setup)) {
    world_ = build_world(setup->scene);
    ++generation_;
  }
  scene_ = setup->scene;
  thrown_ = setup->thrown;
  pinned_at_start_ = setup->pinned_at_start;
  edits_ = setup->edits;
  setup_ = std::move(setup);
}

/// Where the setup lacks only objects that were added later, it is enough to remove these.
bool Simulation::remove_later_objects(const Setup& setup) {
  const auto same_name = [](const AnyObjectDescription& a, const AnyObjectDescription& b) {
    return common(a).name == common(b).name;
  };
  const std::vector<AnyObjectDescription>&before = setup.scene.objects, &now = scene_.objects;
  if (setup.edits != edits_ || before.size() > now.size() ||
      !std::equal(before.begin(), before.end(), now.begin(), same_name))
    return false;
  for (std::size_t i = before.size(); i < now.size(); ++i)
    world_.remove(world_.find_object(common(now[i]).name));
  return true;
}

/// `edited`: materials or pins; settings and new objects need no new world when they are taken back.
void Simulation::changed(bool edited) {
  past_.move_on();
  setup_.reset();
  if (edited) ++edits_;
  ++steps_;  // a radius is visible
}

// --- changes -------------------------------------------------------------------------------------

void Simulation::set_settings(const Settings& settings) {
  world_.set_settings(settings);
  changed(false);
  scene_.settings = settings;
}

ObjectId Simulation::add(AnyObjectDescription object, bool thrown) {
  ObjectDescription& shared = common(object);
  const std::string base = shared.name;
  const auto is_taken = [&](const std::string& name) {
    const auto has_name = [&](const AnyObjectDescription& other) { return common(other).name == name; };
    const auto is_called = [&](const ColliderDescription& other) { return other.name == name; };
    return std::any_of(scene_.objects.begin(), scene_.objects.end(), has_name) ||
           std::any_of(scene_.colliders.begin(), scene_.colliders.end(), is_called);
  };
  for (int number = 2; is_taken(shared.name); ++number) shared.name = fmt::format("{}{}", base, number);
  const std::string name = shared.name;

  scene_.objects.push_back(std::move(object));
  try {
    add_to_world(scene_, scene_.objects.size() - 1, world_);
  } catch (...) {
    scene_.objects.pop_back();
    throw;
  }
  changed(false);
  pinned_at_start_.emplace_back();
  if (thrown) thrown_.insert(name);
  return world_.find_object(name);
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
  changed(true);
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
  if (thrown_.empty()) return to_json(scene_);
  SceneDescription scene = scene_;
  forget_thrown(scene);
  return to_json(scene);
}

}  // namespace souple::viewer
