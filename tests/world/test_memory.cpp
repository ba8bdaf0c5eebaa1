#include "souple/geometry/builders.h"
#include "souple/world/memory.h"
#include "souple/world/world.h"

#include <gtest/gtest.h>

namespace souple::test_world_memory {

std::size_t bytes_of_part(const std::vector<MemoryReport::Part>& parts, const std::string& name) {
  for (const MemoryReport::Part& part : parts)
    if (part.name == name) return part.bytes;
  return 0;
}

MemoryReport memory_of(const ClothMaterial& material) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(200, 200, 2), material);
  world.step(1.0 / 60);
  world.positions(cloth);
  return world.memory();
}

TEST(Memory, AClothTakesAtMost256BytesAParticle) {
  ClothMaterial springs;
  springs.bending = BendingModel::distance;
  ClothMaterial stiff = springs;
  stiff.membrane_stiffness = stiff.bending_stiffness = rigid;
  for (const ClothMaterial& material : {springs, stiff}) {
    const MemoryReport report = memory_of(material);
    EXPECT_EQ(report.particles, 40000u);
    EXPECT_LE(MemoryReport::total(report.simulation), 256 * report.particles);
    EXPECT_LE(MemoryReport::total(report.objects), 128 * report.particles);
  }
}

TEST(Memory, EveryConstraintIsCounted) {
  ClothMaterial material;
  material.bending = BendingModel::none;
  const std::size_t edges = bytes_of_part(memory_of(material).simulation, "distance");
  EXPECT_GE(edges, std::size_t{119201} * 2 * sizeof(std::uint32_t));
  material.bending = BendingModel::distance;
  EXPECT_GE(bytes_of_part(memory_of(material).simulation, "distance"),
            edges + std::size_t{118405} * 2 * sizeof(std::uint32_t));
}

}  // namespace souple::test_world_memory
