#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

CodecPtr<SignedDistanceFieldDescription> signed_distance_field_codec() {
  using F = SignedDistanceFieldDescription;
  auto keys = table<F>("signed_distance_field",
                       "The solid inside a surface, as a grid of signed distances. For large rigid "
                       "meshes with many triangles.");
  keys->required<&F::mesh>("mesh", mesh_codec(MeshUse::surface),
                           "surface, closed but for small holes, in the collider's own frame")
      .key<&F::spacing>(
          "spacing", maybe(number<double>(size_range)),
          "distance between grid points [m]; walls and gaps thinner than two of these distances are lost")
      .key<&F::resolution>("resolution", number<int>(within(4, 4096)),
                           "cells along the surface's longest side, instead of `spacing`")
      .excludes("spacing", "resolution");
  return keys;
}

}  // namespace

CodecPtr<SurfaceLook> surface_look() {
  return enumeration<SurfaceLook>({{"solid", SurfaceLook::solid}, {"glass", SurfaceLook::glass}});
}

CodecPtr<ShapeDescription> shape_codec() {
  using S = ShapeDescription;
  const CodecPtr<Vec3f> center = vector3<float>(meters);
  const CodecPtr<float> size = number<float>(size_range);
  const char* center_doc = "center in the collider's own frame [m]";
  auto plane = table<Plane>("plane", "The half space normal . x <= offset is solid.");
  plane
      ->key<&Plane::normal>("normal", vector3<float>(meters),
                            "direction out of the solid; any nonzero length")
      .key<&Plane::offset>(
          "offset", number<float>(meters),
          "distance of the plane from the origin along the normal [m], times the normal's length")
      .check([](const Plane& shape, const JsonPath& path) {
        if (!(length_squared(Vec3d(shape.normal)) > 1e-12)) path.key("normal").fail("must not be zero");
      });
  auto sphere = table<Sphere>("sphere", "A ball.");
  sphere->required<&Sphere::radius>("radius", size, "radius [m]")
      .key<&Sphere::center>("center", center, center_doc);
  auto box = table<Box>("box", "A box.");
  box->required<&Box::half_extents>("half_extents", vector3<float>(size_range), "half the side lengths [m]")
      .key<&Box::center>("center", center, center_doc);
  auto capsule = table<Capsule>("capsule", "All points within `radius` of a segment along Y.");
  capsule->required<&Capsule::radius>("radius", size, "radius [m]")
      .required<&Capsule::half_height>("half_height", number<float>(from_zero(far_away)),
                                       "half the length of the segment, without caps [m]")
      .key<&Capsule::center>("center", center, center_doc);
  auto cylinder = table<Cylinder>("cylinder", "A cylinder along Y with flat ends.");
  cylinder->required<&Cylinder::radius>("radius", size, "radius [m]")
      .required<&Cylinder::half_height>("half_height", size, "half the height [m]")
      .key<&Cylinder::center>("center", center, center_doc);
  auto keys = table<S>("shape", "The solid of a collider, or the region of a drain.");
  keys->choice<>(
      {alternative<S, Plane>("plane", plane, "a half space"),
       alternative<S, Sphere>("sphere", sphere, "a ball"), alternative<S, Box>("box", box, "a box"),
       alternative<S, Capsule>("capsule", capsule, "a capsule along Y"),
       alternative<S, Cylinder>("cylinder", cylinder, "a cylinder along Y"),
       alternative<S>("signed_distance_field", signed_distance_field_codec(), "the inside of a mesh")});
  return keys;
}

CodecPtr<ColliderDescription> collider_codec() {
  using C = ColliderDescription;
  auto keys = table<C>("collider", "A solid that objects collide with, static or moved by keyframes.");
  keys->key<&C::name>("name", name(), "unique name; if not given: collider, collider2, ...")
      .required<&C::shape>("shape", shape_codec(), "the collider's solid")
      .key<&C::friction>("friction", number<float>(friction_range),
                         "Coulomb friction coefficient; a contact uses the geometric mean of both sides")
      .key<&C::kinetic_friction>(
          "kinetic_friction", maybe(number<float>(friction_range)),
          "friction coefficient while sliding, at most `friction`; if not given: `friction`")
      .key<&C::restitution>("restitution", number<float>(unit),
                            "coefficient of restitution, the fraction of the speed that a bounce keeps; a "
                            "contact uses the larger of both sides")
      .key<&C::color>(
          "color", maybe(color()),
          "color in pictures, as in HTML; if not given: light gray, and gray concrete for a level floor")
      .key<&C::look>("look", surface_look(),
                     "material in pictures; `glass` is transparent, best with thin walls")
      .key<&C::show>("show", boolean(), "false: hidden in pictures; it still collides")
      .key<&C::sensor>("sensor", boolean(),
                       "true: pushes nothing and stops no fluid; programs ask which objects overlap it")
      .key<&C::transform>("transform", pose_codec(), "position and rotation")
      .excludes("transform", "keyframes")
      .check(check_kinetic_friction<C>);
  add_keyframe_keys(*keys, "motion, instead of `transform`");
  add_collision_keys(*keys);
  return keys;
}

}  // namespace souple::scene_format
