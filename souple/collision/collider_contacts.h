#pragma once

#include "souple/collision/collider.h"
#include "souple/collision/contact.h"
#include "souple/collision/rigid_pose.h"
#include "souple/solver/projector.h"
#include "souple/solver/threads.h"

#include <span>
#include <vector>

namespace souple {

/// Particles against analytic colliders, static or moving.
///
///   C = n . (p - s) - r >= 0,   s the surface point, n the outward normal, r the particle's radius.
///
/// How a step uses it:
///   begin_step(...)                                 once: which particles may meet which collider
///   for each substep, at time t:
///     refresh(view, substep, t)                     after prediction: the contacts along x -> p,
///                                                   colliders t -> t + h
///     project(color, view, substep)                each iteration: push out, friction
///     apply_restitution(view, velocities, substep)  after v = (p - x) / h
///     report(), events()
///
/// n and s are read anew from the shape at each projection while the particle's center is outside the shape
/// (outside a convex shape the normal is continuous, so it cannot flip). Where the center is inside, or the
/// particle moves so fast that it may pass the shape within a substep, they are found once where the motion
/// relative to the collider first touches the surface (sphere tracing), and that plane holds for the substep:
/// a thin box lets nothing through and an edge does not throw a particle to its other side.
///
/// Friction is solved with the positions (Macklin et al. 2014, section 6.1): the tangential displacement
/// since the substep began, relative to that of the collider's surface, is canceled by corrections whose sum
/// stays within mu times the sum of normal corrections, so any number of iterations gives the same law and
/// nothing creeps. Particles of inverse mass 0 are ignored. No state outlives a step.
class ColliderContacts final : public Projector {
 public:
  /// `particles` as the last substep left them; spans are read during the call only, but `colliders`,
  /// `objects`, `surfaces` and `radius` must live until the step ends. surfaces.at(object, collider). What a
  /// motion callback throws passes through; the contacts are then empty.
  void begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                  std::span<const float> radius, std::span<const ContactObject> objects,
                  std::span<const Collider> colliders, const ContactMaterialTable& materials,
                  const ContactStep& step, Threads& threads);

  /// The contacts of the substep [time, time + h]: call after prediction and before the first project.
  void refresh(const ParticleView& particles, const Substep& substep, double time, Threads& threads);

  /// Velocity of contacts that pushed, relative to the collider's surface: v_n becomes e times the approach
  /// speed where that was above 2 |g| h, else 0. The approach speed is that of the predicted motion. What is
  /// left of a push that only undid an overlap is taken out, never more than the contact itself put in.
  /// Impulses added here bring their friction. `velocity` is m/s per particle.
  void apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity, const Substep& substep,
                         Threads& threads);

  ContactReport report() const;
  /// Appends the contacts that pushed during the last substep, in order of collider, then particle.
  void events(const ParticleView& particles, std::vector<ContactPush>& out) const;

  std::string_view kind() const override { return "collider contact"; }
  std::size_t size() const override { return contacts_.size(); }
  void prepare(std::size_t) override {}
  /// One color per collider: a particle meets each collider once.
  int color_count() const override { return static_cast<int>(bodies_.size()); }
  std::size_t color_size(int color) const override {
    const Body& body = bodies_[static_cast<std::size_t>(color)];
    return body.contact_end - body.contact_begin;
  }
  std::size_t grain() const override { return 64; }
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  Residual residual(const ParticleView& particles) const override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  /// Contacts live for one step; erasing between steps forgets them all.
  std::size_t bytes() const override;
  void erase_particles(std::uint32_t begin, std::uint32_t end) override;

 private:
  /// A collider during the step.
  struct Body {
    std::uint32_t collider = 0;
    bool moves = false;
    RigidPose before, after;  // at the substep's begin and end
    BoundingBall ball;
    Vec3d center;                // of the ball, at the substep's end [m]
    double shift = 0, turn = 0;  // what the center moves in a substep [m], and |R1 - R0|
    std::size_t candidate_begin = 0, candidate_end = 0;
    std::size_t contact_begin = 0, contact_end = 0;
  };
  /// A particle and the object it belongs to.
  struct Member {
    std::uint32_t particle, object;
  };
  /// Where a member was in the last broad phase, and how far it may go before the next.
  struct BroadPhasePosition {
    Vec3d at;
    double margin;
  };
  struct Contact {
    std::uint32_t particle;
    float radius;
    ContactMaterialPair material;
    bool fixed_plane;                // the plane below holds for the whole substep
    SurfaceDistance start;           // at the substep's begin, or where the motion first touched
    double plane_offset;             // of the plane with normal start.normal, in the collider's frame [m]
    float slop;                      // C may stay this negative: an old overlap leaves slowly [m]
    Vec3f predicted;                 // motion relative to the surface before any projection [m]
    float normal_sum = 0;            // sum of normal corrections [m]
    Vec3f tangent_sum{};             // sum of tangential corrections [m]
    Vec3f normal{};                  // world, of the last projection
    Vec3f surface_motion{};          // what the surface moved in the substep at the contact [m]
    float restitution_velocity = 0;  // normal velocity added by apply_restitution [m/s]
    float depth = 0;                 // what is left of the overlap of one that pushed [m]
  };
  struct Gap {
    double C;       // m
    Vec3d normal;   // in the collider's frame
    Vec3d surface;  // the surface point in the collider's frame
  };

  static Gap gap(const Shape& shape, const Contact& contact, const Vec3d& local);
  const Shape& shape_of(const Body& body) const { return colliders_[body.collider].shape; }
  void find_bodies();
  void find_members();
  void find_candidates(const ParticleView& particles, std::span<const Vec4f> velocity, float h,
                       Threads& threads);
  bool is_candidate(const Body& body, std::size_t member, const ParticleView& particles) const;
  bool left_margins(const ParticleView& particles, Threads& threads) const;
  void find_contacts(Body& body, const ParticleView& particles, float h, Threads& threads);
  bool may_touch(const Body& body, const Member& member, const ParticleView& particles) const;
  double distance_if_near(const Body& body, const Member& member, const ParticleView& particles) const;
  Contact contact_of(const Body& body, const Member& member, double end_distance,
                     const ParticleView& particles, float h) const;
  void apply_restitution_to(const Body& body, Contact& contact, const ParticleView& particles,
                            std::span<Vec4f> velocity, float h) const;
  void project_one(const Body& body, Contact& contact, const ParticleView& particles) const;

  std::span<const Collider> colliders_;
  std::span<const ContactObject> objects_;
  std::span<const float> radius_;
  const ContactMaterialTable* materials_ = nullptr;
  ContactStep step_;
  float last_h_ = 0;  // of the last refresh [s]
  std::vector<Body> bodies_;
  std::vector<Member> members_;
  std::vector<BroadPhasePosition> broad_phase_;  // of each member
  std::vector<Member> candidates_;               // of static bodies, body by body
  std::vector<double> distance_;                 // of each member or candidate that a body may meet [m]
  std::vector<std::uint32_t> near_;              // which of them it meets
  std::vector<Contact> contacts_;                // body by body
};

}  // namespace souple
