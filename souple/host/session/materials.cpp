#include "souple/host/session/materials.h"

#include "souple/host/material_tunables.h"
#include "souple/objects/kind_functions.h"
#include "souple/scene/nearest.h"

#include <cmath>
#include <optional>

namespace souple::host {

namespace {

const KindFunctions& functions_of_kind(Kind kind) {
  return functions_of(static_cast<ObjectKind>(kind));
}

/// The preset of a kind, or nullopt.
std::optional<AnyMaterial> find_preset(Kind kind, const std::string& name) {
  const auto find = functions_of_kind(kind).find_preset;
  return find == nullptr ? std::nullopt : find(name);
}

}  // namespace

AnyMaterial make_material(Kind kind, const std::string& preset) {
  if (preset.empty()) return functions_of_kind(kind).default_material();
  if (const std::optional<AnyMaterial> found = find_preset(kind, preset)) return *found;
  throw Error("there is no preset \"" + preset + "\" of kind " + kind_name(kind) +
              scene_format::suggestion(preset, preset_names(kind)));
}

std::vector<std::string> preset_names(Kind kind) {
  std::vector<std::string> fitting;
  for (const std::string& name : material::names())
    if (find_preset(kind, name)) fitting.push_back(name);
  return fitting;
}

std::vector<Parameter> parameters_of(const AnyMaterial& material, Mode mode) {
  std::vector<Parameter> parameters;
  const auto add = [&](const auto& m) {
    for (const auto& tunable : tunables(m)) {
      if (!is_used(tunable, m, mode == Mode::pbd)) continue;
      const std::string label = tunable.label;
      const double value = static_cast<double>(m.*tunable.field);
      parameters.push_back({tunable.name, label.substr(label.find_first_not_of(' ')), tunable.unit, value,
                            static_cast<double>(tunable.range.least), static_cast<double>(tunable.range.most),
                            tunable.range.logarithmic});
    }
  };
  std::visit(add, material);
  return parameters;
}

AnyMaterial with_parameter(const AnyMaterial& material, const std::string& name, double value) {
  const auto change = [&](auto m) -> AnyMaterial {
    std::vector<std::string> known;
    for (const auto& tunable : tunables(m)) {
      known.emplace_back(tunable.name);
      if (tunable.name != name) continue;
      m.*tunable.field = static_cast<float>(value);
      return m;
    }
    throw Error("there is no parameter \"" + name + "\"" + scene_format::suggestion(name, known));
  };
  return std::visit(change, material);
}

}  // namespace souple::host
