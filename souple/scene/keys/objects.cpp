#include "souple/scene/keys/parts.h"

#include <algorithm>

namespace souple::scene_format {

namespace {

constexpr double fast = 1e5;  // m/s

CodecPtr<TethersDescription> tethers_codec() {
  auto keys = table<TethersDescription>("tethers",
                                        "No vertex goes farther from the nearest pinned vertex than "
                                        "its distance along the mesh, stretched by `slack` (Kim 2012): "
                                        "stops long hanging cloth and ropes from sagging.");
  keys->key<&TethersDescription::slack>("slack", number<float>(from_zero(10)), "0.02 allows 2 % more");
  return keys;
}

CodecPtr<EnclosedVolumeDescription> enclosed_volume_codec() {
  using E = EnclosedVolumeDescription;
  auto keys = table<E>("enclosed_volume", "Keeps the volume inside a closed cloth.");
  keys->key<&E::factor>("factor", number<float>(positive(1000)), "of the volume at rest")
      .key<&E::compliance>("compliance", number<float>(from_zero(1e6)), "[m^3/Pa]; 0 is rigid");
  return keys;
}

/// The key that tells objects apart; already read when its table is.
class KindWord : public Codec<std::string> {
 public:
  explicit KindWord(std::string kind) : kind_(std::move(kind)) {}
  void read(const Json&, const JsonPath&, std::string&) const override {}
  Json write(const std::string&) const override { return Json::of(kind_); }
  TypeInfo describe(Format&) const override {
    Json schema = Json::object();
    schema.set("const", Json::of(kind_));
    return {"\"" + kind_ + "\"", schema};
  }

