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
                                 "starts from this material; the other keys change it");
  return keys;
}

template <class T>
void add_surface_keys(Table<T>& keys) {
  keys.template key<&T::friction>("friction", number<float>(friction_range), "Coulomb coefficient")
      .template key<&T::restitution>("restitution", number<float>(unit),
                                     "how much of the speed a bounce gives back");
}

template <class T>
void add_damping_keys(Table<T>& keys) {
  keys.template key<&T::damping_time>("damping_time", number<float>(from_zero(1000)),
                                      "Kelvin-Voigt: stress = E (strain + damping_time * strain rate) [s]")
      .template key<&T::damping>("damping", number<float>(from_zero(1e4)),
                                 "of motion other than that of a rigid body [1/s]");
}

}  // namespace

CodecPtr<MaterialDescription<ClothMaterial>> cloth_material_codec() {
  using M = ClothMaterial;
  auto keys = material_table<M>("cloth_material", "A thin sheet.", material::find_cloth);
  keys->key<&M::areal_density>("areal_density", number<float>(positive(1e4)), "[kg/m^2]")
      .key<&M::membrane_stiffness>(
          "membrane_stiffness", stiffness(positive(1e12)),
          "Young's modulus times thickness [N/m]; of the warp in the membrane model, "
          "where it cannot be rigid")
      .key<&M::weft_stiffness>("weft_stiffness", number<float>(from_zero(1e12)),
                               "membrane model [N/m]; 0: as membrane_stiffness")
      .key<&M::shear_stiffness>("shear_stiffness", number<float>(from_zero(1e12)),
                                "membrane model [N/m]; 0: isotropic, Y / (2 (1 + nu))")
      .key<&M::poisson_ratio>("poisson_ratio", number<float>(below(1)), "membrane model")
      .key<&M::bending_stiffness>("bending_stiffness", stiffness(from_zero(1e9)),
                                  "per unit width [N m]; rigid only with bending \"distance\"")
      .key<&M::thickness>("thickness", number<float>(positive(10)), "from side to side [m]");
  add_surface_keys(*keys);
  add_damping_keys(*keys);
  keys->key<&M::air_drag>("air_drag", number<float>(from_zero(100)),
                          "coefficient of the wind along its direction")
      .key<&M::air_lift>("air_lift", number<float>(from_zero(100)), "coefficient of the wind across it")
      .key<&M::stretch>(
          "stretch",
          enumeration<StretchModel>(
              {{"springs", StretchModel::springs}, {"membrane", StretchModel::membrane}}),
          "how stretching is resisted: a spring along each edge, or triangles of an orthotropic membrane")
      .key<&M::bending>("bending",
                        enumeration<BendingModel>({{"isometric", BendingModel::isometric},
                                                   {"dihedral", BendingModel::dihedral},
                                                   {"distance", BendingModel::distance},
                                                   {"none", BendingModel::none}}),
                        "how bending is resisted: at the edges, flat or at their angle, or by springs across "
                        "them")
      .key<&M::pbd_stretch>("pbd_stretch", number<float>(unit), "stiffness in mode \"pbd\"")
      .key<&M::pbd_bending>("pbd_bending", number<float>(unit), "stiffness in mode \"pbd\"")
      .check([](const MaterialDescription<M>& m, const JsonPath& path) {
        if (m.membrane_stiffness == rigid && m.stretch != StretchModel::springs)
          path.key("membrane_stiffness").fail("is \"rigid\": only springs can be (stretch \"springs\")");
        if (m.bending_stiffness == rigid && m.bending != BendingModel::distance)
          path.key("bending_stiffness").fail("is \"rigid\": only springs can be (bending \"distance\")");
      });
  return keys;
}

CodecPtr<MaterialDescription<SoftBodyMaterial>> soft_body_material_codec() {
  using M = SoftBodyMaterial;
  auto keys = material_table<M>("soft_body_material", "A solid that deforms.", material::find_soft_body);
  keys->key<&M::young_modulus>("young_modulus", number<float>(positive(1e13)), "[Pa]")
      .key<&M::poisson_ratio>("poisson_ratio", number<float>(below(0.5)), "how much it thins when stretched")
      .key<&M::density>("density", number<float>(positive(1e6)), "[kg/m^3]")
      .key<&M::thickness>("thickness", number<float>(positive(10)),
                          "contacts keep half of it as distance [m]");
  add_surface_keys(*keys);
  add_damping_keys(*keys);
  keys->key<&M::model>("model",
                       enumeration<SoftBodyModel>({{"neo_hookean", SoftBodyModel::neo_hookean},
                                                   {"springs", SoftBodyModel::springs},
                                                   {"shape_matching", SoftBodyModel::shape_matching}}),
                       "how deformation is resisted: tets of a neo-Hookean solid, cheap springs and volumes, "
                       "or one stiff shape")
      .key<&M::pbd_stiffness>("pbd_stiffness", number<float>(unit), "stiffness in mode \"pbd\"");
  return keys;
}

