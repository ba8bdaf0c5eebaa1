#include "render/passes/surfaces.h"

#include "render/gl/vertex_array.h"
#include "render/wall.h"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <vector>

namespace souple::render {

namespace {

enum Location : GLuint { position, normal, texture, color };

constexpr std::uint64_t frames_kept = 120;  // frames; lifetime of buffers that no list refers to

// The buffers of one surface, indexed. For wireframes, every triangle gets its own vertices instead, so that
// the vertex shader can distinguish its corners.
struct Buffers {
  gl::VertexArray array;
  gl::Buffer positions, normals, texture, colors, indices;
  std::uint64_t topology = 0, version = 0, last_used = 0;
  bool expanded = false;
  std::uint32_t vertices_needed = 0;  // largest index + 1
  GLsizei count = 0;                  // number of indices, or of vertices when expanded
  bool has_normals = false, has_colors = false, has_texture = false;
  bool never_uploaded = true, is_glass = false;
  Wall wall;  // of glass
};

struct Item {
  const Surface* surface;
  const Buffers* buffers;
};

template <class T>
void upload(gl::Buffer& buffer, std::span<const T> values, const Surface& surface, bool expanded) {
  if (!expanded) {
    buffer.upload(values);
    return;
  }
  std::vector<T> corners;
  corners.reserve(3 * surface.triangles.size());
  for (const Triangle& triangle : surface.triangles) {
    for (const std::uint32_t vertex : triangle) corners.push_back(values[vertex]);
  }
  buffer.upload(std::span<const T>(corners));
}

// An attribute that the surface may lack. Returns whether it has the attribute.
template <class T>
bool upload_optional(Buffers& buffers, gl::Buffer& buffer, const gl::Attribute& attribute,
                     std::span<const T> values, const Surface& surface) {
  const bool there = !values.empty() && values.size() == surface.positions.size();
  if (there) {
    upload(buffer, values, surface, buffers.expanded);
    buffers.array.attribute(buffer, attribute);
  } else {
    buffers.array.without_attribute(attribute.location);
  }
  return there;
}

void upload_topology(Buffers& buffers, const Surface& surface) {
  buffers.topology = surface.topology;
  buffers.expanded = surface.wireframe;
  buffers.count = GLsizei(3 * surface.triangles.size());
  buffers.vertices_needed = 0;
  for (const Triangle& triangle : surface.triangles) {
    const std::uint32_t largest = std::max({triangle[0], triangle[1], triangle[2]});
    buffers.vertices_needed = std::max(buffers.vertices_needed, largest + 1);
  }
  if (!buffers.expanded) {
    buffers.indices.upload(surface.triangles);
    buffers.array.elements(buffers.indices);
  }
}

void upload_vertices(Buffers& buffers, const Surface& surface, bool all) {
  buffers.version = surface.version;
  upload(buffers.positions, surface.positions, surface, buffers.expanded);
  buffers.array.attribute(buffers.positions, {.location = position});
  buffers.has_normals =
      upload_optional(buffers, buffers.normals, {.location = normal}, surface.normals, surface);
  buffers.has_colors =
      upload_optional(buffers, buffers.colors, {.location = color, .components = 4, .type = GL_UNSIGNED_BYTE},
                      surface.colors, surface);
  if (all) {
    buffers.has_texture =
        upload_optional(buffers, buffers.texture, {.location = texture}, surface.texture, surface);
  }
}

bool can_be_drawn(const Buffers& buffers, const Surface& surface) {
  return buffers.count > 0 && buffers.vertices_needed <= surface.positions.size();
}

void upload_changes(Buffers& buffers, const Surface& surface) {
  const bool all =
      buffers.never_uploaded || buffers.topology != surface.topology || buffers.expanded != surface.wireframe;
  if (all) upload_topology(buffers, surface);
  if (!can_be_drawn(buffers, surface)) return;
  if (surface.look.glass && (all || !buffers.is_glass))
    buffers.wall = wall_of(surface.positions, surface.triangles);
  buffers.is_glass = surface.look.glass;
  if (all || buffers.version != surface.version) upload_vertices(buffers, surface, all);
  buffers.never_uploaded = false;
}

bool is_of_glass(Target target) {
  return target == Target::glass_entry || target == Target::glass_exit || target == Target::sunlight;
}

bool is_drawn(const Item& item, Target target) {
  const Surface& surface = *item.surface;
  switch (target) {
    case Target::material:
      return !surface.look.glass;
    case Target::glass_entry:
      return surface.look.glass;
    case Target::glass_exit:
      return surface.look.glass && item.buffers->wall.closed;
    case Target::sunlight:
      return surface.look.glass && surface.casts_shadow;
    case Target::depth:
      return surface.casts_shadow && !surface.look.glass;
    case Target::pick:
      return surface.pick != 0;
  }
  return true;
}

}  // namespace

struct SurfacesPass::Impl {
  // By target, then without and with wireframe.
  std::array<std::array<gl::Program, 2>, target_count> programs{
      make(Target::material), make(Target::glass_entry), make(Target::glass_exit),
      make(Target::sunlight), make(Target::depth),       make(Target::pick)};
  std::unordered_map<std::uint64_t, Buffers> buffers;  // by key
  std::vector<Item> items;
  std::uint64_t frame = 0;

