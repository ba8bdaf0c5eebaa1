#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <memory>

// Valid C++17: for plugins too.

namespace souple {

class World;
struct ObjectId;
struct GrabState;

struct GrabOptions {
  float max_force = 0;  ///< N; 0: 20 times the object's weight
  float stiffness = 0;  ///< N/m; 0: max_force at 20 cm
};

/// A hand on an object: a damped spring from the picked point to where the mouse is, as strong as max_force
/// and no stronger, so nothing explodes however far and fast the mouse moves. It takes hold of the picked
/// vertex and of those around it, for a pull at one vertex alone would stretch a thin cloth out of shape.
///
/// Let go of when it is destroyed. It may outlive the object, which it then holds no longer, and the world,
/// or another world may take the world's place by assignment; but while it holds, the world must not be moved
/// elsewhere. When a snapshot is restored it goes on holding.
class Grab {
 public:
  /// `vertex` in user order, `point` where it was picked [m], as a Hit tells them. A pinned vertex cannot be
  /// grabbed: the grab then holds nothing. Throws Error when there is no such vertex, a number is not finite
  /// or negative, or a step runs.
  Grab(World& world, const ObjectId& object, std::uint32_t vertex, const Vec3f& point,
       const GrabOptions& options = {});
  ~Grab();
  Grab(Grab&&) noexcept;
  Grab& operator=(Grab&&) noexcept;

  /// Where the picked point has to go [m]; acts from the next substep on. Throws Error when it is not finite.
  void move_to(const Vec3f& point);
  /// Also lets go when a callback of a step calls it.
  void release() noexcept;
  bool holds() const;

  Vec3f target() const;  ///< m
  /// Where the picked point is, as of the last substep. [m]
  Vec3f point() const;
  float max_force() const;  ///< N

 private:
  std::shared_ptr<GrabState> state_;
};

}  // namespace souple
