#include "souple/broad_phase/near_pairs.h"

#include "souple/broad_phase/kernels/find_kernels.h"
#include "souple/error.h"
#include "souple/math/sentinels.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <numeric>

#include <fmt/core.h>

namespace souple {
namespace {

constexpr std::size_t patches_per_chunk = 128;  // patches of a chunk
constexpr std::size_t box_grain = 1024;         // least number of boxes that pays for a thread

using Clock = std::chrono::steady_clock;

constexpr Bounds infinite_box{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// A box around an infinite box is infinite, and the search skips it.
Bounds finite_or_infinite(const Bounds& box) {
  return is_finite(box) ? box : infinite_box;
}

void require(std::size_t is, std::size_t expected, const char* what) {
  if (is < expected)
    throw Error(fmt::format("NearPairFinder: {} has {} entries, elements refer to {}; pass one for each",
                            what, is, expected));
}

kernels::BoxGroup group(std::uint32_t begin, std::uint32_t count, const Bounds& box, std::uint32_t marked) {
  return {begin, count, {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z}, marked};
}

// Kinds of patches without triangles: of grains, and of a rope's edges.
bool is_particles_only(const SurfacePatch& patch) {
  return patch.triangles == 0 && patch.edges == 0;
}
bool is_edges_only(const SurfacePatch& patch) {
  return patch.triangles == 0 && patch.edges > 0;
}

// Keeps the pairs with a particle that can move, in order. Returns their number.
std::size_t keep_moving(kernels::Quad* pairs, std::size_t count, std::span<const Vec4f> position_w) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool moves =
        std::any_of(pairs[i], pairs[i] + 4, [&](std::uint32_t p) { return position_w[p].w > 0; });
    std::copy_n(pairs[i], 4, pairs[kept]);
    kept += moves ? 1 : 0;
  }
  return kept;
}

}  // namespace

kernels::Quad* NearPairFinder::List::grow_capacity(std::size_t more) {
  if (count + more > pairs.size()) pairs.resize(2 * (count + more));
  return &pairs[count].particle;
}

void NearPairFinder::Boxes::resize(std::size_t count) {
  for (auto* columns : {&lo, &hi})
    for (auto& column : *columns) resize_with_spare(column, count + SurfaceElements::padding);
}

void NearPairFinder::Boxes::set(std::size_t i, const Bounds& box) {
  lo[0][i] = box.lo.x, lo[1][i] = box.lo.y, lo[2][i] = box.lo.z;
  hi[0][i] = box.hi.x, hi[1][i] = box.hi.y, hi[2][i] = box.hi.z;
}

kernels::BoxColumns NearPairFinder::Boxes::columns() const {
  return {{lo[0].data(), lo[1].data(), lo[2].data()}, {hi[0].data(), hi[1].data(), hi[2].data()}, {}};
}

void NearPairFinder::begin(const SurfaceElements& elements, std::span<const Bounds> boxes,
                           std::span<const Vec4f> position_w, Threads& threads) {
  require(boxes.size(), elements.particle_end(), "boxes");
  require(position_w.size(), elements.particle_end(), "position_w");
  elements_ = &elements;
  kernels_ = &kernels::find_patch_kernels(instruction_set());
  make_boxes(boxes, position_w, threads);
  find_own_patches();
  marks_.assign(elements.patches().size(), {});
  is_moving_.assign(elements.particle_end(), 0);
}

bool NearPairFinder::find(const SurfaceElements& elements, std::span<const Bounds> boxes,
                          const ObjectFilter& compares, std::span<const Vec4f> position_w, NearPairs& out,
                          Threads& threads, std::size_t most) {
  const ActiveScope awake(threads);
  auto start = Clock::now();
  begin(elements, boxes, position_w, threads);
  milliseconds_.boxes = milliseconds_since(start);

  start = Clock::now();
  hash_.build(patch_boxes_, SpatialHash::choose_cell_size(patch_boxes_), threads);
  milliseconds_.build = milliseconds_since(start);

  start = Clock::now();
  const std::size_t patches = patch_boxes_.size();
  find_partners(compares, threads);
  const bool complete =
      find_in_chunks(patches, patches_per_chunk, most, out, threads, [&](std::size_t a, Part& part) {
        find_near(static_cast<std::uint32_t>(a), compares, position_w, part);
      });
  milliseconds_.pairs = milliseconds_since(start);
  return complete;
}

