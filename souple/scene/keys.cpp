#include "souple/scene/keys.h"

#include "souple/solver/solver_names.h"

#include <algorithm>
#include <set>

namespace souple::scene_format {

namespace {

constexpr double far_away = 1e6;       // m
constexpr double fast = 1e5;           // m/s
constexpr double most_vertices = 4e6;  // of one built mesh
const Range metres = signed_range(far_away);
const Range size_range = positive(far_away);

template <class T>
std::shared_ptr<Table<T>> table(const char* name, const char* doc) {
  return std::make_shared<Table<T>>(name, doc);
}

/// Three counts, or one for all three axes.
class Counts : public Codec<std::array<int, 3>> {
 public:
  explicit Counts(int most) : range_(within(1, most)), count_(range_) {}
  void read(const Json& json, const Place& place, std::array<int, 3>& value) const override {
    if (json.is(Json::Kind::number)) {
      int all = 1;
      count_.read(json, place, all);
      value = {all, all, all};
      return;
    }
    if (!json.is(Json::Kind::array) || json.items.size() != 3) {
      place.unexpected("a whole number or three of them, [x, y, z]", json);
    }
    for (std::size_t i = 0; i < 3; ++i) count_.read(json.items[i], place.item(i), value[i]);
  }
  Json write(const std::array<int, 3>& value) const override {
    return Json::array({Json::whole(value[0]), Json::whole(value[1]), Json::whole(value[2])});
  }
  TypeInfo describe(Format&) const override {
    Json three = Json::object();
    three.set("type", Json::of("array"));
    three.set("items", range_.schema("integer"));
    three.set("minItems", Json::whole(3));
    three.set("maxItems", Json::whole(3));
    Json schema = Json::object();
    schema.set("oneOf", Json::array({range_.schema("integer"), three}));
    return {range_.text("whole number") + ", or three of them", schema};
  }

