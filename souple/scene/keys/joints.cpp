#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

constexpr Range compliance_range = from_zero(1e9);
constexpr Range damping_range = from_zero(1e12);
constexpr Range force_range = positive(1e15);

/// Whether a degree of freedom is a rotation, which is told in degrees.
enum class Motion { translation, rotation };

/// Angles and lengths have equal keys, but their own words and ranges.
struct Words {
  Range range;
  const char* position;    // "[m]"
  const char* velocity;    // "[m/s]"
  const char* compliance;  // "[m/N]"
  const char* damping;
  const char* force;
};
Words words_of(Motion motion) {
  if (motion == Motion::translation) return {meters, "[m]", "[m/s]", "[m/N]", "[N s/m]", "[N]"};
  return {signed_range(1e6), "[degrees]", "[rad/s]", "[rad/(N m)]", "[N m s/rad]", "[N m]"};
}

std::string with_unit(const char* words, const char* unit) {
  return std::string(words) + " " + unit;
}

CodecPtr<JointLimitsDescription> limits_codec(Motion motion) {
  using L = JointLimitsDescription;
  const Words words = words_of(motion);
  auto keys = table<L>(motion == Motion::rotation ? "angle_limits" : "length_limits",
                       "Stops of a joint. Its angle, or its shift, is 0 at the start.");
  keys->key<&L::low>("low", maybe(number<double>(words.range)),
                     with_unit("lower end; if not given, none", words.position).c_str())
      .key<&L::high>("high", maybe(number<double>(words.range)),
                     with_unit("upper end; if not given, none", words.position).c_str())
      .key<&L::compliance>("compliance", number<double>(compliance_range),
                           with_unit("of both ends; 0 is rigid", words.compliance).c_str())
      .key<&L::damping>("damping", number<double>(damping_range),
                        with_unit("of both ends", words.damping).c_str())
      .check([](const L& limits, const JsonPath& path) {
        if (!limits.low && !limits.high) path.fail("needs \"low\" or \"high\"");
        if (limits.low && limits.high && *limits.low > *limits.high)
          path.fail("\"low\" must not be above \"high\"");
      });
  return keys;
}

CodecPtr<JointSpringDescription> spring_codec(Motion motion) {
  using S = JointSpringDescription;
  const Words words = words_of(motion);
  auto keys = table<S>(motion == Motion::rotation ? "angle_spring" : "length_spring",
                       "A spring and damper along what a joint leaves free.");
  keys->key<&S::rest>("rest", number<double>(words.range),
                      with_unit("where it pulls to", words.position).c_str())
      .key<&S::compliance>("compliance", maybe(number<double>(compliance_range)),
                           with_unit("1 / stiffness; if not given, a damper alone", words.compliance).c_str())
      .key<&S::damping>("damping", number<double>(damping_range),
                        with_unit("force per speed", words.damping).c_str())
      .check([](const S& spring, const JsonPath& path) {
        if (!spring.compliance && !(spring.damping > 0)) path.fail("needs \"compliance\" or \"damping\"");
      });
  return keys;
}

CodecPtr<JointMotorDescription> motor_codec(Motion motion) {
  using M = JointMotorDescription;
  const Words words = words_of(motion);
  auto keys = table<M>(motion == Motion::rotation ? "angle_motor" : "length_motor",
                       "Drives what a joint leaves free, to a velocity or to a position.");
  keys->key<&M::velocity>("velocity", maybe(number<double>(signed_range(1e5))),
                          with_unit("target velocity", words.velocity).c_str())
      .key<&M::position>("position", maybe(number<double>(words.range)),
                         with_unit("target position", words.position).c_str())
      .key<&M::max_force>("max_force", maybe(number<double>(force_range)),
                          with_unit("largest force; if not given, any", words.force).c_str())
      .key<&M::compliance>("compliance", number<double>(compliance_range),
                           with_unit("of a target position", words.compliance).c_str())
      .key<&M::damping>("damping", number<double>(damping_range),
                        with_unit("of a target position", words.damping).c_str())
      .excludes("velocity", "position")
      .check([](const M& motor, const JsonPath& path) {
        if (!motor.velocity && !motor.position) path.fail("needs \"velocity\" or \"position\"");
      });
  return keys;
}

