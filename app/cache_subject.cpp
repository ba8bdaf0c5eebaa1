#include "app/cache_subject.h"

#include "app/scene_colors.h"
#include "souple/error.h"
#include "souple/io/recorded_foam.h"
#include "souple/objects/kind_traits.h"

#include <string_view>
#include <utility>

namespace souple::app {

namespace {

std::optional<SceneDescription> embedded_scene(const RunManifest& manifest,
                                               const std::filesystem::path& path) {
  if (manifest.scene.empty()) return std::nullopt;
  return parse_recorded_scene(manifest.scene, path.string() + ": embedded scene");
}

/// Whether the collider's mesh file, if it has one, can still be read.
bool can_be_shown(const ColliderDescription& collider) {
  const auto* field = std::get_if<SignedDistanceFieldDescription>(&collider.shape);
  const auto* mesh = field ? std::get_if<FileMesh>(&field->mesh.source) : nullptr;
  return !mesh || std::filesystem::exists(mesh->file);
}

/// A world with the scene's colliders alone, to draw. A distance field is drawn as its mesh, so the coarsest
/// field suffices.
World collider_world(const std::optional<SceneDescription>& scene) {
  SceneDescription colliders;
  if (scene) {
    colliders.source = scene->source;
    for (ColliderDescription collider : scene->colliders) {
      if (!can_be_shown(collider)) continue;
      if (auto* field = std::get_if<SignedDistanceFieldDescription>(&collider.shape))
        field->spacing.reset(), field->resolution = 4;
      colliders.colliders.push_back(std::move(collider));
    }
  }
  return build_world(colliders);
}

}  // namespace

CacheSubject::CacheSubject(const std::filesystem::path& path)
    : playback_(path),
      scene_(embedded_scene(playback_.manifest(), path)),
      collider_world_(collider_world(scene_)) {
  velocities_.resize(playback_.objects().size());
}

const render::Subject& CacheSubject::read(std::uint64_t frame, bool velocities) {
  for (std::vector<Vec3f>& of_object : velocities_) of_object.clear();
  if (velocities && frame > 1) {
    playback_.read(frame - 1);
    find_velocities(frame);
  } else {
    playback_.read(frame);
  }
  subject_.frame = frame;
  describe_bodies();
  const double time = playback_.time(frame);
  subject_.colliders.clear();
  for (const ColliderId collider : collider_world_.colliders()) {
    const ColliderOptions& options = collider_world_.collider_options(collider);
    render::ColliderBody body{collider.value, options.name, &collider_world_.shape(collider),
                              options.motion.at(time)};
    if (!options.motion.is_static()) body.motion = &options.motion;
    body.time = time;
    subject_.colliders.push_back(body);
  }
  if (scene_) add_colors(*scene_, subject_);
  return subject_;
}

void CacheSubject::find_velocities(std::uint64_t frame) {
  for (std::size_t i = 0; i < velocities_.size(); ++i) velocities_[i] = playback_.objects()[i].positions;
  playback_.read(frame);
  const auto rate = static_cast<float>(1 / (playback_.time(frame) - playback_.time(frame - 1)));
  for (std::size_t i = 0; i < velocities_.size(); ++i) {
    const std::vector<Vec3f>& now = playback_.objects()[i].positions;
    if (now.size() != velocities_[i].size()) {  // the object appeared or vanished between the frames
      velocities_[i].clear();
      continue;
    }
    for (std::size_t v = 0; v < now.size(); ++v) velocities_[i][v] = (now[v] - velocities_[i][v]) * rate;
  }
}

void CacheSubject::describe_bodies() {
  std::vector<std::size_t> shape;
  for (const Playback::Object& object : playback_.objects()) {
    if (object.kind == foam_kind_name) continue;
    shape.push_back(object.positions.size());
    shape.push_back(object.triangles.size());
  }
  if (shape != shape_) ++subject_.topology;  // an object appeared, vanished or changed its mesh
  shape_ = std::move(shape);
  subject_.bodies.clear();
  for (std::size_t i = 0; i < playback_.objects().size(); ++i) {
    const Playback::Object& object = playback_.objects()[i];
    if (object.positions.empty() || object.kind == foam_kind_name) continue;
    render::Body body;
    body.id = static_cast<std::uint32_t>(i + 1);
    body.name = object.name;
    body.kind = find_kind(object.kind).value_or(ObjectKind::grains);
    body.positions = object.positions;
    body.normals = object.normals;
    body.velocities = velocities_[i];
    body.triangles = object.triangles;
    if (!object.triangles.empty()) body.rest = object.rest;
    if (scene_) {
      for (const AnyObjectDescription& description : scene_->objects) {
        if (common(description).name != object.name) continue;
        body.radius =
            std::visit([](const auto& kind) { return particle_radius(kind.material); }, description);
        if (const auto* fluid = std::get_if<FluidDescription>(&description))
          body.density = fluid->material.density;
      }
    }
    subject_.bodies.push_back(body);
  }
  for (const Playback::Object& object : playback_.objects())
    if (object.kind == foam_kind_name) render::show_foam(subject_, object.positions);
}

}  // namespace souple::app
