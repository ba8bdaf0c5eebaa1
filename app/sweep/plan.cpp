#include "app/sweep/plan.h"

#include "souple/error.h"
#include "souple/scene/json.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/core.h>

namespace souple::app {

namespace {

using scene_format::Json;

constexpr std::uint64_t most_values = SweepPlan::most_runs;

std::optional<double> number_in(const std::string& text) {
  try {
    const Json json = scene_format::parse_json(text, "");
    if (json.is(Json::Kind::number)) return json.number;
  } catch (const Error&) {
  }
  return std::nullopt;
}

bool is_json(const std::string& text) {
  try {
    scene_format::parse_json(text, "");
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Splits at each `separator` outside of brackets and quotes.
std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts(1);
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' && (i == 0 || text[i - 1] != '\\')) quoted = !quoted;
    if (!quoted && (c == '[' || c == '{')) ++depth;
    if (!quoted && (c == ']' || c == '}')) --depth;
    if (c == separator && depth == 0 && !quoted) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// Twelve digits: equal for every C library, although their pow() differ in the last bits.
std::string rounded(double value) {
  return scene_format::number_text(std::strtod(fmt::format("{:.12g}", value).c_str(), nullptr));
}

struct ValueRange {
  double first, last;
  std::uint64_t count;
  bool logarithmic;
};

std::vector<std::string> values_in(const ValueRange& range) {
  std::vector<std::string> values{scene_format::number_text(range.first)};
  const double n = static_cast<double>(range.count - 1);
  for (std::uint64_t i = 1; i + 1 < range.count; ++i) {
    const double at = static_cast<double>(i);
    // The sums are exact where first, last and the step are whole.
    values.push_back(rounded(range.logarithmic ? range.first * std::pow(range.last / range.first, at / n)
                                               : (range.first * (n - at) + range.last * at) / n));
  }
  values.push_back(scene_format::number_text(range.last));
  return values;
}

std::optional<std::uint64_t> count_in(const std::string& text) {
  if (text.empty() || text.size() > 6 || text.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  const std::uint64_t count = std::strtoull(text.c_str(), nullptr, 10);
  return count >= 2 && count <= most_values ? std::optional(count) : std::nullopt;
}

[[noreturn]] void refuse(const std::string& argument, const std::string& expected) {
  throw Error(fmt::format("--set {}: {}", scene_format::brief(Json::of(argument)), expected));
}

/// The range in "A:B:N" or "A:B:logN"; nothing where the first part is no number: a text with colons.
std::optional<ValueRange> range_in(const std::string& argument, const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  const std::optional<double> first = number_in(parts[0]);
  if (parts.size() < 2 || !first) return std::nullopt;
  const char* const expected = "expected A:B:N, N values from A to B, or A:B:logN, such as 1e-6:1e-4:log5";
  const std::optional<double> last = number_in(parts[1]);
  if (parts.size() != 3 || !last) refuse(argument, expected);
  const bool logarithmic = parts[2].rfind("log", 0) == 0;
  const std::optional<std::uint64_t> count = count_in(logarithmic ? parts[2].substr(3) : parts[2]);
  if (!count)
    refuse(argument, fmt::format("expected a number of values from 2 to {} at the end", most_values));
  if (*first == *last) refuse(argument, "expected two different numbers at the ends of the range");
  if (logarithmic && !(*first * *last > 0))
    refuse(argument, "a logarithmic range needs ends of one sign, without zero");
  return ValueRange{*first, *last, *count, logarithmic};
}

std::vector<std::string> list_in(const std::string& argument, const std::string& text) {
  std::vector<std::string> values = split(text, ',');
  if (values.size() == 1) return values;
  std::set<std::string> seen;
  for (const std::string& value : values) {
    if (value.empty()) refuse(argument, "a value of the list is empty; expected A,B,C");
    if (!seen.insert(value).second)
      refuse(argument, fmt::format("the list has {} twice", scene_format::brief(Json::of(value))));
  }
  return values;
}

}  // namespace

SweepSetting parse_sweep_setting(const std::string& argument) {
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos || equals == 0)
    refuse(argument, "expected PATH=VALUES, such as substeps=10,20,40 or wind.velocity.0=0:10:3");
  const std::string text = argument.substr(equals + 1);
  SweepSetting setting{argument.substr(0, equals), {}};
  if (is_json(text)) {
    setting.values = {text};
  } else if (const std::optional<ValueRange> range = range_in(argument, text)) {
    setting.values = values_in(*range);
  } else {
    setting.values = list_in(argument, text);
  }
  return setting;
}

SweepPlan::SweepPlan(const std::vector<std::string>& arguments) {
  std::set<std::string> paths;
  for (const std::string& argument : arguments) {
    settings_.push_back(parse_sweep_setting(argument));
    const SweepSetting& setting = settings_.back();
    if (!paths.insert(setting.path).second)
      refuse(argument, "the path is set twice; give all values at once");
    runs_ *= setting.values.size();
    if (runs_ > most_runs)
      throw Error(fmt::format("more than {} combinations; give fewer values", most_runs));
  }
  if (runs_ == 1)
    throw Error(
        "expected a --set with several values, such as --set substeps=10,20,40 (`souple run` makes one run)");
}

const std::string& SweepPlan::value_of(std::size_t setting, std::uint64_t run) const {
  std::uint64_t index = run - 1;
  for (std::size_t i = settings_.size() - 1; i > setting; --i) index /= settings_[i].values.size();
  const std::vector<std::string>& values = settings_[setting].values;
  return values[index % values.size()];
}

std::vector<std::string> SweepPlan::settings_of(std::uint64_t run) const {
  std::vector<std::string> settings;
  for (std::size_t i = 0; i < settings_.size(); ++i)
    settings.push_back(settings_[i].path + "=" + value_of(i, run));
  return settings;
}

std::vector<std::pair<std::string, std::string>> SweepPlan::values_of(std::uint64_t run) const {
  std::vector<std::pair<std::string, std::string>> values;
  for (std::size_t i = 0; i < settings_.size(); ++i)
    if (settings_[i].values.size() > 1) values.emplace_back(settings_[i].path, value_of(i, run));
  return values;
}

std::string SweepPlan::short_label_of(std::uint64_t run) const {
  std::string label;
  for (const auto& [path, value] : values_of(run)) {
    std::size_t dot = path.rfind('.');
    const bool component = dot != std::string::npos && dot + 2 == path.size();  // wind.velocity.0
    if (component && dot > 0) dot = path.rfind('.', dot - 1);
    if (!label.empty()) label += " ";
    label += (dot == std::string::npos ? path : path.substr(dot + 1)) + "=" + value;
  }
  return label;
}

std::string SweepPlan::label_of(std::uint64_t run) const {
  std::string label;
  for (const auto& [path, value] : values_of(run)) {
    if (!label.empty()) label += " ";
    label += path + "=" + value;
  }
  for (char& c : label)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';  // a message stays on one line
  return label;
}

}  // namespace souple::app
