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

// What one picture shows, in the renderer's terms: it knows neither worlds nor caches. Spans have to live
// until the list is drawn.

namespace souple::render {

/// What a surface is made of.
struct Look {
  Color color = srgb(0xc8c8c8);
  Color second = srgb(0xc8c8c8);  ///< the other fields of the checker
  float checker_size = 0;         ///< edge of a field, in units of `texture` below [m]; 0: plain `color`
  float roughness = 0.55f;        ///< GGX, in (0, 1]
  float metalness = 0;            ///< in [0, 1]
  float sheen = 0;                ///< light scattered at grazing angles, as by cloth, in [0, 1]
};

/// Triangles, drawn from both sides unless told otherwise. Buffers on the GPU are kept from picture to
/// picture under `key`.
struct Surface {
  std::uint64_t key = 0;             ///< unique among the surfaces of all lists drawn by one renderer
  std::uint64_t topology = 0;        ///< another number: triangles and texture have changed
  std::uint64_t version = 0;         ///< another number: positions, normals and colors have changed
  std::span<const Vec3f> positions;  ///< m
  std::span<const Vec3f> normals;    ///< unit, one per vertex; empty: flat shading
  std::span<const Triangle> triangles;
  std::span<const Vec3f> texture;       ///< empty, or where each vertex lies in a solid checker
  std::span<const PackedColor> colors;  ///< empty, or one per vertex instead of look.color
  Transform pose{};                     ///< applied to positions and normals
  Look look{};
  bool wireframe = false;  ///< edges drawn over the surface
  bool one_sided = false;  ///< seen (and dark to the sun, and picked) from its front only
  bool casts_shadow = true;
  std::uint32_t pick = 0;  ///< what picking returns; 0: cannot be picked
};

/// Balls, exact at any size.
struct Spheres {
  std::uint64_t key = 0, version = 0;  ///< as of a Surface
  std::span<const Vec3f> centers;      ///< m
  std::span<const float> radii;        ///< empty: `radius` for all [m]
  float radius = 0.01f;
  std::span<const PackedColor> colors;  ///< empty, or one per ball instead of look.color
  Look look{};
  bool casts_shadow = true;
  std::uint32_t pick = 0;
};

/// What a liquid does to light.
struct LiquidLook {
  Vec3f absorption{1.6f, 0.42f, 0.2f};  ///< of red, green and blue light [1/m]
  Vec3f scattering{};                   ///< what makes it cloudy, likewise
  float refractive_index = 1.33f;       ///< at least 1
  float roughness = 0.08f;              ///< GGX, in (0, 1]
};
/// The absorption that leaves white light this color after `distance` meters. Channels are taken to lie in
/// [0.005, 1].
Vec3f absorption_of(const Color& left, float distance);

/// A liquid, given by the particles that fill it: drawn as one smooth, clear body.
struct Liquid {
  std::uint64_t key = 0, version = 0;  ///< as of a Surface
  std::span<const Vec3f> centers;      ///< m
  float radius = 0.015f;  ///< of the balls whose surface is smoothed: 0.6 to 0.9 of the spacing [m]
  float spacing = 0.02f;  ///< each particle stands for a cube with this edge [m]
  /// Empty, or an ellipsoid instead of each ball, A times the unit ball [m]. Where A is 0 nothing is seen of
  /// the particle: it only makes the liquid thicker.
  std::span<const Mat3f> ellipsoids;
  LiquidLook look{};
  bool casts_shadow = true;
  std::uint32_t pick = 0;
};

/// Foam, spray and bubbles: small white particles, too many to be distinguished.
struct Foam {
  std::uint64_t key = 0, version = 0;  ///< unique among foams; as of a Surface
  std::span<const Vec3f> centers;      ///< m
  float radius = 0.01f;                ///< m
  float opacity = 0.5f;                ///< of one in its middle, in [0, 1)
};

/// A line of constant width on screen.
struct Line {
  Vec3f a, b;  ///< m
  PackedColor color = 0xffffffff;
  float width = 1.5f;  ///< pixels
};

/// Words on the picture.
struct Label {
  std::string text;    ///< UTF-8; '\n' starts a line
  float x = 0, y = 0;  ///< top left corner, rounded to whole pixels
  float size = 16;     ///< height of a line, rounded to a whole number in [6, 128] [pixels]
  Color color = srgb(0xffffff);
  Color background{0, 0, 0, 0};  ///< a box behind it, reaching a little beyond the text
};

/// The endless floor y = height.
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
  float sun_size = 2.5f;              ///< its apparent radius [degrees]: how soft shadows are
  Color sky = srgb(0xbfd4ee), horizon = srgb(0xeef2f6), floor = srgb(0x9a9894);
};

struct DrawList {
  std::vector<Surface> surfaces;
  std::vector<Spheres> spheres;
  std::vector<Liquid> liquids;
  std::vector<Foam> foams;
  std::vector<Line> lines;      ///< hidden by what lies before them
  std::vector<Line> top_lines;  ///< never hidden
  std::vector<Label> labels;
  Ground ground{};
  Light light{};

  Bounds bounds() const;  ///< of all but lines and labels: what shadows and depth have to enclose
};

}  // namespace souple::render
