#include "app/view/panels.h"
#include "app/view/widgets.h"

#include <imgui.h>
#include <string>
#include <type_traits>
#include <vector>

namespace souple::viewer {

namespace {

/// When a knob turns anything.
enum class Where { always, membrane, pbd };

/// One number of a material.
template <class Material>
struct Knob {
  const char* name;
  const char* id;  ///< as in scene files
  const char* unit;
  float Material::*field;
  SliderRange range;
  Where where = Where::always;
};

constexpr SliderRange logarithmic(float lo, float hi) {
  return {lo, hi, true};
}
constexpr SliderRange fraction{0, 1, false};

using C = ClothMaterial;
const std::vector<Knob<C>> cloth_knobs{
    {"Density", "areal_density", "kg/m\xc2\xb2", &C::areal_density, logarithmic(0.01f, 10)},
    {"Stretching", "membrane_stiffness", "N/m", &C::membrane_stiffness, logarithmic(1, 1e6f)},
    {"  weft", "weft_stiffness", "N/m", &C::weft_stiffness, logarithmic(1, 1e6f), Where::membrane},
    {"  shear", "shear_stiffness", "N/m", &C::shear_stiffness, logarithmic(1, 1e6f), Where::membrane},
    {"  Poisson's ratio", "poisson_ratio", "", &C::poisson_ratio, {0, 0.95f}, Where::membrane},
    {"Bending", "bending_stiffness", "N m", &C::bending_stiffness, logarithmic(1e-8f, 1)},
    {"Thickness", "thickness", "m", &C::thickness, logarithmic(1e-4f, 0.2f)},
    {"Friction", "friction", "", &C::friction, {0, 2}},
    {"Restitution", "restitution", "", &C::restitution, fraction},
    {"Damping", "damping", "1/s", &C::damping, logarithmic(1e-3f, 100)},
    {"Damping time", "damping_time", "s", &C::damping_time, logarithmic(1e-6f, 1)},
    {"Air drag", "air_drag", "", &C::air_drag, {0, 3}},
    {"Air lift", "air_lift", "", &C::air_lift, {0, 3}},
    {"PBD stretching", "pbd_stretch", "", &C::pbd_stretch, fraction, Where::pbd},
    {"PBD bending", "pbd_bending", "", &C::pbd_bending, fraction, Where::pbd},
};

using B = SoftBodyMaterial;
const std::vector<Knob<B>> soft_body_knobs{
    {"Young's modulus", "young_modulus", "Pa", &B::young_modulus, logarithmic(100, 1e9f)},
    {"Poisson's ratio", "poisson_ratio", "", &B::poisson_ratio, {0, 0.49f}},
    {"Density", "density", "kg/m\xc2\xb3", &B::density, logarithmic(10, 2e4f)},
    {"Thickness", "thickness", "m", &B::thickness, logarithmic(1e-4f, 0.2f)},
    {"Friction", "friction", "", &B::friction, {0, 2}},
    {"Restitution", "restitution", "", &B::restitution, fraction},
    {"Damping", "damping", "1/s", &B::damping, logarithmic(1e-3f, 100)},
    {"Damping time", "damping_time", "s", &B::damping_time, logarithmic(1e-6f, 1)},
    {"PBD stiffness", "pbd_stiffness", "", &B::pbd_stiffness, fraction, Where::pbd},
};

using R = RopeMaterial;
const std::vector<Knob<R>> rope_knobs{
    {"Radius", "radius", "m", &R::radius, logarithmic(1e-4f, 0.2f)},
    {"Young's modulus", "young_modulus", "Pa", &R::young_modulus, logarithmic(1e4f, 1e12f)},
    {"Density", "density", "kg/m\xc2\xb3", &R::density, logarithmic(10, 2e4f)},
    {"Bending", "bending_stiffness", "N m\xc2\xb2", &R::bending_stiffness, logarithmic(1e-8f, 100)},
    {"Friction", "friction", "", &R::friction, {0, 2}},
    {"Restitution", "restitution", "", &R::restitution, fraction},
    {"Damping", "damping", "1/s", &R::damping, logarithmic(1e-3f, 100)},
    {"Damping time", "damping_time", "s", &R::damping_time, logarithmic(1e-6f, 1)},
    {"PBD stretching", "pbd_stretch", "", &R::pbd_stretch, fraction, Where::pbd},
    {"PBD bending", "pbd_bending", "", &R::pbd_bending, fraction, Where::pbd},
};

using G = GrainsMaterial;
const std::vector<Knob<G>> grains_knobs{
    {"Radius", "radius", "m", &G::radius, logarithmic(1e-3f, 0.5f)},
    {"Density", "density", "kg/m\xc2\xb3", &G::density, logarithmic(10, 2e4f)},
    {"Friction", "friction", "", &G::friction, {0, 2}},
    {"Restitution", "restitution", "", &G::restitution, fraction},
    {"Damping", "damping", "1/s", &G::damping, logarithmic(1e-3f, 100)},
};

using O = ObstacleMaterial;
const std::vector<Knob<O>> obstacle_knobs{
    {"Thickness", "thickness", "m", &O::thickness, logarithmic(1e-4f, 0.2f)},
    {"Friction", "friction", "", &O::friction, {0, 2}},
    {"Restitution", "restitution", "", &O::restitution, fraction},
};

template <class Material>
bool is_membrane(const Material& material) {
  if constexpr (std::is_base_of_v<ClothMaterial, Material>) return material.stretch == StretchModel::membrane;
  return false;
}

/// The presets that are of this kind: `find` gives one, or nullptr.
template <class Material, class Find>
bool preset_row(MaterialDescription<Material>& material, Find find) {
  static const std::vector<std::string> names = material::names();
  std::vector<const char*> fitting{"(none)"};
  int chosen = 0;
  for (const std::string& name : names) {
    if (find(name) == nullptr) continue;
    if (name == material.preset) chosen = static_cast<int>(fitting.size());
    fitting.push_back(name.c_str());
  }
  if (!choice_row("Preset", "##preset", chosen, fitting, "Sets every value below.")) return false;
  const bool none = chosen == 0;
  static_cast<Material&>(material) = none ? Material{} : *find(fitting[static_cast<std::size_t>(chosen)]);
  material.preset = none ? "" : fitting[static_cast<std::size_t>(chosen)];
  return true;
}

bool preset_row(MaterialDescription<ClothMaterial>& material) {
  return preset_row(material, material::find_cloth);
}
bool preset_row(MaterialDescription<SoftBodyMaterial>& material) {
  return preset_row(material, material::find_soft_body);
}
bool preset_row(MaterialDescription<RopeMaterial>& material) {
  return preset_row(material, material::find_rope);
}
bool preset_row(MaterialDescription<GrainsMaterial>& material) {
  return preset_row(material, material::find_grains);
}
bool preset_row(const ObstacleMaterial&) {
  return false;  // there is none
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
bool model_rows(const ObstacleMaterial&) {
  return false;
}
template <class Material>
bool model_rows(MaterialDescription<Material>&) {
  return false;
}

template <class Description, class Material>
void rows(Simulation& simulation, std::size_t object, const std::vector<Knob<Material>>& knobs) {
  auto material = std::get<Description>(simulation.scene().objects[object]).material;
  bool changed = preset_row(material);
  changed |= model_rows(material);
  for (const Knob<Material>& knob : knobs) {
    if (knob.where == Where::membrane && !is_membrane(material)) continue;
    if (knob.where == Where::pbd && simulation.scene().settings.mode != Mode::pbd) continue;
    changed |=
        slider_row(knob.name, std::string("##") + knob.id, material.*knob.field, knob.range, knob.unit);
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
  switch (kind_of(objects[chosen])) {
    case ObjectKind::cloth:
      return rows<ClothDescription>(simulation, chosen, cloth_knobs);
    case ObjectKind::soft_body:
      return rows<SoftBodyDescription>(simulation, chosen, soft_body_knobs);
    case ObjectKind::rope:
      return rows<RopeDescription>(simulation, chosen, rope_knobs);
    case ObjectKind::grains:
      return rows<GrainsDescription>(simulation, chosen, grains_knobs);
    case ObjectKind::obstacle:
      return rows<ObstacleDescription>(simulation, chosen, obstacle_knobs);
  }
}

}  // namespace souple::viewer
