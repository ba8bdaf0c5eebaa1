#include "souple/multilevel/tet_levels.h"

#include "souple/math/disjoint_sets.h"
#include "souple/math/polar_decomposition.h"
#include "souple/math/sentinels.h"
#include "souple/multilevel/weighted_sums.h"
#include "souple/simd/instruction_set.h"
#include "souple/solver/coloring.h"
#include "souple/solver/kernels/cells.h"
#include "souple/solver/kernels/find_kernels.h"
#include "souple/solver/solver.h"
#include "souple/solver/sweep_regions.h"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

constexpr std::size_t corners = kernels::cell_nodes;
/// Cells per color are a multiple of this.
constexpr std::size_t lanes = kernels::cell_block;
/// A level costs about as much as two sweeps, so bodies that need fewer have none. Small bodies are swept: their
/// lattices would have too few cells to bend.
constexpr float fewest_sweeps = 3;
constexpr std::size_t smallest_body = 1000;
/// Sweeps act on a smooth stress as springs of compliance alpha~/omega + b D. Here b is 1/omega - 1/2, times 1.3
/// because gradients turn while they are projected (measured: hanging and bent bars of 1e6 and 1e7 Pa).
constexpr float sweep_share = 1.9f;
/// K is this much stiffer than the tets of the rest shape, for what the lattice does not resolve.
constexpr float margin = 1.1f;
/// Springs that hold the lattice at pinned particles, relative to the stiffness of their tets: |a - b|^2 <= 2 |a|^2 +
/// 2 |b|^2 of a particle and its neighbor.
constexpr float pin_margin = 2;
/// Conjugate gradients end when the residual is this much smaller, or after this many iterations. With 0.01 a bar of
/// 1e6 Pa bends 6 % too little.
constexpr float tolerance = 3e-3f;
constexpr int max_iterations = 60;
/// Longest move of a node in a substep, in cells.
constexpr float max_move = 0.25f;
constexpr std::size_t tet_grain = 256;

using detail::FourFloats;
using detail::load;
using detail::store;

/// sum of a . b times `by`, in a fixed order.
float product(std::span<const Vec4f> a, std::span<const Vec4f> b) {
  FourFloats partial[4]{};
  for (std::size_t j = 0; j < a.size(); ++j) partial[j % 4] += load(a[j]) * load(b[j]);
  const FourFloats sum = (partial[0] + partial[2]) + (partial[1] + partial[3]);
  return (sum[0] + sum[1]) + sum[2];
}
float product(std::span<const Vec4f> a, std::span<const float> by) {
  FourFloats partial[4]{};
  for (std::size_t j = 0; j < by.size(); ++j) partial[j % 4] += load(a[j]) * load(a[j]) * by[j];
  const FourFloats sum = (partial[0] + partial[2]) + (partial[1] + partial[3]);
  return (sum[0] + sum[1]) + sum[2];
}

// The scalar version of the packed kernel (compile_cells.h).
void apply_cells(const kernels::CellArrays& cells, const float* x, float* y, std::size_t begin,
                 std::size_t end) {
  for (std::size_t c = begin; c < end; ++c) {
    Vec3f v[corners];
    for (std::size_t a = 0; a < corners; ++a) {
      const float* const at = x + cells.node[a][c];
      v[a] = {at[0], at[1], at[2]};
    }
    Mat3f R;
    for (std::size_t k = 0; k < 9; ++k)
      R.column[k / 3][static_cast<int>(k % 3)] = cells.rotation[kernels::cell_entry(c, 9, k)];
    const auto stiffness = [c, &cells](int k) {
      return cells.stiffness[kernels::cell_entry(c, kernels::cell_stiffnesses, static_cast<std::size_t>(k))];
    };
    kernels::multiply_cell(R, stiffness, v);
    for (std::size_t a = 0; a < corners; ++a)
      for (int axis = 0; axis < 3; ++axis)
        y[cells.node[a][c] + static_cast<std::uint32_t>(axis)] += v[a][axis] * cells.scale[c];
  }
}

const kernels::CellKernels& cell_kernels() {
  static constexpr kernels::CellKernels scalar{apply_cells};
  const kernels::CellKernels* packed = find_cell_kernels(instruction_set());
  return packed ? *packed : scalar;
}

