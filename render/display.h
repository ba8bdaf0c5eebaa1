#pragma once

#include "render/draw_list.h"
#include "render/subject.h"

#include <array>
#include <memory>
#include <string_view>
#include <vector>

namespace souple::render {

/// How objects are shown; the viewer's keys 1 to 9, and `--display`.
enum class Display {
  shaded,     ///< one color each, lit; cloth with a checker
  plain,      ///< the same without checker
  wireframe,  ///< with the edges of the triangles
  strain,     ///< surfaces colored by how much their edges are stretched
  speed,      ///< colored by speed
  particles,  ///< the particles alone, at their radius
  lattice,    ///< edges of the tets inside soft bodies
  normals,    ///< colored by normal, with a line at every vertex
  contacts    ///< contacts that push, as lines along their normal
};
inline constexpr std::size_t display_count = 9;
std::string_view display_name(Display display);
/// Throws Error that lists the names.
Display display_of(std::string_view name);

/// How constraints are drawn over the objects; the viewer's key C goes through them.
enum class ConstraintDisplay { none, kind, color, strain, residual };
inline constexpr std::size_t constraint_display_count = 5;
std::string_view constraint_display_name(ConstraintDisplay display);

/// What each particle of a liquid is drawn as, before the surface is smoothed.
enum class SplatShape {
  spheres,    ///< the same ball for all
  ellipsoids  ///< stretched as the particles around lie, see souple/surface/splat_shapes.h
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
  float largest_strain = 0.1f;  ///< what the hottest color means
  float largest_speed = 3;      ///< m/s, likewise
  SplatShape liquid_splats = SplatShape::ellipsoids;
};

/// Turns a subject into what the renderer draws. Keeps the buffers it needs between pictures, so use one for
/// one subject over time.
class SubjectDrawing {
 public:
  SubjectDrawing();
  ~SubjectDrawing();
  SubjectDrawing(const SubjectDrawing&) = delete;
  SubjectDrawing& operator=(const SubjectDrawing&) = delete;

  /// The list stays valid until the next call or until the subject changes. A body's surfaces and spheres
  /// have pick = position in subject.bodies + 1; a collider's are counted on from there.
  const DrawList& update(const Subject& subject, const DisplayOptions& options);
  DrawList& list();  ///< of the last update, to add lines and labels to

  /// A vertex of the object from what picking returned: ropes are drawn as tubes whose vertices are not the
  /// object's.
  std::uint32_t vertex_of(const Subject& subject, std::uint32_t pick, std::uint32_t element) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
