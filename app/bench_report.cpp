#include "app/bench.h"
#include "souple/error.h"
#include "souple/files/file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/core.h>

namespace souple::app {

using scene_format::Json;
using scene_format::Member;

namespace {

/// A number of an object; 0 if the key is missing.
double number_at(const Json& object, const char* key) {
  const Json* value = object.find(key);
  return value != nullptr && value->is(Json::Kind::number) ? value->number : 0;
}

std::string text_of(const Json* value) {
  if (value == nullptr) return "?";
  return value->is(Json::Kind::text) ? value->text : dump_line(*value);
}

/// Ratios of the numbers that both objects have; `inverse` for numbers of which less is faster.
Json ratios(const Json* now, const Json* before, bool inverse) {
  Json result = Json::object();
  if (now == nullptr || before == nullptr) return result;
  for (const Member& member : now->members) {
    const double a = member.value.number, b = number_at(*before, member.key.c_str());
    if (a > 0 && b > 0) result.set(member.key, rounded(inverse ? b / a : a / b));
  }
  return result;
}

/// Lists are left out. `faster` has ratios of some of the values, or is null.
void print_members(const Json& object, const Json* faster, int indent) {
  const int width = 30 - indent;
  for (const Member& member : object.members) {
    const Json& value = member.value;
    const Json* ratio = faster == nullptr ? nullptr : faster->find(member.key);
    if (value.is(Json::Kind::array)) continue;
    if (value.is(Json::Kind::object)) {
      std::printf("%*s%s\n", indent, "", member.key.c_str());
      print_members(value, ratio, indent + 2);
      continue;
    }
    std::printf("%*s%-*s %16s", indent, "", width, member.key.c_str(), text_of(&value).c_str());
    if (ratio != nullptr) std::printf("  %6.2fx", ratio->number);
    std::printf("\n");
  }
}

/// Lists settings that differ between two results: then their ratio is not a speed-up of the code alone.
void print_differences(const Json& now, const Json& before) {
  const auto differ = [&](const char* key) { return text_of(now.find(key)) != text_of(before.find(key)); };
  for (const char* key : {"name", "size", "threads", "simd", "substeps", "iterations", "solver", "sweep",
                          "relaxation", "chebyshev", "colors", "mode"})
    if (differ(key))
      std::printf("%s: %s, was %s\n", key, text_of(now.find(key)).c_str(), text_of(before.find(key)).c_str());
  if (!differ("runs") && !differ("warm_up") && differ("hash"))
    std::printf("the results differ: hash %s, was %s\n", text_of(now.find("hash")).c_str(),
                text_of(before.find("hash")).c_str());
}

}  // namespace

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

Json rounded(double value) {
  if (value == 0 || !std::isfinite(value)) return std::isfinite(value) ? Json::of(0.0) : Json();
  const double unit = std::pow(10.0, std::floor(std::log10(std::fabs(value))) - 5);
  const double shown =
      unit < 1 ? std::round(value / unit) / std::round(1 / unit) : std::round(value / unit) * unit;
  return Json::of(shown);
}

Json count_json(std::size_t count) {
  return Json::whole(static_cast<std::int64_t>(count));
}

Json hash_json(std::uint64_t hash) {
  return Json::of(fmt::format("{:016x}", hash));
}

Json read_bench_json(const std::filesystem::path& file) {
  Json result = scene_format::parse_json(read_whole_file(file), file.string());
  const bool fits = result.is(Json::Kind::object) && number_at(result, "ms_per_step") > 0;
  if (!fits)
    throw Error(file.string() + ": expected what `souple bench NAME --json` prints: no ms_per_step found");
  return result;
}

Json speed_up(const Json& now, const Json& before) {
  Json result = Json::object();
  const double is = number_at(now, "ms_per_step"), was = number_at(before, "ms_per_step");
  result.set("ms_per_step", rounded(was / is));
  result.set("ms_per_stage", ratios(now.find("ms_per_stage"), before.find("ms_per_stage"), true));
  result.set("projections_per_second",
             ratios(now.find("projections_per_second"), before.find("projections_per_second"), false));
  return result;
}

void print_bench(const Json& now, const Json* before) {
  const Json faster = before == nullptr ? Json() : speed_up(now, *before);
  print_members(now, before == nullptr ? nullptr : &faster, 0);
  if (before != nullptr) print_differences(now, *before);
}

}  // namespace souple::app
