#include "studio.h"

#include "souple/world/world.h"

namespace souple::render {

namespace {

ObjectOptions placed(const Vec3d& at) {
  ObjectOptions options;
  options.transform.translation = at;
  return options;
}

// 6 x 6 x 5 grains, each layer with a small offset from the layer below.
std::vector<Vec3d> heap() {
  std::vector<Vec3d> centers;
  centers.reserve(180);
  for (int layer = 0; layer < 5; ++layer) {
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 6; ++column) {
        centers.emplace_back(-1.05 + 0.071 * column + 0.004 * layer, 0.05 + 0.071 * layer,
                             0.45 + 0.071 * row);
      }
    }
  }
  return centers;
}

}  // namespace

Studio::Studio(int steps, int cloth_side)
    : ball_(sphere(5, 0.412)), box_(box({0.4, 0.6, 0.4})), small_box_(box({0.24, 0.24, 0.24})) {
  world_.add_collider(Plane{});
  world_.add_collider(Sphere{.center = {0, 0.42f, 0}, .radius = 0.42f}, {.friction = 0.3f});
  world_.add_collider(Box{.center = {0.85f, 0.3f, -0.35f}, .half_extents = {0.2f, 0.3f, 0.2f}});
  const TriangleMesh sheet = grid(cloth_side, cloth_side, 1.6);
  cloth_ = world_.add_cloth(sheet, {.bending_stiffness = 2e-4f, .thickness = 0.01f}, placed({0, 0.95, 0}));
  for (const Vec3d& x : sheet.positions) cloth_rest_.push_back(Vec3f(x));
  ring_ = world_.add_soft_body(torus(0.2, 0.08, 40, 20), {.young_modulus = 3e4f}, {.cells = 900},
                               placed({0.85, 0.75, -0.35}));
  grains_ = world_.add_grains(heap(), {.radius = 0.035f});
  for (int i = 0; i < steps; ++i) world_.step(1.0 / 60);
}

DrawList Studio::list() const {
  DrawList list;
  Surface cloth;
  cloth.key = 1;
  cloth.pick = 1;
  cloth.positions = world_.positions(cloth_);
  cloth.normals = world_.normals(cloth_);
  cloth.triangles = world_.triangles(cloth_);
  cloth.texture = cloth_rest_;
  cloth.look.color = srgb(0xd9483b);
  cloth.look.second = srgb(0xf1e3d3);
  cloth.look.checker_size = 0.1f;
  cloth.look.roughness = 0.8f;
  cloth.look.sheen = 0.5f;
  list.surfaces.push_back(cloth);
  list.surfaces.push_back(ball_.surface(2, true, {0, 0.42, 0}, srgb(0x6f7f92)));
  list.surfaces.push_back(box_.surface(3, false, {0.85, 0.3, -0.35}, srgb(0x4a7fb5)));
  list.surfaces.push_back(small_box_.surface(4, false, {-0.6, 0.12, 0.75}, srgb(0xe0a030)));
  Surface ring;
  ring.key = 5;
  ring.pick = 5;
  ring.positions = world_.positions(ring_);
  ring.normals = world_.normals(ring_);
  ring.triangles = world_.triangles(ring_);
  ring.look.color = srgb(0x4fae7a);
  ring.look.roughness = 0.35f;
  list.surfaces.push_back(ring);
  Spheres grains;
  grains.key = 6;
  grains.pick = 6;
  grains.centers = world_.positions(grains_);
  grains.radius = 0.035f;
  grains.look.color = srgb(0xd8b365);
  list.spheres.push_back(grains);
  return list;
}

}  // namespace souple::render
