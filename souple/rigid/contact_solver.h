#pragma once

#include "souple/rigid/impulse.h"
#include "souple/rigid/rigid_contact.h"
#include "souple/threads/threads.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A substep of rigid contacts.
struct RigidSubstep {
  double h = 0;                    ///< [s]
  int iterations = 1;              ///< sweeps over all bodies
  double depenetration_speed = 1;  ///< at which older overlaps are removed [m/s]
  double bounce_speed = 0;         ///< contacts that approach more slowly are no impacts [m/s]
};

/// Contacts between rigid bodies, in a substep:
///
///   bounce      before the prediction: velocities of bodies that would hit each other
///   solve       after the prediction: poses
///
/// `solve` minimizes the energy of implicit Euler, one body after the other with all its contacts at once, and raises the
/// impulses by an augmented Lagrangian: Giles, Diaz and Yuksel 2025, "Augmented Vertex Block Descent". Impulses are those of
/// the last substep to begin with, so a stack does not sag, and heavy bodies may lie on light ones. It conserves momentum
/// only where it has converged, so impacts are left to `bounce`, which does so exactly.
///
/// C and the slip of a contact are linear in the corrections dx and dtheta of the predicted poses:
///   C = C* + n . (dx_a + dtheta_a x r_a - dx_b - dtheta_b x r_b).
class ContactSolver {
 public:
  /// Call when the list of contacts has changed.
  void prepare(std::span<const RigidContact> contacts, const RigidBodies& bodies);
  /// Every contact that closes within the substep, faster than the bounce speed, gives its sides e times the approach
  /// speed, with friction; again and again until none approaches. So an impact travels through a row of balls.
  void bounce(std::span<const RigidContact> contacts, RigidBodies& bodies, const RigidSubstep& substep);
  void solve(std::span<RigidContact> contacts, RigidBodies& bodies, const RigidSubstep& substep,
             Threads& threads);

  /// The largest depth [m].
  static double deepest(std::span<const RigidContact> contacts, const RigidBodies& bodies);
  std::size_t bytes() const;

 private:
  /// A point, linearized at the predicted poses. Forces are those on a.
  struct Row {
    Vec3d n{};             ///< from b to a
    Vec3d r_a{}, r_b{};    ///< from the centers of mass [m]
    double C = 0;          ///< less what is left of an older overlap [m]
    Vec3d slip{};          ///< tangential, less what is left of an older one [m]
    double stiffness = 0;  ///< of the augmented Lagrangian [N/m]
    double normal = 0;     ///< force so far [N]
    Vec3d tangent{};       ///< [N]
    float static_friction = 0, kinetic_friction = 0;
    bool pushes = false;  ///< before the last step of a body
  };
  /// What a row does at the current poses.
  struct Push {
    double normal = 0;    ///< [N], not negative
    Vec3d sticking{};     ///< tangential force that would stop the slip [N]
    Vec3d tangent{};      ///< within friction [N]
    bool slides = false;  ///< the tangential force is at its limit
  };
  /// Correction of a body's predicted pose.
  struct Correction {
    Vec3d dx{}, dtheta{};  ///< [m], [rad]
  };
  /// A contact of a body.
  struct Side {
    std::uint32_t contact = 0;
    bool is_a = false;
  };

  /// Whether a contact's sides hit each other.
  static bool collide(const RigidContact& contact, RigidBodies& bodies, const RigidSubstep& substep);
  void look_again(std::uint32_t body);
  void color_bodies(std::span<const RigidContact> contacts, const RigidBodies& bodies);
  void linearize(RigidContact& contact, std::span<Row> rows, const RigidBodies& bodies,
                 const RigidSubstep& substep) const;
  Vec3d correction_at(const RigidContact& contact, const Row& row) const;
  Push push_of(const RigidContact& contact, const Row& row) const;
  /// One step of Newton's method. Whether a contact pulled in it.
  bool step_body(std::uint32_t body, std::span<const RigidContact> contacts, const RigidBodies& bodies,
                 double h);
  void solve_body(std::uint32_t body, std::span<const RigidContact> contacts, const RigidBodies& bodies,
                  double h);
  void keep(RigidContact& contact, std::span<Row> rows, double h) const;

  std::vector<Row> rows_;                  // four for each contact
  std::vector<Correction> corrections_;    // per body
  std::vector<Mat3d> inertia_;             // per body with contacts, in world axes [kg m^2]
  std::vector<std::uint32_t> side_begin_;  // per body: into sides_
  std::vector<Side> sides_;
  std::vector<std::uint32_t> color_;                   // per body
  std::vector<std::uint32_t> order_;                   // bodies with contacts, by color
  std::vector<std::uint32_t> color_begin_;             // into order_
  std::vector<std::uint32_t> impacts_, next_impacts_;  // contacts to look at
  std::vector<std::uint8_t> waits_;                    // per contact: is in next_impacts_
};

}  // namespace souple
