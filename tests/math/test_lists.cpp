#include "souple/math/lists.h"
#include "souple/state/columns.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_math_lists {
namespace {

TEST(Lists, KeepTheOrderOfTheirItems) {
  const std::vector<std::array<std::uint32_t, 2>> items{{3, 7}, {0, 5}, {3, 1}, {1, 2}, {3, 7}};
  Lists<std::uint32_t> lists;
  for (int twice = 0; twice < 2; ++twice) {
    lists.fill(5, [&](const auto& add) {
      for (const auto& [key, item] : items) add(key, item);
    });
    ASSERT_EQ(lists.size(), 5u);
    const auto list = [&](std::size_t key) {
      return std::vector<std::uint32_t>(lists[key].begin(), lists[key].end());
    };
    EXPECT_EQ(list(0), (std::vector<std::uint32_t>{5}));
    EXPECT_EQ(list(1), (std::vector<std::uint32_t>{2}));
    EXPECT_EQ(list(3), (std::vector<std::uint32_t>{7, 1, 7}));
    EXPECT_TRUE(list(2).empty() && list(4).empty());
  }
  EXPECT_EQ(Lists<float>().size(), 0u);
}

struct Columns {
  std::uint32_t* index;
  float* value[2];
};

TEST(ColumnStore, RowsKeepTheirValuesWhenItGrows) {
  ColumnStore<Columns> store;
  for (const std::uint32_t size : {3u, 100u, 5000u}) {
    const std::size_t before = store.size();
    store.resize(size);
    const Columns columns = store.columns();
    for (std::uint32_t row = 0; row < before; ++row) {
      EXPECT_EQ(columns.index[row], row);
      EXPECT_EQ(columns.value[0][row], float(row) + 0.25f);
      EXPECT_EQ(columns.value[1][row], float(row) + 0.5f);
    }
    for (std::uint32_t row = 0; row < size; ++row)
      columns.index[row] = row, columns.value[0][row] = float(row) + 0.25f,
      columns.value[1][row] = float(row) + 0.5f;
  }
  const Columns columns = store.columns();
  store.copy(7, 3);
  EXPECT_EQ(columns.index[3], 7u);
  EXPECT_EQ(columns.value[1][3], 7.5f);
  EXPECT_EQ(columns.value[1][4], 4.5f);
  store.resize(2), store.resize(5000);
  EXPECT_EQ(store.columns().index, columns.index) << "a size that was reached allocates nothing";
  EXPECT_EQ(columns.value[1][4999], 4999.5f);
}

}  // namespace
}  // namespace souple::test_math_lists
