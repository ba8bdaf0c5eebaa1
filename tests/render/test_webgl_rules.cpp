// Rules of WebGL 2 that Mesa does not check, and that OpenGL ES 3.0 leaves undefined. They concern a buffer of indices
// with another earlier use, and a texture that a draw call both reads and draws into.
#include "gl_test.h"
#include "souple/geometry/builders.h"

#include <algorithm>
#include <array>
#include <epoxy/gl.h>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/core.h>

namespace souple::render::test_render_webgl_rules {

/// An OpenGL function of libepoxy that is replaced by one that first calls `before`.
template <auto* pointer>
struct Hooked;
template <class... A, void (**pointer)(A...)>
struct Hooked<pointer> {
  static inline void (*original)(A...) = nullptr;
  static inline std::function<void(A...)> before;
  static void call(A... arguments) {
    before(arguments...);
    original(arguments...);
  }
};

/// Notes what is bound, and what breaks the rules.
class Watch {
 public:
  Watch() {
    hook<&epoxy_glBindBuffer>([this](GLenum target, GLuint id) { bind_buffer(target, id); });
    hook<&epoxy_glDeleteBuffers>([this](GLsizei count, const GLuint* ids) {
      for (GLsizei i = 0; i < count; ++i) first_target_.erase(ids[i]);
    });
    hook<&epoxy_glBindFramebuffer>([this](GLenum target, GLuint id) {
      if (target != GL_READ_FRAMEBUFFER) framebuffer_ = id;
    });
    hook<&epoxy_glFramebufferTexture2D>([this](GLenum, GLenum attachment, GLenum, GLuint texture, GLint) {
      attached_[framebuffer_][attachment] = texture;
    });
    hook<&epoxy_glDeleteFramebuffers>([this](GLsizei count, const GLuint* ids) {
      for (GLsizei i = 0; i < count; ++i) attached_.erase(ids[i]);
    });
    hook<&epoxy_glActiveTexture>([this](GLenum unit) { unit_ = static_cast<GLint>(unit - GL_TEXTURE0); });
    hook<&epoxy_glBindTexture>([this](GLenum, GLuint id) { texture_[unit_] = id; });
    hook<&epoxy_glUseProgram>([this](GLuint id) { program_ = id; });
    hook<&epoxy_glDrawArrays>([this](auto...) { draw(); });
    hook<&epoxy_glDrawArraysInstanced>([this](auto...) { draw(); });
    hook<&epoxy_glDrawElements>([this](auto...) { draw(); });
  }
  ~Watch() {
    for (const auto& restore : restore_) restore();
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  std::set<std::string> broken;  ///< one sentence each
  int draws = 0;

 private:
  template <auto* pointer, class Before>
  void hook(Before before) {
    using H = Hooked<pointer>;
    H::original = *pointer;
    H::before = before;
    *pointer = &H::call;
    restore_.emplace_back([] { *pointer = H::original; });
  }
  void bind_buffer(GLenum target, GLuint id) {
    if (id == 0) return;
    const GLenum first = first_target_.emplace(id, target).first->second;
    if (target == GL_ELEMENT_ARRAY_BUFFER && first != target)
      broken.insert(fmt::format("a buffer of indices was bound to {:#x} first", first));
  }
  void draw() {
    ++draws;
    for (const auto& [name, unit] : samplers())
      for (const auto& [attachment, texture] : attached_[framebuffer_])
        if (texture != 0 && texture_[unit] == texture)
          broken.insert(fmt::format("{} reads the texture at attachment {:#x}", name, attachment));
  }
  /// Samplers of the program in use, and their units.
  const std::map<std::string, GLint>& samplers() {
    const auto [entry, is_new] = samplers_.try_emplace(program_);
    if (!is_new) return entry->second;
    GLint count = 0;
    glGetProgramiv(program_, GL_ACTIVE_UNIFORMS, &count);
    for (GLint i = 0; i < count; ++i) {
      std::array<char, 128> name{};
      GLint size = 0, unit = 0;
      GLenum type = 0;
      glGetActiveUniform(program_, static_cast<GLuint>(i), GLsizei(name.size()), nullptr, &size, &type,
                         name.data());
      if (type != GL_SAMPLER_2D && type != GL_SAMPLER_2D_SHADOW && type != GL_UNSIGNED_INT_SAMPLER_2D)
        continue;
      glGetUniformiv(program_, glGetUniformLocation(program_, name.data()), &unit);
      entry->second[name.data()] = unit;
    }
    return entry->second;
  }

  std::vector<std::function<void()>> restore_;
  std::map<GLuint, GLenum> first_target_;
  std::map<GLuint, std::map<GLenum, GLuint>> attached_;
  std::map<GLint, GLuint> texture_;
  std::map<GLuint, std::map<std::string, GLint>> samplers_;
  GLuint framebuffer_ = 0, program_ = 0;
  GLint unit_ = 0;
};

/// Everything that a list can hold.
class Everything {
 public:
  Everything() : mesh_(box({0.4, 0.4, 0.4})) {
    for (const Vec3d& x : mesh_.positions) positions_.emplace_back(Vec3f(x));
    for (int i = 0; i < 300; ++i)
      centers_.push_back(Vec3f{0.03f * float(i % 10), 0.03f * float(i / 10 % 10), 0.03f * float(i / 100)} +
                         Vec3f{0.5f, 0.1f, 0.4f});
    for (std::uint64_t key = 1; key <= 2; ++key) {
      Surface surface;
      surface.key = key;
      surface.positions = positions_;
      surface.triangles = mesh_.triangles;
      surface.pose.translation = {-1.0 + double(key), 0.4, 0};
      surface.look.glass = key == 2;
      surface.pick = static_cast<std::uint32_t>(key);
      list.surfaces.push_back(surface);
    }
    Spheres& balls = list.spheres.emplace_back();
    balls.key = balls.pick = 3;
    balls.centers = centers_;
    balls.radius = 0.02f;
    Liquid& water = list.liquids.emplace_back();
    water.key = water.pick = 4;
    water.centers = centers_;
    list.foams.push_back({.key = 5, .centers = centers_});
    list.lines.push_back({{-1, 0.2f, 0.5f}, {1, 0.2f, 0.5f}});
    list.top_lines.push_back({{-1, 0.3f, 0.5f}, {1, 0.3f, 0.5f}});
    list.labels.push_back({.text = "words"});
  }
  DrawList list;

 private:
  TriangleMesh mesh_;
  std::vector<Vec3f> positions_, centers_;
};

class WebGlRules : public GlTest {};

TEST_F(WebGlRules, EveryPassKeepsThem) {
  const Camera camera;
  const Everything everything;
  const auto draw_all = [&](Renderer& on) {
    RenderOptions options;
    on.picture(everything.list, camera, options, 160, 120);
    options.samples = 2;
    options.liquid_filter = LiquidFilter::curvature_flow;
    on.picture(everything.list, camera, options, 160, 120);
    on.pick(everything.list, camera, 80, 60, 160, 120);
  };
  const auto whole_life = [&] {
    Renderer fresh;
    draw_all(fresh);
  };
  whole_life();  // libepoxy finds a function when it is called for the first time
  Watch watch;
  whole_life();
  EXPECT_GT(watch.draws, 50);
  EXPECT_EQ(watch.broken, std::set<std::string>{});
}

}  // namespace souple::render::test_render_webgl_rules
