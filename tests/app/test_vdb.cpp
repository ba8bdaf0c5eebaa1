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

namespace souple::app {
namespace {

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

/// The grid that OpenVDB reads from a file of these bytes.
openvdb::FloatGrid::Ptr read_back(const std::string& bytes) {
  const auto path = std::filesystem::temp_directory_path() / ("souple-" + std::to_string(getpid()) + ".vdb");
  std::ofstream(path, std::ios::binary) << bytes;
  openvdb::initialize();
  openvdb::io::File file(path.string());
  file.open(false);
  openvdb::GridBase::Ptr grid = file.readGrid("surface");
  EXPECT_EQ(file.getGrids()->size(), 1u);
  file.close();
  std::filesystem::remove(path);
  return openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
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

// OpenVDB's random names are replaced by hashes of the content.
TEST(Vdb, SameBytesEachTimeAndForAnyNumberOfThreads) {
  const std::string bytes = sphere_bytes(1);
  EXPECT_EQ(bytes, sphere_bytes(1));
  EXPECT_EQ(bytes, sphere_bytes(3));
}

}  // namespace
}  // namespace souple::app
