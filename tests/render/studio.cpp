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
  list.surfaces.push_back({.key = 1,
                           .positions = world_.positions(cloth_),
                           .normals = world_.normals(cloth_),
                           .triangles = world_.triangles(cloth_),
                           .texture = cloth_rest_,
                           .look = {.color = srgb(0xd9483b),
                                    .second = srgb(0xf1e3d3),
                                    .checker_size = 0.1f,
                                    .roughness = 0.8f,
                                    .sheen = 0.5f},
                           .pick = 1});
  list.surfaces.push_back(ball_.surface(2, true, {0, 0.42, 0}, srgb(0x6f7f92)));
  list.surfaces.push_back(box_.surface(3, false, {0.85, 0.3, -0.35}, srgb(0x4a7fb5)));
  list.surfaces.push_back(small_box_.surface(4, false, {-0.6, 0.12, 0.75}, srgb(0xe0a030)));
  list.surfaces.push_back({.key = 5,
                           .positions = world_.positions(ring_),
                           .normals = world_.normals(ring_),
                           .triangles = world_.triangles(ring_),
                           .look = {.color = srgb(0x4fae7a), .roughness = 0.35f},
                           .pick = 5});
  list.spheres.push_back({.key = 6,
                          .centers = world_.positions(grains_),
                          .radius = 0.035f,
                          .look = {.color = srgb(0xd8b365)},
                          .pick = 6});
  return list;
}

}  // namespace souple::render
