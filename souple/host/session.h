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

// All that a renderer's plugin needs; see docs/embedding.md. No header of this folder needs C++20.

namespace souple::host {

/// Names an object of a session; never used again for another, also after another scene is opened. 0: none.
using Handle = std::uint32_t;

enum class Kind { cloth, soft_body, rope, grains, obstacle, fluid };
const char* kind_name(Kind kind);

struct ObjectInfo {
  Handle handle = 0;
  std::string name;  ///< unique in the session
  Kind kind = Kind::cloth;
  std::size_t vertex_count = 0;    ///< that `write` fills: render vertices, or those of the scene's mesh
  std::size_t triangle_count = 0;  ///< 0 of ropes, grains and fluids
  float radius = 0;                ///< of ropes, grains and fluids; half the thickness of the others [m]
  bool from_scene = false;         ///< rather than from a mesh of the host
  bool has_color = false;          ///< the scene file gives one
  std::array<float, 3> color{};    ///< R, G, B in [0, 1], sRGB as in scene files, not linear light
};

/// What a scene's collider (plane, sphere, box, ...) looks like.
struct ColliderShape {
  std::string name;
  std::vector<float> positions, normals;  ///< x, y, z of each vertex, in the collider's own frame [m]
  std::vector<std::uint32_t> indices;     ///< three a triangle, counter-clockwise from outside
  bool has_color = false;                 ///< the scene file gives one
  std::array<float, 3> color{};           ///< as of ObjectInfo
};

/// How a mesh of the host becomes an object.
struct MeshOptions {
  std::string name;                  ///< unique; empty: the kind, then kind2, ...
  const float* transform = nullptr;  ///< 4 x 4, column-major, mesh to world; copied. nullptr: none
  double weld_tolerance = 0;         ///< see VertexWelder
  std::string preset;                ///< "cotton", "jelly", ...; empty: the kind's default material
  bool self_collision = false;       ///< of cloth
  std::size_t lattice_tets = 2000;   ///< of soft bodies: about as many tets carry the surface
};

/// One number of a material, for a slider.
struct Parameter {
  std::string name;   ///< as in scene files
  std::string label;  ///< for people
  std::string unit;   ///< UTF-8, may be empty
  double value = 0, least = 0, most = 1;
  bool logarithmic = false;  ///< its slider; least > 0 then, and a value of 0 stands at the left end
};

/// What the last step did, as numbers.
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
  std::string warnings;        ///< what the step wants to be known, one sentence each with what mends it

  std::string text() const;  ///< a few lines for a panel
};