// Fills partners_. Grids list a pair at the smaller box, and which grids there are depends on all boxes. Here it is listed at
// the lower patch, so that the order of pairs depends on nothing but their own objects.
void NearPairFinder::find_partners(const ObjectFilter& compares, Threads& threads) {
  const std::size_t patches = patch_boxes_.size(), chunks = chunks_.size();
  if (overlaps_.size() < chunks) overlaps_.resize(chunks);
  threads.each(chunks, 1, [&](std::size_t c) {
    Overlaps& own = overlaps_[c];
    own.pairs.clear();
    for (std::size_t k = c * patches_per_chunk; k < std::min(patches, (c + 1) * patches_per_chunk); ++k) {
      const auto a = static_cast<std::uint32_t>(k);
      own.found.clear();
      hash_.find_partners(a, skipped(a, compares), own.found);
      for (const std::uint32_t b : own.found) own.pairs.push_back({std::min(a, b), std::max(a, b)});
    }
  });
  partners_begin_.assign(patches + 1, 0);
  for (std::size_t c = 0; c < chunks; ++c)
    for (const auto& pair : overlaps_[c].pairs) ++partners_begin_[pair[0] + 1];
  for (std::size_t a = 0; a < patches; ++a) partners_begin_[a + 1] += partners_begin_[a];
  resize_with_spare(partners_, partners_begin_[patches]);
  next_partner_.assign(partners_begin_.begin(), partners_begin_.end());
  for (std::size_t c = 0; c < chunks; ++c)
    for (const auto& pair : overlaps_[c].pairs) partners_[next_partner_[pair[0]]++] = pair[1];
  threads.each(patches, patches_per_chunk, [&](std::size_t a) {
    std::sort(partners_.data() + partners_begin_[a], partners_.data() + partners_begin_[a + 1]);
  });
}

// Calls find_one(k, part) for k in [0, count). Parts take chunks in rotation, so that crowded regions are
// distributed among them. Pairs are in order of k. Whether there are more than `most` does not depend on the order in
// which threads find them: the sum only grows.
template <class Function>
bool NearPairFinder::find_in_chunks(std::size_t count, std::size_t per_chunk, std::size_t most,
                                    NearPairs& out, Threads& threads, const Function& find_one) {
  chunks_.resize((count + per_chunk - 1) / per_chunk);
  const std::size_t parts =
      std::clamp<std::size_t>(chunks_.size(), 1, static_cast<std::size_t>(threads.count()));
  if (parts_.size() < parts) parts_.resize(parts);
  std::atomic<std::size_t> sum = 0;
  threads.for_each(parts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      Part& part = parts_[p];
      part.vertex_triangle.count = part.edge_edge.count = 0;
      std::size_t counted = 0;
      const auto exceeds = [&] {
        const std::size_t found = part.vertex_triangle.count + part.edge_edge.count;
        const std::size_t before = sum.fetch_add(found - counted, std::memory_order_relaxed);
        const bool more = before + (found - counted) > most;
        counted = found;
        return more;
      };
      for (std::size_t c = p; c < chunks_.size(); c += parts) {
        const std::size_t first_vertex_triangle = part.vertex_triangle.count,
                          first_edge = part.edge_edge.count;
        for (std::size_t k = c * per_chunk; k < std::min(count, (c + 1) * per_chunk); ++k) {
          find_one(k, part);
          if (most != unlimited && exceeds()) return;
        }
        chunks_[c] = {{first_vertex_triangle, part.vertex_triangle.count - first_vertex_triangle, 0},
                      {first_edge, part.edge_edge.count - first_edge, 0}};
      }
    }
  });
  if (sum > most) {
    out.vertex_triangle.clear(), out.edge_edge.clear();
    return false;
  }
  join(&Chunk::vertex_triangle, &Part::vertex_triangle, out.vertex_triangle, parts, threads);
  join(&Chunk::edge_edge, &Part::edge_edge, out.edge_edge, parts, threads);
  return true;
}

