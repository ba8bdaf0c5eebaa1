#include "souple/fluid/density_solver.h"

#include "souple/assert.h"
#include "souple/fluid/kernels/find_kernels.h"
#include "souple/fluid/kernels/shapes.h"

#include <algorithm>
#include <array>
#include <atomic>

namespace souple {

namespace {

constexpr float coarse_spacings = 4;     // cell size of the coarse level, in spacings
constexpr float margin_spacings = 0.2f;  // margin of the neighbor lists beyond the support, in spacings
constexpr float coarse_share = 0.5f;     // of the coarse level's lambda; a larger share overshoots
constexpr float jacobi_share = 0.25f;    // of the residual, if no pass follows
float value_at(SmoothingShape shape, float q) {
  switch (shape) {
    case SmoothingShape::poly6_spiky:
      return kernels::Poly6Spiky::value(q);
    case SmoothingShape::cubic_spline:
      return kernels::CubicSpline::value(q);
    case SmoothingShape::wendland:
    case SmoothingShape::wide_wendland:
      break;
  }
  return kernels::Wendland::value(q);
}

/// Calls f(i) for i in [0, n), with work stealing; each i must be worth the cost of an atomic operation. A thread first
/// runs its own part in order, as with Threads::for_each, then takes items of other parts. Parts rarely take equal
/// time, and a core may be unavailable. Results of f must not depend on the calling thread.
template <class Function>
void parallel_for(std::size_t n, Threads& threads, const Function& f) {
  constexpr std::size_t max_parts = 64;
  struct alignas(64) Part {
    std::atomic<std::size_t> next{0};
    std::size_t end = 0;
  };
  std::array<Part, max_parts> part;
  const std::size_t parts = std::min({n, max_parts, static_cast<std::size_t>(std::max(threads.count(), 1))});
  for (std::size_t t = 0; t < parts; ++t) {
    part[t].next.store(n * t / parts, std::memory_order_relaxed);
    part[t].end = n * (t + 1) / parts;
  }
  threads.each(parts, 1, [&](std::size_t t) {
    for (std::size_t k = 0; k < parts; ++k) {
      Part& from = part[(t + k) % parts];
      for (std::size_t i; (i = from.next.fetch_add(1, std::memory_order_relaxed)) < from.end;) f(i);
    }
  });
}

constexpr Vec4f far_away{1e15f, 1e15f, 1e15f, 0};

}  // namespace

DensitySolver::DensitySolver(float spacing, const Options& options)
    : options_(options),
      smoothing_(spacing, options.shape),
      kernels_(&kernels::find_density_kernels(instruction_set(), options.shape)),
      margin_(margin_spacings * spacing) {}

/// for_lists: f(lists of consecutive particles) for all particles, at most this many per call.
constexpr std::uint32_t lists_per_call = 128;

template <class Function>
void DensitySolver::for_lists(Threads& threads, const Function& f) const {
  const auto blocks = neighbors_.blocks();
  parallel_for(blocks.size(), threads, [&](std::size_t b) {
    for (std::uint32_t from = blocks[b].begin; from < blocks[b].end; from += lists_per_call)
      f(blocks[b].lists(from, std::min(from + lists_per_call, blocks[b].end)));
  });
}

void DensitySolver::set_positions(std::span<const Vec4f> positions, Threads& threads) {
  if (!lists_are_valid(positions, threads)) find_neighbors(positions, threads);
  const auto order = order_.order();
  threads.each(size(), 256, [&](std::size_t k) {
    x_[k] = positions[order[k]];
    boundary_[k] = {};
    lambda_[k] = 0;
    moved_[k] = {};
  });
}

// Two particles further apart than support plus margin stay outside the support. To reach it, one must move by half the
// margin relative to the mean motion.
bool DensitySolver::lists_are_valid(std::span<const Vec4f> positions, Threads& threads) {
  if (positions.size() != listed_.size()) return false;
  const auto moved = [&](std::size_t i) { return positions[i].xyz() - listed_[i].xyz(); };
  return 2 * largest_motion_.from_mean(positions.size(), moved, threads) < margin_;
}

void DensitySolver::find_neighbors(std::span<const Vec4f> positions, Threads& threads) {
  const float search_radius = smoothing_.support() + margin_;
  order_.build(positions, search_radius, threads);
  neighbors_.find(order_, search_radius, threads);
  listed_.assign(positions.begin(), positions.end());
  const std::size_t n = positions.size();
  x_.resize(n + 1);
  q_.resize(n + 1);
  threads.each(n, 256, [&](std::size_t k) { x_[k] = positions[order_.order()[k]]; });
  x_[n] = q_[n] = far_away;
  boundary_.resize(n);
  denominator_.resize(n);
  samples_.resize(n);
  lambda_.resize(n);
  change_.resize(n);
  moved_.resize(n);
  coarse_.begin_step(this->positions(), coarse_spacings * smoothing_.spacing(), threads);
}

void DensitySolver::find_fluid_sums(Threads& threads) {
  const float V = smoothing_.volume(), d = smoothing_.spacing();
  const float scaled_volume = V / smoothing_.factors().scale;
  const float least = 1e-3f / (d * d);  // regularization: an isolated particle has no gradient
  const float soft = softness();
  for_lists(threads, [&](const kernels::NeighborLists& lists) {
    std::array<kernels::DensitySums, lists_per_call> found;
    kernels_->sums_of(x_.data(), lists, smoothing_.factors(), found.data());
    for (std::uint32_t k = lists.begin; k < lists.end; ++k) {
      const kernels::DensitySums& sums = found[k - lists.begin];
      const BoundarySums& boundary = boundary_[k];
      const Vec3f G = sums.gradient * V, g = boundary.slope, whole = G + g, rough = G * 2.0f + g;
      samples_[k].c = V * (sums.density + smoothing_.center()) + boundary.value - 1;
      const float w = x_[k].w;
      samples_[k].diagonal = 2 * w * dot(rough, rough) + boundary.local_response + coarse_share * soft;
      denominator_[k] = w * dot(whole, whole) + scaled_volume * scaled_volume * sums.gradient_squared +
                        least * w + boundary.response + soft;
      SOUPLE_ASSERT(!(denominator_[k] < 0), "the response to a pressure is positive");
    }
  });
}

void DensitySolver::start_from_coarse_level(Threads& threads) {
  coarse_.solve(positions(), samples_, surface(), threads);
  coarse_.interpolate(positions(), samples_, surface(), lambda_, threads);
  const float added = options_.passes == 0 ? jacobi_share : 0, soft = softness(), V = smoothing_.volume();
  // Artificial pressure is scaled to W at q = 0.2.
  if (options_.artificial_pressure > 0)
    repulsion_ = {-options_.artificial_pressure * V * V * h_ * h_, 1 / value_at(options_.shape, 0.2f)};
  threads.each(size(), 256, [&](std::size_t k) {
    const float smooth = coarse_share * lambda_[k];
    const float wanted = smooth - added * (samples_[k].c + soft * smooth) / denominator_[k];
    lambda_[k] = change_[k] = min(wanted, 0.0f);
    q_[k] = {x_[k].x, x_[k].y, x_[k].z, lambda_[k] * V};
  });
}

double DensitySolver::mean_error() const {
  double sum = 0;
  for (std::size_t k = 0; k < size(); ++k) sum += std::max(0.0, static_cast<double>(samples_[k].c));
  return size() == 0 ? 0 : sum / static_cast<double>(size());
}

void DensitySolver::relax(Threads& threads) {
  const float soft = softness();
  threads.each(size(), 256, [&](std::size_t k) {
    const float wanted = lambda_[k] - options_.omega * (samples_[k].c + soft * lambda_[k]) / denominator_[k];
    const float next = min(wanted, 0.0f);
    SOUPLE_ASSERT(!(next > 0), "fluids do not pull");
    change_[k] = next - lambda_[k];
    lambda_[k] = next;
    q_[k] = {x_[k].x, x_[k].y, x_[k].z, change_[k] * smoothing_.volume()};
  });
}

void DensitySolver::push_fluid(Threads& threads) {
  for_lists(threads, [&](const kernels::NeighborLists& lists) {
    std::array<Vec3f, lists_per_call> found;
    if (repulsion_.strength == 0)
      kernels_->push_of(q_.data(), lists, smoothing_.factors(), found.data());
    else
      kernels_->repel_of(q_.data(), lists, smoothing_.factors(), repulsion_, found.data());
    for (std::uint32_t k = lists.begin; k < lists.end; ++k) {
      const Vec3f by = (found[k - lists.begin] + boundary_[k].slope * change_[k]) * x_[k].w;
      moved_[k] = moved_[k] + by;
      x_[k].set_xyz(x_[k].xyz() + by);
    }
  });
}

}  // namespace souple
