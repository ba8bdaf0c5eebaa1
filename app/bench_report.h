#pragma once

#include "app/bench_measure.h"
#include "souple/scene/json.h"

#include <filesystem>

namespace souple::app {

scene_format::Json bench_json(const BenchResult& result);

/// Reads a result of an earlier --json. Throws Error for other files.
scene_format::Json read_bench_json(const std::filesystem::path& file);

/// Ratios of `before` to `now` per number: > 1 means that `now` is faster.
scene_format::Json speed_up(const scene_format::Json& now, const scene_format::Json& before);

/// Prints a short table; with `before`, if it is not nullptr, beside it.
void print_bench(const scene_format::Json& now, const scene_format::Json* before);

}  // namespace souple::app
