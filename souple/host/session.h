#pragma once

#include "souple/host/clock.h"
#include "souple/host/drag_plane.h"
#include "souple/host/vertex_welder.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

// The interface for a renderer's plugin; see docs/embedding.md. The headers of this folder are valid C++17.

namespace souple::host {

/// Identifies an object of a session. A handle is never reused, not even after another scene is opened.
/// 0: no object.
using Handle = std::uint32_t;

enum class Kind { cloth, soft_body, rope, grains, obstacle, fluid, rigid_body };
const char* kind_name(Kind kind);

struct ObjectInfo {
  Handle handle = 0;
  std::string name;  ///< unique in the session
  Kind kind = Kind::cloth;
  std::size_t vertex_count = 0;    ///< vertices that `write` fills: render vertices, or the scene mesh's
  std::size_t triangle_count = 0;  ///< 0 for ropes, grains and fluids
  float radius = 0;                ///< ropes, grains, fluids: radius; other kinds: half the thickness [m]
  bool from_scene = false;         ///< true: from the scene file; false: from a mesh of the host
  bool has_color = false;          ///< the scene file defines `color`
  std::array<float, 3> color{};    ///< R, G, B in [0, 1], sRGB as in scene files, not linear light
};

/// A render mesh of a scene's collider (plane, sphere, box, ...).
struct ColliderShape {
  std::string name;
  std::vector<float> positions, normals;  ///< x, y, z of each vertex, in the collider's own frame [m]
  std::vector<std::uint32_t> indices;     ///< three a triangle, counter-clockwise from outside
  bool has_color = false;                 ///< the scene file defines `color`
  std::array<float, 3> color{};           ///< R, G, B in [0, 1], sRGB
};

/// How the session turns a mesh of the host into an object.
struct MeshOptions {
  std::string name;                  ///< unique; empty: the kind, then kind2, ...
  const float* transform = nullptr;  ///< 4 x 4, column-major, mesh to world; copied. nullptr: none
  double weld_tolerance = 0;         ///< see VertexWelder
  std::string preset;                ///< "cotton", "jelly", ...; empty: the kind's default material
  bool self_collision = false;       ///< cloth only
  std::size_t lattice_tets = 2000;   ///< soft bodies only: approximate number of lattice tets
};

/// Surface of a collider that the host adds.
struct ColliderSurface {
  float friction = 0.5f;
  float restitution = 0;
};

/// A number of a material, for a slider.
struct Parameter {
  std::string name;   ///< as in scene files
  std::string label;  ///< for the user interface
  std::string unit;   ///< UTF-8, may be empty
  double value = 0, least = 0, most = 1;
  bool logarithmic = false;  ///< logarithmic slider: least > 0, and the left end stands for the value 0 too
};

/// Numbers of the last step.
struct Statistics {
  std::uint64_t steps = 0;  ///< since the start or the last reset
  double time = 0;          ///< simulated [s]
  double milliseconds = 0;  ///< of the last step
  struct Stage {
    std::string name;
    double milliseconds = 0;
  };
  std::vector<Stage> stages;
  std::size_t objects = 0, particles = 0, constraints = 0, contacts = 0, asleep = 0;
  double largest_strain = 0;   ///< extension over rest length
  double deepest_contact = 0;  ///< m
  std::string warnings;        ///< the step's warnings, one sentence each, with remedies

