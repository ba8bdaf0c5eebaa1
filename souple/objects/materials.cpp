#include "souple/objects/materials.h"

namespace souple::material {

// Densities, thicknesses and moduli are typical figures of the trade, not measurements of one fabric:
// - areal densities and thicknesses: apparel fabric data sheets (cotton poplin 120-180, habotai silk 35-80,
//   denim 340-470 g/m^2);
// - membrane stiffness: KES-F tensile modulus at small extension, hundreds to thousands of N/m (Kawabata
//   1980);
// - bending stiffness: KES-F bending rigidity B, 1e-6 to 1e-4 N m^2/m. Kawabata 1980 has cotton shirting about 0.05,
//   silk 0.01-0.05, denim 0.5-1.5 gf cm^2/cm (1 gf cm^2/cm = 9.81e-5 N m);
// - frictions: fabric on wood or smooth plastic, 0.2 to 0.6.

// clang-format off
const ClothMaterial cotton{.areal_density = 0.15f, .membrane_stiffness = 4000, .shear_stiffness = 300, .poisson_ratio = 0.3f,
                           .bending_stiffness = 5e-6f, .thickness = 0.0005f, .friction = 0.4f, .damping = 0.2f};
const ClothMaterial silk{.areal_density = 0.06f, .membrane_stiffness = 3000, .shear_stiffness = 100, .poisson_ratio = 0.3f,
                         .bending_stiffness = 2e-6f, .thickness = 0.0002f, .friction = 0.25f, .damping = 0.1f};
const ClothMaterial denim{.areal_density = 0.40f, .membrane_stiffness = 15000, .weft_stiffness = 10000, .shear_stiffness = 1000,
                          .poisson_ratio = 0.3f, .bending_stiffness = 1e-4f, .thickness = 0.0009f, .friction = 0.5f,
                          .damping = 0.4f};

// Soft natural rubber: E 1-5 MPa, nearly incompressible, 920-1100 kg/m^3 (Ashby, Materials Selection).
const SoftBodyMaterial rubber{.young_modulus = 1.5e6f, .poisson_ratio = 0.45f, .density = 1000, .friction = 0.8f,
                              .restitution = 0.3f, .damping_time = 0.008f};
// Table jelly (gelatin 5-10 %): shear modulus of a few kPa (Markidou et al. 2005), water's density. Stiffened
// to 20 kPa so that a 30 cm body supports its own weight.
const SoftBodyMaterial jelly{.young_modulus = 2e4f, .poisson_ratio = 0.45f, .density = 1000, .friction = 0.4f,
                             .damping_time = 0.008f};

// Nylon 6 fiber 1150 kg/m^3; a laid rope has about a quarter of the fiber's 2-4 GPa (Cordage Institute elongations).
const RopeMaterial nylon{.radius = 0.005f, .young_modulus = 6e8f, .density = 1150, .friction = 0.4f};
// Steel 200 GPa, 7850 kg/m^3; radius 1 mm, so E I = E pi r^4 / 4 = 0.157 N m^2.
const RopeMaterial steel_wire{.radius = 0.001f, .young_modulus = 2e11f, .density = 7850, .bending_stiffness = 0.157f,
                              .friction = 0.3f};

// Quartz 2650 kg/m^3; angle of repose of dry sand 30-35 degrees, tan = 0.6-0.7. A grain of 1 cm represents
// many.
const GrainsMaterial sand{.radius = 0.01f, .density = 2650, .friction = 0.65f, .rolling_friction = 0.4f};

// Water at 20 C: 998 kg/m^3, 1.0 mPa s. Sunflower oil: 920 kg/m^3, 49 mPa s at 26 C. Honey: 1420 kg/m^3, 10
// Pa s (CRC Handbook of Chemistry and Physics; Engineering ToolBox). Surface tension is visible only below a
// centimeter.
const FluidMaterial water{.density = 998, .viscosity = 0.001f};
const FluidMaterial oil{.density = 920, .viscosity = 0.049f};
const FluidMaterial honey{.density = 1420, .viscosity = 10};
// clang-format on

const ClothMaterial* find_cloth(std::string_view name) {
  if (name == "cotton") return &cotton;
  if (name == "silk") return &silk;
  return name == "denim" ? &denim : nullptr;
}

const SoftBodyMaterial* find_soft_body(std::string_view name) {
  if (name == "rubber") return &rubber;
  return name == "jelly" ? &jelly : nullptr;
}

const RopeMaterial* find_rope(std::string_view name) {
  if (name == "nylon") return &nylon;
  return name == "steel_wire" ? &steel_wire : nullptr;
}

const GrainsMaterial* find_grains(std::string_view name) {
  return name == "sand" ? &sand : nullptr;
}

const FluidMaterial* find_fluid(std::string_view name) {
  if (name == "water") return &water;
  if (name == "honey") return &honey;
  return name == "oil" ? &oil : nullptr;
}

std::vector<std::string> names() {
  return {"cotton",     "silk", "denim", "rubber", "jelly", "nylon",
          "steel_wire", "sand", "water", "oil",    "honey"};
}

}  // namespace souple::material