bool NearPairFinder::find_moved(std::span<const std::uint32_t> particles, std::span<const Bounds> boxes,
                                const ObjectFilter& compares, std::span<const Vec4f> position_w,
                                NearPairs& out, Threads& threads, std::size_t most) {
  for (const std::uint32_t i : particles)
    if (i < elements_->particle_end()) clean_boxes_[i] = finite_or_infinite(boxes[i]);
  mark(particles);
  for (const std::uint32_t a : moved_patches_) left_out_ += make_boxes_of(a, position_w);
  if (!moved_patches_.empty())
    hash_.build(patch_boxes_, SpatialHash::choose_cell_size(patch_boxes_), threads);
  constexpr std::size_t per_chunk = 16;
  const auto find_one = [&](std::size_t k, Part& part) {
    const std::uint32_t a = moved_patches_[k];
    part.found.clear();
    hash_.find(patch_boxes_[a], skipped(a, compares), part.found);
    for (const std::uint32_t b : part.found) {
      const Marks& of_b = marks_[b];
      const bool seen = b < a && (of_b.vertices | of_b.edges | of_b.triangles) != 0;
      if (!seen) find_between(a, marks_[a], b, of_b, compares, position_w, part);
    }
  };
  const bool complete = find_in_chunks(moved_patches_.size(), per_chunk, most, out, threads, find_one);
  unmark(particles);
  return complete;
}

// Objects were added one after the other, so an object's patches follow each other.
void NearPairFinder::find_own_patches() {
  const std::span<const SurfacePatch> patches = elements_->patches();
  own_patches_.resize(patches.size());
  for (std::uint32_t first = 0, last = 0; first < patches.size(); first = last) {
    while (last < patches.size() && patches[last].object == patches[first].object) ++last;
    std::fill(own_patches_.data() + first, own_patches_.data() + last, SpatialHash::Skip{first, last});
  }
}

// An object that is not compared with itself, such as a fluid, skips its own patches.
SpatialHash::Skip NearPairFinder::skipped(std::uint32_t patch, const ObjectFilter& compares) const {
  const std::uint32_t object = elements_->patches()[patch].object;
  return compares(object, object) ? SpatialHash::Skip{} : own_patches_[patch];
}

// Finds the patches that contain a given particle, and marks their items that do.
void NearPairFinder::mark(std::span<const std::uint32_t> particles) {
  moved_patches_.clear();
  for (const std::uint32_t i : particles) {
    if (i >= elements_->particle_end()) continue;
    is_moving_[i] = 1;
    for (const std::uint32_t p : elements_->patches_of(i)) moved_patches_.push_back(p);
  }
  std::sort(moved_patches_.begin(), moved_patches_.end());
  moved_patches_.erase(std::unique(moved_patches_.begin(), moved_patches_.end()), moved_patches_.end());
  const auto bits = [&](std::uint32_t first, std::uint32_t count, const auto& moves) {
    std::uint32_t marked = 0;
    for (std::uint32_t k = 0; k < count; ++k) marked |= moves(first + k) ? 1u << k : 0u;
    return marked;
  };
  for (const std::uint32_t a : moved_patches_) {
    const SurfacePatch& patch = elements_->patches()[a];
    marks_[a].vertices = bits(patch.first_vertex, patch.vertices,
                              [&](std::uint32_t v) { return is_moving_[elements_->vertices()[v]] != 0; });
    marks_[a].edges = bits(patch.first_edge, patch.edges, [&](std::uint32_t e) {
      const Edge& edge = elements_->edges()[e];
      return (is_moving_[edge[0]] | is_moving_[edge[1]]) != 0;
    });
    marks_[a].triangles = bits(patch.first_triangle, patch.triangles, [&](std::uint32_t t) {
      const auto& corner = elements_->triangles()[t].particle;
      return (is_moving_[corner[0]] | is_moving_[corner[1]] | is_moving_[corner[2]]) != 0;
    });
  }
}

void NearPairFinder::unmark(std::span<const std::uint32_t> particles) {
  for (const std::uint32_t i : particles)
    if (i < elements_->particle_end()) is_moving_[i] = 0;
  for (const std::uint32_t a : moved_patches_) marks_[a] = {};
}

