#include "souple/multilevel/tet_lattice.h"

#include "souple/math/disjoint_sets.h"
#include "souple/math/elementary.h"
#include "souple/math/lists.h"
#include "souple/math/sentinels.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace souple {
namespace {

constexpr std::size_t lattice_corners = kernels::cell_nodes;
/// Sides of a cell, in sides of a cube of five tets. Twice as many nodes cost more than they gain; with four times,
/// bending becomes too stiff.
constexpr double cell_coarsening = 3;

using Place = std::array<int, 3>;

int bit(std::size_t corner, std::size_t axis) {
  return static_cast<int>(corner >> axis & 1);
}

class Builder {
 public:
  Builder(const ConstraintSet<NeoHookean>& set, std::span<const std::uint32_t> tets);
  TetLattice build();

 private:
  using Corners = std::array<std::uint32_t, 4>;

  void find_particles();
  void find_rest_positions();
  void choose_cells();
  void connect();
  void number_nodes();
  void add_stiffness();
  static constexpr std::size_t points = 3;  // along each axis
  static void divide(float volume, const Vec3d& u, std::array<float, points * points * points>& volumes);
  void integrate(std::size_t cell, const std::array<float, points * points * points>& volumes);
  void add_samples();

  // Where x lies in the lattice, and, from 0 to 1, in its cell.
  Place place_of(const Vec3d& x) const;
  Vec3d within(const Vec3d& x, const Place& place) const;
  std::array<float, lattice_corners> weights(const Vec3d& u) const;
  std::array<Vec3f, lattice_corners> gradients(const Vec3d& u) const;
  std::uint32_t cell_of(const Corners& tet, const Vec3d& center);
  void choose_samples(std::size_t cell, std::span<const std::uint32_t> candidates);
  bool fit_gradients(std::size_t begin);

  const ConstraintSet<NeoHookean>& set_;
  std::span<const std::uint32_t> tets_;
  TetLattice lattice_;
  std::vector<Corners> corners_;  // of each tet: numbers of particles
  std::vector<Vec3d> rest_;       // per particle [m]
  Vec3d low_{}, size_{};          // corner of the lattice, sides of a cell [m]
  Place count_{};                 // cells along each axis
  std::vector<Place> place_;      // per particle
  // A piece is a connected part of the body in a cell.
  std::vector<std::uint32_t> piece_;       // per particle
  std::vector<Place> piece_place_;         // per piece
  std::vector<std::uint32_t> piece_node_;  // per piece and corner
  std::vector<std::uint32_t> piece_cell_;  // per piece; no_index: no tet
  std::vector<std::uint32_t> tet_cell_;    // per tet
  std::vector<Place> cell_place_;          // per cell
};

Builder::Builder(const ConstraintSet<NeoHookean>& set, std::span<const std::uint32_t> tets)
    : set_(set), tets_(tets) {}

TetLattice Builder::build() {
  find_particles();
  find_rest_positions();
  choose_cells();
  connect();
  number_nodes();
  add_stiffness();
  add_samples();
  return std::move(lattice_);
}

void Builder::find_particles() {
  std::vector<std::uint32_t>& particle = lattice_.particle;
  for (const std::uint32_t t : tets_)
    for (const std::uint32_t i : set_.indices(t)) particle.push_back(i);
  std::sort(particle.begin(), particle.end());
  particle.erase(std::unique(particle.begin(), particle.end()), particle.end());
  std::vector<std::uint32_t> number(particle.back() - particle.front() + std::size_t{1});
  for (std::uint32_t k = 0; k < particle.size(); ++k) number[particle[k] - particle.front()] = k;
  corners_.resize(tets_.size());
  for (std::size_t t = 0; t < tets_.size(); ++t) {
    const auto indices = set_.indices(tets_[t]);
    for (std::size_t k = 0; k < 4; ++k) corners_[t][k] = number[indices[k] - particle.front()];
  }
}

// From tet to tet: B^-1 holds the rest edges of each.
void Builder::find_rest_positions() {
  const std::size_t n = lattice_.particle.size();
  const Lists<std::uint32_t> around(n, [&](const auto& add) {
    for (std::uint32_t t = 0; t < corners_.size(); ++t)
      for (const std::uint32_t i : corners_[t]) add(i, t);
  });
  rest_.resize(n);
  std::vector<bool> known(n);
  std::vector<std::uint32_t> queue{0};
  known[0] = true;
  for (std::size_t q = 0; q < queue.size(); ++q) {
    const std::uint32_t i = queue[q];
    for (const std::uint32_t t : around[i]) {
      const Corners& tet = corners_[t];
      if (std::all_of(tet.begin(), tet.end(), [&](std::uint32_t j) { return known[j]; })) continue;
      const Mat3d edges = inverse(Mat3d(set_.params(tets_[t]).rest_inverse));
      const std::array<Vec3d, 4> at{Vec3d{}, edges.column[0], edges.column[1], edges.column[2]};
      const auto own = static_cast<std::size_t>(std::find(tet.begin(), tet.end(), i) - tet.begin());
      for (std::size_t c = 0; c < 4; ++c) {
        if (known[tet[c]]) continue;
        known[tet[c]] = true;
        rest_[tet[c]] = rest_[i] + at[c] - at[own];
        queue.push_back(tet[c]);
      }
    }
  }
}

void Builder::choose_cells() {
  Vec3d high{};
  for (const Vec3d& x : rest_)
    for (int axis = 0; axis < 3; ++axis)
      low_[axis] = std::min(low_[axis], x[axis]), high[axis] = std::max(high[axis], x[axis]);
  double volume = 0;
  for (const std::uint32_t t : tets_)
    volume += 1 / (6 * std::fabs(determinant(Mat3d(set_.params(t).rest_inverse))));
  const double side = cell_coarsening * elementary::cbrt(5 * volume / static_cast<double>(tets_.size()));
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = high[axis] - low_[axis];
    const auto a = static_cast<std::size_t>(axis);
    count_[a] = std::max(1, static_cast<int>(std::lround(extent / side)));
    size_[axis] = extent / count_[a];
  }
  lattice_.cell_size = static_cast<float>(std::min({size_.x, size_.y, size_.z}));
}

