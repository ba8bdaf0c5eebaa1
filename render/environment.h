#pragma once

#include "render/hdr.h"
#include "render/mat4.h"
#include "souple/math/vec3.h"

#include <array>

namespace souple::render {

/// Second-order spherical harmonics of the light that a white, diffuse surface reflects: irradiance / pi.
using SkyIrradiance = std::array<Vec4, 9>;
inline constexpr std::array<float, 9> cosine_lobe{1,     2 / 3.0f, 2 / 3.0f, 2 / 3.0f, 0.25f,
                                                  0.25f, 0.25f,    0.25f,    0.25f};  ///< over pi, by order
/// Real spherical harmonics up to order 2 of a unit vector, with Y as the first axis.
std::array<float, 9> harmonics(const Vec3f& n);

struct EnvironmentOptions {
  float rotation = 0;      ///< about Y, counterclockwise from above [rad]
  float strength = 1;      ///< factor of the radiance
  float sun = 0;           ///< irradiance of Light's sun, relative to the exposure
  bool background = true;  ///< drawn behind the scene; otherwise the procedural sky is
};

/// Light from all directions, of a panorama whose middle is in the direction of -Z.
class Environment {
 public:
  Environment(Panorama panorama, const EnvironmentOptions& options);

  const Panorama& panorama() const { return panorama_; }
  const EnvironmentOptions& options() const { return options_; }
  /// With the strength and the rotation of the options. Ramamoorthi and Hanrahan 2001, "An efficient representation
  /// for irradiance environment maps", eq. 12.
  const SkyIrradiance& irradiance() const { return irradiance_; }
  /// Radiance from a unit direction: that of the nearest pixel, with the strength and the rotation.
  Vec3f radiance(const Vec3f& direction) const;

 private:
  Panorama panorama_;
  EnvironmentOptions options_;
  SkyIrradiance irradiance_{};
};

}  // namespace souple::render
