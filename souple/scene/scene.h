#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/collision/shapes.h"
#include "souple/contacts/contact_material.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/lattice.h"
#include "souple/geometry/vertex_maps.h"
#include "souple/mesh_files/mesh_file.h"
#include "souple/objects/handles.h"
#include "souple/objects/kind_traits.h"
#include "souple/objects/materials.h"
#include "souple/objects/self_collision.h"
#include "souple/queries/selector.h"
#include "souple/scene/joint_description.h"
#include "souple/scene/tie_description.h"
#include "souple/stages/settings.h"
#include "souple/state/warnings.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

// A scene file in C++: plain data, one struct per JSON object, one field per key, with equal names.
// docs/scene-format.md explains the keys; it is generated from the reader's tables.

namespace souple {

class World;

struct TransformDescription {
  Vec3d translate{};  ///< m
  Vec3d rotate{};     ///< degrees about X, then Y, then Z (fixed axes)
  double scale = 1;
};

struct KeyframeDescription {
  double time = 0;  ///< s
  Vec3d translate{};
  Vec3d rotate{};  ///< degrees
};

// --- meshes
struct GridMesh {
  int columns = 0, rows = 0;
  double size = 0;
  Diagonals diagonals = Diagonals::alternating;
};
struct DiskMesh {
  int rings = 0, segments = 0;
  double radius = 0;
};
struct SphereMesh {
  int subdivisions = 3;
  double radius = 0;
};
struct BoxMesh {
  Vec3d size{};
  std::array<int, 3> divisions{1, 1, 1};
};
struct TorusMesh {
  double major_radius = 0, minor_radius = 0;
  int major_segments = 32, minor_segments = 16;
};
struct CapsuleMesh {
  double radius = 0, length = 0;
  int segments = 24, rings = 6, divisions = 1;
};
struct CylinderMesh {
  double radius = 0, height = 0;
  int segments = 24, divisions = 1, cap_rings = 1;
};
struct TetBarMesh {
  std::array<int, 3> cells{1, 1, 1};
  Vec3d size{};
};
struct TetBallMesh {
  int subdivisions = 2, layers = 2;
  double radius = 0;
};
struct FileMesh {
  std::string file;  ///< relative to the scene's folder
};
struct MeshDescription {
  std::variant<GridMesh, DiskMesh, SphereMesh, BoxMesh, TorusMesh, CapsuleMesh, CylinderMesh, TetBarMesh,
               TetBallMesh, FileMesh>
      source;
  MeshImport import{};  ///< import options of a file
};

// --- pins and maps
/// Positions of all vertices of an object over time. The file is a .pc2, a .mdd, an animation (.glb, .gltf, .fbx,
/// .dae), or a sequence of meshes (one of its files, or its folder).
struct SequenceDescription {
  std::string file;
  std::string animation{};  ///< its name in the file; empty: the only one
  double frame_rate = 60;
  double start_time = 0;        ///< s
  std::optional<double> scale;  ///< meters per unit of the file; if not given, that of the mesh
  std::optional<UpAxis> up;     ///< the file's up axis; if not given, that of the mesh
  bool loop = false;            ///< repeats the frames after the last, which should equal the first
};

struct PinDescription {
  Selector where{};
  std::vector<KeyframeDescription> keyframes;
  bool loop = false;
  /// Center of rotation of the keyframes; if not given, the mean of the vertices.
  std::optional<Vec3d> about;
  std::optional<SequenceDescription> sequence;
};

struct AttachmentDescription : PinDescription {
  float compliance = 0;  ///< m/N
};

/// A number per vertex: `value` inside a group and `fallback` outside, or a blend by a channel of the vertex
/// colors.
struct MapDescription {
  std::variant<std::string, ColorChannel> source;
  float value = 1, fallback = 0;
};
/// Pin weight per vertex: 1 is a pin, 0 is free, between them a spring.
struct PinMapDescription : MapDescription {
  float compliance = 1e-3f;  ///< compliance of a vertex of weight 1/2 [m/N]
};
struct MapsDescription {
  std::optional<PinMapDescription> pin_weight;
  std::optional<MapDescription> stiffness, thickness;
};

struct TethersDescription {
  float slack = 0.02f;
};
struct EnclosedVolumeDescription {
  float factor = 1;
  float compliance = 0;  ///< m^3/Pa
};

// --- objects
/// A material, optionally based on a preset.
template <class Material>
struct MaterialDescription : Material {
  std::string preset;
};

struct ObjectDescription {
  std::string name;
  TransformDescription transform;
  Vec3f velocity{};                                   ///< m/s
  Vec3f angular_velocity{};                           ///< rad/s
  std::optional<std::uint32_t> color;                 ///< 0xRRGGBB (sRGB), for viewers and pictures
  SelfCollision self_collision = SelfCollision::off;  ///< not for grains; ropes: not particles
  int layer = 0;                                      ///< not for ropes and grains
  CollisionFilter collision{};                        ///< collision groups and mask
  float wind_exposure = 1;  ///< share of the wind's velocity that reaches it; not for obstacles
  std::vector<PinDescription> pins;
  std::vector<AttachmentDescription> attachments;
};

/// Fabric of a cloth in pictures.
enum class ClothLook { woven, velvet, satin };
enum class ClothPattern { plain, checker, stripes, plaid, dots };
/// Print of a cloth in pictures: one of the patterns, or a picture.
struct ClothPrint {
  ClothPattern pattern = ClothPattern::plain;
  std::string file;  ///< of a picture, placed by the mesh's UVs; empty: `pattern`
};

struct ClothDescription : ObjectDescription {
  MeshDescription mesh;
  MaterialDescription<ClothMaterial> material;
  MapsDescription maps;
  std::optional<TethersDescription> tethers;
  std::optional<float> pressure;  ///< Pa
  std::optional<EnclosedVolumeDescription> enclosed_volume;
  ClothLook look = ClothLook::woven;  ///< in pictures
  std::optional<ClothPrint> pattern;  ///< in pictures; empty: of woven cloth by its place, of others plain
};

struct SoftBodyDescription : ObjectDescription {
  MeshDescription mesh;
  std::optional<LatticeOptions> lattice;
  MaterialDescription<SoftBodyMaterial> material;
  MapsDescription maps;
};

struct RopeDescription : ObjectDescription {
  std::vector<Vec3d> points;  ///< m
  std::uint32_t segments = 20;
  MaterialDescription<RopeMaterial> material;
  std::optional<TethersDescription> tethers;
};

/// Grains that fill a box on a cubic lattice, with random displacements.
struct GrainsBox {
  Vec3d lo{}, hi{};               ///< m
  std::optional<double> spacing;  ///< m; if not given, 2 radius (1 + jitter)
  double jitter = 0;  ///< largest displacement of a center along each axis, as a fraction of the radius
};
/// Grains on a cubic lattice centered at the origin.
struct GrainsGrid {
  std::array<int, 3> counts{1, 1, 1};
  std::optional<double> spacing;
  double jitter = 0;
};
struct GrainsDescription : ObjectDescription {
  std::variant<std::vector<Vec3d>, GrainsBox, GrainsGrid, MeshDescription> centers;
  MaterialDescription<GrainsMaterial> material;
};

struct EmitterDescription {
  Vec3f position{};  ///< m
  Vec3f direction{0, -1, 0};
  float radius = 0.05f;                        ///< m
  float speed = 1;                             ///< m/s
  double start = 0;                            ///< s
  std::optional<double> end;                   ///< s; if not given, never
  std::vector<KeyframeDescription> keyframes;  ///< poses applied to position and direction
  bool loop = false;
};
struct FluidBox {
  Vec3d lo{}, hi{};  ///< m
};
struct FluidDescription : ObjectDescription {
  std::variant<std::vector<Vec3d>, FluidBox, MeshDescription> filling;
  MaterialDescription<FluidMaterial> material;
  std::vector<EmitterDescription> emitters;
  std::uint32_t max_particles = 0;  ///< 0: as many as at the start
  bool caustics = false;            ///< in pictures: it refracts sunlight onto the floor
};

/// The solid inside a closed surface, as a grid of signed distances.
struct SignedDistanceFieldDescription {
  MeshDescription mesh;
  std::optional<double> spacing;  ///< of the grid [m]
  int resolution = 64;            ///< cells along the mesh's longest side, if no spacing is given
};
/// The alternatives of Shape, with equal names.
using ShapeDescription = std::variant<Plane, Sphere, Box, Capsule, Cylinder, SignedDistanceFieldDescription>;

/// Material of a collider or obstacle in pictures.
enum class SurfaceLook { solid, glass };

/// An obstacle. It uses only the common fields name, transform, color, layer and collision groups.
struct ObstacleDescription : ObjectDescription {
  MeshDescription mesh;
  ObstacleMaterial material;
  SurfaceLook look = SurfaceLook::solid;  ///< in pictures
  std::vector<KeyframeDescription> keyframes;
  bool loop = false;
  std::optional<SequenceDescription> sequence;
};

/// A shape of a rigid body of several.
struct RigidPartDescription {
  ShapeDescription shape{};
  TransformDescription transform;  ///< with scale 1
  std::optional<double> density;   ///< kg/m^3; if not given, that of the material
};
/// It is the convex hull of each connected piece of a mesh, an analytic shape, or several of these.
struct RigidBodyDescription : ObjectDescription {
  std::variant<MeshDescription, ShapeDescription, std::vector<RigidPartDescription>> solid;
  RigidBodyMaterial material;
  std::optional<double> mass;           ///< kg; if not given, from the density
  std::optional<Vec3d> center_of_mass;  ///< in the frame of the mesh or shape [m]; if not given, of the solid
  std::optional<Vec3d>
      inertia;  ///< moments about the axes of that frame [kg m^2]; if not given, of the solid
  bool kinematic = false;
  std::vector<KeyframeDescription> keyframes;  ///< of a kinematic body
  bool loop = false;
};

/// The alternatives are in the order of ObjectKind.
using AnyObjectDescription =
    std::variant<ClothDescription, SoftBodyDescription, RopeDescription, GrainsDescription,
                 ObstacleDescription, FluidDescription, RigidBodyDescription>;
/// The fields that all kinds share.
const ObjectDescription& common(const AnyObjectDescription& object);
ObjectDescription& common(AnyObjectDescription& object);
ObjectKind kind_of(const AnyObjectDescription& object);

// --- colliders, connections, the scene
struct ColliderDescription {
  std::string name;
  ShapeDescription shape{};
  float friction = 0.5f;
  std::optional<float> kinetic_friction;  ///< if not given, `friction`
  float restitution = 0;
  CollisionFilter collision{};                 ///< collision groups and mask
  std::optional<std::uint32_t> color;          ///< 0xRRGGBB (sRGB), for viewers and pictures
  SurfaceLook look = SurfaceLook::solid;       ///< in pictures
  bool show = true;                            ///< in pictures; a hidden collider still collides
  bool sensor = false;                         ///< pushes nothing, see ColliderOptions
  TransformDescription transform;              ///< with scale 1
  std::vector<KeyframeDescription> keyframes;  ///< instead of the transform
  bool loop = false;
};

/// Light from a panorama of the surroundings, in pictures.
struct SkyDescription {
  std::string file;        ///< a picture in the Radiance format (.hdr)
  double rotation = 0;     ///< about the vertical, counterclockwise from above [degrees]
  double strength = 1;     ///< factor of its radiance; 1 in the file is white
  double sun = 0;          ///< irradiance of the sun that casts sharp shadows; 4 without a panorama
  bool background = true;  ///< it is drawn behind the scene
};

struct DrainDescription {
  ShapeDescription shape{};
  TransformDescription transform;  ///< with scale 1
  std::optional<float> rate;       ///< m^3/s; if not given, all fluid in the region
  double start = 0;                ///< s
  std::optional<double> end;       ///< s; if not given, never
};

struct PairDescription {
  std::array<std::string, 2> between;  ///< names of objects or colliders
  bool collide = true;
  std::optional<float> friction;          ///< if not given, that of the materials; then `collide` is false
  std::optional<float> kinetic_friction;  ///< used only with a friction
  float restitution = 0;                  ///< used only with a friction
};

struct EndDescription {
  std::string object;
  Selector where{};
};
enum class Pairing { in_order, nearest };
/// Distance joints between vertices of two objects, or of one.
struct ConnectionDescription {
  EndDescription from, to;
  Pairing pairing = Pairing::in_order;
  std::optional<float> rest_length;  ///< m; if not given, the distance at the start
  float compliance = 0;              ///< m/N
  std::optional<double> until;       ///< s; if not given, never released
};

struct CameraDescription {
  Vec3d from{2, 1.5, 3}, to{0, 0.5, 0};  ///< m
  double fov = 40;                       ///< vertical [degrees]
};

struct SceneDescription {
  std::string description;  ///< one line for `souple list`
  double frame_rate = 60;   ///< frames per second
  std::uint32_t frames = 240;
  Settings settings{};
  CameraDescription camera;
  std::optional<SkyDescription> sky;  ///< in pictures; empty: a procedural sky
  std::vector<AnyObjectDescription> objects;
  std::vector<ColliderDescription> colliders;
  std::vector<PairDescription> pairs;
  std::vector<ConnectionDescription> connections;
  std::vector<AnyJointDescription> joints;
  std::vector<TieDescription> ties;
  std::vector<DrainDescription> drains;

