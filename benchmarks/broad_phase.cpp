// Spatial hashing beside bounding volume hierarchies that are rebuilt, or refitted, in every step: all pairs of
// overlapping boxes of n moving triangles, one thread.
//
//   broad_phase [MOST]    n = 1000, 2000, 5000, ... up to MOST, 500,000 by default
//
// Soups of triangles that fly in random directions through a box with walls. One has triangles of one size. Another has
// sizes from 1 to 30, where every factor of two in size covers the same volume. A triangle meets four others on
// average, with many sizes two. Neighbors in space are near in memory, as in objects that were renumbered; in a third
// soup the order is random. Times are milliseconds of processor time a step, the median of five steps, in turn. Prints
// JSON.

#include "souple/broad_phase/spatial_hash.h"
#include "souple/simd/instruction_set.h"
#include "souple/threads/threads.h"
#include "tests/collision/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace souple;

// --- triangles

struct Soup {
  std::vector<std::array<Vec3f, 3>> corner;  // relative to the center
  std::vector<Vec3f> center, velocity;
  std::vector<Bounds> box;
  float side = 1;  // of the walls [m]

  void find_boxes() {
    box.resize(center.size());
    for (std::size_t i = 0; i < center.size(); ++i) {
      box[i] = {center[i] + corner[i][0], center[i] + corner[i][0]};
      for (const Vec3f& p : corner[i]) box[i] = united(box[i], {center[i] + p, center[i] + p});
    }
  }
  void move(float dt) {
    for (std::size_t i = 0; i < center.size(); ++i) {
      center[i] += velocity[i] * dt;
      for (int axis = 0; axis < 3; ++axis)
        if (center[i][axis] < 0 || center[i][axis] > side) velocity[i][axis] = -velocity[i][axis];
    }
    find_boxes();
  }
};

/// Bits of a number in [0, 1024), with two zeros between them.
std::uint32_t spread(float x) {
  auto v = static_cast<std::uint32_t>(std::clamp(x, 0.f, 1023.f));
  v = (v | v << 16) & 0x030000ff;
  v = (v | v << 8) & 0x0300f00f;
  v = (v | v << 4) & 0x030c30c3;
  return (v | v << 2) & 0x09249249;
}

std::uint32_t morton_code(const Vec3f& x) {
  return spread(x.x) << 2 | spread(x.y) << 1 | spread(x.z);
}

struct Kind {
  const char* sizes;
  bool many_sizes, ordered;
};
constexpr Kind kinds[] = {
    {"equal", false, true}, {"1 to 30", true, true}, {"equal, in random order", false, false}};

Soup soup(std::size_t n, const Kind& kind) {
  test::Random random(7);
  std::vector<double> sizes;
  double volume = 0;
  for (std::size_t i = 0; i < n; ++i) {
    // Density of sizes ~ size^-4, so that each factor of two has the same volume.
    const double u = random.uniform(0, 1), largest = 30;
    sizes.push_back(kind.many_sizes ? std::pow(1 - u * (1 - std::pow(largest, -3)), -1.0 / 3) : 1);
    volume += sizes.back() * sizes.back() * sizes.back();
  }
  Soup result;
  result.side = static_cast<float>(std::cbrt(volume * (kind.many_sizes ? 0.35 : 0.25)));
  for (std::size_t i = 0; i < n; ++i)
    result.center.emplace_back(random.point(0, static_cast<double>(result.side)));
  const float scale = 1023 / result.side;
  if (kind.ordered)
    std::sort(result.center.begin(), result.center.end(), [&](const Vec3f& a, const Vec3f& b) {
      return morton_code(a * scale) < morton_code(b * scale);
    });
  for (std::size_t i = 0; i < n; ++i) {
    result.corner.emplace_back();
    for (Vec3f& p : result.corner.back()) p = Vec3f(random.point(-0.5, 0.5) * sizes[i]);
    result.velocity.emplace_back(random.point(-1, 1));
  }
  result.find_boxes();
  return result;
}

// --- trees

