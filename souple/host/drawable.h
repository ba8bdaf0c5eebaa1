#pragma once

#include "souple/host/session.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace souple::host {

/// An object of a session for a simple renderer: triangles with a normal per vertex, or balls. For renderers
/// that show only the front of triangles, a cloth can have two sides and a rim that closes it. Each side is
/// half the thickness, and at least 1 mm, from the middle. The balls of a rope overlap to look like a tube.
class Drawable {
 public:
  enum class Sides {
    one,  ///< the object's own vertices and triangles
    two   ///< a scene's cloth: also the back side and the rim; other objects: as `one`
  };
  /// Throws Error if the session has no such object.
  Drawable(Session& session, Handle object, Sides sides = Sides::one);

  Handle object() const { return object_; }
  /// Whether the object is drawn as balls: ropes and grains.
  bool balls() const { return triangles_.empty(); }
  float radius() const { return radius_; }  ///< of a ball [m]

  /// Reads the current vertices from the session. Throws Error if the object was removed.
  void update(Session& session);
  const std::vector<float>& positions() const { return drawn_positions_; }  ///< x, y, z
  const std::vector<float>& normals() const { return drawn_normals_; }      ///< x, y, z; empty for balls
  const std::vector<std::uint32_t>& triangles() const { return triangles_; }
  std::size_t vertex_count() const { return drawn_positions_.size() / 3; }
  /// The object's vertex for the drawn vertex `drawn`; for a rope, the nearer end of its segment.
  std::uint32_t vertex_of(std::uint32_t drawn) const;

 private:
  struct Ball {  // between two vertices of the object
    std::uint32_t a, b;
    float t;
  };
  struct Border {  // an edge of the rim; seen from the front, the cloth is to the left of a -> b
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
