#pragma once

#include "render/passes/pass_context.h"

#include <memory>
#include <span>

namespace souple::render {

/// Render targets for the particles of liquids and foams.
enum class SplatTarget {
  depth,  ///< depth along the view, and the liquid's look
  /// Summed: optical depth and thickness in front of opaque objects, and the part of the optical depth due to
  /// scattering.
  thickness,
  sunlight,  ///< optical depth from the sun, summed; and minimum depth
  foam,      ///< summed: occlusion by foam
  pick       ///< as Target::pick
};
inline constexpr int splat_target_count = 5;

/// Draws the particles of liquids and foams as splats.
class LiquidSplats {
 public:
  LiquidSplats();
  ~LiquidSplats();

  /// Uploads changes and deletes the buffers of removed liquids and foams. Once per picture.
  void update(std::span<const Liquid> liquids, std::span<const Foam> foams);
  /// Whether there is nothing to draw.
  bool empty() const;
  bool casts_shadow() const;
  /// Whether there is foam, or a liquid that scatters light.
  bool is_cloudy() const;
  /// Absorption and scattering of all liquids together [1/m]; w: 1, or 0 where two liquids differ.
  Vec4 extinction() const;
  /// Draws the liquids and foams of the last `update`, without changing the blend state. Target sunlight
  /// includes only those that cast a shadow, target pick those that can be picked. Requires the uniform block
  /// to be bound; for foam and thickness also the depth maps.
  /// `scale`: of target thickness, pixels of the depth map per pixel.
  void draw(SplatTarget target, int scale = 1) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
