#include "app/bench_stages.h"

#include "app/bench_report.h"
#include "souple/error.h"
#include "souple/simd/instruction_set.h"
#include "souple/threads/threads.h"
#include "souple/version.h"

#include <array>
#include <cmath>
#include <cstdio>

#include <fmt/core.h>

namespace souple::app {

using scene_format::Json;
using scene_format::Member;

namespace {

constexpr std::array benches{
    StageBench{"dam-break", "a block of water collapses in a tank: steps of 2 ms, 5 iterations", "particles",
               97336, 1000, 4000000, measure_dam_break},
    StageBench{"surface", "the surface of a broken dam as a mesh, cells of a particle's radius",
               "approximate number of particles", 98000, 100, 5000000, measure_surface},
};

void print_member(const Member& member, int indent) {
  const Json& value = member.value;
  const int width = 26 - indent;
  if (value.is(Json::Kind::object)) {
    std::printf("%*s%s\n", indent, "", member.key.c_str());
    for (const Member& inner : value.members) print_member(inner, indent + 2);
  } else if (value.is(Json::Kind::number)) {
    std::printf("%*s%-*s %14.6g\n", indent, "", width, member.key.c_str(), value.number);
  } else {
    std::printf("%*s%-*s %14s\n", indent, "", width, member.key.c_str(), value.text.c_str());
  }
}

}  // namespace

std::span<const StageBench> stage_benches() {
  return benches;
}

const StageBench* find_stage_bench(const std::string& name) {
  for (const StageBench& bench : benches)
    if (bench.name == name) return &bench;
  return nullptr;
}

Json measure_stage(const StageBench& bench, BenchOptions options) {
  if (options.size == 0) options.size = bench.default_size;
  if (options.size < bench.min_size || options.size > bench.max_size)
    throw Error(fmt::format("--size {}: {} takes {} to {} {}", options.size, bench.name, bench.min_size,
                            bench.max_size, bench.size_means));
  if (options.residual) throw Error(std::string("--residual: ") + bench.name + " uses no solver");
  Json result = Json::object();
  result.set("name", Json::of(bench.name));
  result.set("size", Json::whole(options.size));
  result.set("threads",
             Json::whole(make_threads(options.settings.threading, options.settings.threads)->count()));
  result.set("simd", Json::of(std::string(simd_name())));
  result.set("version", Json::of(version));
  result.set("warm_up", Json::whole(options.warm_up));
  result.set("runs", Json::whole(options.runs));
  for (Member& member : bench.measure(options).members) result.set(member.key, std::move(member.value));
  return result;
}

Json milliseconds(const std::vector<double>& values) {
  return Json::of(std::round(median(values) * 1e3) / 1e3);
}

Json hash_json(std::uint64_t hash) {
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return Json::of(text);
}

void print_stage(const Json& now, const Json* before) {
  for (const Member& member : now.members) print_member(member, 0);
  if (before == nullptr) return;
  std::printf("faster than before\n");
  for (const Member& member : speed_up(now, *before).members) print_member(member, 2);
}

}  // namespace souple::app
