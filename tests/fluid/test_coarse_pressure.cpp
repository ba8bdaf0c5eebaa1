#include "souple/fluid/coarse_pressure.h"
#include "tests/fluid/clouds.h"

#include <cmath>
#include <map>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace souple::test_fluid_coarse_pressure {

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

}  // namespace souple::test_fluid_coarse_pressure
