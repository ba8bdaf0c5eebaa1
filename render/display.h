#pragma once

#include "render/draw_list.h"
#include "render/subject.h"

#include <array>
#include <memory>
#include <string_view>
#include <vector>

namespace souple::render {

/// Display of objects; the viewer's keys 1 to 9, and `--display`.
enum class Display {
  shaded,     ///< one color per object, lit; cloth with a checker
  plain,      ///< as shaded, without checker
  wireframe,  ///< with the edges of the triangles
  strain,     ///< surfaces colored by how much their edges are stretched
  speed,      ///< colored by speed
  particles,  ///< the particles alone, at their radius
  lattice,    ///< edges of the tets inside soft bodies
  normals,    ///< colored by normal, with a line at every vertex
  contacts    ///< contacts with an impulse, as lines along their normal
};
inline constexpr std::size_t display_count = 9;
std::string_view display_name(Display display);

/// Display of constraints over the objects; the viewer's key C cycles through the values.
enum class ConstraintDisplay { none, kind, color, strain, residual };
inline constexpr std::size_t constraint_display_count = 5;
std::string_view constraint_display_name(ConstraintDisplay display);

/// Shape of each particle of a liquid before the surface is smoothed.
enum class SplatShape {
  spheres,    ///< balls of equal size
  ellipsoids  ///< stretched along the neighbors' distribution, see souple/surface/splat_shapes.h
};
inline constexpr std::size_t splat_shape_count = 2;
std::string_view splat_shape_name(SplatShape shape);

struct DisplayOptions {
  Display display = Display::shaded;
  ConstraintDisplay constraints = ConstraintDisplay::none;
  bool wireframe = false;  ///< in addition to any display
  bool colliders = true;
  bool pins = true;         ///< draw pinned vertices as small balls
  float max_strain = 0.1f;  ///< strain of the hottest color
  float max_speed = 3;      ///< speed of the hottest color [m/s]
  SplatShape liquid_splats = SplatShape::ellipsoids;
};

/// Converts a subject to a list for the renderer. Keeps its buffers between pictures: use one instance for
/// one subject over time.
class SubjectDrawing {
 public:
  SubjectDrawing();
  ~SubjectDrawing();
  SubjectDrawing(const SubjectDrawing&) = delete;
  SubjectDrawing& operator=(const SubjectDrawing&) = delete;

  /// The list is valid until the next call or until the subject changes. Surfaces and spheres of a body have
  /// pick = position in subject.bodies + 1; those of colliders follow.
  const DrawList& update(const Subject& subject, const DisplayOptions& options);
  DrawList& list();  ///< the last list, to which lines and labels may be added

  /// The object's vertex for a picked element: ropes are drawn as tubes with vertices of their own.
  std::uint32_t vertex_of(const Subject& subject, std::uint32_t pick, std::uint32_t element) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