Place Builder::place_of(const Vec3d& x) const {
  constexpr double rounding = 1e-6;
  Place place{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double at = std::floor((x[axis] - low_[axis]) / size_[axis] + rounding);
    place[a] = std::clamp(static_cast<int>(at), 0, count_[a] - 1);
  }
  return place;
}

Vec3d Builder::within(const Vec3d& x, const Place& place) const {
  Vec3d u;
  for (int axis = 0; axis < 3; ++axis)
    u[axis] =
        std::clamp((x[axis] - low_[axis]) / size_[axis] - place[static_cast<std::size_t>(axis)], 0.0, 1.0);
  return u;
}

std::array<float, lattice_corners> Builder::weights(const Vec3d& u) const {
  std::array<float, lattice_corners> w{};
  for (std::size_t c = 0; c < lattice_corners; ++c) {
    double product = 1;
    for (int axis = 0; axis < 3; ++axis)
      product *= bit(c, static_cast<std::size_t>(axis)) != 0 ? u[axis] : 1 - u[axis];
    w[c] = static_cast<float>(product);
  }
  return w;
}

std::array<Vec3f, lattice_corners> Builder::gradients(const Vec3d& u) const {
  std::array<Vec3f, lattice_corners> g{};
  for (std::size_t c = 0; c < lattice_corners; ++c) {
    double part[3], slope[3];
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = bit(c, static_cast<std::size_t>(axis)) != 0;
      part[axis] = upper ? u[axis] : 1 - u[axis];
      slope[axis] = (upper ? 1 : -1) / size_[axis];
    }
    g[c] = Vec3f(
        Vec3d{slope[0] * part[1] * part[2], part[0] * slope[1] * part[2], part[0] * part[1] * slope[2]});
  }
  return g;
}

// Pieces, and the nodes that neighboring pieces share.
void Builder::connect() {
  const std::size_t n = rest_.size();
  place_.resize(n);
  for (std::size_t i = 0; i < n; ++i) place_[i] = place_of(rest_[i]);
  DisjointSets together(n);
  const auto for_each_edge = [&](const auto& f) {
    for (const Corners& tet : corners_)
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4; ++b) f(tet[a], tet[b]);
  };
  for_each_edge([&](std::uint32_t i, std::uint32_t j) {
    if (place_[i] == place_[j]) together.join(i, j);
  });
  piece_.assign(n, no_index);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t root = together.root(i);
    if (root == i)
      piece_[i] = static_cast<std::uint32_t>(piece_place_.size()), piece_place_.push_back(place_[i]);
    piece_[i] = piece_[root];
  }
  DisjointSets same(piece_place_.size() * lattice_corners);
  std::vector<std::uint64_t> neighbors;
  for_each_edge([&](std::uint32_t i, std::uint32_t j) {
    const std::uint32_t a = piece_[i], b = piece_[j];
    if (a != b) neighbors.push_back(std::uint64_t{std::min(a, b)} << 32 | std::max(a, b));
  });
  std::sort(neighbors.begin(), neighbors.end());
  neighbors.erase(std::unique(neighbors.begin(), neighbors.end()), neighbors.end());
  for (const std::uint64_t pair : neighbors) {
    const auto a = static_cast<std::uint32_t>(pair >> 32), b = static_cast<std::uint32_t>(pair);
    for (std::size_t c = 0; c < lattice_corners; ++c) {
      std::size_t other = 0;
      bool shared = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int at = piece_place_[a][axis] + bit(c, axis) - piece_place_[b][axis];
        shared = shared && (at == 0 || at == 1);
        other |= static_cast<std::size_t>(at & 1) << axis;
      }
      if (shared)
        same.join(static_cast<std::uint32_t>(a * lattice_corners + c),
                  static_cast<std::uint32_t>(b * lattice_corners + other));
    }
  }
  piece_node_.assign(piece_place_.size() * lattice_corners, no_index);
  for (std::uint32_t k = 0; k < piece_node_.size(); ++k) {
    const std::uint32_t root = same.root(k);
    if (root == k) piece_node_[k] = static_cast<std::uint32_t>(lattice_.node_count++);
    piece_node_[k] = piece_node_[root];
  }
}

