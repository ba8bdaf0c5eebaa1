#include "souple/studies/direct.h"

#include "souple/error.h"

#include <algorithm>
#include <string>

#include <Eigen/SparseCholesky>
#include <fmt/core.h>

namespace souple {
namespace {

using Matrix = Eigen::SparseMatrix<double>;  // lower triangle, by columns
constexpr double redundant = 1e-9;           // added to the diagonal of the dual matrix, as a fraction of it
constexpr double max_operations = 5e9;       // multiplications of one factorization: some seconds
constexpr std::size_t max_unknowns = 300000;
// Limit for the dual matrix: every pair of rows that share a particle has an entry.
constexpr std::size_t max_entries = 30000000;

/// An entry of the lower triangle.
struct MatrixEntry {
  std::uint32_t column, row;
  friend bool operator<(const MatrixEntry& a, const MatrixEntry& b) {
    return a.column != b.column ? a.column < b.column : a.row < b.row;
  }
  friend bool operator==(const MatrixEntry& a, const MatrixEntry& b) {
    return a.column == b.column && a.row == b.row;
  }
};

void sort_unique(std::vector<MatrixEntry>& matrix_entries) {
  std::sort(matrix_entries.begin(), matrix_entries.end());
  matrix_entries.erase(std::unique(matrix_entries.begin(), matrix_entries.end()), matrix_entries.end());
}

/// Reports the cost of a factorization before it is computed.
class Factorization : public Eigen::SimplicialLDLT<Matrix, Eigen::Lower> {
 public:
  double operations() const { return this->m_nonZerosPerCol.template cast<double>().squaredNorm(); }
};

[[noreturn]] void refuse(double amount, const char* what, double limit) {
  throw Error(
      fmt::format("the solver direct would need {:.3g} {}, but the limit is {:.3g}: use the solver "
                  "conjugate_gradient or a coarser mesh",
                  amount, what, limit));
}

/// A constraint row that involves an unknown, and its gradient there.
struct Incidence {
  std::uint32_t row, gradient;
};

}  // namespace

struct Direct::Impl {
  bool dual = false;
  Matrix matrix;
  Factorization factorization;
  Eigen::VectorXd rhs, solution;
  // Destination of each added term, in the order in which terms are added. Primal: index of the block in its
  // column of 3 x 3 blocks. Dual: index into the values.
  std::vector<std::uint32_t> slot;
  std::vector<std::vector<Incidence>> incidences;  // dual: per unknown

