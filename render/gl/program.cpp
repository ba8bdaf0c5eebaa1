#include "render/gl/program.h"

#include "souple/error.h"

#include <algorithm>
#include <array>

namespace souple::render {

std::string_view shader_source(std::string_view name);  // generated from render/shaders

namespace gl {

namespace {

inline void delete_shader(GLuint id) {
  glDeleteShader(id);
}
using Shader = Handle<delete_shader>;

constexpr std::array<std::pair<std::string_view, Unit>, 14> sampler_units{
    {{"shadow_map", Unit::shadow},
     {"sum_map", Unit::sum},
     {"occlusion_map", Unit::occlusion},
     {"albedo_map", Unit::albedo},
     {"normal_map", Unit::normal},
     {"depth_map", Unit::depth},
     {"color_map", Unit::color},
     {"glyph_map", Unit::glyph},
     {"pick_map", Unit::pick},
     {"liquid_depth_map", Unit::liquid_depth},
     {"liquid_look_map", Unit::liquid_look},
     {"liquid_optics_map", Unit::liquid_optics},
     {"liquid_glow_map", Unit::liquid_glow},
     {"liquid_light_map", Unit::liquid_light}}};

// The source of a shader, with each `#include "name"` replaced by that file, each file once.
std::string expand(std::string_view name, std::vector<std::string>& included) {
  const std::string_view source = shader_source(name);
  if (source.empty())
    throw Error("shader " + std::string(name) + ": there is no such file in render/shaders");
  constexpr std::string_view directive = "#include \"";
  std::string text;
  for (std::size_t begin = 0; begin < source.size();) {
    const std::size_t end = std::min(source.find('\n', begin), source.size());
    const std::string_view line = source.substr(begin, end - begin);
    begin = end + 1;
    if (line.substr(0, directive.size()) != directive) {
      text.append(line).append("\n");
      continue;
    }
    const std::string other(line.substr(directive.size(), line.rfind('"') - directive.size()));
    if (std::find(included.begin(), included.end(), other) != included.end()) continue;
    included.push_back(other);
    text += expand(other, included);
  }
  return text;
}

std::string preamble(const std::vector<std::string>& defines) {
  std::string text = is_es() ? "#version 300 es\n"
                               "precision highp float;\nprecision highp int;\n"
                               "precision highp sampler2D;\nprecision highp sampler2DShadow;\n"
                               "precision highp usampler2D;\n"
                             : "#version 330 core\n";
  for (const std::string& name : defines) text += "#define " + name + " 1\n";
  return text;
}

std::string with_defines(std::string_view name, const std::vector<std::string>& defines) {
  std::string text(name);
  for (const std::string& define : defines) text += " " + define;
  return text;
}

Shader compile(GLenum stage, std::string_view name, const std::vector<std::string>& defines) {
  std::vector<std::string> included;
  const std::string text = preamble(defines) + expand(name, included);
  const char* const pointer = text.c_str();
  Shader shader(glCreateShader(stage));
  glShaderSource(shader.id(), 1, &pointer, nullptr);
  glCompileShader(shader.id());
  GLint ok = 0;
  glGetShaderiv(shader.id(), GL_COMPILE_STATUS, &ok);
  if (ok != 0) return shader;
  std::array<char, 2048> log{};
  glGetShaderInfoLog(shader.id(), GLsizei(log.size()), nullptr, log.data());
  throw Error("shader " + with_defines(name, defines) + " does not compile: " + log.data());
}

}  // namespace

bool is_es() {
  return !epoxy_is_desktop_gl();
}

Program::Program(std::string_view vertex, std::string_view fragment,
                 const std::vector<std::string>& defines) {
  const Shader vertex_shader = compile(GL_VERTEX_SHADER, vertex, defines);
  const Shader fragment_shader = compile(GL_FRAGMENT_SHADER, fragment, defines);
  handle_ = Handle<delete_program>(glCreateProgram());
  const GLuint id = handle_.id();
  glAttachShader(id, vertex_shader.id());
  glAttachShader(id, fragment_shader.id());
  glLinkProgram(id);
  GLint ok = 0;
  glGetProgramiv(id, GL_LINK_STATUS, &ok);
  if (ok == 0) {
    std::array<char, 2048> log{};
    glGetProgramInfoLog(id, GLsizei(log.size()), nullptr, log.data());
    throw Error("shaders " + std::string(vertex) + " and " + with_defines(fragment, defines) +
                " do not link: " + log.data());
  }
  find_uniforms();
  const GLuint frame = glGetUniformBlockIndex(id, "Frame");
  if (frame != GL_INVALID_INDEX) glUniformBlockBinding(id, frame, frame_binding);
  use();
  for (const auto& [name, unit] : sampler_units) set(name, int(unit));
  glUseProgram(0);
}

void Program::find_uniforms() {
  GLint count = 0;
  glGetProgramiv(handle_.id(), GL_ACTIVE_UNIFORMS, &count);
  for (GLint i = 0; i < count; ++i) {
    std::array<char, 128> name{};
    GLint size = 0;
    GLenum type = 0;
    glGetActiveUniform(handle_.id(), GLuint(i), GLsizei(name.size()), nullptr, &size, &type, name.data());
    const GLint location = glGetUniformLocation(handle_.id(), name.data());
    if (location >= 0) uniforms_.emplace_back(name.data(), location);
  }
}

GLint Program::location(std::string_view name) const {
  for (const auto& [known, location] : uniforms_) {
    if (known == name) return location;
  }
  return -1;  // which glUniform ignores
}

void Program::set(std::string_view name, int value) const {
  glUniform1i(location(name), value);
}
void Program::set(std::string_view name, unsigned value) const {
  glUniform1ui(location(name), value);
}
void Program::set(std::string_view name, float value) const {
  glUniform1f(location(name), value);
}
void Program::set(std::string_view name, float x, float y) const {
  glUniform2f(location(name), x, y);
}
void Program::set(std::string_view name, const Vec3f& v) const {
  glUniform3f(location(name), v.x, v.y, v.z);
}
void Program::set(std::string_view name, const Vec4& v) const {
  glUniform4f(location(name), v.x, v.y, v.z, v.w);
}
void Program::set(std::string_view name, const Color& c) const {
  glUniform4f(location(name), c.r, c.g, c.b, c.a);
}
void Program::set(std::string_view name, const Mat4& m) const {
  glUniformMatrix4fv(location(name), 1, GL_FALSE, m.m.data());
}

}  // namespace gl
}  // namespace souple::render
