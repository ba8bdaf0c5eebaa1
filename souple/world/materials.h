#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace souple {

/// How a cloth resists stretching.
enum class StretchModel {
  springs,  ///< a spring along each edge, k = Y (A0 + A1) / l^2; Poisson's ratio is 1/3 whatever the material
            ///< says
  membrane  ///< St. Venant-Kirchhoff triangles, orthotropic in warp, weft and shear
};

/// How a cloth resists bending; all from bending_stiffness in N m.
enum class BendingModel {
  isometric,  ///< quadratic in the positions; flat at rest (Bergou et al. 2006)
  dihedral,   ///< the angle between triangles, about whatever angle they have at rest
  distance,   ///< a spring between the two vertices opposite an edge: cheap; limp while flat, then stiff
  none
};

/// A stiffness without end: what it holds is rigid (compliance 0). For membrane_stiffness of springs and for
/// bending_stiffness of distances only.
inline constexpr float rigid = std::numeric_limits<float>::infinity();

/// A thin sheet. SI units; thickness is the full thickness.
struct ClothMaterial {
  float areal_density = 0.15f;  ///< kg/m^2
  /// Y = Young's modulus times thickness [N/m]; of the warp in the membrane model.
  float membrane_stiffness = 4000;
  float weft_stiffness = 0;         ///< membrane model [N/m]; 0: as membrane_stiffness
  float shear_stiffness = 0;        ///< membrane model [N/m]; 0: isotropic, Y / (2 (1 + nu))
  float poisson_ratio = 0.3f;       ///< membrane model, in [0, 1)
  float bending_stiffness = 1e-5f;  ///< D per unit width [N m]
  float thickness = 0.001f;         ///< m
  float friction = 0.4f;            ///< Coulomb coefficient
  float restitution = 0;            ///< in [0, 1]
  float damping_time = 0;           ///< Kelvin-Voigt: stress = E (strain + damping_time * strain rate) [s]
  float damping = 0;                ///< of motion other than that of a rigid body, conserves momenta [1/s]
  float air_drag = 1;               ///< coefficients of the wind on triangles
  float air_lift = 0.5f;
  StretchModel stretch = StretchModel::springs;
  BendingModel bending = BendingModel::isometric;
  float pbd_stretch = 1;     ///< Mode::pbd only: stiffness in [0, 1]
  float pbd_bending = 0.2f;  ///< Mode::pbd only
};

/// How a soft body resists deformation.
enum class SoftBodyModel {
  neo_hookean,    ///< compressible neo-Hookean tets (Macklin & Müller 2021)
  springs,        ///< tet edges as springs and tet volumes: cheap, not a material of theory
  shape_matching  ///< one region, rigid up to its compliance (Müller et al. 2005): stiff boxes
};

struct SoftBodyMaterial {
  float young_modulus = 5e4f;  ///< Pa
  float poisson_ratio = 0.4f;  ///< in [0, 0.5)
  float density = 1000;        ///< kg/m^3
  float thickness = 0.002f;    ///< contact distance is half of it [m]
  float friction = 0.5f;
  float restitution = 0;
  float damping_time = 0;  ///< s
  float damping = 0;       ///< 1/s
  SoftBodyModel model = SoftBodyModel::neo_hookean;
  float pbd_stiffness = 1;  ///< Mode::pbd only
};

struct RopeMaterial {
  float radius = 0.005f;        ///< m
  float young_modulus = 1e9f;   ///< Pa
  float density = 1100;         ///< kg/m^3
  float bending_stiffness = 0;  ///< E I [N m^2]; 0: limp. A solid rod has E pi r^4 / 4, a laid rope far less
  float friction = 0.4f;
  float restitution = 0;
  float damping_time = 0;    ///< s
  float damping = 0;         ///< 1/s
  float pbd_stretch = 1;     ///< Mode::pbd only
  float pbd_bending = 0.2f;  ///< Mode::pbd only
};

struct GrainsMaterial {
  float radius = 0.01f;  ///< m
  float density = 1600;  ///< of one grain [kg/m^3]
  float friction = 0.6f;
  float restitution = 0;
  float damping = 0;  ///< 1/s
};

/// A liquid made of particles (docs/fluids.md). All fluids of a world have the same spacing.
struct FluidMaterial {
  float spacing = 0.02f;      ///< between particles at rest: one has the volume spacing^3 [m]
  float density = 1000;       ///< kg/m^3
  float viscosity = 0.001f;   ///< dynamic, mu [Pa s]
  float xsph = 24;            ///< rate at which particles take over the velocity around them, beside what
                              ///< the viscosity does: it keeps noise down [1/s]
  float surface_tension = 0;  ///< sigma, against air [N/m]; see docs/fluids.md for how it limits substeps
  float contact_angle = 90;   ///< of a drop on a wall, measured within it; needs surface tension [degrees]
  float vorticity = 0;        ///< strength of vorticity confinement: adds energy to whirls [m/s]
  float air_drag = 0;         ///< coefficient of the drag on what meets the air; 0.47 is a ball's
  float foam = 0;             ///< how much of Settings::fluid.foam it makes: 0 none, 1 as that says
  float friction = 1;         ///< how walls hold it: 1 its viscosity does, 0 it slips. In [0, 1]
  float restitution = 0;
};

/// The surface of a mesh that nothing moves but its own motion: it has no mass.
struct ObstacleMaterial {
  float thickness = 0.002f;  ///< full: contacts keep half of it as distance [m]
  float friction = 0.5f;
  float restitution = 0;
};

/// Named materials. Each value's source stands beside it in materials.cpp.
namespace material {
extern const ClothMaterial cotton, silk, denim;
extern const SoftBodyMaterial rubber, jelly;
extern const RopeMaterial nylon, steel_wire;
extern const GrainsMaterial sand;
extern const FluidMaterial water, oil, honey;

/// The preset of that name, or nullptr.
const ClothMaterial* find_cloth(std::string_view name);
const SoftBodyMaterial* find_soft_body(std::string_view name);
const RopeMaterial* find_rope(std::string_view name);
const GrainsMaterial* find_grains(std::string_view name);
const FluidMaterial* find_fluid(std::string_view name);
/// Names of all presets of all kinds, in the order of the declarations above.
std::vector<std::string> names();
}  // namespace material

}  // namespace souple