template <auto... Member, class T>
void add_axis_keys(Table<T>& keys, Motion motion) {
  using A = JointAxisDescription;
  keys.template key<Member..., &A::limits>("limits", maybe(limits_codec(motion)), "stops")
      .template key<Member..., &A::spring>("spring", maybe(spring_codec(motion)), "spring and damper")
      .template key<Member..., &A::motor>("motor", maybe(motor_codec(motion)), "drive");
}

CodecPtr<JointAxisDescription> axis_codec() {
  auto keys = table<JointAxisDescription>("joint_axis", "Forces about one axis of a joint.");
  add_axis_keys(*keys, Motion::rotation);
  return keys;
}

template <class T>
std::shared_ptr<Table<T>> joint_table(const char* kind, const char* heading, const char* doc,
                                      const char* point) {
  auto keys = table<T>(heading, doc);
  keys->template key<&T::name>("name", name(),
                               "unique among joints; if not given: the kind, then the kind with 2, 3, ...")
      .template required<&T::name>("kind", constant<std::string>(Json::of(kind), kind), "kind of the joint")
      .template key<&T::from>("from", name(), "a rigid body or collider; if not given, the world")
      .template required<&T::to>("to", name(), "the rigid body that it holds")
      .template required<&T::point>("point", vector3<double>(meters), point)
      .template key<&T::breaking_force>("breaking_force", maybe(number<double>(force_range)),
                                        "it breaks at a larger force [N]; if not given, never")
      .template key<&T::breaking_torque>("breaking_torque", maybe(number<double>(force_range)),
                                         "it breaks at a larger torque [N m]; if not given, never")
      .template key<&T::collide>("collide", boolean(), "whether the two collide with each other")
      .template key<&T::compliance>("compliance", number<double>(compliance_range),
                                    "of what it holds [m/N]; 0 is rigid")
      .template key<&T::damping>("damping", number<double>(damping_range), "of what it holds [N s/m]");
  return keys;
}

constexpr const char* common_point = "where it joins both at the start [m]";
constexpr const char* point_of_from = "where it holds `from` at the start [m]";

template <class T>
void add_axial_keys(Table<T>& keys, const char* axis) {
  keys.template key<&T::axis>("axis", vector3<double>(meters), axis)
      .template key<&T::angular_compliance>("angular_compliance", number<double>(compliance_range),
                                            "of the axes that it holds [rad/(N m)]; 0 is rigid")
      .template key<&T::angular_damping>("angular_damping", number<double>(damping_range),
                                         "of the axes that it holds [N m s/rad]")
      .check([](const T& joint, const JsonPath& path) {
        if (joint.axis == Vec3d{}) path.key("axis").fail("must not be [0, 0, 0]");
      });
}

CodecPtr<BallSpringDescription> ball_spring_codec() {
  using S = BallSpringDescription;
  auto keys = table<S>("ball_spring", "Pulls a ball joint back to how it was at the start, about all axes.");
  keys->key<&S::compliance>("compliance", number<double>(compliance_range), "1 / stiffness [rad/(N m)]")
      .key<&S::damping>("damping", number<double>(damping_range), "torque per speed [N m s/rad]")
      .key<&S::max_torque>("max_torque", maybe(number<double>(force_range)),
                           "largest torque about each axis [N m]; if not given, any");
  return keys;
}

std::shared_ptr<Table<FixedJointDescription>> fixed_table() {
  auto keys = joint_table<FixedJointDescription>("fixed", "fixed_joint", "Welds two bodies.", common_point);
  add_axial_keys(*keys, "first axis");
  return keys;
}

std::shared_ptr<Table<BallJointDescription>> ball_table() {
  using T = BallJointDescription;
  auto keys =
      joint_table<T>("ball", "ball_joint", "A point of each body; they rotate about it.", common_point);
  keys->key<&T::axis>("axis", vector3<double>(meters),
                      "axis of the twist; swing is the angle by which it moves")
      .key<&T::max_swing>("max_swing", maybe(number<double>(within(0, 180))),
                          "largest swing [degrees]; if not given, any")
      .key<&T::swing_compliance>("swing_compliance", number<double>(compliance_range),
                                 "of the largest swing [rad/(N m)]; 0 is rigid")
      .key<&T::twist>("twist", maybe(limits_codec(Motion::rotation)), "limits of the twist, from -180 to 180")
      .key<&T::spring>("spring", maybe(ball_spring_codec()), "pulls back")
      .needs("swing_compliance", "max_swing")
      .check([](const T& joint, const JsonPath& path) {
        if (joint.axis == Vec3d{}) path.key("axis").fail("must not be [0, 0, 0]");
      });
  return keys;
}

