#pragma once

#include "souple/contacts/anchor.h"
#include "souple/contacts/contact_law.h"
#include "souple/contacts/contact_projector.h"
#include "souple/contacts/kernels/collider_contacts.h"
#include "souple/contacts/kernels/collider_elements.h"
#include "souple/contacts/packed_collider.h"
#include "souple/state/columns.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Contacts of triangles and edges with colliders, where contacts of their corners do not suffice. Examples are a cloth
/// on a table's edge, a coarse cloth on a small ball, a rope over a thin bar.
///
///   C = n . (sum_k w_k p_k - s) - r / 4 >= 0,
///
/// sum_k w_k p_k the element's deepest point, s the surface point below it, n the outward normal there, r the
/// smallest radius of its particles. The corners keep the distance r themselves (ColliderContacts); the
/// points between them may come nearer. So elements that are fine relative to the curvature below them need
/// no contact, and are skipped before they cost anything. Planes need no such contacts.
///
/// The point nearest to a convex shape is on an edge, or inside a triangle above the shape's farthest point along the
/// triangle's normal. So each edge is searched once, whatever the number of its triangles
/// (kernels/collider_elements.h). In a signed distance field, an element is sampled and its lowest sample descends. See
/// Macklin et al. 2020, "Local optimization for robust signed distance field collision", section 4. They descend from
/// the middle, which on bumps ends in the wrong dip.
///
/// The point, its weights and its plane are fixed for a substep. For a fast element they are those
/// of its first touch. Friction and restitution are those of ColliderContacts, distributed to the corners by
/// their weights. Contacts are few. They are projected one after another, by collider, then element.
class ColliderElementContacts final : public ContactProjector {
 public:
  /// Contacts are in the order of triangles, edges, edges of triangles.
  void build(const ContactGeometry& geometry) override { set_elements(geometry.elements); }
  void begin_step(const ContactInput& input, Threads& threads) override;
  void refresh(const ParticleView& particles, const Substep& substep, double time, Threads& threads) override;
  void apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity, const Substep& substep,
                         Threads& threads) override;
  ContactReport report() const override;
  /// `particle` is the corner with the largest weight.
  void events(const ParticleView& particles, std::vector<ContactPush>& out) const override;

  std::string_view kind() const override { return "collider element contact"; }
  bool is_collider_contact() const override { return true; }
  std::size_t size() const override { return contacts_.size(); }
  int color_count() const override { return contacts_.empty() ? 0 : 1; }
  std::size_t color_size(int) const override { return contacts_.size(); }
  /// Contacts share particles, so one thread projects all of them.
  std::size_t grain() const override { return ~std::size_t{0} / 2; }
  std::uint32_t particle_of(int color, std::size_t index, const ParticleView& particles) const override;
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  void visit_impulses(const ParticleView& particles, const ImpulseFunction& f) const override;
  std::size_t bytes() const override;
  void clear() override { set_elements({}); }

 private:
  using Element = ContactElement;
  /// A collider during the step.
  struct Body : PackedCollider {
    using PackedCollider::PackedCollider;
    bool is_field = false;
    float smallest_radius = 0;  // of the elements that get contacts [m]
    int parts = 1;              // see kernels::ColliderFieldSearch
    float gap = 0;              // of samples, see there [m]
    std::size_t row_begin = 0, row_end = 0;
    std::size_t near_corner_begin = 0, near_corner_end = 0;
    std::size_t candidate_begin = 0, triangle_end = 0, candidate_end = 0;
    std::size_t contact_begin = 0, contact_end = 0;
  };
  struct Contact {
    Anchor<3> anchor;
    float inverse_mass;  // of the anchor [1/kg]
    float target;        // [m]
    ContactMaterialPair material;
    Vec3f normal;                    // in the world
    float start_gap;                 // C with the positions of the substep's start [m]
    float slop;                      // target of C, at most 0: old overlaps are removed slowly [m]
    Vec3f predicted;                 // motion of the point relative to the surface before any projection [m]
    Vec3f surface_motion;            // displacement of the surface at the contact in the substep [m]
    ContactSums<float> sums{};       // of the point
    float restitution_velocity = 0;  // normal velocity that apply_restitution added [m/s]
    float depth = 0;                 // remaining overlap, of contacts with a normal impulse [m]
  };
  /// Elements that may touch a body in this step, body by body, triangles first.
  struct Candidates {
    std::uint32_t *element, *corner[3];  ///< corner: first float of its record
    float *radius, *reach, *near;
    float *u, *v, *lower, *limit;  ///< see kernels::ColliderFieldSearch
    float* travel;                 ///< in a field: motion since it was sampled [m]
    float* clear_for;              ///< in a field: motion that it needs to come near [m]
    kernels::ColliderElementTouches touch;

    kernels::ColliderElements elements(float clearance_part) const {
      return {{corner[0], corner[1], corner[2]}, radius, clearance_part};
    }
  };

  struct Corner {
    std::uint32_t particle, object;
  };
  /// Particles of all elements, each once, in order.
  struct Corners {
    std::vector<Corner> all;
    std::vector<std::uint32_t> particle;                    // per corner
    std::vector<std::array<std::uint32_t, 3>> first_float;  // per element: of its corners' records
    // Per corner:
    std::vector<float> distance;          // from a body [m]
    std::vector<Vec4f> from, to;          // records of kernels::ColliderFrameRecords
    std::vector<std::uint32_t> all_rows;  // 0, 1, ...
    std::vector<std::uint8_t> is_row;
    MotionMargins margins;
    std::vector<std::uint32_t> rows;  // corners of candidates, body by body
    std::vector<Corner> near;         // corners that moving bodies may reach, body by body
    std::vector<std::uint32_t> near_particle;
  };

  void set_elements(std::vector<Element> elements);
  void append_edges_of_triangles();
  void find_corners();
  void find_bodies();
  void place(const Body& body, std::span<const std::uint32_t> rows, const ParticleView& particles,
             Threads& threads);
  void find_candidates(const ParticleView& particles, std::span<const Vec4f> velocity, float h,
                       Threads& threads);
  void find_candidates_of(Body& body, const ParticleView& particles, Threads& threads);
  /// The first candidate from this one on that is an edge.
  std::size_t first_edge(std::size_t candidate) const;
  void keep_near(std::size_t begin);
  void find_rows(Body& body);
  void find_near_corners(Body& body, const ParticleView& particles, Threads& threads);
  bool needs_search(const ParticleView& particles, Threads& threads);
  /// Finds the objects of these corners that the collider has jumped into; the corners' particles are given too.
  void find_depenetrating(Body& body, std::span<const Corner> corners,
                          std::span<const std::uint32_t> particle, const ParticleView& particles,
                          Threads& threads);
  void find_contacts(Body& body, const ParticleView& particles, float h, Threads& threads);
  void find_touches(const Body& body, Threads& threads);
  void find_touches_of_field(const Body& body, Threads& threads);
  bool contact_of(const Body& body, const Candidates& all, std::size_t candidate,
                  const ParticleView& particles, float h, Contact& contact) const;
  std::uint8_t* depenetrating_of(const Body& body) {
    return depenetrating_.data() + static_cast<std::size_t>(&body - bodies_.data()) * objects_;
  }
  float radius_of(const Element& element) const;
  static float gap(const Contact& contact, const ParticleView& particles);
  static void project_one(Contact& contact, const ParticleView& particles);
  void apply_restitution_to(Contact& contact, const ParticleView& particles, std::span<Vec4f> velocity,
                            float h) const;

  std::vector<Element> elements_;  // triangles, edges, edges of triangles
  std::size_t triangles_ = 0, given_ = 0;
  Corners corners_;
  float largest_radius_ = 0;   // of all elements [m]
  std::uint32_t objects_ = 0;  // one more than the largest object of an element
  std::span<const Collider> colliders_;
  std::span<const float> radius_;
  const ContactMaterialTable* materials_ = nullptr;
  const kernels::ColliderElementKernels* kernels_ = nullptr;
  const kernels::ColliderContactKernels* particle_kernels_ = nullptr;
  ContactStep step_;
  float last_h_ = 0;  // [s]
  std::vector<Body> bodies_;
  bool searched_ = false;  // in this step: candidates are known
  ColumnStore<Candidates> candidates_;
  std::vector<std::uint32_t> stale_, near_;  // candidates in a field: to be sampled, and that may touch
  std::vector<std::uint8_t> depenetrating_;  // [body][object]: a part of the object started inside
  std::vector<Contact> contacts_;            // body by body
};

}  // namespace souple
