#include "render/constraint_lines.h"

#include "render/looks.h"
#include "souple/world/debug_draw.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <fmt/core.h>

namespace souple::render {
namespace {

constexpr float line_width = 1.2f;  ///< pixels
constexpr float shrunk = 0.85f;     ///< elements are drawn smaller, so that they do not cover their neighbors

struct KindStyle {
  std::string_view kind;
  std::uint32_t color;  ///< sRGB
};
constexpr std::array<KindStyle, 17> styles{{{"attachment", 0xe6194b},
                                            {"ball_joint", 0x9a6324},
                                            {"collider contact", 0xff7f0e},
                                            {"cone_limit", 0x008080},
                                            {"custom", 0x808000},
                                            {"dihedral_bending", 0x9467bd},
                                            {"distance", 0x1f77b4},
                                            {"enclosed_volume", 0x17becf},
                                            {"isometric_bending", 0x8e44ad},
                                            {"neo_hookean", 0x2ca02c},
                                            {"particle contact", 0xf7b500},
                                            {"rope_bending", 0xe377c2},
                                            {"shape_matching", 0x8c564b},
                                            {"tet_volume", 0x3cb44b},
                                            {"tether", 0xb8b8b8},
                                            {"triangle_membrane", 0x0a9396},
                                            {"twist_limit", 0xd62728}}};

bool is_hinge(std::string_view kind) {
  return kind == "dihedral_bending" || kind == "isometric_bending";
}

Vec3f centroid(std::span<const Vec3f> points) {
  Vec3f sum{};
  for (const Vec3f& p : points) sum += p;
  return sum / static_cast<float>(points.size());
}

/// Tethers span the whole object: makes them transparent, so that objects behind them remain visible.
PackedColor thinned(std::string_view kind, PackedColor color) {
  return kind == "tether" ? (color & 0x00ffffffu) | 0x50000000u : color;
}

/// Adds the lines of one constraint.
class Pen {
 public:
  Pen(std::vector<Line>& lines, float size) : lines_(lines), size_(size) {}

  void draw(std::string_view kind, std::span<const Vec3f> x, PackedColor color) {
    color_ = color;
    if (x.empty()) return;
    if (x.size() == 1) {
      cross(x[0]);
    } else if (x.size() == 2) {
      segment(x[0], x[1]);
    } else if (x.size() == 4 && is_hinge(kind)) {
      hinge(x);
    } else if (x.size() <= 4) {
      element(x);
    } else {
      const Vec3f middle = centroid(x);
      for (const Vec3f& p : x) segment(middle, p);
    }
  }

 private:
  void segment(const Vec3f& a, const Vec3f& b) { lines_.push_back({a, b, color_, line_width}); }
  void cross(const Vec3f& x) {
    for (const Vec3f& axis : {Vec3f{size_, 0, 0}, Vec3f{0, size_, 0}, Vec3f{0, 0, size_}})
      segment(x - axis, x + axis);
  }
  /// From the center of one triangle over the shared edge to the center of the other triangle.
  void hinge(std::span<const Vec3f> x) {
    const Vec3f edge = (x[0] + x[1]) / 2.0f;
    segment((x[0] + x[1] + x[2]) / 3.0f, edge);
    segment(edge, (x[0] + x[1] + x[3]) / 3.0f);
  }
  /// All edges of a triangle or tet.
  void element(std::span<const Vec3f> x) {
    const Vec3f middle = centroid(x);
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t j = i + 1; j < x.size(); ++j)
        segment(middle + (x[i] - middle) * shrunk, middle + (x[j] - middle) * shrunk);
  }

