#include "app/view/panels.h"
#include "app/view/widgets.h"
#include "souple/host/material_tunables.h"
#include "souple/objects/kind_functions.h"

#include <imgui.h>
#include <string>
#include <vector>

namespace souple::viewer {

namespace {

template <class M>
bool preset_row(MaterialDescription<M>& material) {
  static const std::vector<std::string> names = material::names();
  const auto find = functions_of(Material(M{})).find_preset;
  if (find == nullptr) return false;
  std::vector<const char*> fitting{"(none)"};
  int chosen = 0;
  for (const std::string& name : names) {
    if (!find(name)) continue;
    if (name == material.preset) chosen = static_cast<int>(fitting.size());
    fitting.push_back(name.c_str());
  }
  if (!choice_row("Preset", "##preset", chosen, fitting, "Sets every value below.")) return false;
  const bool none = chosen == 0;
  static_cast<M&>(material) =
      none ? M{} : std::get<M>(find(fitting[static_cast<std::size_t>(chosen)]).value());
  material.preset = none ? "" : fitting[static_cast<std::size_t>(chosen)];
  return true;
}

bool preset_row(MaterialDescription<FluidMaterial>& material) {
  const float spacing = material.spacing;  // cannot be changed
  const bool changed = preset_row<FluidMaterial>(material);
  material.spacing = spacing;
  return changed;
}
template <class M>
bool preset_row(const M&) {
  return false;  // there are no presets
}

bool model_rows(MaterialDescription<ClothMaterial>& material) {
  int stretch = static_cast<int>(material.stretch), bending = static_cast<int>(material.bending);
  bool changed = choice_row("Stretch model", "##stretch", stretch, {"springs", "membrane"});
  changed |= choice_row("Bending model", "##bending", bending, {"isometric", "dihedral", "distance", "none"});
  material.stretch = static_cast<StretchModel>(stretch);
  material.bending = static_cast<BendingModel>(bending);
  return changed;
}
bool model_rows(MaterialDescription<SoftBodyMaterial>& material) {
  int model = static_cast<int>(material.model);
  const bool changed = choice_row("Model", "##model", model, {"neo-Hookean", "springs", "shape matching"});
  material.model = static_cast<SoftBodyModel>(model);
  return changed;
}
template <class M>
bool model_rows(const M&) {
  return false;
}

template <class Description>
void rows(Simulation& simulation, std::size_t object) {
  auto material = std::get<Description>(simulation.scene().objects[object]).material;
  bool changed = preset_row(material);
  changed |= model_rows(material);
  const bool pbd = simulation.scene().settings.mode == Mode::pbd;
  if constexpr (requires { host::tunables(material); })
    for (const auto& tunable : host::tunables(material)) {
      if (!host::is_used(tunable, material, pbd)) continue;
      const SliderRange range{tunable.range.least, tunable.range.most, tunable.range.logarithmic};
      changed |= slider_row(tunable.label, std::string("##") + tunable.name, material.*tunable.field, range,
                            tunable.unit);
    }
  if (changed) simulation.set_material(object, material);
}

void object_row(const Simulation& simulation, std::size_t& chosen) {
  std::vector<const char*> names;
  for (const AnyObjectDescription& object : simulation.scene().objects)
    names.push_back(common(object).name.c_str());
  int position = static_cast<int>(chosen);
  if (choice_row("Object", "##object", position, names)) chosen = static_cast<std::size_t>(position);
}

}  // namespace

void material_panel(Simulation& simulation, std::size_t& chosen) {
  const std::vector<AnyObjectDescription>& objects = simulation.scene().objects;
  if (objects.empty() || !section("Material")) return;
  if (chosen >= objects.size()) chosen = 0;
  object_row(simulation, chosen);
  // The description changes meanwhile: only its type is used.
  std::visit([&]<class Description>(const Description&) { rows<Description>(simulation, chosen); },
             objects[chosen]);
}

}  // namespace souple::viewer