std::shared_ptr<Table<HingeJointDescription>> hinge_table() {
  using T = HingeJointDescription;
  auto keys = joint_table<T>("hinge", "hinge_joint", "`to` rotates about an axis of `from`: a door, a wheel.",
                             common_point);
  add_axial_keys(*keys, "axis of the rotation");
  add_axis_keys<&T::rotation>(*keys, Motion::rotation);
  return keys;
}

std::shared_ptr<Table<SliderJointDescription>> slider_table() {
  using T = SliderJointDescription;
  auto keys = joint_table<T>("slider", "slider_joint",
                             "`to` moves along an axis of `from`: a drawer, a piston.", common_point);
  add_axial_keys(*keys, "axis of the translation");
  add_axis_keys<&T::translation>(*keys, Motion::translation);
  return keys;
}

std::shared_ptr<Table<UniversalJointDescription>> universal_table() {
  using T = UniversalJointDescription;
  auto keys =
      joint_table<T>("universal", "universal_joint", "A Cardan joint: two axes that cross.", common_point);
  add_axial_keys(*keys, "axis of `from`");
  keys->key<&T::second_axis>("second_axis", maybe(vector3<double>(meters)),
                             "axis of `to`, perpendicular to `axis`; if not given, any")
      .key<&T::first>("first", axis_codec(), "about `axis`")
      .key<&T::second>("second", axis_codec(), "about `second_axis`");
  return keys;
}

std::shared_ptr<Table<DistanceJointDescription>> distance_table() {
  using T = DistanceJointDescription;
  auto keys = joint_table<T>("distance", "distance_joint",
                             "A rod between two points, or a rope if `shortest` is 0.", point_of_from);
  keys->required<&T::to_point>("to_point", vector3<double>(meters), "where it holds `to` at the start [m]")
      .key<&T::shortest>(
          "shortest", maybe(number<double>(from_zero(far_away))),
          "shortest distance [m]; if not given, that at the start, or `longest` if that is less")
      .key<&T::longest>(
          "longest", maybe(number<double>(from_zero(far_away))),
          "longest distance [m]; if not given, that at the start, or `shortest` if that is more")
      .key<&T::motor>("motor", maybe(motor_codec(Motion::translation)), "a winch")
      .check([](const T& joint, const JsonPath& path) {
        if (joint.shortest && joint.longest && *joint.shortest > *joint.longest)
          path.fail("\"shortest\" must not be above \"longest\"");
      });
  return keys;
}

std::shared_ptr<Table<PulleyJointDescription>> pulley_table() {
  using T = PulleyJointDescription;
  auto keys = joint_table<T>("pulley", "pulley_joint",
                             "A rope from `from` over two wheels of the world to `to`. It only pulls.",
                             point_of_from);
  keys->required<&T::to_point>("to_point", vector3<double>(meters), "where it holds `to` at the start [m]")
      .required<&T::from_wheel>("from_wheel", vector3<double>(meters), "where the rope leaves for `from` [m]")
      .required<&T::to_wheel>("to_wheel", vector3<double>(meters), "where the rope leaves for `to` [m]")
      .key<&T::ratio>("ratio", number<double>(positive(1e6)),
                      "force on `to` over force on `from`: 2 if the rope is doubled there")
      .key<&T::length>("length", maybe(number<double>(from_zero(far_away))),
                       "length of the rope, that to `to` times `ratio` [m]; if not given, taut at the start");
  return keys;
}

}  // namespace

CodecPtr<AnyJointDescription> joint_codec() {
  using V = AnyJointDescription;
  return std::make_shared<Kinds<V>>(
      std::vector<Alternative>{alternative<V, FixedJointDescription>("fixed", fixed_table(), ""),
                               alternative<V, BallJointDescription>("ball", ball_table(), ""),
                               alternative<V, HingeJointDescription>("hinge", hinge_table(), ""),
                               alternative<V, SliderJointDescription>("slider", slider_table(), ""),
                               alternative<V, UniversalJointDescription>("universal", universal_table(), ""),
                               alternative<V, DistanceJointDescription>("distance", distance_table(), ""),
                               alternative<V, PulleyJointDescription>("pulley", pulley_table(), "")});
}

}  // namespace souple::scene_format
