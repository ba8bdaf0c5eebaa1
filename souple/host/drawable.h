#pragma once

#include "souple/host/session.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace souple::host {

/// An object of a session as a simple renderer draws it: triangles with a normal per vertex, or balls. For
/// renderers that show triangles from one side only, a cloth can have two sides, each half its thickness and
/// at least 1 mm from the middle, with a rim that closes it; the balls of a rope are close enough to look
/// like one.
class Drawable {
 public:
  enum class Sides {
    one,  ///< the object's own vertices and triangles
    two   ///< of a scene's cloth: those, the other side's, the rim's; the others stay as they are
  };
  /// Throws Error when the session has no such object.
  Drawable(Session& session, Handle object, Sides sides = Sides::one);

  Handle object() const { return object_; }
  /// Balls instead of triangles: of ropes and grains.
  bool balls() const { return triangles_.empty(); }
  float radius() const { return radius_; }  ///< of a ball [m]

  /// Takes the vertices from the session as they are now. Throws Error when the object is gone.
  void update(Session& session);
  const std::vector<float>& positions() const { return drawn_positions_; }  ///< x, y, z
  const std::vector<float>& normals() const { return drawn_normals_; }      ///< x, y, z; none of balls
  const std::vector<std::uint32_t>& triangles() const { return triangles_; }
  std::size_t vertex_count() const { return drawn_positions_.size() / 3; }
  /// The object's vertex that is drawn as vertex `drawn`; of a rope the nearer of two.
  std::uint32_t vertex_of(std::uint32_t drawn) const;

 private:
  struct Ball {  // between two vertices of the object
    std::uint32_t a, b;
    float t;
  };
  struct Border {  // an edge of the rim; seen from the first side, the cloth lies to the left of a to b
    std::uint32_t a, b;
  };
  void add_other_side();
  void add_rim();
  void place_balls(Session& session);
  void draw_sides();
  void draw_rim();
  void draw_balls();

  Handle object_;
  float radius_;
  std::size_t object_vertices_;
  bool two_sided_ = false;
  std::vector<std::uint32_t> triangles_;
  std::vector<Border> borders_;
  std::vector<Ball> balls_;
  std::vector<float> positions_, normals_;  // of the object
  std::vector<float> drawn_positions_, drawn_normals_;
};

}  // namespace souple::host