/// A binary tree over boxes in an order of space. A node's left half comes first; leaves have up to four boxes.
class Tree {
 public:
  /// Sorts by Morton codes of the centers (Lauterbach et al. 2009).
  void build_by_morton(const std::vector<Bounds>& boxes, float side) {
    keys_.resize(boxes.size());
    const float scale = 1023 / side;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      const Vec3f c = (boxes[i].lo + boxes[i].hi) * (0.5f * scale);
      keys_[i] = {morton_code(c), i};
    }
    sort_keys();
    order_.resize(boxes.size());
    for (std::size_t i = 0; i < keys_.size(); ++i) order_[i] = keys_[i].index;
    lay_out(boxes);
  }
  /// Splits at the median of the centers along the longest side.
  void build_by_median(const std::vector<Bounds>& boxes) {
    order_.resize(boxes.size());
    for (std::uint32_t i = 0; i < boxes.size(); ++i) order_[i] = i;
    split(boxes, 0, order_.size());
    lay_out(boxes);
  }
  /// Keeps the order.
  void refit(const std::vector<Bounds>& boxes) { lay_out(boxes); }

  std::size_t count_pairs() const {
    std::size_t pairs = 0;
    std::uint32_t stack[64];
    for (std::uint32_t i = 0; i < sorted_.size(); ++i) {
      int top = 0;
      stack[top++] = 0;
      while (top > 0) {
        const Node& node = nodes_[stack[--top]];
        if (node.end <= i + 1 || !overlap(node.box, sorted_[i])) continue;  // each pair once
        if (node.right != 0) {
          stack[top++] = node.right;
          stack[top++] = static_cast<std::uint32_t>(&node - nodes_.data()) + 1;
          continue;
        }
        for (std::uint32_t j = std::max(node.begin, i + 1); j < node.end; ++j)
          pairs += overlap(sorted_[i], sorted_[j]) ? 1 : 0;
      }
    }
    return pairs;
  }

 private:
  static constexpr std::size_t leaf = 4;
  struct Node {
    Bounds box;
    std::uint32_t begin, end, right;  // right: index of the right child, 0 for a leaf
  };
  struct Key {
    std::uint32_t code, index;
  };

  // Radix sort, three passes of ten bits.
  void sort_keys() {
    other_.resize(keys_.size());
    for (int shift = 0; shift < 30; shift += 10) {
      std::array<std::uint32_t, 1025> begin{};
      for (const Key& key : keys_) ++begin[(key.code >> shift & 1023) + 1];
      for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
      for (const Key& key : keys_) other_[begin[key.code >> shift & 1023]++] = key;
      keys_.swap(other_);
    }
  }
  void split(const std::vector<Bounds>& boxes, std::size_t begin, std::size_t end) {
    if (end - begin <= leaf) return;
    Bounds around = boxes[order_[begin]];
    for (std::size_t i = begin; i < end; ++i) around = united(around, boxes[order_[i]]);
    const Vec3f size = around.hi - around.lo;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      return boxes[a].lo[axis] + boxes[a].hi[axis] < boxes[b].lo[axis] + boxes[b].hi[axis];
    });
    split(boxes, begin, middle);
    split(boxes, middle, end);
  }
  void lay_out(const std::vector<Bounds>& boxes) {
    sorted_.resize(boxes.size());
    for (std::size_t i = 0; i < order_.size(); ++i) sorted_[i] = boxes[order_[i]];
    nodes_.clear();
    lay_out(0, static_cast<std::uint32_t>(sorted_.size()));
  }
  Bounds lay_out(std::uint32_t begin, std::uint32_t end) {
    const std::size_t at = nodes_.size();
    nodes_.push_back({sorted_[begin], begin, end, 0});
    Bounds box = sorted_[begin];
    if (end - begin <= leaf) {
      for (std::uint32_t i = begin; i < end; ++i) box = united(box, sorted_[i]);
    } else {
      const std::uint32_t middle = begin + (end - begin) / 2;
      box = lay_out(begin, middle);
      nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
      box = united(box, lay_out(middle, end));
    }
    return nodes_[at].box = box;
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
  std::vector<Bounds> sorted_;
  std::vector<Key> keys_, other_;
};

// --- measurement

struct Times {
  std::vector<double> build, query;
  std::size_t pairs = 0;
};

// Processor time.
double milliseconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

template <class Build, class Query>
void measure(Times& times, const Build& build, const Query& query) {
  const double start = milliseconds();
  build();
  const double built = milliseconds();
  times.pairs = query();
  times.build.push_back(built - start);
  times.query.push_back(milliseconds() - built);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

constexpr const char* methods[] = {"spatial hash", "tree, rebuilt by Morton codes",
                                   "tree, rebuilt by medians", "tree, refitted"};

std::array<Times, 4> measure(std::size_t n, const Kind& kind) {
  constexpr int warm_up = 2, steps = 5;
  Soup triangles = soup(n, kind);
  const std::unique_ptr<Threads> threads = make_threads(Threading::serial, 1);
  SpatialHash hash;
  Tree morton, medians, refitted;
  refitted.build_by_median(triangles.box);
  std::vector<std::uint32_t> found;
  std::array<Times, 4> times;
  for (int step = 0; step < warm_up + steps; ++step) {
    if (step == warm_up) times = {};
    triangles.move(0.05f);
    measure(
        times[0], [&] { hash.build(triangles.box, SpatialHash::choose_cell_size(triangles.box), *threads); },
        [&] {
          std::size_t pairs = 0;
          for (std::uint32_t i = 0; i < n; ++i) {
            found.clear();
            hash.find_partners(i, found);
            pairs += found.size();
          }
          return pairs;
        });
    const auto of = [](const Tree& tree) { return [&tree] { return tree.count_pairs(); }; };
    measure(
        times[1], [&] { morton.build_by_morton(triangles.box, triangles.side); }, of(morton));
    measure(
        times[2], [&] { medians.build_by_median(triangles.box); }, of(medians));
    measure(
        times[3], [&] { refitted.refit(triangles.box); }, of(refitted));
  }
  return times;
}

}  // namespace

int main(int argc, char** argv) {
  const double most = argc > 1 ? std::atof(argv[1]) : 5e5;
  std::printf("{\"simd\": \"%s\", \"results\": [", std::string(simd_name()).c_str());
  bool first = true;
  for (const Kind& kind : kinds)
    for (double decade = 1000; decade <= most; decade *= 10)
      for (const double part : {1.0, 2.0, 5.0}) {
        const auto n = static_cast<std::size_t>(decade * part);
        if (static_cast<double>(n) > most) continue;
        const std::array<Times, 4> times = measure(n, kind);
        for (std::size_t k = 0; k < times.size(); ++k) {
          std::printf(
              "%s\n {\"sizes\": \"%s\", \"method\": \"%s\", \"triangles\": %zu, \"pairs\": %zu, "
              "\"build_ms\": %.4g, \"query_ms\": %.4g}",
              first ? "" : ",", kind.sizes, methods[k], n, times[k].pairs, median(times[k].build),
              median(times[k].query));
          first = false;
        }
        std::fflush(stdout);
      }
  std::printf("]}\n");
}
