#pragma once

#include "souple/rigid/contact_block.h"
#include "souple/rigid/impacts.h"
#include "souple/rigid/joints/block_cholesky.h"
#include "souple/threads/threads.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Contacts between rigid bodies, in a substep:
///
///   bounce      before the prediction: velocities of bodies that hit each other and bounce
///   solve       after the prediction: poses; as often as one likes
class ContactSolver {
 public:
  /// Call when the list of contacts has changed.
  void prepare(std::span<const RigidContact> contacts, const RigidBodies& bodies);
  void bounce(std::span<const RigidContact> contacts, RigidBodies& bodies, const RigidSubstep& substep);
  void solve(std::span<RigidContact> contacts, RigidBodies& bodies, const RigidSubstep& substep,
             Threads& threads);

  /// The largest depth [m].
  static double deepest(std::span<const RigidContact> contacts, const RigidBodies& bodies);
  std::size_t bytes() const;

 //private:
  void read_bodies(const RigidBodies& bodies);
  void linearize(RigidContact& contact, ContactBlock& block, const RigidBodies& bodies,
                 const RigidSubstep& substep) const;
  void find_islands();
  void solve_island(std::size_t island, const RigidSubstep& substep);
  bool newton(std::size_t island);
  double sweep(std::size_t island, bool forward);
  void keep(RigidContact& contact, const ContactBlock& block) const;

  Impacts impacts_;
  bool begun_ = false;                 // blocks are those of this substep
  std::vector<ContactBody> states_;    // per body, and one for no_body
  std::vector<ContactBlock> blocks_;   // of contacts with points
  std::vector<std::uint32_t> root_;    // per body
  std::vector<std::uint32_t> island_of_;
  std::vector<std::uint32_t> island_begin_, island_blocks_;
  struct Work { joint::BlockCholesky matrix; std::vector<std::uint32_t> bodies; std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs; std::vector<double> x, q, mq, md, g; };
  std::vector<Work> work_; std::vector<std::uint32_t> local_; std::vector<Mat3d> inertia_;
 public:
  static inline long n_sweeps = 0, n_substeps = 0, max_sweeps = 0, n_islands = 0, n_points = 0, n_sweep_points = 0;
  static inline double tolerance = 1e-3; static inline long cap = 200; static inline int inner = 2; static inline bool ncg = false;
  static inline double recovery = 0.01; static inline double kappa = 1e3, kappa_t = 1e3; static inline long n_newton = 0, n_slopes = 0, n_failed = 0; static inline int trials = 4; static inline long pre = 2, post = 1, newtons = 6; static inline double cost_limit = 1e7;
};

}  // namespace souple
