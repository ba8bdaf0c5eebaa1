#include "app/sweep/table.h"

#include "souple/error.h"
#include "souple/files/atomic_file.h"
#include "souple/scene/json.h"

#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace souple::app {

using scene_format::Json;

namespace {

/// The text of --set as its value: JSON, else text.
Json value_in(const std::string& text) {
  try {
    return scene_format::parse_json(text, "");
  } catch (const Error&) {
    return Json::of(text);
  }
}

/// Names of values, each once, in the order in which results have them.
std::vector<std::string> names_in(const std::vector<RunResult>& results) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const RunResult& result : results) {
    for (const auto& [name, value] : result.values)
      if (seen.insert(name).second) names.push_back(name);
  }
  return names;
}

std::optional<double> value_of(const RunResult& result, const std::string& name) {
  for (const auto& [known, value] : result.values)
    if (known == name && std::isfinite(value)) return value;
  return std::nullopt;
}

/// RFC 4180: quotes around what has a comma, a quote or a line feed.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + "\"";
}

std::string csv_head(const Sweep& sweep, const std::vector<std::string>& names) {
  std::string head = "run";
  for (const auto& [path, value] : sweep.plan.values_of(1)) head += "," + cell(path);
  head += ",status,frames";
  for (const std::string& name : names) head += "," + cell(name);
  return head + ",hash,error,seconds\n";
}

std::string csv_row(const Sweep& sweep, std::uint64_t run, const RunResult& result,
                    const std::vector<std::string>& names) {
  std::string row = fmt::format("{}", run);
  for (const auto& [path, value] : sweep.plan.values_of(run)) row += "," + cell(value);
  row += fmt::format(",{},{}", status_name(result.status), result.frames);
  for (const std::string& name : names) {
    const std::optional<double> value = value_of(result, name);
    row += value ? "," + scene_format::number_text(*value) : ",";
  }
  return row + fmt::format(",{},{},{:.3f}\n", result.hash, cell(result.error), result.seconds);
}

Json json_row(const Sweep& sweep, std::uint64_t run, const RunResult& result) {
  Json settings = Json::object(), values = Json::object();
  for (const auto& [path, text] : sweep.plan.values_of(run)) settings.set(path, value_in(text));
  for (const auto& [name, value] : result.values)
    values.set(name, std::isfinite(value) ? Json::of(value) : Json{});
  Json row = Json::object();
  row.set("run", Json::whole(static_cast<std::int64_t>(run)));
  row.set("settings", std::move(settings));
  row.set("status", Json::of(status_name(result.status)));
  row.set("frames", Json::whole(static_cast<std::int64_t>(result.frames)));
  row.set("values", std::move(values));
  row.set("hash", Json::of(result.hash));
  row.set("error", Json::of(result.error));
  row.set("seconds", Json::of(result.seconds));
  return row;
}

void count(RunResult::Status status, SweepCounts& counts) {
  switch (status) {
    case RunResult::Status::finished:
      ++counts.finished;
      return;
    case RunResult::Status::diverged:
      ++counts.diverged;
      return;
    case RunResult::Status::failed:
      ++counts.failed;
      return;
    case RunResult::Status::missing:
      ++counts.missing;
      return;
  }
}

}  // namespace

SweepCounts write_tables(const Sweep& sweep) {
  const OutputLock lock = wait_for_lock(sweep.out / table_name);
  std::vector<RunResult> results;
  SweepCounts counts;
  for (std::uint64_t run = 1; run <= sweep.plan.runs(); ++run) {
    results.push_back(read_result(sweep, run));
    count(results.back().status, counts);
  }
  const std::vector<std::string> names = names_in(results);
  std::string csv = csv_head(sweep, names);
  Json rows = Json::array();
  for (std::size_t i = 0; i < results.size(); ++i) {
    csv += csv_row(sweep, i + 1, results[i], names);
    rows.items.push_back(json_row(sweep, i + 1, results[i]));
  }
  write_file_atomically(sweep.out / table_name, csv);
  write_file_atomically(sweep.out / json_table_name, scene_format::dump_json(rows));
  return counts;
}

}  // namespace souple::app
