#include "souple/solver/tree_elimination.h"

#include "souple/solver/set_projector.h"

#include <cmath>
#include <cstdlib>

namespace souple {
namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};
using Sym3 = TreeElimination::Sym3;

Vec3d mul(const Sym3& m, const Vec3d& v) {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}
void add_outer(Sym3& m, double s, const Vec3d& a) {
  const Vec3d b = a * s;
  m.xx += b.x * a.x, m.xy += b.x * a.y, m.yy += b.y * a.y, m.xz += b.x * a.z, m.yz += b.y * a.z, m.zz += b.z * a.z;
}
void add_pair(Sym3& m, const Vec3d& a, const Vec3d& b) {  // a b^T + b a^T
  m.xx += 2 * a.x * b.x, m.yy += 2 * a.y * b.y, m.zz += 2 * a.z * b.z;
  m.xy += a.x * b.y + a.y * b.x, m.xz += a.x * b.z + a.z * b.x, m.yz += a.y * b.z + a.z * b.y;
}
void add_identity(Sym3& m, double s) { m.xx += s, m.yy += s, m.zz += s; }
void add(Sym3& m, double s, const Sym3& a) {
  m.xx += s * a.xx, m.xy += s * a.xy, m.yy += s * a.yy, m.xz += s * a.xz, m.yz += s * a.yz, m.zz += s * a.zz;
}
Sym3 inverse(const Sym3& m) {
  const double cxx = m.yy * m.zz - m.yz * m.yz, cxy = m.xz * m.yz - m.xy * m.zz, cxz = m.xy * m.yz - m.xz * m.yy;
  const double d = 1 / (m.xx * cxx + m.xy * cxy + m.xz * cxz);
  return {cxx * d, cxy * d, (m.xx * m.zz - m.xz * m.xz) * d, cxz * d, (m.xz * m.xy - m.xx * m.yz) * d,
          (m.xx * m.yy - m.xy * m.xy) * d};
}

Vec3d position(const ParticleView& particles, std::size_t i) {
  const Vec3d x(particles.position[i].xyz());
  return particles.form == Form::displacement ? x + Vec3d(particles.moving[i].xyz()) : x;
}
Vec3d start_position(const ParticleView& particles, std::size_t i) {
  const Vec3d x(particles.start[i].xyz());
  return particles.form == Form::displacement ? x + Vec3d(particles.position[i].xyz()) : x;
}

}  // namespace

void TreeElimination::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  distances_.clear(), attachments_.clear(), links_.clear();
  for (const Projector* projector : projectors) {
    if (const auto* distances = dynamic_cast<const SetProjector<Distance>*>(projector)) {
      const auto set = static_cast<std::uint32_t>(distances_.size());
      for (std::uint32_t i = 0; i < distances->size(); ++i) {
        const auto [a, b] = distances->set().indices(i);
        links_.push_back({a, b, set, i});
      }
      distances_.push_back(distances);
    }
    if (const auto* attachments = dynamic_cast<const SetProjector<Attachment>*>(projector))
      attachments_.push_back(attachments);
  }
  trees_ = find_trees(links_, particles.position.size());
  nodes_.assign(trees_.nodes.size(), {});
  moved_.assign(trees_.nodes.size(), {});
  node_of_.assign(particles.position.size(), none);
  for (std::uint32_t k = 0; k < trees_.nodes.size(); ++k) node_of_[trees_.nodes[k].particle] = k;
  anchors_.clear();
  left_out_.clear();
  std::vector<std::vector<std::uint32_t>> left(distances_.size());
  for (std::uint32_t k = 0; k < trees_.nodes.size(); ++k) {
    if (trees_.nodes[k].parent == k) continue;
    const TreeLink& link = links_[trees_.nodes[k].link];
    left[link.set].push_back(link.constraint);
  }
  for (std::size_t s = 0; s < left.size(); ++s) {
    std::sort(left[s].begin(), left[s].end());
    if (!left[s].empty()) left_out_.add(*distances_[s], left[s], distances_[s]->size());
  }
  for (std::uint32_t s = 0; s < attachments_.size(); ++s) {
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < attachments_[s]->size(); ++i) {
      const std::uint32_t node = node_of_[attachments_[s]->set().indices(i)[0]];
      if (node == none) continue;
      anchors_.push_back({node, s, i});
      out.push_back(i);
    }
    if (!out.empty()) left_out_.add(*attachments_[s], out, attachments_[s]->size());
  }
  std::sort(anchors_.begin(), anchors_.end(), [](const Anchor& a, const Anchor& b) {
    return std::tuple(a.node, a.set, a.constraint) < std::tuple(b.node, b.set, b.constraint);
  });
  anchor_begin_.clear();
  for (const std::uint32_t begin : trees_.begin)
    anchor_begin_.push_back(static_cast<std::uint32_t>(
        std::lower_bound(anchors_.begin(), anchors_.end(), begin, [](const Anchor& a, std::uint32_t n) { return a.node < n; }) -
        anchors_.begin()));
  if (const char* e = std::getenv("NEWTON")) max_newton_ = std::atoi(e);
}

