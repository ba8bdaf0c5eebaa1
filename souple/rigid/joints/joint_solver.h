#pragma once

#include "souple/rigid/joints/block_cholesky.h"
#include "souple/rigid/joints/prepared_joint.h"

namespace souple::joint {

enum class Method : std::uint8_t {
  direct,  ///< all joints of an island at once, by a sparse factorization: exact at any mass ratio
  sweep,   ///< one joint after the other, with the impulses of the last substep applied first
};

/// Moves bodies so that joints hold. In a substep: predict_bodies, begin_substep, project as often as one likes, with the
/// projections of contacts in between, end_substep, finish_bodies. Joints need no pass over velocities: dampers and motors
/// are part of `project`.
///
/// An island is a set of bodies that joints connect; bodies that cannot move connect nothing. Islands are independent.
/// Within one, Newton's method solves S dlambda = -(C + alpha lambda) for all rows, with S = J (M + T)^-1 J^T + alpha.
/// S is sparse and positive definite. Trees of joints cause no fill, so the time is linear in their length. T is the
/// stiffness of arms that a load turns (`weigh_arms`). Limits, and motors at their largest force, are found by
/// exchanging rows that violate their bounds. An island whose factorization takes more than 5e7 multiplications is
/// swept.
class JointSolver {
 public:
  Method method = Method::direct;

  /// Call when bodies were predicted. Finds the islands again if joints, or which bodies move, changed: this allocates.
  void begin_substep(Joints& joints, const RigidBodies& bodies, double h);
  void project(Joints& joints, RigidBodies& bodies);
  /// Reports forces, and breaks joints.
  void end_substep(Joints& joints);

 private:
  /// A body at one side of a joint.
  struct Side {
    std::uint32_t joint = 0;  ///< index in the island
    bool is_b = false;
  };
  /// Two sides of the same body: a part of one block.
  struct Product {
    Side row, column;
    std::uint32_t body = 0;
    std::size_t offset = 0;
  };
  struct Island {
    std::vector<std::uint32_t> joints, bodies;
    std::vector<Product> products;
    std::vector<std::size_t> diagonal;  ///< offset of each joint's own block
    BlockCholesky matrix;
    std::vector<double> x;
    bool direct = true;
    bool projected = false;  ///< in this substep
  };
  /// Impulses on a body in a pass.
  struct Impulse {
    Vec3d linear, angular;
  };

  bool is_current(const Joints& joints, const RigidBodies& bodies) const;
  void find_islands(const Joints& joints, const RigidBodies& bodies);
  void build(Island& island, const Joints& joints);
  void weigh(const Island& island, const Joints& joints, const RigidBodies& bodies, bool jerk);
  void save(const Island& island, const Joints& joints, const RigidBodies& bodies);
  bool restart(const Island& island, Joints& joints, RigidBodies& bodies);
  void solve(Island& island, Joints& joints, RigidBodies& bodies);
  void assemble(Island& island, const RigidBodies& bodies, double damping);
  void solve_rows(Island& island, const Joints& joints, const RigidBodies& bodies);
  double largest_turn(const Island& island) const;
  double left_of(std::size_t i, const Joints& joints, std::uint32_t j) const;
  double known_motion(std::size_t i, const Joint& joint, const PreparedJoint& prepared,
                      const RigidBodies& bodies) const;
  void add_impulses(const Joint& joint, const PreparedJoint& prepared);
  void move(std::uint32_t body, RigidBodies& bodies);
  void sweep(Island& island, Joints& joints, RigidBodies& bodies);
  void apply(std::uint32_t j, Joints& joints);
  void solve_alone(std::uint32_t j, Joints& joints, RigidBodies& bodies);
  bool moves(std::uint32_t body) const { return body != no_body && movable_[body]; }

  double h_ = 0;
  std::vector<BodyPose> saved_;  ///< before the present projection
  std::vector<PreparedJoint> prepared_;
  std::vector<Island> islands_;
  std::vector<char> movable_;                      ///< of each body, when islands were found
  std::vector<std::array<std::uint32_t, 3>> key_;  ///< bodies and rows of each joint then
  std::vector<Mat3d> stiffness_, response_;        ///< T and (I + T)^-1 of each body, in world axes
  std::vector<Impulse> impulse_;                   ///< of each body
};

}  // namespace souple::joint