void Builder::number_nodes() {
  lattice_.parent.resize(rest_.size());
  lattice_.weight.resize(rest_.size());
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    for (std::size_t c = 0; c < lattice_corners; ++c)
      lattice_.parent[i][c] = piece_node_[piece_[i] * lattice_corners + c];
    lattice_.weight[i] = weights(within(rest_[i], place_[i]));
  }
}

// The cell of the piece that a tet belongs to: where its center lies, if one of its particles does as well.
std::uint32_t Builder::cell_of(const Corners& tet, const Vec3d& center) {
  const Place place = place_of(center);
  std::uint32_t piece = piece_[tet[0]];
  for (const std::uint32_t i : tet)
    if (place_[i] == place) {
      piece = piece_[i];
      break;
    }
  if (piece_cell_[piece] == no_index) {
    piece_cell_[piece] = static_cast<std::uint32_t>(lattice_.cells.size());
    cell_place_.push_back(piece_place_[piece]);
    lattice_.cells.emplace_back();
    for (std::size_t c = 0; c < lattice_corners; ++c)
      lattice_.cells.back().node[c] = piece_node_[piece * lattice_corners + c];
  }
  return piece_cell_[piece];
}

// Let g_a be the gradients of the shape functions at the center of a tet of volume V, and T_ab = sum V g_a g_b^T. Then
// small strain gives K_ab = mu (trace(T_ab) 1 + T_ab^T) + lambda T_ab. The products of gradients are quadratic along
// each axis. So a sum over 27 points, among which Lagrange's polynomials divide each tet's volume, is equal and five
// times as fast.
void Builder::add_stiffness() {
  piece_cell_.assign(piece_place_.size(), no_index);
  tet_cell_.resize(corners_.size());
  lattice_.stiffness.assign(rest_.size(), 0);
  std::vector<std::array<float, points * points * points>> volumes;
  for (std::size_t t = 0; t < corners_.size(); ++t) {
    const Corners& tet = corners_[t];
    const Vec3d center = (rest_[tet[0]] + rest_[tet[1]] + rest_[tet[2]] + rest_[tet[3]]) * 0.25;
    const std::uint32_t cell = tet_cell_[t] = cell_of(tet, center);
    if (cell == volumes.size()) volumes.emplace_back();
    const Mat3f B = set_.params(tets_[t]).rest_inverse, edges = transpose(B);
    const float volume = 1 / (6 * std::fabs(determinant(B)));
    divide(volume, within(center, cell_place_[cell]), volumes[cell]);
    const auto alpha = set_.compliance(tets_[t]);
    lattice_.cells[cell].shear += 1 / alpha[0], lattice_.cells[cell].bulk += 1 / alpha[2];
    const Vec3f first = edges.column[0] + edges.column[1] + edges.column[2];
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3f b = k == 0 ? first : edges.column[k - 1];
      lattice_.stiffness[tet[k]] += (2 / alpha[0] + 1 / alpha[2]) * dot(b, b);
    }
  }
  lattice_.cell_stiffness.resize(volumes.size());
  for (std::size_t c = 0; c < volumes.size(); ++c) integrate(c, volumes[c]);
}

void Builder::divide(float volume, const Vec3d& u, std::array<float, points * points * points>& volumes) {
  float l[3][points];
  for (int axis = 0; axis < 3; ++axis) {
    const auto s = static_cast<float>(u[axis]);
    l[axis][0] = (2 * s - 1) * (s - 1), l[axis][1] = 4 * s * (1 - s), l[axis][2] = s * (2 * s - 1);
  }
  for (std::size_t z = 0, k = 0; z < points; ++z)
    for (std::size_t y = 0; y < points; ++y)
      for (std::size_t x = 0; x < points; ++x) volumes[k++] += volume * l[0][x] * l[1][y] * l[2][z];
}

