#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

/// A stiffness: a number, or "rigid".
class Stiffness : public Codec<float> {
 public:
  explicit Stiffness(const Range& range) : range_(range), number_(range) {}
  void read(const Json& json, const JsonPath& path, float& value) const override {
    if (json.is(Json::Kind::text) && json.text == "rigid") {
      value = rigid;
    } else if (json.is(Json::Kind::number)) {
      number_.read(json, path, value);
    } else {
      path.unexpected(range_.text("a number") + " or \"rigid\"", json);
    }
  }
  Json write(const float& value) const override {
    return value == rigid ? Json::of("rigid") : number_.write(value);
  }
  TypeInfo describe(Format&) const override {
    Json word = Json::object(), schema = Json::object();
    word.set("const", Json::of("rigid"));
    schema.set("oneOf", Json::array({range_.schema("number"), word}));
    return {range_.text("number") + ", or \"rigid\"", schema};
  }

 private:
  Range range_;
  Number<float> number_;
};

CodecPtr<float> stiffness(const Range& range) {
  return std::make_shared<Stiffness>(range);
}

template <class Material, class Find>
auto material_table(const char* heading, const char* doc, Find find) {
  using M = MaterialDescription<Material>;
  std::vector<std::string> known;
  for (const std::string& preset : material::names()) {
    if (find(preset) != nullptr) known.push_back(preset);
  }
  auto preset_codec = word("preset", known);
  auto keys = table<M>(heading, doc);
  keys->start(
      [preset_codec, find](const Json& json, const JsonPath& path, void* object) {
        M& value = *static_cast<M*>(object);
        const Json* preset = json.find("preset");
        if (preset == nullptr) return;
        preset_codec->read(*preset, path.key("preset"), value.preset);
        static_cast<Material&>(value) = *find(value.preset);
      },
      [find](const M& value, M& fallback) {
        if (const Material* preset = find(value.preset)) static_cast<Material&>(fallback) = *preset;
      });
  keys->template key<&M::preset>("preset", preset_codec,
                                 "material to start from; the other keys override its values");
  return keys;
}

template <class T>
void add_surface_keys(Table<T>& keys) {
  keys.template key<&T::friction>("friction", number<float>(friction_range), "Coulomb friction coefficient")
      .template key<&T::kinetic_friction>(
          "kinetic_friction", maybe(number<float>(friction_range)),
          "friction coefficient while sliding, at most `friction`; if not given: `friction`")
      .template key<&T::restitution>(
          "restitution", number<float>(unit),
          "coefficient of restitution, the fraction of the speed that a bounce keeps")
      .check(check_kinetic_friction<T>);
}

template <class T>
void add_damping_keys(Table<T>& keys) {
  keys.template key<&T::damping_time>(
          "damping_time", number<float>(from_zero(1000)),
          "Kelvin-Voigt damping: stress = E (strain + damping_time * strain rate) [s]")
      .template key<&T::damping>("damping", number<float>(from_zero(1e4)),
                                 "damping rate of all motion except rigid-body motion [1/s]");
}

}  // namespace

