#include "render/sky.h"

#include <algorithm>
#include <cmath>

namespace souple::render {

namespace {

constexpr int sky_rings = 24, sectors = 24;  ///< of the grid of directions

Vec3f vec3(const Color& c) {
  return {c.r, c.g, c.b};
}

Vec3f scaled(const Vec3f& a, const Vec3f& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

/// Share of the horizon's color at this height above it: 1 / the series of exp(9 h) up to h^2.
float haze(float height) {
  return 1 / (1 + height * (9 + 40 * height));
}

}  // namespace

Sky sky_of(const Light& light, const Ground& ground) {
  Sky sky{vec3(light.sky), vec3(light.horizon), vec3(light.floor), normalized(light.to_sun), ground.shown};
  if (!ground.shown) return sky;
  const Vec3f above = irradiance_at(sky_irradiance(sky), {0, 1, 0});
  const Vec3f sun = vec3(sun_color) * (light.sun * std::max(sky.to_sun.y, 0.0f) / float(pi));
  sky.floor = scaled((vec3(ground.color) + vec3(ground.second)) * 0.5f, above + sun);
  return sky;
}

Vec3f sky_radiance(const Sky& sky, const Vec3f& direction) {
  const bool above = direction.y > 0;
  const float height = above ? direction.y : -direction.y * (sky.has_floor ? 3.0f : 1.0f);
  const Vec3f far = above ? sky.zenith : sky.floor;
  // Haze ends higher for blue light than for red: the sky is blue, not gray, above the horizon.
  const Vec3f share{haze(1.6f * height), haze(height), haze(0.55f * height)};
  Vec3f light = far + scaled(sky.horizon - far, share);
  // The sun is not drawn, but the air around it glows.
  const float cosine = above ? std::max(dot(direction, sky.to_sun), 0.0f) : 0.0f;
  const float c2 = cosine * cosine, c4 = c2 * c2, c8 = c4 * c4, c16 = c8 * c8, c32 = c16 * c16;
  return light + sky.horizon * (0.12f * c4 + 0.5f * c32 * c32);
}

SkyIrradiance sky_irradiance(const Sky& sky) {
  SkyIrradiance result{};
  const float area = 4 * float(pi) / float(sky_rings * sectors);  // rings of equal height have equal areas
  for (int ring = 0; ring < sky_rings; ++ring) {
    const float y = (float(ring) + 0.5f) * 2 / float(sky_rings) - 1, r = std::sqrt(1 - y * y);
    for (int sector = 0; sector < sectors; ++sector) {
      const float angle = (float(sector) + 0.5f) * 2 * float(pi) / float(sectors);
      const Vec3f direction{r * std::cos(angle), y, r * std::sin(angle)};
      const Vec3f light = sky_radiance(sky, direction) * area;
      const std::array<float, 9> basis = harmonics(direction);
      for (std::size_t i = 0; i < basis.size(); ++i) {
        const Vec3f part = light * (basis[i] * cosine_lobe[i]);
        result[i] = {result[i].x + part.x, result[i].y + part.y, result[i].z + part.z, 0};
      }
    }
  }
  return result;
}

Vec3f irradiance_at(const SkyIrradiance& irradiance, const Vec3f& normal) {
  const std::array<float, 9> basis = harmonics(normal);
  Vec3f sum{};
  for (std::size_t i = 0; i < basis.size(); ++i)
    sum = sum + Vec3f{irradiance[i].x, irradiance[i].y, irradiance[i].z} * basis[i];
  return sum;
}

}  // namespace souple::render
