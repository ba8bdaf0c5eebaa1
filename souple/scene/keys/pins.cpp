#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

/// Exactly `true`: for the selector without a value.
class True : public Codec<Selector::All> {
 public:
  void read(const Json& json, const JsonPath& path, Selector::All&) const override {
    if (!json.is(Json::Kind::boolean) || !json.boolean) path.unexpected("true", json);
  }
  Json write(const Selector::All&) const override { return Json::of(true); }
  TypeInfo describe(Format&) const override {
    Json schema = Json::object();
    schema.set("const", Json::of(true));
    return {"true", schema};
  }
};

/// [[x, y, z], [x, y, z]]: the lower and the upper corner.
class BoxCorners : public Codec<Selector::InBox> {
 public:
  void read(const Json& json, const JsonPath& path, Selector::InBox& value) const override {
    if (!json.is(Json::Kind::array) || json.items.size() != 2) {
      path.unexpected("two corners, [[x, y, z], [x, y, z]]", json);
    }
    corner_.read(json.items[0], path.item(0), value.lo);
    corner_.read(json.items[1], path.item(1), value.hi);
    for (int i = 0; i < 3; ++i) {
      if (value.lo[i] > value.hi[i])
        path.fail("the first corner must be the lower one, found " + brief(json));
    }
  }
  Json write(const Selector::InBox& value) const override {
    return Json::array({corner_.write(value.lo), corner_.write(value.hi)});
  }
  TypeInfo describe(Format& format) const override {
    Json schema = Json::object();
    schema.set("type", Json::of("array"));
    schema.set("items", corner_.describe(format).schema);
    schema.set("minItems", Json::whole(2));
    schema.set("maxItems", Json::whole(2));
    return {"[[x, y, z], [x, y, z]]", schema};
  }

 private:
  Vector3<float> corner_{meters};
};

template <class T>
void add_pin_keys(Table<T>& keys) {
  keys.template choice<&PinDescription::where, &Selector::choice>(selectors());
  keys.template key<&PinDescription::keyframes>("keyframes", keyframes_codec(),
                                                "moves the vertices: `translate` is relative to their start "
                                                "positions, `rotate` rotates them about `about`")
      .template key<&PinDescription::loop>("loop", boolean(), "repeats the keyframes after the last")
      .template key<&PinDescription::about>("about", maybe(vector3<double>(meters)),
                                            "center of rotation [m]; if not given, the mean of the vertices")
      .template key<&PinDescription::sequence>("sequence", maybe(sequence_codec()),
                                               "moves the vertices to positions from files")
      .needs("loop", "keyframes")
      .needs("about", "keyframes")
      .excludes("keyframes", "sequence")
      .check([](const T& pin, const JsonPath& path) { check_times(pin.keyframes, path); });
}

}  // namespace

std::vector<Alternative> selectors() {
  using V = decltype(Selector::choice);
  using S = Selector;
  return {alternative<V>(
              "vertices",
              wrapped<S::Vertices>(&S::Vertices::indices, list(number<std::uint32_t>(from_zero(1e9)), 1)),
              "vertex indices, from 0, in the order of the mesh"),
          alternative<V>("in_box", CodecPtr<S::InBox>(std::make_shared<BoxCorners>()),
                         "vertices inside this box at the start [m], in world coordinates, bounds included"),
          alternative<V>("nearest", wrapped<S::Nearest>(&S::Nearest::point, vector3<float>(meters)),
                         "the vertex nearest to this point at the start [m]"),
          alternative<V>("group", wrapped<S::Group>(&S::Group::name, text()),
                         "the vertices of this group of the mesh file"),
          alternative<V>("all", CodecPtr<S::All>(std::make_shared<True>()), "all vertices")};
}

CodecPtr<PinDescription> pin_codec() {
  auto keys = table<PinDescription>("pin",
                                    "Vertices that are fixed at their start positions, or follow keyframes "
                                    "or a sequence. Forces do not move them.");
  add_pin_keys(*keys);
  return keys;
}

CodecPtr<AttachmentDescription> attachment_codec() {
  auto keys = table<AttachmentDescription>(
      "attachment",
      "Vertices with springs to their start positions, or to positions from keyframes or a sequence.");
  add_pin_keys(*keys);
  keys->key<&AttachmentDescription::compliance>("compliance", number<float>(from_zero(1e6)),
                                                "compliance of each vertex's spring [m/N]; 0 is rigid");
  return keys;
}

}  // namespace souple::scene_format
