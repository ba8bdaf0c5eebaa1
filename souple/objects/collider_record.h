#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/collision/shapes.h"
#include "souple/objects/handles.h"
#include "souple/objects/object_options.h"

#include <cstdint>
#include <memory>

namespace souple {

struct Arrival;

/// A collider in a world.
struct ColliderRecord {
  ColliderId id;
  ColliderOptions options;
  Shape shape;
  std::shared_ptr<Arrival> arrival{};  ///< `options.motion`, once move_collider has set it
  ColliderMotion given{};              ///< the motion before
  std::uint64_t user_data = 0;
  std::uint64_t since = 0;  ///< number of steps before it was added
};

}  // namespace souple