CodecPtr<MaterialDescription<RopeMaterial>> rope_material_codec() {
  using M = RopeMaterial;
  auto keys = material_table<M>("rope_material", "A rope, a cable, a wire.", material::find_rope);
  keys->key<&M::radius>("radius", number<float>(positive(100)), "[m]")
      .key<&M::young_modulus>("young_modulus", number<float>(positive(1e13)), "[Pa]")
      .key<&M::density>("density", number<float>(positive(1e6)), "[kg/m^3]")
      .key<&M::bending_stiffness>("bending_stiffness", number<float>(from_zero(1e9)),
                                  "E I [N m^2]; 0: limp. A solid rod has E pi r^4 / 4, a laid rope far less");
  add_surface_keys(*keys);
  keys->key<&M::damping_time>("damping_time", number<float>(from_zero(1000)), "Kelvin-Voigt [s]")
      .key<&M::damping>("damping", number<float>(from_zero(1e4)),
                        "of motion other than that of a rigid body [1/s]")
      .key<&M::pbd_stretch>("pbd_stretch", number<float>(unit), "stiffness in mode \"pbd\"")
      .key<&M::pbd_bending>("pbd_bending", number<float>(unit), "stiffness in mode \"pbd\"");
  return keys;
}

CodecPtr<MaterialDescription<GrainsMaterial>> grains_material_codec() {
  using M = GrainsMaterial;
  auto keys = material_table<M>("grains_material", "Balls that touch and rub.", material::find_grains);
  keys->key<&M::radius>("radius", number<float>(positive(100)), "[m]")
      .key<&M::density>("density", number<float>(positive(1e6)), "of one grain [kg/m^3]");
  add_surface_keys(*keys);
  keys->key<&M::damping>("damping", number<float>(from_zero(1e4)), "of motion relative to the whole [1/s]");
  return keys;
}

CodecPtr<MaterialDescription<FluidMaterial>> fluid_material_codec() {
  using M = FluidMaterial;
  auto keys = material_table<M>("fluid_material", "A liquid.", material::find_fluid);
  keys->key<&M::spacing>("spacing", number<float>(positive(100)),
                         "between particles at rest, the same for all fluids of a scene [m]")
      .key<&M::density>("density", number<float>(positive(1e6)), "[kg/m^3]")
      .key<&M::viscosity>("viscosity", number<float>(from_zero(1e6)), "dynamic viscosity [Pa s]")
      .key<&M::xsph>("xsph", number<float>(from_zero(1e4)),
                     "rate at which particles take over the velocity around them: keeps noise down [1/s]")
      .key<&M::surface_tension>("surface_tension", number<float>(from_zero(1e4)), "against air [N/m]")
      .key<&M::contact_angle>("contact_angle", number<float>(within(0, 180)),
                              "of a drop on a wall, measured within it [degrees]")
      .key<&M::vorticity>("vorticity", number<float>(from_zero(1e3)),
                          "strength of vorticity confinement: adds energy to whirls [m/s]")
      .key<&M::air_drag>("air_drag", number<float>(from_zero(1e3)),
                         "coefficient of the drag on what meets the air; a ball has 0.47")
      .key<&M::foam>("foam", number<float>(within(0, 1000)),
                     "how much of the settings' `foam` it makes: 0 none, 1 as they say")
      .key<&M::friction>("friction", number<float>(unit),
                         "how walls hold it: 1 as its viscosity says, 0 it slips")
      .key<&M::restitution>("restitution", number<float>(unit),
                            "how much of its speed it keeps when it bounces");
  return keys;
}

CodecPtr<ObstacleMaterial> obstacle_material_codec() {
  using M = ObstacleMaterial;
  auto keys = table<M>("obstacle_material", "How the surface of an obstacle is felt.");
  keys->key<&M::thickness>("thickness", number<float>(positive(10)),
                           "contacts keep half of it as distance [m]");
  add_surface_keys(*keys);
  return keys;
}

}  // namespace souple::scene_format
