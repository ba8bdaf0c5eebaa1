#pragma once

#include "render/draw_list.h"
#include "souple/souple.h"

#include <vector>

// A scene for visual inspection: a cloth that has fallen on a ball, boxes, a soft ring, grains.

namespace souple::render {

/// A static mesh as a surface.
class Solid {
 public:
  explicit Solid(const TriangleMesh& mesh) : positions_(mesh.positions.size()), triangles_(mesh.triangles) {
    for (std::size_t i = 0; i < positions_.size(); ++i) positions_[i] = Vec3f(mesh.positions[i]);
    for (std::size_t i = 0; i < positions_.size(); ++i) normals_.push_back(normalized(positions_[i]));
  }
  /// `smooth`: normals point away from the origin, as on a ball.
  Surface surface(std::uint64_t key, bool smooth, const Vec3d& at, const Color& color) const {
    Surface s;
    s.key = key;
    s.positions = positions_;
    if (smooth) s.normals = normals_;
    s.triangles = triangles_;
    s.pose.translation = at;
    s.look.color = s.look.second = color;
    s.pick = std::uint32_t(key);
    return s;
  }

 private:
  std::vector<Vec3f> positions_, normals_;
  std::vector<Triangle> triangles_;
};

class Studio {
 public:
  explicit Studio(int steps, int cloth_side = 64);
  /// Spans refer to the studio.
  DrawList list() const;
  static Camera camera() {
    Camera camera;
    camera.from = {2.1f, 1.45f, 2.7f};
    camera.to = {0.1f, 0.33f, 0};
    camera.fov = 32;
    return camera;
  }

 private:
  World world_;
  ObjectId cloth_, ring_, grains_;
  std::vector<Vec3f> cloth_rest_;
  Solid ball_, box_, small_box_;
};

}  // namespace souple::render
