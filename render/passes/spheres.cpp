#include "render/passes/spheres.h"

#include "render/gl/vertex_array.h"
#include "render/srgb.h"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <vector>

namespace souple::render {

namespace {

enum Location : GLuint { center, radius, color };

constexpr std::uint64_t frames_kept = 120;  // frames; lifetime of buffers that no list refers to

/// The buffers of one set of balls.
struct Buffers {
  gl::VertexArray array;
  gl::Buffer centers, radii, colors;
  std::uint64_t version = 0, last_used = 0;
  GLsizei count = 0;
  bool never_uploaded = true;
};

struct Item {
  const Spheres* spheres = nullptr;
  const Buffers* buffers = nullptr;
};

/// An attribute that may be constant for all balls; then the draw call sets its value.
template <class T>
void upload_optional(Buffers& buffers, gl::Buffer& buffer, const gl::Attribute& attribute,
                     std::span<const T> values) {
  if (values.size() == std::size_t(buffers.count)) {
    buffer.upload(values);
    buffers.array.attribute(buffer, attribute);
  } else {
    buffers.array.without_attribute(attribute.location);
  }
}

void upload_changes(Buffers& buffers, const Spheres& spheres) {
  const auto count = GLsizei(spheres.centers.size());
  if (!buffers.never_uploaded && buffers.version == spheres.version && buffers.count == count) return;
  buffers.never_uploaded = false;
  buffers.version = spheres.version;
  buffers.count = count;
  if (count == 0) return;
  buffers.centers.upload(spheres.centers);
  buffers.array.attribute(buffers.centers, {.location = center, .components = 3, .divisor = 1});
  upload_optional(buffers, buffers.radii, {.location = radius, .components = 1, .divisor = 1}, spheres.radii);
  upload_optional(buffers, buffers.colors,
                  {.location = color, .components = 4, .type = GL_UNSIGNED_BYTE, .divisor = 1},
                  spheres.colors);
}

bool is_drawn(const Spheres& spheres, Target target) {
  if (target == Target::depth) return spheres.casts_shadow;
  if (target == Target::pick) return spheres.pick != 0;
  return true;
}

}  // namespace

struct SpheresPass::Impl {
  static gl::Program make(Target target) {
    return {"sphere.vert.glsl", "sphere.frag.glsl", {target_define(target)}};
  }

  static void draw(const Item& item, const gl::Program& program) {
    const Look& look = item.spheres->look;
    program.set("pick", item.spheres->pick);
    program.set("look", Vec4{look.roughness, look.metalness, look.sheen, 0});
    glVertexAttrib1f(radius, item.spheres->radius);
    glVertexAttrib4f(color, srgb_of_linear(look.color.r), srgb_of_linear(look.color.g),
                     srgb_of_linear(look.color.b), look.color.a);
    item.buffers->array.bind();
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, item.buffers->count);
  }

  static constexpr std::array targets{Target::material, Target::depth, Target::pick};
  const gl::Program& program_for(Target target) const {
    return programs.at(std::size_t(std::find(targets.begin(), targets.end(), target) - targets.begin()));
  }

  std::array<gl::Program, targets.size()> programs{make(targets[0]), make(targets[1]), make(targets[2])};
  std::unordered_map<std::uint64_t, Buffers> buffers;  // by key
  std::vector<Item> items;
  std::uint64_t frame = 0;
};

SpheresPass::SpheresPass() : impl_(std::make_unique<Impl>()) {}
SpheresPass::~SpheresPass() = default;

void SpheresPass::update(std::span<const Spheres> spheres) {
  Impl& m = *impl_;
  ++m.frame;
  m.items.clear();
  for (const Spheres& cloud : spheres) {
    Buffers& buffers = m.buffers[cloud.key];
    buffers.last_used = m.frame;
    upload_changes(buffers, cloud);
    if (buffers.count > 0) m.items.push_back({&cloud, &buffers});
  }
  std::erase_if(m.buffers, [&](const auto& entry) { return entry.second.last_used + frames_kept < m.frame; });
}

void SpheresPass::draw(const PassContext& context) {
  const gl::Program& program = impl_->program_for(context.target);
  program.use();
  for (const Item& item : impl_->items) {
    if (is_drawn(*item.spheres, context.target)) Impl::draw(item, program);
  }
  glBindVertexArray(0);
}

}  // namespace souple::render