  void prepare_primal(const LinearSystem& system);
  void prepare_dual(const LinearSystem& system);
  void build_primal_pattern(std::size_t unknowns, const std::vector<MatrixEntry>& blocks);
  void build_dual_pattern(std::size_t rows, const std::vector<MatrixEntry>& matrix_entries);
  void fill_primal(const LinearSystem& system);
  void fill_dual(const LinearSystem& system);
};

Direct::Direct() : impl_(std::make_unique<Impl>()) {}
Direct::~Direct() = default;

namespace {

// Calls f(a, b) for the pairs of free members whose 3 x 3 block is in the lower triangle.
template <class Function>
void for_each_pair(std::span<const std::uint32_t> members, const Function& f) {
  for (std::size_t a = 0; a < members.size(); ++a)
    for (std::size_t b = 0; b < members.size(); ++b)
      if (members[a] != LinearSystem::pinned && members[b] <= members[a]) f(a, b);
}

}  // namespace

void Direct::Impl::build_primal_pattern(std::size_t unknowns, const std::vector<MatrixEntry>& blocks) {
  const auto n = static_cast<Eigen::Index>(3 * unknowns);
  matrix = Matrix(n, n);
  matrix.resizeNonZeros(static_cast<Eigen::Index>(9 * blocks.size() - 3 * unknowns));
  int* starts = matrix.outerIndexPtr();
  int* rows = matrix.innerIndexPtr();
  int next = 0;
  for (std::size_t begin = 0, end = 0; begin < blocks.size(); begin = end) {
    const std::uint32_t column = blocks[begin].column;
    while (end < blocks.size() && blocks[end].column == column) ++end;
    for (std::uint32_t j = 0; j < 3; ++j) {
      starts[3 * column + j] = next;
      for (std::size_t k = begin; k < end; ++k)
        for (std::uint32_t i = k == begin ? j : 0; i < 3; ++i)
          rows[next++] = static_cast<int>(3 * blocks[k].row + i);
    }
  }
  starts[n] = next;
}

void Direct::Impl::prepare_primal(const LinearSystem& system) {
  std::vector<MatrixEntry> blocks;
  for (std::uint32_t u = 0; u < system.unknowns(); ++u) blocks.push_back({u, u});
  for (const LinearSystem::Block& block : system.blocks()) {
    const auto of = system.members(block);
    for_each_pair(of, [&](std::size_t a, std::size_t b) { blocks.push_back({of[b], of[a]}); });
  }
  sort_unique(blocks);
  std::vector<std::size_t> begin(system.unknowns() + 1, blocks.size());
  for (std::size_t k = blocks.size(); k-- > 0;) begin[blocks[k].column] = k;
  slot.clear();
  for (const LinearSystem::Block& block : system.blocks()) {
    const auto of = system.members(block);
    for_each_pair(of, [&](std::size_t a, std::size_t b) {
      const auto first = blocks.begin() + static_cast<std::ptrdiff_t>(begin[of[b]]);
      const auto at = std::lower_bound(first, blocks.end(), MatrixEntry{of[b], of[a]});
      slot.push_back(static_cast<std::uint32_t>(at - first));
    });
  }
  build_primal_pattern(system.unknowns(), blocks);
}

// (M + J^T A^-1 J) and J^T A^-1 b.
void Direct::Impl::fill_primal(const LinearSystem& system) {
  const int* starts = matrix.outerIndexPtr();
  double* values = matrix.valuePtr();
  std::fill_n(values, matrix.nonZeros(), 0.0);
  rhs.setZero(matrix.rows());
  for (std::size_t u = 0; u < system.unknowns(); ++u)
    for (std::size_t axis = 0; axis < 3; ++axis) values[starts[3 * u + axis]] += system.mass[u];
  std::size_t next = 0;
  for (const LinearSystem::Block& block : system.blocks()) {
    const auto of = system.members(block);
    const double* inverse = &system.inverse[block.compliance];
    const auto stiffness = [&](int r, int s) { return inverse[packed_index(r, s)]; };
    for_each_pair(of, [&](std::size_t a, std::size_t b) {
      const auto at = static_cast<int>(3 * slot[next++]);
      for (int s = 0; s < block.rows; ++s) {
        Vec3d left{};  // row s of A^-1 J, at member a
        for (int r = 0; r < block.rows; ++r) left += Vec3d(system.gradient_of(block, r)[a]) * stiffness(r, s);
        const Vec3d right(system.gradient_of(block, s)[b]);
        for (int j = 0; j < 3; ++j)
          for (int i = a == b ? j : 0; i < 3; ++i)
            values[starts[3 * of[b] + static_cast<std::uint32_t>(j)] + at - j + i] += left[i] * right[j];
      }
    });
    for (int r = 0; r < block.rows; ++r) {
      const double force = row_times(block.rows, inverse, r, &system.b[block.row]);
      for (std::size_t k = 0; k < block.arity; ++k)
        for (int axis = 0; axis < 3; ++axis)
          if (of[k] != LinearSystem::pinned)
            rhs[3 * static_cast<Eigen::Index>(of[k]) + axis] +=
                force * static_cast<double>(system.gradient_of(block, r)[k][axis]);
    }
  }
}

void Direct::Impl::build_dual_pattern(std::size_t rows, const std::vector<MatrixEntry>& matrix_entries) {
  const auto n = static_cast<Eigen::Index>(rows);
  matrix = Matrix(n, n);
  matrix.resizeNonZeros(static_cast<Eigen::Index>(matrix_entries.size()));
  int* starts = matrix.outerIndexPtr();
  std::fill_n(starts, n + 1, 0);
  for (std::size_t k = 0; k < matrix_entries.size(); ++k) {
    ++starts[matrix_entries[k].column + 1];
    matrix.innerIndexPtr()[k] = static_cast<int>(matrix_entries[k].row);
  }
  for (Eigen::Index c = 0; c < n; ++c) starts[c + 1] += starts[c];
}

namespace {

// Visits the terms of the dual's lower triangle in the order in which they are added. These are compliance_term(entry,
// index into the compliances) for each block, then pair_term(entry, unknown, a, b) for the pairs of rows that share an
// unknown.
template <class ComplianceTerm, class PairTerm>
void for_each_dual_entry(const LinearSystem& system, const std::vector<std::vector<Incidence>>& incidences,
                         const ComplianceTerm& compliance_term, const PairTerm& pair_term) {
  for (const LinearSystem::Block& block : system.blocks())
    for (std::uint32_t r = 0; r < block.rows; ++r)
      for (std::uint32_t s = 0; s <= r; ++s)
        compliance_term(MatrixEntry{block.row + s, block.row + r}, block.compliance + r * (r + 1) / 2 + s);
  for (std::size_t u = 0; u < incidences.size(); ++u)
    for (std::size_t a = 0; a < incidences[u].size(); ++a)
      for (std::size_t b = 0; b <= a; ++b)
        pair_term(MatrixEntry{incidences[u][b].row, incidences[u][a].row}, u, incidences[u][a],
                  incidences[u][b]);
}

}  // namespace

void Direct::Impl::prepare_dual(const LinearSystem& system) {
  incidences.assign(system.unknowns(), {});
  double entries = 0;
  for (const LinearSystem::Block& block : system.blocks()) {
    const auto of = system.members(block);
    for (std::uint32_t r = 0; r < block.rows; ++r)
      for (std::uint32_t k = 0; k < block.arity; ++k)
        if (of[k] != LinearSystem::pinned) {
          incidences[of[k]].push_back({block.row + r, block.gradient + r * block.arity + k});
          entries += static_cast<double>(incidences[of[k]].size());
        }
  }
  if (entries > static_cast<double>(max_entries)) refuse(entries, "entries of its matrix", max_entries);
  std::vector<MatrixEntry> matrix_entries;
  const auto collect = [&](const MatrixEntry& at, auto&&...) { matrix_entries.push_back(at); };
  for_each_dual_entry(system, incidences, collect, collect);
  sort_unique(matrix_entries);
  build_dual_pattern(system.rows(), matrix_entries);
  slot.clear();
  const auto find = [&](const MatrixEntry& at, auto&&...) {
    slot.push_back(static_cast<std::uint32_t>(
        std::lower_bound(matrix_entries.begin(), matrix_entries.end(), at) - matrix_entries.begin()));
  };
  for_each_dual_entry(system, incidences, find, find);
}

// J W J^T + A.
void Direct::Impl::fill_dual(const LinearSystem& system) {
  double* values = matrix.valuePtr();
  std::fill_n(values, matrix.nonZeros(), 0.0);
  rhs = Eigen::Map<const Eigen::VectorXd>(system.b.data(), static_cast<Eigen::Index>(system.b.size()));
  std::size_t next = 0;
  for_each_dual_entry(
      system, incidences,
      [&](const MatrixEntry&, std::uint32_t compliance) {
        values[slot[next++]] += system.compliance[compliance];
      },
      [&](const MatrixEntry&, std::size_t u, const Incidence& a, const Incidence& b) {
        values[slot[next++]] +=
            dot(Vec3d(system.gradient[a.gradient]), Vec3d(system.gradient[b.gradient])) / system.mass[u];
      });
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) values[matrix.outerIndexPtr()[row]] *= 1 + redundant;
}

