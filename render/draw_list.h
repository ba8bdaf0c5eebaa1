#pragma once

#include "render/camera.h"
#include "render/color.h"
#include "render/environment.h"
#include "render/image.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/math/mat3.h"
#include "souple/math/transform.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

// The content of one picture as the renderer draws it, independent of worlds and caches. Spans must stay
// valid until the list is drawn.

namespace souple::render {

/// A print of two colors on fields of Look::checker_size; shaders/pattern.glsl draws it.
enum class Pattern { checker, stripes, plaid, dots, strands };

/// Appearance of a surface.
struct Look {
  Color color = srgb(0xc8c8c8);
  Color second = srgb(0xc8c8c8);  ///< second color of the pattern
  Pattern pattern = Pattern::checker;
  float checker_size = 0;   ///< edge of a field, in units of Surface::texture [m]; 0: only `color`
  float weave = 0;          ///< contrast of woven threads over the pattern, in [0, 1]
  float roughness = 0.55f;  ///< GGX, in (0, 1]
  float metalness = 0;      ///< in [0, 1]
  float sheen = 0;          ///< light scattered at grazing angles, as by cloth, in [0, 1]
  float translucency =
      0;  ///< light spread under the surface, as in jelly, in [0, 1]; excludes sheen and metalness
  bool glass = false;  ///< transparent and refracting; `color` is the tint of light through one wall
};

/// The UVs of a triangle's corners.
using CornerUvs = std::array<std::array<float, 2>, 3>;

/// Triangles, two-sided by default. The renderer keeps their buffers on the GPU between pictures, under
/// `key`.
struct Surface {
  std::uint64_t key = 0;               ///< unique among the surfaces of all lists drawn by one renderer
  std::uint64_t topology = 0;          ///< changes when triangles or texture have changed
  std::uint64_t version = 0;           ///< changes when positions, normals or colors have changed
  std::span<const Vec3f> positions{};  ///< m
  std::span<const Vec3f> normals{};    ///< unit, one per vertex; empty: flat shading
  std::span<const Triangle> triangles{};
  std::span<const Vec3f> texture{};       ///< empty, or each vertex's coordinates in a solid checker
  std::shared_ptr<const Image> print{};   ///< printed over look.color where `uvs` say; nullptr: none
  std::span<const CornerUvs> uvs{};       ///< of `print`, one per triangle; v = 0 is the picture's lower edge
  std::span<const PackedColor> colors{};  ///< empty, or one per vertex instead of look.color
  Transform pose{};                       ///< transforms positions and normals
  Look look{};
  bool wireframe = false;  ///< edges drawn over the surface
  bool one_sided = false;  ///< visible, lit by the sun and pickable only from its front
  bool casts_shadow = true;
  std::uint32_t pick = 0;  ///< value returned by picking; 0: cannot be picked
};

/// Balls, exact at any size.
struct Spheres {
  std::uint64_t key = 0, version = 0;  ///< as in Surface
  std::span<const Vec3f> centers{};    ///< m
  std::span<const float> radii{};      ///< empty: `radius` for all [m]
  float radius = 0.01f;
  std::span<const PackedColor> colors{};  ///< empty, or one per ball instead of look.color
  Look look{};
  bool casts_shadow = true;
  std::uint32_t pick = 0;
};

/// Optical properties of a liquid.
struct LiquidLook {
  Vec3f absorption{1.6f, 0.42f, 0.2f};  ///< of red, green and blue light [1/m]
  /// Makes the liquid cloudy: scattering coefficients of red, green and blue light [1/m].
  Vec3f scattering{};
  float refractive_index = 1.33f;  ///< at least 1
  float roughness = 0.08f;         ///< GGX, in (0, 1]
};
/// The absorption with which white light has this color after `distance` meters. Channels are clamped to
/// [0.005, 1].
Vec3f absorption_of(const Color& left, float distance);

/// A liquid, given by the particles that fill it: drawn as one smooth, clear volume.
struct Liquid {
  std::uint64_t key = 0, version = 0;  ///< as in Surface
  std::span<const Vec3f> centers{};    ///< m
  float radius = 0.015f;  ///< radius of the balls whose surface is smoothed: 0.6 to 0.9 of the spacing [m]
  float spacing = 0.02f;  ///< each particle represents a cube with this edge [m]
  /// Empty, or an ellipsoid instead of each ball: A times the unit ball [m]. A particle with A = 0 is
  /// invisible and only adds to the liquid's thickness.
  std::span<const Mat3f> ellipsoids{};
  LiquidLook look{};
  bool casts_shadow = true;
  std::uint32_t pick = 0;
};

/// Foam, spray and bubbles: small white particles, too many to be distinguished.
struct Foam {
  std::uint64_t key = 0, version = 0;  ///< `key` is unique among foams; as in Surface
  std::span<const Vec3f> centers{};    ///< m
  float radius = 0.01f;                ///< m
  float opacity = 0.5f;                ///< of one particle at its center, in [0, 1)
};

/// A line of constant width on screen.
struct Line {
  Vec3f a, b;  ///< m
  PackedColor color = 0xffffffff;
  float width = 1.5f;  ///< pixels
};

/// Text on the picture.
struct Label {
  std::string text{};  ///< UTF-8; '\n' starts a line
  float x = 0, y = 0;  ///< top left corner, rounded to whole pixels
  float size = 16;     ///< height of a line, rounded to a whole number in [6, 128] [pixels]
  Color color = srgb(0xffffff);
  Color background{0, 0, 0, 0};  ///< color of a box behind the text, a little larger than it
};

/// The infinite floor y = height.
struct Ground {
  bool shown = true;
  float height = 0;                                       ///< m
  Color color = srgb(0x80786d), second = srgb(0x5f5a52);  ///< range of the concrete's colors
  float tile = 0.5f;                                      ///< edge of a slab [m]
};

/// Color of sunlight: warmer than the sky, so shadows look cool. As sun_color in lighting.glsl.
inline constexpr Color sun_color{1.10f, 1.0f, 0.86f};

/// The sun and the sky. Sunlight is about four times the light of the sky on a level surface.
struct Light {
  Vec3f to_sun{-0.45f, 0.8f, 0.5f};  ///< need not be a unit vector
  float sun = 4.0f;                  ///< irradiance, relative to the exposure
  float sun_size = 2.5f;             ///< apparent radius [degrees]: the softness of shadows
  Color sky{0.12f, 0.25f, 0.52f}, horizon{0.92f, 0.80f, 0.66f};  ///< radiance at zenith and horizon
  Color floor{0.12f, 0.11f, 0.10f};  ///< radiance below the horizon where there is no floor
  bool caustics = false;             ///< liquids refract sunlight onto the floor
  /// Panorama instead of that sky, and the sun's irradiance of its options instead of `sun`; nullptr: none.
  std::shared_ptr<const Environment> environment;
};

struct DrawList {
  std::vector<Surface> surfaces;
  std::vector<Spheres> spheres;
  std::vector<Liquid> liquids;
  std::vector<Foam> foams;
  std::vector<Line> lines;      ///< hidden by objects in front of them
  std::vector<Line> top_lines;  ///< never hidden
  std::vector<Label> labels;
  Ground ground{};
  Light light{};

  Bounds bounds() const;  ///< bounds of all elements but lines and labels, for shadows and depth
};

}  // namespace souple::render
