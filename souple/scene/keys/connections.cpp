#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

CodecPtr<PairDescription> pair_codec() {
  using P = PairDescription;
  const auto two_names = std::make_shared<Array<std::string, 2>>(name(), "two names: [a, b]", "[name, name]");
  auto keys = table<P>(
      "pair",
      "Overrides for two objects or colliders: their friction and restitution instead of their materials', "
      "and whether they collide, whatever their groups. A name twice means an object with itself.");
  keys->required<&P::between>("between", two_names, "names of objects or colliders")
      .key<&P::collide>("collide", boolean(), "false: they pass through each other")
      .key<&P::friction>("friction", maybe(number<float>(friction_range)), "Coulomb friction coefficient")
      .key<&P::kinetic_friction>(
          "kinetic_friction", maybe(number<float>(friction_range)),
          "friction coefficient while sliding, at most `friction`; if not given: `friction`")
      .key<&P::restitution>("restitution", number<float>(unit),
                            "coefficient of restitution, the fraction of the speed that a bounce keeps")
      .needs("restitution", "friction")
      .needs("kinetic_friction", "friction")
      .check(check_kinetic_friction<P>)
      .check([](const P& pair, const JsonPath& path) {
        if (pair.collide && !pair.friction) path.fail("needs \"friction\", or \"collide\": false");
      });
  return keys;
}

CodecPtr<ConnectionDescription> connection_codec() {
  using C = ConnectionDescription;
  auto end = table<EndDescription>("end", "Vertices of an object.");
  end->required<&EndDescription::object>("object", name(), "name of the object");
  end->choice<&EndDescription::where, &Selector::choice>(selectors());
  auto keys =
      table<C>("connection", "Distance joints between vertices of two objects, or of one, pair by pair.");
  keys->required<&C::from>("from", CodecPtr<EndDescription>(end), "vertices of the first object")
      .required<&C::to>("to", CodecPtr<EndDescription>(end), "vertices of the second object")
      .key<&C::pairing>(
          "pairing", enumeration<Pairing>({{"in_order", Pairing::in_order}, {"nearest", Pairing::nearest}}),
          "in_order: first with first, second with second (a single vertex joins all of the other side). "
          "nearest: each vertex of `from` with the nearest of `to`")
      .key<&C::rest_length>(
          "rest_length", maybe(number<float>(from_zero(far_away))),
          "rest length [m]; if not given, the distance at the start; 0 glues the vertices together")
      .key<&C::compliance>("compliance", number<float>(from_zero(1e6)),
                           "compliance of each joint [m/N]; 0 is rigid")
      .key<&C::until>("until", maybe(number<double>(from_zero(far_away))),
                      "time at which the joints are released [s]; if not given, never");
  return keys;
}

}  // namespace souple::scene_format
