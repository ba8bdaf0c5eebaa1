#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

/// [[x, y, z], [x, y, z]]: the lower and the upper corner.
class BoxCorners : public Codec<Selector::InBox> {
 public:
  void read(const Json& json, const JsonPath& path, Selector::InBox& value) const override {
    std::array<Vec3f, 2> corners;
    corners_.read(json, path, corners);
    value = {corners[0], corners[1]};
    for (int i = 0; i < 3; ++i)
      if (value.lo[i] > value.hi[i])
        path.fail("the first corner must be the lower one, found " + brief(json));
  }
  Json write(const Selector::InBox& value) const override { return corners_.write({value.lo, value.hi}); }
  TypeInfo describe(Format& format) const override { return corners_.describe(format); }

 private:
  Array<Vec3f, 2> corners_{vector3<float>(meters), "two corners, [[x, y, z], [x, y, z]]",
                           "[[x, y, z], [x, y, z]]"};
};

template <class T>
void add_pin_keys(Table<T>& keys) {
  keys.template choice<&PinDescription::where, &Selector::choice>(selectors());
  add_keyframe_keys(keys,
                    "moves the vertices: `translate` is relative to their start positions, `rotate` rotates "
                    "them about `about`")
      .template key<&PinDescription::about>("about", maybe(vector3<double>(meters)),
                                            "center of rotation [m]; if not given, the mean of the vertices")
      .template key<&PinDescription::sequence>("sequence", maybe(sequence_codec()),
                                               "moves the vertices to positions from files")
      .needs("about", "keyframes")
      .excludes("keyframes", "sequence");
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
          alternative<V>("all", constant<S::All>(Json::of(true), "true"), "all vertices")};
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
