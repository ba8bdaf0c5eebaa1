#include "souple/collision/mesh_tree.h"
#include "souple/collision/signed_distance_grid.h"
#include "souple/error.h"
#include "souple/geometry/close_holes.h"
#include "souple/geometry/measures.h"
#include "souple/threads/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/core.h>

namespace souple {
namespace {

constexpr double margin_cells = SignedDistanceField::fine_cells;  // least margin of the grid around the mesh
// A point on the surface, a whole spacing away, may have either sign.
constexpr double rounding_factor = 1.000001;
constexpr double far_tolerance = 0.01;  // relative, of distances far from the surface

// Memory is proportional to the surface, so to spacing^-2.
[[noreturn]] void too_large(double spacing, double bytes) {
  const double limit = SignedDistanceField::max_bytes;
  const double fits = spacing * sqrt(bytes / limit) * 1.1;
  throw Error(
      fmt::format("SignedDistanceField: a spacing of {:.3g} m needs {:.3g} MiB for this mesh; at most {:.3g} "
                  "are allowed: take a spacing of about {:.3g} m or more",
                  spacing, bytes / 1048576, limit / 1048576, fits));
}

}  // namespace

/// Fills a grid. Points are visited along lines in alternating direction, so each follows a neighbor. The
/// neighbor's nearest triangle is a good guess. Both are on the same side if one is farther from the surface than they
/// are apart, or if no triangle crosses their connection.
struct SignedDistanceField::Builder {
  const MeshTree& tree;
  Grid& grid;

  struct Walker {
    Vec3d point{};
    double distance = -1;  // unsigned [m]; below 0: none yet
    double sign = 1;
    std::uint32_t triangle = 0;
  };

  double measure(Walker& walker, const Vec3d& point, double tolerance) const {
    const double step = length(point - walker.point);
    const MeshTree::Nearest nearest = tree.nearest(point, walker.triangle, tolerance);
    const double clear = max(walker.distance, nearest.distance) / (1 + tolerance);
    const bool same_side =
        walker.distance >= 0 && (clear > step * rounding_factor || !tree.may_cross(walker.point, point));
    if (!same_side) walker.sign = tree.winding_number(point) > 0.5 ? -1.0 : 1.0;
    walker = {point, nearest.distance, walker.sign, nearest.triangle};
    return walker.sign * nearest.distance;
  }

  /// Calls f(i, j, k) for all points of a box; successive points are neighbors.
  template <class F>
  static void to_and_fro(int nx, int ny, int nz, const F& f) {
    bool back_y = false, back_x = false;
    for (int k = 0; k < nz; ++k, back_y = !back_y)
      for (int j = 0; j < ny; ++j, back_x = !back_x)
        for (int i = 0; i < nx; ++i) f(back_x ? nx - 1 - i : i, back_y ? ny - 1 - j : j, k);
  }

  void fill_corners() {
    const auto [nx, ny, nz] = grid.blocks;
    grid.corners.resize(grid.corner_index(nx, ny, nz) + 1);
    const double step = grid.spacing * Grid::block_cells;
    Walker walker;
    to_and_fro(nx + 1, ny + 1, nz + 1, [&](int i, int j, int k) {
      const Vec3d point = grid.origin + Vec3d{double(i), double(j), double(k)} * step;
      grid.corners[grid.corner_index(i, j, k)] = static_cast<float>(measure(walker, point, far_tolerance));
    });
  }

  /// A block stores all its points if the surface comes within fine_cells spacings of it.
  void choose_blocks() {
    const auto [nx, ny, nz] = grid.blocks;
    grid.slot.assign(grid.block_index(nx - 1, ny - 1, nz - 1) + 1, Grid::coarse_only);
    const double step = grid.spacing * Grid::block_cells;
    const double max_distance = (fine_cells * grid.spacing + 0.5 * sqrt(3.0) * step) * (1 + far_tolerance);
    std::int32_t count = 0;
    std::uint32_t guess = 0;
    to_and_fro(nx, ny, nz, [&](int i, int j, int k) {
      const Vec3d center = grid.origin + Vec3d{i + 0.5, j + 0.5, k + 0.5} * step;
      const MeshTree::Nearest nearest = tree.nearest(center, guess, far_tolerance);
      guess = nearest.triangle;
      if (nearest.distance <= max_distance) grid.slot[grid.block_index(i, j, k)] = count++;
    });
    const double bytes = double(count) * Grid::block_points * sizeof(float);
    if (bytes > max_bytes) too_large(grid.spacing, bytes);
    grid.points.resize(static_cast<std::size_t>(count) * Grid::block_points);
  }