  std::string text() const;  ///< a few lines for a panel
};

/// A world driven by the clock, the meshes and the mouse of a host program.
///
/// Each frame the host calls `advance`, then `write` for each visible object. All functions but `advance`
/// throw Error (one sentence) and leave the session unchanged on failure. Other threads may call `post`,
/// `take_messages` and `statistics` at any time; the other functions allow one thread at a time.
class Session {
 public:
  explicit Session(const ClockOptions& clock = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // --- objects
  /// Replaces the session's contents by a scene file.
  void open_scene(const std::string& file);
  /// Removes all objects; the settings become the defaults.
  void clear();
  /// Adds a cloth at the current time of the world. After a reset it exists from the start.
  Handle add_cloth(const TriangleSoup& soup, const MeshOptions& options = {});
  /// Adds a soft body: the closed surface is embedded in a lattice of tets.
  Handle add_soft_body(const TriangleSoup& soup, const MeshOptions& options = {});
  /// Adds an obstacle: other objects collide with it, and no contact moves it. It has no preset.
  Handle add_obstacle(const TriangleSoup& soup, const MeshOptions& options = {});
  /// Adds a rigid body: it collides as the convex hull of each connected piece, and with cloth, ropes and grains by its
  /// triangles. It has no preset.
  Handle add_rigid_body(const TriangleSoup& soup, const MeshOptions& options = {});
  /// Removes an object, at any time, with its attachments and grabs. A reset does not restore it.
  void remove(Handle object);
  bool contains(Handle object) const;
  ObjectInfo object(Handle object) const;
  std::vector<ObjectInfo> objects() const;  ///< in the order of their addition
  /// Reports that the host moved its mesh. An obstacle moves to the new transform during the next step and carries the
  /// objects it touches. Relative to the transform at its addition, it may only rotate and translate. Particles of
  /// other objects keep their world positions: only the output of `write` changes.
  void set_transform(Handle object, const float* transform);
  /// Pins a vertex at its current position, or releases it; the pin survives a reset.
  void set_pinned(Handle object, std::uint32_t vertex, bool pinned);

  /// Moves a pinned vertex: it arrives at the position [m, world] at the end of the next step, and stays.
  /// A reset returns it to the object's mesh.
  void move_pin(Handle object, std::uint32_t vertex, float x, float y, float z);

  // --- colliders, connections, wind; all survive a reset
  /// Adds an analytic collider: much cheaper than an obstacle of triangles. `transform` is rigid, 4 x 4,
  /// column-major, collider to world; nullptr: none. A plane is solid below the XZ plane of its frame. The axis
  /// of a capsule is along Y; half_height is that of its segment, without the caps. [m]
  Handle add_plane(const float* transform = nullptr, const ColliderSurface& surface = {});
  Handle add_sphere(float radius, const float* transform = nullptr, const ColliderSurface& surface = {});
  Handle add_box(float half_x, float half_y, float half_z, const float* transform = nullptr,
                 const ColliderSurface& surface = {});
  Handle add_capsule(float radius, float half_height, const float* transform = nullptr,
                     const ColliderSurface& surface = {});
  /// A collider of the host arrives at the transform at the end of the next step, and sweeps its path.
  void move_collider(Handle collider, const float* transform);
  void remove_collider(Handle collider);
  /// Keeps two vertices at a distance [m], negative: their current distance; compliance in m/N, 0: rigid. An
  /// obstacle's vertex carries the other. Removing one of the objects removes the connection.
  Handle connect(Handle object, std::uint32_t vertex, Handle other, std::uint32_t other_vertex,
                 float distance = 0, float compliance = 0);
  void disconnect(Handle connection);
  /// Wind [m/s]; `gust`: 0 steady, 0.5: 50 % stronger and weaker.
  void set_wind(float x, float y, float z, float gust = 0);
  std::array<float, 3> wind() const;
  /// Share of the wind that reaches an object, as World::set_wind_exposure.
  void set_wind_exposure(Handle object, float exposure);

  // --- time
  /// Processes a frame of the host: its animation time and the frame's length [s]. Applies the posted
  /// actions, then does nothing, a step or a reset as Clock decides, and returns the decision. Never throws:
  /// `take_messages` reports failures. A failed step or reset pauses and leaves the world unchanged.
  Tick advance(double host_time, double frame_dt);
  /// While paused, the host's time causes no steps. A new session plays.
  void set_playing(bool playing);
  bool playing() const;
  /// The next `advance` makes one step, even if the host's time stands still, and pauses.
  void request_step();
  /// Returns to the start with the current objects, materials, pins and settings, and with the host's meshes
  /// at their current transforms.
  void reset();
  /// Sets the host time that corresponds to the world's current time [s]; see Clock::start_at.
  void start_at(double host_time);
  double time() const;            ///< simulated [s]
  std::uint64_t steps() const;    ///< since the start or the last reset
  std::uint64_t version() const;  ///< increases whenever the output of `write` may have changed
  /// Hash of all positions and velocities, as World::hash.
  std::uint64_t hash() const;

  // --- drawing
  /// Writes the object's vertices into buffers of `vertex_count` vertices, in the coordinates of the host's
  /// mesh. Objects of a scene are written in world coordinates, with welded normals. Ropes and grains have
  /// no normals.
  void write(Handle object, const VertexBuffers& buffers, std::size_t vertex_count,
             Normals normals = Normals::welded);
  /// Three vertex indices per triangle.
  std::vector<std::uint32_t> triangles(Handle object) const;
  /// Two vertex indices per segment of a rope, from its first to its last vertex; empty for other kinds.
  std::vector<std::uint32_t> segments(Handle object) const;
  /// Render meshes of the scene's colliders. Colliders are rigid, so the meshes change only when a scene is
  /// opened. A plane is a square of side 2 `extent` [m] around its point nearest to the world's origin.
  std::vector<ColliderShape> colliders(double extent = 10) const;
  /// Current transforms of `colliders()`, in that order: 4 x 4, column-major, collider frame to world.
  std::vector<std::array<float, 16>> collider_transforms() const;

  // --- the mouse; rays are in world coordinates [m]
  /// Grabs a render vertex and releases the previous grab. The vertex is dragged along a plane through it
  /// that faces the viewer (DragPlane). Returns false, without a grab, if the vertex is pinned or belongs to
  /// an obstacle.
  bool grab_vertex(Handle object, std::uint32_t vertex, const Ray& ray, const Vec3f& facing = {});
  /// Grabs the point where the ray intersects the plane of a triangle; otherwise like `grab_vertex`.
  bool grab_triangle(Handle object, std::uint32_t triangle, const Ray& ray, const Vec3f& facing = {});
  /// Grabs the first object on the ray, for hosts without picking. Returns false if the ray hits no object.
  bool grab(const Ray& ray, const Vec3f& facing = {});
  void drag(const Ray& ray);  ///< no effect without a grab
  void release();
  bool grabbing() const;
  Vec3f grabbed_point() const;  ///< current position of the grabbed point [m]; (0, 0, 0) without a grab
  Vec3f drag_target() const;    ///< position that the mouse requests for the grabbed point [m]

  // --- tunables
  int substeps() const;
  int iterations() const;
  std::string mode() const;  ///< one of `modes`
  static std::vector<std::string> modes();
  void set_substeps(int substeps);
  void set_iterations(int iterations);
  void set_mode(const std::string& mode);
  std::array<float, 3> gravity() const;  ///< m/s^2
  void set_gravity(float x, float y, float z);
  /// Parameters that have an effect in the current mode and material model.
  std::vector<Parameter> parameters(Handle object) const;
  void set_parameter(Handle object, const std::string& name, double value);
  /// Names of the presets for the object's kind.
  std::vector<std::string> presets(Handle object) const;
  void set_preset(Handle object, const std::string& name);

  // --- from any thread
  /// Queues an action for the next `advance`, which applies queued actions in order. `name` identifies the
  /// action in error messages, such as "pin"; its object may no longer exist by then.
  void post(std::string name, std::function<void(Session&)> action);
  /// Errors and notes since the last call, one sentence each; the latest 100. A step's warning appears here
  /// once; `statistics` shows it as long as it persists.
  std::vector<std::string> take_messages();
  Statistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::host
