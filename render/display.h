#pragma once

#include "render/draw_list.h"
#include "render/subject.h"

#include <array>
#include <memory>
#include <string_view>
#include <vector>

namespace souple::render {

/// Display modes of objects: the viewer's keys 1 to 9, and `--display`.
enum class Display {
  shaded,     ///< one color per object, lit; cloth with a checker
  plain,      ///< one color per object, lit, without checker
  wireframe,  ///< with the edges of the triangles
  strain,     ///< surfaces colored by the strain of their edges
  speed,      ///< colored by speed
  particles,  ///< only the particles, at their radius
  lattice,    ///< edges of the tets inside soft bodies
  normals,    ///< colored by normal, with a line at every vertex
  contacts    ///< active contacts, as lines along their normals
};
inline constexpr std::size_t display_count = 9;
std::string_view display_name(Display display);
/// Throws Error that lists the names.
Display display_of(std::string_view name);

/// Coloring of constraints drawn over the objects; the viewer's key C cycles through the values.
enum class ConstraintDisplay { none, kind, color, strain, residual };
inline constexpr std::size_t constraint_display_count = 5;
std::string_view constraint_display_name(ConstraintDisplay display);

/// Shape of a liquid's particles before the surface is smoothed.
enum class SplatShape {
  spheres,    ///< balls of one size
  ellipsoids  ///< stretched along the distribution of the neighbors, see souple/surface/splat_shapes.h
};
inline constexpr std::size_t splat_shape_count = 2;
std::string_view splat_shape_name(SplatShape shape);
/// Throws Error that lists the names.
SplatShape splat_shape_of(std::string_view name);

struct DisplayOptions {
  Display display = Display::shaded;
  ConstraintDisplay constraints = ConstraintDisplay::none;
  bool wireframe = false;  ///< added to any display
  bool colliders = true;
  bool pins = true;             ///< pinned vertices as small balls
  float largest_strain = 0.1f;  ///< strain of the hottest color
  float largest_speed = 3;      ///< speed of the hottest color [m/s]
  SplatShape liquid_splats = SplatShape::ellipsoids;
};

/// Converts a subject to a DrawList. Its buffers persist between pictures, so use one instance per subject
/// over time.
class SubjectDrawing {
 public:
  SubjectDrawing();
  ~SubjectDrawing();
  SubjectDrawing(const SubjectDrawing&) = delete;
  SubjectDrawing& operator=(const SubjectDrawing&) = delete;

  /// The list is valid until the next call or until the subject changes. A body's surfaces and spheres have
  /// pick = index in subject.bodies + 1; colliders continue the count.
  const DrawList& update(const Subject& subject, const DisplayOptions& options);
  DrawList& list();  ///< the list of the last update, for additional lines and labels

  /// The object's vertex for a picked element: the tubes of ropes have vertices of their own.
  std::uint32_t vertex_of(const Subject& subject, std::uint32_t pick, std::uint32_t element) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
