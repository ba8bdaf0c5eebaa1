#pragma once

#include "souple/contacts/contact_projector.h"
#include "souple/contacts/surfaces/element_pairs.h"

#include <memory>
#include <span>
#include <vector>

namespace souple {

class ContactColors;
class MotionFilter;
class RoundContacts;
class SurfaceNarrowPhase;

/// Contacts between surfaces: a vertex and a triangle, or two edges, of two objects or of one. A ball and the
/// edge of a rope are two edges, the ball's of zero length.
///
///   C = n . sum_k c_k p_k - d >= 0,   sum_k c_k = 0
///
/// The weights of the two nearest points are c_k (1 and minus barycentric for a vertex and a triangle). The unit vector
/// between them is n, and the thickness requires the distance d. Weights and n are computed once a substep, at the end
/// of the motion x -> p. If the elements would pass through each other, they are computed just before the impact
/// (continuous.h). So n always points to the side where the elements started. Corrections w_k c_k n conserve momentum.
/// Friction, restitution and the slow release of an old overlap are as in ParticleContacts.
///
/// A vertex that is nearest to an edge or a corner makes a contact with one of the triangles there
/// (feature_owners.h). Pairs of edges whose nearest point is an end make no contact, unless one is a rope's. The vertex
/// at that end makes a contact with the triangles.
///
/// A contact must exist before the solver brings two elements too near. Otherwise it is present in one
/// substep and absent in the next, and resting objects would tremble. If bodies are stiff or heavy, the solver first
/// moves them into each other by much more than their motion in a substep. Then contacts push them back. So contacts of
/// a particle that was pushed back start earlier by that correction, in this substep and some following ones.
///
/// With discrete detection only a vertex whose path crosses a triangle gets a contact, at the crossing and
/// along the triangle's normal (surface_narrow_phase.cpp).
///
/// After the solver, `after_solve` tests all motions again (motion_filter.h).
///
/// Round rigid bodies touch triangles as such (round_contacts.h). These contacts are solved one after the other, as one
/// color of one item, the last.
///
/// A substep goes through four classes. ElementPairs keeps the candidates. SurfaceNarrowPhase finds which of them
/// touch, and describes the contacts. ContactColors orders them for the solver, and MotionFilter corrects violations
/// that the solver left.
class SurfaceContacts final : public ContactProjector {
 public:
  /// Contacts ignore the pairs that the resolver exempts; null: none. It must outlive this object.
  explicit SurfaceContacts(const IntersectionResolver* intersection_resolver = nullptr);
  ~SurfaceContacts() override;

  /// No contact between an element of one particle of a joined pair and an element of the other particle.
  void build(const ContactGeometry& geometry) override;
  void set_end(std::size_t object, std::uint32_t end) override { pairs_.set_end(object, end); }
  void begin_step(const ContactInput& input, Threads& threads) override;
  void refresh(const ParticleView& particles, const Substep& substep, double time, Threads& threads) override;
  /// Prevents intersections. Returns the number of clamps.
  std::size_t after_solve(const ParticleView& particles, const Substep& substep, Threads& threads) override;
  std::span<const BodyPush> body_pushes() const override;
  std::span<const Pinch> pinches() const override;
  void update_masses(const ParticleView& particles) override;
  void choose_body_contacts(const ParticleView& particles, const ParticleFunction& f) override;
  void project_body_contacts(const ParticleView& particles) override;
  void visit_body_impulses(const ImpulseFunction& f) const override;
  void apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity, const Substep& substep,
                         Threads& threads) override;
  void append_impacts(const Substep& substep, std::vector<Impact>& out) const override;
  ContactReport report() const override;
  ShortenedMotion shortened() const override {
    return pairs_.shortened().speed > 0 ? pairs_.shortened() : held_;
  }
  void events(const ParticleView& particles, std::vector<ContactPush>& out) const override;

  std::string_view kind() const override { return "surface contact"; }
  std::size_t size() const override { return contacts_.size() + round_size(); }
  int color_count() const override;
  std::size_t color_size(int color) const override;
  std::size_t grain() const override { return 256; }
  std::uint32_t particle_of(int color, std::size_t index, const ParticleView& particles) const override;
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  void visit_impulses(const ParticleView& particles, const ImpulseFunction& f) const override;
  std::size_t bytes() const override;
  void clear() override { build({}); }

 private:
  void clear_contacts();
  std::size_t round_size() const;
  bool is_rigid(std::uint32_t particle) const;
  bool is_of_body(std::size_t contact) const;
  float normal_sum(std::size_t contact) const;
  ContactImpulse impulse(std::size_t contact) const;
  float gap(std::size_t contact, const ParticleView& particles) const;
  bool still_have_margins() const;
  void color_new(std::size_t first_new);
  void describe_contacts(const ParticleView& particles, Threads& threads);
  void update_contact_margins();

  const IntersectionResolver* intersection_resolver_;
  ElementPairs pairs_;
  std::unique_ptr<SurfaceNarrowPhase> narrow_phase_;
  std::unique_ptr<ContactColors> colors_;
  std::unique_ptr<MotionFilter> filter_;
  ShortenedMotion held_;  // the fastest driven particle that was stopped in this step
  std::unique_ptr<RoundContacts> round_;
  std::span<const float> radius_;
  std::span<float> contact_margin_;
  std::vector<std::uint8_t> still_, has_margin_;  // per surface; `has_margin_`: some particles may have one
  std::vector<PairToi> contact_pairs_;            // in order of pairs
  SurfaceContactRows contacts_;                   // in order of colors
  kernels::ContactColumns columns_{};             // of contacts_
  bool balls_roll_ = false;                       // contacts have shares and moments
  std::vector<std::uint32_t>
      of_bodies_;  // contacts that project_body_contacts projects, round ones after all others
};

}  // namespace souple
