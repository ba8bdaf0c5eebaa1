#include "souple/fluid/xsph.h"

namespace souple {

float wall_friction(const Smoothing& smoothing, float value) {
  const float d = smoothing.spacing();
  return 2 / (d * d) * value / smoothing.wall(0.5f * d).value;
}

void Xsph::apply(const FluidView& fluid, WallFriction walls, float h, Threads& threads) {
  const Smoothing& smoothing = fluid.smoothing;
  const float V = smoothing.volume(), d = smoothing.spacing();
  // Across an axis only the two lattice layers at distance d lie within the support. Each has V sum W =
  // value(d/2), the part that a wall there would replace. So along each of the three axes V sum W x^2 = 2 d^2
  // value(d/2). The wide kernel extends slightly into the next layers; rates stay within 7 %.
  const float m2 = 6 * d * d * smoothing.wall(0.5f * d).value;
  next_.resize(fluid.size());
  fluid.for_lists(threads, [&](std::uint32_t k, std::span<const std::uint32_t> list) {
    const Vec4f& v = fluid.v[k];
    const Vec3f exchange = kernels_->exchange(fluid.x.data(), fluid.v.data(), fluid.x[k], v, list.data(),
                                              list.size(), smoothing.factors());
    next_[k] = v.xyz() + exchange * (h * fluid.x[k].w * V * V * 6 / m2);
    if (walls.empty()) return;
    const float wall_drag = h * fluid.x[k].w * V * v.w * wall_friction(smoothing, walls[k].w);
    next_[k] = (next_[k] + walls[k].xyz() * wall_drag) * (1 / (1 + wall_drag));
  });
  for_each_index(fluid.size(), threads, [&](std::size_t k) { fluid.v[k].set_xyz(next_[k]); });
}

}  // namespace souple
