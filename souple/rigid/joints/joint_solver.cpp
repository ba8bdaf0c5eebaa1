#include "souple/rigid/joints/joint_solver.h"

#include "souple/assert.h"
#include "souple/math/disjoint_sets.h"

#include <algorithm>
#include <utility>

namespace souple::joint {
namespace {

/// Newton's method ends when no error, relative to the bodies' size, is larger than this one. One or two passes
/// suffice.
constexpr double enough = 1e-7;
/// An error above this limit after a pass shows that bodies turned too far for the gradients of the substep's start.
constexpr double too_far = 1e-3;
/// A joint is jerked if s (prepared_joint.h) exceeds `least_jerk`, and exceeds `jerk_ratio` times the s for which its
/// arms were chosen.
constexpr double least_jerk = 0.5, jerk_ratio = 3;
constexpr int most_restarts = 3;
/// A pass that would turn a body further than this [rad] is repeated with damping (Levenberg and Marquardt), a part of
/// the matrix's diagonal. Large turns mean that joints cannot be satisfied, or only along a path that gradients do not
/// show. A straight chain that must become shorter is an example.
constexpr double most_turn = 0.5, least_damping = 1e-6;
/// Exchanging rows at bounds may go in circles.
constexpr int most_passes = 20;
constexpr int most_passes_alone = 4;
constexpr double most_cost = 5e7;
/// Part of the last substep's impulses that sweeps begin with. More than 2/3 is unstable: errors of positions then sum up
/// faster than sweeps remove them.
constexpr double warm_part = 0.5;

const Vec3d& linear_of(const Row& row, bool is_b) {
  return is_b ? row.linear_b : row.linear_a;
}
const Vec3d& angular_of(const Row& row, bool is_b) {
  return is_b ? row.angular_b : row.angular_a;
}

/// Adds J M^-1 J^T of one body to a block of `prepared`, row by row.
void add_product(const PreparedJoint& row_joint, bool row_is_b, const PreparedJoint& column_joint,
                 bool column_is_b, double inverse_mass, const Mat3d& inverse_inertia, double* block) {
  const std::size_t columns = column_joint.count();
  for (std::size_t c = 0; c < columns; ++c) {
    if (!column_joint.solved[c]) continue;
    const Vec3d linear = linear_of(column_joint.rows.row[c], column_is_b) * inverse_mass;
    const Vec3d angular = inverse_inertia * angular_of(column_joint.rows.row[c], column_is_b);
    for (std::size_t r = 0; r < row_joint.count(); ++r) {
      if (!row_joint.solved[r]) continue;
      const Row& row = row_joint.rows.row[r];
      block[r * columns + c] +=
          dot(linear_of(row, row_is_b), linear) + dot(angular_of(row, row_is_b), angular);
    }
  }
}

/// Adds alpha and `damping` to the diagonal; rows that are not solved get 1.
void add_diagonal(const PreparedJoint& joint, double damping, double* block) {
  const std::size_t n = joint.count();
  for (std::size_t r = 0; r < n; ++r)
    block[r * n + r] += joint.solved[r] ? joint.target[r].alpha + damping * joint.K[r] : 1;
}

}  // namespace

bool JointSolver::is_current(const Joints& joints, const RigidBodies& bodies) const {
  if (key_.size() != joints.size() || movable_.size() != bodies.size()) return false;
  for (std::uint32_t i = 0; i < bodies.size(); ++i)
    if (movable_[i] != char(is_movable(bodies, i))) return false;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Joint& joint = joints.joint[j];
    if (key_[j] != std::array{joint.a, joint.b, static_cast<std::uint32_t>(prepared_[j].rows.count)})
      return false;
  }
  return true;
}

void JointSolver::find_islands(const Joints& joints, const RigidBodies& bodies) {
  movable_.resize(bodies.size()), stiffness_.assign(bodies.size(), {}), response_.assign(bodies.size(), {});
  impulse_.assign(bodies.size(), {}), saved_.assign(bodies.size(), {});
  for (std::uint32_t i = 0; i < bodies.size(); ++i) movable_[i] = is_movable(bodies, i);
  DisjointSets connected(bodies.size());
  key_.clear();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto [a, b] = std::pair{joints.joint[j].a, joints.joint[j].b};
    key_.push_back({a, b, static_cast<std::uint32_t>(prepared_[j].rows.count)});
    if (moves(a) && moves(b)) connected.join(a, b);
  }
  islands_.clear();
  std::vector<std::size_t> island_of(bodies.size(), ~std::size_t{0});
  for (std::uint32_t j = 0; j < joints.size(); ++j) {
    const std::uint32_t body = moves(joints.joint[j].a) ? joints.joint[j].a : joints.joint[j].b;
    if (!moves(body)) continue;
    std::size_t& island = island_of[connected.root(body)];
    if (island == ~std::size_t{0}) island = islands_.size(), islands_.emplace_back();
    islands_[island].joints.push_back(j);
  }
  for (Island& island : islands_) build(island, joints);
}

