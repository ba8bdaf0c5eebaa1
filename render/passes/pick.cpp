#include "render/passes/pick.h"

#include "render/gl/framebuffer.h"
#include "render/gl/vertex_array.h"
#include "souple/math/bit_cast.h"

#include <array>
#include <limits>
#include <optional>
#include <vector>

namespace souple::render {

namespace {

/// Pick and element per pixel, and a copy with depth in a format that can be read back. OpenGL ES reads no depth
/// buffers, and integers only as four channels.
struct Buffers {
  Buffers(int width, int height)
      : ids(GL_RG32UI, width, height),
        depth(GL_DEPTH_COMPONENT32F, width, height),
        all(GL_RGBA32UI, width, height),
        drawing("picking", {&ids}, &depth),
        reading("reading picks", {&all}, nullptr) {}

  gl::Texture ids, depth, all;
  gl::Framebuffer drawing, reading;
};

/// A rectangle of the picture: pixels, from the bottom.
struct Window {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Pick data of a pixel.
struct Texel {
  std::uint32_t pick = 0, element = 0, depth_bits = 0, unused = 0;

  float depth() const { return bit_cast<float>(depth_bits); }
};

/// The world point that a pixel shows, y from the top.
Vec3f point_at(const PassContext& context, const Mat4& inverse_view, int x, int y, float depth) {
  const Mat4& p = context.projection;
  const float ndc_x = 2 * (float(x) + 0.5f) / float(context.width) - 1;
  const float ndc_y = 1 - 2 * (float(y) + 0.5f) / float(context.height);
  const Vec4 point =
      inverse_view * Vec4{(ndc_x + p.m[8]) / p.m[0] * depth, (ndc_y + p.m[9]) / p.m[5] * depth, -depth, 1};
  return {point.x, point.y, point.z};
}

Vec3f to_local(const Transform& pose, const Vec3f& point) {
  return Vec3f(rotate(conjugate(pose.rotation), Vec3d(point) - pose.translation) / pose.scale);
}

std::uint32_t nearest_vertex(const Surface& surface, const Vec3f& point) {
  const Vec3f local = to_local(surface.pose, point);
  std::uint32_t best = 0;
  float least = std::numeric_limits<float>::max();
  for (std::uint32_t i = 0; i < surface.positions.size(); ++i) {
    const float distance = length_squared(surface.positions[i] - local);
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return best;
}

const Surface* surface_of(const DrawList& list, std::uint32_t pick) {
  for (const Surface& surface : list.surfaces) {
    if (surface.pick == pick) return &surface;
  }
  return nullptr;  // spheres or a liquid
}

}  // namespace

struct PickPass::Impl {
  /// Only pixels in the window are valid.
  std::vector<Texel> read(const Pickable& pickable, const PassContext& context, Window window);

  gl::VertexArray empty_array;  // for draw_screen
  gl::Program program{"screen.vert.glsl", "pick.frag.glsl"};
  std::optional<Buffers> buffers;
};

std::vector<Texel> PickPass::Impl::read(const Pickable& pickable, const PassContext& context, Window window) {
  if (!buffers || buffers->ids.width() != context.width || buffers->ids.height() != context.height) {
    buffers.reset();  // frees memory before allocating
    buffers.emplace(context.width, context.height);
  }
  glEnable(GL_SCISSOR_TEST);
  glScissor(window.x, window.y, window.width, window.height);
  buffers->drawing.bind();
  glEnable(GL_DEPTH_TEST);
  const std::array<GLuint, 4> nobody{};
  glClearBufferuiv(GL_COLOR, 0, nobody.data());
  clear_depth(1);
  pickable.surfaces.draw(context);
  pickable.spheres.draw(context);
  pickable.liquids.draw(SplatTarget::pick);

  buffers->reading.bind();
  glDisable(GL_DEPTH_TEST);
  buffers->ids.bind(gl::Unit::pick);
  buffers->depth.bind(gl::Unit::depth);
  program.use();
  empty_array.bind();
  draw_screen();
  glBindVertexArray(0);
  glDisable(GL_SCISSOR_TEST);

  std::vector<Texel> texels(std::size_t(window.width) * std::size_t(window.height));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(window.x, window.y, window.width, window.height, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
               texels.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return texels;
}

PickPass::PickPass() : impl_(std::make_unique<Impl>()) {}
PickPass::~PickPass() = default;

Picked PickPass::pick(const DrawList& list, const Pickable& pickable, const PassContext& context, int x,
                      int y) {
  const Window window{x, context.height - 1 - y, 1, 1};
  const Texel texel = impl_->read(pickable, context, window).front();
  if (texel.pick == 0) return {};
  Picked picked{texel.pick, texel.element, point_at(context, inverse(context.view), x, y, texel.depth())};
  if (const Surface* surface = surface_of(list, texel.pick))
    picked.element = nearest_vertex(*surface, picked.point);
  return picked;
}

PickImage PickPass::image(const DrawList& list, const Pickable& pickable, const PassContext& context) {
  const int width = context.width, height = context.height;
  const std::vector<Texel> texels = impl_->read(pickable, context, {0, 0, width, height});
  const Mat4 inverse_view = inverse(context.view);
  PickImage image{width, height, {}, {}, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Texel& texel = texels[std::size_t(height - 1 - y) * std::size_t(width) + std::size_t(x)];
      image.pick.push_back(texel.pick);
      image.element.push_back(texel.element);
      image.depth.push_back(texel.depth());
      if (const Surface* surface = texel.pick != 0 ? surface_of(list, texel.pick) : nullptr)
        image.element.back() = nearest_vertex(*surface, point_at(context, inverse_view, x, y, texel.depth()));
    }
  }
  return image;
}

}  // namespace souple::render
