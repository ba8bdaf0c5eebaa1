// Rules of WebGL 2 that Mesa does not check, and that OpenGL ES 3.0 leaves undefined. They concern a buffer of indices
// with another earlier use, and a texture that a draw call both reads and draws into.
#include "gl_test.h"
#include "souple/geometry/builders.h"

#include <algorithm>
#include <array>
#include <epoxy/gl.h>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/core.h>

namespace souple::render::test_render_webgl_rules {

/// Replaces OpenGL's functions by some that note what is bound, and what breaks the rules.
class Watch {
 public:
  Watch() {
    watch_ = this;
    hook(epoxy_glBindBuffer, bind_buffer_, [](GLenum target, GLuint id) {
      watch_->bind_buffer(target, id);
      watch_->bind_buffer_(target, id);
    });
    hook(epoxy_glDeleteBuffers, delete_buffers_, [](GLsizei count, const GLuint* ids) {
      for (GLsizei i = 0; i < count; ++i) watch_->first_target_.erase(ids[i]);
      watch_->delete_buffers_(count, ids);
    });
    hook(epoxy_glBindFramebuffer, bind_framebuffer_, [](GLenum target, GLuint id) {
      if (target != GL_READ_FRAMEBUFFER) watch_->framebuffer_ = id;
      watch_->bind_framebuffer_(target, id);
    });
    hook(epoxy_glFramebufferTexture2D, attach_,
         [](GLenum target, GLenum attachment, GLenum kind, GLuint texture, GLint level) {
           watch_->attached_[watch_->framebuffer_][attachment] = texture;
           watch_->attach_(target, attachment, kind, texture, level);
         });
    hook(epoxy_glDeleteFramebuffers, delete_framebuffers_, [](GLsizei count, const GLuint* ids) {
      for (GLsizei i = 0; i < count; ++i) watch_->attached_.erase(ids[i]);
      watch_->delete_framebuffers_(count, ids);
    });
    hook(epoxy_glActiveTexture, active_texture_, [](GLenum unit) {
      watch_->unit_ = static_cast<GLint>(unit - GL_TEXTURE0);
      watch_->active_texture_(unit);
    });
    hook(epoxy_glBindTexture, bind_texture_, [](GLenum target, GLuint id) {
      watch_->texture_[watch_->unit_] = id;
      watch_->bind_texture_(target, id);
    });
    hook(epoxy_glUseProgram, use_program_, [](GLuint id) {
      watch_->program_ = id;
      watch_->use_program_(id);
    });
    hook(epoxy_glDrawArrays, draw_arrays_, [](GLenum mode, GLint first, GLsizei count) {
      watch_->draw();
      watch_->draw_arrays_(mode, first, count);
    });
    hook(epoxy_glDrawArraysInstanced, draw_instanced_,
         [](GLenum mode, GLint first, GLsizei count, GLsizei instances) {
           watch_->draw();
           watch_->draw_instanced_(mode, first, count, instances);
         });
    hook(epoxy_glDrawElements, draw_elements_,
         [](GLenum mode, GLsizei count, GLenum type, const void* offset) {
           watch_->draw();
           watch_->draw_elements_(mode, count, type, offset);
         });
  }
  ~Watch() {
    epoxy_glBindBuffer = bind_buffer_;
    epoxy_glDeleteBuffers = delete_buffers_;
    epoxy_glBindFramebuffer = bind_framebuffer_;
    epoxy_glFramebufferTexture2D = attach_;
    epoxy_glDeleteFramebuffers = delete_framebuffers_;
    epoxy_glActiveTexture = active_texture_;
    epoxy_glBindTexture = bind_texture_;
    epoxy_glUseProgram = use_program_;
    epoxy_glDrawArrays = draw_arrays_;
    epoxy_glDrawArraysInstanced = draw_instanced_;
    epoxy_glDrawElements = draw_elements_;
    watch_ = nullptr;
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  std::set<std::string> broken;  ///< one sentence each
  int draws = 0;

 private:
  template <class F, class G>
  void hook(F*& function, F*& kept, const G& instead) {
    kept = function;
    function = instead;
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

  static inline Watch* watch_ = nullptr;
  decltype(epoxy_glBindBuffer) bind_buffer_ = nullptr;
  decltype(epoxy_glDeleteBuffers) delete_buffers_ = nullptr;
  decltype(epoxy_glBindFramebuffer) bind_framebuffer_ = nullptr;
  decltype(epoxy_glFramebufferTexture2D) attach_ = nullptr;
  decltype(epoxy_glDeleteFramebuffers) delete_framebuffers_ = nullptr;
  decltype(epoxy_glActiveTexture) active_texture_ = nullptr;
  decltype(epoxy_glBindTexture) bind_texture_ = nullptr;
  decltype(epoxy_glUseProgram) use_program_ = nullptr;
  decltype(epoxy_glDrawArrays) draw_arrays_ = nullptr;
  decltype(epoxy_glDrawArraysInstanced) draw_instanced_ = nullptr;
  decltype(epoxy_glDrawElements) draw_elements_ = nullptr;
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
