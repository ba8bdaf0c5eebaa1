#include "souple/scene/keys.h"

#include "souple/scene/keys/parts.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/core.h>

namespace souple::scene_format {

namespace {

CodecPtr<CameraDescription> camera_codec() {
  using C = CameraDescription;
  auto keys = table<C>("camera", "A good viewpoint for the scene; viewers start there.");
  keys->key<&C::from>("from", vector3<double>(meters), "position of the camera [m]")
      .key<&C::to>("to", vector3<double>(meters), "point that the camera looks at [m]")
      .key<&C::fov>("fov", number<double>(within(1, 170)), "vertical field of view [degrees]")
      .check([](const C& camera, const JsonPath& path) {
        if (camera.from == camera.to) path.fail("\"from\" and \"to\" are the same point");
      });
  return keys;
}

CodecPtr<SkyDescription> sky_codec() {
  using S = SkyDescription;
  auto keys =
      table<S>("sky",
               "Light from all around in pictures, from a panorama instead of the procedural sky. The middle "
               "of the panorama is in the direction of -Z.");
  keys->required<&S::file>("file", file(),
                           "picture in the Radiance format (.hdr), of all directions; 1 is white")
      .key<&S::rotation>("rotation", number<double>(within(-360, 360)),
                         "turn about the vertical, counterclockwise seen from above [degrees]")
      .key<&S::strength>("strength", number<double>(from_zero(1000)), "factor of its light")
      .key<&S::sun>("sun", number<double>(from_zero(100)),
                    "irradiance of the sun, which casts the sharp shadows; without a panorama it is 4")
      .key<&S::background>("background", boolean(),
                           "whether it is visible behind the scene; otherwise the procedural sky is");
  return keys;
}

/// Gives default names to unnamed items, by the world's rule; fails on duplicate names.
template <class Items, class NameOf, class Base>
void complete_names(Items& items, const char* list_key, const JsonPath& path, NameOf name_of, Base base,
                    std::set<std::string>& used) {
  const JsonPath list_path = path.key(list_key);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string& given = name_of(items[i]);
    if (given.empty() || used.insert(given).second) continue;
    const JsonPath item = list_path.item(i);
    item.key("name").fail("the name \"" + given + "\" is used twice; names must be unique");
  }
  std::map<std::string, int> next;  // number of a base: lower ones are taken
  for (auto& item : items) {
    if (!name_of(item).empty()) continue;
    std::string name = base(item);
    int& number = next.try_emplace(name, 2).first->second;
    while (!used.insert(name).second) name = fmt::format("{}{}", base(item), number++);
    name_of(item) = name;
  }
}

void check_name(const std::string& name, const std::vector<std::string>& known, const JsonPath& path,
                const char* noun) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  path.fail("there is no " + std::string(noun) + " called \"" + name + "\"" + suggestion(name, known));
}

/// `to` is a rigid body, `from` another one, a collider, or the world.
void check_joints(const SceneDescription& scene, const std::vector<std::string>& bodies,
                  const JsonPath& path) {
  std::vector<std::string> sides = bodies;
  for (const ColliderDescription& collider : scene.colliders) sides.push_back(collider.name);
  for (std::size_t i = 0; i < scene.joints.size(); ++i) {
    const JointDescription& joint = common(scene.joints[i]);
    const JsonPath item = path.item(i);
    check_name(joint.to, bodies, item.key("to"), "rigid body");
    if (!joint.from.empty()) check_name(joint.from, sides, item.key("from"), "rigid body or collider");
    if (joint.from == joint.to) item.fail("\"from\" and \"to\" are the same body");
  }
}

/// `to` is an object, `from` an object, a collider, or the world; a stitch needs two objects.
void check_ties(const SceneDescription& scene, const std::vector<std::string>& objects,
                const std::vector<std::string>& all, const JsonPath& path) {
  for (std::size_t i = 0; i < scene.ties.size(); ++i) {
    const TieDescription& tie = scene.ties[i];
    const JsonPath item = path.item(i);
    check_name(tie.to, objects, item.key("to"), "object");
    if (tie.stitch)
      check_name(tie.from, objects, item.key("from"), "object");
    else if (!tie.from.empty())
      check_name(tie.from, all, item.key("from"), "object or collider");
  }
}