void TreeElimination::solve(const ParticleView& particles, const Substep& substep, int iteration, Threads& threads) {
  threads.for_each(trees_.begin.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t tree = begin; tree < end; ++tree) solve_tree(tree, particles, substep, iteration);
  });
}

void TreeElimination::load(std::size_t begin, std::size_t end, const ParticleView& particles, const Substep& substep, int iteration) {
  const double inverse_h2 = 1 / (double(substep.h) * double(substep.h));
  for (std::size_t k = begin; k < end; ++k) {
    Node& node = nodes_[k];
    const std::uint32_t i = trees_.nodes[k].particle;
    const auto w = double(particles.inverse_mass(i));
    node.mass = w > 0 ? 1 / w : 0;
    node.x = position(particles, i);
    if (iteration == 0) moved_[k] = {};
    node.target = node.x - moved_[k];
    if (trees_.nodes[k].parent == k) continue;
    const TreeLink& link = links_[trees_.nodes[k].link];
    const auto& set = distances_[link.set]->set();
    node.rest_length = double(set.params(link.constraint).rest_length);
    node.point = node.rest_length <= 0;
    node.alpha = double(set.compliance(link.constraint)[0]) * inverse_h2;
    if (iteration > 0) continue;
    const double l = length(start_position(particles, i) - start_position(particles, trees_.nodes[trees_.nodes[k].parent].particle));
    node.tension = node.alpha > 0 ? (l - node.rest_length) / node.alpha : 0;
  }
}

// Leaf to root.
void TreeElimination::eliminate(std::size_t tree, double inverse_h2) {
  const std::size_t begin = trees_.begin[tree], end = trees_.begin[tree + 1];
  for (std::size_t k = begin; k < end; ++k) {
    Node& node = nodes_[k];
    node.D = {node.mass, 0, node.mass, 0, 0, node.mass};
    node.r = (node.target - node.x) * node.mass;
  }
  for (std::size_t a = anchor_begin_[tree]; a < anchor_begin_[tree + 1]; ++a) {
    const Anchor& anchor = anchors_[a];
    Node& node = nodes_[anchor.node];
    if (!(node.mass > 0)) continue;
    const auto& set = attachments_[anchor.set]->set();
    const double alpha = std::fmax(double(set.compliance(anchor.constraint)[0]) * inverse_h2, 1e-8 / node.mass);
    add_identity(node.D, 1 / alpha);
    node.r += (Vec3d(set.params(anchor.constraint).target) - node.x) * (1 / alpha);
  }
  for (std::size_t k = begin; k + 1 < end; ++k) {
    Node& node = nodes_[k];
    Node& parent = nodes_[trees_.nodes[k].parent];
    const bool fixed = !(node.mass > 0), fixed_parent = !(parent.mass > 0);
    if (fixed && fixed_parent) continue;
    const Vec3d d = node.x - parent.x;
    const double l = length(d);
    const double alpha = fixed ? std::fmax(node.alpha, 1e-8 / parent.mass) : node.alpha;
    if (node.point) {
      const Sym3 inverse_N = fixed ? Sym3{} : inverse(node.D);
      node.g = d;
      node.D = inverse_N;
      if (fixed_parent) add_identity(node.D, 0);
      Sym3 sum = inverse_N;
      add_identity(sum, alpha);
      const Sym3 S = inverse(sum);
      if (!fixed_parent) {
        add(parent.D, 1, S);
        parent.r += mul(S, d + mul(inverse_N, node.r));
      }
      continue;
    }
    node.g = d * (1 / std::fmax(l, 1e-18));
    node.C = l - node.rest_length;
    node.t = std::fmax(0.0, node.tension) / std::fmax(l, 0.1 * node.rest_length);
    if (fixed) {
      node.D = {};
    } else {
      add_identity(node.D, node.t);
      add_outer(node.D, -node.t, node.g);
      node.D = inverse(node.D);
    }
    node.n = mul(node.D, node.g);
    const double gn = dot(node.g, node.n);
    node.q = node.g - (node.n - node.g * gn) * node.t;
    const double sum = alpha + gn;
    node.s = sum > 0 ? 1 / sum : 0;
    if (fixed_parent) continue;
    // t P - t P N^-1 t P
    add_identity(parent.D, node.t);
    add_outer(parent.D, -node.t, node.g);
    const double t2 = node.t * node.t;
    add(parent.D, -t2, node.D);
    add_pair(parent.D, node.g * t2, node.n);
    add_outer(parent.D, -t2 * gn, node.g);
    add_outer(parent.D, node.s, node.q);
    const Vec3d free = mul(node.D, node.r);
    parent.r += (free - node.g * dot(node.g, free)) * node.t + node.q * (node.s * (node.C + dot(node.n, node.r)));
  }
}

