#include "souple/collision/near_pairs.h"

#include "souple/error.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <chrono>
#include <limits>

namespace souple {
namespace {

constexpr std::size_t chunk_size = 1024;  // items of which one thread finds the pairs in one go
constexpr std::size_t box_grain = 1024;   // boxes worth a thread

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// A comparison with what is not a number is false: whatever is united with an endless box is left out.
Bounds clean(const Bounds& box) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const bool fine = box.lo.x <= box.hi.x && box.lo.y <= box.hi.y && box.lo.z <= box.hi.z;
  return fine ? box : Bounds{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
}

bool is_finite(const Bounds& box) {
  return souple::is_finite(box.lo) && souple::is_finite(box.hi);
}

void require(bool large_enough, const char* what, std::size_t is, std::size_t expected) {
  if (!large_enough)
    throw Error(std::string("NearPairFinder: ") + what + " has " + std::to_string(is) + ", elements name " +
                std::to_string(expected) + "; give one for each");
}

}  // namespace

// Room for more pairs behind those that are there.
NearPair* NearPairFinder::Part::room_for(std::size_t more) {
  if (count + more > pairs.size()) pairs.resize(2 * (count + more));
  return pairs.data() + count;
}

void NearPairFinder::find(const SurfaceElements& elements, std::span<const Bounds> boxes,
                          const ObjectMatrix& meets, std::span<const Vec4f> position_w, NearPairs& out,
                          Threads& threads) {
  const std::size_t particles = elements.particle_end();
  require(boxes.size() >= particles, "boxes", boxes.size(), particles);
  require(position_w.size() >= particles, "position_w", position_w.size(), particles);
  require(meets.size() >= elements.object_end(), "meets", meets.size(), elements.object_end());
  elements_ = &elements;
  meets_ = &meets;
  const Wakefulness awake(threads);
  auto start = Clock::now();
  clean_boxes_.resize(particles);
  threads.for_each(particles, box_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) clean_boxes_[i] = clean(boxes[i]);
  });
  make_boxes(position_w, threads);
  milliseconds_.boxes = milliseconds_since(start);

  start = Clock::now();
  build(threads);
  milliseconds_.build = milliseconds_since(start);

  start = Clock::now();
  const std::size_t vertices = vertex_boxes_.size();
  collect(
      vertices + (vertices_.size() > 0 ? triangle_boxes_.size() : 0),
      [&](std::size_t i, Part& part) {
        if (i < vertices) {
          triangles_near(static_cast<std::uint32_t>(i), part);
        } else {
          larger_vertices_near(static_cast<std::uint32_t>(i - vertices), part);
        }
      },
      out.vertex_triangle, threads);
  collect(
      edge_boxes_.size(), [&](std::size_t i, Part& part) { edges_near(static_cast<std::uint32_t>(i), part); },
      out.edge_edge, threads);
  milliseconds_.pairs = milliseconds_since(start);
}

void NearPairFinder::make_boxes(std::span<const Vec4f> position_w, Threads& threads) {
  const std::span<const Bounds> boxes = clean_boxes_;
  const auto moves = [&](std::uint32_t i) { return position_w[i].w > 0; };
  const std::span<const std::uint32_t> vertices = elements_->vertices();
  vertex_boxes_.resize(vertices.size());
  vertex_moves_.resize(vertices.size());
  threads.for_each(vertices.size(), box_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      vertex_boxes_[v] = boxes[vertices[v]];
      vertex_moves_[v] = moves(vertices[v]);
    }
  });
  const std::span<const Edge> edges = elements_->edges();
  edge_boxes_.resize(edges.size());
  edge_moves_.resize(edges.size());
  threads.for_each(edges.size(), box_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const auto [a, b] = edges[e];
      edge_boxes_[e] = united(boxes[a], boxes[b]);
      edge_moves_[e] = moves(a) || moves(b);
    }
  });
  const std::span<const SurfaceElement> triangles = elements_->triangles();
  triangle_boxes_.resize(triangles.size());
  triangle_moves_.resize(triangles.size());
  threads.for_each(triangles.size(), box_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto& [a, b, c] = triangles[t].particle;
      triangle_boxes_[t] = united(united(boxes[a], boxes[b]), boxes[c]);
      triangle_moves_[t] = moves(a) || moves(b) || moves(c);
    }
  });
}

void NearPairFinder::build(Threads& threads) {
  const float cell_size = SpatialHash::choose_cell_size(triangle_boxes_);
  triangles_.build(triangle_boxes_, cell_size, threads);
  edges_.build(edge_boxes_, SpatialHash::choose_cell_size(edge_boxes_), threads);
  // A vertex looks for triangles as large as itself; only triangles among larger vertices must look for them.
  const bool larger = std::any_of(vertex_boxes_.begin(), vertex_boxes_.end(),
                                  [&](const Bounds& box) { return triangles_.larger_than_some(box); });
  vertices_.build(larger ? std::span<const Bounds>(vertex_boxes_) : std::span<const Bounds>(), cell_size,
                  threads);
  const auto finite = std::count_if(vertex_boxes_.begin(), vertex_boxes_.end(),
                                    [](const Bounds& box) { return is_finite(box); });
  left_out_ =
      triangles_.left_out() + edges_.left_out() + vertex_boxes_.size() - static_cast<std::size_t>(finite);
}