void Direct::prepare_system(LinearSystem& system, const ParticleView& particles) {
  system.linearize(particles, Substep{.h = 1}, true);
  impl_->dual = system.floored() > 0 && system.rows() <= 3 * system.unknowns();
  floors_ = !impl_->dual;
  const std::size_t size = impl_->dual ? system.rows() : 3 * system.unknowns();
  if (size > max_unknowns) refuse(static_cast<double>(size), "unknowns", static_cast<double>(max_unknowns));
  if (size == 0) return;
  if (impl_->dual) {
    impl_->prepare_dual(system);
  } else {
    impl_->prepare_primal(system);
  }
  impl_->factorization.analyzePattern(impl_->matrix);
  const double operations = impl_->factorization.operations();
  if (operations > max_operations) refuse(operations, "operations per factorization", max_operations);
}

bool Direct::solve_system(LinearSystem& system, Threads&) {
  Impl& impl = *impl_;
  if (system.unknowns() == 0) return true;
  if (impl.dual) {
    impl.fill_dual(system);
  } else {
    impl.fill_primal(system);
  }
  if (!impl.rhs.allFinite()) return false;
  impl.factorization.factorize(impl.matrix);
  if (impl.factorization.info() != Eigen::Success) return false;
  impl.solution = impl.factorization.solve(impl.rhs);
  if (!impl.solution.allFinite()) return false;
  if (impl.dual) {
    std::copy(impl.solution.begin(), impl.solution.end(), system.dlambda.begin());
    system.moves_from_multipliers();
  } else {
    for (std::size_t u = 0; u < system.unknowns(); ++u) {
      const auto at = static_cast<Eigen::Index>(3 * u);
      system.dx[u] = {impl.solution[at], impl.solution[at + 1], impl.solution[at + 2]};
    }
    system.multipliers_from_moves();
  }
  return true;
}

std::string Direct::diagnostic() const {
  return floor_diagnostic();
}

}  // namespace souple
