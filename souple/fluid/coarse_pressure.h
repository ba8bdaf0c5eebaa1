#pragma once

#include "souple/fluid/cell_order.h"
#include "souple/math/mat3.h"
#include "souple/state/particles.h"
#include "souple/threads/threads.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// The smooth part of a fluid's pressure. One pass over neighbors transports a multiplier by one particle spacing. So a
/// deep fluid would need as many passes as the square of its number of layers. Here multipliers are interpolated
/// trilinearly from the nodes a of a grid with cell size H, and one linear system gives all node values y:
///
///   A y = b,   b_a = -sum_i N_a(x_i) C_i,   lambda_i = sum_a N_a(x_i) y_a
///   A = sum_cells (sum_i w_i) / H^2 K + diag(2 sum_i w_i |2 G_i + g_i|^2 N_a(x_i)) + sum_bodies J^T W J
///
/// w_i are the inverse masses of a cell's particles. K is the Laplacian of the unit cube's trilinear element. It is 1/3
/// on the diagonal, 0 along edges, -1/12 along diagonals of faces and of the cube. G_i = V sum_j grad W_ij and the
/// walls' part g_i measure how unevenly a particle is surrounded. Where 2 G + g is large, as at a free surface, a
/// smooth multiplier would displace the particle, and the diagonal keeps y small. Particles of a free surface (C_i
/// below -surface) do not contribute to b. A rigid body with W = diag(1/m, I^-1) responds to all pressures together:
/// J_a = sum_i N_a(x_i) (g_i, r_i x g_i) over the particles in contact with it.
class CoarsePressure {
 public:
  /// One particle's contribution to the system.
  struct Sample {
    float c = 0;  ///< C = rho / rho_0 - 1
    /// 2 w |2 G + g|^2, plus the response of movable bodies and the fluid's compliance [1/(kg m^2)]
    float diagonal = 0;
  };

  /// Discards the last solution: the next solve starts from zero.
  void reset() { last_keys_.clear(); }
  /// Builds the grid for a step. `positions` by sorted index; H = cell_size > 0 [m].
  void begin_step(std::span<const Vec4f> positions, float cell_size, Threads& threads);
  /// Solves for y by conjugate gradients with diagonal preconditioning, from 0.9 times the last y. It ends when the
  /// preconditioned residual is a fiftieth of b, or after 30 iterations. `positions` (w: inverse mass [1/kg]) and
  /// `samples` by sorted index. Sums have a fixed order, whatever the number of threads.
  void solve(std::span<const Vec4f> positions, std::span<const Sample> samples, float surface,
             Threads& threads);
  /// lambda_i per sorted index; 0 at a free surface [kg m^2, as C / (w |grad C|^2)].
  void interpolate(std::span<const Vec4f> positions, std::span<const Sample> samples, float surface,
                   std::span<float> lambda, Threads& threads) const;
  /// Movable rigid bodies; call after begin_step and before each solve.
  void begin_movers(std::size_t count);
  void set_mover(std::size_t mover, double inverse_mass, const Mat3d& inverse_inertia);
  /// Adds a contact: the mover acts on a particle along `slope` g; `moment` is r x g about the mover's
  /// center.
  void add_contact(std::size_t mover, std::uint32_t index, const Vec4f& position, const Vec3d& slope,
                   const Vec3d& moment);
  int iterations() const { return iterations_; }  ///< of the last solve
  std::size_t node_count() const { return y_.size(); }

 private:
  using Corners = std::array<std::uint32_t, 8>;
  using Eight = std::array<double, 8>;

  /// A rigid body with its J and W.
  struct Mover {
    double inverse_mass = 0;
    Mat3d inverse_inertia{};
    std::vector<std::uint32_t> nodes;             // nodes with a nonzero column of J
    std::vector<std::pair<Vec3d, Vec3d>> pushes;  // J of these nodes: force and torque
    std::vector<std::uint32_t> slot_of_node;      // per node: its index in `nodes`, or none
  };

  /// A y = b, preconditioned, and vectors of the iteration. All per node.
  struct System {
    std::vector<double> b, diagonal, preconditioner;
    std::vector<double> r, p, ap;
  };

  void find_nodes();
  void add_bodies(const std::vector<double>& y, std::vector<double>& result) const;
  std::array<float, 8> weights(std::size_t cell, const Vec4f& position) const;
  void gather(std::span<const Eight> of_cells, std::vector<double>& of_nodes) const;
  void find_system(std::span<const Vec4f> positions, std::span<const Sample> samples, float surface,
                   Threads& threads);
  void sum_cells(std::span<const Vec4f> positions, std::span<const Sample> samples, float surface,
                 Threads& threads);
  void apply(const std::vector<double>& y, std::vector<double>& result);
  void iterate();

  float size_ = 1;
  CellOrder order_;
  std::vector<std::array<float, 3>> origin_;  // per cell: its lower corner [m]
  std::vector<Corners> corners_;              // per cell: its nodes
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> begin_, terms_;  // per node: 8 cell + corner, ascending
  std::vector<std::uint32_t> next_;           // per node: where its next term goes
  std::vector<std::uint32_t> cell_of_;        // per sorted index: its cell
  std::vector<Mover> movers_;
  std::size_t mover_count_ = 0;
  std::vector<double> stiffness_;  // per cell: sum w / H^2
  std::vector<Eight> cell_sums_, cell_diagonals_;
  std::vector<double> y_;  // per node
  System system_;
  std::vector<std::uint64_t> node_keys_, last_keys_;
  std::vector<double> last_y_;
  int iterations_ = 0;
};

}  // namespace souple
