#include "souple/stages/pins.h"

#include "souple/error.h"
#include "souple/math/limits.h"
#include "souple/objects/object.h"

#include <fmt/format.h>

namespace souple {

Vec3d target_at(const Target& target, std::uint32_t vertex, double time, std::string_view object) {
  const Vec3d x = target(vertex, time);
  if (!is_within(x, range::coordinate))
    throw Error(
        fmt::format("its position for vertex {}{}{} at {:g} s is not finite, or more than {:g} m from the "
                    "origin",
                    vertex, object.empty() ? "" : " of ", object, time, range::coordinate));
  return x;
}

void drive_pins(const StageView& stage, const Substep& substep, double part) {
  const ObjectsView& objects = stage.objects;
  const double t = stage.time + static_cast<double>(substep.h);
  std::vector<Vec4f>& p = objects.particles.offset;
  for (const auto& object : objects.objects) {
    for (const PinnedParticle& pin : object->pins) {
      if (!pin.target && !pin.arrival) continue;
      const std::uint32_t i = object->begin + pin.particle;
      Vec3d goal = objects.particles.exact_position(i);
      if (pin.arrival)
        goal = part == 1 ? *pin.arrival : pin.from + (*pin.arrival - pin.from) * part;
      else
        stage.warnings.guarded("a pin's target", [&] {
          goal = target_at(*pin.target, pin.vertex, t, object->name) + pin.offset;
        });
      p[i].set_xyz(Vec3f(goal - Vec3d(objects.particles.position[i].xyz())));
    }
  }
}

}  // namespace souple
