#include "souple/host/session.h"

#include "souple/host/session/contents.h"
#include "souple/host/session/impl.h"

#include <utility>

namespace souple::host {

// Kind repeats ObjectKind, for hosts that are compiled as C++17.
static_assert(static_cast<int>(Kind::cloth) == static_cast<int>(ObjectKind::cloth) &&
              static_cast<int>(Kind::soft_body) == static_cast<int>(ObjectKind::soft_body) &&
              static_cast<int>(Kind::rope) == static_cast<int>(ObjectKind::rope) &&
              static_cast<int>(Kind::grains) == static_cast<int>(ObjectKind::grains) &&
              static_cast<int>(Kind::obstacle) == static_cast<int>(ObjectKind::obstacle) &&
              static_cast<int>(Kind::fluid) == static_cast<int>(ObjectKind::fluid) &&
              static_cast<int>(Kind::rigid_body) == static_cast<int>(ObjectKind::rigid_body));

const char* kind_name(Kind kind) {
  return souple::kind_name(static_cast<ObjectKind>(kind)).data();  // a literal
}

Session::Impl::Impl(const ClockOptions& options)
    : contents(std::make_unique<Contents>([this](std::string message) { report(std::move(message)); })),
      clock(options) {}
Session::Impl::~Impl() = default;

Session::Session(const ClockOptions& clock) : impl_(std::make_unique<Impl>(clock)) {}
Session::~Session() = default;

// --- objects -------------------------------------------------------------------------------------

void Session::open_scene(const std::string& file) {
  const std::uint64_t version_now = version();
  impl_->contents->open(file);
  impl_->version_before = version_now + 1;
  impl_->begin_again();
}

void Session::clear() {
  const std::uint64_t version_now = version();
  impl_->contents->clear();
  impl_->version_before = version_now + 1;
  impl_->begin_again();
}

Handle Session::Impl::add(Kind kind, const TriangleSoup& soup, const MeshOptions& options) {
  const Handle added = contents->add(kind, soup, options);
  take_statistics();
  return added;
}

Handle Session::add_cloth(const TriangleSoup& soup, const MeshOptions& options) {
  return impl_->add(Kind::cloth, soup, options);
}
Handle Session::add_soft_body(const TriangleSoup& soup, const MeshOptions& options) {
  return impl_->add(Kind::soft_body, soup, options);
}
Handle Session::add_obstacle(const TriangleSoup& soup, const MeshOptions& options) {
  return impl_->add(Kind::obstacle, soup, options);
}
Handle Session::add_rigid_body(const TriangleSoup& soup, const MeshOptions& options) {
  return impl_->add(Kind::rigid_body, soup, options);
}

void Session::remove(Handle object) {
  impl_->contents->remove(object);
  if (!grabbing()) release();
  impl_->take_statistics();
}

bool Session::contains(Handle object) const {
  return impl_->contents->contains(object);
}

ObjectInfo Session::object(Handle handle) const {
  const Item& item = impl_->contents->item(handle);
  const World& world = impl_->contents->world();
  ObjectInfo info;
  info.handle = handle;
  info.name = item.name;
  info.kind = item.kind;
  info.vertex_count = item.mesh ? item.mesh->weld.vertex_count() : world.positions(item.id).size();
  info.triangle_count = item.mesh ? item.mesh->weld.triangle_count() : world.triangles(item.id).size();
  info.radius = world.particle_radius(item.id);
  info.from_scene = !item.mesh;
  info.has_color = item.color.has_value();
  info.color = channels_of(item.color);
  return info;
}

std::vector<ObjectInfo> Session::objects() const {
  std::vector<ObjectInfo> infos;
  for (const auto& item : impl_->contents->items()) infos.push_back(object(item->handle));
  return infos;
}

void Session::set_transform(Handle object, const float* transform) {
  impl_->contents->set_transform(object, transform);
  ++impl_->version_before;
}

void Session::set_pinned(Handle object, std::uint32_t vertex, bool pinned) {
  const Item& item = impl_->contents->item(object);
  impl_->contents->set_pinned(object, Impl::world_vertex(item, impl_->contents->world(), vertex), pinned);
}

void Session::move_pin(Handle object, std::uint32_t vertex, float x, float y, float z) {
  const Item& item = impl_->contents->item(object);
  impl_->contents->move_pin(object, Impl::world_vertex(item, impl_->contents->world(), vertex), {x, y, z});
}

// --- colliders, connections ----------------------------------------------------------------------

Handle Session::add_plane(const float* transform, const ColliderSurface& surface) {
  return impl_->contents->add_collider(Plane{}, transform, surface);
}

Handle Session::add_sphere(float radius, const float* transform, const ColliderSurface& surface) {
  return impl_->contents->add_collider(Sphere{.radius = radius}, transform, surface);
}

Handle Session::add_box(float half_x, float half_y, float half_z, const float* transform,
                        const ColliderSurface& surface) {
  return impl_->contents->add_collider(Box{.half_extents = {half_x, half_y, half_z}}, transform, surface);
}

Handle Session::add_capsule(float radius, float half_height, const float* transform,
                            const ColliderSurface& surface) {
  return impl_->contents->add_collider(Capsule{.radius = radius, .half_height = half_height}, transform,
                                       surface);
}

void Session::move_collider(Handle collider, const float* transform) {
  impl_->contents->move_collider(collider, transform);
}

void Session::remove_collider(Handle collider) {
  impl_->contents->remove_collider(collider);
}

Handle Session::connect(Handle object, std::uint32_t vertex, Handle other, std::uint32_t other_vertex,
                        float distance, float compliance) {
  Contents& contents = *impl_->contents;
  const std::uint32_t a = Impl::world_vertex(contents.item(object), contents.world(), vertex);
  const std::uint32_t b = Impl::world_vertex(contents.item(other), contents.world(), other_vertex);
  return contents.connect({0, {object, other}, {a, b}, distance, compliance, {}});
}

void Session::disconnect(Handle connection) {
  impl_->contents->disconnect(connection);
}

void Session::set_wind_exposure(Handle object, float exposure) {
  impl_->contents->set_wind_exposure(object, exposure);
}

// --- from any thread -----------------------------------------------------------------------------

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