CodecPtr<MaterialDescription<ClothMaterial>> cloth_material_codec() {
  using M = ClothMaterial;
  auto keys = material_table<M>("cloth_material", "A thin sheet.", material::find_cloth);
  keys->key<&M::areal_density>("areal_density", number<float>(positive(1e4)), "mass per area [kg/m^2]")
      .key<&M::membrane_stiffness>("membrane_stiffness", stiffness(positive(1e12)),
                                   "Young's modulus times thickness [N/m]; in the membrane model that of the "
                                   "warp, which cannot be rigid")
      .key<&M::weft_stiffness>("weft_stiffness", number<float>(from_zero(1e12)),
                               "stiffness of the weft in the membrane model [N/m]; 0: as membrane_stiffness")
      .key<&M::shear_stiffness>("shear_stiffness", number<float>(from_zero(1e12)),
                                "shear stiffness in the membrane model [N/m]; 0: isotropic, Y / (2 (1 + nu))")
      .key<&M::poisson_ratio>("poisson_ratio", number<float>(below(1)),
                              "Poisson's ratio in the membrane model")
      .key<&M::bending_stiffness>(
          "bending_stiffness", stiffness(from_zero(1e9)),
          "bending stiffness per unit width [N m]; rigid only with bending \"distance\"")
      .key<&M::thickness>("thickness", number<float>(positive(10)), "thickness from side to side [m]");
  add_surface_keys(*keys);
  add_damping_keys(*keys);
  keys->key<&M::air_drag>("air_drag", number<float>(from_zero(100)),
                          "drag coefficient: force of the wind along its direction")
      .key<&M::air_lift>("air_lift", number<float>(from_zero(100)),
                         "lift coefficient: force of the wind across its direction")
      .key<&M::stretch>("stretch",
                        enumeration<StretchModel>(
                            {{"springs", StretchModel::springs}, {"membrane", StretchModel::membrane}}),
                        "stretching model: a spring along each edge, or triangles of an orthotropic membrane")
      .key<&M::bending>("bending",
                        enumeration<BendingModel>({{"isometric", BendingModel::isometric},
                                                   {"dihedral", BendingModel::dihedral},
                                                   {"distance", BendingModel::distance},
                                                   {"none", BendingModel::none}}),
                        "bending model: isometric (flat at rest), dihedral (angles of the mesh at rest), or "
                        "distance (springs across edges)")
      .key<&M::pbd_stretch>("pbd_stretch", number<float>(unit), "stiffness in mode \"pbd\"")
      .key<&M::pbd_bending>("pbd_bending", number<float>(unit), "stiffness in mode \"pbd\"")
      .check([](const MaterialDescription<M>& m, const JsonPath& path) {
        if (m.membrane_stiffness == rigid && m.stretch != StretchModel::springs)
          path.key("membrane_stiffness").fail("\"rigid\" is valid only with stretch \"springs\"");
        if (m.bending_stiffness == rigid && m.bending != BendingModel::distance)
          path.key("bending_stiffness").fail("\"rigid\" is valid only with bending \"distance\"");
      });
  return keys;
}

CodecPtr<MaterialDescription<SoftBodyMaterial>> soft_body_material_codec() {
  using M = SoftBodyMaterial;
  auto keys = material_table<M>("soft_body_material", "A deformable solid.", material::find_soft_body);
  keys->key<&M::young_modulus>("young_modulus", number<float>(positive(1e13)), "Young's modulus [Pa]")
      .key<&M::poisson_ratio>("poisson_ratio", number<float>(below(0.5)),
                              "Poisson's ratio: transverse contraction over extension")
      .key<&M::density>("density", number<float>(positive(1e6)), "density [kg/m^3]")
      .key<&M::thickness>("thickness", number<float>(positive(10)),
                          "contact thickness [m]; contacts keep a distance of half of it");
  add_surface_keys(*keys);
  add_damping_keys(*keys);
  keys->key<&M::model>("model",
                       enumeration<SoftBodyModel>({{"neo_hookean", SoftBodyModel::neo_hookean},
                                                   {"springs", SoftBodyModel::springs},
                                                   {"shape_matching", SoftBodyModel::shape_matching}}),
                       "deformation model: tets of a neo-Hookean solid, cheap springs and tet volumes, or "
                       "shape matching of the whole body (stiff)")
      .key<&M::pbd_stiffness>("pbd_stiffness", number<float>(unit), "stiffness in mode \"pbd\"");
  return keys;
}

CodecPtr<MaterialDescription<RopeMaterial>> rope_material_codec() {
  using M = RopeMaterial;
  auto keys = material_table<M>("rope_material", "A rope, a cable, a wire.", material::find_rope);
  keys->key<&M::radius>("radius", number<float>(positive(100)), "radius [m]")
      .key<&M::young_modulus>("young_modulus", number<float>(positive(1e13)), "Young's modulus [Pa]")
      .key<&M::density>("density", number<float>(positive(1e6)), "density [kg/m^3]")
      .key<&M::bending_stiffness>(
          "bending_stiffness", number<float>(from_zero(1e9)),
          "bending stiffness E I [N m^2]; 0: limp. A solid rod has E pi r^4 / 4, a laid rope far less");
  add_surface_keys(*keys);
  keys->key<&M::damping_time>("damping_time", number<float>(from_zero(1000)),
                              "Kelvin-Voigt damping: stress = E (strain + damping_time * strain rate) [s]")
      .key<&M::damping>("damping", number<float>(from_zero(1e4)),
                        "damping rate of all motion except rigid-body motion [1/s]")
      .key<&M::pbd_stretch>("pbd_stretch", number<float>(unit), "stiffness in mode \"pbd\"")
      .key<&M::pbd_bending>("pbd_bending", number<float>(unit), "stiffness in mode \"pbd\"");
  return keys;
}

