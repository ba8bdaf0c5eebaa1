#include "souple/host/session/materials.h"

#include "souple/host/material_tunables.h"
#include "souple/scene/nearest.h"

#include <cmath>
#include <optional>

namespace souple::host {

namespace {

/// The preset of a kind, or nullopt.
std::optional<AnyMaterial> find_preset(Kind kind, const std::string& name) {
  const auto copied = [](const auto* found) {
    return found == nullptr ? std::nullopt : std::optional<AnyMaterial>(*found);
  };
  switch (kind) {
    case Kind::cloth:
      return copied(material::find_cloth(name));
    case Kind::soft_body:
      return copied(material::find_soft_body(name));
    case Kind::rope:
      return copied(material::find_rope(name));
    case Kind::grains:
      return copied(material::find_grains(name));
    case Kind::fluid:
      return copied(material::find_fluid(name));
    case Kind::obstacle:
      break;
  }
  return std::nullopt;
}

AnyMaterial default_material(Kind kind) {
  switch (kind) {
    case Kind::cloth:
      return ClothMaterial{};
    case Kind::soft_body:
      return SoftBodyMaterial{};
    case Kind::rope:
      return RopeMaterial{};
    case Kind::grains:
      return GrainsMaterial{};
    case Kind::fluid:
      return FluidMaterial{};
    case Kind::obstacle:
      break;
  }
  return ObstacleMaterial{};
}

}  // namespace

AnyMaterial material_of(const World& world, ObjectId object) {
  switch (world.kind(object)) {
    case ObjectKind::cloth:
      return world.cloth_material(object);
    case ObjectKind::soft_body:
      return world.soft_body_material(object);
    case ObjectKind::rope:
      return world.rope_material(object);
    case ObjectKind::grains:
      return world.grains_material(object);
    case ObjectKind::fluid:
      return world.fluid_material(object);
    case ObjectKind::obstacle:
      break;
  }
  return world.obstacle_material(object);
}

void set_material(World& world, ObjectId object, const AnyMaterial& material) {
  std::visit([&](const auto& m) { world.set_material(object, m); }, material);
}

AnyMaterial make_material(Kind kind, const std::string& preset) {
  if (preset.empty()) return default_material(kind);
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
