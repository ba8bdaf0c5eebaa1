#pragma once

#include "render/passes/pass_context.h"

#include <memory>
#include <span>

namespace souple::render {

/// Render targets of the particles of liquids and foams.
enum class SplatTarget {
  depth,      ///< depth along the view, and the liquid's look
  thickness,  ///< additive: optical depth and thickness in front of opaque objects, and the scattered part
  sunlight,   ///< additive: optical depth seen from the sun; and the minimum depth
  foam,       ///< additive: coverage by foam
  pick        ///< see Target::pick
};
inline constexpr int splat_target_count = 5;

/// The particles of liquids and foams as splats.
class LiquidSplats {
 public:
  LiquidSplats();
  ~LiquidSplats();

  /// Uploads changed data and frees buffers of removed objects. Call once per picture.
  void update(std::span<const Liquid> liquids, std::span<const Foam> foams);
  /// Whether there is anything to draw.
  bool empty() const;
  bool casts_shadow() const;
  /// Whether there is foam, or a liquid that scatters light.
  bool is_cloudy() const;
  /// Draws the splats given to `update`, without changing the blend state: for sunlight those that cast
  /// shadows, for pick those that can be picked. Requires the bound uniform block; for foam and thickness
  /// also the depth maps.
  void draw(SplatTarget target) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
