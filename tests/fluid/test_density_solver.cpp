#include "souple/fluid/coarse_pressure.h"
#include "souple/fluid/density_solver.h"
#include "tests/fluid/clouds.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace souple::test_fluid_density_solver {

constexpr float d = 0.02f, gravity = 9.81f, density = 1000;

/// Water in a box without lid, with a corner at (0, 0, 0).
struct Pool {
  int nx, ny, nz;
  std::unique_ptr<Threads> threads;
  DensitySolver solver;
  std::vector<Vec4f> positions;
  std::vector<Vec3f> velocity, smoothed;
  double floor_impulse = 0;  // N s

  Pool(int x, int y, int z, int thread_count, const DensitySolver::Options& options = {})
      : nx(x), ny(y), nz(z), threads(make_threads(Threading::pool, thread_count)), solver(d, options) {
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k)
        for (int i = 0; i < nx; ++i)
          positions.push_back(
              {(float(i) + 0.5f) * d, (float(j) + 0.5f) * d, (float(k) + 0.5f) * d, 1 / mass()});
    velocity.resize(positions.size());
    smoothed.resize(positions.size());
  }
  float mass() const { return density * solver.smoothing().volume(); }
  /// The product rule for five walls: overlapping walls are not counted twice.
  BoundarySums walls(const Vec3f& x) const {
    const float distance[] = {x.x, float(nx) * d - x.x, x.y, x.z, float(nz) * d - x.z};
    const Vec3f normal[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
    BoundarySums sums;
    float left = 1;
    for (int a = 0; a < 5; ++a) {
      const Smoothing::Wall wall = solver.smoothing().wall(distance[a]);
      sums.slope = sums.slope * (1 - wall.value) + normal[a] * (wall.slope * left);
      left *= 1 - wall.value;
    }
    sums.value = 1 - left;
    return sums;
  }
  struct Walls : FixedBoundary {
    explicit Walls(const Pool& p) : pool(p) {}
    const Pool& pool;
    BoundarySums sample(std::size_t, const Vec3f& x) const { return pool.walls(x); }
  };
  void substep(float h) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      velocity[i].y -= gravity * h;
      positions[i].set_xyz(positions[i].xyz() + velocity[i] * h);
    }
    solver.set_positions(positions, *threads);
    Walls boundary{*this};
    solver.solve(boundary, *threads, h);
    for (std::size_t k = 0; k < positions.size(); ++k) {
      const std::uint32_t i = solver.order()[k];
      positions[i].set_xyz(solver.positions()[k].xyz());
      velocity[i] = velocity[i] + solver.moved()[k] * (1 / h);
      floor_impulse += double{mass()} * double{solver.moved()[k].y} / double{h};
    }
    smooth();
  }
  /// XSPH: velocities move a twentieth toward those of neighbors.
  void smooth() {
    for (const Neighbors::Block& block : solver.neighbors().blocks()) {
      for (std::uint32_t k = block.begin; k < block.end; ++k) {
        Vec3f mean{};
        const std::uint32_t i = solver.order()[k];
        for (const std::uint32_t entry : block.of(k)) {
          const Vec3f apart = solver.positions()[entry / 4].xyz() - solver.positions()[k].xyz();
          const float q = length(apart) / (2 * d), t = std::max(1 - q, 0.0f);
          const float weight = solver.smoothing().factors().value_factor * t * t * t * t * (1 + 4 * q);
          mean = mean + (velocity[solver.order()[entry / 4]] - velocity[i]) * weight;
        }
        smoothed[i] = velocity[i] + mean * (0.05f * solver.smoothing().volume());
      }
    }
    velocity.swap(smoothed);
  }
  double rms_speed() const {
    double sum = 0;
    for (const Vec3f& v : velocity) sum += double{dot(v, v)};
    return std::sqrt(sum / double(velocity.size()));
  }
  double fill_height() const {  // center of the top layer plus half a spacing
    std::vector<float> y;
    for (const Vec4f& p : positions) y.push_back(p.y);
    std::sort(y.begin(), y.end());
    return double{y[y.size() - 1 - std::size_t(nx * nz) / 2]} + 0.5 * double{d};
  }
  double pressure(float from, float to, float h) const {  // mean between two heights [Pa]
    double sum = 0;
    int count = 0;
    for (std::size_t k = 0; k < positions.size(); ++k) {
      const float y = solver.positions()[k].y;
      if (y < from || y > to) continue;
      sum -= double{solver.lambda()[k]} / double{solver.smoothing().volume() * h * h};
      ++count;
    }
    return sum / count;
  }
};

