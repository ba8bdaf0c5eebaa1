#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

/// Exactly `true`: the selector that needs no value.
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

/// [[x, y, z], [x, y, z]]: the lower corner and the upper.
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
                                                "moves the vertices: `translate` is relative to where they "
                                                "start, `rotate` turns them about `about`")
      .template key<&PinDescription::loop>("loop", boolean(), "starts the keyframes over after the last")
      .template key<&PinDescription::about>(
          "about", maybe(vector3<double>(meters)),
          "center of the rotations [m]; the middle of the vertices if not given")
      .template key<&PinDescription::sequence>("sequence", maybe(sequence_codec()),
                                               "moves the vertices along with positions from files")
      .needs("loop", "keyframes")
      .needs("about", "keyframes")
      .excludes("keyframes", "sequence")
      .check([](const T& pin, const JsonPath& path) { check_times(pin.keyframes, path); });
}

}  // namespace

std::vector<Alternative> selectors() {
  using V = decltype(Selector::choice);
  using S = Selector;
  return {
      alternative<V>(
          "vertices",
          wrapped<S::Vertices>(&S::Vertices::indices, list(number<std::uint32_t>(from_zero(1e9)), 1)),
          "these vertices, counted from 0 in the order of the mesh"),
      alternative<V>("in_box", CodecPtr<S::InBox>(std::make_shared<BoxCorners>()),
                     "vertices that stand in this box at the start [m], world coordinates, bounds included"),
      alternative<V>("nearest", wrapped<S::Nearest>(&S::Nearest::point, vector3<float>(meters)),
                     "the one vertex nearest to this point at the start [m]"),
      alternative<V>("group", wrapped<S::Group>(&S::Group::name, text()),
                     "the vertices of this group of the mesh file"),
      alternative<V>("all", CodecPtr<S::All>(std::make_shared<True>()), "every vertex")};
}

CodecPtr<PinDescription> pin_codec() {
  auto keys = table<PinDescription>("pin",
                                    "Vertices that stay where they start, or go where they are told, "
                                    "whatever pulls at them.");
  add_pin_keys(*keys);
  return keys;
}

CodecPtr<AttachmentDescription> attachment_codec() {
  auto keys = table<AttachmentDescription>("attachment",
                                           "Vertices that springs pull to where they start, or to "
                                           "where they are told.");
  add_pin_keys(*keys);
  keys->key<&AttachmentDescription::compliance>("compliance", number<float>(from_zero(1e6)),
                                                "of the spring of each vertex [m/N]; 0 is rigid");
  return keys;
}

}  // namespace souple::scene_format