  // Origin of the scene; not part of the file.
  std::string source;            ///< name of the scene in messages
  std::filesystem::path folder;  ///< base folder of its relative files
};

/// Reads a scene file. `overrides` are `path=value` texts, such as
/// "objects.flag.material.bending_stiffness=1e-5" or "substeps=20", applied before validation; a list entry
/// is given by its name or its index. Every object and collider of the result has a name. Throws Error, one
/// line: file, path inside it, the value, and the expected value. Reads the scene's text only; its mesh files
/// must exist.
SceneDescription load_scene(const std::filesystem::path& file, std::span<const std::string> overrides = {});

/// Parses a scene in memory. `source` replaces the file's name in messages.
SceneDescription parse_scene(std::string_view text, const std::filesystem::path& folder,
                             std::string_view source, std::span<const std::string> overrides = {});

/// Parses the scene embedded in a run.json, for display, not for building: its mesh files may be gone.
SceneDescription parse_recorded_scene(std::string_view text, std::string_view source);

/// Writes a scene in normalized form: fixed order of keys, no defaults, all objects named.
std::string to_json(const SceneDescription& scene);

/// "plane", "sphere", ...: shape_name of the Shape built from it.
std::string_view shape_name(const ShapeDescription& shape);

using SceneLog = std::function<void(LogLevel, std::string_view)>;

/// Reads the meshes and builds a world. Repairs and warnings about meshes go to `log`, one line each. Throws
/// Error: file, path inside it, the problem.
World build_world(const SceneDescription& scene, const SceneLog& log = {});

/// Adds scene.objects[object] to a world that has the objects before it, at the world's current time. Throws
/// Error like build_world.
void add_to_world(const SceneDescription& scene, std::size_t object, World& world);

/// The JSON schema (draft 2020-12) of scene files, and the manual page docs/scene-format.md; both are
/// generated from the reader's tables.
std::string scene_schema();
std::string scene_manual();

}  // namespace souple
