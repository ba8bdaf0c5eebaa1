#pragma once

#include "render/checker.h"
#include "render/display.h"
#include "render/tube.h"
#include "render/vertex_colors.h"
#include "souple/geometry/creased_surface.h"
#include "souple/surface/splat_shapes.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace souple::render {

/// Balls that stand for an object's particles.
struct ParticleCloud {
  std::vector<Vec3f> centers;
  std::vector<float> radii;

  void clear() {
    centers.clear();
    radii.clear();
  }
};

/// Properties of the whole picture for drawing one object.
struct Drawing {
  const DisplayOptions& options;
  const HeatScale& heat;
  std::uint64_t frame = 0;  ///< frame of the subject
  bool has_world = false;
  Threads& threads;
  DrawList& list;
};

/// Draws one object; its buffers persist from picture to picture.
class BodyDrawing {
 public:
  /// `index` chooses its colors; `key` and `key` + 1 are those of its surface and its balls.
  BodyDrawing(const Body& body, std::uint32_t index, std::uint64_t key);

  /// Whether the body's mesh is unchanged.
  bool fits(const Body& body) const;
  /// Adds the object to the list. Fill `particles()` first if particles are drawn. `rope_strain`: per point,
  /// or empty.
  void draw(const Body& body, std::uint32_t pick, std::span<const float> rope_strain, const Drawing& drawing);

  /// The vertex of the body for an element of the drawn geometry.
  std::uint32_t vertex_of(const Body& body, std::uint32_t element) const;

  ParticleCloud& particles() { return particles_; }
  Bounds bounds(const Body& body) const;
  float mean_edge() const { return mean_edge_; }       ///< mean edge of the mesh; 2 radii without a mesh [m]
  bool draws_particles(const Drawing& drawing) const;  ///< the world's particles instead of the surface
  bool draws_liquid(const Drawing& drawing) const;     ///< a liquid surface instead of particles

 private:
  /// Inputs of the current GPU buffers.
  struct Shown {
    std::uint64_t frame = 0;
    const Vec3f* positions = nullptr;
    Display display = Display::shaded;
    bool pale = false;
    SplatShape splats = SplatShape::spheres;
    float largest = 0, radius = 0;
    friend bool operator==(const Shown&, const Shown&) = default;
  };

  Look own_look() const;
  Look look(const Drawing& drawing) const;
  void refresh(const Body& body, std::span<const float> rope_strain, const Drawing& drawing);
  void shape_splats(const Body& body, Threads& threads);
  std::span<const float> values(const Body& body, std::span<const float> rope_strain, Display display);
  void set_colors(const Body& body, std::span<const float> rope_strain, const Drawing& drawing);
  void draw_surface(const Body& body, std::uint32_t pick, const Drawing& drawing);
  void draw_tube(std::uint32_t pick, const Drawing& drawing);
  void draw_liquid(const Body& body, std::uint32_t pick, const Drawing& drawing);
  void draw_grains(const Body& body, std::uint32_t pick, const Drawing& drawing);
  void draw_particles(const Body& body, std::uint32_t pick, const Drawing& drawing);
  void draw_normals(const Body& body, DrawList& list) const;

  ObjectKind kind_;
  std::uint32_t index_;
  std::optional<Color> chosen_;
  std::uint64_t key_;
  std::size_t vertices_, triangle_count_;
  const Triangle* triangles_;
  float mean_edge_ = 0, density_;

  std::uint64_t version_ = 0, topology_ = 0;
  Shown shown_;
  bool as_particles_ = false;
  Checker checker_;
  Tube tube_;
  CreasedSurface creased_;  ///< for soft bodies with sharp edges
  EdgeStrain strain_;
  bool has_strain_ = false;
  std::vector<float> values_;        ///< per vertex
  std::vector<PackedColor> colors_;  ///< per vertex or per vertex of the tube; or empty
  std::vector<PackedColor> grain_colors_;
  ParticleCloud particles_;
  std::optional<SplatShapes> splats_;  ///< for a liquid drawn as ellipsoids
};

}  // namespace souple::render