  void fill_block(int i, int j, int k, float* points) const {
    const Vec3d first =
        grid.origin + Vec3d{double(i), double(j), double(k)} * (grid.spacing * Grid::block_cells);
    Walker walker;
    to_and_fro(Grid::block_side, Grid::block_side, Grid::block_side, [&](int x, int y, int z) {
      const Vec3d point = first + Vec3d{double(x), double(y), double(z)} * grid.spacing;
      points[(z * Grid::block_side + y) * Grid::block_side + x] =
          static_cast<float>(measure(walker, point, 0));
    });
  }

  void fill_blocks() {
    const auto [nx, ny, nz] = grid.blocks;
    std::vector<std::array<int, 3>> stored;  // in order of their slots
    to_and_fro(nx, ny, nz, [&](int i, int j, int k) {
      if (grid.slot[grid.block_index(i, j, k)] != Grid::coarse_only) stored.push_back({i, j, k});
    });
    make_threads(Threading::automatic, 0)->each(stored.size(), 1, [&](std::size_t slot) {
      const auto [i, j, k] = stored[slot];
      fill_block(i, j, k, &grid.points[slot * Grid::block_points]);
    });
  }

  /// Sets the number of blocks that contain the mesh and its margin, with the mesh in the middle.
  static void lay_out(Grid& grid) {
    const double step = grid.spacing * Grid::block_cells;
    double blocks = 1;
    double count[3];
    for (int k = 0; k < 3; ++k) {
      count[k] = std::ceil((grid.hi[k] - grid.lo[k] + 2 * margin_cells * grid.spacing) / step);
      blocks *= count[k];
      grid.origin[k] = 0.5 * (grid.lo[k] + grid.hi[k]) - 0.5 * step * count[k];
    }
    // Checked before the costly part. A mesh in so large a box would exceed the limit as well.
    const double bytes = blocks * (sizeof(float) + sizeof(std::int32_t));
    if (!(bytes <= max_bytes / 8)) too_large(grid.spacing, 8 * bytes);
    for (int k = 0; k < 3; ++k) grid.blocks[static_cast<std::size_t>(k)] = static_cast<int>(count[k]);
  }
};

SignedDistanceField::SignedDistanceField(const TriangleMesh& mesh, double spacing) {
  if (!(std::isfinite(spacing) && spacing > 0))
    throw Error(fmt::format(
        "SignedDistanceField: spacing is {:.3g}; expected a finite length above 0, in meters", spacing));
  if (mesh.triangles.size() > max_triangles)
    throw Error(
        fmt::format("SignedDistanceField: the mesh has {} triangles; at most {} are taken: simplify it, "
                    "since details smaller than "
                    "two spacings are lost anyway",
                    mesh.triangles.size(), max_triangles));
  const ClosedSurface closed = closed_surface(mesh, "signed distance field");
  const TriangleMesh& solid = closed.mesh;
  const MeshTree tree(solid.positions, solid.triangles);
  const auto grid = std::make_shared<Grid>();
  const BoundingBox box = bounding_box(solid.positions, solid.triangles);
  grid->lo = box.lo;
  grid->hi = box.hi;
  grid->spacing = spacing;
  grid->mesh_positions = solid.positions;
  grid->mesh_triangles = solid.triangles;
  grid->sentences = closed.sentences();
  Builder::lay_out(*grid);
  Builder builder{tree, *grid};
  builder.choose_blocks();
  builder.fill_corners();
  builder.fill_blocks();
  grid_ = grid;
}

double SignedDistanceField::spacing_of(const TriangleMesh& mesh, int resolution) {
  if (resolution < 1)
    throw Error(fmt::format("SignedDistanceField: resolution is {}; expected at least 1 cell", resolution));
  const Vec3d size = bounding_box(mesh.positions).size();
  return max(size.x, max(size.y, size.z)) / resolution;
}

}  // namespace souple
