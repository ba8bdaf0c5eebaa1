#include "souple/multilevel/stiff_bending.h"

#include "souple/geometry/adjacency.h"
#include "souple/math/sentinels.h"
#include "souple/solver/facets.h"

#include <algorithm>
#include <cmath>

#include <Eigen/SparseCholesky>

namespace souple {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// Pieces are solved here if the mean of h^2 sum_k w_k K_k^2 is more than this times the compliance. One sweep then no
/// longer reaches the stiffness (SetProjector::find_shared).
constexpr double bending_limit = 1.8;
/// Pieces of more unknowns are swept only, unless they are far softer so. The factors of 2,500 unknowns cost as much as
/// two substeps of such a cloth, those of 10,000 as much as four.
constexpr double usual_unknowns = 3000, max_unknowns = 12000;
/// Pieces per thread, at least.
constexpr std::size_t hinge_grain = 1;

struct Vec3dPadded {
  double x = 0, y = 0, z = 0, padding = 0;
};

}  // namespace

/// A bending constraint; particles and K of a rope's have a fourth entry without effect.
struct StiffBending::Bending {
  std::array<std::uint32_t, 4> particle{};
  std::array<std::uint32_t, 4> unknown{};  ///< no_index: fixed
  std::array<float, 4> K{};
  float alpha = 0;       ///< 0: not solved here
  double stiffness = 0;  ///< h^2 / alpha [kg m^2]

  /// sum_k w_k K_k^2 / alpha [1/s^2]
  float softness(std::span<const float> inverse_masses) const {
    float sum = 0;
    for (std::size_t k = 0; k < 4; ++k) sum += inverse_masses[particle[k]] * K[k] * K[k];
    return alpha > 0 ? sum / alpha : 0;
  }
};

struct StiffBending::Piece {
  std::vector<Bending> bendings;
  std::vector<std::uint32_t> particle;  ///< per unknown, in the order of the factors
  std::vector<double> mass;             ///< per unknown [kg]
  // L D L^T: the entries of L below the diagonal, by columns.
  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> row;
  std::vector<double> entry, inverse_diagonal;
  std::vector<Vec3dPadded> step, moved;  ///< work space, per unknown

  bool factorize(std::span<const float> inverse_masses, double softness);
  void solve(const ParticleView& particles, bool first_iteration);

 private:
  void number_unknowns(std::span<const float> inverse_masses);
  Matrix assemble() const;
  void permute(const Eigen::VectorXi& new_position);
  void add_force(const Bending& bending, const ParticleView& particles);
  void apply_inverse();
};

void StiffBending::Piece::number_unknowns(std::span<const float> inverse_masses) {
  for (const Bending& bending : bendings)
    for (std::size_t k = 0; k < 4; ++k)
      if (inverse_masses[bending.particle[k]] > 0) particle.push_back(bending.particle[k]);
  std::sort(particle.begin(), particle.end());
  particle.erase(std::unique(particle.begin(), particle.end()), particle.end());
  for (const std::uint32_t i : particle) mass.push_back(1 / static_cast<double>(inverse_masses[i]));
  for (Bending& bending : bendings)
    for (std::size_t k = 0; k < 4; ++k) {
      const auto at = std::lower_bound(particle.begin(), particle.end(), bending.particle[k]);
      const bool found = at != particle.end() && *at == bending.particle[k];
      bending.unknown[k] = found ? static_cast<std::uint32_t>(at - particle.begin()) : no_index;
    }
}

Matrix StiffBending::Piece::assemble() const {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](std::uint32_t i, std::uint32_t j, double value) {
    if (i != no_index && j != no_index && i >= j)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
  };
  for (std::uint32_t i = 0; i < particle.size(); ++i) add(i, i, mass[i]);
  for (const Bending& bending : bendings)
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t l = 0; l < 4; ++l)
        add(bending.unknown[k], bending.unknown[l],
            bending.stiffness * static_cast<double>(bending.K[k]) * static_cast<double>(bending.K[l]));
  Matrix matrix(static_cast<Eigen::Index>(particle.size()), static_cast<Eigen::Index>(particle.size()));
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// Numbers the unknowns as the factors do.
void StiffBending::Piece::permute(const Eigen::VectorXi& new_position) {
  std::vector<std::uint32_t> new_particle(particle.size());
  std::vector<double> new_mass(particle.size());
  const auto position = [&](std::uint32_t i) {
    return static_cast<std::uint32_t>(new_position[static_cast<Eigen::Index>(i)]);
  };
  for (std::uint32_t i = 0; i < particle.size(); ++i)
    new_particle[position(i)] = particle[i], new_mass[position(i)] = mass[i];
  particle = std::move(new_particle), mass = std::move(new_mass);
  for (Bending& bending : bendings)
    for (std::uint32_t& i : bending.unknown)
      if (i != no_index) i = position(i);
}