/// Finds the joints that share bodies, and the places of their products in the matrix.
void JointSolver::build(Island& island, const Joints& joints) {
  struct At {
    std::uint32_t body;
    Side side;
  };
  std::vector<At> sides;
  std::vector<int> sizes;
  for (std::uint32_t k = 0; k < island.joints.size(); ++k) {
    const std::uint32_t j = island.joints[k];
    sizes.push_back(prepared_[j].rows.count);
    for (const bool is_b : {false, true}) {
      const std::uint32_t body = is_b ? joints.joint[j].b : joints.joint[j].a;
      if (moves(body)) sides.push_back({body, {k, is_b}});
    }
  }
  std::stable_sort(sides.begin(), sides.end(), [](const At& a, const At& b) { return a.body < b.body; });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i == 0 || sides[i].body != sides[i - 1].body) island.bodies.push_back(sides[i].body);
    for (std::size_t k = i; k < sides.size() && sides[k].body == sides[i].body; ++k) {
      if (sides[i].side.joint != sides[k].side.joint)
        pairs.emplace_back(sides[i].side.joint, sides[k].side.joint);
      island.products.push_back({sides[i].side, sides[k].side, sides[i].body, 0});
    }
  }
  island.matrix.analyze(sizes, pairs);
  island.direct = island.matrix.cost() < most_cost;
  for (Product& product : island.products) {
    const auto [offset, swapped] = island.matrix.place(product.row.joint, product.column.joint);
    product.offset = offset;
    if (swapped) std::swap(product.row, product.column);
  }
  for (std::uint32_t k = 0; k < island.joints.size(); ++k)
    island.diagonal.push_back(island.matrix.place(k, k).offset);
  island.x.resize(island.matrix.rows());
}

void JointSolver::begin_substep(Joints& joints, const RigidBodies& bodies, double h) {
  SOUPLE_ASSERT(h > 0, "a substep lasts");
  h_ = h;
  prepared_.resize(joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j)
    prepare(joints.joint[j], joints.state[j], bodies, h, prepared_[j]);
  if (!is_current(joints, bodies)) find_islands(joints, bodies);
  for (Island& island : islands_) {
    island.projected = false;
    const bool direct = island.direct && method == Method::direct;
    if (direct) weigh(island, joints, bodies, false);
    for (const std::uint32_t body : island.bodies) {
      impulse_[body] = {};
      if (!direct) response_[body] = bodies.inverse_inertia[body];
    }
    for (const std::uint32_t j : island.joints) {
      // Newton's method needs no first guess; sweeps do.
      for (std::size_t i = 0; i < Rows::most; ++i)
        prepared_[j].change[i] = direct ? 0 : warm_part * joints.state[j].lambda[i];
      joints.state[j].lambda = {};
    }
  }
}

void JointSolver::project(Joints& joints, RigidBodies& bodies) {
  for (Island& island : islands_) {
    if (island.direct && method == Method::direct)
      solve(island, joints, bodies);
    else
      sweep(island, joints, bodies);
  }
}

void JointSolver::end_substep(Joints& joints) {
  for (std::size_t j = 0; j < joints.size(); ++j) report(joints.joint[j], joints.state[j], prepared_[j]);
}

/// Arms, and how bodies respond to torques, for the present impulses.
void JointSolver::weigh(const Island& island, const Joints& joints, const RigidBodies& bodies, bool jerk) {
  for (const std::uint32_t body : island.bodies) stiffness_[body] = {};
  for (const std::uint32_t j : island.joints)
    weigh_arms(joints.joint[j], joints.state[j], jerk, prepared_[j], stiffness_);
  for (const std::uint32_t body : island.bodies) {
    const Mat3d& inverse = bodies.inverse_inertia[body];
    response_[body] = souple::inverse(Mat3d::identity() + inverse * stiffness_[body]) * inverse;
  }
}

void JointSolver::save(const Island& island, const Joints& joints, const RigidBodies& bodies) {
  for (const std::uint32_t body : island.bodies) saved_[body] = bodies.pose[body];
  for (const std::uint32_t j : island.joints) prepared_[j].lambda = joints.state[j].lambda;
}

