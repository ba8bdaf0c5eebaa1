#pragma once

#include "souple/multilevel/tet_lattice.h"
#include "souple/solver/set_projector.h"

#include <utility>
#include <vector>

namespace souple {

/// A coarse level for bodies of stiff, fine tets. A sweep from lambda = 0 supplies a part of their stiffness that
/// decreases with h^2 E / (rho dx^2) (docs/notes/solvers.md). Before the sweeps, the level supplies the rest. It moves
/// the nodes of a coarse lattice (TetLattice) by the implicit Euler step of the remaining elastic forces,
///
///   (M + h^2 K) dX = h^2 P^T f(x*),    x = x* + P dX
///
/// P: trilinear interpolation; M = P^T m: masses of the nodes; f: forces of all tets (elastic_forces). K: stiffness of
/// the lattice, with the rotations of its cells. In equilibrium f is the load, and dX takes back what the load moved,
/// whatever K is. So a body at rest has the shape of its tets, not that of the lattice. K only has to be at least as
/// stiff as P^T (df/dx) P, or the body trembles.
///
/// The lattice feels colliders: springs hold the particles that the body presses against one. A body that presses
/// against another object would have to move that object as well. A body that touches others has no level meanwhile,
/// and is swept as often as it needs.
///
/// Conjugate gradients with M as preconditioner find dX. Every iterate is M^-1 times a sum of forces without resultant.
/// So momentum is conserved to rounding, and an unfinished solution is softer, not braked.
class TetLevels {
 public:
  /// Finds the bodies and builds the lattices of those that may need one, unless the tets are unchanged.
  void prepare(SetProjector<NeoHookean>* tets, const ParticleView& particles);
  /// Chooses the bodies that need a level in such a substep.
  void choose(const Substep& substep);
  /// Moves the particles of these bodies, unless they touch other objects, and tells the tets. As many sweeps of the
  /// tets follow as they need.
  void correct(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
               Threads& threads);

 private:
  struct Body {
    TetLattice lattice;
    float softness = 0;                             ///< mean of NeoHookean::softness [1/s^2]
    bool wanted = false;                            ///< needs a level in substeps of this length
    bool active = false;                            ///< and has one in this substep
    int sweeps = 1;                                 ///< of its tets in this substep
    std::vector<std::uint32_t> child_begin, child;  ///< per node: particles of the lattice
    std::vector<float> child_weight;
    std::vector<float> mass;            ///< per node [kg]
    std::vector<std::uint32_t> pinned;  ///< particles of the lattice
    std::vector<std::uint32_t>
        held;  ///< pinned particles, and those that the body presses against a collider
    std::vector<float> held_stiffness;  ///< per node: sum over the held particles [N/m]
    std::vector<float> inverse;         ///< per node: preconditioner [1/kg]
    // Per slot, the cells sorted by color and padded:
    std::vector<std::uint32_t> cell;  ///< none: padding
    std::vector<std::uint32_t> color_begin;
    std::array<std::vector<std::uint32_t>, kernels::cell_nodes> node;
    std::vector<float> stiffness, rotation, scale;
    // Per node and one more, for padding:
    std::vector<Vec4f> x, r, p, Ap;
  };

  void meet_contacts(std::span<Projector* const> projectors, const ParticleView& particles,
                     const Substep& substep, Threads& threads);
  void choose_wanted(std::span<Projector* const> projectors, const ParticleView& particles,
                     const Substep& substep) const;
  void sweep_wanted(Projector& contacts, const ParticleView& particles, const Substep& substep,
                    Threads& threads);
  void find_held(Body& body) const;
  void mark();
  void find_bodies(const ParticleView& particles);
  void find_softness(const ParticleView& particles);
  void set_masses(Body& body, const ParticleView& particles) const;
  static void arrange(Body& body);
  void find_forces(const ParticleView& particles, const Substep& substep, Threads& threads);
  void find_sweeps(const Substep& substep);
  void add_forces(int sweeps, const ParticleView& particles, const Substep& substep, Threads& threads);
  static void measure_cells(Body& body, const ParticleView& particles, float h2, Threads& threads);
  static void restrict_forces(Body& body, std::span<const Vec4f> force, Threads& threads);
  static void solve(Body& body, float h2, Threads& threads);
  static void apply(Body& body, float h2, Threads& threads);
  static void limit_moves(Body& body);
  /// How far the nodes move particle i of the lattice. [m]
  static Vec3f node_move(const Body& body, std::uint32_t i);
  static void prolong(const Body& body, const ParticleView& particles, Threads& threads);

  SetProjector<NeoHookean>* tets_ = nullptr;
  // Work space:
  std::vector<IndexRange> ranges_, tet_ranges_;
  std::vector<SweptRun> runs_;
  std::uint64_t revision_ = 0;
  std::vector<Body> bodies_;
  std::vector<std::uint32_t> body_of_;  ///< per tet of the set
  std::vector<std::uint8_t> in_level_;  ///< per tet of the set
  std::vector<Vec4f> force_;            ///< per particle of the world: h^2 f [kg m]
  /// Per particle: how far contacts with colliders, and all others, moved it. [m]
  std::vector<Vec3f> collider_moved_, others_moved_;
  std::pair<float, int> chosen_for_{0, 0};
  bool any_ = false;  ///< a body is wanted
};

}  // namespace souple
