#pragma once

#include "app/sweep/result.h"

#include <cstdint>

namespace souple::app {

/// How many runs have which result.
struct SweepCounts {
  std::uint64_t finished = 0, diverged = 0, failed = 0, missing = 0;
};

/// Writes table.csv and table.json from the results that there are: a row for each run, in order. Throws Error.
SweepCounts write_tables(const Sweep& sweep);

inline constexpr const char* table_name = "table.csv";
inline constexpr const char* json_table_name = "table.json";

}  // namespace souple::app