/// The rotation nearest to F. Near one, by Newton's iteration R <- (R + R^-T) / 2, which converges quadratically
/// (Higham 1986); elsewhere by singular values.
Mat3f rotation_of(const Mat3f& F) {
  Mat3f R = F;
  for (int i = 0; i < 8; ++i) {
    const Mat3f cof = cofactor(R);
    const float J = dot(R.column[0], cof.column[0]);
    if (!(J > 0.1f) || !(J < 10)) break;
    const Mat3f next = (R + cof * (1 / J)) * 0.5f;
    const float change = frobenius_squared(next - R);
    R = next;
    if (change < 1e-8f) return R;
  }
  return nearest_rotation(F);
}

/// Upper limit of the stiffness of a neo-Hookean material of deformation gradient F, relative to that at rest, in any
/// direction. Its volume term has the second derivative (lambda + mu) (cof F) (cof F)^T + (lambda + mu) (J - 1) d cof
/// F/dF.
float stiffening(const Mat3f& F) {
  const Mat3f cof = cofactor(F);
  const float J = dot(F.column[0], cof.column[0]);
  return max(1.0f, max(frobenius_squared(cof) - 2, J * std::sqrt(frobenius_squared(F) / 3)));
}

}  // namespace

void TetLevels::prepare(SetProjector<NeoHookean>* tets, const ParticleView& particles) {
  const std::uint64_t revision = tets ? tets->revision() : 0;
  if (tets != tets_ || revision != revision_) {
    tets_ = tets, revision_ = revision;
    bodies_.clear();
    if (tets) find_bodies(particles);
  }
  if (!bodies_.empty()) find_softness(particles);
  for (Body& body : bodies_) set_masses(body, particles);
  chosen_for_ = {};
  any_ = false;
  if (tets) tets->clear_levels();
}

void TetLevels::find_bodies(const ParticleView& particles) {
  const auto& set = std::as_const(*tets_).set();
  DisjointSets connected(particles.position.size());
  for (std::size_t t = 0; t < set.size(); ++t)
    for (const std::uint32_t i : set.indices(t)) connected.join(set.indices(t)[0], i);
  std::vector<std::uint32_t> number(particles.position.size(), no_index);
  std::vector<std::vector<std::uint32_t>> tets;
  body_of_.resize(set.size());
  for (std::uint32_t t = 0; t < set.size(); ++t) {
    std::uint32_t& body = number[connected.root(set.indices(t)[0])];
    if (body == no_index) body = static_cast<std::uint32_t>(tets.size()), tets.emplace_back();
    body_of_[t] = body;
    tets[body].push_back(t);
  }
  std::vector<std::uint32_t> size(tets.size());
  for (std::uint32_t i = 0; i < number.size(); ++i)
    if (const std::uint32_t body = number[connected.root(i)]; body != no_index) ++size[body];
  bodies_.resize(tets.size());
  find_softness(particles);
  for (std::size_t b = 0; b < tets.size(); ++b) {
    Body& body = bodies_[b];
    constexpr float longest_substep = 1 / 60.0f;
    if (size[b] < smallest_body ||
        SetProjector<NeoHookean>::sweeps_for(body.softness, longest_substep) < fewest_sweeps)
      continue;
    body.lattice = build_tet_lattice(set, tets[b]);
    arrange(body);
  }
  in_level_.assign(set.size(), 0);
  force_.assign(particles.position.size(), {});
  collider_moved_.assign(particles.position.size(), {}), others_moved_ = collider_moved_;
}