void complete_and_check(SceneDescription& scene, const JsonPath& path) {
  std::set<std::string> used;
  complete_names(
      scene.objects, "objects", path,
      [](AnyObjectDescription& object) -> std::string& { return common(object).name; },
      [](const AnyObjectDescription& object) { return std::string(kind_name(kind_of(object))); }, used);
  complete_names(
      scene.colliders, "colliders", path,
      [](ColliderDescription& collider) -> std::string& { return collider.name; },
      [](const ColliderDescription&) { return std::string("collider"); }, used);

  std::set<std::string> used_by_joints;
  complete_names(
      scene.joints, "joints", path,
      [](AnyJointDescription& joint) -> std::string& { return common(joint).name; },
      [](const AnyJointDescription& joint) { return std::string(kind_name(joint)); }, used_by_joints);

  std::vector<std::string> objects, bodies;
  for (const AnyObjectDescription& object : scene.objects) {
    objects.push_back(common(object).name);
    if (kind_of(object) == ObjectKind::rigid_body) bodies.push_back(common(object).name);
  }
  std::vector<std::string> all = objects;
  for (const ColliderDescription& collider : scene.colliders) all.push_back(collider.name);

  const JsonPath pairs = path.key("pairs");
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    const JsonPath pair = pairs.item(i), between = pair.key("between");
    for (std::size_t side = 0; side < 2; ++side) {
      check_name(scene.pairs[i].between[side], all, between.item(side), "object or collider");
    }
  }
  const JsonPath connections = path.key("connections");
  for (std::size_t i = 0; i < scene.connections.size(); ++i) {
    const JsonPath connection = connections.item(i), from = connection.key("from"), to = connection.key("to");
    check_name(scene.connections[i].from.object, objects, from.key("object"), "object");
    check_name(scene.connections[i].to.object, objects, to.key("object"), "object");
  }
  check_joints(scene, bodies, path.key("joints"));
  check_ties(scene, objects, all, path.key("ties"));
}

/// Completes names after all keys have been read.
class SceneTable : public Table<SceneDescription> {
 public:
  using Table::Table;
  void read(const Json& json, const JsonPath& path, SceneDescription& value) const override {
    Table::read(json, path, value);
    complete_and_check(value, path);
  }
};

}  // namespace

CodecPtr<SceneDescription> scene_codec() {
  using S = SceneDescription;
  auto keys = std::make_shared<SceneTable>(
      "scene", "The whole file. Units are meters, kilograms and seconds; Y is up, axes are right-handed.");
  keys->required<&S::source>(
          "souple",
          constant<std::string>(Json::whole(1),
                                "1, the only version of the scene format that this Souple reads"),
          "version of the format")
      .key<&S::description>("description", text(), "one line that describes the scene")
      .key<&S::frame_rate>("frame_rate", number<double>(positive(1e5)), "frames per second")
      .key<&S::frames>("frames", number<std::uint32_t>(within(1, 1e7)), "number of frames to simulate");
  add_setting_keys(*keys);
  keys->key<&S::camera>("camera", camera_codec(), "a good viewpoint for the scene")
      .key<&S::sky>("sky", maybe(sky_codec()), "light from a panorama, in pictures")
      .key<&S::settings, &Settings::wind>("wind", wind_codec(), "air, still or moving")
      .key<&S::objects>("objects", list(object_codec(), 0, 10000),
                        "cloth, soft bodies, ropes, grains, fluids, obstacles and rigid bodies")
      .key<&S::colliders>("colliders", list(collider_codec(), 0, 10000), "solids that objects collide with")
      .key<&S::pairs>(
          "pairs", list(pair_codec(), 0, 100000),
          "friction and restitution between two named objects or colliders, or that they do not collide")
      .key<&S::connections>("connections", list(connection_codec(), 0, 10000),
                            "distance joints between vertices")
      .key<&S::joints>("joints", list(joint_codec(), 0, 10000),
                       "joints of rigid bodies: hinges, sliders, ropes over pulleys")
      .key<&S::ties>("ties", list(tie_codec(), 0, 10000),
                     "ties of points of any two objects: glue, seams, beads")
      .key<&S::drains>("drains", list(drain_codec(), 0, 10000), "regions that remove fluid");
  return keys;
}

}  // namespace souple::scene_format
