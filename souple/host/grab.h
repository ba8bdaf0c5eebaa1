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

/// A damped spring from the picked point of an object to the mouse. Its force is limited to max_force, so
/// fast and far mouse motions cannot make the object explode. It acts on the picked vertex and on its
/// neighborhood, because a force on a single vertex would stretch a thin cloth out of shape.
///
/// The destructor releases the object. A grab may outlive its object (which ends the grab) and its world, and
/// another world may be assigned to its world. During the grab the world must not be moved to another
/// address. A restored snapshot does not end the grab.
class Grab {
 public:
  /// `vertex`: in user order; `point`: the picked position [m]; both as in a Hit. A pinned vertex cannot be
  /// grabbed: the grab is then inactive. Throws Error if there is no such vertex, a number is not finite or
  /// negative, or during a step.
  Grab(World& world, const ObjectId& object, std::uint32_t vertex, const Vec3f& point,
       const GrabOptions& options = {});
  ~Grab();
  Grab(Grab&&) noexcept;
  Grab& operator=(Grab&&) noexcept;

  /// Sets the target of the picked point [m], from the next substep on. Throws Error if it is not finite.
  void move_to(const Vec3f& point);
  /// Ends the grab; also valid in a callback during a step.
  void release() noexcept;
  bool holds() const;

  Vec3f target() const;  ///< m
  /// Position of the picked point after the last substep. [m]
  Vec3f point() const;
  float max_force() const;  ///< N

 private:
  std::shared_ptr<GrabState> state_;
};

}  // namespace souple
