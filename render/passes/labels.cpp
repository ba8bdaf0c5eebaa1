#include "render/passes/labels.h"

#include "render/gl/program.h"
#include "render/gl/texture.h"
#include "render/gl/vertex_array.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <vector>

namespace souple::render {

namespace {

constexpr int smallest = 6, largest = 128;  // line heights in pixels
constexpr std::size_t max_sheets = 8;       // a resized window may request any size

/// A rectangle of a glyph sheet and its position on the picture.
struct Quad {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< pixels from the top left corner
  float u0 = 0, v0 = 0, u1 = 0, v1 = 0;
  PackedColor color = 0;
};

/// The glyphs of one size that were needed so far, on the GPU.
struct Sheet {
  std::set<char32_t> requested;
  GlyphSheet glyphs;
  gl::Texture texture;
};

int size_of(const Label& label) {
  return std::isfinite(label.size) ? std::clamp(int(std::lround(label.size)), smallest, largest) : smallest;
}

/// Lays out the text line by line from its top left corner; returns the extent of its box.
struct Extent {
  float x = 0, y = 0;
};
Extent lay_out(const std::vector<char32_t>& text, const GlyphSheet& sheet, int size, Extent corner,
               PackedColor color, std::vector<Quad>& quads) {
  Extent pen = corner, end{corner.x, corner.y + float(size)};
  for (const char32_t character : text) {
    if (character == U'\n') {
      pen = {corner.x, pen.y + float(size)};
      end.y = pen.y + float(size);
      continue;
    }
    const GlyphSheet::Glyph& glyph = sheet.glyphs.at(character);
    // Glyphs are rasterized for whole pixels; at fractions of a pixel they would blur.
    const float x = pen.x + std::round(glyph.x0), y = pen.y + std::round(glyph.y0);
    quads.push_back({x, y, x + (glyph.x1 - glyph.x0), y + (glyph.y1 - glyph.y0), glyph.u0, glyph.v0, glyph.u1,
                     glyph.v1, color});
    pen.x += glyph.advance;
    end.x = std::max(end.x, pen.x);
  }
  return end;
}

}  // namespace

struct LabelsPass::Impl {
  explicit Impl(const std::filesystem::path& file) : font(file) {
    for (char32_t c = 0x20; c < 0x100; ++c) usual.insert(c);
    const GLsizei stride = sizeof(Quad);
    array.attribute(buffer, {0, 4, GL_FLOAT, false, stride, offsetof(Quad, x0), 1});
    array.attribute(buffer, {1, 4, GL_FLOAT, false, stride, offsetof(Quad, u0), 1});
    array.attribute(buffer, {2, 4, GL_UNSIGNED_BYTE, false, stride, offsetof(Quad, color), 1});
  }

  /// A sheet of this size with at least the characters of the text.
  const Sheet& sheet(int size, const std::vector<char32_t>& text) {
    if (sheets.count(size) == 0 && sheets.size() >= max_sheets) sheets.clear();
    Sheet& sheet = sheets[size];
    std::set<char32_t> wanted = sheet.requested.empty() ? usual : sheet.requested;
    wanted.insert(text.begin(), text.end());
    if (wanted.size() == sheet.requested.size()) return sheet;
    sheet.requested = std::move(wanted);
    sheet.glyphs = font.sheet(size, {sheet.requested.begin(), sheet.requested.end()});
    sheet.texture = gl::Texture(GL_R8, sheet.glyphs.width, sheet.glyphs.height, GL_NEAREST);
    sheet.texture.upload_bytes(sheet.glyphs.coverage.data());
    return sheet;
  }

  void append(const Label& label, const std::vector<char32_t>& text, const GlyphSheet& glyphs) {
    const int size = size_of(label);
    const Extent corner{std::round(label.x), std::round(label.y)};
    const std::size_t first = quads.size();
    const bool boxed = label.background.a > 0;
    if (boxed) quads.emplace_back();
    const Extent end = lay_out(text, glyphs, size, corner, pack(label.color), quads);
    if (!boxed) return;
    const float across = std::round(0.4f * float(size)), above = std::round(0.2f * float(size));
    quads[first] = {corner.x - across, corner.y - above, end.x + across,
                    end.y + above,     glyphs.solid_u,   glyphs.solid_v,
                    glyphs.solid_u,    glyphs.solid_v,   pack(label.background)};
  }

  void flush(const gl::Texture& texture) {
    buffer.upload(std::span<const Quad>(quads));
    texture.bind(gl::Unit::glyph);
    array.bind();
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, GLsizei(quads.size()));
    quads.clear();
  }

  Font font;
  std::set<char32_t> usual;
  std::map<int, Sheet> sheets;  ///< by size
  std::vector<Quad> quads;
  gl::Program program{"label.vert.glsl", "label.frag.glsl"};
  gl::Buffer buffer;
  gl::VertexArray array;
};

LabelsPass::LabelsPass(const std::filesystem::path& font) : impl_(std::make_unique<Impl>(font)) {}
LabelsPass::~LabelsPass() = default;

void LabelsPass::draw(std::span<const Label> labels, int width, int height) {
  if (labels.empty()) return;
  impl_->program.use();
  impl_->program.set("pixels", float(width), float(height));
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  for (const Label& label : labels) {
    const std::vector<char32_t> text = code_points(label.text);
    const Sheet& sheet = impl_->sheet(size_of(label), text);
    impl_->append(label, text, sheet.glyphs);
    impl_->flush(sheet.texture);
  }
  glBindVertexArray(0);
  glDisable(GL_BLEND);
}

}  // namespace souple::render
