#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/collision/shapes.h"
#include "souple/collision/contact_material.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/vertex_maps.h"
#include "souple/io/mesh_file.h"
#include "souple/world/world.h"

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

// A scene file in C++: plain data, one struct per JSON object, one field per key, by the same names.
// docs/scene-format.md says what each means; it is made from the same tables that read the file.

namespace souple {

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
  MeshImport import{};  ///< of a file
};

// --- what holds vertices
/// Positions of all of an object's vertices over time, from a .pc2, a .mdd or a sequence of meshes
/// (one of its files, or its folder).
struct SequenceDescription {
  std::string file;
  double frame_rate = 60;
  double start_time = 0;  ///< s
};

struct PinDescription {
  Selector where{};
  std::vector<KeyframeDescription> keyframes;
  bool loop = false;
  /// Center of the keyframes' rotations; the middle of the vertices if not given.
  std::optional<Vec3d> about;
  std::optional<SequenceDescription> sequence;
};

struct AttachmentDescription : PinDescription {
  float compliance = 0;  ///< m/N
};

/// A number per vertex: `fallback` outside and `value` inside a group, or blended by a color of the
/// vertices.
struct MapDescription {
  std::variant<std::string, ColorChannel> source;
  float value = 1, fallback = 0;
};
/// How strongly vertices are held: 1 is a pin, 0 free, between them a spring.
struct PinMapDescription : MapDescription {
  float compliance = 1e-3f;  ///< of a vertex of weight one half [m/N]
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
/// A material as a preset, if one is named, with changes.
template <class Material>
struct MaterialDescription : Material {
  std::string preset;
};

struct ObjectDescription {
  std::string name;
  TransformDescription transform;
  Vec3f velocity{};                    ///< m/s
  Vec3f angular_velocity{};            ///< rad/s
  std::optional<std::uint32_t> color;  ///< 0xRRGGBB (sRGB), for those who show it
  bool self_collision = false;         ///< not of grains
  int layer = 0;                       ///< not of ropes and grains
  CollisionFilter collision{};         ///< groups and mask
  std::vector<PinDescription> pins;
  std::vector<AttachmentDescription> attachments;
};

struct ClothDescription : ObjectDescription {
  MeshDescription mesh;
  MaterialDescription<ClothMaterial> material;
  MapsDescription maps;
  std::optional<TethersDescription> tethers;
  std::optional<float> pressure;  ///< Pa
  std::optional<EnclosedVolumeDescription> enclosed_volume;
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

/// Grains that fill a box on a cubic lattice, each moved at random.
struct GrainsBox {
  Vec3d lo{}, hi{};               ///< m
  std::optional<double> spacing;  ///< m; 2 radius (1 + jitter) if not given
  double jitter = 0;              ///< fraction of a radius by which a center may be moved along each axis
};
/// Grains on a cubic lattice about the origin.
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
  std::optional<double> end;                   ///< s; never if not given
  std::vector<KeyframeDescription> keyframes;  ///< of poses applied to the position and direction
  bool loop = false;
};
struct FluidBox {
  Vec3d lo{}, hi{};  ///< m
};
struct FluidDescription : ObjectDescription {
  std::variant<std::vector<Vec3d>, FluidBox, MeshDescription> filling;
  MaterialDescription<FluidMaterial> material;
  std::vector<EmitterDescription> emitters;
  std::uint32_t max_particles = 0;  ///< 0: as many as it begins with
};

struct ObstacleSequenceDescription : SequenceDescription {
  bool loop = false;
};
/// Of what all objects share it has a name, a transform, a color and collision groups.
struct ObstacleDescription : ObjectDescription {
  MeshDescription mesh;
  ObstacleMaterial material;
  std::vector<KeyframeDescription> keyframes;
  bool loop = false;
  std::optional<ObstacleSequenceDescription> sequence;
};

using AnyObjectDescription = std::variant<ClothDescription, SoftBodyDescription, RopeDescription,
                                          GrainsDescription, ObstacleDescription, FluidDescription>;
/// What all kinds share.
const ObjectDescription& common(const AnyObjectDescription& object);
ObjectDescription& common(AnyObjectDescription& object);
ObjectKind kind_of(const AnyObjectDescription& object);

// --- the rest
/// The solid inside a closed surface, as a grid of distances.
struct SignedDistanceFieldDescription {
  MeshDescription mesh;
  std::optional<double> spacing;  ///< of the grid [m]
  int resolution = 64;            ///< cells along the mesh's longest side, if no spacing is given
};
/// The alternatives of Shape, by the same names.
using ShapeDescription = std::variant<Plane, Sphere, Box, Capsule, Cylinder, SignedDistanceFieldDescription>;

struct ColliderDescription {
  std::string name;
  ShapeDescription shape{};
  float friction = 0.5f;
  float restitution = 0;
  CollisionFilter collision{};                 ///< as of an object
  std::optional<std::uint32_t> color;          ///< the same
  bool show = true;                            ///< in pictures; it collides all the same
  TransformDescription transform;              ///< its scale is 1
  std::vector<KeyframeDescription> keyframes;  ///< instead of the transform
  bool loop = false;
};

struct DrainDescription {
  ShapeDescription shape{};
  TransformDescription transform;  ///< its scale is 1
  std::optional<float> rate;       ///< m^3/s; all that comes if not given
  double start = 0;                ///< s
  std::optional<double> end;       ///< s; never if not given
};

struct PairDescription {
  std::array<std::string, 2> between;  ///< names of objects or colliders
  bool collide = true;
  std::optional<float> friction;  ///< what the materials say if not given; then `collide` is false
  float restitution = 0;          ///< counts only beside a friction
};

struct EndDescription {
  std::string object;
  Selector where{};
};
enum class Pairing { in_order, nearest };
/// Ties vertices of one object to vertices of another, or of the same.
struct ConnectionDescription {
  EndDescription from, to;
  Pairing pairing = Pairing::in_order;
  std::optional<float> rest_length;  ///< m; the distance at the start if not given
  float compliance = 0;              ///< m/N
  std::optional<double> until;       ///< s; for ever if not given
};

struct CameraDescription {
  Vec3d from{2, 1.5, 3}, to{0, 0.5, 0};  ///< m
  double fov = 40;                       ///< vertical [degrees]
};

struct SceneDescription {
  std::string description;  ///< one line for `souple list`
  double frame_rate = 60;   ///< frames a second
  std::uint32_t frames = 240;
  Settings settings{};
  CameraDescription camera;
  std::vector<AnyObjectDescription> objects;
  std::vector<ColliderDescription> colliders;
  std::vector<PairDescription> pairs;
  std::vector<ConnectionDescription> connections;
  std::vector<DrainDescription> drains;

