#pragma once

#include "souple/math/mat3.h"
#include "souple/multilevel/distance_trees.h"
#include "souple/solver/facets.h"
#include "souple/solver/left_out.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace souple {

/// Solves trees of distances exactly: ropes, chains, and loads tied to them by distance joints and attachments.
/// Elimination from the leaves to the root has no fill, so the time is linear in their length. See Deul et al. 2018,
/// "Direct position-based solver for stiff rods".
///
/// From y, the positions without the constraints of the tree, a substep ends at x and lambda with
///
///   M (x - y) = sum_j f_j lambda_j,   C_j + alpha~_j lambda_j = 0,   f_j = a g_j + b g0_j + c g-_j,   a + b + c = 1
///
/// g_j is the direction of link j at x, g0_j at the start of the substep, and g-_j one substep before. The velocities
/// of the substep's start give g-_j as the direction of 2 d0 - d*. Here d0 is the difference of the link's ends then,
/// and d* the predicted one. A link that swings at omega turns according to
///
///   theta_n+1 - 2 theta_n + theta_n-1 = -(omega h)^2 (a theta_n+1 + b theta_n + c theta_n-1)
///
/// whose solutions shrink by sqrt((1 + c (omega h)^2) / (1 + a (omega h)^2)) per substep: a swing loses (a - c) omega^2 h
/// of its energy per second. a = 1 is implicit Euler, a = c loses nothing (a = b = 1/2: half as much as a = 1). a - c is
/// small here, and positive: what swings faster than substeps can follow loses sqrt(c / a) per substep. Links that are
/// jerked have c = 0, and a link that turns far in one substep has f_j = g_j. The first step of a substep finds which
/// links are jerked. Newton's method solves, until no particle moves further than a hundredth of its link relative to
/// its parent,
///
///   (M + T) dx - f lambda = M (y - x),   g . dx + alpha~ lambda = -C,
///   T = sum_j a t_j (I - g_j g_j^T) on the difference of the ends,   t_j = max(0, -lambda_j) / |d_j|
///
/// T follows from the turning of the links, under tension only. Without it a swinging load of many times the rope's
/// mass explodes. With compression the matrix would be indefinite (Tournier et al. 2015, "Stable constrained
/// dynamics"). The first lambda is -C / alpha~ of the substep's start. Links without compliance, and links without
/// length, need nothing special.
///
/// It is a projector with one color, whose elements are the trees. Several projections of a substep, with other
/// constraints in between, converge to a common solution. Then y is the position without the motion by the earlier
/// projections.
class TreeElimination final : public Projector {
 public:
  /// Finds the trees among the distances of all projectors, and the attachments of their particles. Topology is found
  /// again only when distances changed. Lengths, compliances, targets and masses are read in each projection.
  void find(std::span<Projector* const> projectors, std::size_t particle_count);
  bool has_trees() const { return trees_.size() > 0; }
  /// Adds the constraints of the trees: sweeps must omit them.
  void leave_out(LeftOut& left_out) const;
  /// Adds what the constraints of other projectors than `internal` moved in this substep. Call after the last
  /// projection.
  void add_external(ExternalMoves& external, const ParticleView& particles, const Substep& substep) const;

  std::string_view kind() const override { return "tree of distances"; }
  /// None of its own.
  std::size_t size() const override { return 0; }
  void prepare(std::size_t) override {}
  Facets facets() override { return {.every_round = true}; }
  int color_count() const override { return 1; }
  std::size_t color_size(int) const override { return trees_.size(); }
  std::uint32_t particle_of(int color, std::size_t tree, const ParticleView& particles) const override;
  void begin_substep(const ParticleView& particles, const Substep& substep) override;
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  Residual residual(const ParticleView&, Threads*) const override { return {}; }
  void erase_particles(std::uint32_t, std::uint32_t) override {}

 private:
  /// A particle and the link to its parent.
  struct Node {
    double mass = 0;         ///< kg; 0: fixed
    Vec3d x, y;              ///< m
    double length = 0;       ///< rest length of the link [m]; 0: its ends coincide
    double alpha = 0;        ///< alpha~ of the link [1/kg]
    double lambda = 0;       ///< of the link, divided by h^2: a mass times a length [kg m]
    Vec3d lambdas;           ///< of a link without length
    Vec3d dx, r;             ///< unknown and right side
    Mat3d D;                 ///< the node's block; once eliminated, the inverse N^-1
    Vec3d before, g0, g;     ///< g-: direction of the link one substep earlier; at the substep's start; now
    double calm = 1;         ///< 0: jerked
    double a = 1;            ///< weight of g in f
    Vec3d others;            ///< b g0 + c g-
    Vec3d f, p;              ///< direction of its force; see `eliminate`
    double C = 0;            ///< of the link [m]
    double t = 0, turn = 0;  ///< tension / length, and the part of it that turns with g
    double s = 0, rest = 0;  ///< see `eliminate`
    bool fixed() const { return mass == 0; }
  };
  /// Change in a step of Newton's method: the largest values of all links, as parts of their lengths.
  struct Change {
    double longest = 0;     ///< motion of a particle relative to its parent
    double by_tension = 0;  ///< the part of it that follows from a wrong tension
  };
  /// An attachment of a node.
  struct Anchor {
    std::uint32_t node = 0, set = 0, constraint = 0;
  };

  /// Data of a node that later projections of the substep need.
  struct Kept {
    Vec3d moved;        ///< by the projections so far [m]
    double lambda = 0;  ///< of the link
    double calm = 1;
    Vec3d force;  ///< f lambda, if forces are recorded
  };
  /// A tree that is being solved.
  struct Work {
    std::size_t begin;      ///< its first node
    std::span<Node> nodes;  ///< from that one on
    double h2;              ///< square of the substep [s^2]
  };

  void find_attachments(std::size_t particle_count);
  Node& parent_of(const Work& work, std::size_t k) const {
    return work.nodes[trees_.nodes[work.begin + k].parent - work.begin];
  }
  void load(const Work& work, const ParticleView& particles, bool begun);
  void load_link(Node& node, const Node& parent, const TreeNode& link, double h2) const;
  static void weigh_directions(Node& node, double calm);
  bool find_jerks(const Work& work) const;
  void store(const Work& work, const ParticleView& particles, bool with_forces);
  void solve(std::size_t tree, const Work& work, bool begun);
  void assemble(std::size_t tree, const Work& work);
  StructureFacet::Pull pull_of(const Anchor& anchor) const {
    return attachments_[anchor.set].structure->pull(anchor.constraint);
  }
  double anchor_alpha(const Anchor& anchor, double mass, double h2) const;
  static void eliminate(Node& node, Node& parent);
  static void eliminate_point(Node& node, Node& parent);
  static double by_tension(const Node& node, const Node& parent);
  Change substitute(const Work& work) const;

  DistanceTrees trees_;
  std::vector<Node> nodes_;       ///< work space
  std::vector<Kept> kept_;        ///< as trees_.nodes
  std::vector<Vec3d> predicted_;  ///< as trees_.nodes: position before any projection of the substep [m]
  std::vector<char> begun_;       ///< per tree: whether it was projected in this substep
  /// A projector of distances or attachments.
  struct Set {
    const Projector* projector;
    const StructureFacet* structure;
  };
  std::vector<Set> distances_, attachments_;
  std::vector<std::pair<const Projector*, std::uint64_t>> revisions_;  ///< of distances_
  std::size_t particle_count_ = 0;
  std::vector<Anchor> anchors_;               ///< ascending by node
  std::vector<std::uint32_t> anchors_begin_;  ///< per tree
};

}  // namespace souple