// A pool of 25 layers after two seconds: its height is unchanged, it is at rest, and its pressure is the
// weight above.
TEST(DensitySolver, AColumnRests) {
  Pool pool(10, 25, 10, 2);
  constexpr float h = 1.0f / 360;
  for (int i = 0; i < 720; ++i) pool.substep(h);
  pool.floor_impulse = 0;
  for (int i = 0; i < 60; ++i) pool.substep(h);
  const double height = 25 * double{d};
  EXPECT_LT(pool.rms_speed(), 0.01);
  EXPECT_NEAR(pool.fill_height() / height, 1, 0.01);
  const double weight = double{pool.mass()} * double(pool.positions.size()) * double{gravity};
  EXPECT_NEAR(pool.floor_impulse / (60 * double{h}) / weight, 1, 0.01);
  const double below = double{density * gravity} * (height - 0.5 * double{d});
  EXPECT_NEAR(pool.pressure(0, d, h) / below, 1, 0.03);
  EXPECT_NEAR(pool.pressure(12 * d, 13 * d, h) / (double{density * gravity} * 12.5 * double{d}), 1, 0.04);
  double error = 0;
  for (std::size_t k = 0; k < pool.positions.size(); ++k)
    error += std::max(0.0, double{pool.solver.density_error(k)}) / double(pool.positions.size());
  EXPECT_LT(error, 0.005);
}

struct Nothing : FixedBoundary {
  BoundarySums sample(std::size_t, const Vec3f&) const { return {}; }
};

// Two particles at rest: their density does not compress them, so only artificial pressure separates them.
TEST(DensitySolver, ArtificialPressureKeepsParticlesFromMeeting) {
  const auto threads = make_threads(Threading::serial, 1);
  const auto displacement = [&](float pressure, float apart, float h) {
    DensitySolver solver(d, {.artificial_pressure = pressure});
    const float w = 1 / (density * d * d * d);
    solver.set_positions(std::vector<Vec4f>{{0, 0, 0, w}, {apart, 0, 0, w}}, *threads);
    Nothing nothing;
    solver.solve(nothing, *threads, h);
    EXPECT_EQ(solver.moved()[0], solver.moved()[1] * -1.0f);
    return solver.moved()[solver.order()[0] == 0 ? 1 : 0].x;
  };
  const float near = displacement(1000, 0.4f * d, 0.002f);
  EXPECT_EQ(displacement(0, 0.4f * d, 0.002f), 0);
  EXPECT_GT(near, 0);
  EXPECT_NEAR(displacement(2000, 0.4f * d, 0.002f) / near, 2, 1e-3);
  EXPECT_NEAR(displacement(1000, 0.4f * d, 0.004f) / near, 4, 1e-3);  // an acceleration
  EXPECT_LT(displacement(1000, d, 0.002f), 0.01f * near);
}

TEST(DensitySolver, KeepsTheMomentumOfWhatIsPressedTogether) {
  Pool pool(8, 8, 8, 2);
  double largest = 0;
  for (std::size_t i = 0; i < pool.positions.size(); ++i) {
    pool.positions[i].set_xyz(pool.positions[i].xyz() * 0.9f);
    if (i % 3 == 0) pool.positions[i].w *= 2;  // some lighter particles
  }
  pool.solver.set_positions(pool.positions, *pool.threads);
  Nothing nothing;
  pool.solver.solve(nothing, *pool.threads);
  Vec3d sum{};
  for (std::size_t k = 0; k < pool.positions.size(); ++k) {
    const double m = 1 / double{pool.solver.positions()[k].w};
    sum = sum + Vec3d(pool.solver.moved()[k]) * m;
    largest += double{length(pool.solver.moved()[k])} * m;
  }
  EXPECT_GT(largest, 0);
  EXPECT_LT(length(sum) / largest, 1e-6);
}

using Sample = CoarsePressure::Sample;

constexpr float cell = 0.25f, surface = 0.06f;

struct Case {
  std::vector<Vec4f> positions = test::random_cloud(600, 1, 1);
  std::vector<Sample> samples;