/// Repeats the projection with arms for the present impulses when a chain jerks taut. A joint then pulls much more than
/// its arms were chosen for.
bool JointSolver::restart(const Island& island, Joints& joints, RigidBodies& bodies) {
  bool jerked = false;
  for (const std::uint32_t j : island.joints) {
    const double s = stiffness_of(joints.state[j], prepared_[j]);
    jerked |= s > least_jerk && s > jerk_ratio * prepared_[j].stiffness;
  }
  if (!jerked) return false;
  weigh(island, joints, bodies, true);
  for (const std::uint32_t body : island.bodies) bodies.pose[body] = saved_[body];
  for (const std::uint32_t j : island.joints) joints.state[j].lambda = prepared_[j].lambda;
  return true;
}

void JointSolver::solve(Island& island, Joints& joints, RigidBodies& bodies) {
  bool far = false, damped = false;
  double damping = 0;
  int restarts = 0;
  const bool again = std::exchange(island.projected, true);
  save(island, joints, bodies);
  for (int pass = 0; pass < most_passes; ++pass) {
    Refreshed all;
    const Gradients gradients = far ? Gradients::present : Gradients::prepared;
    for (const std::uint32_t j : island.joints) {
      const Refreshed one = refresh(joints.joint[j], joints.state[j], bodies, h_, gradients, prepared_[j]);
      all = {all.changed || one.changed, std::max(all.error, one.error)};
    }
    if ((again || pass > 0) && !all.changed && all.error < enough) break;
    damping = damping > least_damping ? damping / 100 : 0;
    if (pass == 0 || all.changed || far || damped) assemble(island, bodies, damping);
    solve_rows(island, joints, bodies);
    while (largest_turn(island) > most_turn && damping < 1) {
      damping = std::max(100 * damping, least_damping);
      assemble(island, bodies, damping);
      solve_rows(island, joints, bodies);
    }
    for (const std::uint32_t body : island.bodies) move(body, bodies);
    damped = damping > 0;
    far = pass > 0 && all.error > too_far;
    for (const std::uint32_t j : island.joints)
      for (std::size_t i = 0; i < prepared_[j].count(); ++i)
        joints.state[j].lambda[i] += prepared_[j].change[i];
    if (pass == 0 && restarts < most_restarts && restart(island, joints, bodies)) ++restarts, pass = -1;
  }
}

/// `damping`: a part of the diagonal.
void JointSolver::assemble(Island& island, const RigidBodies& bodies, double damping) {
  island.matrix.clear();
  for (const Product& product : island.products) {
    const PreparedJoint& row = prepared_[island.joints[product.row.joint]];
    const PreparedJoint& column = prepared_[island.joints[product.column.joint]];
    add_product(row, product.row.is_b, column, product.column.is_b, bodies.mass[product.body].inverse,
                response_[product.body], island.matrix.at(product.offset));
  }
  for (std::size_t k = 0; k < island.joints.size(); ++k)
    add_diagonal(prepared_[island.joints[k]], damping, island.matrix.at(island.diagonal[k]));
  island.matrix.factorize();
}

/// The change of each lambda: known where a row is at a bound, the solution elsewhere. Leaves the bodies' impulses.
void JointSolver::solve_rows(Island& island, const Joints& joints, const RigidBodies& bodies) {
  for (const std::uint32_t body : island.bodies) impulse_[body] = {};
  for (const std::uint32_t j : island.joints) {
    for (std::size_t i = 0; i < prepared_[j].count(); ++i)
      if (prepared_[j].solved[i]) prepared_[j].change[i] = 0;
    add_impulses(joints.joint[j], prepared_[j]);
  }
  for (std::size_t k = 0; k < island.joints.size(); ++k) {
    const std::uint32_t j = island.joints[k];
    const PreparedJoint& prepared = prepared_[j];
    double* x = island.x.data() + island.matrix.first_row(k);
    for (std::size_t i = 0; i < prepared.count(); ++i)
      x[i] = prepared.solved[i] ? -left_of(i, joints, j) - known_motion(i, joints.joint[j], prepared, bodies)
                                : 0;
  }
  island.matrix.solve(island.x);
  for (const std::uint32_t body : island.bodies) impulse_[body] = {};
  for (std::size_t k = 0; k < island.joints.size(); ++k) {
    PreparedJoint& prepared = prepared_[island.joints[k]];
    const double* x = island.x.data() + island.matrix.first_row(k);
    for (std::size_t i = 0; i < prepared.count(); ++i)
      if (prepared.solved[i]) prepared.change[i] = x[i];
    add_impulses(joints.joint[island.joints[k]], prepared);
  }
}

