#pragma once

#include "render/passes/pass_context.h"

#include <memory>
#include <span>

namespace souple::render {

/// What the particles of liquids and foams are drawn into.
enum class SplatTarget {
  depth,      ///< depth along the view, and the liquid's look
  thickness,  ///< added: optical depth and thickness before the opaque objects; and its part by scattering
  sunlight,   ///< added: optical depth as the sun sees it; and the least depth
  foam,       ///< added: what foam hides
  pick        ///< as of Target::pick
};
inline constexpr int splat_target_count = 5;

/// The particles of liquids and foams as splats.
class LiquidSplats {
 public:
  LiquidSplats();
  ~LiquidSplats();

  /// Uploads what has changed and drops the buffers of what is gone. Once per picture.
  void update(std::span<const Liquid> liquids, std::span<const Foam> foams);
  /// Whether there is anything to draw.
  bool empty() const;
  bool casts_shadow() const;
  /// Whether there is foam, or a liquid that scatters light.
  bool is_cloudy() const;
  /// Those that were given to `update`, without changing what is blended; of target sunlight those that cast
  /// a shadow, of target pick those that can be picked. The uniform block is bound; for foam and thickness
  /// the depth maps too.
  void draw(SplatTarget target) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