  static std::array<gl::Program, 2> make(Target target) {
    const auto program = [&](const std::vector<std::string>& defines) {
      return gl::Program("surface.vert.glsl", "surface.frag.glsl", defines);
    };
    return {program({target_define(target)}), program({target_define(target), "WIREFRAME"})};
  }

  void draw(const Item& item, const gl::Program& program) const;
};

SurfacesPass::SurfacesPass() : impl_(std::make_unique<Impl>()) {}
SurfacesPass::~SurfacesPass() = default;

void SurfacesPass::update(std::span<const Surface> surfaces) {
  Impl& m = *impl_;
  ++m.frame;
  m.items.clear();
  for (const Surface& surface : surfaces) {
    Buffers& buffers = m.buffers[surface.key];
    buffers.last_used = m.frame;
    upload_changes(buffers, surface);
    if (can_be_drawn(buffers, surface)) m.items.push_back({&surface, &buffers});
  }
  std::erase_if(m.buffers, [&](const auto& entry) { return entry.second.last_used + frames_kept < m.frame; });
}

void SurfacesPass::Impl::draw(const Item& item, const gl::Program& program) const {
  const Surface& surface = *item.surface;
  const Look& look = surface.look;
  program.set("pose", to_mat4(surface.pose));
  program.set("pick", surface.pick);
  program.set("color_first", look.color);
  program.set("color_second", look.second);
  const float checker = item.buffers->has_texture ? look.checker_size : 0;
  program.set("look", Vec4{look.roughness, look.metalness, look.sheen, checker});
  program.set("fabric", Vec4{static_cast<float>(look.pattern), look.weave, look.translucency, 0});
  program.set("thickness", item.buffers->wall.closed ? item.buffers->wall.thickness : 0.0f);
  program.set("has_colors", item.buffers->has_colors ? 1.0f : 0.0f);
  program.set("has_normals", item.buffers->has_normals ? 1.0f : 0.0f);
  item.buffers->array.bind();
  if (item.buffers->expanded) {
    glDrawArrays(GL_TRIANGLES, 0, item.buffers->count);
  } else {
    glDrawElements(GL_TRIANGLES, item.buffers->count, GL_UNSIGNED_INT, nullptr);
  }
}

bool SurfacesPass::has_glass() const {
  return std::any_of(impl_->items.begin(), impl_->items.end(),
                     [](const Item& item) { return item.surface->look.glass; });
}

bool SurfacesPass::glass_casts_shadow() const {
  return std::any_of(impl_->items.begin(), impl_->items.end(),
                     [](const Item& item) { return item.surface->look.glass && item.surface->casts_shadow; });
}

void SurfacesPass::draw(const PassContext& context) {
  const auto& programs = impl_->programs.at(std::size_t(context.target));
  for (const bool expanded : {false, true}) {
    const gl::Program& program = programs.at(expanded ? 1 : 0);
    program.use();
    program.set("wire_width", 1.1f);
    program.set("layer", static_cast<float>(context.layer));
    program.set("glass_part", context.glass_part);
    float number = 0;
    for (const Item& item : impl_->items) {
      ++number;
      if (item.buffers->expanded != expanded || !is_drawn(item, context.target)) continue;
      program.set("number", number);
      const bool solid = is_of_glass(context.target) && item.buffers->wall.closed;
      (item.surface->one_sided || solid ? glEnable : glDisable)(GL_CULL_FACE);
      glCullFace(context.target == Target::glass_exit ? GL_FRONT : GL_BACK);
      impl_->draw(item, program);
    }
  }
  glCullFace(GL_BACK);
  glDisable(GL_CULL_FACE);
  glBindVertexArray(0);
}

}  // namespace souple::render