CodecPtr<MaterialDescription<GrainsMaterial>> grains_material_codec() {
  using M = GrainsMaterial;
  auto keys =
      material_table<M>("grains_material", "Balls with contacts and friction.", material::find_grains);
  keys->key<&M::radius>("radius", number<float>(positive(100)), "radius [m]")
      .key<&M::density>("density", number<float>(positive(1e6)), "density of one grain [kg/m^3]");
  add_surface_keys(*keys);
  keys->key<&M::rolling_friction>(
          "rolling_friction", number<float>(friction_range),
          "largest moment of a contact against rolling, as a part of radius times normal force; 0: perfect "
          "spheres. From about 1 on grains slide but do not roll")
      .key<&M::damping>("damping", number<float>(from_zero(1e4)),
                        "damping rate of motion relative to the whole object [1/s]");
  return keys;
}

CodecPtr<MaterialDescription<FluidMaterial>> fluid_material_codec() {
  using M = FluidMaterial;
  auto keys = material_table<M>("fluid_material", "A liquid.", material::find_fluid);
  keys->key<&M::spacing>("spacing", number<float>(positive(100)),
                         "distance between particles at rest, equal for all fluids of a scene [m]")
      .key<&M::density>("density", number<float>(positive(1e6)), "density [kg/m^3]")
      .key<&M::viscosity>("viscosity", number<float>(from_zero(1e6)), "dynamic viscosity [Pa s]")
      .key<&M::xsph>("xsph", number<float>(from_zero(1e4)),
                     "XSPH smoothing: rate at which particles adopt the velocity of their neighbors; reduces "
                     "noise [1/s]")
      .key<&M::surface_tension>("surface_tension", number<float>(from_zero(1e4)),
                                "surface tension against air [N/m]")
      .key<&M::contact_angle>("contact_angle", number<float>(within(0, 180)),
                              "contact angle of a drop on a wall, measured inside the drop [degrees]")
      .key<&M::vorticity>("vorticity", number<float>(from_zero(1e3)),
                          "strength of vorticity confinement, which adds energy to vortices [m/s]")
      .key<&M::air_drag>("air_drag", number<float>(from_zero(1e3)),
                         "drag coefficient of the surface in air; a ball has 0.47")
      .key<&M::foam>("foam", number<float>(within(0, 1000)),
                     "factor of the emission rates in the settings' `foam`; 0: no foam")
      .key<&M::friction>("friction", number<float>(unit),
                         "wall friction: 1 follows from the viscosity, 0 is free slip")
      .key<&M::restitution>("restitution", number<float>(unit),
                            "coefficient of restitution, the fraction of the speed that a bounce keeps");
  return keys;
}

CodecPtr<RigidBodyMaterial> rigid_body_material_codec() {
  using M = RigidBodyMaterial;
  auto keys = table<M>("rigid_body_material", "Density and contact properties of a rigid body.");
  keys->key<&M::density>("density", number<float>(positive(1e6)), "density [kg/m^3]")
      .key<&M::thickness>(
          "thickness", number<float>(positive(10)),
          "contact thickness [m]; cloth, ropes, soft bodies and grains keep a distance of half of it; "
          "rigid bodies and colliders touch the surface");
  add_surface_keys(*keys);
  return keys;
}

CodecPtr<ObstacleMaterial> obstacle_material_codec() {
  using M = ObstacleMaterial;
  auto keys = table<M>("obstacle_material", "Contact properties of an obstacle's surface.");
  keys->key<&M::thickness>("thickness", number<float>(positive(10)),
                           "contact thickness [m]; contacts keep a distance of half of it");
  add_surface_keys(*keys);
  return keys;
}

}  // namespace souple::scene_format