  std::vector<Line>& lines_;
  float size_;
  PackedColor color_ = 0;
};

/// Data of one kind of constraint for the legend.
struct KindSummary {
  std::size_t count = 0;
  float residual = 0, strain = 0;  ///< maximum
  int colors = 0;
};
using Summary = std::map<std::string, KindSummary, std::less<>>;

void note(Summary& summary, const DebugConstraint& c) {
  auto place = summary.find(c.kind);
  if (place == summary.end()) place = summary.try_emplace(std::string(c.kind)).first;
  KindSummary& kind = place->second;
  ++kind.count;
  kind.residual = std::max(kind.residual, c.residual);
  kind.strain = std::max(kind.strain, std::abs(c.strain));
  kind.colors = std::max(kind.colors, c.color + 1);
}

/// Units differ between kinds, so each kind has its own scale: the maximum of each must be known before the
/// first line.
bool takes_two_passes(ConstraintDisplay display) {
  return display == ConstraintDisplay::residual || display == ConstraintDisplay::strain;
}

/// Kinds without a strain would cover kinds that have one.
bool has_strain(const Summary& summary, std::string_view kind) {
  return kind == "distance" || summary.find(kind)->second.strain > 0;
}

PackedColor color_of(const DebugConstraint& c, const DisplayOptions& options, const HeatScale& heat,
                     const Summary& summary) {
  switch (options.constraints) {
    case ConstraintDisplay::color:
      return distinct_color(static_cast<std::uint32_t>(c.color));
    case ConstraintDisplay::strain:
      return heat(options.max_strain > 0 ? std::abs(c.strain) / options.max_strain : 0);
    case ConstraintDisplay::residual: {
      const float largest = summary.find(c.kind)->second.residual;
      return heat(largest > 0 ? c.residual / largest : 0);
    }
    case ConstraintDisplay::none:
    case ConstraintDisplay::kind:
      break;
  }
  return kind_color(c.kind);
}

void explain(const Summary& summary, const DisplayOptions& options, const HeatScale& heat, Legend& legend) {
  switch (options.constraints) {
    case ConstraintDisplay::none:
      return;
    case ConstraintDisplay::kind:
      legend.title("constraints by kind");
      for (const auto& [kind, of] : summary)
        legend.entry(kind_color(kind), fmt::format("{}  {}", kind, of.count));
      return;
    case ConstraintDisplay::color:
      legend.title("constraints by solver color");
      for (const auto& [kind, of] : summary)
        legend.title(fmt::format("{}  {} {}", kind, of.colors, of.colors == 1 ? "color" : "colors"));
      return;
    case ConstraintDisplay::strain:
      legend.title("constraints by |strain|");
      legend.scale(heat, 100 * options.max_strain, "%");
      for (const auto& [kind, of] : summary)
        if (has_strain(summary, kind)) legend.title(fmt::format("{}  {}", kind, of.count));
      return;
    case ConstraintDisplay::residual:
      legend.title("constraints by residual |C|, from 0 (dark) to");
      for (const auto& [kind, of] : summary)
        legend.entry(heat(of.residual > 0 ? 1.0f : 0.0f),
                     kind + "  " + short_number(static_cast<double>(of.residual)));
      return;
  }
}

}  // namespace

PackedColor kind_color(std::string_view kind) {
  for (const KindStyle& style : styles)
    if (style.kind == kind) return pack(srgb(style.color));
  std::uint32_t sum = 0;
  for (const char c : kind) sum = sum * 31 + static_cast<unsigned char>(c);
  return distinct_color(sum % 997);
}

void draw_constraints(const World& world, const DisplayOptions& options, const HeatScale& heat, float size,
                      std::vector<Line>& lines, Legend& legend) {
  if (options.constraints == ConstraintDisplay::none) return;
  Summary summary;
  DebugDraw draw;
  const bool two_passes = takes_two_passes(options.constraints);
  if (two_passes) {
    draw.constraint = [&](const DebugConstraint& c) { note(summary, c); };
    world.debug_draw(draw);
  }
  Pen pen(lines, size);
  draw.constraint = [&](const DebugConstraint& c) {
    if (!two_passes) note(summary, c);
    if (options.constraints == ConstraintDisplay::strain && !has_strain(summary, c.kind)) return;
    pen.draw(c.kind, c.points, thinned(c.kind, color_of(c, options, heat, summary)));
  };
  world.debug_draw(draw);
  explain(summary, options, heat, legend);
}

}  // namespace souple::render
