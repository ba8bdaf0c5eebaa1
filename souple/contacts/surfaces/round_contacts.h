#pragma once

#include "souple/broad_phase/contact_surface.h"
#include "souple/contacts/anchor.h"
#include "souple/contacts/contact_law.h"
#include "souple/math/mat3.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

class ElementPairs;
class ElementSurfaces;
class IntersectionResolver;
class SurfaceNarrowPhase;
struct NearPair;
struct PairToi;
namespace kernels {
struct ContactLimits;
}

/// Contacts of rigid balls, capsules and cylinders with triangles of objects that deform.
///
/// Contacts of the body's own triangles would make it roll as a polyhedron. They push on its vertices, beside the point
/// below the center: a ball of 642 vertices lost two fifths of its speed in 2 s. So the triangles near the body, those
/// around the particles of its element pairs, touch its round surface:
///
///   C = n . (K - q) - R - d >= 0
///
/// The point K is on the body's axis, q on the triangle, and n the unit vector between them when the substep begins. Then
/// the push passes through the axis. While the body rolls, K moves straight and the material in contact does not. So C
/// follows K in the predicted motion, and the material in corrections of it. The material is a sum of four particles of
/// the body, which receive the impulse. Points q are nearest to the ends of the axis, and where the axis passes an edge.
///
/// A body that would pass through a surface within the substep meets it by its own triangles. So does a cylinder that does
/// not lie on its side.
class RoundContacts {
 public:
  struct Contact {
    Anchor<7> anchor{};  ///< four particles of the body, then the triangle
    std::uint32_t body = 0;
    float along_axis = 0;  ///< of K, from 0 to 1
    Vec3f normal{};        ///< unit, towards the body
    float base = 0;        ///< C without motion of the anchor [m]
    float slop = 0;        ///< see ContactColumns [m]
    float inverse_mass = 0, approach = 0, thickness = 0;
    ContactMaterialPair material{};
    ContactSums<float> sums{};
    float restitution_velocity = 0;  ///< m/s
    float depth = 0;                 ///< m

    float gap(const ParticleView& particles) const { return base + dot(normal, anchor.moved(particles)); }
    Vec3f correction() const { return normal * sums.normal_sum + sums.tangent_sum; }
  };

  void build(const ElementSurfaces& surfaces);
  void clear() { contacts_.clear(); }
  /// Finds the contacts of the substep, and removes the contacts of pairs that they replace from `found`.
  /// `radius`, `contact_margin`: per particle [m].
  void find(const ElementPairs& pairs, const SurfaceNarrowPhase& narrow_phase, const ParticleView& particles,
            std::span<const float> radius, std::span<const float> contact_margin,
            const IntersectionResolver* resolver, std::vector<PairToi>& found);
  /// Element pairs of a round body begin to touch while they are farther apart by its sagitta.
  void raise_margins(const ElementSurfaces& surfaces, std::span<float> contact_margin) const;

  std::span<Contact> contacts() { return contacts_; }
  std::span<const Contact> contacts() const { return contacts_; }
  /// Projects a contact.
  void project(std::size_t contact, const ParticleView& particles);
  void apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                         const kernels::ContactLimits& limits);
  std::size_t bytes() const;

 private:
  /// A body when the substep begins or ends. Points are relative to its first particle.
  struct Body {
    std::uint32_t surface = 0;
    RoundShape shape{};                ///< its particles counted from 0
    std::vector<std::uint32_t> near;   ///< particles of other surfaces
    std::array<Vec3f, 2> ends, moved;  ///< of the axis, and their motion [m]
    Mat3d to_weights;                  ///< of a point, to the weights of the last three particles
    bool at_end = false;

    Vec3f on_axis(float along) const { return ends[0] * (1 - along) + ends[1] * along; }
    /// The weights whose sum of the particles is a point.
    std::array<float, 4> weights(const Vec3f& point) const;
  };
  struct Touch;
  struct Input;

  bool may_replace(const Body& body, const NearPair& pair, bool edges, const ParticleView& particles) const;
  void choose_pairs(const Input& input, std::vector<PairToi>& found);
  static void place(Body& body, const ParticleView& particles, bool at_end);
  void find_near(const Input& input, Body& body);
  void touch_triangle(const Input& input, const Body& body, const std::array<std::uint32_t, 3>& triangle);
  void add(const Input& input, const Body& body, const Touch& touch);

  std::vector<Body> bodies_;
  std::vector<std::uint32_t> body_of_;              // per surface: its index, or no_surface
  std::vector<std::array<std::uint32_t, 2>> fast_;  // body, and surface that it would pass through
  std::vector<std::uint32_t> marks_;                // per particle: last mark
  std::uint32_t mark_ = 0;
  std::vector<Contact> contacts_;
};

}  // namespace souple
