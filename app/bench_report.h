#pragma once

#include "app/bench_measure.h"
#include "souple/scene/json.h"

#include <filesystem>

namespace souple::app {

scene_format::Json bench_json(const BenchResult& result);

/// A result that --json printed earlier. Throws Error when the file is something else.
scene_format::Json read_bench_json(const std::filesystem::path& file);

/// How much faster `now` is than `before`, number by number: above 1 is faster.
scene_format::Json speed_up(const scene_format::Json& now, const scene_format::Json& before);

/// A short table for people; `before`, when there is one, beside it.
void print_bench(const scene_format::Json& now, const scene_format::Json* before);

}  // namespace souple::app
