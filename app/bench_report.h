#pragma once

#include "app/bench_measure.h"
#include "souple/scene/json.h"

#include <filesystem>

namespace souple::app {

scene_format::Json bench_json(const BenchResult& result);

/// Reads a result that --json printed. Throws Error when the file is not such a result.
scene_format::Json read_bench_json(const std::filesystem::path& file);

/// Speed-up of `now` over `before` for each number: above 1 is faster.
scene_format::Json speed_up(const scene_format::Json& now, const scene_format::Json& before);

/// Prints a short table for people; with `before`, if not null, beside it.
void print_bench(const scene_format::Json& now, const scene_format::Json* before);

}  // namespace souple::app
