#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

CodecPtr<StitchDescription> stitch_codec() {
  using S = StitchDescription;
  auto keys = table<S>("stitch", "Ties each of some vertices of `from` to the closest point of `to`.");
  keys->choice<&S::where, &Selector::choice>(selectors());
  keys->key<&S::distance>("distance", number<double>(from_zero(far_away)),
                          "vertices farther away at the start are not tied [m]");
  return keys;
}

CodecPtr<SlideDescription> slide_codec() {
  using S = SlideDescription;
  auto keys = table<S>("slide", "Lets the point of `to` slide along a chain of its edges.");
  keys->key<&S::along>("along", list(number<std::uint32_t>(from_zero(1e9)), 0, 100000),
                       "vertices of `to`, in order; if not given, all of a rope")
      .key<&S::friction>("friction", number<double>(from_zero(1e3)), "Coulomb friction coefficient");
  return keys;
}

}  // namespace

CodecPtr<TieDescription> tie_codec() {
  using T = TieDescription;
  auto keys =
      table<T>("tie", "Ties a point of an object to a point of another object, a collider or the world.");
  keys->key<&T::name>("name", name(), "for messages; if not given, \"tie\"")
      .key<&T::from>("from", name(), "an object or collider; if not given, the world")
      .required<&T::to>("to", name(), "an object")
      .key<&T::point>("point", maybe(vector3<double>(meters)),
                      "it holds the closest points of both to this one at the start [m]")
      .key<&T::to_point>(
          "to_point", maybe(vector3<double>(meters)),
          "it holds the point of `to` that is closest to this one [m]; if not given, to `point`")
      .key<&T::stitch>("stitch", maybe(stitch_codec()), "many ties, one for each of some vertices")
      .key<&T::rest_length>(
          "rest_length", maybe(number<double>(from_zero(far_away))),
          "rest length [m]; 0 draws the points together; if not given, as they lie at the start")
      .key<&T::compliance>("compliance", number<double>(from_zero(1e9)), "compliance [m/N]; 0 is rigid")
      .key<&T::breaking_force>("breaking_force", maybe(number<double>(positive(1e15))),
                               "it breaks at a larger force [N]; if not given, never")
      .key<&T::breaking_strain>(
          "breaking_strain", maybe(number<double>(positive(1e6))),
          "it breaks at a larger strain, relative to its rest length; if not given, never")
      .key<&T::slide>("slide", maybe(slide_codec()), "the point of `to` slides")
      .excludes("point", "stitch")
      .needs("to_point", "point")
      .check([](const T& tie, const JsonPath& path) {
        if (!tie.point && !tie.stitch) path.fail("needs \"point\" or \"stitch\"");
        if (tie.stitch && tie.from.empty())
          path.fail("\"stitch\" needs \"from\": an object with the vertices");
        if (tie.stitch && tie.slide) path.fail("\"stitch\" and \"slide\" exclude each other");
      });
  return keys;
}

}  // namespace souple::scene_format