  Case() {
    test::Random random(2);
    for (Vec4f& p : positions) p.w = static_cast<float>(random.uniform(10, 30));
    positions[0] = {0, 0, 0, 20};  // the grid's corner
    for (std::size_t i = 0; i < positions.size(); ++i)
      samples.push_back(
          {static_cast<float>(random.uniform(-0.1, 0.1)), static_cast<float>(random.uniform(0, 2000))});
  }
  std::vector<float> multipliers(int threads) const {
    const auto pool = make_threads(Threading::pool, threads);
    CoarsePressure coarse;
    std::vector<float> lambda(positions.size());
    coarse.begin_step(positions, cell, *pool);
    // Each solve starts from the last solution and comes closer.
    for (int again = 0; again < 6; ++again) coarse.solve(positions, samples, surface, *pool);
    coarse.interpolate(positions, samples, surface, lambda, *pool);
    return lambda;
  }
};

using Node = std::array<int, 3>;

/// The multipliers by a dense matrix, straight from the formula.
std::vector<float> by_dense_matrix(const Case& c) {
  std::map<Node, int> number;
  std::vector<std::array<std::pair<int, double>, 8>> weights;
  std::map<Node, double> w_in;
  for (const Vec4f& p : c.positions) {
    const double x[3] = {p.x / cell, p.y / cell, p.z / cell};
    const Node at{int(x[0]), int(x[1]), int(x[2])};
    w_in[at] += double{p.w};
    auto& mine = weights.emplace_back();
    for (int e = 0; e < 8; ++e) {
      Node node = at;
      double weight = 1;
      for (std::size_t a = 0; a < 3; ++a) {
        const int up = e >> a & 1;
        node[a] += up;
        weight *= up != 0 ? x[a] - at[a] : 1 - (x[a] - at[a]);
      }
      mine[std::size_t(e)] = {number.try_emplace(node, int(number.size())).first->second, weight};
    }
  }
  const auto n = Eigen::Index(number.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  for (const auto& [at, w] : w_in) {
    for (int e = 0; e < 8; ++e) {
      for (int f = 0; f < 8; ++f) {
        const int apart = __builtin_popcount(unsigned(e ^ f));
        const double k = apart == 0 ? 1.0 / 3 : apart == 1 ? 0 : -1.0 / 12;
        const auto node = [&at = at](int corner) {
          return Node{at[0] + (corner & 1), at[1] + (corner >> 1 & 1), at[2] + (corner >> 2)};
        };
        A(number.at(node(e)), number.at(node(f))) += w / (cell * cell) * k;
      }
    }
  }
  for (std::size_t i = 0; i < c.positions.size(); ++i) {
    for (const auto& [node, weight] : weights[i]) {
      A(node, node) += double{c.samples[i].diagonal} * weight;
      if (c.samples[i].c > -surface) b[node] -= weight * c.samples[i].c;
    }
  }
  const Eigen::VectorXd y = A.ldlt().solve(b);
  std::vector<float> lambda;
  for (std::size_t i = 0; i < c.positions.size(); ++i) {
    double sum = 0;
    for (const auto& [node, weight] : weights[i]) sum += weight * y[node];
    lambda.push_back(c.samples[i].c > -surface ? float(sum) : 0);
  }
  return lambda;
}

TEST(CoarsePressure, SolvesWhatItsFormulaSays) {
  const Case c;
  const std::vector<float> found = c.multipliers(2), expected = by_dense_matrix(c);
  double error = 0, size = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    error += std::pow(found[i] - expected[i], 2);
    size += std::pow(expected[i], 2);
  }
  EXPECT_GT(size, 0);
  EXPECT_LT(std::sqrt(error / size), 0.03);
}

TEST(CoarsePressure, OfNothingAndOfOne) {
  const auto threads = make_threads(Threading::serial, 1);
  CoarsePressure coarse;
  coarse.begin_step({}, 1, *threads);
  coarse.solve({}, {}, 0.1f, *threads);
  EXPECT_EQ(coarse.node_count(), 0u);
  const std::vector<Vec4f> one{{5, 6, 7, 1}};
  std::vector<float> lambda(1);
  const std::vector<Sample> sample{{0.5f, 3}};
  coarse.begin_step(one, 1, *threads);
  coarse.solve(one, sample, 0.1f, *threads);
  coarse.interpolate(one, sample, 0.1f, lambda, *threads);
  EXPECT_LT(lambda[0], 0);
  EXPECT_TRUE(std::isfinite(lambda[0]));
}

}  // namespace souple::test_fluid_density_solver
