// Compiled as C++20, which the library's own headers require.
#include "plugins/radium/headless/pure_run.h"

#include <souple/error.h>
#include <souple/scene/scene.h>
#include <souple/world/world.h>

namespace souple::radium {

PureRun run_scene(const std::string& file, int frames, double dt) {
  World world = build_world(load_scene(file));
  for (int frame = 1; frame <= frames; ++frame)
    if (!world.step(dt).ok()) throw Error(file + ": step " + std::to_string(frame) + " diverged");
  PureRun run{world.hash(), {}};
  for (const ObjectId object : world.objects()) {
    std::vector<float>& positions = run.positions[std::string(world.name(object))];
    for (const Vec3f& x : world.positions(object)) positions.insert(positions.end(), {x.x, x.y, x.z});
  }
  return run;
}

View view_of_scene(const std::string& file) {
  const CameraDescription camera = load_scene(file).camera;
  const Vec3f from(camera.from), to(camera.to);
  return {{from.x, from.y, from.z}, {to.x, to.y, to.z}, static_cast<float>(camera.fov)};
}

}  // namespace souple::radium
