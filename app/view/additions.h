#pragma once

#include "souple/scene/scene.h"

#include <array>
#include <filesystem>

// Objects that a user adds to a running scene: balls that are thrown, objects from a menu, mesh files.

namespace souple::viewer {

/// A stiff ball: one region of shape matching, so that it rolls, and presses on cloth and fluids.
struct Ball {
  float radius = 0.1f;  ///< m
  float mass = 1;       ///< kg
  float speed = 5;      ///< m/s
};

/// A ball that suits a view of this distance [m]. It is a twentieth of the distance large, half as dense as water, and
/// falls by a fifth of the distance on its way.
Ball ball_for(float distance, float gravity);
/// The unit direction in which a ball from `from` meets `target` on its ballistic path under `gravity` [m/s^2]. It is
/// straight toward the target if the speed is too low. [m]
Vec3f aim(const Vec3f& from, const Vec3f& target, float speed, const Vec3f& gravity);

/// An object to add, and a ball that contains it in its own coordinates.
struct NewObject {
  AnyObjectDescription description;
  Vec3d center{};     ///< m
  double radius = 0;  ///< m
};

/// The ball that leaves `from` [m] along the unit direction.
AnyObjectDescription thrown(const Ball& ball, const Vec3f& from, const Vec3f& direction);

enum class Addition { cloth, soft_ball, stiff_box, rope, grains };
inline constexpr std::array<Addition, 5> all_additions{Addition::cloth, Addition::soft_ball,
                                                       Addition::stiff_box, Addition::rope, Addition::grains};
const char* label(Addition addition);
/// An object about `size` [m] large.
NewObject described(Addition addition, double size);
/// A mesh file as an object: a soft body if its surface is closed, else a cloth. Throws Error when the file
/// cannot be read.
NewObject described(const std::filesystem::path& mesh_file);

/// The object above a point, at the first place with free space around it.
AnyObjectDescription placed_above(const Vec3f& point, const World& world, const NewObject& object);

}  // namespace souple::viewer
