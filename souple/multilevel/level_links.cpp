#include "souple/multilevel/level_links.h"

#include "souple/assert.h"
#include "souple/simd/instruction_set.h"
#include "souple/solver/coloring.h"
#include "souple/solver/kernels/find_kernels.h"
#include "souple/solver/kernels/links.h"

namespace souple {
namespace {

/// Slots per color are a multiple of this: the link_lanes of the widest register.
constexpr std::size_t link_lanes = 16;
/// Minimum number of slots per thread. Levels with smaller colors are swept by one thread, all colors in one call.
constexpr std::size_t link_grain = 512;

Vec3f difference(const float* records, std::uint32_t a, std::uint32_t b) {
  return {records[a] - records[b], records[a + 1] - records[b + 1], records[a + 2] - records[b + 2]};
}

// The scalar versions of the packed kernels (compile_links.h).

void measure_links(const kernels::LinkArrays& links, const kernels::LinkMeasures& m, std::size_t begin,
                   std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    const float now = length(difference(m.start, m.start_a[i], m.start_b[i]));
    float ratio = kernels::link_ratio(now, m.rest_length[i]);
    if (m.path_length) {
      ratio = max(ratio, kernels::path_ratio(m.path_length[i], m.stretch[i], m.rest_length[i]));
    } else {
      m.stretch[i] = now - m.rest_length[i];
    }
    const Vec3f X = difference(m.position, links.a[i], links.b[i]);
    const kernels::LinkLimits<float> limits(X, difference(m.moving, links.a[i], links.b[i]), ratio);
    links.x[i] = X.x, links.y[i] = X.y, links.z[i] = X.z;
    links.min_length[i] = limits.min_length, links.max_length[i] = limits.max_length;
  }
}

void sweep_links(const kernels::LinkArrays& links, float* moving, std::size_t begin, std::size_t end,
                 float relaxation) {
  for (std::size_t i = begin; i < end; ++i) {
    float *const d_a = moving + links.a[i], *const d_b = moving + links.b[i];
    const Vec3f u = Vec3f{links.x[i], links.y[i], links.z[i]} + difference(moving, links.a[i], links.b[i]);
    const Vec3f p =
        kernels::link_correction(u, links.min_length[i], links.max_length[i], relaxation * links.gain[i]);
    for (int axis = 0; axis < 3; ++axis) d_a[axis] -= d_a[3] * p[axis], d_b[axis] += d_b[3] * p[axis];
  }
}

// One lane of the packed kernels.

void find_stretched(const kernels::ParticleLinks& links, const float* position, const float* moving,
                    std::uint16_t* stretched, std::size_t begin, std::size_t end) {
  for (std::size_t k = begin; k < end; ++k) {
    unsigned bits = 0;
    for (std::size_t lane = 0; lane < link_lanes; ++lane) {
      const std::size_t i = link_lanes * k + lane;
      const Vec3f u =
          difference(position, links.a[i], links.b[i]) + difference(moving, links.a[i], links.b[i]);
      if (dot(u, u) > links.longest[i] * links.longest[i]) bits |= 1u << lane;
    }
    stretched[k] = static_cast<std::uint16_t>(bits);
  }
}

void measure_stretched(const kernels::LinkArrays& links, const kernels::StretchedMeasures& m,
                       const float* position, const float* moving, float* gain, std::size_t begin,
                       std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3f X = difference(position, links.a[i], links.b[i]);
    const Vec3f u = X + difference(moving, links.a[i], links.b[i]);
    links.x[i] = X.x, links.y[i] = X.y, links.z[i] = X.z;
    links.max_length[i] = m.longest[i];
    links.min_length[i] = min(m.longest[i] * m.shortest_part, length(u));
    gain[i] = kernels::stretched_gain(m.compliance[i], m.inverse_mass[i], m.softest, m.sweeps_over_h2);
  }
}

}  // namespace

const kernels::LinkKernels& link_kernels() {
  static constexpr kernels::LinkKernels scalar{measure_links, sweep_links, find_stretched, measure_stretched};
  const kernels::LinkKernels* packed = find_link_kernels(instruction_set());
  return packed ? *packed : scalar;
}

