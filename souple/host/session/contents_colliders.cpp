#include "souple/host/session/contents.h"
#include "souple/host/session/drive.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

// Colliders and connections that the host adds; pins that it moves.

namespace souple::host {

namespace {

Transform rigid(const float* matrix) {
  return rigid_motion({}, Placement::of(matrix, "collider: transform"), "collider");
}

}  // namespace

ColliderId add_collider_to(World& world, const HostCollider& collider) {
  ColliderOptions options;
  options.friction = collider.surface.friction;
  options.restitution = collider.surface.restitution;
  options.motion = ColliderMotion::fixed(collider.pose);
  return world.add_collider(collider.shape, options);
}

void Contents::move_pin(Handle handle, std::uint32_t vertex, const Vec3f& position) {
  const std::uint32_t vertices[] = {vertex};
  const Vec3f positions[] = {position};
  world_.move_pins(item(handle).id, vertices, positions);
}

void Contents::set_wind_exposure(Handle handle, float exposure) {
  Item& object = item(handle);
  world_.set_wind_exposure(object.id, exposure);
  object.wind_exposure = exposure;
}

// --- colliders and connections -------------------------------------------------------------------

std::vector<HostCollider>::iterator Contents::find_collider(Handle handle) {
  const auto found = std::find_if(colliders_.begin(), colliders_.end(),
                                  [&](const HostCollider& collider) { return collider.handle == handle; });
  if (found == colliders_.end())
    throw Error(fmt::format("there is no collider {} of the host: it was removed, or is of a scene", handle));
  return found;
}

Handle Contents::add_collider(const Shape& shape, const float* transform, const ColliderSurface& surface) {
  HostCollider collider{0, shape, surface, rigid(transform), {}};
  collider.id = add_collider_to(world_, collider);
  collider.handle = ++last_;
  colliders_.push_back(std::move(collider));
  return last_;
}

void Contents::move_collider(Handle handle, const float* transform) {
  HostCollider& collider = *find_collider(handle);
  const Transform pose = rigid(transform);
  world_.move_collider(collider.id, pose);
  collider.pose = pose;
}

void Contents::remove_collider(Handle handle) {
  const auto found = find_collider(handle);
  world_.remove(found->id);
  colliders_.erase(found);
}

ProjectorId Contents::connect_in(World& world, const Connection& connection,
                                 const std::function<ObjectId(Handle)>& object) const {
  const std::pair<VertexRef, VertexRef> pairs[] = {{{object(connection.object[0]), connection.vertex[0]},
                                                    {object(connection.object[1]), connection.vertex[1]}}};
  return world.connect(pairs, connection.distance, connection.compliance);
}

Handle Contents::connect(Connection connection) {
  connection.id = connect_in(world_, connection, [this](Handle handle) { return item(handle).id; });
  connection.handle = ++last_;
  connections_.push_back(connection);
  return last_;
}

void Contents::disconnect(Handle handle) {
  const auto found = std::find_if(connections_.begin(), connections_.end(),
                                  [&](const Connection& connection) { return connection.handle == handle; });
  if (found == connections_.end())
    throw Error(fmt::format("there is no connection {}: it was removed, or one of its objects was", handle));
  world_.remove(found->id);
  connections_.erase(found);
}

}  // namespace souple::host