 private:
  std::string kind_;
};

template <class T>
std::shared_ptr<Table<T>> object_table(const char* kind, const char* doc) {
  auto keys = table<T>(kind, doc);
  keys->template key<&T::name>("name", name(),
                               "unique; names its files. If not given: the kind, then the kind and 2, 3, ...")
      .template required<&T::name>("kind", CodecPtr<std::string>(std::make_shared<KindWord>(kind)),
                                   "what it is");
  return keys;
}

template <class T>
void add_object_keys(Table<T>& keys) {
  keys.template key<&T::transform>("transform", transform_codec(), "where it stands at the start")
      .template key<&T::velocity>("velocity", vector3<float>(signed_range(fast)), "at the start [m/s]")
      .template key<&T::angular_velocity>("angular_velocity", vector3<float>(signed_range(fast)),
                                          "at the start, about the center of mass [rad/s]")
      .template key<&T::color>("color", maybe(color()),
                               "how pictures show it, as in HTML; if not given: one of eight")
      .template key<&T::pins>("pins", list(pin_codec(), 0, 10000), "vertices held where they are, or led")
      .template key<&T::attachments>("attachments", list(attachment_codec(), 0, 10000),
                                     "vertices held by springs");
  add_collision_keys(keys);
}

template <class T>
void add_self_collision_key(Table<T>& keys) {
  keys.template key<&T::self_collision>("self_collision", boolean(), "its surface touches itself");
}

template <class T>
void add_layer_key(Table<T>& keys) {
  keys.template key<&T::layer>(
      "layer", number<int>(within(0, 1000)),
      "which layer of cloth it is: of two that meet, the higher lies over the other, on "
      "the side where that one's triangles are counter-clockwise; 0: in no order");
}

std::shared_ptr<Table<ClothDescription>> cloth_table() {
  using T = ClothDescription;
  auto keys = object_table<T>("cloth", "A thin sheet: cloth, paper, skin.");
  keys->required<&T::mesh>("mesh", mesh_codec(MeshUse::surface), "its surface at rest")
      .key<&T::material>("material", cloth_material_codec(), "what it is made of");
  add_object_keys(*keys);
  add_self_collision_key(*keys);
  add_layer_key(*keys);
  keys->key<&T::maps>("maps", maps_codec(), "what differs from vertex to vertex")
      .key<&T::tethers>("tethers", maybe(tethers_codec()), "limits how far it hangs from its pins")
      .key<&T::pressure>("pressure", maybe(number<float>(signed_range(1e9))),
                         "of the gas inside a closed surface, above the outside [Pa]")
      .key<&T::enclosed_volume>("enclosed_volume", maybe(enclosed_volume_codec()),
                                "keeps the volume inside a closed surface");
  return keys;
}

CodecPtr<LatticeOptions> lattice_codec() {
  auto keys =
      table<LatticeOptions>("lattice", "How finely a soft body made from a surface is cut into tets.");
  keys->key<&LatticeOptions::cells>("cells", number<std::size_t>(within(1, max_vertices)),
                                    "wanted number of tets")
      .key<&LatticeOptions::cell_size>("cell_size", number<double>(from_zero(far_away)),
                                       "size of a cell [m], instead of `cells`; 0: from `cells`")
      .excludes("cells", "cell_size");
  return keys;
}

std::shared_ptr<Table<SoftBodyDescription>> soft_body_table() {
  using T = SoftBodyDescription;
  auto keys = object_table<T>("soft_body", "A solid that deforms: jelly, rubber, flesh.");
  keys->required<&T::mesh>("mesh", mesh_codec(MeshUse::solid), "its shape at rest")
      .key<&T::lattice>("lattice", maybe(lattice_codec()), "how a surface is filled with tets")
      .key<&T::material>("material", soft_body_material_codec(), "what it is made of");
  add_object_keys(*keys);
  add_self_collision_key(*keys);
  add_layer_key(*keys);
  keys->key<&T::maps>("maps", maps_codec(), "what differs from vertex to vertex");
  return keys;
}

std::shared_ptr<Table<RopeDescription>> rope_table() {
  using T = RopeDescription;
  auto keys = object_table<T>("rope", "A line: rope, cable, wire.");
  keys->required<&T::points>("points", list(vector3<double>(meters), 2), "the corners of its course [m]")
      .key<&T::segments>("segments", number<std::uint32_t>(within(1, 1e6)),
                         "pieces of equal length it is cut into")
      .key<&T::material>("material", rope_material_codec(), "what it is made of");
  add_object_keys(*keys);
  add_self_collision_key(*keys);
  keys->key<&T::tethers>("tethers", maybe(tethers_codec()), "limits how far it hangs from its pins");
  return keys;
}

CodecPtr<GrainsBox> grains_box_codec() {
  using G = GrainsBox;
  auto keys = table<G>("grains_box", "A box filled with grains on a cubic lattice.");
  keys->required<&G::lo>("lo", vector3<double>(meters), "lower corner [m]")
      .required<&G::hi>("hi", vector3<double>(meters), "upper corner [m]")
      .key<&G::spacing>("spacing", maybe(number<double>(positive(1000))),
                        "between centers [m]; if not given, two radii and what the jitter needs")
      .key<&G::jitter>("jitter", number<double>(unit),
                       "each center is moved at random by up to this fraction of a radius along each axis")
      .check([](const G& box, const JsonPath& path) {
        for (int i = 0; i < 3; ++i) {
          if (!(box.lo[i] < box.hi[i])) path.fail("\"lo\" must be below \"hi\" along every axis");
        }
      });
  return keys;
}

CodecPtr<GrainsGrid> grains_grid_codec() {
  using G = GrainsGrid;
  auto keys = table<G>("grains_grid", "A cubic lattice of grains, centered at the origin.");
  keys->required<&G::counts>("counts", counts(10000), "grains along X, Y and Z")
      .key<&G::spacing>("spacing", maybe(number<double>(positive(1000))),
                        "between centers [m]; if not given, two radii and what the jitter needs")
      .key<&G::jitter>("jitter", number<double>(unit),
                       "each center is moved at random by up to this fraction of a radius along each axis")
      .check([](const G& grid, const JsonPath& path) {
        check_count(static_cast<double>(grid.counts[0]) * grid.counts[1] * grid.counts[2], path);
      });
  return keys;
}

std::shared_ptr<Table<GrainsDescription>> grains_table() {
  using T = GrainsDescription;
  auto keys = object_table<T>("grains", "Loose balls: sand, gravel, beads.");
  using V = decltype(T::centers);
  keys->choice<&T::centers>({alternative<V>("points", list(vector3<double>(meters), 1), "centers [m]"),
                             alternative<V>("box", grains_box_codec(), "fills a box"),
                             alternative<V>("grid", grains_grid_codec(), "a given number along each axis"),
                             alternative<V>("mesh", mesh_codec(MeshUse::points), "centers from a file")});
  keys->key<&T::material>("material", grains_material_codec(), "what they are made of");
  add_object_keys(*keys);
  return keys;
}

CodecPtr<FluidBox> fluid_box_codec() {
  auto keys = table<FluidBox>("fluid_box", "A box filled with a fluid.");
  keys->required<&FluidBox::lo>("lo", vector3<double>(meters), "lower corner [m]")
      .required<&FluidBox::hi>("hi", vector3<double>(meters), "upper corner [m]")
      .check([](const FluidBox& box, const JsonPath& path) {
        for (int i = 0; i < 3; ++i) {
          if (!(box.lo[i] < box.hi[i])) path.fail("\"lo\" must be below \"hi\" along every axis");
        }
      });
  return keys;
}

std::shared_ptr<Table<FluidDescription>> fluid_table() {
  using T = FluidDescription;
  auto keys = object_table<T>("fluid", "A liquid: water, oil, honey.");
  using V = decltype(T::filling);
  keys->choice<&T::filling>({alternative<V>("points", list(vector3<double>(meters), 0),
                                            "where particles are [m]; [] where emitters bring all of them"),
                             alternative<V>("box", fluid_box_codec(), "fills a box"),
                             alternative<V>("mesh", mesh_codec(MeshUse::surface), "fills a closed surface")});
  keys->key<&T::material>("material", fluid_material_codec(), "what it is made of")
      .key<&T::transform>("transform", transform_codec(), "where it is put")
      .key<&T::velocity>("velocity", vector3<float>(signed_range(fast)), "at the start [m/s]")
      .key<&T::emitters>("emitters", list(emitter_codec(), 0, 10000), "nozzles from which more of it comes")
      .key<&T::max_particles>("max_particles", number<std::uint32_t>(within(0, 5e7)),
                              "emitters give it no more than these; there is room for them from the start")
      .key<&T::color>("color", maybe(color()), "how pictures show it, as in HTML")
      .check([](const T& fluid, const JsonPath& path) {
        const auto* points = std::get_if<std::vector<Vec3d>>(&fluid.filling);
        if (points && points->empty() && fluid.max_particles == 0)
          path.fail("has no points; a fluid that emitters fill needs \"max_particles\"");
        if (!fluid.emitters.empty() && fluid.max_particles == 0)
          path.fail("\"emitters\" need \"max_particles\": how many particles there may be");
      });
  add_collision_keys(*keys);
  return keys;
}

std::shared_ptr<Table<ObstacleDescription>> obstacle_table() {
  using T = ObstacleDescription;
  auto keys = object_table<T>(
      "obstacle",
      "A mesh that others touch and that nothing moves but its own motion: still, led through keyframes, or "
      "deforming like a character that walks. It may be open; both sides are solid. With both `sequence` and "
      "`keyframes`, these carry the mesh that deforms.");
  keys->required<&T::mesh>("mesh", mesh_codec(MeshUse::surface), "its surface")
      .key<&T::material>("material", obstacle_material_codec(), "how it is felt")
      .key<&T::transform>("transform", transform_codec(), "where it stands")
      .key<&T::color>("color", maybe(color()), "how pictures show it, as in HTML; if not given: light gray")
      .key<&T::keyframes>("keyframes", keyframes_codec(),
                          "moves it, as `transform` has placed it: turned about the origin first, then moved")
      .key<&T::loop>("loop", boolean(), "starts the keyframes over after the last")
      .key<&T::sequence>("sequence", maybe(obstacle_sequence_codec()), "deforms it")
      .needs("loop", "keyframes")
      .check([](const T& obstacle, const JsonPath& path) { check_times(obstacle.keyframes, path); });
  add_collision_keys(*keys);
  add_layer_key(*keys);
  return keys;
}

/// A soft body's key in a cloth is a better message than an unknown key.
template <class A, class B>
void add_foreign(const Table<A>& other, const std::string& owner, const Table<B>& mine,
                 std::vector<std::pair<std::string, std::string>>& foreign) {
  const std::vector<std::string> own = mine.keys();
  for (const std::string& key : other.keys()) {
    if (std::find(own.begin(), own.end(), key) == own.end()) foreign.emplace_back(key, owner);
  }
}

}  // namespace

CodecPtr<AnyObjectDescription> object_codec() {
  const auto cloth = cloth_table();
  const auto soft_body = soft_body_table();
  const auto rope = rope_table();
  const auto grains = grains_table();
  const auto obstacle = obstacle_table();
  const auto fluid = fluid_table();
  const auto foreign_keys_of = [&](const auto& mine) {
    std::vector<std::pair<std::string, std::string>> foreign;
    add_foreign(*cloth, "a cloth", mine, foreign);
    add_foreign(*soft_body, "a soft_body", mine, foreign);
    add_foreign(*rope, "a rope", mine, foreign);
    add_foreign(*grains, "grains", mine, foreign);
    add_foreign(*obstacle, "an obstacle", mine, foreign);
    add_foreign(*fluid, "a fluid", mine, foreign);
    return foreign;
  };
  cloth->foreign(foreign_keys_of(*cloth));
  soft_body->foreign(foreign_keys_of(*soft_body));
  rope->foreign(foreign_keys_of(*rope));
  grains->foreign(foreign_keys_of(*grains));
  obstacle->foreign(foreign_keys_of(*obstacle));
  fluid->foreign(foreign_keys_of(*fluid));
  using V = AnyObjectDescription;
  return std::make_shared<Kinds<V>>(
      std::vector<Alternative>{alternative<V, ClothDescription>("cloth", cloth, ""),
                               alternative<V, SoftBodyDescription>("soft_body", soft_body, ""),
                               alternative<V, RopeDescription>("rope", rope, ""),
                               alternative<V, GrainsDescription>("grains", grains, ""),
                               alternative<V, ObstacleDescription>("obstacle", obstacle, ""),
                               alternative<V, FluidDescription>("fluid", fluid, "")});
}

}  // namespace souple::scene_format
