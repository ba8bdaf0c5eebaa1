#include "souple/files/file.h"
#include "souple/scene/keys/parts.h"

#include <algorithm>

namespace souple::scene_format {

namespace {

constexpr double fast = 1e5;  // m/s

CodecPtr<TethersDescription> tethers_codec() {
  auto keys = table<TethersDescription>(
      "tethers",
      "Limits the distance of each vertex from the nearest pinned vertex to its distance along the mesh at "
      "rest, plus `slack` (Kim 2012). Keeps long hanging cloth and ropes from sagging.");
  keys->key<&TethersDescription::slack>("slack", number<float>(from_zero(10)),
                                        "extra length as a fraction; 0.02 allows 2 % more");
  return keys;
}

CodecPtr<EnclosedVolumeDescription> enclosed_volume_codec() {
  using E = EnclosedVolumeDescription;
  auto keys = table<E>("enclosed_volume", "Preserves the volume inside a cloth.");
  keys->key<&E::factor>("factor", number<float>(positive(1000)), "target volume over the volume at rest")
      .key<&E::compliance>("compliance", number<float>(from_zero(1e6)), "compliance [m^3/Pa]; 0 is rigid");
  return keys;
}

/// A pattern's name, or the name of a PNG file.
class PrintCodec : public Codec<ClothPrint> {
 public:
  void read(const Json& json, const JsonPath& path, ClothPrint& value) const override {
    if (is_picture(json)) return file_->read(json, path, value.file);
    if (json.is(Json::Kind::text) && json.text.find('.') != std::string::npos)
      path.unexpected("a pattern's name or a picture whose name ends in .png", json);
    value.file.clear();
    pattern_->read(json, path, value.pattern);
  }
  Json write(const ClothPrint& value) const override {
    return value.file.empty() ? pattern_->write(value.pattern) : file_->write(value.file);
  }
  TypeInfo describe(Format& format) const override {
    const TypeInfo pattern = pattern_->describe(format);
    TypeInfo file = file_->describe(format);
    file.schema.set("pattern", Json::of("\\.[Pp][Nn][Gg]$"));
    return {pattern.text + ", or a PNG file, relative to the scene's folder",
            Json::object({{"oneOf", Json::array({pattern.schema, file.schema})}})};
  }

 private:
  static bool is_picture(const Json& json) {
    return json.is(Json::Kind::text) && lower_case(json.text).ends_with(".png");
  }

