#pragma once

#include "souple/collision/collider.h"
#include "souple/collision/contact.h"
#include "souple/collision/rigid_pose.h"
#include "souple/solver/projector.h"
#include "souple/solver/threads.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Contacts of triangles and edges with colliders, where contacts of their corners do not suffice: a coarse
/// cloth on a table's corner or on a small ball, a rope over a thin bar.
///
///   C = n . (sum_k w_k p_k - s) - r / 4 >= 0,
///
/// sum_k w_k p_k the element's deepest point, s the surface point below it, n the outward normal there, r the
/// smallest radius of its particles. The corners keep the distance r themselves (ColliderContacts); the
/// points between them may come nearer. So elements that are fine relative to the curvature below them need
/// no contact, and are skipped before they cost anything. On shapes with edges, elements that are small
/// relative to the whole shape are skipped too: an edge of the shape may enter a fine cloth between its
/// vertices, by half a triangle's size at most. Planes need no such contacts.
///
/// The search for the deepest point follows Macklin et al. 2020 ("Local optimization for robust signed
/// distance field collision", section 4), who use the method of Frank and Wolfe; see `deepest` for the
/// deviation. The point, its weights and its plane are fixed for a substep. For a fast element they are those
/// of its first touch. Friction and restitution are those of ColliderContacts, distributed to the corners by
/// their weights. Contacts are few. They are projected one after another, by collider, then element.
class ColliderElementContacts final : public Projector {
 public:
  /// A triangle, or an edge that repeats its second corner.
  struct Element {
    std::array<std::uint32_t, 3> particle;
    std::uint32_t object;  ///< row in the material table
    float radius;          ///< of the smallest circle around it at rest [m]
  };
  /// Sets the elements of all objects. Their order determines the order of contacts.
  void set_elements(std::vector<Element> elements);

