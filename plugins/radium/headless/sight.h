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

  /// About `count` of them, here and there on objects that have triangles; of each, the pixel is nearer to it
  /// than to the other corners of its triangle.
  std::vector<VisibleVertex> visible_vertices(std::size_t count) const;

 private:
  struct Triangle {
    PickedVertex first_corner;
    std::array<Ra::Core::Vector3, 3> corners;
    float thickness;  // of an object; less than 0 of what cannot be grabbed
  };
  void add(const RenderMesh& mesh, float thickness);
  /// nullptr when the ray meets nothing.
  const Triangle* first_met(const Ra::Core::Ray& ray) const;

  Window& window_;
  std::vector<Triangle> triangles_;
};

}  // namespace souple::radium