  CodecPtr<std::string> file_ = file();
  CodecPtr<ClothPattern> pattern_ = enumeration<ClothPattern>({{"plain", ClothPattern::plain},
                                                               {"checker", ClothPattern::checker},
                                                               {"stripes", ClothPattern::stripes},
                                                               {"plaid", ClothPattern::plaid},
                                                               {"dots", ClothPattern::dots}});
};

template <class T>
std::shared_ptr<Table<T>> object_table(const char* kind, const char* doc) {
  auto keys = table<T>(kind, doc);
  keys->template key<&T::name>(
          "name", name(),
          "unique name, also for its files; if not given: the kind, then the kind with 2, 3, ...")
      .template required<&T::name>("kind", constant<std::string>(Json::of(kind), kind), "kind of the object");
  return keys;
}

template <class T>
void add_wind_key(Table<T>& keys) {
  keys.template key<&T::wind_exposure>(
      "wind_exposure", number<float>(from_zero(100)),
      "share of the wind's velocity that reaches it: 0 in the lee, where air "
      "is still; more than 1 in a draft");
}

template <class T>
void add_object_keys(Table<T>& keys) {
  keys.template key<&T::transform>("transform", transform_codec(), "initial position, rotation and scale")
      .template key<&T::velocity>("velocity", vector3<float>(signed_range(fast)), "initial velocity [m/s]")
      .template key<&T::angular_velocity>("angular_velocity", vector3<float>(signed_range(fast)),
                                          "initial angular velocity about the center of mass [rad/s]")
      .template key<&T::color>("color", maybe(color()),
                               "color in pictures, as in HTML; if not given: one of eight")
      .template key<&T::pins>("pins", list(pin_codec(), 0, 10000),
                              "vertices that are fixed, or moved by keyframes or a sequence")
      .template key<&T::attachments>("attachments", list(attachment_codec(), 0, 10000),
                                     "vertices attached by springs");
  add_wind_key(keys);
  add_collision_keys(keys);
}

template <class T>
void add_self_collision_key(Table<T>& keys) {
  keys.template key<&T::self_collision>(
      "self_collision", self_collision(true),
      "whether it collides with itself: true is `surfaces`, which never pass through each other; `particles` "
      "is fast but lets some pass");
}

template <class T>
void add_layer_key(Table<T>& keys) {
  keys.template key<&T::layer>("layer", number<int>(within(0, 1000)),
                               "layer of cloth; 0: no order. A colliding object of a higher layer lies over "
                               "the other, on the side where the other's triangles are counterclockwise");
}

std::shared_ptr<Table<ClothDescription>> cloth_table() {
  using T = ClothDescription;
  auto keys = object_table<T>("cloth", "A thin sheet: cloth, paper, leather.");
  keys->required<&T::mesh>("mesh", mesh_codec(MeshUse::surface), "surface at rest")
      .key<&T::material>("material", cloth_material_codec(), "material properties");
  add_object_keys(*keys);
  add_self_collision_key(*keys);
  add_layer_key(*keys);
  keys->key<&T::maps>("maps", maps_codec(), "values that vary per vertex")
      .key<&T::tethers>("tethers", maybe(tethers_codec()), "limits the distance of vertices from the pins")
      .key<&T::pressure>("pressure", maybe(number<float>(signed_range(1e9))),
                         "gas pressure inside a surface, closed but for small holes, above that outside [Pa]")
      .key<&T::enclosed_volume>("enclosed_volume", maybe(enclosed_volume_codec()),
                                "preserves the volume inside a surface, closed but for small holes")
      .key<&T::look>(
          "look",
          enumeration<ClothLook>(
              {{"woven", ClothLook::woven}, {"velvet", ClothLook::velvet}, {"satin", ClothLook::satin}}),
          "fabric in pictures")
      .key<&T::pattern>(
          "pattern", maybe<ClothPrint>(std::make_shared<PrintCodec>()),
          "print in pictures; a picture appears where the mesh's UVs are; if not given: of woven "
          "cloth one of four, of others plain");
  return keys;
}

CodecPtr<LatticeOptions> lattice_codec() {
  auto keys = table<LatticeOptions>("lattice", "Resolution of the tet lattice that fills a surface.");
  keys->key<&LatticeOptions::cells>("cells", number<std::size_t>(within(1, max_vertices)),
                                    "target number of tets")
      .key<&LatticeOptions::cell_size>("cell_size", number<double>(from_zero(far_away)),
                                       "size of a cell [m], instead of `cells`; 0: from `cells`")
      .excludes("cells", "cell_size");
  return keys;
}

std::shared_ptr<Table<SoftBodyDescription>> soft_body_table() {
  using T = SoftBodyDescription;
  auto keys = object_table<T>("soft_body", "A deformable solid: jelly, rubber, flesh.");
  keys->required<&T::mesh>("mesh", mesh_codec(MeshUse::solid), "shape at rest")
      .key<&T::lattice>("lattice", maybe(lattice_codec()), "tet lattice that fills a surface")
      .key<&T::material>("material", soft_body_material_codec(), "material properties");
  add_object_keys(*keys);
  add_self_collision_key(*keys);
  add_layer_key(*keys);
  keys->key<&T::maps>("maps", maps_codec(), "values that vary per vertex");
  return keys;
}

std::shared_ptr<Table<RopeDescription>> rope_table() {
  using T = RopeDescription;
  auto keys = object_table<T>("rope", "A line: a rope, a cable, a wire.");
  keys->required<&T::points>("points", list(vector3<double>(meters), 2), "corners of the polyline [m]")
      .key<&T::segments>("segments", number<std::uint32_t>(within(1, 1e6)),
                         "number of segments of equal length; with self_collision each at least a fifth of "
                         "the radius long")
      .key<&T::material>("material", rope_material_codec(), "material properties");
  add_object_keys(*keys);
  keys->key<&T::self_collision>("self_collision", self_collision(false), "whether it collides with itself")
      .key<&T::tethers>("tethers", maybe(tethers_codec()), "limits the distance of vertices from the pins");
  return keys;
}

/// Corners of a box.
template <class T>
void add_corner_keys(Table<T>& keys) {
  keys.template required<&T::lo>("lo", vector3<double>(meters), "lower corner [m]")
      .template required<&T::hi>("hi", vector3<double>(meters), "upper corner [m]")
      .check([](const T& box, const JsonPath& path) {
        for (int i = 0; i < 3; ++i) {
          if (!(box.lo[i] < box.hi[i])) path.fail("\"lo\" must be below \"hi\" along every axis");
        }
      });
}

template <class T>
void add_spacing_keys(Table<T>& keys) {
  keys.template key<&T::spacing>(
          "spacing", maybe(number<double>(positive(1000))),
          "distance between centers [m]; if not given, two radii plus the space for the jitter")
      .template key<&T::jitter>(
          "jitter", number<double>(unit),
          "random displacement of each center along each axis, up to this fraction of a radius");
}

CodecPtr<GrainsBox> grains_box_codec() {
  auto keys = table<GrainsBox>("grains_box", "A box filled with grains on a cubic lattice.");
  add_corner_keys(*keys);
  add_spacing_keys(*keys);
  return keys;
}

CodecPtr<GrainsGrid> grains_grid_codec() {
  using G = GrainsGrid;
  auto keys = table<G>("grains_grid", "A cubic lattice of grains, centered at the origin.");
  keys->required<&G::counts>("counts", counts(10000), "grains along X, Y and Z")
      .check([](const G& grid, const JsonPath& path) {
        check_count(static_cast<double>(grid.counts[0]) * grid.counts[1] * grid.counts[2], path);
      });
  add_spacing_keys(*keys);
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
  keys->key<&T::material>("material", grains_material_codec(), "material properties");
  add_object_keys(*keys);
  return keys;
}

CodecPtr<FluidBox> fluid_box_codec() {
  auto keys = table<FluidBox>("fluid_box", "A box filled with a fluid.");
  add_corner_keys(*keys);
  return keys;
}

std::shared_ptr<Table<FluidDescription>> fluid_table() {
  using T = FluidDescription;
  auto keys = object_table<T>("fluid", "A liquid: water, oil, honey.");
  using V = decltype(T::filling);
  keys->choice<&T::filling>(
      {alternative<V>("points", list(vector3<double>(meters), 0),
                      "positions of particles [m]; [] if emitters add all of them"),
       alternative<V>("box", fluid_box_codec(), "fills a box"),
       alternative<V>("mesh", mesh_codec(MeshUse::surface), "fills a surface, closed but for small holes")});
  keys->key<&T::material>("material", fluid_material_codec(), "material properties")
      .key<&T::transform>("transform", transform_codec(), "initial position, rotation and scale")
      .key<&T::velocity>("velocity", vector3<float>(signed_range(fast)), "initial velocity [m/s]")
      .key<&T::emitters>("emitters", list(emitter_codec(), 0, 10000), "nozzles that add more of this fluid")
      .key<&T::max_particles>("max_particles", number<std::uint32_t>(within(0, 5e7)),
                              "maximum number of particles; emitters stop at it, and memory for all of them "
                              "is reserved at the start")
      .key<&T::color>("color", maybe(color()), "color in pictures, as in HTML")
      .key<&T::caustics>(
          "caustics", boolean(),
          "whether it refracts sunlight onto the floor in pictures, as bright lines under waves")
      .check([](const T& fluid, const JsonPath& path) {
        const auto* points = std::get_if<std::vector<Vec3d>>(&fluid.filling);
        if (points && points->empty() && fluid.max_particles == 0)
          path.fail("\"points\" is empty; a fluid that emitters fill needs \"max_particles\"");
        if (!fluid.emitters.empty() && fluid.max_particles == 0)
          path.fail("\"emitters\" need \"max_particles\", the maximum number of particles");
      });
  add_wind_key(*keys);
  add_collision_keys(*keys);
  return keys;
}

std::shared_ptr<Table<ObstacleDescription>> obstacle_table() {
  using T = ObstacleDescription;
  auto keys = object_table<T>("obstacle",
                              "A kinematic mesh that other objects collide with: static, moved by keyframes, "
                              "or deforming like a walking character. It may be open; both sides are solid. "
                              "With both `sequence` and `keyframes`, the keyframes move the deforming mesh.");
  keys->required<&T::mesh>("mesh", mesh_codec(MeshUse::surface), "surface mesh")
      .key<&T::material>("material", obstacle_material_codec(), "contact properties")
      .key<&T::transform>("transform", transform_codec(), "position, rotation and scale")
      .key<&T::color>("color", maybe(color()), "color in pictures, as in HTML; if not given: light gray")
      .key<&T::look>("look", surface_look(),
                     "material in pictures; `glass` is transparent, best with thin walls");
  add_keyframe_keys(*keys,
                    "moves the mesh after `transform`: rotated about the origin first, then translated")
      .key<&T::sequence>("sequence", maybe(sequence_codec()), "deforms the mesh");
  add_collision_keys(*keys);
  add_layer_key(*keys);
  return keys;
}

/// Tells each table the keys of the other kinds of objects: their message names the kind that has the key.
void add_foreign_keys(const std::vector<std::pair<std::string, TableCore*>>& kinds) {
  for (const auto& [kind, mine] : kinds) {
    const std::vector<std::string> own = mine->keys();
    std::vector<std::pair<std::string, std::string>> foreign;
    for (const auto& [owner, other] : kinds)
      for (const std::string& key : other->keys())
        if (std::find(own.begin(), own.end(), key) == own.end()) foreign.emplace_back(key, owner);
    mine->foreign(std::move(foreign));
  }
}

CodecPtr<RigidPartDescription> rigid_part_codec() {
  using P = RigidPartDescription;
  auto keys = table<P>("rigid_body_part", "A shape of a rigid body of several.");
  keys->required<&P::shape>("shape", shape_codec(), "a sphere, box, capsule or cylinder")
      .key<&P::transform>("transform", pose_codec(), "position and rotation in the body's own frame")
      .key<&P::density>("density", maybe(number<double>(positive(1e6))),
                        "density of this shape [kg/m^3]; if not given: that of `material`");
  return keys;
}

std::shared_ptr<Table<RigidBodyDescription>> rigid_body_table() {
  using T = RigidBodyDescription;
  auto keys = object_table<T>("rigid_body", "A solid that does not deform: a box, a ball, a bone.");
  using V = decltype(T::solid);
  keys->choice<&T::solid>(
      {alternative<V>("shape", shape_codec(), "a sphere, box, capsule or cylinder"),
       alternative<V>(
           "mesh", mesh_codec(MeshUse::surface),
           "a surface; it collides with rigid bodies, colliders and obstacles as the convex hull of each "
           "piece"),
       alternative<V>("shapes", list(rigid_part_codec(), 1, 1000),
                      "several shapes that form one body; what they share counts in the mass of each")});
  keys->key<&T::material>("material", rigid_body_material_codec(), "density and contact properties")
      .key<&T::transform>("transform", transform_codec(), "initial position, rotation and scale")
      .key<&T::velocity>("velocity", vector3<float>(signed_range(fast)), "initial velocity [m/s]")
      .key<&T::angular_velocity>("angular_velocity", vector3<float>(signed_range(fast)),
                                 "initial angular velocity about the center of mass [rad/s]")
      .key<&T::mass>("mass", maybe(number<double>(positive(1e12))),
                     "mass [kg], instead of that of the solid of `material.density`")
      .key<&T::center_of_mass>("center_of_mass", maybe(vector3<double>(meters)),
                               "center of mass in the frame of the mesh or shape, before `transform` [m]; if "
                               "not given: of the solid")
      .key<&T::inertia>(
          "inertia", maybe(vector3<double>(positive(1e12))),
          "moments of inertia about the axes of that frame through the center of mass [kg m^2]; if "
          "not given: of the solid, for its mass")
      .key<&T::kinematic>("kinematic", boolean(),
                          "true: nothing pushes the body; it pushes others, stands or follows `keyframes`")
      .needs("keyframes", "kinematic");
  add_keyframe_keys(*keys,
                    "motion of a kinematic body after `transform`: rotated about the origin first, then "
                    "translated")
      .check([](const T& body, const JsonPath& path) {
        if (!body.keyframes.empty() && !body.kinematic)
          path.key("kinematic")
              .fail("is false, but \"keyframes\" move only a kinematic body: set it to true");
      })
      .key<&T::color>("color", maybe(color()), "color in pictures, as in HTML; if not given: one of eight")
      .key<&T::attachments>("attachments", list(attachment_codec(), 0, 10000),
                            "vertices attached by springs");
  add_wind_key(*keys);
  add_collision_keys(*keys);
  return keys;
}

}  // namespace

CodecPtr<AnyObjectDescription> object_codec() {
  const auto cloth = cloth_table();
  const auto soft_body = soft_body_table();
  const auto rope = rope_table();
  const auto grains = grains_table();
  const auto obstacle = obstacle_table();
  const auto fluid = fluid_table();
  const auto rigid_body = rigid_body_table();
  add_foreign_keys({{"a cloth", cloth.get()},
                    {"a soft_body", soft_body.get()},
                    {"a rope", rope.get()},
                    {"grains", grains.get()},
                    {"an obstacle", obstacle.get()},
                    {"a fluid", fluid.get()},
                    {"a rigid_body", rigid_body.get()}});
  using V = AnyObjectDescription;
  return std::make_shared<Kinds<V>>(
      std::vector<Alternative>{alternative<V, ClothDescription>("cloth", cloth, ""),
                               alternative<V, SoftBodyDescription>("soft_body", soft_body, ""),
                               alternative<V, RopeDescription>("rope", rope, ""),
                               alternative<V, GrainsDescription>("grains", grains, ""),
                               alternative<V, ObstacleDescription>("obstacle", obstacle, ""),
                               alternative<V, FluidDescription>("fluid", fluid, ""),
                               alternative<V, RigidBodyDescription>("rigid_body", rigid_body, "")});
}

}  // namespace souple::scene_format