void NearPairFinder::make_boxes(std::span<const Bounds> boxes, std::span<const Vec4f> position_w,
                                Threads& threads) {
  const std::size_t particles = elements_->particle_end(), patches = elements_->patches().size();
  clean_boxes_.resize(particles);
  threads.each(particles, box_grain, [&](std::size_t i) { clean_boxes_[i] = finite_or_infinite(boxes[i]); });
  vertex_boxes_.resize(elements_->vertices().size());
  edge_boxes_.resize(elements_->edges().size());
  triangle_boxes_.resize(elements_->triangles().size());
  patch_boxes_.resize(patches);
  moves_.resize(patches);
  chunks_.resize((patches + patches_per_chunk - 1) / patches_per_chunk);
  left_out_of_.resize(chunks_.size());
  threads.each(chunks_.size(), 1, [&](std::size_t k) {
    std::size_t left_out = 0;
    for (std::size_t a = k * patches_per_chunk; a < std::min(patches, (k + 1) * patches_per_chunk); ++a)
      left_out += make_boxes_of(a, position_w);
    left_out_of_[k] = left_out;
  });
  left_out_ = std::accumulate(left_out_of_.begin(), left_out_of_.end(), std::size_t{0});
  vertices_ = vertex_boxes_.columns();
  edges_ = edge_boxes_.columns();
  triangles_ = triangle_boxes_.columns();
  vertices_.particle[0] = elements_->vertex_particles();
  for (std::size_t k = 0; k < 2; ++k) edges_.particle[k] = elements_->edge_particles(k);
  for (std::size_t k = 0; k < 3; ++k) triangles_.particle[k] = elements_->triangle_particles(k);
}

// Computes the boxes of a patch and its items. Returns the number of items that are skipped.
std::size_t NearPairFinder::make_boxes_of(std::size_t a, std::span<const Vec4f> position_w) {
  const SurfacePatch& patch = elements_->patches()[a];
  std::size_t left_out = 0, moving = 0;
  Bounds around = empty_bounds;
  const auto add = [&](Boxes& to, std::size_t i, const Bounds& box, bool moves) {
    const bool finite = box.lo.x > -infinity;
    const Bounds kept = finite ? box : empty_bounds;
    to.set(i, kept);
    around = united(around, kept);
    left_out += finite ? 0 : 1;
    moving += moves ? 1 : 0;
  };
  const std::span<const Bounds> boxes = clean_boxes_;
  const auto moves = [&](std::uint32_t i) { return position_w[i].w > 0; };
  for (std::uint32_t v = patch.first_vertex; v < patch.first_vertex + patch.vertices; ++v) {
    const std::uint32_t i = elements_->vertices()[v];
    add(vertex_boxes_, v, boxes[i], moves(i));
  }
  for (std::uint32_t e = patch.first_edge; e < patch.first_edge + patch.edges; ++e) {
    const auto& [i, j] = elements_->edges()[e];
    add(edge_boxes_, e, united(boxes[i], boxes[j]), moves(i) || moves(j));
  }
  for (std::uint32_t t = patch.first_triangle; t < patch.first_triangle + patch.triangles; ++t) {
    const auto& [i, j, k] = elements_->triangles()[t].particle;
    add(triangle_boxes_, t, united(united(boxes[i], boxes[j]), boxes[k]), moves(i) || moves(j) || moves(k));
  }
  patch_boxes_[a] = around;
  const std::size_t items = std::size_t{patch.vertices} + patch.edges + patch.triangles;
  moves_[a] = moving == 0 ? Moves::nothing : (moving == items ? Moves::all : Moves::some);
  return left_out;
}

void NearPairFinder::find_near(std::uint32_t a, const ObjectFilter& compares,
                               std::span<const Vec4f> position_w, Part& part) const {
  constexpr Marks all{~0u, ~0u, ~0u};
  find_between(a, all, a, all, compares, position_w, part);
  for (std::uint32_t k = partners_begin_[a]; k < partners_begin_[a + 1]; ++k)
    find_between(a, all, partners_[k], all, compares, position_w, part);
}

