#include "souple/objects/material_fields.h"
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
    const Json rigid_word = Json::object({{"const", Json::of("rigid")}});
    return {range_.text("number") + ", or \"rigid\"",
            Json::object({{"oneOf", Json::array({range_.schema("number"), rigid_word})}})};
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

/// Adds the key of each field of a material.
template <class T>
struct FieldKeys {
  Table<T>& keys;

  template <auto member>
  void operator()(Field<member>, const char* name, const FieldRange& limits, const char* doc,
                  const Slider&) const {
    const Range range{limits.lowest, limits.highest, limits.open_low, limits.open_high};
    if constexpr (!std::is_same_v<MemberType<T, member>, float>)
      keys.template key<member>(name, maybe(number<float>(range)), doc);
    else
      keys.template key<member>(name, limits.rigid ? stiffness(range) : number<float>(range), doc);
  }
  template <auto member, class E>
  void operator()(Field<member>, const char* name, FieldWords<E> words, const char* doc) const {
    keys.template key<member>(name, enumeration<E>({words.begin(), words.end()}), doc);
  }
};

template <class M, class T>
std::shared_ptr<Table<T>> with_fields(std::shared_ptr<Table<T>> keys) {
  visit_fields<M>(FieldKeys<T>{*keys});
  if constexpr (requires(T & m) { m.kinetic_friction; }) keys->check(check_kinetic_friction<T>);
  return keys;
}

}  // namespace

CodecPtr<MaterialDescription<ClothMaterial>> cloth_material_codec() {
  using M = ClothMaterial;
  auto keys = with_fields<M>(material_table<M>("cloth_material", "A thin sheet.", material::find_cloth));
  keys->check([](const MaterialDescription<M>& m, const JsonPath& path) {
    if (m.membrane_stiffness == rigid && !may_be_rigid(m, &M::membrane_stiffness))
      path.key("membrane_stiffness").fail("\"rigid\" is valid only with stretch \"springs\"");
    if (m.bending_stiffness == rigid && !may_be_rigid(m, &M::bending_stiffness))
      path.key("bending_stiffness").fail("\"rigid\" is valid only with bending \"distance\"");
  });
  return keys;
}

CodecPtr<MaterialDescription<SoftBodyMaterial>> soft_body_material_codec() {
  using M = SoftBodyMaterial;
  return with_fields<M>(
      material_table<M>("soft_body_material", "A deformable solid.", material::find_soft_body));
}

CodecPtr<MaterialDescription<RopeMaterial>> rope_material_codec() {
  using M = RopeMaterial;
  return with_fields<M>(material_table<M>("rope_material", "A rope, a cable, a wire.", material::find_rope));
}

CodecPtr<MaterialDescription<GrainsMaterial>> grains_material_codec() {
  using M = GrainsMaterial;
  return with_fields<M>(
      material_table<M>("grains_material", "Balls with contacts and friction.", material::find_grains));
}

CodecPtr<MaterialDescription<FluidMaterial>> fluid_material_codec() {
  using M = FluidMaterial;
  return with_fields<M>(material_table<M>("fluid_material", "A liquid.", material::find_fluid));
}

CodecPtr<RigidBodyMaterial> rigid_body_material_codec() {
  using M = RigidBodyMaterial;
  return with_fields<M>(table<M>("rigid_body_material", "Density and contact properties of a rigid body."));
}

CodecPtr<ObstacleMaterial> obstacle_material_codec() {
  using M = ObstacleMaterial;
  return with_fields<M>(table<M>("obstacle_material", "Contact properties of an obstacle's surface."));
}

}  // namespace souple::scene_format
