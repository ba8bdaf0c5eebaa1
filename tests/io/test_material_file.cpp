#include "souple/io/material_file.h"

#include <gtest/gtest.h>

namespace souple::test::test_io_material_file {

TEST(MaterialFile, ReadsColorsAndOpacities) {
  const auto materials = parse_materials(
      "# a comment\nKd 1 1 1\nnewmtl Blue cloth\r\nNs 10\nKd 0 0.25 7\nd 0.5\nmap_Kd wood.png\nnewmtl "
      "plain\nKd 1 x 0\nd\n");
  ASSERT_EQ(materials.size(), 2u);
  EXPECT_EQ(materials.at("Blue cloth").color, Vec3f(0, 0.25f, 1));
  EXPECT_EQ(materials.at("Blue cloth").opacity, 0.5f);
  EXPECT_EQ(materials.at("plain").color, Vec3f(0.8f, 0.8f, 0.8f));
  EXPECT_EQ(materials.at("plain").opacity, 1);
  EXPECT_TRUE(parse_materials("").empty());
}

}  // namespace souple::test::test_io_material_file
