#include <souple/souple.h>

int main() {
  souple::World world({.substeps = 10});  // meters, kilograms, seconds; Y up, right-handed
  auto cloth = world.add_cloth(souple::grid(64, 64, 2.0f), souple::material::cotton);
  world.pin(cloth, souple::vertices({0, 63}));
  world.add_collider(souple::Sphere{.center = {0, -1, 0}, .radius = 0.5f}, {.friction = 0.4f});

  souple::Recorder recorder(world, "out");  // out/run.json, out/cloth.obj, out/cloth.pc2
  for (int frame = 0; frame < 240; ++frame) {
    world.step(1.0f / 60.0f);
    recorder.capture();
  }
}
