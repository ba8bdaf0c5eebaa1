#pragma once

#include "souple/multilevel/hierarchical_levels.h"
#include "souple/solver/kernels/links.h"
#include "souple/threads/threads.h"

namespace souple {

/// Projections of links are multiplied by this in all sweeps but the last.
inline constexpr float over_relaxation = 1.6f;

/// The kernels of links for the processor's instruction set.
const kernels::LinkKernels& link_kernels();
/// Projects the links of each color n times. The last sweep is plain, those before it are over-relaxed by omega.
/// `color_begin`: first slot of each color, and the number of slots.
void sweep_colors(const kernels::LinkArrays& links, std::span<const std::size_t> color_begin, int n,
                  float omega, std::span<Vec4f> moving, Threads& threads);

/// Links of a coarse level as sweeps use them: sorted by color, each color padded to whole registers. A slot is
/// a place in this order.
class LevelLinks {
 public:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  LevelLinks() = default;
  /// `links`: the links of `map` to take; those between two fixed particles come last and are not swept. `moving`
  /// and `position` of the level have one record per particle and one more, zero, for the ends of padding.
  LevelLinks(const CoarseLevel& map, std::span<const std::uint32_t> links);

  std::size_t slots() const { return link_.size(); }
  /// The link in a slot; `none`: padding.
  std::uint32_t link(std::size_t slot) const { return link_[slot]; }
  /// The slot of each link up to the last one that is here.
  std::vector<std::uint32_t> slot_of_link() const;
  /// Number of links that are swept.
  std::size_t swept() const { return swept_; }
  /// Sets g of a slot, 1 / (w_J + w_K + alpha~). [kg]
  void set_gain(std::size_t slot, float gain) { gain_[slot] = gain; }

  /// Limits of all slots at the start of the substep.
  void measure(const kernels::LinkMeasures& from, Threads& threads);
  /// Takes over the limits that its links have in `all`.
  void copy_limits(const LevelLinks& all, std::span<const std::uint32_t> slot_in_all);
  /// Projects every link n times. The last sweep is plain, those before it are over-relaxed by omega.
  void sweep(int n, float omega, std::span<Vec4f> moving, Threads& threads);

 private:
  kernels::LinkArrays arrays();
  void add(const CoarseLevel& map, std::uint32_t link);
  void pad(const CoarseLevel& map);

  std::vector<std::uint32_t> link_, a_, b_;                        // per slot
  std::vector<float> x_, y_, z_, min_length_, max_length_, gain_;  // per slot
  std::vector<std::size_t> color_begin_{0};                        // of swept slots
  std::size_t swept_ = 0;
};

}  // namespace souple
