#include "web/src/held_world.h"

#include "souple/error.h"
#include "souple/host/material_tunables.h"
#include "souple/objects/kind_traits.h"
#include "souple/scene/json.h"

#include <array>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/core.h>

namespace souple::web {

using scene_format::Json;

namespace {

/// States of the past take less memory than a browser gives.
constexpr std::size_t past_bytes = std::size_t{48} << 20;

Json number(double value) {
  return Json::of(value);
}

Json whole(std::size_t value) {
  return Json::whole(static_cast<std::int64_t>(value));
}

std::string source_of(const SceneDescription& scene) {
  return scene.source.empty() ? "the scene" : scene.source;
}

}  // namespace

HeldWorld::HeldWorld(SceneDescription scene, std::string name)
    : simulation_(std::move(scene), std::move(name)) {
  simulation_.limit_past(1);  // one state, which a simulation needs
}

void HeldWorld::keep_past() {
  simulation_.limit_past(past_bytes);
}

void HeldWorld::step(double dt) {
  if (dt == 0) {
    const bool playing = simulation_.playing();
    simulation_.step_frame();
    simulation_.set_playing(playing);
  } else {
    if (!(dt > 0)) throw Error("World.step: expected a time above 0 s");
    world().set_settings(simulation_.scene().settings);
    world().step(dt);
  }
  const StepReport& report = world().report();
  if (!report.ok()) throw Error(report.message);
}

void HeldWorld::reset() {
  release();
  simulation_.reset();
}

std::string HeldWorld::add(const std::string& object_json) {
  // The reader of scenes reads the object as the last one of the scene, which it may refer to.
  Json scene = scene_format::parse_json(simulation_.scene_text(), source_of(simulation_.scene()));
  Json object = scene_format::parse_json(object_json, "the object");
  if (!object.is(Json::Kind::object)) throw Error("World.add: expected an object as in a scene file");
  Json* objects = scene.find("objects");
  if (objects == nullptr) objects = &scene.set("objects", Json::array());
  objects->items.push_back(std::move(object));
  SceneDescription next =
      parse_scene(scene_format::dump_json(scene), simulation_.scene().folder, source_of(simulation_.scene()));
  return world().name(simulation_.add(std::move(next.objects.back())));
}

void HeldWorld::set(const std::string& setting) {
  const std::array<std::string, 1> overrides{setting};
  const SceneDescription next = parse_scene(simulation_.scene_text(), simulation_.scene().folder,
                                            source_of(simulation_.scene()), overrides);
  const std::string_view path = std::string_view(setting).substr(0, setting.find('='));
  for (std::size_t i = 0; i < next.objects.size(); ++i) {
    if (!path.starts_with("objects." + common(next.objects[i]).name + ".material")) continue;
    std::visit([&](const auto& object) { simulation_.set_material(i, object.material); }, next.objects[i]);
    return;
  }
  for (const std::string_view fixed : {"objects", "colliders", "pairs", "connections", "joints", "ties",
                                       "drains", "camera", "frames", "frame_rate", "description", "souple"})
    if (path.starts_with(fixed))
      throw Error(std::string(path) +
                  ": cannot change while the world runs; open the scene with this override");
  simulation_.set_settings(next.settings);
}

// --- the hand --------------------------------------------------------------------------------------

/// A ball of the radius `reach` finds ropes and grains that the ray misses.
Hit HeldWorld::hit_by(const host::Ray& ray, float reach) {
  const Hit hit = world().ray_cast(ray.origin, ray.direction);
  if ((hit.found && !hit.is_collider) || reach <= 0) return hit;
  QueryFilter filter;
  filter.colliders = false;
  return world().sphere_cast(ray.origin, reach, ray.direction, hit.found ? hit.distance : 1e30, filter);
}

bool HeldWorld::grab(const host::Ray& ray, float reach, const Vec3f& facing) {
  release();
  const Hit hit = hit_by(ray, reach);
  if (!hit.found || hit.is_collider) return false;
  auto grab = std::make_unique<Grab>(world(), hit.object, hit.vertex, hit.point);
  if (!grab->holds()) return false;
  grab_ = std::move(grab);
  plane_.emplace(hit.point, ray, facing);
  return true;
}

void HeldWorld::drag(const host::Ray& ray) {
  if (grabbing()) grab_->move_to(plane_->drag(ray));
}

void HeldWorld::release() {
  grab_.reset();
  plane_.reset();
}

// --- JSON ------------------------------------------------------------------------------------------

std::string HeldWorld::objects_text() {
  Json list = Json::array();
  for (const ObjectId id : world().objects()) {
    Json object = Json::object();
    object.set("id", Json::whole(id.value));
    object.set("name", Json::of(world().name(id)));
    object.set("kind", Json::of(std::string(kind_name(world().kind(id)))));
    object.set("vertices", whole(world().positions(id).size()));
    object.set("triangles", whole(world().triangles(id).size()));
    object.set("radius", number(static_cast<double>(world().particle_radius(id))));
    list.items.push_back(std::move(object));
  }
  return scene_format::dump_line(list);
}

std::string HeldWorld::report_text() {
  const StepReport& report = world().report();
  Json stages = Json::object();
  for (std::size_t i = 0; i < stage_count; ++i)
    stages.set(std::string(stage_name(static_cast<Stage>(i))), number(report.milliseconds[i]));
  Json text = Json::object();
  text.set("time", number(world().time()));
  text.set("outcome", Json::of(std::string(outcome_name(report.outcome))));
  text.set("step", Json::whole(static_cast<std::int64_t>(report.step)));
  text.set("milliseconds", number(report.total_milliseconds()));
  text.set("stages", std::move(stages));
  text.set("particles", whole(report.particles));
  text.set("constraints", whole(report.constraints));
  text.set("contacts", whole(report.contacts));
  text.set("asleep", whole(report.asleep));
  text.set("deepestContact", number(report.deepest_contact));
  text.set("largestStrain", number(report.largest_strain));
  text.set("warnings", Json::of(report.message));
  if (simulation_.failure())
    text.set("failure", Json::of(simulation_.failure()->message));
  else if (!report.ok())
    text.set("failure", Json::of(report.message));
  return scene_format::dump_line(text);
}

std::string HeldWorld::tunables_text(std::size_t object) {
  const std::size_t objects = simulation_.scene().objects.size();
  if (object >= objects)
    throw Error(fmt::format("World.tunables: the scene has {} objects, found the place {}", objects, object));
  Json list = Json::array();
  const bool pbd = simulation_.scene().settings.mode == Mode::pbd;
  const auto add = [&](const auto& description) {
    const auto& material = description.material;
    for (const auto& tunable : host::tunables(material)) {
      if (!host::is_used(tunable, material, pbd)) continue;
      Json entry = Json::object();
      entry.set("label", Json::of(tunable.label));
      entry.set("name", Json::of(tunable.name));
      entry.set("unit", Json::of(tunable.unit));
      entry.set("value", Json::of(material.*tunable.field));
      entry.set("least", Json::of(tunable.range.least));
      entry.set("most", Json::of(tunable.range.most));
      entry.set("logarithmic", Json::of(tunable.range.logarithmic));
      list.items.push_back(std::move(entry));
    }
  };
  std::visit(add, simulation_.scene().objects[object]);
  return scene_format::dump_line(list);
}

}  // namespace souple::web
