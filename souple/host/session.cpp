#include "souple/host/session.h"

#include "souple/host/session/impl.h"
#include "souple/scene/nearest.h"
#include "souple/solver/solver_names.h"

#include <algorithm>
#include <utility>

namespace souple::host {

const char* kind_name(Kind kind) {
  switch (kind) {
    case Kind::cloth:
      return "cloth";
    case Kind::soft_body:
      return "soft_body";
    case Kind::rope:
      return "rope";
    case Kind::grains:
      return "grains";
    case Kind::obstacle:
      return "obstacle";
  }
  return "?";
}

Session::Session(const ClockOptions& clock) : impl_(std::make_unique<Impl>(clock)) {}
Session::~Session() = default;

// --- what is in it
// ---------------------------------------------------------------------------------------------------

void Session::open_scene(const std::string& file) {
  const std::uint64_t version_now = version();
  impl_->contents.open(file);
  impl_->version_before = version_now + 1;
  impl_->begin_again();
}

void Session::clear() {
  const std::uint64_t version_now = version();
  impl_->contents.clear();
  impl_->version_before = version_now + 1;
  impl_->begin_again();
}

Handle Session::add_cloth(const Soup& soup, const MeshOptions& options) {
  return impl_->contents.add(Kind::cloth, soup, options);
}
Handle Session::add_soft_body(const Soup& soup, const MeshOptions& options) {
  return impl_->contents.add(Kind::soft_body, soup, options);
}
Handle Session::add_obstacle(const Soup& soup, const MeshOptions& options) {
  return impl_->contents.add(Kind::obstacle, soup, options);
}

void Session::remove(Handle object) {
  impl_->contents.remove(object);
  if (!grabbing()) release();
}

bool Session::contains(Handle object) const {
  return impl_->contents.contains(object);
}

ObjectInfo Session::object(Handle handle) const {
  const Item& item = impl_->contents.item(handle);
  const World& world = impl_->contents.world();
  ObjectInfo info;
  info.handle = handle;
  info.name = item.name;
  info.kind = item.kind;
  info.vertex_count = item.mesh ? item.mesh->weld.vertex_count() : world.positions(item.id).size();
  info.triangle_count = item.mesh ? item.mesh->weld.triangle_count() : world.triangles(item.id).size();
  info.radius = world.particle_radius(item.id);
  info.from_scene = !item.mesh;
  info.has_colour = item.colour.has_value();
  info.colour = channels_of(item.colour);
  return info;
}

std::vector<ObjectInfo> Session::objects() const {
  std::vector<ObjectInfo> infos;
  for (const auto& item : impl_->contents.items()) infos.push_back(object(item->handle));
  return infos;
}

void Session::set_transform(Handle object, const float* transform) {
  impl_->contents.set_transform(object, transform);
  ++impl_->version_before;
}

void Session::set_pinned(Handle object, std::uint32_t vertex, bool pinned) {
  const Item& item = impl_->contents.item(object);
  impl_->contents.set_pinned(object, Impl::world_vertex(item, impl_->contents.world(), vertex), pinned);
}

// --- what is drawn
// ---------------------------------------------------------------------------------------------------

namespace {

void require_count(const std::string& name, std::size_t given, std::size_t expected) {
  if (given != expected)
    throw Error(name + ": the buffers hold " + std::to_string(given) + " vertices, expected " +
                std::to_string(expected));
}

void copy(std::span<const Vec3f> values, float* out, std::size_t stride) {
  if (out == nullptr) return;
  for (std::size_t v = 0; v < values.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) out[v * stride + k] = values[v][static_cast<int>(k)];
}

/// An object of the scene: its own vertices, as the world has them.
void write_plain(const World& world, const Item& item, const VertexBuffers& buffers, std::size_t count) {
  if (buffers.stride < 3) throw Error(item.name + ": the stride of the buffers is below 3 floats");
  const std::span<const Vec3f> positions = world.positions(item.id);
  require_count(item.name, count, positions.size());
  copy(positions, buffers.positions, buffers.stride);
  copy(world.normals(item.id), buffers.normals, buffers.stride);
}

}  // namespace

void Session::write(Handle object, const VertexBuffers& buffers, std::size_t vertex_count, Normals normals) {
  Item& item = impl_->contents.item(object);
  const World& world = impl_->contents.world();
  if (!item.mesh) return write_plain(world, item, buffers, vertex_count);
  HostMesh& mesh = *item.mesh;
  require_count(item.name, vertex_count, mesh.weld.vertex_count());
  if (item.kind == Kind::obstacle) return mesh.weld.write(mesh.rest.data(), {}, buffers, normals);
  mesh.weld.write(world.positions(item.id).data(), mesh.placement, buffers, normals);
}

std::vector<std::uint32_t> Session::triangles(Handle object) const {
  const Item& item = impl_->contents.item(object);
  std::vector<std::uint32_t> indices;
  const auto add = [&](const auto& triangles) {
    for (const Triangle& triangle : triangles)
      indices.insert(indices.end(), triangle.begin(), triangle.end());
  };
  if (item.mesh)
    add(item.mesh->weld.render_triangles());
  else
    add(impl_->contents.world().triangles(item.id));
  return indices;
}

std::vector<std::uint32_t> Session::segments(Handle object) const {
  const Item& item = impl_->contents.item(object);
  std::vector<std::uint32_t> indices;
  if (item.kind != Kind::rope) return indices;
  const std::size_t count = impl_->contents.world().positions(item.id).size();
  for (std::uint32_t v = 0; v + 1 < count; ++v) indices.insert(indices.end(), {v, v + 1});
  return indices;
}

// --- knobs
// -----------------------------------------------------------------------------------------------------------

int Session::substeps() const {
  return impl_->contents.world().settings().substeps;
}
int Session::iterations() const {
  return impl_->contents.world().settings().iterations;
}

std::string Session::mode() const {
  for (const auto& [name, mode] : mode_names)
    if (mode == impl_->contents.world().settings().mode) return name;
  return "?";
}

std::vector<std::string> Session::modes() {
  std::vector<std::string> names;
  for (const auto& [name, mode] : mode_names) names.emplace_back(name);
  return names;
}

void Session::set_substeps(int substeps) {
  Settings settings = impl_->contents.world().settings();
  settings.substeps = substeps;
  impl_->contents.set_settings(settings);
}

void Session::set_iterations(int iterations) {
  Settings settings = impl_->contents.world().settings();
  settings.iterations = iterations;
  impl_->contents.set_settings(settings);
}

void Session::set_mode(const std::string& wanted) {
  for (const auto& [name, mode] : mode_names) {
    if (name != wanted) continue;
    Settings settings = impl_->contents.world().settings();
    settings.mode = mode;
    return impl_->contents.set_settings(settings);
  }
  throw Error("there is no mode \"" + wanted + "\"" + scene_format::suggestion(wanted, modes()));
}

std::array<float, 3> Session::gravity() const {
  const Vec3f& g = impl_->contents.world().settings().gravity;
  return {g.x, g.y, g.z};
}

void Session::set_gravity(float x, float y, float z) {
  Settings settings = impl_->contents.world().settings();
  settings.gravity = {x, y, z};
  impl_->contents.set_settings(settings);
}

std::vector<Parameter> Session::parameters(Handle object) const {
  return parameters_of(impl_->contents.item(object).material, impl_->contents.world().settings().mode);
}

void Session::set_parameter(Handle object, const std::string& name, double value) {
  impl_->contents.set_material(object, with_parameter(impl_->contents.item(object).material, name, value));
}

std::vector<std::string> Session::presets(Handle object) const {
  return preset_names(impl_->contents.item(object).kind);
}

void Session::set_preset(Handle object, const std::string& name) {
  impl_->contents.set_material(object, make_material(impl_->contents.item(object).kind, name));
}

// --- from any thread
// -------------------------------------------------------------------------------------------------

void Session::post(std::string name, std::function<void(Session&)> action) {
  impl_->actions.post(std::move(name), std::move(action));
}

std::vector<std::string> Session::take_messages() {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  std::vector<std::string> taken(impl_->messages.begin(), impl_->messages.end());
  impl_->messages.clear();
  return taken;
}

Statistics Session::statistics() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->statistics;
}

}  // namespace souple::host
