#include "souple/host/session/contents.h"
#include "souple/host/session/impl.h"

#include <fmt/core.h>

// Output of a session's objects for the host.

namespace souple::host {

namespace {

void require_count(const std::string& name, std::size_t given, std::size_t expected) {
  if (given != expected)
    throw Error(fmt::format("{}: the buffers hold {} vertices, expected {}", name, given, expected));
}

void copy(std::span<const Vec3f> values, float* out, std::size_t stride) {
  if (out == nullptr) return;
  for (std::size_t v = 0; v < values.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) out[v * stride + k] = values[v][static_cast<int>(k)];
}

/// Writes an object of the scene: the world's vertices.
void write_plain(const World& world, const Item& item, const VertexBuffers& buffers, std::size_t count) {
  if (buffers.stride < 3) throw Error(item.name + ": the stride of the buffers is below 3 floats");
  const std::span<const Vec3f> positions = world.positions(item.id);
  require_count(item.name, count, positions.size());
  copy(positions, buffers.positions, buffers.stride);
  copy(world.normals(item.id), buffers.normals, buffers.stride);
}

}  // namespace

void Session::write(Handle object, const VertexBuffers& buffers, std::size_t vertex_count, Normals normals) {
  Item& item = impl_->contents->item(object);
  const World& world = impl_->contents->world();
  if (!item.mesh) return write_plain(world, item, buffers, vertex_count);
  HostMesh& mesh = *item.mesh;
  require_count(item.name, vertex_count, mesh.weld.vertex_count());
  if (item.kind == Kind::obstacle) return mesh.weld.write(mesh.rest.data(), {}, buffers, normals);
  mesh.weld.write(world.positions(item.id).data(), mesh.placement, buffers, normals);
}

std::vector<std::uint32_t> Session::triangles(Handle object) const {
  const Item& item = impl_->contents->item(object);
  std::vector<std::uint32_t> indices;
  const auto add = [&](const auto& triangles) {
    for (const Triangle& triangle : triangles)
      indices.insert(indices.end(), triangle.begin(), triangle.end());
  };
  if (item.mesh)
    add(item.mesh->weld.render_triangles());
  else
    add(impl_->contents->world().triangles(item.id));
  return indices;
}

std::vector<std::uint32_t> Session::segments(Handle object) const {
  const Item& item = impl_->contents->item(object);
  std::vector<std::uint32_t> indices;
  if (item.kind != Kind::rope) return indices;
  const std::size_t count = impl_->contents->world().positions(item.id).size();
  for (std::uint32_t v = 0; v + 1 < count; ++v) indices.insert(indices.end(), {v, v + 1});
  return indices;
}

}  // namespace souple::host
