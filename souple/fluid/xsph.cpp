#include "souple/fluid/xsph.h"

namespace souple {

float wall_friction(const Smoothing& smoothing, float value) {
  const float d = smoothing.spacing();
  return 2 / (d * d) * value / smoothing.wall(0.5f * d).value;
}

void Xsph::apply(const FluidView& fluid, WallFriction walls, float h, Threads& threads) {
  const Smoothing& smoothing = fluid.smoothing;
  const float V = smoothing.volume(), d = smoothing.spacing();
  // On the lattice only the two layers beside a plane lie within the support, and off it: half of W's sum
  // over each is what half a spacing of wall hides, so m2 = 3 directions x 2 layers x d^2 value(d/2).
  const float m2 = 6 * d * d * smoothing.wall(0.5f * d).value;
  next_.resize(fluid.size());
  fluid.for_lists(threads, [&](std::uint32_t k, std::span<const std::uint32_t> list) {
    const Vec4f& v = fluid.v[k];
    const Vec3f exchange = kernels_->exchange(fluid.x.data(), fluid.v.data(), fluid.x[k], v, list.data(),
                                              list.size(), smoothing.factors());
    next_[k] = v.xyz() + exchange * (h * fluid.x[k].w * V * V * 6 / m2);
    if (walls.empty()) return;
    const float rub = h * fluid.x[k].w * V * v.w * wall_friction(smoothing, walls[k].w);
    next_[k] = (next_[k] + walls[k].xyz() * rub) * (1 / (1 + rub));
  });
  for_places(fluid.size(), threads, [&](std::size_t k) { fluid.v[k].set_xyz(next_[k]); });
}

}  // namespace souple