/// The largest rotation of a body by the impulses of this pass [rad].
double JointSolver::largest_turn(const Island& island) const {
  double turn = 0;
  for (const std::uint32_t body : island.bodies)
    turn = std::max(turn, length_squared(response_[body] * impulse_[body].angular));
  return std::sqrt(turn);
}

/// Residual of a row's equation.
double JointSolver::left_of(std::size_t i, const Joints& joints, std::uint32_t j) const {
  const RowTarget& target = prepared_[j].target[i];
  return prepared_[j].rows.row[i].value - target.goal + target.alpha * joints.state[j].lambda[i];
}

/// Change of a row's value by the impulses of rows at bounds.
double JointSolver::known_motion(std::size_t i, const Joint& joint, const PreparedJoint& prepared,
                                 const RigidBodies& bodies) const {
  double motion = 0;
  for (const bool is_b : {false, true}) {
    const std::uint32_t body = is_b ? joint.b : joint.a;
    if (!moves(body)) continue;
    const Row& row = prepared.rows.row[i];
    motion += bodies.mass[body].inverse * dot(linear_of(row, is_b), impulse_[body].linear) +
              dot(angular_of(row, is_b), response_[body] * impulse_[body].angular);
  }
  return motion;
}

void JointSolver::add_impulses(const Joint& joint, const PreparedJoint& prepared) {
  for (const bool is_b : {false, true}) {
    const std::uint32_t body = is_b ? joint.b : joint.a;
    if (!moves(body)) continue;
    for (std::size_t i = 0; i < prepared.count(); ++i) {
      impulse_[body].linear += linear_of(prepared.rows.row[i], is_b) * prepared.change[i];
      impulse_[body].angular += angular_of(prepared.rows.row[i], is_b) * prepared.change[i];
    }
  }
}

/// Applies and forgets a body's impulses.
void JointSolver::move(std::uint32_t body, RigidBodies& bodies) {
  if (!moves(body)) return;
  BodyPose& pose = bodies.pose[body];
  pose.position += impulse_[body].linear * bodies.mass[body].inverse;
  pose.rotation = turned(pose.rotation, response_[body] * impulse_[body].angular);
  impulse_[body] = {};
}

/// Gauss-Seidel. The first sweep of a substep begins with the impulses of the last one.
void JointSolver::sweep(Island& island, Joints& joints, RigidBodies& bodies) {
  if (!island.projected) {
    for (const std::uint32_t j : island.joints) apply(j, joints);
    for (const std::uint32_t body : island.bodies) move(body, bodies);
    island.projected = true;
  }
  for (const std::uint32_t j : island.joints) solve_alone(j, joints, bodies);
}

/// Adds the joint's changes to its impulses and to those of its bodies.
void JointSolver::apply(std::uint32_t j, Joints& joints) {
  add_impulses(joints.joint[j], prepared_[j]);
  for (std::size_t i = 0; i < prepared_[j].count(); ++i) joints.state[j].lambda[i] += prepared_[j].change[i];
}

void JointSolver::solve_alone(std::uint32_t j, Joints& joints, RigidBodies& bodies) {
  const Joint& joint = joints.joint[j];
  PreparedJoint& prepared = prepared_[j];
  std::array<double, std::size_t{Rows::most} * Rows::most> block;
  std::array<double, Rows::most> x;
  for (int pass = 0; pass < most_passes_alone; ++pass) {
    const bool changed = refresh(joint, joints.state[j], bodies, h_, Gradients::present, prepared).changed;
    if (pass > 0 && !changed) break;
    block.fill(0);
    for (const bool is_b : {false, true}) {
      const std::uint32_t body = is_b ? joint.b : joint.a;
      if (moves(body))
        add_product(prepared, is_b, prepared, is_b, bodies.mass[body].inverse, response_[body], block.data());
    }
    add_diagonal(prepared, 0, block.data());
    add_impulses(joint, prepared);
    for (std::size_t i = 0; i < prepared.count(); ++i)
      x[i] = prepared.solved[i] ? -left_of(i, joints, j) - known_motion(i, joint, prepared, bodies) : 0;
    for (const std::uint32_t body : {joint.a, joint.b})
      if (moves(body)) impulse_[body] = {};
    solve_dense(block.data(), prepared.rows.count, x.data());
    for (std::size_t i = 0; i < prepared.count(); ++i)
      if (prepared.solved[i]) prepared.change[i] = x[i];
    apply(j, joints);
    move(joint.a, bodies), move(joint.b, bodies);
  }
}

}  // namespace souple::joint
