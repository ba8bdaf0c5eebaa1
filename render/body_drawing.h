#pragma once

#include "render/checker.h"
#include "render/display.h"
#include "render/tube.h"
#include "render/vertex_colors.h"
#include "souple/geometry/creased_surface.h"
#include "souple/objects/kind_traits.h"
#include "souple/surface/splat_shapes.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace souple::render {

/// Balls that represent an object's particles.
struct ParticleCloud {
  std::vector<Vec3f> centers;
  std::vector<float> radii;

  void clear() {
    centers.clear();
    radii.clear();
  }
};

/// Data of the whole picture that drawing one object needs.
struct DrawContext {
  const DisplayOptions& options;
  const HeatScale& heat;
  std::uint64_t frame = 0;  ///< frame number of the subject
  bool has_world = false;
  Threads& threads;
  DrawList& list;
};

/// Draws one object and keeps its buffers between pictures.
class BodyDrawing {
 public:
  /// `index` selects its colors; `key` and `key` + 1 are the keys of its surface and of its balls.
  BodyDrawing(const Body& body, std::uint32_t index, std::uint64_t key);

  /// Whether the body still has the mesh it had at construction.
  bool fits(const Body& body) const;
  /// Adds the object to the list. Where particles are shown, `particles()` must be filled. `rope_strain` is
  /// per point; empty if unknown.
  void draw(const Body& body, std::uint32_t pick, std::span<const float> rope_strain,
            const DrawContext& context);

  /// The body's vertex for an element of the drawn geometry.
  std::uint32_t vertex_of(const Body& body, std::uint32_t element) const;

  ParticleCloud& particles() { return particles_; }
  Bounds bounds(const Body& body) const;
  /// Mean edge length of the mesh; without a mesh 2 radii [m].
  float mean_edge() const { return mean_edge_; }
  bool draws_particles(const DrawContext& context) const;  ///< the world's particles instead of the surface
  bool draws_liquid(const DrawContext& context) const;     ///< a smooth surface instead of particles

 private:
  /// State from which the buffers on the GPU were built.
  struct UploadedState {
    std::uint64_t frame = 0;
    const Vec3f* positions = nullptr;
    Display display = Display::shaded;
    bool pale = false;
    SplatShape splats = SplatShape::spheres;
    float largest = 0, radius = 0;
    friend bool operator==(const UploadedState&, const UploadedState&) = default;
  };

  Look base_look() const;
  Look look(const DrawContext& context) const;
  void refresh(const Body& body, std::span<const float> rope_strain, const DrawContext& context);
  void shape_splats(const Body& body, Threads& threads);
  std::span<const float> values(const Body& body, std::span<const float> rope_strain, Display display);
  void set_colors(const Body& body, std::span<const float> rope_strain, const DrawContext& context);
  void draw_surface(const Body& body, std::uint32_t pick, const DrawContext& context);
  void add_picture(const Body& body, Surface& surface);
  void draw_tube(std::uint32_t pick, const DrawContext& context);
  void draw_liquid(const Body& body, std::uint32_t pick, const DrawContext& context);
  void draw_grains(const Body& body, std::uint32_t pick, const DrawContext& context);
  void draw_particles(const Body& body, std::uint32_t pick, const DrawContext& context);
  void draw_normals(const Body& body, DrawList& list) const;

  const KindTraits& traits() const { return traits_of(kind_); }
  bool is_line() const { return traits().shape == ObjectShape::line; }

  ObjectKind kind_;
  std::uint32_t index_;
  std::optional<Color> chosen_;
  std::uint64_t key_;
  std::size_t vertices_, triangle_count_;
  const Triangle* triangles_;
  float mean_edge_ = 0, density_;

  std::uint64_t version_ = 0, topology_ = 0;
  UploadedState uploaded_;
  bool as_particles_ = false;
  Checker checker_;
  Tube tube_;
  CreasedSurface creased_;  ///< for soft bodies, rigid bodies and obstacles with sharp edges
  EdgeStrain strain_;
  bool has_strain_ = false;
  std::vector<CornerUvs> uvs_;       ///< of a cloth with a picture, per triangle
  std::vector<float> values_;        ///< per vertex
  std::vector<PackedColor> colors_;  ///< per vertex of the body or of the tube; may be empty
  std::vector<PackedColor> grain_colors_;
  ParticleCloud particles_;
  std::optional<SplatShapes> splats_;  ///< for a liquid drawn as ellipsoids
};

}  // namespace souple::render
