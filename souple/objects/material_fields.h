#pragma once

#include "souple/objects/materials.h"

#include <initializer_list>
#include <type_traits>
#include <utility>

// The fields of each material, listed once, in the order of their declaration. The World's checks, scene files, panels and Python
// visit them.

namespace souple {

/// Numbers that a field may have. In scene files every range is bounded, because a huge number is a typing error.
struct FieldRange {
  double lowest, highest;  ///< in scene files
  bool open_low = false;   ///< excludes `lowest`
  bool open_high = false;  ///< excludes `highest`
  bool exact = false;      ///< `highest` follows from what the number means, so that it binds programs too
  bool zero = false;       ///< programs may give 0 although `open_low`
  bool rigid = false;      ///< may be infinite where may_be_rigid allows it; in scene files "rigid"
};

/// Condition under which a field has an effect.
enum class FieldUse { always, membrane, pbd };

/// A field in a panel: the useful values, not all permitted ones. Without a label the panel leaves the field out.
struct Slider {
  const char* label = nullptr;  ///< begins with spaces if it belongs to the preceding field
  const char* unit = "";        ///< UTF-8; empty: a plain number
  float least = 0, most = 1;
  bool logarithmic = false;  ///< true: least > 0, and the left end stands for the value 0 too
  FieldUse use = FieldUse::always;
};

/// A member as an argument: a visitor gets it as a constant.
template <auto member>
struct Field {};
template <auto member>
inline constexpr Field<member> field{};

/// The words of an enumeration, in the order of its values.
template <class E>
using FieldWords = std::initializer_list<std::pair<const char*, E>>;

namespace fields {

constexpr FieldRange positive(double highest) {
  return {0, highest, true};
}
constexpr FieldRange from_zero(double highest) {
  return {0, highest};
}
constexpr FieldRange with_zero(FieldRange range) {
  range.zero = true;
  return range;
}
constexpr FieldRange or_rigid(FieldRange range) {
  range.rigid = true;
  return range;
}
constexpr FieldRange exactly(double lowest, double highest) {
  return {lowest, highest, false, false, true};
}
constexpr FieldRange below(double highest) {
  return {0, highest, false, true, true};
}
inline constexpr FieldRange part = exactly(0, 1), coefficient = from_zero(100);
inline constexpr FieldRange layer = with_zero(positive(10));  // m

constexpr Slider linear(const char* label, float most) {
  return {label, "", 0, most};
}
constexpr Slider logarithmic(const char* label, const char* unit, float least, float most,
                             FieldUse use = FieldUse::always) {
  return {label, unit, least, most, true, use};
}
constexpr Slider of_pbd(const char* label) {
  return {label, "", 0, 1, false, FieldUse::pbd};
}
inline constexpr Slider none{};
inline constexpr const char* in_pbd = "stiffness in mode \"pbd\"";
inline constexpr const char* half = "contact thickness [m]; contacts keep a distance of half of it";

template <class M, class V>
void density(V& visit, const Slider& slider, const char* doc = "density [kg/m^3]") {
  visit(field<&M::density>, "density", positive(1e6), doc, slider);
}
template <class M, class V>
void friction(V& visit) {
  visit(field<&M::friction>, "friction", coefficient, "Coulomb friction coefficient", linear("Friction", 2));
  visit(field<&M::kinetic_friction>, "kinetic_friction", coefficient,
        "friction coefficient while sliding, at most `friction`; if not given: `friction`", none);
}
template <class M, class V>
void restitution(V& visit) {
  visit(field<&M::restitution>, "restitution", part,
        "coefficient of restitution, the fraction of the speed that a bounce keeps",
        linear("Restitution", 1));
}
template <class M, class V>
void thickness(V& visit, const char* doc) {
  visit(field<&M::thickness>, "thickness", layer, doc, logarithmic("Thickness", "m", 1e-4f, 0.2f));
}
template <class M, class V>
void damping_rate(V& visit, const char* doc) {
  visit(field<&M::damping>, "damping", from_zero(1e4), doc, logarithmic("Damping", "1/s", 1e-3f, 100));
}
template <class M, class V>
void damping(V& visit) {
  visit(field<&M::damping_time>, "damping_time", from_zero(1000),
        "Kelvin-Voigt damping: stress = E (strain + damping_time * strain rate) [s]",
        logarithmic("Damping time", "s", 1e-6f, 1));
  damping_rate<M>(visit, "damping rate of all motion except rigid-body motion [1/s]");
}
template <class M, class V>
void pbd_stretch_and_bending(V& visit) {
  visit(field<&M::pbd_stretch>, "pbd_stretch", part, in_pbd, of_pbd("PBD stretching"));
  visit(field<&M::pbd_bending>, "pbd_bending", part, in_pbd, of_pbd("PBD bending"));
}

template <class M, class V>
void visit_all(V& visit) {
  if constexpr (std::is_same_v<M, ClothMaterial>) {
    constexpr FieldUse membrane = FieldUse::membrane;
    visit(field<&M::areal_density>, "areal_density", positive(1e4), "mass per area [kg/m^2]",
          logarithmic("Density", "kg/m\xc2\xb2", 0.01f, 10));
    visit(field<&M::membrane_stiffness>, "membrane_stiffness", or_rigid(with_zero(positive(1e12))),
          "Young's modulus times thickness [N/m]; in the membrane model that of the warp, which cannot be "
          "rigid",
          logarithmic("Stretching", "N/m", 1, 1e6f));
    visit(field<&M::weft_stiffness>, "weft_stiffness", from_zero(1e12),
          "stiffness of the weft in the membrane model [N/m]; 0: as membrane_stiffness",
          logarithmic("  weft", "N/m", 1, 1e6f, membrane));
    visit(field<&M::shear_stiffness>, "shear_stiffness", from_zero(1e12),
          "shear stiffness in the membrane model [N/m]; 0: isotropic, Y / (2 (1 + nu))",
          logarithmic("  shear", "N/m", 1, 1e6f, membrane));
    visit(field<&M::poisson_ratio>, "poisson_ratio", below(1), "Poisson's ratio in the membrane model",
          Slider{"  Poisson's ratio", "", 0, 0.95f, false, membrane});
    visit(field<&M::bending_stiffness>, "bending_stiffness", or_rigid(from_zero(1e9)),
          "bending stiffness per unit width [N m]; rigid only with bending \"distance\"",
          logarithmic("Bending", "N m", 1e-8f, 1));
    thickness<M>(visit, "thickness from side to side [m]");
    friction<M>(visit);
    restitution<M>(visit);
    damping<M>(visit);
    visit(field<&M::air_drag>, "air_drag", coefficient,
          "drag coefficient: force of the air along its direction", linear("Air drag", 3));
    visit(field<&M::air_lift>, "air_lift", coefficient,
          "lift coefficient: force of the air across its direction", linear("Air lift", 3));
    visit(field<&M::stretch>, "stretch",
          FieldWords<StretchModel>{{"springs", StretchModel::springs}, {"membrane", StretchModel::membrane}},
          "stretching model: a spring along each edge, or triangles of an orthotropic membrane");
    visit(field<&M::bending>, "bending",
          FieldWords<BendingModel>{{"isometric", BendingModel::isometric},
                                   {"dihedral", BendingModel::dihedral},
                                   {"distance", BendingModel::distance},
                                   {"none", BendingModel::none}},
          "bending model: isometric (flat at rest), dihedral (angles of the mesh at rest), or distance "
          "(springs across edges)");
    pbd_stretch_and_bending<M>(visit);
  } else if constexpr (std::is_same_v<M, SoftBodyMaterial>) {
    visit(field<&M::young_modulus>, "young_modulus", positive(1e13), "Young's modulus [Pa]",
          logarithmic("Young's modulus", "Pa", 100, 1e9f));
    visit(field<&M::poisson_ratio>, "poisson_ratio", below(0.5),
          "Poisson's ratio: transverse contraction over extension", linear("Poisson's ratio", 0.49f));
    density<M>(visit, logarithmic("Density", "kg/m\xc2\xb3", 10, 2e4f));
    thickness<M>(visit, half);
    friction<M>(visit);
    restitution<M>(visit);
    damping<M>(visit);
    visit(field<&M::model>, "model",
          FieldWords<SoftBodyModel>{{"neo_hookean", SoftBodyModel::neo_hookean},
                                    {"springs", SoftBodyModel::springs},
                                    {"shape_matching", SoftBodyModel::shape_matching}},
          "deformation model: tets of a neo-Hookean solid, cheap springs and tet volumes, or shape matching "
          "of the whole body "
          "(stiff)");
    visit(field<&M::pbd_stiffness>, "pbd_stiffness", part, in_pbd, of_pbd("PBD stiffness"));
  } else if constexpr (std::is_same_v<M, RopeMaterial>) {
    visit(field<&M::radius>, "radius", positive(100), "radius [m]", logarithmic("Radius", "m", 1e-4f, 0.2f));
    visit(field<&M::young_modulus>, "young_modulus", positive(1e13), "Young's modulus [Pa]",
          logarithmic("Young's modulus", "Pa", 1e4f, 1e12f));
    density<M>(visit, logarithmic("Density", "kg/m\xc2\xb3", 10, 2e4f));
    visit(field<&M::bending_stiffness>, "bending_stiffness", from_zero(1e9),
          "bending stiffness E I [N m^2]; 0: limp. A solid rod has E pi r^4 / 4, a laid rope far less",
          logarithmic("Bending", "N m\xc2\xb2", 1e-8f, 100));
    friction<M>(visit);
    restitution<M>(visit);
    damping<M>(visit);
    pbd_stretch_and_bending<M>(visit);
  } else if constexpr (std::is_same_v<M, GrainsMaterial>) {
    visit(field<&M::radius>, "radius", positive(100), "radius [m]", logarithmic("Radius", "m", 1e-3f, 0.5f));
    density<M>(visit, logarithmic("Density", "kg/m\xc2\xb3", 10, 2e4f), "density of one grain [kg/m^3]");
    friction<M>(visit);
    visit(field<&M::rolling_friction>, "rolling_friction", coefficient,
          "largest moment of a contact against rolling, as a part of radius times normal force; 0: perfect "
          "spheres. "
          "From about 1 on grains slide but do not roll",
          linear("Rolling friction", 1));
    restitution<M>(visit);
    damping_rate<M>(visit, "damping rate of motion relative to the whole object [1/s]");
  } else if constexpr (std::is_same_v<M, FluidMaterial>) {
    // The spacing is not tunable: it defines the discretization.
    visit(field<&M::spacing>, "spacing", positive(100),
          "distance between particles at rest, equal for all fluids of a scene [m]", none);
    density<M>(visit, logarithmic("Density", "kg/m\xc2\xb3", 100, 2e4f));
    visit(field<&M::viscosity>, "viscosity", from_zero(1e6), "dynamic viscosity [Pa s]",
          logarithmic("Viscosity", "Pa s", 1e-4f, 1000));
    visit(
        field<&M::xsph>, "xsph", from_zero(1e4),
        "XSPH smoothing: rate at which particles adopt the velocity of their neighbors; reduces noise [1/s]",
        logarithmic("Smoothing", "1/s", 0.1f, 1000));
    visit(field<&M::surface_tension>, "surface_tension", from_zero(1e4), "surface tension against air [N/m]",
          logarithmic("Surface tension", "N/m", 1e-3f, 10));
    visit(field<&M::contact_angle>, "contact_angle", exactly(0, 180),
          "contact angle of a drop on a wall, measured inside the drop [degrees]",
          Slider{"Contact angle", "degrees", 0, 180});
    visit(field<&M::vorticity>, "vorticity", from_zero(1e3),
          "strength of vorticity confinement, which adds energy to vortices [m/s]",
          logarithmic("Vorticity", "m/s", 1e-4f, 10));
    visit(field<&M::air_drag>, "air_drag", from_zero(1e3),
          "drag coefficient of the surface in air; a ball has 0.47", linear("Air drag", 2));
    visit(field<&M::foam>, "foam", exactly(0, 1000),
          "factor of the emission rates in the settings' `foam`; 0: no foam", linear("Foam", 4));
    visit(field<&M::friction>, "friction", part,
          "wall friction: 1 follows from the viscosity, 0 is free slip", linear("Friction", 1));
    restitution<M>(visit);
  } else if constexpr (std::is_same_v<M, ObstacleMaterial>) {
    thickness<M>(visit, half);
    friction<M>(visit);
    restitution<M>(visit);
  } else {
    static_assert(std::is_same_v<M, RigidBodyMaterial>);
    density<M>(visit, none);
    thickness<M>(visit,
                 "contact thickness [m]; cloth, ropes, soft bodies and grains keep a distance of half of it; "
                 "rigid bodies and "
                 "colliders touch the surface");
    friction<M>(visit);
    restitution<M>(visit);
  }
}

}  // namespace fields

/// Whether the stiffness may be infinite with the models that the material has chosen.
inline bool may_be_rigid(const ClothMaterial& m, float ClothMaterial::*stiffness) {
  return stiffness == &ClothMaterial::membrane_stiffness ? m.stretch == StretchModel::springs
                                                         : m.bending == BendingModel::distance;
}

/// visit_fields<M>(visit): visit(field<&M::member>, name, range, doc, slider) for each number, and
/// visit(field<&M::member>, name, words, doc) for each enumeration. The range of a kinetic friction ends at `friction` too.
template <class M, class V>
void visit_fields(V&& visit) {
  fields::visit_all<M>(visit);
}

}  // namespace souple
