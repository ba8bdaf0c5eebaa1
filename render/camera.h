#pragma once

#include "render/mat4.h"
#include "souple/math/vec3.h"

#include <optional>
#include <span>

namespace souple::render {

/// An axis-aligned box; empty while lo > hi.
struct Bounds {
  Vec3f lo{1e30f, 1e30f, 1e30f}, hi{-1e30f, -1e30f, -1e30f};  ///< m

  bool empty() const { return lo.x > hi.x; }
  void add(const Vec3f& point, float radius = 0);
  void add(const Bounds& other);
  Vec3f center() const { return (lo + hi) * 0.5f; }
  float radius() const { return empty() ? 0 : length(hi - lo) * 0.5f; }  ///< radius of the enclosing ball [m]
};

struct Ray {
  Vec3f origin, direction;  ///< direction is a unit vector
};

/// A point on screen: pixels from the top left corner, y down; the center of the first pixel is (0.5, 0.5).
struct ScreenPoint {
  float x = 0, y = 0;
  float depth = 0;  ///< distance along the view direction [m]
};

/// Fractions of a picture's width and height.
struct Fraction {
  float width = 0, height = 0;
};

/// A camera that orbits a target. Y is up.
class Camera {
 public:
  Vec3f from{2, 1.5f, 3}, to{0, 0.5f, 0};  ///< m
  float fov = 40;                          ///< vertical [degrees], in (1, 170)

  /// `aspect` is width / height. The near and far planes enclose `scene` tightly enough for a 24 bit depth
  /// buffer.
  Mat4 view() const;
  Mat4 projection(float aspect, const Bounds& scene) const;

  Vec3f forward() const;  ///< unit
  Vec3f right() const;    ///< unit
  Vec3f up() const;       ///< unit
  float distance() const { return length(to - from); }

  /// The ray through a point of a picture of this size.
  Ray ray(float x, float y, int width, int height) const;
  /// Screen position of a point; empty if it is behind the eye.
  std::optional<ScreenPoint> project(const Vec3f& point, int width, int height) const;
  /// Fractions of a picture that the box around the points on screen fills; points behind the eye do not count.
  Fraction filled(std::span<const Vec3f> points, float aspect) const;
  /// World length of one pixel at this depth. [m]
  float pixel_size(float depth, int height) const;

  /// Rotates about the target [rad]: yaw > 0 counterclockwise as seen from above, pitch > 0 upwards. Stops
  /// just before the poles.
  void orbit(float yaw, float pitch);
  /// Moves eye and target by a mouse motion in pixels of a picture of this height (y down). A point at the target's
  /// depth stays under the mouse.
  void pan(float dx, float dy, int height);
  /// Scales the distance to the target; > 1 moves away. Clamped to [1e-3, 1e5] m.
  void zoom(float factor);
  /// Keeps the view direction and moves the camera so that the box fills the picture, centered, with some
  /// margin.
  void frame(const Bounds& box, float aspect);
  /// Likewise for points [m]; without points the camera stays.
  void frame(std::span<const Vec3f> points, float aspect);
  /// Turns the camera about its target if framed points would fill less than 35 % of the picture's width or height. It
  /// takes the smallest multiple of 15 degrees that fills 35 % of both and shows at least 75 % of the points' length.
  /// It turns around the vertical and up to 30 degrees upwards. If no turn suffices, as for a vertical rope, the camera
  /// stays.
  void turn_to_fill(std::span<const Vec3f> points, float aspect);
};

}  // namespace souple::render
