#include "app/bench_report.h"

#include "app/percent.h"
#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/version.h"

#include <cmath>
#include <cstdio>

namespace souple::app {

using scene_format::Json;
using scene_format::Member;

namespace {

/// Rounds to six digits, the precision of the measurements; null: not finite.
Json rounded(double value) {
  if (value == 0 || !std::isfinite(value)) return std::isfinite(value) ? Json::of(0.0) : Json();
  const double unit = std::pow(10.0, std::floor(std::log10(std::fabs(value))) - 5);
  const double shown =
      unit < 1 ? std::round(value / unit) / std::round(1 / unit) : std::round(value / unit) * unit;
  return Json::of(shown);
}

Json named_values_json(const NamedValues& values) {
  Json object = Json::object();
  for (const auto& [name, value] : values) object.set(name, rounded(value));
  return object;
}

Json curve_json(const std::vector<CurvePoint>& curve) {
  Json list = Json::array();
  for (const CurvePoint& point : curve) {
    Json entry = Json::object();
    entry.set("iterations", Json::whole(point.iterations));
    entry.set("ms", rounded(point.milliseconds));
    entry.set("mean_strain", rounded(point.mean_strain));
    entry.set("rms_strain", rounded(point.rms_strain));
    entry.set("largest_strain", rounded(point.largest_strain));
    entry.set("energy", rounded(point.energy));
    list.items.push_back(std::move(entry));
  }
  return list;
}

Json residual_json(const ResidualResult& residual) {
  Json object = Json::object();
  object.set("target", rounded(residual.target));
  object.set("start", rounded(residual.start));
  object.set("start_energy", rounded(residual.start_energy));
  object.set("reached", Json::of(residual.milliseconds.has_value()));
  object.set("ms", residual.milliseconds ? rounded(*residual.milliseconds) : Json());
  object.set("iterations", Json::whole(residual.iterations));
  object.set("curve", curve_json(residual.curve));
  return object;
}

/// A number of an object; 0 if the key is missing.
double number_at(const Json& object, const char* key) {
  const Json* value = object.find(key);
  return value != nullptr && value->is(Json::Kind::number) ? value->number : 0;
}

std::string text_at(const Json& object, const char* key) {
  const Json* value = object.find(key);
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

/// " 1.23x"; empty if the number has no counterpart.
std::string ratio_text(const Json* ratios, const std::string& key) {
  const Json* ratio = ratios == nullptr ? nullptr : ratios->find(key);
  if (ratio == nullptr) return "";
  char text[32];
  std::snprintf(text, sizeof text, "  %6.2fx", ratio->number);
  return text;
}

void print_head(const Json& now) {
  std::printf("%s, size %s: %s particles, %s constraints\n", text_at(now, "name").c_str(),
              text_at(now, "size").c_str(), text_at(now, "particles").c_str(),
              text_at(now, "constraints").c_str());
  std::printf("  threads %s, %s, %s, %s substeps of %s; %s steps\n", text_at(now, "threads").c_str(),
              text_at(now, "simd").c_str(), text_at(now, "solver").c_str(), text_at(now, "substeps").c_str(),
              text_at(now, "iterations").c_str(), text_at(now, "runs").c_str());
  const std::string diagnostic = now.find("remark") != nullptr ? text_at(now, "remark") : "";
  if (!diagnostic.empty()) std::printf("  %s\n", diagnostic.c_str());
}

void print_members(const Json& now, const char* key, const Json* ratio, double unit, const char* unit_name) {
  const Json* values = now.find(key);
  if (values == nullptr) return;
  for (const Member& member : values->members)
    std::printf("    %-20s %10.3f %s%s\n", member.key.c_str(), member.value.number / unit, unit_name,
                ratio_text(ratio, member.key).c_str());
}

void print_residual(const Json& residual) {
  const double target = 100 * number_at(residual, "target");
  const Json* reached = residual.find("reached");
  if (reached != nullptr && reached->boolean) {
    std::printf("  %-22s %10.3f ms, %s iterations\n",
                ("to a strain of " + scene_format::number_text(target) + " %").c_str(),
                number_at(residual, "ms"), text_at(residual, "iterations").c_str());
    return;
  }
  const Json* curve = residual.find("curve");
  const double last =
      curve == nullptr || curve->items.empty() ? 0 : number_at(curve->items.back(), "mean_strain");
  std::printf("  a strain of %g %% was not reached in %s iterations: %.3g %%\n", target,
              text_at(residual, "iterations").c_str(), 100 * last);
}

/// Lists settings that differ between two results: then their ratio is not a speed-up of the code alone.
void print_differences(const Json& now, const Json& before) {
  for (const char* key : {"name", "size", "threads", "simd", "substeps", "iterations", "solver", "sweep",
                          "relaxation", "chebyshev", "colors", "mode"}) {
    const std::string is = text_at(now, key), was = text_at(before, key);
    if (is != was) std::printf("  %s: %s, was %s\n", key, is.c_str(), was.c_str());
  }
  const bool same_steps = text_at(now, "runs") == text_at(before, "runs") &&
                          text_at(now, "warm_up") == text_at(before, "warm_up");
  if (same_steps && text_at(now, "hash") != text_at(before, "hash"))
    std::printf("  the results differ: hash %s, was %s\n", text_at(now, "hash").c_str(),
                text_at(before, "hash").c_str());
}

}  // namespace

Json bench_json(const BenchResult& r) {
  char hash[20];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(r.hash));
  Json object = Json::object();
  object.set("name", Json::of(r.name));
  object.set("size", Json::whole(r.size));
  object.set("threads", Json::whole(r.threads));
  object.set("simd", Json::of(r.simd));
  object.set("version", Json::of(version));
  object.set("solver", Json::of(r.solver));
  object.set("sweep", Json::of(r.sweep));
  object.set("relaxation", rounded(r.relaxation));
  object.set("chebyshev", rounded(r.chebyshev));
  object.set("colors", Json::whole(r.colors));
  object.set("mode", Json::of(r.mode));
  object.set("substeps", Json::whole(r.substeps));
  object.set("iterations", Json::whole(r.iterations));
  object.set("warm_up", Json::whole(r.warm_up));
  object.set("runs", Json::whole(r.runs));
  object.set("particles", Json::whole(static_cast<std::int64_t>(r.particles)));
  object.set("constraints", Json::whole(static_cast<std::int64_t>(r.constraints)));
  object.set("ms_per_step", rounded(r.ms_per_step));
  object.set("ms_fastest", rounded(r.ms_fastest));
  object.set("ms_per_stage", named_values_json(r.ms_per_stage));
  object.set("constraints_per_second", rounded(r.constraints_per_second));
  object.set("projections_per_second", named_values_json(r.projections_per_second));
  object.set("max_strain", rounded(r.max_strain));
  object.set("hash", Json::of(hash));
  if (r.crossings) object.set("crossings", Json::whole(static_cast<std::int64_t>(*r.crossings)));
  if (!r.diagnostic.empty()) object.set("remark", Json::of(r.diagnostic));
  if (r.residual) object.set("residual", residual_json(*r.residual));
  return object;
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
  Json faster;
  if (before != nullptr) faster = speed_up(now, *before);
  print_head(now);
  std::printf("  %-22s %10.3f ms%s\n", "a step", number_at(now, "ms_per_step"),
              ratio_text(&faster, "ms_per_step").c_str());
  print_members(now, "ms_per_stage", faster.find("ms_per_stage"), 1, "ms");
  std::printf("  %-22s %10.3f million/s\n", "constraints", number_at(now, "constraints_per_second") / 1e6);
  std::printf("  projection alone\n");
  print_members(now, "projections_per_second", faster.find("projections_per_second"), 1e6, "million/s");
  if (const Json* residual = now.find("residual")) print_residual(*residual);
  std::printf("  largest strain %s, hash %s\n", percent(number_at(now, "max_strain")).c_str(),
              text_at(now, "hash").c_str());
  if (now.find("crossings") != nullptr)
    std::printf("  %.0f edges pass through triangles of the same cloth\n", number_at(now, "crossings"));
  if (before != nullptr) print_differences(now, *before);
}

}  // namespace souple::app
