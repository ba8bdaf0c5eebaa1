// Numbers as text: where the standard library lacks floating from_chars and to_chars, the same texts and numbers.
#include "souple/math/bit_cast.h"
#include "souple/mesh_files/number_text.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace souple::mesh_detail::test_io_number_text {

std::string written(float value) {
  std::string text;
  append_real(text, value);
  return text;
}
std::string written_portably(float value) {
  std::string text;
  append_real_portably(text, value);
  return text;
}

TEST(NumberText, OneTextForEachFloat) {
  std::mt19937 random(1);
  for (int i = 0; i < 200000; ++i) {
    const auto value = bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(written_portably(value), written(value));
    double read = -1;
    ASSERT_TRUE(parse_unsigned_real(written(std::abs(value)), read));
    ASSERT_EQ(static_cast<float>(read), std::abs(value)) << written(value);
  }
  for (const float value : {0.0f, -0.0f, 1.0f, -1.5f, 0.1f, 1e-5f, 1e-4f, 123456789.0f, 16777216.0f, 1e20f,
                            3.4e38f, 1e-45f, 100000.0f, 1e6f, 0.001f, 0.0001234f, 12345.678f})
    EXPECT_EQ(written_portably(value), written(value));
}

TEST(NumberText, OneNumberForEachText) {
  const auto expect_same = [](const std::string& text) {
    double value = -1, other = -1;
    const bool is_number = parse_unsigned_real(text, value);
    ASSERT_EQ(parse_unsigned_real_portably(text, other), is_number) << text;
    if (is_number) {
      EXPECT_EQ(other, value) << text;
    }
  };
  for (const char* text :
       {"0",        "1",        "1.",  ".5", ".",     "",    "1e5",  "1E+5",     "1e",    "1e+",
        "-1",       "+1",       "--1", "1-", "0x10",  "inf", "nan",  "infinity", "1e400", "1e-400",
        "0.0e-999", "4.9e-324", " 1",  "1 ", "1.5.2", "1,5", "1e5e", "1_0",      "12a"})
    expect_same(text);
  std::mt19937_64 random(2);
  for (int i = 0; i < 20000; ++i) {
    const double value = std::abs(bit_cast<double>(static_cast<std::uint64_t>(random())));
    if (std::isfinite(value)) expect_same(fmt::format("{}", value));
  }
}

}  // namespace souple::mesh_detail::test_io_number_text