// Root to leaf; returns the largest motion of a particle relative to its parent.
double TreeElimination::substitute(std::size_t begin, std::size_t end) {
  Node& root = nodes_[end - 1];
  root.dx = root.mass > 0 ? mul(inverse(root.D), root.r) : Vec3d{};
  double largest = 0;
  for (std::size_t k = end - 1; k-- > begin;) {
    Node& node = nodes_[k];
    const Node& parent = nodes_[trees_.nodes[k].parent];
    const bool fixed = !(node.mass > 0);
    if (fixed && !(parent.mass > 0)) {
      node.dx = {};
      continue;
    }
    if (node.point) {
      const double alpha = fixed ? std::fmax(node.alpha, 1e-8 / parent.mass) : node.alpha;
      Sym3 sum = node.D;
      add_identity(sum, alpha);
      const Vec3d lambda = mul(inverse(sum), parent.dx - node.g - mul(node.D, node.r));
      node.dx = fixed ? Vec3d{} : mul(node.D, node.r + lambda);
      continue;
    }
    const Vec3d across = (parent.dx - node.g * dot(node.g, parent.dx)) * node.t;
    const double lambda = node.s * (dot(node.q, parent.dx) - node.C - dot(node.n, node.r));
    node.dx = fixed ? Vec3d{} : mul(node.D, node.r + across + node.g * lambda);
    node.tension = -lambda;
    largest = std::fmax(largest, length(node.dx - parent.dx) / node.rest_length);
  }
  return largest;
}

void TreeElimination::solve_tree(std::size_t tree, const ParticleView& particles, const Substep& substep, int iteration) {
  const std::size_t begin = trees_.begin[tree], end = trees_.begin[tree + 1];
  bool any = false;
  for (std::size_t k = begin; k < end && !any; ++k) any = particles.inverse_mass(trees_.nodes[k].particle) > 0;
  if (!any) return;
  load(begin, end, particles, substep, iteration);
  const double inverse_h2 = 1 / (double(substep.h) * double(substep.h));
  ++solves;
  for (int newton = 0; newton < max_newton_; ++newton) {
    ++newtons;
    eliminate(tree, inverse_h2);
    const double largest = substitute(begin, end);
    const double step = largest > 0.5 ? 0.5 / largest : 1;
    for (std::size_t k = begin; k < end; ++k) nodes_[k].x += nodes_[k].dx * step;
    if (largest < 0.01) break;
  }
  for (std::size_t k = begin; k < end; ++k) {
    const std::uint32_t i = trees_.nodes[k].particle;
    if (!(nodes_[k].mass > 0)) continue;
    const Vec3d change = nodes_[k].x - position(particles, i);
    moved_[k] += change;
    Vec4f& moving = particles.moving[i];
    moving.set_xyz(Vec3f(Vec3d(moving.xyz()) + change));
  }
}

}  // namespace souple