// False if the piece is too large. `softness`: mean of h^2 sum_k w_k K_k^2 / alpha.
bool StiffBending::Piece::factorize(std::span<const float> inverse_masses, double softness) {
  number_unknowns(inverse_masses);
  const auto unknowns = static_cast<double>(particle.size());
  if (unknowns == 0 ||
      unknowns > std::min(max_unknowns, usual_unknowns * std::sqrt(softness / bending_limit)))
    return false;
  const Matrix matrix = assemble();
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower> factors;
  factors.analyzePattern(matrix);
  factors.factorize(matrix);
  if (factors.info() != Eigen::Success) return false;
  const Matrix L = factors.matrixL();
  const Eigen::VectorXd D = factors.vectorD();
  permute(factors.permutationP().indices());
  begin.push_back(0);
  for (Eigen::Index column = 0; column < L.outerSize(); ++column) {
    for (Matrix::InnerIterator i(L, column); i; ++i)
      if (i.row() > column) row.push_back(static_cast<std::uint32_t>(i.row())), entry.push_back(i.value());
    begin.push_back(row.size());
    inverse_diagonal.push_back(1 / D[column]);
  }
  step.resize(particle.size()), moved.resize(particle.size());
  return true;
}

// Adds -h^2 K^T K x / alpha.
void StiffBending::Piece::add_force(const Bending& bending, const ParticleView& particles) {
  const auto& p = bending.particle;
  Vec3f v{};
  for (std::size_t k = 1; k < 4; ++k) v += particles.difference(p[k], p[0]) * bending.K[k];
  for (std::size_t k = 0; k < 4; ++k) {
    if (bending.unknown[k] == no_index) continue;
    Vec3dPadded& f = step[bending.unknown[k]];
    const double factor = bending.stiffness * static_cast<double>(bending.K[k]);
    f.x -= factor * static_cast<double>(v.x);
    f.y -= factor * static_cast<double>(v.y);
    f.z -= factor * static_cast<double>(v.z);
  }
}

// Forces become steps.
void StiffBending::Piece::apply_inverse() {
  for (std::size_t j = 0; j < step.size(); ++j) {
    const Vec3dPadded s = step[j];
    for (std::size_t k = begin[j]; k < begin[j + 1]; ++k) {
      Vec3dPadded& t = step[row[k]];
      t.x -= entry[k] * s.x, t.y -= entry[k] * s.y, t.z -= entry[k] * s.z;
    }
  }
  for (std::size_t j = step.size(); j-- > 0;) {
    Vec3dPadded s = step[j];
    s.x *= inverse_diagonal[j], s.y *= inverse_diagonal[j], s.z *= inverse_diagonal[j];
    for (std::size_t k = begin[j]; k < begin[j + 1]; ++k) {
      const Vec3dPadded& t = step[row[k]];
      s.x -= entry[k] * t.x, s.y -= entry[k] * t.y, s.z -= entry[k] * t.z;
    }
    step[j] = s;
  }
}

void StiffBending::Piece::solve(const ParticleView& particles, bool first_iteration) {
  if (particles.inverse_mass(particle[0]) == 0) return;  // the object is asleep
  if (first_iteration) std::fill(moved.begin(), moved.end(), Vec3dPadded{});
  for (std::size_t i = 0; i < step.size(); ++i)
    step[i] = {-mass[i] * moved[i].x, -mass[i] * moved[i].y, -mass[i] * moved[i].z};
  for (const Bending& bending : bendings) add_force(bending, particles);
  apply_inverse();
  for (std::size_t i = 0; i < step.size(); ++i) {
    if (particles.inverse_mass(particle[i]) == 0) continue;  // pinned during the step
    moved[i].x += step[i].x, moved[i].y += step[i].y, moved[i].z += step[i].z;
    particles.correct(particle[i], {static_cast<float>(step[i].x), static_cast<float>(step[i].y),
                                    static_cast<float>(step[i].z)});
  }
}

StiffBending::StiffBending() = default;
StiffBending::~StiffBending() = default;