/// A world that somebody else's program drives: its clock, its meshes, its mouse.
///
/// Each frame the host calls `advance` and then `write` for what it shows. All functions but `advance` throw
/// Error, one sentence, and then leave the session as it was. Only `post`, `take_messages` and `statistics`
/// may be called by another thread meanwhile; all others by one thread at a time.
class Session {
 public:
  explicit Session(const ClockOptions& clock = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // --- what is in it
  /// Opens a scene file in the place of all that was there.
  void open_scene(const std::string& file);
  /// Removes everything; the settings become the defaults.
  void clear();
  /// Adds at the present moment of the world. After a reset it is there from the start.
  Handle add_cloth(const TriangleSoup& soup, const MeshOptions& options = {});
  /// Of a closed surface, carried by a lattice of tets.
  Handle add_soft_body(const TriangleSoup& soup, const MeshOptions& options = {});
  /// What others touch and nothing moves. Its preset is none.
  Handle add_obstacle(const TriangleSoup& soup, const MeshOptions& options = {});
  /// Takes an object out, at any time; what holds it lets go. A reset does not bring it back.
  void remove(Handle object);
  bool contains(Handle object) const;
  ObjectInfo object(Handle object) const;
  std::vector<ObjectInfo> objects() const;  ///< in the order they were added
  /// The host moved its mesh. An obstacle goes there in the course of the next step and takes along what it
  /// touches; it can only be turned and moved against how it was added. The particles of the others stay
  /// where they are in the world: only what `write` writes is another.
  void set_transform(Handle object, const float* transform);
  /// Holds a vertex where it is, or lets it go; also after a reset.
  void set_pinned(Handle object, std::uint32_t vertex, bool pinned);

  // --- time
  /// A frame of the host: its animation time and the frame's length [s]. Applies what was posted, then does
  /// nothing, a step or a reset as Clock says, and returns what it did. Does not throw: what fails is told by
  /// `take_messages`, and a step or a reset that cannot be done pauses and leaves the world as it was.
  Tick advance(double host_time, double frame_dt);
  /// While paused, the host's time makes no steps. A new session plays.
  void set_playing(bool playing);
  bool playing() const;
  /// The next `advance` makes a step whether or not the host's time goes on, and pauses.
  void request_step();
  /// Back to the start with all objects, materials, pins and settings as they are now, and meshes of the host
  /// where it has them now.
  void reset();
  /// The host's time stands here [s]; see Clock::start_at.
  void start_at(double host_time);
  double time() const;            ///< simulated [s]
  std::uint64_t steps() const;    ///< since the start or the last reset
  std::uint64_t version() const;  ///< grows whenever what `write` writes may be another
  /// Of all positions and velocities, as World::hash.
  std::uint64_t hash() const;

  // --- what is drawn
  /// The object's vertices into buffers of `vertex_count` vertices, in the coordinates of the host's mesh;
  /// those of a scene's object in the world's, with welded normals. Ropes and grains have no normals.
  void write(Handle object, const VertexBuffers& buffers, std::size_t vertex_count,
             Normals normals = Normals::welded);
  /// Three vertex indices a triangle.
  std::vector<std::uint32_t> triangles(Handle object) const;
  /// Two vertex indices a segment of a rope, from its begin to its end; empty for others.
  std::vector<std::uint32_t> segments(Handle object) const;
  /// The scene's colliders, for once: they are rigid, and change only when a scene is opened. A plane is a
  /// square of 2 `extent` [m] about the point nearest to the world's origin.
  std::vector<ColliderShape> colliders(double extent = 10) const;
  /// Where each of them is now, in the same order: 4 x 4, column-major, from its own frame to the world.
  std::vector<std::array<float, 16>> collider_transforms() const;

  // --- the mouse; rays are in the world's coordinates [m]
  /// Takes hold of a render vertex, to be dragged along the plane through it across the view (DragPlane), and
  /// lets go of what was held before. False when it is pinned or of an obstacle: nothing is held then.
  bool grab_vertex(Handle object, std::uint32_t vertex, const Ray& ray, const Vec3f& facing = {});
  /// The same where the ray meets the plane of a triangle.
  bool grab_triangle(Handle object, std::uint32_t triangle, const Ray& ray, const Vec3f& facing = {});
  /// The same of whatever the ray meets first, for hosts that cannot pick. False when that is nothing.
  bool grab(const Ray& ray, const Vec3f& facing = {});
  void drag(const Ray& ray);  ///< does nothing unless something is held
  void release();
  bool grabbing() const;
  Vec3f grabbed_point() const;  ///< where it is now [m]; (0, 0, 0) when nothing is held
  Vec3f drag_target() const;    ///< and where the mouse wants it [m]

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
  /// Those that turn something with the present mode and model.
  std::vector<Parameter> parameters(Handle object) const;
  void set_parameter(Handle object, const std::string& name, double value);
  /// Names that fit the object's kind.
  std::vector<std::string> presets(Handle object) const;
  void set_preset(Handle object, const std::string& name);

  // --- from any thread
  /// Waits for the next `advance`, which applies what was posted in order. `name` says in messages what
  /// failed, such as "pin": its object may be gone by then.
  void post(std::string name, std::function<void(Session&)> action);
  /// What went wrong or is worth knowing since the last call, one sentence each; the latest 100. A step's
  /// warning comes once, and stands in `statistics` for as long as it lasts.
  std::vector<std::string> take_messages();
  Statistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::host