  /// As for ColliderContacts. `colliders`, `materials` and `radius` must live until the step ends.
  void begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                  std::span<const float> radius, std::span<const Collider> colliders,
                  const ContactMaterialTable& materials, const ContactStep& step, Threads& threads);
  void refresh(const ParticleView& particles, const Substep& substep, double time, Threads& threads);
  void apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity, const Substep& substep);
  ContactReport report() const;
  /// Appends the contacts with a normal impulse in the last substep. `particle` is the corner with the
  /// largest weight.
  void events(const ParticleView& particles, std::vector<ContactPush>& out) const;

  std::string_view kind() const override { return "collider element contact"; }
  bool is_contact() const override { return true; }
  bool is_collider_contact() const override { return true; }
  std::size_t size() const override { return contacts_.size(); }
  void prepare(std::size_t) override {}
  int color_count() const override { return contacts_.empty() ? 0 : 1; }
  std::size_t color_size(int) const override { return contacts_.size(); }
  /// Contacts share particles, so one thread projects all of them.
  std::size_t grain() const override { return std::size_t{1} << 40; }
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  Residual residual(const ParticleView& particles) const override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  std::size_t bytes() const override;
  void erase_particles(std::uint32_t begin, std::uint32_t end) override;

 private:
  using Corners = std::array<Vec3d, 3>;
  /// A collider during the step.
  struct Body {
    std::uint32_t collider = 0;
    bool moves = false;
    RigidPose before, after;  // at the substep's start and end
    BoundingBall ball;
    double smallest_radius = 0;  // of the elements that get contacts [m]
    std::size_t candidate_begin = 0, candidate_end = 0;
    std::size_t contact_begin = 0, contact_end = 0;
  };
  struct Deepest {
    std::array<double, 3> weight;
    Vec3d point;
    SurfaceDistance surface;
    double gap;  // bound of how much lower the distance is elsewhere, for convex shapes [m]
  };
  struct Contact {
    std::array<std::uint32_t, 3> particle;
    std::array<float, 3> weight;
    float inverse_mass;  // sum_k w_k^2 / m_k [1/kg]
    float target;        // [m]
    ContactMaterialPair material;
    Vec3d normal;                    // in the collider's frame
    double plane_offset;             // [m]
    float slop;                      // target of C, at most 0: old overlaps are removed slowly [m]
    Vec3f predicted;                 // motion of the point relative to the surface before any projection [m]
    float normal_sum = 0;            // sum of normal corrections of the point [m]
    Vec3f tangent_sum{};             // sum of tangential corrections of the point [m]
    Vec3f surface_motion{};          // displacement of the surface at the contact in the substep [m]
    float restitution_velocity = 0;  // normal velocity that apply_restitution added [m/s]
    float depth = 0;                 // remaining overlap, of contacts with a normal impulse [m]
  };
  /// Result of the test of a candidate.
  struct Found {
    bool touches = false, inside = false;
    Contact contact{};
  };

  void find_bodies();
  void find_candidates(const ParticleView& particles, std::span<const Vec4f> velocity, float h,
                       Threads& threads);
  bool is_candidate(const Body& body, std::size_t element, const ParticleView& particles) const;
  bool left_margins(const ParticleView& particles) const;
  void find_contacts(Body& body, const ParticleView& particles, float h, Threads& threads);
  Corners corners(const RigidPose& pose, const Element& element, const ParticleView& particles,
                  bool start) const;
  void find_depenetrating(Body& body, const ParticleView& particles, Threads& threads);
  std::uint8_t* depenetrating_of(const Body& body) {
    return depenetrating_.data() + static_cast<std::size_t>(&body - bodies_.data()) * objects_;
  }
  bool is_depenetrating(const Body& body, std::uint32_t object) {
    return depenetrating_of(body)[object] != 0;
  }
  float radius_of(const Element& element) const;
  bool may_touch(const Body& body, const Element& element, const ParticleView& particles) const;
  static double sag(const Shape& shape, const Corners& x, const Vec3d& middle,
                    const SurfaceDistance& at_middle);
  bool contact_of(const Body& body, const Element& element, const ParticleView& particles, float h,
                  Found& found) const;
  static Deepest evaluate(const Shape& shape, const Corners& x, const std::array<double, 3>& weight);
  static Deepest deepest_between(const Shape& shape, const Corners& x, const std::array<double, 3>& a,
                                 const std::array<double, 3>& b);
  static Deepest deepest_by_sections(const Shape& shape, const Corners& x);
  static Deepest deepest(const Shape& shape, const Corners& x, double limit, double tolerance);
  double gap(const Body& body, const Contact& contact, const ParticleView& particles) const;
  static Vec3f moved(const Contact& contact, const ParticleView& particles);
  static void correct(const Contact& contact, const ParticleView& particles, const Vec3f& change);
  void project_one(const Body& body, Contact& contact, const ParticleView& particles) const;
  void apply_restitution_to(const Body& body, Contact& contact, const ParticleView& particles,
                            std::span<Vec4f> velocity, float h) const;
  const Shape& shape_of(const Body& body) const { return colliders_[body.collider].shape; }

  std::vector<Element> elements_;
  struct Corner {
    std::uint32_t particle, object;
  };
  std::vector<Corner> corners_;  // particles of all elements, each once
  float largest_radius_ = 0;     // of all elements [m]
  std::uint32_t objects_ = 0;    // one more than the largest object of an element
  std::span<const Collider> colliders_;
  std::span<const float> radius_;
  const ContactMaterialTable* materials_ = nullptr;
  ContactStep step_;
  float last_h_ = 0;  // [s]
  std::vector<Body> bodies_;
  std::vector<Vec3d> broad_phase_position_;  // per particle: in the last broad phase [m]
  std::vector<float> margin_;                // per particle: motion allowed before the next one [m]
  std::vector<std::uint8_t> near_;           // per element, candidate or corner: result of a test
  std::vector<std::uint32_t> candidates_;    // elements, body by body
  std::vector<std::uint32_t> tested_;        // candidates of a body that may touch it in this substep
  std::vector<Found> found_;                 // per element of tested_
  std::vector<std::uint8_t> depenetrating_;  // [body][object]: a part of the object started inside
  std::vector<Contact> contacts_;            // body by body
};

}  // namespace souple
