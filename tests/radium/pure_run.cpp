// Compiled as C++20, which the library's own headers require.
#include "tests/radium/pure_run.h"

#include <souple/scene/scene.h>
#include <souple/world/world.h>
#include <stdexcept>

namespace souple::radium {

std::uint64_t hash_of_pure_run(const std::string& file, int frames, double dt) {
  World world = build_world(load_scene(file));
  for (int frame = 0; frame < frames; ++frame)
    if (!world.step(dt).ok()) throw std::runtime_error(file + " diverged");
  return world.hash();
}

}  // namespace souple::radium