void TetLevels::find_softness(const ParticleView& particles) {
  const auto& set = std::as_const(*tets_).set();
  std::vector<double> sum(bodies_.size());
  std::vector<std::size_t> count(bodies_.size());
  for (std::size_t t = 0; t < set.size(); ++t) {
    float w[4];
    for (std::size_t k = 0; k < 4; ++k) w[k] = particles.inverse_mass(set.indices(t)[k]);
    sum[body_of_[t]] += static_cast<double>(NeoHookean::softness(set.params(t), set.compliance(t), w));
    ++count[body_of_[t]];
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    bodies_[b].softness = static_cast<float>(sum[b] / static_cast<double>(count[b]));
}

// Sorts the cells by color and lists the particles of each node.
void TetLevels::arrange(Body& body) {
  const TetLattice& lattice = body.lattice;
  std::vector<std::uint32_t> ends;
  for (const TetLattice::Cell& cell : lattice.cells)
    ends.insert(ends.end(), cell.node.begin(), cell.node.end());
  const Coloring colors = color_constraints(ends, corners, lattice.node_count);
  body.color_begin = {0};
  for (std::size_t c = 0; c + 1 < colors.color_begin.size(); ++c) {
    for (std::size_t k = colors.color_begin[c]; k < colors.color_begin[c + 1]; ++k)
      body.cell.push_back(colors.order[k]);
    while (body.cell.size() % lanes != 0) body.cell.push_back(no_index);
    body.color_begin.push_back(static_cast<std::uint32_t>(body.cell.size()));
  }
  const std::size_t slots = body.cell.size();
  body.stiffness.assign(kernels::cell_stiffnesses * slots, 0);
  body.rotation.assign(9 * slots, 0);
  body.scale.assign(slots, 0);
  for (std::size_t a = 0; a < corners; ++a)
    for (const std::uint32_t cell : body.cell)
      body.node[a].push_back(4 * (cell == no_index ? static_cast<std::uint32_t>(lattice.node_count)
                                                   : lattice.cells[cell].node[a]));
  for (std::size_t s = 0; s < slots; ++s)
    for (std::size_t k = 0; body.cell[s] != no_index && k < kernels::cell_stiffnesses; ++k)
      body.stiffness[kernels::cell_entry(s, kernels::cell_stiffnesses, k)] =
          lattice.cell_stiffness[body.cell[s]][k];
  body.child_begin.assign(lattice.node_count + 1, 0);
  for (std::size_t i = 0; i < lattice.parent.size(); ++i)
    for (std::size_t c = 0; c < corners; ++c)
      if (lattice.weight[i][c] > 0) ++body.child_begin[lattice.parent[i][c] + 1];
  for (std::size_t j = 0; j < lattice.node_count; ++j) body.child_begin[j + 1] += body.child_begin[j];
  body.child.resize(body.child_begin.back()), body.child_weight.resize(body.child.size());
  std::vector<std::uint32_t> next(body.child_begin.begin(), body.child_begin.end() - 1);
  for (std::uint32_t i = 0; i < lattice.parent.size(); ++i)
    for (std::size_t c = 0; c < corners; ++c) {
      if (!(lattice.weight[i][c] > 0)) continue;
      const std::uint32_t at = next[lattice.parent[i][c]]++;
      body.child[at] = i, body.child_weight[at] = lattice.weight[i][c];
    }
  body.mass.resize(lattice.node_count), body.held_stiffness = body.inverse = body.mass;
  body.x.resize(lattice.node_count + 1), body.r = body.p = body.Ap = body.x;
  body.pinned.reserve(lattice.particle.size()), body.held.reserve(lattice.particle.size());
}

void TetLevels::set_masses(Body& body, const ParticleView& particles) const {
  const TetLattice& lattice = body.lattice;
  std::fill(body.mass.begin(), body.mass.end(), 0.0f);
  body.pinned.clear();
  for (std::uint32_t i = 0; i < lattice.particle.size(); ++i) {
    const float w = particles.inverse_mass(lattice.particle[i]);
    if (!(w > 0)) body.pinned.push_back(i);
    for (std::size_t c = 0; w > 0 && c < corners; ++c)
      body.mass[lattice.parent[i][c]] += lattice.weight[i][c] / w;
  }
}

void TetLevels::choose(const Substep& substep) {
  const std::pair<float, int> key{substep.h, substep.mode == Mode::small_steps ? substep.iterations : 0};
  if (!tets_ || key == chosen_for_) return;
  chosen_for_ = key;
  any_ = false;
  for (Body& body : bodies_) {
    const float needed = SetProjector<NeoHookean>::sweeps_for(body.softness, substep.h);
    body.wanted = body.active = key.second == 1 && needed >= fewest_sweeps && !body.lattice.cells.empty();
    any_ = any_ || body.wanted;
  }
  if (any_) {
    mark();
  } else {
    tets_->clear_levels();
  }
}

// Tells the tets which of them have a level.
void TetLevels::mark() {
  for (std::size_t t = 0; t < in_level_.size(); ++t) in_level_[t] = bodies_[body_of_[t]].active ? 1 : 0;
  tets_->set_levels(in_level_);
}

void TetLevels::correct(std::span<Projector* const> projectors, const ParticleView& particles,
                        const Substep& substep, Threads& threads) {
  if (!any_) return;
  meet_contacts(projectors, particles, substep, threads);
  find_forces(particles, substep, threads);
  const float h2 = substep.h * substep.h;
  for (Body& body : bodies_) {
    if (!body.active) continue;
    find_held(body);
    measure_cells(body, particles, h2, threads);
    restrict_forces(body, force_, threads);
    solve(body, h2, threads);
    limit_moves(body);
    prolong(body, particles, threads);
  }
}

// Other regions' contacts are left alone.
void TetLevels::choose_wanted(std::span<Projector* const> projectors, const ParticleView& particles,
                              const Substep& substep) const {
  if (substep.regions == nullptr) return;
  substep.regions->choose_none(projectors, particles);
  for (const Body& body : bodies_)
    if (body.wanted) substep.regions->choose(body.lattice.particle.front());
}

void TetLevels::sweep_wanted(Projector& contacts, const ParticleView& particles, const Substep& substep,
                             Threads& threads) {
  Substep before = substep;
  ++before.sweep;  // the first one of the rounds takes the other order
  if (substep.regions == nullptr) return sweep(contacts, particles, before, threads);
  substep.regions->list_chosen(contacts, particles, runs_);
  sweep(contacts, runs_, particles, before, threads);
}

// Contacts come first as well as last, so that it is known what touches what.
void TetLevels::meet_contacts(std::span<Projector* const> projectors, const ParticleView& particles,
                              const Substep& substep, Threads& threads) {
  const auto for_each_particle = [&](const auto& f) {
    for (const Body& body : bodies_) {
      if (!body.wanted) continue;
      for (const std::uint32_t i : body.lattice.particle) f(i);
    }
  };
  const auto meet = [&](bool colliders, std::vector<Vec3f>& moved) {
    for_each_particle([&](std::uint32_t i) { moved[i] = {}; });
    const auto concerned = [&](Projector* p) {
      const ContactFacet* const contact = p->facets().contact;
      return contact != nullptr && p->size() > 0 && contact->is_collider_contact() == colliders;
    };
    if (std::none_of(projectors.begin(), projectors.end(), concerned)) return;
    for_each_particle([&](std::uint32_t i) { moved[i] -= particles.moved(i); });
    for (Projector* projector : projectors)
      if (concerned(projector)) sweep_wanted(*projector, particles, substep, threads);
    for_each_particle([&](std::uint32_t i) { moved[i] += particles.moved(i); });
  };
  choose_wanted(projectors, particles, substep);
  meet(false, others_moved_);
  meet(true, collider_moved_);
  bool changed = false;
  for (Body& body : bodies_) {
    const bool active =
        body.wanted && std::none_of(body.lattice.particle.begin(), body.lattice.particle.end(),
                                    [&](std::uint32_t i) { return others_moved_[i] != Vec3f{}; });
    changed = changed || active != body.active;
    body.active = active;
  }
  if (changed) mark();
}

// Springs hold pinned particles, and those that elastic forces press against a contact, f . n < 0. Otherwise the
// lattice would move the body through the contact and the contact would push back its outermost layer alone.
void TetLevels::find_held(Body& body) const {
  const TetLattice& lattice = body.lattice;
  body.held.assign(body.pinned.begin(), body.pinned.end());
  for (std::uint32_t i = 0; i < lattice.particle.size(); ++i) {
    const std::uint32_t particle = lattice.particle[i];
    if (dot(collider_moved_[particle], force_[particle].xyz()) < 0) body.held.push_back(i);
  }
  std::fill(body.held_stiffness.begin(), body.held_stiffness.end(), 0.0f);
  for (const std::uint32_t i : body.held)
    for (std::size_t c = 0; c < corners; ++c)
      body.held_stiffness[lattice.parent[i][c]] += lattice.weight[i][c] * pin_margin * lattice.stiffness[i];
}

void TetLevels::find_sweeps(const Substep& substep) {
  for (Body& body : bodies_) {
    if (!body.active) continue;
    if (substep.regions == nullptr) {
      body.sweeps = tets_->sweeps_needed(substep);
    } else {
      substep.regions->list_particles(body.lattice.particle.front(), ranges_);
      body.sweeps = tets_->sweeps_needed(substep, ranges_);
    }
  }
}

// Forces of the active bodies with so many sweeps.
void TetLevels::add_forces(int sweeps, const ParticleView& particles, const Substep& substep,
                           Threads& threads) {
  ranges_.clear(), tet_ranges_.clear();
  for (const Body& body : bodies_)
    if (body.active && body.sweeps == sweeps)
      ranges_.push_back({body.lattice.particle.front(), body.lattice.particle.back() + std::size_t{1}});
  std::sort(ranges_.begin(), ranges_.end(),
            [](const IndexRange& a, const IndexRange& b) { return a.begin < b.begin; });
  std::size_t count = 0;
  for (const IndexRange& range : ranges_)
    if (count > 0 && range.begin < ranges_[count - 1].end)
      ranges_[count - 1].end = std::max(ranges_[count - 1].end, range.end);
    else
      ranges_[count++] = range;
  ranges_.resize(count);
  tets_->append_constraints_of(ranges_, tet_ranges_);
  const float share = sweep_share / static_cast<float>(sweeps);
  const std::size_t least = tets_->facets().grain;
  std::size_t first = 0;
  int color = 0;
  for (const IndexRange& range : tet_ranges_) {
    for (; range.begin >= first + tets_->color_size(color); ++color) first += tets_->color_size(color);
    threads.for_each(range.end - range.begin, least, [&](std::size_t begin, std::size_t end) {
      tets_->add_forces(color, range.begin - first + begin, range.begin - first + end, particles, substep,
                        share);
    });
  }
}

void TetLevels::find_forces(const ParticleView& particles, const Substep& substep, Threads& threads) {
  find_sweeps(substep);
  int most = 0;
  for (const Body& body : bodies_) {
    if (!body.active) continue;
    most = std::max(most, body.sweeps);
    for (const std::uint32_t i : body.lattice.particle) force_[i] = {};
  }
  ParticleView view = particles;
  view.corrected = force_;
  for (int sweeps = 1; sweeps <= most; ++sweeps)
    if (std::any_of(bodies_.begin(), bodies_.end(),
                    [&](const Body& body) { return body.active && body.sweeps == sweeps; }))
      add_forces(sweeps, view, substep, threads);
  for (const Body& body : bodies_) {
    if (!body.active) continue;
    for (const std::uint32_t k : body.pinned) force_[body.lattice.particle[k]] = {};
  }
}

void TetLevels::measure_cells(Body& body, const ParticleView& particles, float h2, Threads& threads) {
  const TetLattice& lattice = body.lattice;
  const std::size_t slots = body.cell.size();
  threads.each(slots, tet_grain / 8, [&](std::size_t s) {
    if (body.cell[s] == no_index) return;
    const TetLattice::Cell& cell = lattice.cells[body.cell[s]];
    const std::uint32_t first = lattice.particle[lattice.sample[cell.sample_begin]];
    Mat3f F{};
    for (std::uint32_t k = cell.sample_begin; k < cell.sample_end; ++k)
      F = F + outer(particles.difference(lattice.particle[lattice.sample[k]], first), lattice.gradient[k]);
    const Mat3f R = rotation_of(F);
    for (std::size_t k = 0; k < 9; ++k)
      body.rotation[kernels::cell_entry(s, 9, k)] = R.column[k / 3][static_cast<int>(k % 3)];
    body.scale[s] = h2 * margin * stiffening(F);
  });
}

// r = P^T f.
void TetLevels::restrict_forces(Body& body, std::span<const Vec4f> force, Threads& threads) {
  threads.each(body.mass.size(), tet_grain / 4, [&](std::size_t j) {
    FourFloats sum{};
    for (std::uint32_t k = body.child_begin[j]; k < body.child_begin[j + 1]; ++k)
      sum += load(force[body.lattice.particle[body.child[k]]]) * body.child_weight[k];
    store(body.r[j], sum);
  });
}

// Ap = (M + h^2 K) p.
void TetLevels::apply(Body& body, float h2, Threads& threads) {
  for (std::size_t j = 0; j < body.mass.size(); ++j) store(body.Ap[j], load(body.p[j]) * body.mass[j]);
  kernels::CellArrays cells;
  for (std::size_t a = 0; a < corners; ++a) cells.node[a] = body.node[a].data();
  cells.stiffness = body.stiffness.data(), cells.rotation = body.rotation.data(),
  cells.scale = body.scale.data();
  const kernels::ApplyCells kernel = cell_kernels().apply;
  const float* const p = &body.p.data()->x;
  float* const Ap = &body.Ap.data()->x;
  for (std::size_t c = 0; c + 1 < body.color_begin.size(); ++c) {
    const std::size_t first = body.color_begin[c];
    threads.for_each((body.color_begin[c + 1] - first) / lanes, 2, [&](std::size_t begin, std::size_t end) {
      kernel(cells, p, Ap, first + begin * lanes, first + end * lanes);
    });
  }
  const TetLattice& lattice = body.lattice;
  for (const std::uint32_t i : body.held) {
    FourFloats sum{};
    for (std::size_t c = 0; c < corners; ++c)
      sum += load(body.p[lattice.parent[i][c]]) * lattice.weight[i][c];
    sum *= h2 * pin_margin * lattice.stiffness[i];
    for (std::size_t c = 0; c < corners; ++c) {
      Vec4f& y = body.Ap[lattice.parent[i][c]];
      store(y, load(y) + sum * lattice.weight[i][c]);
    }
  }
}

// Conjugate gradients; x: the solution.
void TetLevels::solve(Body& body, float h2, Threads& threads) {
  const std::size_t n = body.mass.size();
  for (std::size_t j = 0; j < n; ++j) {
    const float m = body.mass[j] + h2 * body.held_stiffness[j];
    body.inverse[j] = m > 0 ? 1 / m : 0;
    body.x[j] = {};
    store(body.p[j], load(body.r[j]) * body.inverse[j]);
  }
  float rz = product(body.r, body.inverse);
  const float enough = tolerance * tolerance * rz;
  for (int i = 0; i < max_iterations && rz > enough; ++i) {
    apply(body, h2, threads);
    const float pAp = product(body.p, body.Ap);
    if (!(pAp > 0)) break;
    const float a = rz / pAp;
    for (std::size_t j = 0; j < n; ++j) {
      store(body.x[j], load(body.x[j]) + load(body.p[j]) * a);
      store(body.r[j], load(body.r[j]) - load(body.Ap[j]) * a);
    }
    const float next = product(body.r, body.inverse), b = next / rz;
    rz = next;
    for (std::size_t j = 0; j < n; ++j)
      store(body.p[j], load(body.r[j]) * body.inverse[j] + load(body.p[j]) * b);
  }
}

// One factor for the whole body limits the longest move, so that momentum is kept.
void TetLevels::limit_moves(Body& body) {
  float farthest = 0;
  for (const Vec4f& x : body.x) farthest = std::fmax(farthest, dot(x.xyz(), x.xyz()));
  const float limit = max_move * body.lattice.cell_size;
  if (farthest <= limit * limit) return;
  const float factor = farthest < 1e30f ? limit / std::sqrt(farthest) : 0;
  for (Vec4f& x : body.x) x.set_xyz(factor > 0 ? x.xyz() * factor : Vec3f{});
}

// x += P dX.
void TetLevels::prolong(const Body& body, const ParticleView& particles, Threads& threads) {
  const TetLattice& lattice = body.lattice;
  threads.each(lattice.particle.size(), tet_grain, [&](std::size_t i) {
    const std::uint32_t particle = lattice.particle[i];
    if (!(particles.inverse_mass(particle) > 0)) return;
    particles.correct(particle, node_move(body, static_cast<std::uint32_t>(i)));
  });
}

Vec3f TetLevels::node_move(const Body& body, std::uint32_t i) {
  FourFloats sum{};
  for (std::size_t c = 0; c < corners; ++c)
    sum += load(body.x[body.lattice.parent[i][c]]) * body.lattice.weight[i][c];
  return {sum[0], sum[1], sum[2]};
}

}  // namespace souple