void Builder::integrate(std::size_t cell, const std::array<float, points * points * points>& volumes) {
  constexpr std::size_t n = 3 * lattice_corners;
  std::array<std::array<float, n>, n> T{};
  float total = 0;
  for (std::size_t k = 0; k < volumes.size(); ++k) {
    const std::size_t x = k % points, y = k / points % points, z = k / (points * points);
    const Vec3d point{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
    const std::array<Vec3f, lattice_corners> g = gradients(point * 0.5);
    std::array<float, n> row{};
    for (std::size_t c = 0; c < lattice_corners; ++c)
      row[3 * c] = g[c].x, row[3 * c + 1] = g[c].y, row[3 * c + 2] = g[c].z;
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t q = 0; q < n; ++q) T[p][q] += volumes[k] * row[p] * row[q];
    total += volumes[k];
  }
  const float shear = lattice_.cells[cell].shear /= total, bulk = lattice_.cells[cell].bulk /= total;
  for (std::size_t p = 0, k = 0; p < n; ++p)
    for (std::size_t q = 0; q <= p; ++q, ++k) {
      const std::size_t a = p / 3 * 3, b = q / 3 * 3, i = p % 3, j = q % 3;
      const float trace = i == j ? T[a][b] + T[a + 1][b + 1] + T[a + 2][b + 2] : 0;
      lattice_.cell_stiffness[cell][k] = shear * (trace + T[a + j][b + i]) + bulk * T[p][q];
    }
}

void Builder::add_samples() {
  const Lists<std::uint32_t> tets_of(lattice_.cells.size(), [&](const auto& add) {
    for (std::uint32_t t = 0; t < tets_.size(); ++t) add(tet_cell_[t], t);
  });
  std::vector<std::uint32_t> seen(rest_.size(), no_index), candidates;
  for (std::uint32_t c = 0; c < lattice_.cells.size(); ++c) {
    candidates.clear();
    for (const std::uint32_t t : tets_of[c])
      for (const std::uint32_t i : corners_[t])
        if (std::exchange(seen[i], c) != c) candidates.push_back(i);
    choose_samples(c, candidates);
  }
}

// The particles nearest to the corners of the candidates' bounding box; all of them if those lie in a plane.
void Builder::choose_samples(std::size_t cell, std::span<const std::uint32_t> candidates) {
  Vec3d low = rest_[candidates[0]], high = low;
  for (const std::uint32_t i : candidates)
    for (int axis = 0; axis < 3; ++axis)
      low[axis] = std::min(low[axis], rest_[i][axis]), high[axis] = std::max(high[axis], rest_[i][axis]);
  const std::size_t first = lattice_.sample.size();
  lattice_.cells[cell].sample_begin = static_cast<std::uint32_t>(first);
  for (std::size_t c = 0; c < lattice_corners; ++c) {
    const Vec3d corner{bit(c, 0) != 0 ? high.x : low.x, bit(c, 1) != 0 ? high.y : low.y,
                       bit(c, 2) != 0 ? high.z : low.z};
    const auto distance = [&](std::uint32_t i) { return dot(rest_[i] - corner, rest_[i] - corner); };
    const std::uint32_t nearest =
        *std::min_element(candidates.begin(), candidates.end(),
                          [&](std::uint32_t i, std::uint32_t j) { return distance(i) < distance(j); });
    const auto begin = lattice_.sample.begin() + static_cast<std::ptrdiff_t>(first);
    if (std::find(begin, lattice_.sample.end(), nearest) == lattice_.sample.end())
      lattice_.sample.push_back(nearest);
  }
  if (!fit_gradients(first)) {
    lattice_.sample.resize(first);
    lattice_.sample.insert(lattice_.sample.end(), candidates.begin(), candidates.end());
    fit_gradients(first);
  }
  lattice_.cells[cell].sample_end = static_cast<std::uint32_t>(lattice_.sample.size());
}

// The least-squares fit x = F X: F = (sum x Y^T) (sum Y Y^T)^-1 with Y relative to the mean of X. Returns whether
// the samples span a volume.
bool Builder::fit_gradients(std::size_t begin) {
  const std::span<const std::uint32_t> samples(lattice_.sample.data() + begin,
                                               lattice_.sample.size() - begin);
  Vec3d mean{};
  for (const std::uint32_t i : samples) mean += rest_[i] * (1 / static_cast<double>(samples.size()));
  Mat3d moment{};
  for (const std::uint32_t i : samples) moment = moment + outer(rest_[i] - mean, rest_[i] - mean);
  const double size = trace(moment) / 3;
  const bool spans = determinant(moment) > 1e-4 * size * size * size;
  lattice_.gradient.resize(begin);
  for (const std::uint32_t i : samples)
    lattice_.gradient.push_back(spans ? Vec3f(inverse(moment) * (rest_[i] - mean)) : Vec3f{});
  return spans;
}

}  // namespace

TetLattice build_tet_lattice(const ConstraintSet<NeoHookean>& set, std::span<const std::uint32_t> tets) {
  return Builder(set, tets).build();
}

}  // namespace souple
