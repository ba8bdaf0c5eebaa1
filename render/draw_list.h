#pragma once

#include "render/camera.h"
#include "render/color.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/math/mat3.h"
#include "souple/math/transform.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

// The content of a picture in the renderer's terms, without worlds or caches. Spans must be valid until the
// list is drawn.

namespace souple::render {

/// Appearance of a surface.
struct Look {
  Color color = srgb(0xc8c8c8);
  Color second = srgb(0xc8c8c8);  ///< second color of the checker
  float checker_size = 0;         ///< edge of a field, in units of `texture` below [m]; 0: plain `color`
  float roughness = 0.55f;        ///< GGX, in (0, 1]
  float metalness = 0;            ///< in [0, 1]
  float sheen = 0;                ///< light scattered at grazing angles, as by cloth, in [0, 1]
};

/// Triangles, two-sided by default. GPU buffers persist from picture to picture under `key`.
struct Surface {
  std::uint64_t key = 0;             ///< unique among the surfaces of all lists of a renderer
  std::uint64_t topology = 0;        ///< a new number means: triangles and texture changed
  std::uint64_t version = 0;         ///< a new number means: positions, normals and colors changed
  std::span<const Vec3f> positions;  ///< m
  std::span<const Vec3f> normals;    ///< unit, one per vertex; empty: flat shading
  std::span<const Triangle> triangles;
  std::span<const Vec3f> texture;       ///< empty, or per vertex: coordinates in a solid checker
  std::span<const PackedColor> colors;  ///< empty, or one per vertex instead of look.color
  Transform pose{};                     ///< applied to positions and normals
  Look look{};
  bool wireframe = false;  ///< edges drawn over the surface
  bool one_sided = false;  ///< visible, shadow-casting and pickable from the front only
  bool casts_shadow = true;
  std::uint32_t pick = 0;  ///< result of picking; 0: cannot be picked
};

/// Balls, exact at any size.
struct Spheres {
  std::uint64_t key = 0, version = 0;  ///< see Surface
  std::span<const Vec3f> centers;      ///< m
  std::span<const float> radii;        ///< empty: `radius` for all [m]
  float radius = 0.01f;
  std::span<const PackedColor> colors;  ///< empty, or one per ball instead of look.color
  Look look{};
  bool casts_shadow = true;
  std::uint32_t pick = 0;
};

/// Optical properties of a liquid.
struct LiquidLook {
  Vec3f absorption{1.6f, 0.42f, 0.2f};  ///< absorption of red, green and blue light [1/m]
  Vec3f scattering{};                   ///< scattering of red, green and blue light: cloudiness [1/m]
  float refractive_index = 1.33f;       ///< at least 1
  float roughness = 0.08f;              ///< GGX, in (0, 1]
};
/// The absorption after which white light has the color `left` at `distance` meters. Channels are clamped to
/// [0.005, 1].
Vec3f absorption_of(const Color& left, float distance);

/// A liquid, given by its particles and drawn as a smooth transparent body.
struct Liquid {
  std::uint64_t key = 0, version = 0;  ///< see Surface
  std::span<const Vec3f> centers;      ///< m
  float radius = 0.015f;  ///< radius of the balls before smoothing: 0.6 to 0.9 of the spacing [m]
  float spacing = 0.02f;  ///< each particle represents a cube with this edge [m]
  /// Empty, or per particle: an ellipsoid instead of the ball, A times the unit ball [m]. A particle with A =
  /// 0 is invisible and only adds thickness.
  std::span<const Mat3f> ellipsoids;
  LiquidLook look{};
  bool casts_shadow = true;
  std::uint32_t pick = 0;
};

/// Foam, spray and bubbles: small white particles, too many to be distinguished.
struct Foam {
  std::uint64_t key = 0, version = 0;  ///< unique among foams; see Surface
  std::span<const Vec3f> centers;      ///< m
  float radius = 0.01f;                ///< m
  float opacity = 0.5f;                ///< opacity of a particle at its center, in [0, 1)
};

/// A line of constant width on screen.
struct Line {
  Vec3f a, b;  ///< m
  PackedColor color = 0xffffffff;
  float width = 1.5f;  ///< pixels
};

/// Text on the picture.
struct Label {
  std::string text;    ///< UTF-8; '\n' starts a line
  float x = 0, y = 0;  ///< top left corner, rounded to whole pixels
  float size = 16;     ///< height of a line, rounded to a whole number in [6, 128] [pixels]
  Color color = srgb(0xffffff);
  Color background{0, 0, 0, 0};  ///< color of a box slightly larger than the text
};

/// The infinite floor y = height.
struct Ground {
  bool shown = true;
  float height = 0;  ///< m
  Color color = srgb(0xc2c6cb), second = srgb(0xb8bdc3);
  float tile = 0.5f;  ///< m
};

/// The sun and the sky around it.
struct Light {
  Vec3f to_sun{-0.35f, 0.85f, 0.5f};  ///< need not be a unit vector
  float sun = 3.0f;                   ///< irradiance, relative to the exposure
  float sun_size = 2.5f;              ///< apparent radius of the sun: softness of shadows [degrees]
  Color sky = srgb(0xbfd4ee), horizon = srgb(0xeef2f6), floor = srgb(0x9a9894);
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

  Bounds bounds() const;  ///< of all but lines and labels: extent of shadows and depth
};

}  // namespace souple::render
