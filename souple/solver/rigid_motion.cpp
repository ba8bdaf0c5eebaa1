#include "souple/solver/rigid_motion.h"

#include "souple/math/mat3.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace souple {
namespace {

constexpr double negligible = 1e-4;  // of sums of gradients that come in float

/// Who belongs together, each set named by its smallest member.
struct Sets {
  std::vector<std::uint32_t> parent;

  explicit Sets(std::size_t n) : parent(n) { std::iota(parent.begin(), parent.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    parent[std::max(a, b)] = std::min(a, b);
  }
};

// Items 0..n sorted by set; begin of each set, and the end.
std::vector<std::uint32_t> sort_by(const std::vector<std::uint32_t>& set_of, std::size_t sets,
                                   std::vector<std::uint32_t>& order) {
  std::vector<std::uint32_t> begin(sets + 1, 0);
  for (const std::uint32_t s : set_of) ++begin[s + 1];
  for (std::size_t s = 0; s < sets; ++s) begin[s + 1] += begin[s];
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  order.resize(set_of.size());
  for (std::uint32_t i = 0; i < set_of.size(); ++i) order[next[set_of[i]]++] = i;
  return begin;
}

}  // namespace

void RigidMotion::prepare(const LinearSystem& system) {
  // One set more than there are unknowns: what is joined to it is held.
  const auto held = static_cast<std::uint32_t>(system.unknowns());
  Sets sets(system.unknowns() + 1);
  const auto name = [held](std::uint32_t u) { return u == LinearSystem::pinned ? held : u; };
  for (const LinearSystem::Block& block : system.blocks()) {
    const auto of = system.members(block);
    for (const std::uint32_t u : of) sets.join(name(of[0]), name(u));
  }
  std::vector<std::uint32_t> set_of(system.unknowns()), block_set;
  for (std::uint32_t u = 0; u < held; ++u) set_of[u] = sets.find(u);
  const std::uint32_t held_set = sets.find(held);
  for (const LinearSystem::Block& block : system.blocks())
    block_set.push_back(sets.find(name(system.members(block)[0])));
  const auto begin = sort_by(set_of, system.unknowns() + 1, unknowns_);
  const auto block_begin = sort_by(block_set, system.unknowns() + 1, blocks_);
  pieces_.clear();
  for (std::uint32_t s = 0; s < held; ++s)
    if (s != held_set && begin[s] < begin[s + 1])
      pieces_.push_back({begin[s], begin[s + 1], block_begin[s], block_begin[s + 1]});
}

// Whether the gradients of each row sum up to nothing; `turns` stays true while their torques do as well.
bool RigidMotion::is_invariant(const LinearSystem& system, const LinearSystem::Block& block,
                               std::uint32_t first, const ParticleView& particles, bool& turns) {
  const auto of = system.members(block);
  for (int r = 0; r < block.rows; ++r) {
    Vec3d force{}, torque{};
    double force_scale = 0, torque_scale = 0;
    for (std::size_t k = 0; k < block.arity; ++k) {
      const Vec3d g(system.gradient_of(block, r)[k]);
      const Vec3d x(particles.difference(system.particle_of[of[k]], first));
      force += g;
      torque += cross(x, g);
      force_scale += length(g);
      torque_scale += length(x) * length(g);
    }
    if (length(force) > negligible * force_scale) return false;
    if (length(torque) > negligible * torque_scale) turns = false;
  }
  return true;
}

void RigidMotion::remove(LinearSystem& system, const ParticleView& particles) {
  for (const Piece& piece : pieces_) remove(piece, system, particles);
}

void RigidMotion::remove(const Piece& piece, LinearSystem& system, const ParticleView& particles) const {
  const std::uint32_t first = system.particle_of[unknowns_[piece.begin]];
  bool turns = true;
  for (std::uint32_t i = piece.block_begin; i < piece.block_end; ++i)
    if (!is_invariant(system, system.blocks()[blocks_[i]], first, particles, turns)) return;
  double mass = 0;
  Vec3d centre{}, momentum{};
  for (std::uint32_t i = piece.begin; i < piece.end; ++i) {
    const std::uint32_t u = unknowns_[i];
    mass += system.mass[u];
    centre += Vec3d(particles.difference(system.particle_of[u], first)) * system.mass[u];
    momentum += system.dx[u] * system.mass[u];
  }
  centre = centre / mass;
  const Vec3d drift = momentum / mass;
  Mat3d inertia;
  Vec3d spin{};
  for (std::uint32_t i = piece.begin; i < piece.end; ++i) {
    const std::uint32_t u = unknowns_[i];
    const Vec3d x = Vec3d(particles.difference(system.particle_of[u], first)) - centre;
    spin += cross(x, system.dx[u] - drift) * system.mass[u];
    inertia = inertia + (Mat3d::identity() * length_squared(x) - outer(x, x)) * system.mass[u];
  }
  // A straight piece has no inertia about itself, and no spin there either.
  const double size = trace(inertia);
  const Vec3d turn =
      turns && size > 0 ? inverse(inertia + Mat3d::identity() * (1e-12 * size)) * spin : Vec3d{};
  for (std::uint32_t i = piece.begin; i < piece.end; ++i) {
    const std::uint32_t u = unknowns_[i];
    const Vec3d x = Vec3d(particles.difference(system.particle_of[u], first)) - centre;
    system.dx[u] -= drift + cross(turn, x);
  }
}

}  // namespace souple
