#include "render/passes/surfaces.h"

#include "render/gl/vertex_array.h"
#include "render/wall.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace souple::render {

namespace {

enum Location : GLuint { position, normal, texture, color };

constexpr std::uint64_t frames_kept = 120;  // frames; lifetime of buffers that no list refers to

// The buffers of one surface, indexed. For wireframes and pictures, every triangle gets its own vertices instead. The
// vertex shader distinguishes its corners, and corners at a seam have UVs of their own.
struct Buffers {
  gl::VertexArray array;
  gl::Buffer positions, normals, texture, colors, indices;
  std::uint64_t topology = 0, version = 0, last_used = 0;
  bool expanded = false;
  std::uint32_t vertices_needed = 0;  // largest index + 1
  GLsizei count = 0;                  // number of indices, or of vertices when expanded
  bool has_normals = false, has_colors = false, has_texture = false;
  bool never_uploaded = true, is_glass = false, is_printed = false;
  Wall wall;  // of glass
};

/// A picture on the GPU. Holds the image, so that its address stays that of this picture.
struct Print {
  std::shared_ptr<const Image> image;
  gl::Texture texture;
  std::uint64_t last_used = 0;

  explicit Print(std::shared_ptr<const Image> of) : image(std::move(of)) {
    const int most = gl::largest_texture();
    const int width = std::min(image->width, most), height = std::min(image->height, most);
    const bool fits = width == image->width && height == image->height;
    const Image smaller = fits ? Image() : downscale(*image, width, height);
    texture = gl::Texture::picture(width, height, (fits ? *image : smaller).pixels.data());
  }
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

bool is_printed(const Surface& surface) {
  return surface.print && surface.uvs.size() == surface.triangles.size() && surface.colors.empty();
}

bool is_expanded(const Surface& surface) {
  return surface.wireframe || is_printed(surface);
}

/// In a picture the first row is the upper one.
void upload_uvs(Buffers& buffers, const Surface& surface) {
  std::vector<Vec3f> corners;
  corners.reserve(3 * surface.uvs.size());
  for (const CornerUvs& triangle : surface.uvs)
    for (const std::array<float, 2>& uv : triangle) corners.push_back({uv[0], 1 - uv[1], 0});
  buffers.texture.upload(std::span<const Vec3f>(corners));
  buffers.array.attribute(buffers.texture, {.location = texture});
  buffers.has_texture = true;
}

void upload_topology(Buffers& buffers, const Surface& surface) {
  buffers.topology = surface.topology;
  buffers.expanded = is_expanded(surface);
  buffers.is_printed = is_printed(surface);
  buffers.count = GLsizei(3 * surface.triangles.size());
  buffers.vertices_needed = 0;
  for (const Triangle& triangle : surface.triangles) {
    const std::uint32_t largest = std::max({triangle[0], triangle[1], triangle[2]});
    buffers.vertices_needed = std::max(buffers.vertices_needed, largest + 1);
  }
  if (!buffers.expanded) {
    buffers.array.elements(buffers.indices);  // first: WebGL decides now what the buffer may hold
    buffers.indices.upload(surface.triangles);
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
  if (all && buffers.is_printed) {
    upload_uvs(buffers, surface);
  } else if (all) {
    buffers.has_texture =
        upload_optional(buffers, buffers.texture, {.location = texture}, surface.texture, surface);
  }
}

bool can_be_drawn(const Buffers& buffers, const Surface& surface) {
  return buffers.count > 0 && buffers.vertices_needed <= surface.positions.size();
}

void upload_changes(Buffers& buffers, const Surface& surface) {
  const bool all = buffers.never_uploaded || buffers.topology != surface.topology ||
                   buffers.expanded != is_expanded(surface) || buffers.is_printed != is_printed(surface);
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
  // Programs of the material for printed surfaces: compiled when one is drawn.
  std::array<std::optional<gl::Program>, 2> printed;
  std::unordered_map<const Image*, Print> prints;
  std::unordered_map<std::uint64_t, Buffers> buffers;  // by key
  std::vector<Item> items;
  std::uint64_t frame = 0;

  static std::array<gl::Program, 2> make(Target target) {
    const auto program = [&](const std::vector<std::string>& defines) {
      return gl::Program("surface.vert.glsl", "surface.frag.glsl", defines);
    };
    return {program({target_define(target)}), program({target_define(target), "WIREFRAME"})};
  }

  void update_prints();
  void draw(const Item& item, const gl::Program& program) const;
  const gl::Program& program_of(const Item& item, Target target);
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
  m.update_prints();
  std::erase_if(m.buffers, [&](const auto& entry) { return entry.second.last_used + frames_kept < m.frame; });
}

void SurfacesPass::Impl::update_prints() {
  for (const Item& item : items) {
    if (!item.buffers->is_printed) continue;
    const std::shared_ptr<const Image>& image = item.surface->print;
    prints.try_emplace(image.get(), image).first->second.last_used = frame;
  }
  std::erase_if(prints, [&](const auto& entry) { return entry.second.last_used + frames_kept < frame; });
}

const gl::Program& SurfacesPass::Impl::program_of(const Item& item, Target target) {
  const std::size_t wired = item.surface->wireframe ? 1 : 0;
  if (target != Target::material || !item.buffers->is_printed)
    return programs.at(std::size_t(target)).at(wired);
  std::optional<gl::Program>& program = printed.at(wired);
  if (!program) {
    std::vector<std::string> defines{target_define(target), "PRINT"};
    if (wired != 0) defines.emplace_back("WIREFRAME");
    program.emplace("surface.vert.glsl", "surface.frag.glsl", defines);
  }
  return *program;
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
  const gl::Program* used = nullptr;
  float number = 0;
  for (const Item& item : impl_->items) {
    ++number;
    if (!is_drawn(item, context.target)) continue;
    const gl::Program& program = impl_->program_of(item, context.target);
    if (&program != used) {
      program.use();
      program.set("wire_width", 1.1f);
      program.set("layer", static_cast<float>(context.layer));
      program.set("glass_part", context.glass_part);
      program.set("glass_scale", static_cast<float>(context.glass_scale));
    }
    used = &program;
    program.set("number", number);
    const bool solid = is_of_glass(context.target) && item.buffers->wall.closed;
    (item.surface->one_sided || solid ? glEnable : glDisable)(GL_CULL_FACE);
    glCullFace(context.target == Target::glass_exit ? GL_FRONT : GL_BACK);
    if (item.buffers->is_printed) impl_->prints.at(item.surface->print.get()).texture.bind(gl::Unit::print);
    impl_->draw(item, program);
  }
  glCullFace(GL_BACK);
  glDisable(GL_CULL_FACE);
  glBindVertexArray(0);
}

}  // namespace souple::render