  // Where it came from; not part of the file.
  std::string source;            ///< how messages call the scene
  std::filesystem::path folder;  ///< its files are found relative to this
};

/// Reads a scene file. `overrides` are `path=value` texts, e.g.
/// "objects.flag.material.bending_stiffness=1e-5" or "substeps=20", applied before anything is checked; an
/// entry of a list is named by its name or its index. Every object and collider of the result has a name.
/// Throws Error, one line: file, path inside it, the value, what was expected. Nothing but the scene's own
/// text is read; its mesh files must exist.
SceneDescription load_scene(const std::filesystem::path& file, std::span<const std::string> overrides = {});

/// The same from memory. `source` stands for the file's name in messages.
SceneDescription parse_scene(std::string_view text, const std::filesystem::path& folder,
                             std::string_view source, std::span<const std::string> overrides = {});

/// The scene that a run.json embeds, to look at rather than to build: its mesh files may be gone.
SceneDescription parse_recorded_scene(std::string_view text, std::string_view source);

/// Writes a scene back, normalized: keys in a fixed order, defaults left out, every object named.
std::string to_json(const SceneDescription& scene);

/// "plane", "sphere", ... as shape_name of the shape that is built from it.
std::string_view shape_name(const ShapeDescription& shape);

using SceneLog = std::function<void(LogLevel, std::string_view)>;

/// Reads the meshes and adds everything to a new world. What is found in meshes (mended or doubtful) goes to
/// `log`, one line each. Throws Error: file, path inside it, what is wrong.
World build_world(const SceneDescription& scene, const SceneLog& log = {});

/// JSON schema (draft 2020-12) of scene files, and the manual page docs/scene-format.md; both are made from
/// the tables of the reader.
std::string scene_schema();
std::string scene_manual();

}  // namespace souple
