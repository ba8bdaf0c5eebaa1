#include "souple/multilevel/tree_elimination.h"

#include "souple/assert.h"
#include "souple/math/sentinels.h"
#include "souple/solver/external_moves.h"

#include <algorithm>
#include <tuple>

namespace souple {
namespace {

/// Newton's method ends when no particle moved further relative to its parent than this part of the link's length.
/// The error that remains is about half of its square.
constexpr double enough = 0.01;
/// So much of a link's length may follow from a tension that was assumed wrongly.
constexpr double enough_of_tension = 0.001;
/// One step turns no link further than about this; a rope that was torn away needs several.
constexpr double longest_step = 0.5;
constexpr int most_steps = 8;
/// Compliance of rigid links to fixed particles, relative to the inverse mass of the other end.
constexpr double floor = 1e-8;
/// Weights of a link's directions at the substep's end and start in that of its force; the rest is that of a substep
/// before. The loss of a swing is proportional to 2 end + start - 1 = 0.09. A smaller one calms a jerked rope too slowly.
constexpr double end_weight = 0.32, start_weight = 0.45;
/// A link that is jerked gets the weights 1/2, 1/2 and 0. A jerk is a change of the angle that a link turns in a substep.
/// Between these two [rad] the weights change gradually. A steady whirl has none, however fast.
constexpr double small_jerk = 0.002, large_jerk = 0.004;
/// Cosine of the angle per substep up to which a link's force acts along a mean of its directions.
constexpr double little_turn = 0.9;
/// Lengths below this part of the rest length do not make a link turn more stiffly.
constexpr double shortest = 0.1;

double square(float h) {
  return static_cast<double>(h) * static_cast<double>(h);
}

/// (I - g g^T) v.
Vec3d across(const Vec3d& g, const Vec3d& v) {
  return v - g * dot(g, v);
}

Mat3d scaled_identity(double s) {
  return Mat3d::diagonal({s, s, s});
}

}  // namespace

void TreeElimination::find(std::span<Projector* const> projectors, std::size_t particle_count) {
  std::vector<std::pair<const Projector*, std::uint64_t>> revisions;
  distances_.clear(), attachments_.clear();
  for (Projector* projector : projectors) {
    const Facets facets = projector->facets();
    if (facets.distances != nullptr) {
      distances_.push_back({projector, facets.distances});
      revisions.emplace_back(projector, facets.distances->revision());
    }
    if (facets.attachments != nullptr) attachments_.push_back({projector, facets.attachments});
  }
  if (revisions != revisions_ || particle_count != particle_count_) {
    revisions_ = std::move(revisions);
    particle_count_ = particle_count;
    std::vector<TreeLink> links;
    for (std::uint32_t s = 0; s < distances_.size(); ++s)
      for (std::uint32_t i = 0; i < distances_[s].projector->size(); ++i) {
        const StructureFacet::Pull link = distances_[s].structure->pull(i);
        links.push_back({link.particle[0], link.particle[1], s, i, link.rest_length > 0});
      }
    trees_ = find_trees(links, particle_count);
    nodes_.assign(trees_.nodes.size(), {});
    kept_.assign(trees_.nodes.size(), {});
    predicted_.assign(trees_.nodes.size(), {});
  }
  find_attachments(particle_count);
}

void TreeElimination::leave_out(LeftOut& left_out) const {
  std::vector<std::vector<std::uint32_t>> links(distances_.size()), anchors(attachments_.size());
  for (std::uint32_t k = 0; k < trees_.nodes.size(); ++k) {
    const TreeNode& node = trees_.nodes[k];
    if (node.parent != k) links[node.set].push_back(node.constraint);
  }
  for (const Anchor& anchor : anchors_) anchors[anchor.set].push_back(anchor.constraint);
  for (std::size_t s = 0; s < links.size(); ++s)
    left_out.add(*distances_[s].projector, std::move(links[s]), distances_[s].projector->size());
  for (std::size_t s = 0; s < anchors.size(); ++s)
    left_out.add(*attachments_[s].projector, std::move(anchors[s]), attachments_[s].projector->size());
}

void TreeElimination::find_attachments(std::size_t particle_count) {
  std::vector<std::uint32_t> node_of(has_trees() && !attachments_.empty() ? particle_count : 0, no_index);
  for (std::uint32_t k = 0; !node_of.empty() && k < trees_.nodes.size(); ++k)
    node_of[trees_.nodes[k].particle] = k;
  anchors_.clear();
  for (std::uint32_t s = 0; !node_of.empty() && s < attachments_.size(); ++s) {
    for (std::uint32_t i = 0; i < attachments_[s].projector->size(); ++i) {
      const std::uint32_t node = node_of[attachments_[s].structure->pull(i).particle[0]];
      if (node == no_index) continue;
      anchors_.push_back({node, s, i});
    }
  }
  std::sort(anchors_.begin(), anchors_.end(), [](const Anchor& a, const Anchor& b) {
    return std::tuple(a.node, a.set, a.constraint) < std::tuple(b.node, b.set, b.constraint);
  });
  anchors_begin_.clear();
  for (const std::uint32_t begin : trees_.begin)
    anchors_begin_.push_back(
        static_cast<std::uint32_t>(std::partition_point(anchors_.begin(), anchors_.end(),
                                                        [&](const Anchor& a) { return a.node < begin; }) -
                                   anchors_.begin()));
}

void TreeElimination::begin_substep(const ParticleView& particles, const Substep&) {
  begun_.assign(trees_.size(), 0);
  for (std::size_t k = 0; k < predicted_.size(); ++k)
    predicted_[k] = particles.exact_position(trees_.nodes[k].particle);
}

std::uint32_t TreeElimination::particle_of(int, std::size_t tree, const ParticleView& particles) const {
  for (std::size_t k = trees_.begin[tree]; k < trees_.begin[tree + 1]; ++k)
    if (particles.inverse_mass(trees_.nodes[k].particle) > 0) return trees_.nodes[k].particle;
  return no_particle;
}

// All trees of a call use the memory of the first nodes, which stays in the cache: no tree has more nodes than all.
void TreeElimination::project(int, std::size_t begin, std::size_t end, const ParticleView& particles,
                              const Substep& substep) {
  SOUPLE_ASSERT(end <= trees_.size() && begun_.size() == trees_.size(), "begin_substep comes before project");
  for (std::size_t tree = begin; tree < end; ++tree) {
    if (particle_of(0, tree, particles) == no_particle) continue;
    Work work{trees_.begin[tree], {}, square(substep.h)};
    work.nodes = std::span(nodes_).subspan(trees_.begin[begin], trees_.begin[tree + 1] - work.begin);
    load(work, particles, begun_[tree] != 0);
    solve(tree, work, begun_[tree] != 0);
    begun_[tree] = 1;
    store(work, particles, substep.external != nullptr);
  }
}

void TreeElimination::load(const Work& work, const ParticleView& particles, bool begun) {
  for (std::size_t k = 0; k < work.nodes.size(); ++k) {
    Node& node = work.nodes[k];
    const std::uint32_t i = trees_.nodes[work.begin + k].particle;
    const auto w = static_cast<double>(particles.inverse_mass(i));
    node.mass = w > 0 ? 1 / w : 0;
    node.x = particles.exact_start(i);
  }
  for (std::size_t k = 0; k + 1 < work.nodes.size(); ++k) {
    const TreeNode& link = trees_.nodes[work.begin + k];
    Node& node = work.nodes[k];
    const Node& parent = parent_of(work, k);
    load_link(node, parent, link, work.h2);
    const Vec3d predicted = predicted_[work.begin + k] - predicted_[link.parent];
    const Vec3d before = (node.x - parent.x) * 2 - predicted;
    node.before = before * (1 / max(length(before), 1e-18));
    weigh_directions(node, begun ? kept_[work.begin + k].calm : 1);
  }
  for (std::size_t k = 0; k < work.nodes.size(); ++k) {
    Node& node = work.nodes[k];
    Kept& kept = kept_[work.begin + k];
    if (begun) {
      node.lambda = kept.lambda;
    } else {
      kept.moved = {};
    }
    node.x = particles.exact_position(trees_.nodes[work.begin + k].particle);
    node.y = node.x - kept.moved;
  }
}

// Rest length and compliance, and direction and multiplier of the substep's start.
void TreeElimination::load_link(Node& node, const Node& parent, const TreeNode& link, double h2) const {
  const StructureFacet::Pull pull = distances_[link.set].structure->pull(link.constraint);
  const Vec3d d = node.x - parent.x;
  const double l = length(d);
  node.length = max(0.0, static_cast<double>(pull.rest_length));
  node.alpha = static_cast<double>(pull.compliance) / h2;
  node.lambda = node.alpha > 0 ? (node.length - l) / node.alpha : 0;
  node.g0 = d * (1 / max(l, 1e-18));
  if (node.fixed() && !parent.fixed()) node.alpha = max(node.alpha, floor / parent.mass);
}

void TreeElimination::weigh_directions(Node& node, double calm) {
  node.calm = calm;
  node.a = 0.5 + calm * (end_weight - 0.5);
  const double b = 0.5 + calm * (start_weight - 0.5);
  node.others = node.g0 * b + node.before * (1 - node.a - b);
}

// Weighs the directions of the links that are jerked. Returns whether there are any.
bool TreeElimination::find_jerks(const Work& work) const {
  bool any = false;
  for (std::size_t k = 0; k + 1 < work.nodes.size(); ++k) {
    Node& node = work.nodes[k];
    const Vec3d d = node.x - parent_of(work, k).x;
    const double jerk = length(across(node.g0, d * (1 / max(length(d), 1e-18)) + node.before));
    const double calm = std::clamp((large_jerk - jerk) / (large_jerk - small_jerk), 0.0, 1.0);
    if (calm == 1) continue;
    weigh_directions(node, calm);
    any = true;
  }
  return any;
}

void TreeElimination::store(const Work& work, const ParticleView& particles, bool with_forces) {
  for (std::size_t k = 0; k < work.nodes.size(); ++k) {
    const Node& node = work.nodes[k];
    Kept& kept = kept_[work.begin + k];
    kept.lambda = node.lambda;
    kept.calm = node.calm;
    if (with_forces) kept.force = node.length > 0 ? node.f * node.lambda : node.lambdas;
    if (node.fixed()) continue;
    const std::uint32_t i = trees_.nodes[work.begin + k].particle;
    const Vec3d change = node.x - particles.exact_position(i);
    kept.moved += change;
    particles.moving[i].set_xyz(Vec3f(Vec3d(particles.moving[i].xyz()) + change));
  }
}

void TreeElimination::solve(std::size_t tree, const Work& work, bool begun) {
  for (int step = 0; step < most_steps; ++step) {
    assemble(tree, work);
    const Change change = substitute(work);
    const double part = change.longest > longest_step ? longest_step / change.longest : 1;
    for (Node& node : work.nodes) node.x += node.dx * part;
    if (step == 0 && !begun && find_jerks(work)) continue;
    if (change.longest < enough && change.by_tension < enough_of_tension) return;
  }
}

double TreeElimination::anchor_alpha(const Anchor& anchor, double mass, double h2) const {
  return max(static_cast<double>(pull_of(anchor).compliance) / h2, floor / mass);
}

// Fills D and r, and eliminates all nodes but the root.
void TreeElimination::assemble(std::size_t tree, const Work& work) {
  for (Node& node : work.nodes) {
    node.D = scaled_identity(node.mass);
    node.r = (node.y - node.x) * node.mass;
  }
  for (std::size_t a = anchors_begin_[tree]; a < anchors_begin_[tree + 1]; ++a) {
    const Anchor& anchor = anchors_[a];
    Node& node = work.nodes[anchor.node - work.begin];
    if (node.fixed()) continue;
    const double stiffness = 1 / anchor_alpha(anchor, node.mass, work.h2);
    const Vec3d target(pull_of(anchor).target);
    node.D = node.D + scaled_identity(stiffness);
    node.r += (target - node.x) * stiffness;
  }
  for (std::size_t k = 0; k + 1 < work.nodes.size(); ++k) {
    Node& node = work.nodes[k];
    Node& parent = parent_of(work, k);
    if (node.fixed() && parent.fixed()) continue;
    if (node.length > 0) {
      eliminate(node, parent);
    } else {
      eliminate_point(node, parent);
    }
  }
}

// The rows of a node i, its link, and its parent p, with P = I - g g^T and t for a t or t:
//
//   (D + t P) dx_i - t P dx_p - f lambda = r
//   g . (dx_i - dx_p) + alpha~ lambda = -C
//   (D_p + t P) dx_p - t P dx_i + f lambda = r_p
//
// The first two, with N = D + t P, q = f - t P N^-1 f, p = g - t P N^-T g and s = 1 / (alpha~ + g . N^-1 f), give
//
//   lambda = s (p . dx_p - C - g . N^-1 r),   dx_i = N^-1 (r + t P dx_p + f lambda)
//
// and the third becomes
//
//   (D_p + t P - t P N^-1 t P + s q p^T) dx_p = r_p + t P N^-1 r + s q (C + g . N^-1 r)
//
// A fixed node has N^-1 = 0. A fixed parent needs no row.
void TreeElimination::eliminate(Node& node, Node& parent) {
  const Vec3d d = node.x - parent.x;
  const double l = length(d);
  node.g = d * (1 / max(l, 1e-18));
  node.C = l - node.length;
  node.t = max(0.0, -node.lambda) / max(l, shortest * node.length);
  const bool little = dot(node.g, node.g0) > little_turn;
  node.f = little ? node.g * node.a + node.others : node.g;
  node.turn = little ? node.a * node.t : node.t;
  const Mat3d tP = scaled_identity(node.turn) - outer(node.g * node.turn, node.g);
  node.D = node.fixed() ? Mat3d{} : inverse(node.D + tP);
  const Vec3d right = node.D * node.g, left = transpose(node.D) * node.g, n = node.D * node.f,
              free = node.D * node.r;
  node.p = node.g - across(node.g, left) * node.turn;
  node.rest = node.C + dot(node.g, free);
  const double sum = node.alpha + dot(node.g, n);
  node.s = sum > 0 ? 1 / sum : 0;
  if (parent.fixed()) return;
  const Vec3d q = node.f - across(node.g, n) * node.turn;
  const Vec3d gPN = left - node.g * dot(node.g, right);  // P N^-1 P = N^-1 - right g^T - g gPN^T
  const Mat3d PNP = node.D - outer(right, node.g) - outer(node.g, gPN);
  parent.D = parent.D + tP - PNP * (node.turn * node.turn) + outer(q * node.s, node.p);
  parent.r += across(node.g, free) * node.turn + q * (node.s * node.rest);
}

// A link without length is linear in the difference d of its ends, which takes the place of C:
//
//   lambda = S (dx_p - d - D^-1 r),   S = (alpha~ I + D^-1)^-1,   dx_i = D^-1 (r + lambda)
//   (D_p + S) dx_p = r_p + S (d + D^-1 r)
void TreeElimination::eliminate_point(Node& node, Node& parent) {
  node.g = node.x - parent.x;
  node.D = node.fixed() ? Mat3d{} : inverse(node.D);
  if (parent.fixed()) return;
  const Mat3d S = inverse(node.D + scaled_identity(node.alpha));
  parent.D = parent.D + S;
  parent.r += S * (node.g + node.D * node.r);
}

// Error of a link end's motion by the assumed tension t, as a part of its length: the lighter end moves by force /
// (mass + t). A stiff link's assumed tension may be a thousand times too large.
double TreeElimination::by_tension(const Node& node, const Node& parent) {
  const double t = max(0.0, -node.lambda) / max(node.C + node.length, shortest * node.length);
  const double mass = node.fixed() || parent.fixed() ? node.mass + parent.mass : min(node.mass, parent.mass);
  return abs(t - node.t) * length(across(node.g, node.dx - parent.dx)) / ((mass + t) * node.length);
}

// From the root to the leaves.
TreeElimination::Change TreeElimination::substitute(const Work& work) const {
  Change change;
  Node& root = work.nodes.back();
  root.dx = root.fixed() ? Vec3d{} : inverse(root.D) * root.r;
  for (std::size_t k = work.nodes.size() - 1; k-- > 0;) {
    Node& node = work.nodes[k];
    const Node& parent = parent_of(work, k);
    node.dx = {};
    if (node.fixed() && parent.fixed()) continue;
    if (node.length > 0) {
      node.lambda = node.s * (dot(node.p, parent.dx) - node.rest);
      const Vec3d force = node.r + across(node.g, parent.dx) * node.turn + node.f * node.lambda;
      if (!node.fixed()) node.dx = node.D * force;
      change.longest = max(change.longest, length(node.dx - parent.dx) / node.length);
      change.by_tension = max(change.by_tension, by_tension(node, parent));
    } else {
      node.lambdas = inverse(node.D + scaled_identity(node.alpha)) * (parent.dx - node.g - node.D * node.r);
      if (!node.fixed()) node.dx = node.D * (node.r + node.lambdas);
    }
  }
  return change;
}

void TreeElimination::add_external(ExternalMoves& external, const ParticleView& particles,
                                   const Substep& substep) const {
  const auto add = [&](std::uint32_t particle, const Vec3d& force) {
    external.add(particle, Vec3f(force * static_cast<double>(particles.inverse_mass(particle))));
  };
  for (std::size_t tree = 0; tree < trees_.size(); ++tree) {
    if (begun_[tree] == 0) continue;
    for (std::size_t k = trees_.begin[tree]; k + 1 < trees_.begin[tree + 1]; ++k) {
      const TreeNode& node = trees_.nodes[k];
      if (!external.concerns(*distances_[node.set].projector)) continue;
      add(node.particle, kept_[k].force), add(trees_.nodes[node.parent].particle, -kept_[k].force);
    }
  }
  for (const Anchor& anchor : anchors_) {
    const std::uint32_t i = trees_.nodes[anchor.node].particle;
    const auto w = static_cast<double>(particles.inverse_mass(i));
    if (w == 0 || !external.concerns(*attachments_[anchor.set].projector)) continue;
    const Vec3d target(pull_of(anchor).target);
    add(i, (target - particles.exact_position(i)) * (1 / anchor_alpha(anchor, 1 / w, square(substep.h))));
  }
}

}  // namespace souple
