#pragma once

#include "plugins/radium/headless/window.h"

#include <array>

namespace souple::radium {

/// A vertex that is visible at a pixel.
struct VisibleVertex {
  Ra::Core::Vector2 pixel;
  PickedVertex vertex;
  Ra::Core::Vector3 point;  ///< drawn position [m]
  float thickness = 0;      ///< maximum distance of the object's own vertex from `point` [m]
};

/// Visible vertices of a window, found by ray casting instead of OpenGL.
class Sight {
 public:
  /// Reads the current positions.
  Sight(Window& window, PhysicsSystem& system);

  /// About `count` visible vertices, distributed over the picture. The pixel is nearer to a triangle's vertex
  /// than to its other corners; for a splat it is at the center.
  std::vector<VisibleVertex> visible_vertices(std::size_t count) const;

 private:
  struct Target {  // a triangle, or a ball around the first corner
    PickedVertex vertex;
    std::array<Ra::Core::Vector3, 3> corners;
    float ball_radius;  // m; 0 for a triangle
    float thickness;    // thickness of the object; < 0: cannot be grabbed
    bool faces_us;      // by its normals: Radium picks only front faces
  };
  void add(const RenderMesh& mesh, const host::ObjectInfo* object);
  static float distance_along(const Ra::Core::Ray& ray, const Target& target);
  /// nullptr if the ray hits no target.
  const Target* first_met(const Ra::Core::Ray& ray) const;

  Window& window_;
  std::vector<Target> targets_;
};

}  // namespace souple::radium