void NearPairFinder::find_between(std::uint32_t a, const Marks& of_a, std::uint32_t b, const Marks& of_b,
                                  const ObjectFilter& compares, std::span<const Vec4f> position_w,
                                  Part& part) const {
  const SurfacePatch &p = elements_->patches()[a], &q = elements_->patches()[b];
  if (!compares(p.object, q.object)) return;
  if (moves_[a] == Moves::nothing && moves_[b] == Moves::nothing) return;
  const bool all_move = moves_[a] == Moves::all || moves_[b] == Moves::all;
  const auto add = [&](List& list, std::size_t most, const auto& find) {
    if (most == 0) return;
    kernels::Quad* const pairs = list.grow_capacity(most);
    const std::size_t count = find(pairs);
    list.count += all_move ? count : keep_moving(pairs, count, position_w);
  };
  const Bounds &p_box = patch_boxes_[a], &q_box = patch_boxes_[b];
  const auto vertices_triangles = [&](const SurfacePatch& v, const kernels::BoxGroup& vertices,
                                      const SurfacePatch& t, const kernels::BoxGroup& triangles) {
    add(part.vertex_triangle, std::size_t{v.vertices} * t.triangles, [&](kernels::Quad* pairs) {
      return kernels_->vertices_triangles(vertices_, vertices, triangles_, triangles, pairs);
    });
  };
  vertices_triangles(p, group(p.first_vertex, p.vertices, p_box, of_a.vertices), q,
                     group(q.first_triangle, q.triangles, q_box, of_b.triangles));
  if (a != b)
    vertices_triangles(q, group(q.first_vertex, q.vertices, q_box, of_b.vertices), p,
                       group(p.first_triangle, p.triangles, p_box, of_a.triangles));
  add(part.edge_edge, std::size_t{p.edges} * q.edges, [&](kernels::Quad* pairs) {
    return kernels_->edges_edges(edges_, group(p.first_edge, p.edges, p_box, of_a.edges),
                                 group(q.first_edge, q.edges, q_box, of_b.edges), pairs);
  });
  const auto vertices_edges = [&](const SurfacePatch& v, const Bounds& v_box, const Marks& of_v,
                                  const SurfacePatch& e, const Bounds& e_box, const Marks& of_e) {
    if (!is_particles_only(v) || !is_edges_only(e)) return;
    add(part.edge_edge, std::size_t{v.vertices} * e.edges, [&](kernels::Quad* pairs) {
      return kernels_->vertices_edges(vertices_, group(v.first_vertex, v.vertices, v_box, of_v.vertices),
                                      edges_, group(e.first_edge, e.edges, e_box, of_e.edges), pairs);
    });
  };
  vertices_edges(p, p_box, of_a, q, q_box, of_b);
  vertices_edges(q, q_box, of_b, p, p_box, of_a);
}

// Joins the pairs of all chunks, in order of chunks.
void NearPairFinder::join(Piece Chunk::*piece, List Part::*list, std::vector<NearPair>& out,
                          std::size_t parts, Threads& threads) {
  std::size_t sum = 0;
  for (Chunk& chunk : chunks_) {
    (chunk.*piece).offset = sum;
    sum += (chunk.*piece).count;
  }
  resize_with_spare(out, sum);
  threads.for_each(chunks_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Piece& from = chunks_[k].*piece;
      std::copy_n((parts_[k % parts].*list).pairs.data() + from.begin, from.count, out.data() + from.offset);
    }
  });
}

std::size_t NearPairFinder::bytes() const {
  std::size_t sum = bytes_of(clean_boxes_, patch_boxes_, moves_, own_patches_, parts_, chunks_, marks_,
                             is_moving_, moved_patches_) +
                    hash_.bytes();
  for (const Boxes* boxes : {&vertex_boxes_, &edge_boxes_, &triangle_boxes_})
    for (std::size_t axis = 0; axis < 3; ++axis) sum += bytes_of(boxes->lo[axis], boxes->hi[axis]);
  for (const Part& part : parts_)
    sum += bytes_of(part.vertex_triangle.pairs, part.edge_edge.pairs, part.found);
  return sum;
}

}  // namespace souple
