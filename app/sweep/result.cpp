#include "app/sweep/result.h"

#include "souple/error.h"
#include "souple/files/atomic_file.h"
#include "souple/files/file.h"
#include "souple/scene/json.h"

#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace souple::app {

namespace fs = std::filesystem;
using scene_format::Json;

namespace {

constexpr const char* status_names[] = {"finished", "diverged", "failed", "missing"};

fs::path result_file(const Sweep& sweep, std::uint64_t run) {
  return sweep.folder_of(run) / "result.json";
}

Json number_or_null(double value) {
  return std::isfinite(value) ? Json::of(value) : Json{};
}

/// Members of a result. A damaged file throws Error.
class Reader {
 public:
  explicit Reader(const fs::path& file)
      : json_(scene_format::parse_json(read_whole_file(file), file.string())) {}

  const Json& member(const char* key, Json::Kind kind) const {
    const Json* const found = json_.find(key);
    if (found == nullptr || !found->is(kind)) throw Error("not a result");
    return *found;
  }
  const std::string& text(const char* key) const { return member(key, Json::Kind::text).text; }
  double number(const char* key) const { return member(key, Json::Kind::number).number; }
  std::uint64_t count(const char* key) const {
    constexpr double most = 9007199254740992.0;  // 2^53
    const double value = number(key);
    if (!(value >= 0 && value <= most)) throw Error("not a result");
    return static_cast<std::uint64_t>(value);
  }

 private:
  Json json_;
};

RunResult result_in(const fs::path& file, const std::string& id) {
  const Reader reader(file);
  RunResult result;
  if (reader.text("sweep") != id) return result;
  const std::string& status = reader.text("status");
  for (std::size_t i = 0; i < std::size(status_names); ++i)
    if (status == status_names[i]) result.status = static_cast<RunResult::Status>(i);
  result.error = reader.text("error");
  result.frames = reader.count("frames");
  result.hash = reader.text("hash");
  result.seconds = reader.number("seconds");
  for (const scene_format::Member& member : reader.member("values", Json::Kind::object).members) {
    const bool known = member.value.is(Json::Kind::number);
    result.values.emplace_back(member.key,
                               known ? member.value.number : std::numeric_limits<double>::quiet_NaN());
  }
  return result;
}

}  // namespace

const char* status_name(RunResult::Status status) {
  return status_names[static_cast<std::size_t>(status)];
}

void write_result(const Sweep& sweep, std::uint64_t run, const RunResult& result) {
  Json values = Json::object();
  for (const auto& [name, value] : result.values) values.set(name, number_or_null(value));
  Json json = Json::object();
  json.set("sweep", Json::of(sweep.id));
  json.set("run", Json::whole(static_cast<std::int64_t>(run)));
  json.set("status", Json::of(status_name(result.status)));
  json.set("error", Json::of(result.error));
  json.set("frames", Json::whole(static_cast<std::int64_t>(result.frames)));
  json.set("hash", Json::of(result.hash));
  json.set("values", std::move(values));
  json.set("seconds", number_or_null(result.seconds));
  create_folder(sweep.folder_of(run));
  write_file_atomically(result_file(sweep, run), scene_format::dump_json(json), Sync::yes);
}

RunResult read_result(const Sweep& sweep, std::uint64_t run) {
  const fs::path file = result_file(sweep, run);
  std::error_code error;
  if (!fs::exists(file, error)) return {};
  try {
    return result_in(file, sweep.id);
  } catch (const Error&) {
    return {};
  }
}

}  // namespace souple::app
