#include "render/environment.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace souple::render {

std::array<float, 9> harmonics(const Vec3f& n) {
  return {0.282095f,
          0.488603f * n.y,
          0.488603f * n.z,
          0.488603f * n.x,
          1.092548f * n.x * n.y,
          1.092548f * n.y * n.z,
          0.315392f * (3 * n.z * n.z - 1),
          1.092548f * n.x * n.z,
          0.546274f * (n.x * n.x - n.y * n.y)};
}

namespace {

constexpr auto turn = float(2 * pi);

SkyIrradiance irradiance_of(const Panorama& panorama, const EnvironmentOptions& options) {
  std::array<Vec3d, 9> sum{};
  double all = 0;
  for (int y = 0; y < panorama.height; ++y) {
    const float polar = (float(y) + 0.5f) * float(pi) / float(panorama.height);
    const float sine = std::sin(polar), up = std::cos(polar);
    for (int x = 0; x < panorama.width; ++x) {
      const float around = (float(x) + 0.5f) * turn / float(panorama.width) - float(pi) - options.rotation;
      const std::array<float, 9> basis = harmonics({sine * std::sin(around), up, -sine * std::cos(around)});
      const Vec3f light = panorama.at(x, y) * sine;
      for (std::size_t i = 0; i < basis.size(); ++i) sum[i] = sum[i] + Vec3d(light * basis[i]);
    }
    all += double(sine) * panorama.width;
  }
  SkyIrradiance result{};
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const Vec3d part = sum[i] * (4 * pi / all * double(cosine_lobe[i] * options.strength));
    result[i] = {float(part.x), float(part.y), float(part.z), 0};
  }
  return result;
}

}  // namespace

Environment::Environment(Panorama panorama, const EnvironmentOptions& options)
    : panorama_(std::move(panorama)), options_(options), irradiance_(irradiance_of(panorama_, options)) {}

Vec3f Environment::radiance(const Vec3f& direction) const {
  const float around = std::atan2(direction.x, -direction.z) + float(pi) + options_.rotation;
  const float part = around / turn - std::floor(around / turn);
  const float down = std::acos(std::clamp(direction.y, -1.0f, 1.0f)) / float(pi);
  const int x = std::min(static_cast<int>(part * float(panorama_.width)), panorama_.width - 1);
  const int y = std::min(static_cast<int>(down * float(panorama_.height)), panorama_.height - 1);
  return panorama_.at(x, y) * options_.strength;
}

}  // namespace souple::render
