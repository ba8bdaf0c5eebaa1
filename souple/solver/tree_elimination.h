#pragma once

#include "souple/constraints/attachment.h"
#include "souple/constraints/distance.h"
#include "souple/math/mat3.h"
#include "souple/solver/distance_trees.h"
#include "souple/solver/left_out.h"
#include "souple/solver/projector.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

template <class Kind>
class SetProjector;

class TreeElimination {
 public:
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles);
  bool empty() const { return trees_.nodes.empty(); }
  /// Whether a constraint belongs to a tree.
  const LeftOut& left_out() const { return left_out_; }
  void solve(const ParticleView& particles, const Substep& substep, int iteration, Threads& threads);

 //private:
  struct Sym3 {
    double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;
  };
  /// A particle of a tree and its link to its parent.
  struct Node {
    double mass = 0;  ///< kg; 0: fixed
    Vec3d x, target;  ///< m
    Vec3d dx, r;
    Sym3 D;           ///< becomes N^-1
    Vec3d g, n, q;
    double rest_length = 0, alpha = 0, C = 0, tension = 0, t = 0, s = 0;
    bool point = false;
  };
  struct Anchor {
    std::uint32_t node = 0, set = 0, constraint = 0;
  };

  void solve_tree(std::size_t tree, const ParticleView& particles, const Substep& substep, int iteration);
  void load(std::size_t begin, std::size_t end, const ParticleView& particles, const Substep& substep, int iteration);
  void eliminate(std::size_t tree, double inverse_h2);
  double substitute(std::size_t begin, std::size_t end);

  DistanceTrees trees_;
  std::vector<TreeLink> links_;
  std::vector<const SetProjector<Distance>*> distances_;
  std::vector<const SetProjector<Attachment>*> attachments_;
  std::vector<std::uint64_t> revisions_;
  std::vector<std::uint32_t> node_of_;
  std::vector<Anchor> anchors_;
  std::vector<std::uint32_t> anchor_begin_;
  std::vector<Node> nodes_;
  std::vector<Vec3d> moved_;
  LeftOut left_out_;
  int max_newton_ = 8;
 public:
  static inline long solves = 0, newtons = 0;
};

}  // namespace souple