namespace {

template <class Function>
void for_each_bending(Projector& projector, const Function& function) {
  const StructureFacet& set = *projector.facets().bendings;
  for (std::size_t i = 0; i < projector.size(); ++i) {
    const StructureFacet::Bending bending = set.bending(i);
    function(StiffBending::Bending{
        .particle = bending.particle, .unknown = {}, .K = bending.K, .alpha = bending.compliance});
  }
}

}  // namespace

void StiffBending::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  std::vector<std::pair<Projector*, std::uint64_t>> revisions;
  for (Projector* projector : projectors)
    if (const StructureFacet* const set = projector->facets().bendings)
      revisions.emplace_back(projector, set->revision());
  bool changed = revisions != revisions_ || inverse_masses_.size() != particles.position.size();
  for (std::size_t i = 0; i < inverse_masses_.size() && !changed; ++i)
    changed = inverse_masses_[i] != particles.inverse_mass(i);
  if (changed) {
    revisions_ = std::move(revisions);
    inverse_masses_.clear();
    for (std::size_t i = 0; i < particles.position.size(); ++i)
      inverse_masses_.push_back(particles.inverse_mass(i));
    softest_ = 0;
    for (const auto& [projector, revision] : revisions_)
      for_each_bending(*projector, [&](const Bending& bending) {
        softest_ = std::fmax(softest_, bending.softness(inverse_masses_));
      });
    pieces_.clear(), solved_.clear();
    built_for_ = 0;
  }
}

void StiffBending::leave_out(LeftOut& left_out) const {
  for (std::size_t k = 0; k < solved_.size(); ++k)
    left_out.add(*revisions_[k].first, solved_[k], revisions_[k].first->size());
}

void StiffBending::build(float h) {
  built_for_ = h;
  pieces_.clear(), solved_.clear();
  if (static_cast<double>(softest_ * h * h) > bending_limit) {
    std::vector<std::vector<Bending>> sets;
    std::vector<Tet> elements;
    for (const auto& [projector, revision] : revisions_) {
      sets.emplace_back();
      for_each_bending(*projector, [&](const Bending& bending) {
        sets.back().push_back(bending);
        elements.push_back(bending.particle);
      });
    }
    const Components components = connected_components(elements, inverse_masses_.size());
    std::vector<std::unique_ptr<Piece>> pieces = stiff_pieces(sets, components, h);
    for (const std::vector<Bending>& set : sets) {
      solved_.emplace_back();
      for (std::uint32_t i = 0; i < set.size(); ++i)
        if (pieces[components.of_vertex[set[i].particle[0]]] && set[i].alpha > 0) solved_.back().push_back(i);
    }
    for (std::unique_ptr<Piece>& piece : pieces)
      if (piece) pieces_.push_back(std::move(piece));
  }
}

// Per component of the bending constraints: its piece, if it is stiff.
std::vector<std::unique_ptr<StiffBending::Piece>> StiffBending::stiff_pieces(
    std::span<const std::vector<Bending>> sets, const Components& components, float h) const {
  std::vector<double> sum(components.count), count(components.count);
  const auto component = [&](const Bending& bending) { return components.of_vertex[bending.particle[0]]; };
  for (const std::vector<Bending>& set : sets)
    for (const Bending& bending : set)
      sum[component(bending)] += static_cast<double>(bending.softness(inverse_masses_)),
          ++count[component(bending)];
  const double h2 = static_cast<double>(h) * static_cast<double>(h);
  const auto mean = [&](std::uint32_t c) { return h2 * sum[c] / std::max(count[c], 1.0); };
  std::vector<std::unique_ptr<Piece>> pieces(components.count);
  for (const std::vector<Bending>& set : sets)
    for (Bending bending : set) {
      const std::uint32_t c = component(bending);
      if (!(mean(c) > bending_limit) || !(bending.alpha > 0)) continue;
      bending.stiffness = h2 / static_cast<double>(bending.alpha);
      if (!pieces[c]) pieces[c] = std::make_unique<Piece>();
      pieces[c]->bendings.push_back(bending);
    }
  for (std::uint32_t c = 0; c < components.count; ++c)
    if (pieces[c] && !pieces[c]->factorize(inverse_masses_, mean(c))) pieces[c].reset();
  return pieces;
}

bool StiffBending::begin_substep(const Substep& substep) {
  if (substep.h == built_for_ || revisions_.empty()) return false;
  build(substep.h);
  return true;
}

void StiffBending::solve(const ParticleView& particles, int iteration, Threads& threads) {
  threads.each(pieces_.size(), hinge_grain,
               [&](std::size_t i) { pieces_[i]->solve(particles, iteration == 0); });
}

}  // namespace souple
