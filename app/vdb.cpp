#include "app/vdb.h"

#include "souple/math/fnv1a.h"
#include "souple/version.h"

#include <cstdio>
#include <sstream>

// The only file of the program that includes OpenVDB, which costs seconds of compile time.
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>

namespace souple::app {

namespace {

using Leaf = openvdb::FloatGrid::TreeType::LeafNodeType;
static_assert(Leaf::SIZE == NarrowBand::brick_points && Leaf::DIM == NarrowBand::side);

/// Properties that all grids of a file have in common.
void describe(openvdb::GridBase& grid, const NarrowBand& band, const std::string& object) {
  grid.setTransform(openvdb::math::Transform::createLinearTransform(double(band.cell)));
  grid.setCreator(std::string("souple ") + version);
  grid.insertMeta("object", openvdb::StringMetadata(object));
}

/// The library creates the grid: FloatGrid::create would instantiate all operations of a grid once more.
openvdb::FloatGrid::Ptr grid_of(const NarrowBand& band, const std::string& object) {
  const openvdb::GridBase::Ptr made = openvdb::GridBase::createGrid(openvdb::FloatGrid::gridType());
  openvdb::FloatGrid::Ptr grid = openvdb::gridPtrCast<openvdb::FloatGrid>(made);
  grid->tree().root().setBackground(band.width, false);
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  describe(*grid, band, object);
  for (const NarrowBand::Brick& brick : band.bricks) {
    Leaf* leaf = grid->tree().touchLeaf({brick.first[0], brick.first[1], brick.first[2]});
    for (std::size_t i = 0; i < NarrowBand::brick_points; ++i)
      if (brick.in_band(i)) leaf->setValueOn(static_cast<openvdb::Index>(i), brick.distances[i]);
  }
  openvdb::tools::signedFloodFill(grid->tree(), false);
  return grid;
}

/// Velocities at the points of the band.
openvdb::Vec3SGrid::Ptr velocity_grid_of(const NarrowBand& band, const std::string& object,
                                         std::span<const Vec3f> velocities) {
  const openvdb::GridBase::Ptr made = openvdb::GridBase::createGrid(openvdb::Vec3SGrid::gridType());
  openvdb::Vec3SGrid::Ptr grid = openvdb::gridPtrCast<openvdb::Vec3SGrid>(made);
  grid->setName("velocity");
  grid->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
  grid->setSaveFloatAsHalf(true);  // three digits are enough for motion blur
  describe(*grid, band, object);
  auto velocity = velocities.begin();
  for (const NarrowBand::Brick& brick : band.bricks) {
    auto* leaf = grid->tree().touchLeaf({brick.first[0], brick.first[1], brick.first[2]});
    for (std::size_t i = 0; i < NarrowBand::brick_points; ++i) {
      if (!brick.in_band(i)) continue;
      const Vec3f& v = *velocity++;
      leaf->setValueOn(static_cast<openvdb::Index>(i), openvdb::Vec3s(v.x, v.y, v.z));
    }
  }
  return grid;
}

/// A file in memory, as openvdb::io::File writes it: with offsets of its parts, which io::Stream omits.
class Archive : public openvdb::io::Archive {
 public:
  std::string bytes_of(const openvdb::GridCPtrVec& grids) const {
    std::ostringstream stream(std::ios::binary);
    write(stream, grids, true);
    return std::move(stream).str();
  }
};

/// OpenVDB gives each file a random name (UUID). This one is a hash of the file's content.
void name_by_content(std::string& bytes) {
  constexpr std::size_t at = 8 + 4 + 4 + 4 + 1;  // after magic number, three versions and a flag
  constexpr std::size_t size = 36;
  if (bytes.size() < at + size) return;
  std::string name(size, '0');
  for (const std::size_t dash : {8u, 13u, 18u, 23u}) {
    if (bytes[at + dash] != '-') return;  // an unknown format
    name[dash] = '-';
  }
  bytes.replace(at, size, name);
  const std::uint64_t first = fnv1a64(bytes), second = fnv1a64("second half", first);
  char digits[33];
  std::snprintf(digits, sizeof digits, "%016llx%016llx", static_cast<unsigned long long>(first),
                static_cast<unsigned long long>(second));
  std::size_t digit = 0;
  for (char& c : name)
    if (c != '-') c = digits[digit++];
  bytes.replace(at, size, name);
}

}  // namespace

bool has_vdb() {
  return true;
}

void require_vdb() {}

std::string vdb_bytes(const NarrowBand& band, const std::string& object, std::span<const Vec3f> velocities) {
  openvdb::initialize();
  openvdb::GridCPtrVec grids{grid_of(band, object)};
  if (!velocities.empty()) grids.push_back(velocity_grid_of(band, object, velocities));
  std::string bytes = Archive().bytes_of(grids);
  name_by_content(bytes);
  return bytes;
}

}  // namespace souple::app
