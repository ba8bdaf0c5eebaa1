#pragma once

#include "souple/contacts/contact_projector.h"
#include "souple/contacts/kernels/collider_contacts.h"
#include "souple/contacts/packed_collider.h"
#include "souple/state/columns.h"

#include <span>
#include <vector>

namespace souple {

/// Contacts of particles with analytic colliders, static or moving.
///
///   C = n . (p - s) - r >= 0,   s the surface point, n the outward normal, r the particle's radius.
///
/// While the particle's center is outside the shape, each projection reads n and s from the shape again. Outside a
/// convex shape the normal is continuous, so it cannot flip. Two cases use one plane for the whole substep. A center
/// that starts inside takes the nearest surface at the substep's start. A particle fast enough to pass the shape within
/// the substep takes the surface at first touch. Its motion relative to the collider finds that point (sphere tracing).
/// So no particle passes a thin box, and no edge moves a particle to the box's far side.
///
/// Friction is solved with the positions (Macklin et al. 2014, section 6.1). Corrections cancel the
/// tangential displacement since the substep began, relative to that of the collider's surface. Their sum
/// stays within mu times the sum of normal corrections. So the law does not depend on the number of
/// iterations, and resting particles do not creep. Particles of inverse mass 0 are ignored. No state outlives
/// a step.
class ColliderContacts final : public ContactProjector {
 public:
  void build(const ContactGeometry&) override { clear(); }
  void begin_step(const ContactInput& input, Threads& threads) override;
  void refresh(const ParticleView& particles, const Substep& substep, double time, Threads& threads) override;
  void apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity, const Substep& substep,
                         Threads& threads) override;
  void append_impacts(const Substep& substep, std::vector<Impact>& out) const override;
  ContactReport report() const override;
  /// In order of collider, then particle.
  void events(const ParticleView& particles, std::vector<ContactPush>& out) const override;

  std::string_view kind() const override { return "collider contact"; }
  bool is_collider_contact() const override { return true; }
  void visit_overlaps(const std::function<void(std::uint32_t)>& f) const override;
  void take_some(std::span<const std::uint32_t> chosen, std::vector<std::uint32_t>& taken) override;
  /// `again`: with the normals and surface points of the last projection.
  void project_some(const ParticleView& particles, bool again) override;
  void put_back_some() override;
  std::size_t size() const override { return contacts_.size(); }
  /// One color per enabled collider: a particle has at most one contact with each.
  int color_count() const override { return static_cast<int>(bodies_.size()); }
  std::size_t color_size(int color) const override {
    const Body& body = bodies_[static_cast<std::size_t>(color)];
    return body.contact_end - body.contact_begin;
  }
  std::size_t grain() const override { return 64; }
  std::uint32_t particle_of(int color, std::size_t index, const ParticleView& particles) const override;
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  void visit_impulses(const ParticleView& particles, const ImpulseFunction& f) const override;
  std::size_t bytes() const override;
  void clear() override;

 private:
  /// An enabled collider during the step.
  struct Body : PackedCollider {
    using PackedCollider::PackedCollider;
    double curvature_radius = 0;  // see element_clearance.h [m]
    std::size_t candidate_begin = 0, candidate_end = 0;
    std::size_t contact_begin = 0, contact_end = 0;
  };
  /// Particles that may touch something, each with the object it belongs to.
  struct Members {
    std::vector<std::uint32_t> particle, object;
    MotionMargins margins;
  };
  /// The members of an object, [begin, end), in a search.
  struct Group {
    std::uint32_t object;
    std::size_t begin, end;
    Vec3d lo, hi;          // of their positions [m]
    double margin, keeps;  // the largest [m]
  };
  /// Particles that may touch a body in this step, body by body.
  struct Candidates {
    std::vector<std::uint32_t> particle, object;
    std::vector<float> keeps;  // distance that the particle keeps from the surface [m]
  };

  const Shape& shape_of(const Body& body) const { return colliders_[body.collider].shape; }
  void find_bodies();
  void find_members();
  void find_frames(const ParticleView& particles);
  void find_frame(Body& body, const ParticleView& particles) const;
  void find_candidates(const ParticleView& particles, std::span<const Vec4f> velocity, float h,
                       Threads& threads);
  void find_groups(const ParticleView& particles);
  void find_candidates_of(Body& body, const kernels::ColliderParticles& particles, Threads& threads);
  bool may_reach(const Group& group, const Body& body, double body_margin) const;
  bool needs_search(const ParticleView& particles, Threads& threads);
  static Vec3f relative_motion(const Body& body, std::uint32_t particle, const ParticleView& particles);
  void project_exactly(const ParticleView& particles);
  void find_contacts(Body& body, const ParticleView& particles, Threads& threads);
  kernels::ColliderContactLimits limits() const;
  kernels::ColliderParticles rolling_particles(const ParticleView& particles) const;
  template <class Function>
  void for_each_gap(const ParticleView& particles, const Function& f) const;

  std::span<const Collider> colliders_;
  std::span<const ContactObject> objects_;
  std::span<const float> radius_, element_radius_;
  const ContactMaterialTable* materials_ = nullptr;
  ContactStep step_;
  float last_h_ = 0;  // h of the last refresh [s]
  const kernels::ColliderContactKernels* kernels_ = nullptr;
  std::vector<Body> bodies_;
  bool searched_ = false;  // in this step: candidates are known
  Members members_;
  std::vector<Group> groups_;
  Candidates candidates_;
  std::vector<float> distance_;      // per member or candidate: to the body's surface [m]
  std::vector<std::uint32_t> near_;  // candidates in contact with the body
  std::vector<std::uint32_t> some_;  // contacts that take_some took
  ColumnStore<kernels::ColliderContactColumns> contacts_, taken_;  // body by body; copies of some
};

}  // namespace souple
