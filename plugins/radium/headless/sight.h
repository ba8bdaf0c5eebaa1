#pragma once

#include "plugins/radium/headless/window.h"

#include <array>

namespace souple::radium {

/// A vertex that is to be seen at a pixel.
struct VisibleVertex {
  Ra::Core::Vector2 pixel;
  PickedVertex vertex;
  Ra::Core::Vector3 point;  ///< where it is drawn [m]
  float thickness = 0;      ///< how far from there the object's own vertex may be [m]
};

/// What a window shows, found by rays of our own and not by OpenGL.
class Sight {
 public:
  /// As all lies now.
  Sight(Window& window, PhysicsSystem& system);

  /// About `count` of them, here and there. Of a triangle's, the pixel is nearer to it than to the other
  /// corners; of a splat's, it is in the middle.
  std::vector<VisibleVertex> visible_vertices(std::size_t count) const;

 private:
  struct Target {  // a triangle, or a ball about the first corner
    PickedVertex vertex;
    std::array<Ra::Core::Vector3, 3> corners;
    float ball_radius;  // m; 0 of a triangle
    float thickness;    // of an object; less than 0 of what cannot be grabbed
    bool faces_us;      // by its normals: Radium picks nothing else
  };
  void add(const RenderMesh& mesh, const host::ObjectInfo* object);
  static float distance_along(const Ra::Core::Ray& ray, const Target& target);
  /// nullptr when the ray meets nothing.
  const Target* first_met(const Ra::Core::Ray& ray) const;

  Window& window_;
  std::vector<Target> targets_;
};

}  // namespace souple::radium
