#include "souple/stages/pins.h"

#include "souple/objects/object.h"

namespace souple {

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
        stage.warnings.guarded("a pin's target", [&] { goal = (*pin.target)(pin.vertex, t) + pin.offset; });
      p[i].set_xyz(Vec3f(goal - Vec3d(objects.particles.position[i].xyz())));
    }
  }
}

}  // namespace souple
