#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace souple {

/// Stretch model of cloth.
enum class StretchModel {
  springs,  ///< a spring along each edge, k = Y (A0 + A1) / l^2; Poisson's ratio is always 1/3
  membrane  ///< St. Venant-Kirchhoff triangles, orthotropic in warp, weft and shear
};

/// Bending model of cloth; all use bending_stiffness in N m.
enum class BendingModel {
  isometric,  ///< quadratic in the positions; flat at rest (Bergou et al. 2006)
  dihedral,   ///< angle between triangles, relative to their angle at rest
  distance,   ///< a spring between the two vertices opposite an edge: cheap; limp while flat, then stiff
  none
};

/// Infinite stiffness: the constraint is rigid (compliance 0). Valid only for membrane_stiffness with springs
/// and for bending_stiffness with distances.
inline constexpr float rigid = std::numeric_limits<float>::infinity();

/// A thin sheet. SI units; thickness is the full thickness.
struct ClothMaterial {
  float areal_density = 0.15f;  ///< kg/m^2
  /// Y = Young's modulus times thickness [N/m]; in the membrane model that of the warp.
  float membrane_stiffness = 4000;
  float weft_stiffness = 0;                 ///< membrane model [N/m]; 0: equal to membrane_stiffness
  float shear_stiffness = 0;                ///< membrane model [N/m]; 0: isotropic, Y / (2 (1 + nu))
  float poisson_ratio = 0.3f;               ///< membrane model, in [0, 1)
  float bending_stiffness = 1e-5f;          ///< D per unit width [N m]
  float thickness = 0.001f;                 ///< m
  float friction = 0.4f;                    ///< Coulomb coefficient
  std::optional<float> kinetic_friction{};  ///< the same while sliding, at most `friction`; none: `friction`
  float restitution = 0;                    ///< in [0, 1]
  float damping_time = 0;  ///< Kelvin-Voigt: stress = E (strain + damping_time * strain rate) [s]
  float damping = 0;       ///< damping rate of motion other than rigid-body motion; conserves momenta [1/s]
  float air_drag = 1;      ///< drag and lift coefficients of triangles in the air
  float air_lift = 0.5f;
  StretchModel stretch = StretchModel::springs;
  BendingModel bending = BendingModel::isometric;
  float pbd_stretch = 1;     ///< Mode::pbd only: stiffness in [0, 1]
  float pbd_bending = 0.2f;  ///< Mode::pbd only
};

/// Elastic model of a soft body.
enum class SoftBodyModel {
  neo_hookean,    ///< compressible neo-Hookean tets (Macklin & Müller 2021)
  springs,        ///< tet edges as springs, and tet volumes: cheap, but no established material
  shape_matching  ///< one region, rigid up to its compliance (Müller et al. 2005): stiff boxes
};

struct SoftBodyMaterial {
  float young_modulus = 5e4f;  ///< Pa
  float poisson_ratio = 0.4f;  ///< in [0, 0.5)
  float density = 1000;        ///< kg/m^3
  float thickness = 0.002f;    ///< the contact distance is half of it [m]
  float friction = 0.5f;
  std::optional<float> kinetic_friction{};
  float restitution = 0;
  float damping_time =
      0.008f;         ///< without damping a block flutters and loses its grip (docs/materials.md) [s]
  float damping = 0;  ///< 1/s
  SoftBodyModel model = SoftBodyModel::neo_hookean;
  float pbd_stiffness = 1;  ///< Mode::pbd only
};

struct RopeMaterial {
  float radius = 0.005f;        ///< m
  float young_modulus = 1e9f;   ///< Pa
  float density = 1100;         ///< kg/m^3
  float bending_stiffness = 0;  ///< E I [N m^2]; 0: limp. A solid rod has E pi r^4 / 4, a laid rope far less
  float friction = 0.4f;
  std::optional<float> kinetic_friction{};
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
  std::optional<float> kinetic_friction{};
  /// Largest moment of a contact against rolling, as a part of radius times normal force. Between two grains the
  /// radius is the harmonic mean of theirs. 0: perfect spheres; from about 1 on grains slide but do not roll.
  float rolling_friction = 0.1f;
  float restitution = 0;
  float damping = 0;  ///< 1/s
};

/// A liquid made of particles (docs/fluids.md). All fluids of a world have the same spacing.
struct FluidMaterial {
  float spacing = 0.02f;     ///< distance of particles at rest; a particle has the volume spacing^3 [m]
  float density = 1000;      ///< kg/m^3
  float viscosity = 0.001f;  ///< dynamic, mu [Pa s]
  /// Rate at which a particle adopts the velocity around it, in addition to the viscosity: it suppresses
  /// noise [1/s].
  float xsph = 24;
  float surface_tension = 0;  ///< sigma, against air [N/m]; see docs/fluids.md for its limit on the substep
  /// Contact angle of a drop on a wall, measured inside the drop; needs surface tension [degrees].
  float contact_angle = 90;
  float vorticity = 0;  ///< strength of vorticity confinement, which adds energy to vortices [m/s]
  float air_drag = 0;   ///< drag coefficient of particles that face air; a ball has 0.47
  float foam = 0;       ///< factor of the foam that Settings::fluid.foam defines; 0: none
  float friction = 1;   ///< friction at walls: 1: full viscous friction, 0: slip. In [0, 1]
  float restitution = 0;
};

/// Material of an obstacle: a mesh without mass that only its prescribed motion moves.
struct ObstacleMaterial {
  float thickness = 0.002f;  ///< full thickness; the contact distance is half of it [m]
  float friction = 0.5f;
  std::optional<float> kinetic_friction{};
  float restitution = 0;
};

/// Material of a rigid body.
struct RigidBodyMaterial {
  float density = 700;  ///< kg/m^3; the default is that of hardwood
  /// Full thickness of the layer around the surface that keeps cloth, ropes and grains away; rigid bodies and colliders
  /// touch the surface itself [m].
  float thickness = 0.002f;
  float friction = 0.5f;
  std::optional<float> kinetic_friction{};
  float restitution = 0;
};

enum class ObjectKind { cloth, soft_body, rope, grains, obstacle, fluid, rigid_body };
std::string_view kind_name(ObjectKind kind);

/// Material of an object of any kind: the alternatives are in the order of ObjectKind.
using Material = std::variant<ClothMaterial, SoftBodyMaterial, RopeMaterial, GrainsMaterial, ObstacleMaterial,
                              FluidMaterial, RigidBodyMaterial>;

/// Named materials. materials.cpp gives the source of each value.
namespace material {
extern const ClothMaterial cotton, silk, denim;
extern const SoftBodyMaterial rubber, jelly;
extern const RopeMaterial nylon, steel_wire;
extern const GrainsMaterial sand;
extern const FluidMaterial water, oil, honey;

/// The preset with this name, or nullptr.
const ClothMaterial* find_cloth(std::string_view name);
const SoftBodyMaterial* find_soft_body(std::string_view name);
const RopeMaterial* find_rope(std::string_view name);
const GrainsMaterial* find_grains(std::string_view name);
const FluidMaterial* find_fluid(std::string_view name);
/// Names of the presets of all kinds, in the order of the declarations above.
std::vector<std::string> names();
}  // namespace material

}  // namespace souple