 private:
  Range range_;
  Number<int> count_;
};

CodecPtr<std::array<int, 3>> counts(int most) {
  return std::make_shared<Counts>(most);
}

/// Exactly `true`: the selector that needs no value.
class True : public Codec<Selector::All> {
 public:
  void read(const Json& json, const Place& place, Selector::All&) const override {
    if (!json.is(Json::Kind::boolean) || !json.boolean) place.unexpected("true", json);
  }
  Json write(const Selector::All&) const override { return Json::of(true); }
  TypeInfo describe(Format&) const override {
    Json schema = Json::object();
    schema.set("const", Json::of(true));
    return {"true", schema};
  }
};

/// A stiffness: a number, or "rigid".
class Stiffness : public Codec<float> {
 public:
  explicit Stiffness(const Range& range) : range_(range), number_(range) {}
  void read(const Json& json, const Place& place, float& value) const override {
    if (json.is(Json::Kind::text) && json.text == "rigid") {
      value = rigid;
    } else if (json.is(Json::Kind::number)) {
      number_.read(json, place, value);
    } else {
      place.unexpected(range_.text("a number") + " or \"rigid\"", json);
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

/// A struct whose only field is written without a name of its own.
template <class Outer, class Inner, class Access>
class Wrapped : public Codec<Outer> {
 public:
  Wrapped(Access access, CodecPtr<Inner> inner) : access_(access), inner_(std::move(inner)) {}
  void read(const Json& json, const Place& place, Outer& value) const override {
    inner_->read(json, place, std::invoke(access_, value));
  }
  Json write(const Outer& value) const override { return inner_->write(std::invoke(access_, value)); }
  TypeInfo describe(Format& format) const override { return inner_->describe(format); }

 private:
  Access access_;
  CodecPtr<Inner> inner_;
};
template <class Outer, class Inner>
CodecPtr<Outer> wrapped(Inner Outer::*access, CodecPtr<Inner> inner) {
  return std::make_shared<Wrapped<Outer, Inner, Inner Outer::*>>(access, std::move(inner));
}

/// [[x, y, z], [x, y, z]]: the lower corner and the upper.
class BoxCorners : public Codec<Selector::InBox> {
 public:
  void read(const Json& json, const Place& place, Selector::InBox& value) const override {
    if (!json.is(Json::Kind::array) || json.items.size() != 2) {
      place.unexpected("two corners, [[x, y, z], [x, y, z]]", json);
    }
    corner_.read(json.items[0], place.item(0), value.lo);
    corner_.read(json.items[1], place.item(1), value.hi);
    for (int i = 0; i < 3; ++i) {
      if (value.lo[i] > value.hi[i])
        place.fail("the first corner must be the lower one, found " + brief(json));
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
  Vector3<float> corner_{metres};
};

/// A list of exactly two names.
class TwoNames : public Codec<std::array<std::string, 2>> {
 public:
  void read(const Json& json, const Place& place, std::array<std::string, 2>& value) const override {
    if (!json.is(Json::Kind::array) || json.items.size() != 2) place.unexpected("two names: [a, b]", json);
    for (std::size_t i = 0; i < 2; ++i) name_->read(json.items[i], place.item(i), value[i]);
  }
  Json write(const std::array<std::string, 2>& value) const override {
    return Json::array({Json::of(value[0]), Json::of(value[1])});
  }
  TypeInfo describe(Format& format) const override {
    Json schema = Json::object();
    schema.set("type", Json::of("array"));
    schema.set("items", name_->describe(format).schema);
    schema.set("minItems", Json::whole(2));
    schema.set("maxItems", Json::whole(2));
    return {"[name, name]", schema};
  }

 private:
  CodecPtr<std::string> name_ = name();
};

/// A bit mask as the list of the bits that are set, or "all".
class Groups : public Codec<std::uint32_t> {
 public:
  void read(const Json& json, const Place& place, std::uint32_t& value) const override {
    if (json.is(Json::Kind::text) && json.text == "all") {
      value = ~0u;
      return;
    }
    if (!json.is(Json::Kind::array))
      place.unexpected("a list of group numbers from 0 to 31, or \"all\"", json);
    value = 0;
    for (std::size_t i = 0; i < json.items.size(); ++i) {
      std::uint32_t group = 0;
      group_.read(json.items[i], place.item(i), group);
      value |= 1u << group;
    }
  }
  Json write(const std::uint32_t& value) const override {
    if (value == ~0u) return Json::of("all");
    Json json = Json::array();
    for (std::uint32_t group = 0; group < 32; ++group)
      if ((value >> group & 1u) != 0) json.items.push_back(Json::whole(group));
    return json;
  }
  TypeInfo describe(Format& format) const override {
    Json all = Json::object(), numbers = Json::object(), schema = Json::object();
    all.set("const", Json::of("all"));
    numbers.set("type", Json::of("array"));
    numbers.set("items", group_.describe(format).schema);
    schema.set("oneOf", Json::array({numbers, all}));
    return {"list of whole numbers from 0 to 31, or \"all\"", schema};
  }

 private:
  Number<std::uint32_t> group_{within(0, 31)};
};

template <class T>
void add_collision_keys(Table<T>& keys) {
  const CodecPtr<std::uint32_t> groups = std::make_shared<Groups>();
  keys.template key<&T::collision, &CollisionFilter::groups>("collision_groups", groups,
                                                             "which of 32 groups it belongs to")
      .template key<&T::collision, &CollisionFilter::mask>(
          "collision_mask", groups,
          "which groups it meets; two things collide when each is in a group that the other meets");
}

// --- places and motions ------------------------------------------------------------------------------------

CodecPtr<TransformDescription> transform_codec() {
  using T = TransformDescription;
  auto keys = table<T>("transform", "Where a thing stands: scaled first, then rotated, then moved.");
  keys->key<&T::translate>("translate", vector3<double>(metres), "where its origin goes [m]")
      .key<&T::rotate>("rotate", vector3<double>(signed_range(1e5)),
                       "degrees about X, then Y, then Z (axes that stay)")
      .key<&T::scale>("scale", number<double>(positive(1e4)), "factor");
  return keys;
}

CodecPtr<TransformDescription> pose_codec() {
  using T = TransformDescription;
  auto keys = table<T>("pose", "Where a collider stands: rotated first, then moved.");
  keys->key<&T::translate>("translate", vector3<double>(metres), "where its origin goes [m]")
      .key<&T::rotate>("rotate", vector3<double>(signed_range(1e5)),
                       "degrees about X, then Y, then Z (axes that stay)");
  return keys;
}

CodecPtr<std::vector<KeyframeDescription>> keyframes_codec() {
  using K = KeyframeDescription;
  auto keys = table<K>("keyframe",
                       "A pose at a moment. Between two, translations go straight and rotations the "
                       "shorter way round at constant speed; before the first and after the last "
                       "nothing moves.");
  keys->required<&K::time>("time", number<double>(from_zero(1e6)), "when [s]; each later than the one before")
      .key<&K::translate>("translate", vector3<double>(metres), "[m]")
      .key<&K::rotate>("rotate", vector3<double>(signed_range(1e5)), "degrees about X, then Y, then Z");
  return list<K>(keys, 0, 100000);
}

void check_times(const std::vector<KeyframeDescription>& keyframes, const Place& place) {
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    if (keyframes[i].time > keyframes[i - 1].time) continue;
    const Place list_place = place.key("keyframes");
    const Place item = list_place.item(i);
    item.key("time").fail("must be later than the keyframe before, at " + number_text(keyframes[i - 1].time) +
                          " s; found " + number_text(keyframes[i].time));
  }
}

// --- meshes ------------------------------------------------------------------------------------------------

void check_count(double vertices, const Place& place) {
  if (vertices > most_vertices) {
    place.fail("would have " + number_text(vertices) + " vertices; at most " + number_text(most_vertices) +
               " are allowed");
  }
}

CodecPtr<GridMesh> grid_codec() {
  auto keys = table<GridMesh>("grid",
                              "A flat sheet in the XZ plane, square cells, centred at the origin, facing "
                              "up. Vertex index = row * columns + column.");
  keys->required<&GridMesh::columns>("columns", number<int>(within(2, 10000)), "vertices along X")
      .required<&GridMesh::rows>("rows", number<int>(within(2, 10000)), "vertices along Z")
      .required<&GridMesh::size>("size", number<double>(size_range), "width along X [m]")
      .key<&GridMesh::diagonals>(
          "diagonals",
          enumeration<Diagonals>({{"alternating", Diagonals::alternating}, {"one_way", Diagonals::one_way}}),
          "how the squares are cut; one_way prefers a direction and is there to compare with")
      .check([](const GridMesh& mesh, const Place& place) {
        check_count(static_cast<double>(mesh.columns) * mesh.rows, place);
      });
  return keys;
}

CodecPtr<DiskMesh> disk_codec() {
  auto keys = table<DiskMesh>("disk",
                              "A flat disk in the XZ plane, facing up; vertex 0 is the centre, the rest "
                              "follow ring by ring.");
  keys->required<&DiskMesh::rings>("rings", number<int>(within(1, 10000)), "circles about the centre")
      .required<&DiskMesh::segments>("segments", number<int>(within(3, 10000)), "vertices of a circle")
      .required<&DiskMesh::radius>("radius", number<double>(size_range), "[m]")
      .check([](const DiskMesh& mesh, const Place& place) {
        check_count(1 + static_cast<double>(mesh.rings) * mesh.segments, place);
      });
  return keys;
}

CodecPtr<SphereMesh> sphere_mesh_codec() {
  auto keys =
      table<SphereMesh>("sphere_mesh", "A closed sphere of 20 * 4^subdivisions nearly equal triangles.");
  keys->required<&SphereMesh::radius>("radius", number<double>(size_range), "[m]")
      .key<&SphereMesh::subdivisions>("subdivisions", number<int>(within(0, 8)),
                                      "how often an icosahedron's triangles are cut in four");
  return keys;
}

CodecPtr<BoxMesh> box_mesh_codec() {
  auto keys = table<BoxMesh>("box_mesh", "A closed box, centred at the origin.");
  keys->required<&BoxMesh::size>("size", vector3<double>(size_range), "side lengths [m]")
      .key<&BoxMesh::divisions>("divisions", counts(1000), "cells along the sides")
      .check([](const BoxMesh& mesh, const Place& place) {
        const auto [x, y, z] = std::array<double, 3>{static_cast<double>(mesh.divisions[0]),
                                                     static_cast<double>(mesh.divisions[1]),
                                                     static_cast<double>(mesh.divisions[2])};
        check_count(2 * (x * y + y * z + z * x) + 2, place);
      });
  return keys;
}

CodecPtr<TorusMesh> torus_codec() {
  auto keys = table<TorusMesh>("torus", "A closed ring about the Y axis.");
  keys->required<&TorusMesh::major_radius>("major_radius", number<double>(size_range),
                                           "from the axis to the middle of the tube [m]")
      .required<&TorusMesh::minor_radius>("minor_radius", number<double>(size_range), "of the tube [m]")
      .key<&TorusMesh::major_segments>("major_segments", number<int>(within(3, 2000)), "around the axis")
      .key<&TorusMesh::minor_segments>("minor_segments", number<int>(within(3, 2000)), "around the tube")
      .check([](const TorusMesh& mesh, const Place& place) {
        if (mesh.minor_radius >= mesh.major_radius) {
          place.key("minor_radius")
              .fail("must be smaller than major_radius, " + number_text(mesh.major_radius) + "; found " +
                    number_text(mesh.minor_radius));
        }
      });
  return keys;
}

CodecPtr<CapsuleMesh> capsule_mesh_codec() {
  auto keys = table<CapsuleMesh>("capsule_mesh", "A closed cylinder along Y between two half spheres.");
  keys->required<&CapsuleMesh::radius>("radius", number<double>(size_range), "[m]")
      .required<&CapsuleMesh::length>("length", number<double>(size_range),
                                      "of the cylinder, caps not counted [m]")
      .key<&CapsuleMesh::segments>("segments", number<int>(within(3, 1000)), "around the axis")
      .key<&CapsuleMesh::rings>("rings", number<int>(within(1, 1000)), "of each half sphere")
      .key<&CapsuleMesh::divisions>("divisions", number<int>(within(1, 1000)), "along the length");
  return keys;
}

CodecPtr<CylinderMesh> cylinder_mesh_codec() {
  auto keys = table<CylinderMesh>("cylinder_mesh", "A closed cylinder along Y.");
  keys->required<&CylinderMesh::radius>("radius", number<double>(size_range), "[m]")
      .required<&CylinderMesh::height>("height", number<double>(size_range), "[m]")
      .key<&CylinderMesh::segments>("segments", number<int>(within(3, 1000)), "around the axis")
      .key<&CylinderMesh::divisions>("divisions", number<int>(within(1, 1000)), "along the height")
      .key<&CylinderMesh::cap_rings>("cap_rings", number<int>(within(1, 1000)),
                                     "circles from the rim of a cap to its middle");
  return keys;
}

CodecPtr<TetBarMesh> tet_bar_codec() {
  auto keys = table<TetBarMesh>("tet_bar", "A solid box of cells cut into tets; soft bodies only.");
  keys->required<&TetBarMesh::cells>("cells", counts(1000), "cells along X, Y and Z")
      .required<&TetBarMesh::size>("size", vector3<double>(size_range), "side lengths [m]")
      .check([](const TetBarMesh& mesh, const Place& place) {
        check_count((mesh.cells[0] + 1.0) * (mesh.cells[1] + 1.0) * (mesh.cells[2] + 1.0), place);
      });
  return keys;
}

CodecPtr<TetBallMesh> tet_ball_codec() {
  auto keys = table<TetBallMesh>("tet_ball", "A solid ball of tets; soft bodies only.");
  keys->key<&TetBallMesh::subdivisions>(
          "subdivisions", number<int>(within(0, 6)),
          "of an icosahedron: 12, 42, 162, 642, 2562, 10242 or 40962 vertices on the surface")
      .key<&TetBallMesh::layers>("layers", number<int>(within(1, 20)),
                                 "shells between the middle and the surface")
      .required<&TetBallMesh::radius>("radius", number<double>(size_range), "[m]");
  return keys;
}

/// `where` says which shapes an object of this kind can be made of.
enum class MeshUse { surface, solid, points };

CodecPtr<MeshDescription> mesh_codec(MeshUse use) {
  using M = MeshDescription;
  const char* heading =
      use == MeshUse::surface ? "surface" : (use == MeshUse::solid ? "solid" : "point_file");
  const char* doc =
      use == MeshUse::surface ? "A surface: built, or read from a file."
      : use == MeshUse::solid
          ? "The shape of a soft body: a closed surface, which a lattice of tets will fill, or tets."
          : "Points read from a file: the vertices of a mesh.";
  using V = decltype(M::source);
  std::vector<Alternative> sources;
  if (use == MeshUse::surface) {
    sources.push_back(alternative<V>("grid", grid_codec(), "a flat sheet"));
    sources.push_back(alternative<V>("disk", disk_codec(), "a flat disk"));
  }
  if (use != MeshUse::points) {
    sources.push_back(alternative<V>("sphere", sphere_mesh_codec(), "a closed sphere"));
    sources.push_back(alternative<V>("box", box_mesh_codec(), "a closed box"));
    sources.push_back(alternative<V>("torus", torus_codec(), "a closed ring"));
    sources.push_back(alternative<V>("capsule", capsule_mesh_codec(), "a closed capsule"));
    sources.push_back(alternative<V>("cylinder", cylinder_mesh_codec(), "a closed cylinder"));
  }
  if (use == MeshUse::solid) {
    sources.push_back(alternative<V>("tet_bar", tet_bar_codec(), "a box of tets"));
    sources.push_back(alternative<V>("tet_ball", tet_ball_codec(), "a ball of tets"));
  }
  const char* formats =
      use == MeshUse::solid
          ? "OBJ, PLY or STL (or what assimp reads) for a surface; .msh, .node/.ele or .vtk for tets"
          : "OBJ, PLY or STL (or what assimp reads)";
  sources.push_back(alternative<V>("file", wrapped<FileMesh>(&FileMesh::file, file()), formats));
  auto keys = table<M>(heading, doc);
  keys->choice<&M::source>(std::move(sources))
      .key<&M::import, &MeshImport::scale>("scale", number<double>(positive(1e6)),
                                           "metres per unit of the file")
      .key<&M::import, &MeshImport::up>(
          "up", enumeration<UpAxis>({{"x", UpAxis::x}, {"y", UpAxis::y}, {"z", UpAxis::z}}),
          "the axis that points up in the file")
      .needs("scale", "file")
      .needs("up", "file");
  return keys;
}

// --- pins, maps --------------------------------------------------------------------------------------------

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
      alternative<V>("nearest", wrapped<S::Nearest>(&S::Nearest::point, vector3<float>(metres)),
                     "the one vertex nearest to this point at the start [m]"),
      alternative<V>("group", wrapped<S::Group>(&S::Group::name, text()),
                     "the vertices of this group of the mesh file"),
      alternative<V>("all", CodecPtr<S::All>(std::make_shared<True>()), "every vertex")};
}

template <class S>
std::shared_ptr<Table<S>> sequence_table(const char* heading) {
  auto keys = table<S>(heading,
                       "Positions of all the object's vertices over time, in the coordinates of its "
                       "mesh (its `scale`, `up` and `transform` apply). Linear between frames; still "
                       "before the first and after the last.");
  keys->template required<&S::file>("file", file_or_folder(),
                                    "a .pc2, a .mdd, or a sequence of OBJ: one file of it (NAME_0001.obj) or "
                                    "the folder that holds it and no other")
      .template key<&S::frame_rate>("frame_rate", number<double>(positive(1e4)),
                                    "frames a second; a .mdd holds its own times")
      .template key<&S::start_time>("start_time", number<double>(signed_range(1e6)),
                                    "when its first frame plays [s]");
  return keys;
}

CodecPtr<SequenceDescription> sequence_codec() {
  return sequence_table<SequenceDescription>("sequence");
}

CodecPtr<ObstacleSequenceDescription> obstacle_sequence_codec() {
  using S = ObstacleSequenceDescription;
  auto keys = sequence_table<S>("obstacle_sequence");
  keys->key<&S::loop>("loop", boolean(),
                      "starts over after the last frame, which is best the same as the first");
  return keys;
}

template <class T>
void add_pin_keys(Table<T>& keys) {
  keys.template choice<&PinDescription::where, &Selector::choice>(selectors());
  keys.template key<&PinDescription::keyframes>("keyframes", keyframes_codec(),
                                                "moves the vertices: `translate` is relative to where they "
                                                "start, `rotate` turns them about `about`")
      .template key<&PinDescription::loop>("loop", boolean(), "starts the keyframes over after the last")
      .template key<&PinDescription::about>(
          "about", maybe(vector3<double>(metres)),
          "centre of the rotations [m]; the middle of the vertices if not given")
      .template key<&PinDescription::sequence>("sequence", maybe(sequence_codec()),
                                               "moves the vertices along with positions from files")
      .needs("loop", "keyframes")
      .needs("about", "keyframes")
      .excludes("keyframes", "sequence")
      .check([](const T& pin, const Place& place) { check_times(pin.keyframes, place); });
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

template <class T>
void add_map_keys(Table<T>& keys, const char* value_doc, const char* fallback_doc) {
  using V = decltype(MapDescription::source);
  auto channel = enumeration<ColourChannel>(
      {{"red", ColourChannel::red}, {"green", ColourChannel::green}, {"blue", ColourChannel::blue}});
  keys.template choice<&MapDescription::source>(
      {alternative<V>("group", text(),
                      "vertices of this group of the mesh file have `value`, the others `default`"),
       alternative<V>("colour", channel,
                      "this channel of the vertices' colours blends from `default` (0) to `value` (1)")});
  keys.template key<&MapDescription::value>("value", number<float>(from_zero(1e4)), value_doc)
      .template key<&MapDescription::fallback>("default", number<float>(from_zero(1e4)), fallback_doc);
}

CodecPtr<PinMapDescription> pin_map_codec() {
  auto keys = table<PinMapDescription>("pin_map",
                                       "How strongly each vertex is held where it starts: weight 1 is a "
                                       "pin, 0 is free, w between them a spring of compliance "
                                       "(1 - w) / w times `compliance`.");
  add_map_keys(*keys, "weight in the group, or at colour 1; at most 1", "weight elsewhere, or at colour 0");
  keys->key<&PinMapDescription::compliance>("compliance", number<float>(positive(1e6)),
                                            "of a vertex of weight 0.5 [m/N]")
      .check([](const PinMapDescription& map, const Place& place) {
        if (map.value > 1) place.key("value").fail("expected a weight from 0 to 1");
        if (map.fallback > 1) place.key("default").fail("expected a weight from 0 to 1");
      });
  return keys;
}

CodecPtr<MapDescription> scale_map_codec() {
  auto keys = table<MapDescription>("map", "A factor for each vertex.");
  keys->start([](const Json&, const Place&, void* map) { static_cast<MapDescription*>(map)->fallback = 1; },
              [](const MapDescription&, MapDescription& fallback) { fallback.fallback = 1; });
  add_map_keys(*keys, "factor in the group, or at colour 1", "factor elsewhere, or at colour 0");
  return keys;
}

CodecPtr<MapsDescription> maps_codec() {
  using M = MapsDescription;
  auto keys = table<M>("maps",
                       "Numbers that differ from vertex to vertex, from the groups or the colours of the "
                       "mesh file.");
  keys->key<&M::pin_weight>("pin_weight", maybe(pin_map_codec()), "how strongly vertices are held")
      .key<&M::stiffness>("stiffness", maybe(scale_map_codec()), "scales the material's stiffness")
      .key<&M::thickness>("thickness", maybe(scale_map_codec()), "scales the material's thickness");
  return keys;
}

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

// --- materials ---------------------------------------------------------------------------------------------

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
      [preset_codec, find](const Json& json, const Place& place, void* object) {
        M& value = *static_cast<M*>(object);
        const Json* preset = json.find("preset");
        if (preset == nullptr) return;
        preset_codec->read(*preset, place.key("preset"), value.preset);
        static_cast<Material&>(value) = *find(value.preset);
      },
      [find](const M& value, M& fallback) {
        if (const Material* preset = find(value.preset)) static_cast<Material&>(fallback) = *preset;
      });
  keys->template key<&M::preset>("preset", preset_codec,
                                 "starts from this material; the other keys change it");
  return keys;
}

const Range unit = within(0, 1);
const Range friction_range = from_zero(100);

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
      .key<&M::thickness>("thickness", number<float>(positive(10)), "from side to side [m]")
      .key<&M::friction>("friction", number<float>(friction_range), "Coulomb coefficient")
      .key<&M::restitution>("restitution", number<float>(unit), "how much of the speed a bounce gives back")
      .key<&M::damping_time>("damping_time", number<float>(from_zero(1000)),
                             "Kelvin-Voigt: stress = E (strain + damping_time * strain rate) [s]")
      .key<&M::damping>("damping", number<float>(from_zero(1e4)),
                        "of motion other than that of a rigid body [1/s]")
      .key<&M::air_drag>("air_drag", number<float>(from_zero(100)),
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
      .check([](const MaterialDescription<M>& m, const Place& place) {
        if (m.membrane_stiffness == rigid && m.stretch != StretchModel::springs)
          place.key("membrane_stiffness").fail("is \"rigid\": only springs can be (stretch \"springs\")");
        if (m.bending_stiffness == rigid && m.bending != BendingModel::distance)
          place.key("bending_stiffness").fail("is \"rigid\": only springs can be (bending \"distance\")");
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
                          "contacts keep half of it as distance [m]")
      .key<&M::friction>("friction", number<float>(friction_range), "Coulomb coefficient")
      .key<&M::restitution>("restitution", number<float>(unit), "how much of the speed a bounce gives back")
      .key<&M::damping_time>("damping_time", number<float>(from_zero(1000)),
                             "Kelvin-Voigt: stress = E (strain + damping_time * strain rate) [s]")
      .key<&M::damping>("damping", number<float>(from_zero(1e4)),
                        "of motion other than that of a rigid body [1/s]")
      .key<&M::model>("model",
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
                                  "E I [N m^2]; 0: limp. A solid rod has E pi r^4 / 4, a laid rope far less")
      .key<&M::friction>("friction", number<float>(friction_range), "Coulomb coefficient")
      .key<&M::restitution>("restitution", number<float>(unit), "how much of the speed a bounce gives back")
      .key<&M::damping_time>("damping_time", number<float>(from_zero(1000)), "Kelvin-Voigt [s]")
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
      .key<&M::density>("density", number<float>(positive(1e6)), "of one grain [kg/m^3]")
      .key<&M::friction>("friction", number<float>(friction_range), "Coulomb coefficient")
      .key<&M::restitution>("restitution", number<float>(unit), "how much of the speed a bounce gives back")
      .key<&M::damping>("damping", number<float>(from_zero(1e4)), "of motion relative to the whole [1/s]");
  return keys;
}

CodecPtr<ObstacleMaterial> obstacle_material_codec() {
  using M = ObstacleMaterial;
  auto keys = table<M>("obstacle_material", "How the surface of an obstacle is felt.");
  keys->key<&M::thickness>("thickness", number<float>(positive(10)),
                           "contacts keep half of it as distance [m]")
      .key<&M::friction>("friction", number<float>(friction_range), "Coulomb coefficient")
      .key<&M::restitution>("restitution", number<float>(unit), "how much of the speed a bounce gives back");
  return keys;
}

// --- objects -----------------------------------------------------------------------------------------------

/// The key that tells objects apart; already read when its table is.
class KindWord : public Codec<std::string> {
 public:
  explicit KindWord(std::string kind) : kind_(std::move(kind)) {}
  void read(const Json&, const Place&, std::string&) const override {}
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
                                          "at the start, about the centre of mass [rad/s]")
      .template key<&T::colour>("colour", maybe(colour()),
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
  keys->key<&LatticeOptions::cells>("cells", number<std::size_t>(within(1, most_vertices)),
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
  keys->required<&T::points>("points", list(vector3<double>(metres), 2), "the corners of its course [m]")
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
  keys->required<&G::lo>("lo", vector3<double>(metres), "lower corner [m]")
      .required<&G::hi>("hi", vector3<double>(metres), "upper corner [m]")
      .key<&G::spacing>("spacing", maybe(number<double>(positive(1000))),
                        "between centres [m]; if not given, two radii and what the jitter needs")
      .key<&G::jitter>("jitter", number<double>(unit),
                       "each centre is moved at random by up to this fraction of a radius along each axis")
      .check([](const G& box, const Place& place) {
        for (int i = 0; i < 3; ++i) {
          if (!(box.lo[i] < box.hi[i])) place.fail("\"lo\" must be below \"hi\" along every axis");
        }
      });
  return keys;
}

CodecPtr<GrainsGrid> grains_grid_codec() {
  using G = GrainsGrid;
  auto keys = table<G>("grains_grid", "A cubic lattice of grains, centred at the origin.");
  keys->required<&G::counts>("counts", counts(10000), "grains along X, Y and Z")
      .key<&G::spacing>("spacing", maybe(number<double>(positive(1000))),
                        "between centres [m]; if not given, two radii and what the jitter needs")
      .key<&G::jitter>("jitter", number<double>(unit),
                       "each centre is moved at random by up to this fraction of a radius along each axis")
      .check([](const G& grid, const Place& place) {
        check_count(static_cast<double>(grid.counts[0]) * grid.counts[1] * grid.counts[2], place);
      });
  return keys;
}

std::shared_ptr<Table<GrainsDescription>> grains_table() {
  using T = GrainsDescription;
  auto keys = object_table<T>("grains", "Loose balls: sand, gravel, beads.");
  using V = decltype(T::centres);
  keys->choice<&T::centres>({alternative<V>("points", list(vector3<double>(metres), 1), "centres [m]"),
                             alternative<V>("box", grains_box_codec(), "fills a box"),
                             alternative<V>("grid", grains_grid_codec(), "a given number along each axis"),
                             alternative<V>("mesh", mesh_codec(MeshUse::points), "centres from a file")});
  keys->key<&T::material>("material", grains_material_codec(), "what they are made of");
  add_object_keys(*keys);
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
      .key<&T::colour>("colour", maybe(colour()),
                       "how pictures show it, as in HTML; if not given: light grey")
      .key<&T::keyframes>("keyframes", keyframes_codec(),
                          "moves it, as `transform` has placed it: turned about the origin first, then moved")
      .key<&T::loop>("loop", boolean(), "starts the keyframes over after the last")
      .key<&T::sequence>("sequence", maybe(obstacle_sequence_codec()), "deforms it")
      .needs("loop", "keyframes")
      .check([](const T& obstacle, const Place& place) { check_times(obstacle.keyframes, place); });
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

CodecPtr<AnyObjectDescription> object_codec() {
  const auto cloth = cloth_table();
  const auto soft_body = soft_body_table();
  const auto rope = rope_table();
  const auto grains = grains_table();
  const auto obstacle = obstacle_table();
  const auto strangers_to = [&](const auto& mine) {
    std::vector<std::pair<std::string, std::string>> foreign;
    add_foreign(*cloth, "a cloth", mine, foreign);
    add_foreign(*soft_body, "a soft_body", mine, foreign);
    add_foreign(*rope, "a rope", mine, foreign);
    add_foreign(*grains, "grains", mine, foreign);
    add_foreign(*obstacle, "an obstacle", mine, foreign);
    return foreign;
  };
  cloth->foreign(strangers_to(*cloth));
  soft_body->foreign(strangers_to(*soft_body));
  rope->foreign(strangers_to(*rope));
  grains->foreign(strangers_to(*grains));
  obstacle->foreign(strangers_to(*obstacle));
  using V = AnyObjectDescription;
  return std::make_shared<Kinds<V>>(
      std::vector<Alternative>{alternative<V, ClothDescription>("cloth", cloth, ""),
                               alternative<V, SoftBodyDescription>("soft_body", soft_body, ""),
                               alternative<V, RopeDescription>("rope", rope, ""),
                               alternative<V, GrainsDescription>("grains", grains, ""),
                               alternative<V, ObstacleDescription>("obstacle", obstacle, "")});
}

// --- colliders ---------------------------------------------------------------------------------------------

CodecPtr<SignedDistanceFieldDescription> signed_distance_field_codec() {
  using F = SignedDistanceFieldDescription;
  auto keys = table<F>("signed_distance_field",
                       "The solid inside a closed surface, as a grid of distances: large things of many "
                       "triangles that only move as a whole.");
  keys->required<&F::mesh>("mesh", mesh_codec(MeshUse::surface),
                           "its surface, closed, in the collider's own frame")
      .key<&F::spacing>("spacing", maybe(number<double>(size_range)),
                        "of the grid's points [m]; walls and gaps thinner than two of it are lost")
      .key<&F::resolution>("resolution", number<int>(within(4, 4096)),
                           "cells along the surface's longest side, instead of `spacing`")
      .excludes("spacing", "resolution");
  return keys;
}

CodecPtr<ShapeDescription> shape_codec() {
  using S = ShapeDescription;
  const CodecPtr<Vec3f> centre = vector3<float>(metres);
  const CodecPtr<float> size = number<float>(size_range);
  const char* centre_doc = "in the collider's own frame [m]";
  auto plane = table<Plane>("plane", "The half space normal . x <= offset is solid.");
  plane->key<&Plane::normal>("normal", vector3<float>(metres), "points out of the solid; any length but zero")
      .key<&Plane::offset>("offset", number<float>(metres), "[m], times the length of the normal")
      .check([](const Plane& shape, const Place& place) {
        if (!(length_squared(Vec3d(shape.normal)) > 1e-12)) place.key("normal").fail("must not be zero");
      });
  auto sphere = table<Sphere>("sphere", "A ball.");
  sphere->required<&Sphere::radius>("radius", size, "[m]").key<&Sphere::center>("center", centre, centre_doc);
  auto box = table<Box>("box", "A box.");
  box->required<&Box::half_extents>("half_extents", vector3<float>(size_range), "half the side lengths [m]")
      .key<&Box::center>("center", centre, centre_doc);
  auto capsule = table<Capsule>("capsule", "Everything within `radius` of a segment along Y.");
  capsule->required<&Capsule::radius>("radius", size, "[m]")
      .required<&Capsule::half_height>("half_height", number<float>(from_zero(far_away)),
                                       "half the length of the segment, caps not counted [m]")
      .key<&Capsule::center>("center", centre, centre_doc);
  auto cylinder = table<Cylinder>("cylinder", "A cylinder along Y with flat ends.");
  cylinder->required<&Cylinder::radius>("radius", size, "[m]")
      .required<&Cylinder::half_height>("half_height", size, "half the height [m]")
      .key<&Cylinder::center>("center", centre, centre_doc);
  auto keys = table<S>("shape", "The solid of a collider.");
  keys->choice<>({alternative<S, Plane>("plane", plane, "a half space"),
                  alternative<S, Sphere>("sphere", sphere, "a ball"),
                  alternative<S, Box>("box", box, "a box"),
                  alternative<S, Capsule>("capsule", capsule, "a capsule along Y"),
                  alternative<S, Cylinder>("cylinder", cylinder, "a cylinder along Y"),
                  alternative<S>("signed_distance_field", signed_distance_field_codec(),
                                 "the inside of a closed mesh")});
  return keys;
}

CodecPtr<ColliderDescription> collider_codec() {
  using C = ColliderDescription;
  auto keys = table<C>("collider", "A solid that objects touch and that nothing moves but its keyframes.");
  keys->key<&C::name>("name", name(), "unique; if not given: collider, collider2, ...")
      .required<&C::shape>("shape", shape_codec(), "what it is")
      .key<&C::friction>("friction", number<float>(friction_range),
                         "Coulomb coefficient; a contact has the geometric mean of both sides")
      .key<&C::restitution>(
          "restitution", number<float>(unit),
          "how much of the speed a bounce gives back; a contact has the larger of both sides")
      .key<&C::colour>("colour", maybe(colour()),
                       "how pictures show it, as in HTML; if not given: light grey")
      .key<&C::transform>("transform", pose_codec(), "where it stands")
      .key<&C::keyframes>("keyframes", keyframes_codec(), "where it goes, instead of `transform`")
      .key<&C::loop>("loop", boolean(), "starts the keyframes over after the last")
      .needs("loop", "keyframes")
      .excludes("transform", "keyframes")
      .check([](const C& collider, const Place& place) { check_times(collider.keyframes, place); });
  add_collision_keys(*keys);
  return keys;
}

CodecPtr<PairDescription> pair_codec() {
  using P = PairDescription;
  auto keys = table<P>("pair",
                       "How two things rub and bounce, whatever their materials say, and whether they "
                       "collide at all, whatever their groups say. One name twice: an object with itself.");
  keys->required<&P::between>("between", CodecPtr<std::array<std::string, 2>>(std::make_shared<TwoNames>()),
                              "names of objects or colliders")
      .key<&P::collide>("collide", boolean(), "false: they pass through each other")
      .key<&P::friction>("friction", maybe(number<float>(friction_range)), "Coulomb coefficient")
      .key<&P::restitution>("restitution", number<float>(unit), "how much of the speed a bounce gives back")
      .needs("restitution", "friction")
      .check([](const P& pair, const Place& place) {
        if (pair.collide && !pair.friction) place.fail("needs \"friction\", or \"collide\": false");
      });
  return keys;
}

CodecPtr<ConnectionDescription> connection_codec() {
  using C = ConnectionDescription;
  auto end = table<EndDescription>("end", "Vertices of an object.");
  end->required<&EndDescription::object>("object", name(), "its name");
  end->choice<&EndDescription::where, &Selector::choice>(selectors());
  auto keys = table<C>("connection", "Ties vertices of one object to vertices of another, pair by pair.");
  keys->required<&C::from>("from", CodecPtr<EndDescription>(end), "vertices of one object")
      .required<&C::to>("to", CodecPtr<EndDescription>(end), "vertices of the other")
      .key<&C::pairing>(
          "pairing", enumeration<Pairing>({{"in_order", Pairing::in_order}, {"nearest", Pairing::nearest}}),
          "in_order: first to first, second to second (one vertex is tied to all of the other side); "
          "nearest: "
          "each of `from` to the nearest of `to`")
      .key<&C::rest_length>("rest_length", maybe(number<float>(from_zero(far_away))),
                            "[m]; if not given, the distance at the start; 0 glues them")
      .key<&C::compliance>("compliance", number<float>(from_zero(1e6)), "[m/N]; 0 is rigid");
  return keys;
}

CodecPtr<CameraDescription> camera_codec() {
  using C = CameraDescription;
  auto keys = table<C>("camera", "From where the scene is best seen; used by viewers.");
  keys->key<&C::from>("from", vector3<double>(metres), "where it stands [m]")
      .key<&C::to>("to", vector3<double>(metres), "what it looks at [m]")
      .key<&C::fov>("fov", number<double>(within(1, 170)), "vertical angle of view [degrees]")
      .check([](const C& camera, const Place& place) {
        if (camera.from == camera.to) place.fail("\"from\" and \"to\" are the same point");
      });
  return keys;
}

CodecPtr<Wind> wind_codec() {
  auto keys = table<Wind>("wind", "Moving air.");
  keys->key<&Wind::velocity>("velocity", vector3<float>(signed_range(1000)), "[m/s]")
      .key<&Wind::gust>("gust", number<float>(unit), "its strength varies by this fraction")
      .key<&Wind::gust_period>("gust_period", number<float>(positive(1e4)), "of the slowest of the gusts [s]")
      .key<&Wind::air_density>("air_density", number<float>(from_zero(1e4)), "[kg/m^3]");
  return keys;
}

CodecPtr<Sleeping> sleeping_codec() {
  auto keys = table<Sleeping>("sleeping",
                              "Objects at rest fall asleep, those in touch together, and wake when something "
                              "moves them or near them.");
  keys->key<&Sleeping::enabled>("enabled", boolean(), "whether they do")
      .key<&Sleeping::speed>("speed", number<float>(from_zero(1000)),
                             "of an object at rest no particle moves faster, from frame to frame [m/s]")
      .key<&Sleeping::seconds>("seconds", number<float>(positive(1e6)), "of rest before it falls asleep [s]");
  return keys;
}

// --- the whole ---------------------------------------------------------------------------------------------

/// Gives a name to what has none, by the rule of the world; fails on names used twice.
template <class Items, class NameOf, class Base>
void complete_names(Items& items, const char* list_key, const Place& place, NameOf name_of, Base base,
                    std::set<std::string>& taken) {
  const Place list_place = place.key(list_key);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string& given = name_of(items[i]);
    if (given.empty() || taken.insert(given).second) continue;
    const Place item = list_place.item(i);
    item.key("name").fail("the name \"" + given + "\" is taken; names are unique");
  }
  for (auto& item : items) {
    if (!name_of(item).empty()) continue;
    std::string name = base(item);
    for (int number = 2; !taken.insert(name).second; ++number) name = base(item) + std::to_string(number);
    name_of(item) = name;
  }
}

void check_name(const std::string& name, const std::vector<std::string>& known, const Place& place,
                const char* noun) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  place.fail("there is no " + std::string(noun) + " called \"" + name + "\"" + suggestion(name, known));
}

void complete_and_check(SceneDescription& scene, const Place& place) {
  std::set<std::string> taken;
  complete_names(
      scene.objects, "objects", place,
      [](AnyObjectDescription& object) -> std::string& { return common(object).name; },
      [](const AnyObjectDescription& object) { return std::string(kind_name(kind_of(object))); }, taken);
  complete_names(
      scene.colliders, "colliders", place,
      [](ColliderDescription& collider) -> std::string& { return collider.name; },
      [](const ColliderDescription&) { return std::string("collider"); }, taken);

  std::vector<std::string> objects;
  for (const AnyObjectDescription& object : scene.objects) objects.push_back(common(object).name);
  std::vector<std::string> all = objects;
  for (const ColliderDescription& collider : scene.colliders) all.push_back(collider.name);

  const Place pairs = place.key("pairs");
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    const Place pair = pairs.item(i), between = pair.key("between");
    for (std::size_t side = 0; side < 2; ++side) {
      check_name(scene.pairs[i].between[side], all, between.item(side), "object or collider");
    }
  }
  const Place connections = place.key("connections");
  for (std::size_t i = 0; i < scene.connections.size(); ++i) {
    const Place connection = connections.item(i), from = connection.key("from"), to = connection.key("to");
    check_name(scene.connections[i].from.object, objects, from.key("object"), "object");
    check_name(scene.connections[i].to.object, objects, to.key("object"), "object");
  }
}

/// The key "souple": the version of the format.
class FormatVersion : public Codec<std::string> {
 public:
  void read(const Json& json, const Place& place, std::string&) const override {
    if (!json.is(Json::Kind::number) || json.number != 1) {
      place.unexpected("1, the only version of the scene format this Souple knows", json);
    }
  }
  Json write(const std::string&) const override { return Json::whole(1); }
  TypeInfo describe(Format&) const override {
    Json schema = Json::object();
    schema.set("const", Json::whole(1));
    return {"1", schema};
  }
};

/// Names are completed after everything has been read.
class SceneTable : public Table<SceneDescription> {
 public:
  using Table::Table;
  void read(const Json& json, const Place& place, SceneDescription& value) const override {
    Table::read(json, place, value);
    complete_and_check(value, place);
  }
};

}  // namespace

CodecPtr<SceneDescription> scene_codec() {
  using S = SceneDescription;
  auto keys = std::make_shared<SceneTable>("scene",
                                           "The whole file. Metres, kilograms, seconds; Y is up, axes are "
                                           "right-handed.");
  keys->required<&S::source>("souple", CodecPtr<std::string>(std::make_shared<FormatVersion>()),
                             "version of the format")
      .key<&S::description>("description", text(), "one line that says what is to be seen")
      .key<&S::frame_rate>("frame_rate", number<double>(positive(1e5)), "frames a second")
      .key<&S::frames>("frames", number<std::uint32_t>(within(1, 1e7)), "how many to simulate")
      .key<&S::settings, &Settings::substeps>("substeps", number<int>(within(1, 10000)),
                                              "parts a frame is cut into")
      .key<&S::settings, &Settings::iterations>("iterations", number<int>(within(1, 10000)),
                                                "of the solver in each substep")
      .key<&S::settings, &Settings::mode>(
          "mode",
          enumeration<Mode>({{"small_steps", Mode::small_steps}, {"xpbd", Mode::xpbd}, {"pbd", Mode::pbd}}),
          "how constraints are enforced: compliance and many substeps, compliance with stored multipliers, "
          "or "
          "the stiffness in [0, 1] of classic PBD")
      .key<&S::settings, &Settings::form>(
          "form", enumeration<Form>({{"displacement", Form::displacement}, {"plain", Form::plain}}),
          "what the solver moves; plain loses digits and is there to compare with")
      .key<&S::settings, &Settings::integrator>(
          "integrator",
          enumeration<Integrator>({{"semi_implicit", Integrator::semi_implicit},
                                   {"explicit_euler", Integrator::explicit_euler},
                                   {"implicit_euler", Integrator::implicit_euler}}),
          "how forces become velocities and positions")
      .key<&S::settings, &Settings::gravity>("gravity", vector3<float>(signed_range(1e4)), "[m/s^2]")
      .key<&S::settings, &Settings::drag>("drag", number<float>(from_zero(1e4)),
                                          "slows everything relative to the wind [1/s]")
      .key<&S::settings, &Settings::seed>("seed", number<std::uint64_t>(from_zero(9007199254740991.0)),
                                          "of the gusts and of the jitter of grains")
      .key<&S::settings, &Settings::measure_residuals>(
          "measure_residuals", boolean(),
          "reports residuals and strain each frame: costs about one iteration")
      .key<&S::settings, &Settings::solver, &SolverSettings::kind>(
          "solver", enumeration<SolverKind>({std::begin(solver_names), std::end(solver_names)}),
          "how the constraints of a substep are solved")
      .key<&S::settings, &Settings::solver, &SolverSettings::sweep>(
          "sweep", enumeration<Sweep>({std::begin(sweep_names), std::end(sweep_names)}),
          "in which order colours are solved: the same every time, or forward and backward")
      .key<&S::settings, &Settings::solver, &SolverSettings::relaxation>(
          "relaxation", number<float>(Range{0, 2, true, true}),
          "factor on every correction: over-relaxation above 1")
      .key<&S::settings, &Settings::solver, &SolverSettings::chebyshev>(
          "chebyshev", number<float>(below(1)),
          "acceleration of the iterations: the spectral radius it assumes; 0: none")
      .key<&S::settings, &Settings::solver, &SolverSettings::colours>(
          "colours", number<int>(within(0, 64)),
          "to which phantom particles cut the constraint graph; 0: as many as it takes without")
      .key<&S::settings, &Settings::segment_test>(
          "segment_test",
          enumeration<SegmentTest>({std::begin(segment_test_names), std::end(segment_test_names)}),
          "how rays that pick are tested against triangles")
      .key<&S::settings, &Settings::sleeping>("sleeping", sleeping_codec(), "what lies still costs little")
      .key<&S::camera>("camera", camera_codec(), "from where the scene is best seen")
      .key<&S::settings, &Settings::wind>("wind", wind_codec(), "moving air")
      .key<&S::objects>("objects", list(object_codec(), 0, 10000), "what moves")
      .key<&S::colliders>("colliders", list(collider_codec(), 0, 10000), "what it touches")
      .key<&S::pairs>("pairs", list(pair_codec(), 0, 100000),
                      "friction and restitution of two things by name, or that they do not collide")
      .key<&S::connections>("connections", list(connection_codec(), 0, 10000), "ties between objects");
  return keys;
}

}  // namespace souple::scene_format
