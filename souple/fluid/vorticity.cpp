#include "souple/fluid/vorticity.h"

namespace souple {

void VorticityConfinement::apply(const FluidView& fluid, float epsilon, float h, Threads& threads) {
  const Smoothing& smoothing = fluid.smoothing;
  const float V = smoothing.volume();
  omega_.resize(fluid.size());
  strength_.resize(fluid.size() + 1);
  fluid.for_lists(threads, [&](std::uint32_t k, std::span<const std::uint32_t> list) {
    omega_[k] = V * velocity_->curl(fluid.x.data(), fluid.v.data(), fluid.x[k], fluid.v[k], list.data(),
                                    list.size(), smoothing.factors());
    strength_[k] = fluid.x[k];
    strength_[k].w = length(omega_[k]);
  });
  strength_.back() = fluid.x.back();
  fluid.for_lists(threads, [&](std::uint32_t k, std::span<const std::uint32_t> list) {
    // The push kernel adds q_i + q_j; a negated q_i gives the difference.
    Vec4f at = strength_[k];
    at.w = -at.w;
    const Vec3f eta = V * density_->push(strength_.data(), at, list.data(), list.size(), smoothing.factors());
    const float least = 0.01f * strength_[k].w / smoothing.spacing();
    const float size = length(eta) + least;
    if (size > 0) fluid.v[k].set_xyz(fluid.v[k].xyz() + cross(eta, omega_[k]) * (h * epsilon / size));
  });
}

}  // namespace souple
