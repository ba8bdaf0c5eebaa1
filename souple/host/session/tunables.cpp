#include "souple/host/session/contents.h"
#include "souple/host/session/impl.h"
#include "souple/scene/nearest.h"
#include "souple/solver/solver_names.h"

// Settings and materials that a panel edits.

namespace souple::host {

int Session::substeps() const {
  return impl_->contents->world().settings().substeps;
}
int Session::iterations() const {
  return impl_->contents->world().settings().iterations;
}

std::string Session::mode() const {
  return name_in(mode_names, impl_->contents->world().settings().mode);
}

std::vector<std::string> Session::modes() {
  std::vector<std::string> names;
  for (const auto& [name, mode] : mode_names) names.emplace_back(name);
  return names;
}

void Session::set_substeps(int substeps) {
  Settings settings = impl_->contents->world().settings();
  settings.substeps = substeps;
  impl_->contents->set_settings(settings);
}

void Session::set_iterations(int iterations) {
  Settings settings = impl_->contents->world().settings();
  settings.iterations = iterations;
  impl_->contents->set_settings(settings);
}

void Session::set_mode(const std::string& wanted) {
  for (const auto& [name, mode] : mode_names) {
    if (name != wanted) continue;
    Settings settings = impl_->contents->world().settings();
    settings.mode = mode;
    return impl_->contents->set_settings(settings);
  }
  throw Error("there is no mode \"" + wanted + "\"" + scene_format::suggestion(wanted, modes()));
}

std::array<float, 3> Session::gravity() const {
  const Vec3f& g = impl_->contents->world().settings().gravity;
  return {g.x, g.y, g.z};
}

void Session::set_gravity(float x, float y, float z) {
  Settings settings = impl_->contents->world().settings();
  settings.gravity = {x, y, z};
  impl_->contents->set_settings(settings);
}

std::array<float, 3> Session::wind() const {
  const Vec3f& v = impl_->contents->world().settings().wind.velocity;
  return {v.x, v.y, v.z};
}

void Session::set_wind(float x, float y, float z, float gust) {
  Settings settings = impl_->contents->world().settings();
  settings.wind.velocity = {x, y, z};
  settings.wind.gust = gust;
  impl_->contents->set_settings(settings);
}

std::vector<Parameter> Session::parameters(Handle object) const {
  return parameters_of(impl_->contents->item(object).material, impl_->contents->world().settings().mode);
}

void Session::set_parameter(Handle object, const std::string& name, double value) {
  impl_->contents->set_material(object, with_parameter(impl_->contents->item(object).material, name, value));
}

std::vector<std::string> Session::presets(Handle object) const {
  return preset_names(impl_->contents->item(object).kind);
}

void Session::set_preset(Handle object, const std::string& name) {
  impl_->contents->set_material(object, make_material(impl_->contents->item(object).kind, name));
}

}  // namespace souple::host
