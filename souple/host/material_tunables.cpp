#include "souple/host/material_tunables.h"

namespace souple::host {

namespace {

constexpr TunableRange logarithmic(float lo, float hi) {
  return {lo, hi, true};
}
constexpr TunableRange fraction{0, 1, false};

using C = ClothMaterial;
const std::vector<Tunable<C>> cloth_tunables{
    {"Density", "areal_density", "kg/m\xc2\xb2", &C::areal_density, logarithmic(0.01f, 10)},
    {"Stretching", "membrane_stiffness", "N/m", &C::membrane_stiffness, logarithmic(1, 1e6f)},
    {"  weft", "weft_stiffness", "N/m", &C::weft_stiffness, logarithmic(1, 1e6f), TunableUse::membrane},
    {"  shear", "shear_stiffness", "N/m", &C::shear_stiffness, logarithmic(1, 1e6f), TunableUse::membrane},
    {"  Poisson's ratio", "poisson_ratio", "", &C::poisson_ratio, {0, 0.95f}, TunableUse::membrane},
    {"Bending", "bending_stiffness", "N m", &C::bending_stiffness, logarithmic(1e-8f, 1)},
    {"Thickness", "thickness", "m", &C::thickness, logarithmic(1e-4f, 0.2f)},
    {"Friction", "friction", "", &C::friction, {0, 2}},
    {"Restitution", "restitution", "", &C::restitution, fraction},
    {"Damping", "damping", "1/s", &C::damping, logarithmic(1e-3f, 100)},
    {"Damping time", "damping_time", "s", &C::damping_time, logarithmic(1e-6f, 1)},
    {"Air drag", "air_drag", "", &C::air_drag, {0, 3}},
    {"Air lift", "air_lift", "", &C::air_lift, {0, 3}},
    {"PBD stretching", "pbd_stretch", "", &C::pbd_stretch, fraction, TunableUse::pbd},
    {"PBD bending", "pbd_bending", "", &C::pbd_bending, fraction, TunableUse::pbd},
};

using B = SoftBodyMaterial;
const std::vector<Tunable<B>> soft_body_tunables{
    {"Young's modulus", "young_modulus", "Pa", &B::young_modulus, logarithmic(100, 1e9f)},
    {"Poisson's ratio", "poisson_ratio", "", &B::poisson_ratio, {0, 0.49f}},
    {"Density", "density", "kg/m\xc2\xb3", &B::density, logarithmic(10, 2e4f)},
    {"Thickness", "thickness", "m", &B::thickness, logarithmic(1e-4f, 0.2f)},
    {"Friction", "friction", "", &B::friction, {0, 2}},
    {"Restitution", "restitution", "", &B::restitution, fraction},
    {"Damping", "damping", "1/s", &B::damping, logarithmic(1e-3f, 100)},
    {"Damping time", "damping_time", "s", &B::damping_time, logarithmic(1e-6f, 1)},
    {"PBD stiffness", "pbd_stiffness", "", &B::pbd_stiffness, fraction, TunableUse::pbd},
};

using R = RopeMaterial;
const std::vector<Tunable<R>> rope_tunables{
    {"Radius", "radius", "m", &R::radius, logarithmic(1e-4f, 0.2f)},
    {"Young's modulus", "young_modulus", "Pa", &R::young_modulus, logarithmic(1e4f, 1e12f)},
    {"Density", "density", "kg/m\xc2\xb3", &R::density, logarithmic(10, 2e4f)},
    {"Bending", "bending_stiffness", "N m\xc2\xb2", &R::bending_stiffness, logarithmic(1e-8f, 100)},
    {"Friction", "friction", "", &R::friction, {0, 2}},
    {"Restitution", "restitution", "", &R::restitution, fraction},
    {"Damping", "damping", "1/s", &R::damping, logarithmic(1e-3f, 100)},
    {"Damping time", "damping_time", "s", &R::damping_time, logarithmic(1e-6f, 1)},
    {"PBD stretching", "pbd_stretch", "", &R::pbd_stretch, fraction, TunableUse::pbd},
    {"PBD bending", "pbd_bending", "", &R::pbd_bending, fraction, TunableUse::pbd},
};

using G = GrainsMaterial;
const std::vector<Tunable<G>> grains_tunables{
    {"Radius", "radius", "m", &G::radius, logarithmic(1e-3f, 0.5f)},
    {"Density", "density", "kg/m\xc2\xb3", &G::density, logarithmic(10, 2e4f)},
    {"Friction", "friction", "", &G::friction, {0, 2}},
    {"Rolling friction", "rolling_friction", "", &G::rolling_friction, fraction},
    {"Restitution", "restitution", "", &G::restitution, fraction},
    {"Damping", "damping", "1/s", &G::damping, logarithmic(1e-3f, 100)},
};

// The spacing is not tunable: it defines the discretization.
using F = FluidMaterial;
const std::vector<Tunable<F>> fluid_tunables{
    {"Density", "density", "kg/m\xc2\xb3", &F::density, logarithmic(100, 2e4f)},
    {"Viscosity", "viscosity", "Pa s", &F::viscosity, logarithmic(1e-4f, 1000)},
    {"Smoothing", "xsph", "1/s", &F::xsph, logarithmic(0.1f, 1000)},
    {"Surface tension", "surface_tension", "N/m", &F::surface_tension, logarithmic(1e-3f, 10)},
    {"Contact angle", "contact_angle", "degrees", &F::contact_angle, {0, 180}},
    {"Vorticity", "vorticity", "m/s", &F::vorticity, logarithmic(1e-4f, 10)},
    {"Air drag", "air_drag", "", &F::air_drag, {0, 2}},
    {"Foam", "foam", "", &F::foam, {0, 4}},
    {"Friction", "friction", "", &F::friction, fraction},
    {"Restitution", "restitution", "", &F::restitution, fraction},
};

using O = ObstacleMaterial;
const std::vector<Tunable<O>> obstacle_tunables{
    {"Thickness", "thickness", "m", &O::thickness, logarithmic(1e-4f, 0.2f)},
    {"Friction", "friction", "", &O::friction, {0, 2}},
    {"Restitution", "restitution", "", &O::restitution, fraction},
};

using I = RigidBodyMaterial;
const std::vector<Tunable<I>> rigid_body_tunables{
    {"Thickness", "thickness", "m", &I::thickness, logarithmic(1e-4f, 0.2f)},
    {"Friction", "friction", "", &I::friction, {0, 2}},
    {"Restitution", "restitution", "", &I::restitution, fraction},
};

}  // namespace

const std::vector<Tunable<ClothMaterial>>& tunables(const ClothMaterial&) {
  return cloth_tunables;
}
const std::vector<Tunable<SoftBodyMaterial>>& tunables(const SoftBodyMaterial&) {
  return soft_body_tunables;
}
const std::vector<Tunable<RopeMaterial>>& tunables(const RopeMaterial&) {
  return rope_tunables;
}
const std::vector<Tunable<GrainsMaterial>>& tunables(const GrainsMaterial&) {
  return grains_tunables;
}
const std::vector<Tunable<ObstacleMaterial>>& tunables(const ObstacleMaterial&) {
  return obstacle_tunables;
}

const std::vector<Tunable<FluidMaterial>>& tunables(const FluidMaterial&) {
  return fluid_tunables;
}
const std::vector<Tunable<RigidBodyMaterial>>& tunables(const RigidBodyMaterial&) {
  return rigid_body_tunables;
}

bool uses_membrane(const ClothMaterial& material) {
  return material.stretch == StretchModel::membrane;
}

}  // namespace souple::host