// Whether a vertex and a triangle are a pair that counts is known only late and hard to foresee: each is
// written, and overwritten by the next when it is none.

void NearPairFinder::triangles_near(std::uint32_t vertex, Part& part) const {
  part.found.clear();
  triangles_.find(vertex_boxes_[vertex], SpatialHash::Sizes::as_large_or_larger, part.found);
  const std::uint32_t p = elements_->vertices()[vertex], object = elements_->vertex_objects()[vertex];
  const bool moves = vertex_moves_[vertex] != 0;
  NearPair* const pairs = part.room_for(part.found.size());
  std::size_t count = 0;
  for (const std::uint32_t t : part.found) {
    const SurfaceElement& triangle = elements_->triangles()[t];
    const auto& [a, b, c] = triangle.particle;
    pairs[count] = {{p, a, b, c}};
    count += static_cast<std::size_t>((moves | (triangle_moves_[t] != 0)) & (p != a) & (p != b) & (p != c) &
                                      meets_->at(object, triangle.object));
  }
  part.count += count;
}

void NearPairFinder::larger_vertices_near(std::uint32_t t, Part& part) const {
  part.found.clear();
  vertices_.find(triangle_boxes_[t], SpatialHash::Sizes::larger, part.found);
  const SurfaceElement& triangle = elements_->triangles()[t];
  const auto& [a, b, c] = triangle.particle;
  NearPair* const pairs = part.room_for(part.found.size());
  std::size_t count = 0;
  for (const std::uint32_t vertex : part.found) {
    const std::uint32_t p = elements_->vertices()[vertex], object = elements_->vertex_objects()[vertex];
    pairs[count] = {{p, a, b, c}};
    count += static_cast<std::size_t>(((vertex_moves_[vertex] | triangle_moves_[t]) != 0) & (p != a) &
                                      (p != b) & (p != c) & meets_->at(object, triangle.object));
  }
  part.count += count;
}

void NearPairFinder::edges_near(std::uint32_t edge, Part& part) const {
  part.found.clear();
  edges_.find_partners(edge, part.found);
  const auto [a, b] = elements_->edges()[edge];
  const std::uint32_t object = elements_->edge_objects()[edge];
  const bool moves = edge_moves_[edge] != 0;
  NearPair* const pairs = part.room_for(part.found.size());
  std::size_t count = 0;
  for (const std::uint32_t other : part.found) {
    const auto [c, d] = elements_->edges()[other];
    pairs[count] = {{a, b, c, d}};
    count += static_cast<std::size_t>((moves | (edge_moves_[other] != 0)) & (a != c) & (a != d) & (b != c) &
                                      (b != d) & meets_->at(object, elements_->edge_objects()[other]));
  }
  part.count += count;
}

// Chunks of items go to the parts in turn, so that each has its share of crowded places; then their pairs are
// put one after the other in order of chunks.
template <class Function>
void NearPairFinder::collect(std::size_t items, const Function& pairs_of, std::vector<NearPair>& out,
                             Threads& threads) {
  chunks_.resize((items + chunk_size - 1) / chunk_size);
  const std::size_t parts =
      std::clamp<std::size_t>(chunks_.size(), 1, static_cast<std::size_t>(threads.count()));
  if (parts_.size() < parts) parts_.resize(parts);
  threads.for_each(parts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      Part& part = parts_[p];
      part.count = 0;
      for (std::size_t k = p; k < chunks_.size(); k += parts) {
        const std::size_t first = part.count, last = std::min(items, (k + 1) * chunk_size);
        for (std::size_t i = k * chunk_size; i < last; ++i) pairs_of(i, part);
        chunks_[k] = {first, part.count - first, 0};
      }
    }
  });
  std::size_t sum = 0;
  for (Chunk& chunk : chunks_) {
    chunk.place = sum;
    sum += chunk.count;
  }
  resize_with_room(out, sum);
  threads.for_each(chunks_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      std::copy_n(parts_[k % parts].pairs.data() + chunks_[k].begin, chunks_[k].count,
                  out.data() + chunks_[k].place);
  });
}

std::size_t NearPairFinder::bytes() const {
  std::size_t sum = bytes_of(clean_boxes_, triangle_boxes_, edge_boxes_, vertex_boxes_, triangle_moves_,
                             edge_moves_, vertex_moves_, parts_, chunks_) +
                    triangles_.bytes() + edges_.bytes() + vertices_.bytes();
  for (const Part& part : parts_) sum += bytes_of(part.pairs, part.found);
  return sum;
}

}  // namespace souple
