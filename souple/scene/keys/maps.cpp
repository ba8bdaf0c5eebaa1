#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

template <class T>
void add_map_keys(Table<T>& keys, const char* value_doc, const char* fallback_doc) {
  using V = decltype(MapDescription::source);
  auto channel = enumeration<ColorChannel>(
      {{"red", ColorChannel::red}, {"green", ColorChannel::green}, {"blue", ColorChannel::blue}});
  keys.template choice<&MapDescription::source>(
      {alternative<V>("group", text(),
                      "vertices of this group of the mesh file get `value`, all others `default`"),
       alternative<V>("color", channel,
                      "this channel of the vertex colors blends from `default` (0) to `value` (1)")});
  keys.template key<&MapDescription::value>("value", number<float>(from_zero(1e4)), value_doc)
      .template key<&MapDescription::fallback>("default", number<float>(from_zero(1e4)), fallback_doc);
}

CodecPtr<PinMapDescription> pin_map_codec() {
  auto keys = table<PinMapDescription>(
      "pin_map",
      "How strongly each vertex is attached to its start position: weight 1 is a pin, 0 is free. A weight w "
      "between them is a spring of compliance (1 - w) / w times `compliance`.");
  add_map_keys(*keys, "weight in the group, or at color 1; at most 1", "weight elsewhere, or at color 0");
  keys->key<&PinMapDescription::compliance>("compliance", number<float>(positive(1e6)),
                                            "spring compliance of a vertex of weight 0.5 [m/N]")
      .check([](const PinMapDescription& map, const JsonPath& path) {
        if (map.value > 1) path.key("value").fail("expected a weight from 0 to 1");
        if (map.fallback > 1) path.key("default").fail("expected a weight from 0 to 1");
      });
  return keys;
}

CodecPtr<MapDescription> scale_map_codec() {
  auto keys = table<MapDescription>("map", "A factor for each vertex.");
  keys->start(
      [](const Json&, const JsonPath&, void* map) { static_cast<MapDescription*>(map)->fallback = 1; },
      [](const MapDescription&, MapDescription& fallback) { fallback.fallback = 1; });
  add_map_keys(*keys, "factor in the group, or at color 1", "factor elsewhere, or at color 0");
  return keys;
}

}  // namespace

CodecPtr<MapsDescription> maps_codec() {
  using M = MapsDescription;
  auto keys = table<M>("maps", "Values per vertex, from the groups or the vertex colors of the mesh file.");
  keys->key<&M::pin_weight>("pin_weight", maybe(pin_map_codec()),
                            "how strongly vertices are attached to their start positions")
      .key<&M::stiffness>("stiffness", maybe(scale_map_codec()), "scales the material's stiffness")
      .key<&M::thickness>("thickness", maybe(scale_map_codec()), "scales the material's thickness");
  return keys;
}

}  // namespace souple::scene_format
