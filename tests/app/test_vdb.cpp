#include "app/vdb.h"
#include "souple/geometry/builders.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Diagnostics.h>
#include <string>
#include <unistd.h>

#include <gtest/gtest.h>

namespace souple::app::test_app_vdb {

constexpr double radius = 0.5, cell = 0.03125, width = 3 * cell;
const Vec3d center(0.25, -1, 0.1);

/// A sphere; if `hollow`, with a cavity of half its size.
std::string sphere_bytes(int threads, bool hollow = false) {
  TriangleMesh mesh = sphere(4, radius);
  if (hollow) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const TriangleMesh inner = sphere(3, radius / 2);
    mesh.positions.insert(mesh.positions.end(), inner.positions.begin(), inner.positions.end());
    for (const Triangle& t : inner.triangles)
      mesh.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  }
  std::vector<Vec3f> positions;
  for (const Vec3d& x : mesh.positions) positions.emplace_back(x + center);
  const auto workers = make_threads(Threading::pool, threads);
  return vdb_bytes(narrow_band(positions, mesh.triangles, float(cell), 3, *workers), "water, \"cold\"");
}

/// A grid that OpenVDB reads from a file of these bytes and of so many grids.
openvdb::GridBase::Ptr read_grid(const std::string& bytes, const char* name, std::size_t count) {
  const auto path = std::filesystem::temp_directory_path() / ("souple-" + std::to_string(getpid()) + ".vdb");
  std::ofstream(path, std::ios::binary) << bytes;
  openvdb::initialize();
  openvdb::io::File file(path.string());
  file.open(false);
  openvdb::GridBase::Ptr grid = file.readGrid(name);
  EXPECT_EQ(file.getGrids()->size(), count);
  file.close();
  std::filesystem::remove(path);
  return grid;
}

openvdb::FloatGrid::Ptr read_back(const std::string& bytes, std::size_t grids = 1) {
  return openvdb::gridPtrCast<openvdb::FloatGrid>(read_grid(bytes, "surface", grids));
}

TEST(Vdb, IsALevelSetOfTheSphere) {
  const openvdb::FloatGrid::Ptr grid = read_back(sphere_bytes(2));
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_FLOAT_EQ(grid->background(), float(width));
  EXPECT_EQ(grid->voxelSize(), openvdb::Vec3d(cell));
  EXPECT_EQ(grid->metaValue<std::string>("object"), "water, \"cold\"");
  EXPECT_NE(grid->getCreator().find("souple"), std::string::npos);
  std::size_t inside = 0, outside = 0;
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    ASSERT_TRUE(value.isVoxelValue());
    const openvdb::Vec3d at = grid->indexToWorld(value.getCoord());
    const double expected = length(Vec3d(at.x(), at.y(), at.z()) - center) - radius;
    EXPECT_NEAR(*value, expected, 0.001);
    (*value < 0 ? inside : outside) += 1;
  }
  const double shell = 4 * M_PI * radius * radius * width / (cell * cell * cell);
  EXPECT_NEAR(double(inside + outside), 2 * shell, 0.04 * shell);
}

// Beyond the band, voxels are inside or outside too; those in a cavity are outside.
TEST(Vdb, IsFilledBeyondTheBand) {
  const openvdb::FloatGrid::Ptr grid = read_back(sphere_bytes(2, true));
  ASSERT_TRUE(grid);
  EXPECT_EQ(openvdb::tools::checkLevelSet(*grid), "");  // OpenVDB's own check of level sets
  const auto accessor = grid->getConstAccessor();
  for (int i = -40; i <= 40; ++i)
    for (int j = -40; j <= 40; ++j)
      for (int k = -40; k <= 40; ++k) {
        const Vec3d at = center + Vec3d(i, j, k) * 0.02;
        const openvdb::Vec3d index = grid->worldToIndex({at.x, at.y, at.z});
        const openvdb::Coord nearest = openvdb::Coord::round(index);
        const openvdb::Vec3d there = grid->indexToWorld(nearest);
        const double from_center = length(Vec3d(there.x(), there.y(), there.z()) - center);
        const double distance = std::max(from_center - radius, radius / 2 - from_center);
        ASSERT_NEAR(accessor.getValue(nearest), std::clamp(distance, -width, width), 0.002) << from_center;
      }
}

// A body of particles that turns about the vertical: its velocity is the particles' at each point of the band.
TEST(Vdb, HasVelocities) {
  const TriangleMesh mesh = sphere(4, radius);
  std::vector<Vec3f> positions, particles, velocities;
  for (const Vec3d& x : mesh.positions) positions.emplace_back(x);
  const auto turning = [](const Vec3d& x) { return Vec3d(x.z, 0, -x.x) * 2.0 + Vec3d(0, 1, 0); };
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j)
      for (int k = -8; k <= 8; ++k) {
        const Vec3d x = Vec3d(i, j, k) * (2 * cell);
        if (length(x) > radius) continue;
        particles.emplace_back(x);
        velocities.emplace_back(turning(x));
      }
  const auto workers = make_threads(Threading::pool, 2);
  const NarrowBand band = narrow_band(positions, mesh.triangles, float(cell), 3, *workers);
  const std::string bytes = vdb_bytes(
      band, "ball", surface_velocities(band_points(band), particles, velocities, 6 * float(cell), *workers));
  const auto grid = openvdb::gridPtrCast<openvdb::Vec3SGrid>(read_grid(bytes, "velocity", 2));
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->getVectorType(), openvdb::VEC_CONTRAVARIANT_RELATIVE);
  EXPECT_EQ(grid->activeVoxelCount(), read_back(bytes, 2)->activeVoxelCount());
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const openvdb::Vec3d at = grid->indexToWorld(value.getCoord());
    const Vec3d expected = turning({at.x(), at.y(), at.z()});
    // Outside, the mean is that of particles below the surface: up to 3 cells and half a weight inward.
    EXPECT_NEAR(value->y(), 1, 1e-3);
    EXPECT_LT(length(Vec3d(value->x(), value->y(), value->z()) - expected), 2 * 5 * cell);
  }
}

// OpenVDB's random names are replaced by hashes of the content.
TEST(Vdb, SameBytesEachTimeAndForAnyNumberOfThreads) {
  const std::string bytes = sphere_bytes(1);
  EXPECT_EQ(bytes, sphere_bytes(1));
  EXPECT_EQ(bytes, sphere_bytes(3));
}

}  // namespace souple::app::test_app_vdb