LevelLinks::LevelLinks(const CoarseLevel& map, std::span<const std::uint32_t> links) {
  std::vector<std::uint32_t> ends, swept, fixed;
  for (const std::uint32_t e : links) {
    const auto [a, b] = std::pair(map.links[e].a, map.links[e].b);
    if (map.mass[a] == 0 && map.mass[b] == 0) {
      fixed.push_back(e);
    } else {
      swept.push_back(e), ends.push_back(a), ends.push_back(b);
    }
  }
  swept_ = swept.size();
  const Coloring colors = color_constraints(ends, 2, map.mass.size());
  for (std::size_t c = 0; c + 1 < colors.color_begin.size(); ++c) {
    for (std::size_t k = colors.color_begin[c]; k < colors.color_begin[c + 1]; ++k)
      add(map, swept[colors.order[k]]);
    pad(map);
    color_begin_.push_back(slots());
  }
  for (const std::uint32_t e : fixed) add(map, e);
  pad(map);
  gain_.assign(slots(), 1);
  x_ = y_ = z_ = min_length_ = max_length_ = gain_;
}

void LevelLinks::add(const CoarseLevel& map, std::uint32_t link) {
  link_.push_back(link);
  a_.push_back(4 * map.links[link].a), b_.push_back(4 * map.links[link].b);
}

void LevelLinks::pad(const CoarseLevel& map) {
  const auto last = static_cast<std::uint32_t>(4 * map.mass.size());
  while (slots() % link_lanes != 0) link_.push_back(none), a_.push_back(last), b_.push_back(last);
}

std::vector<std::uint32_t> LevelLinks::slot_of_link() const {
  std::vector<std::uint32_t> slot;
  for (std::uint32_t s = 0; s < slots(); ++s) {
    if (link_[s] == none) continue;
    if (link_[s] >= slot.size()) slot.resize(link_[s] + std::size_t{1});
    slot[link_[s]] = s;
  }
  return slot;
}

kernels::LinkArrays LevelLinks::arrays() {
  return {a_.data(), b_.data(),          x_.data(),          y_.data(),
          z_.data(), min_length_.data(), max_length_.data(), gain_.data()};
}

void LevelLinks::measure(const kernels::LinkMeasures& from, Threads& threads) {
  const kernels::LinkArrays links = arrays();
  threads.for_each(slots() / link_lanes, link_grain / link_lanes, [&](std::size_t begin, std::size_t end) {
    link_kernels().measure(links, from, begin * link_lanes, end * link_lanes);
  });
}

void LevelLinks::copy_limits(const LevelLinks& all, std::span<const std::uint32_t> slot_in_all) {
  for (std::size_t i = 0; i < slots(); ++i) {
    if (link_[i] == none) continue;
    const std::uint32_t k = slot_in_all[i];
    x_[i] = all.x_[k], y_[i] = all.y_[k], z_[i] = all.z_[k];
    min_length_[i] = all.min_length_[k], max_length_[i] = all.max_length_[k];
  }
}

void LevelLinks::sweep(int n, float omega, std::span<Vec4f> moving, Threads& threads) {
  sweep_colors(arrays(), color_begin_, n, omega, moving, threads);
}

void sweep_colors(const kernels::LinkArrays& links, std::span<const std::size_t> color_begin, int n,
                  float omega, std::span<Vec4f> moving, Threads& threads) {
  const kernels::SweepLinks sweep_links = link_kernels().sweep;
  float* const d = &moving.data()->x;
  const std::size_t colors = color_begin.size() - 1;
  SOUPLE_ASSERT(color_begin.back() % link_lanes == 0, "colors are padded to whole registers");
  const bool one_thread = color_begin.back() < 2 * link_grain * colors;
  for (int s = 1; s <= n; ++s) {
    const float relaxation = s < n ? omega : 1;
    if (one_thread) {
      sweep_links(links, d, 0, color_begin.back(), relaxation);
      continue;
    }
    for (std::size_t c = 0; c < colors; ++c)
      threads.for_each((color_begin[c + 1] - color_begin[c]) / link_lanes, link_grain / link_lanes,
                       [&](std::size_t begin, std::size_t end) {
                         sweep_links(links, d, color_begin[c] + begin * link_lanes,
                                     color_begin[c] + end * link_lanes, relaxation);
                       });
  }
}

}  // namespace souple
