#include "souple/files/file.h"
#include "souple/geometry/fill.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/tet_mesh.h"
#include "souple/io/animated_target.h"
#include "souple/io/recorder.h"
#include "souple/scene/build_joints.h"
#include "souple/scene/first_frame.h"
#include "souple/scene/scene.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include <fmt/core.h>

namespace souple {

namespace {

constexpr double max_grains = 4e6;

// --- converters --------------------------------------------------------------------------------------------

Quatd rotation_of(const Vec3d& degrees) {
  constexpr double radian = 0.017453292519943295;  // pi / 180
  return Quatd::from_euler_xyz(degrees * radian);
}

Transform transform_of(const TransformDescription& description) {
  return {description.translate, rotation_of(description.rotate), description.scale};
}

ColliderMotion motion_of(const std::vector<KeyframeDescription>& keyframes, bool loop) {
  std::vector<PoseKey> keys;
  keys.reserve(keyframes.size());
  for (const KeyframeDescription& keyframe : keyframes) {
    keys.push_back({keyframe.time, keyframe.translate, rotation_of(keyframe.rotate)});
  }
  return ColliderMotion::keyframes(std::move(keys), loop);
}

bool holds_tets(const std::string& file) {
  const std::string extension = lower_extension(file);
  return extension == ".msh" || extension == ".node" || extension == ".ele" || extension == ".vtk";
}

bool is_tet_mesh(const MeshDescription& mesh) {
  const FileMesh* file = std::get_if<FileMesh>(&mesh.source);
  return std::holds_alternative<TetBarMesh>(mesh.source) ||
         std::holds_alternative<TetBallMesh>(mesh.source) || (file != nullptr && holds_tets(file->file));
}

// --- meshes ------------------------------------------------------------------------------------------------

/// Builds a surface mesh: one overload per source.
struct SurfaceMaker {
  const std::filesystem::path& folder;
  const MeshImport& import;

  TriangleMesh operator()(const GridMesh& m) const { return grid(m.columns, m.rows, m.size, m.diagonals); }
  TriangleMesh operator()(const DiskMesh& m) const { return disk(m.rings, m.segments, m.radius); }
  TriangleMesh operator()(const SphereMesh& m) const { return sphere(m.subdivisions, m.radius); }
  TriangleMesh operator()(const BoxMesh& m) const { return box(m.size, m.divisions); }
  TriangleMesh operator()(const TorusMesh& m) const {
    return torus(m.major_radius, m.minor_radius, m.major_segments, m.minor_segments);
  }
  TriangleMesh operator()(const CapsuleMesh& m) const {
    return capsule(m.radius, m.length, m.segments, m.rings, m.divisions);
  }
  TriangleMesh operator()(const CylinderMesh& m) const {
    return cylinder(m.radius, m.height, m.segments, m.divisions, m.cap_rings);
  }
  TriangleMesh operator()(const TetBarMesh&) const {
    throw Error("expected a surface mesh, found a tet mesh");
  }
  TriangleMesh operator()(const TetBallMesh&) const {
    throw Error("expected a surface mesh, found a tet mesh");
  }
  TriangleMesh operator()(const FileMesh& m) const {
    if (holds_tets(m.file)) throw Error("expected a surface mesh, found a tet mesh file: " + m.file);
    return read_triangle_mesh(folder / m.file, import);
  }
};

TriangleMesh surface_of(const MeshDescription& mesh, const std::filesystem::path& folder) {
  return std::visit(SurfaceMaker{folder, mesh.import}, mesh.source);
}

TetMesh tets_of(const MeshDescription& mesh, const std::filesystem::path& folder) {
  if (const TetBarMesh* bar = std::get_if<TetBarMesh>(&mesh.source)) {
    return tet_bar(bar->cells[0], bar->cells[1], bar->cells[2], bar->size);
  }
  if (const TetBallMesh* ball = std::get_if<TetBallMesh>(&mesh.source)) {
    return tet_ball(ball->subdivisions, ball->layers, ball->radius);
  }
  return read_tet_mesh(folder / std::get<FileMesh>(mesh.source).file, mesh.import);
}

/// Converts a ShapeDescription to a Shape; most shapes need no conversion.
struct ShapeMaker {
  const std::filesystem::path& folder;

  template <class Analytic>
  Shape operator()(const Analytic& shape) const {
    return shape;
  }
  Shape operator()(const SignedDistanceFieldDescription& field) const {
    const TriangleMesh mesh = surface_of(field.mesh, folder);
    const double spacing = field.spacing.value_or(SignedDistanceField::spacing_of(mesh, field.resolution));
    return SignedDistanceField(mesh, spacing);
  }
};

// --- maps --------------------------------------------------------------------------------------------------

/// A tet mesh reduced to the data of maps: positions and groups.
TriangleMesh only_groups(const TetMesh& mesh) {
  TriangleMesh result;
  result.positions = mesh.positions;
  result.groups = mesh.groups;
  return result;
}

std::vector<float> map_values(const MapDescription& map, const TriangleMesh& mesh) {
  if (const std::string* name = std::get_if<std::string>(&map.source)) {
    return map_from_group(mesh, *name, map.value, map.fallback);
  }
  return map_from_colors(mesh, std::get<ColorChannel>(map.source), map.fallback, map.value);
}

// --- grains ------------------------------------------------------------------------------------------------

/// SplitMix64 (Steele et al. 2014): identical numbers on all platforms.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// In [-1, 1).
  double symmetric() {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    z ^= z >> 31;
    return static_cast<double>(z >> 11) * 0x1p-52 - 1;
  }

 private:
  std::uint64_t state_;
};

/// Centers origin + (i, j, k) spacing, each displaced by up to `max_offset` along each axis.
std::vector<Vec3d> cubic_lattice(const std::array<double, 3>& counts, const Vec3d& origin, double spacing,
                                 double max_offset, std::uint64_t seed) {
  if (counts[0] * counts[1] * counts[2] > max_grains) {
    throw Error(
        fmt::format("would have {} grains; at most 4000000 are allowed: enlarge the grains or the spacing",
                    counts[0] * counts[1] * counts[2]));
  }
  Random random(seed);
  std::vector<Vec3d> centers;
  for (double k = 0; k < counts[2]; ++k) {
    for (double j = 0; j < counts[1]; ++j) {
      for (double i = 0; i < counts[0]; ++i) {
        Vec3d center = origin + Vec3d{i, j, k} * spacing;
        for (int axis = 0; axis < 3; ++axis) center[axis] += max_offset * random.symmetric();
        centers.push_back(center);
      }
    }
  }
  return centers;
}

struct GrainMaker {
  const std::filesystem::path& folder;
  double radius;
  std::uint64_t seed;

  double spacing(const std::optional<double>& given, double jitter) const {
    return given ? *given : 2 * radius * (1 + jitter);
  }
  std::vector<Vec3d> operator()(const std::vector<Vec3d>& points) const { return points; }
  std::vector<Vec3d> operator()(const MeshDescription& mesh) const {
    return surface_of(mesh, folder).positions;
  }
  std::vector<Vec3d> operator()(const GrainsGrid& g) const {
    const double step = spacing(g.spacing, g.jitter);
    std::array<double, 3> counts{};
    Vec3d origin;
    for (int i = 0; i < 3; ++i) {
      counts[static_cast<std::size_t>(i)] = g.counts[static_cast<std::size_t>(i)];
      origin[i] = -0.5 * step * (counts[static_cast<std::size_t>(i)] - 1);
    }
    return cubic_lattice(counts, origin, step, g.jitter * radius, seed);
  }
  /// As many whole grains as fit into the box; the lattice is centered in it.
  std::vector<Vec3d> operator()(const GrainsBox& b) const {
    const double step = spacing(b.spacing, b.jitter), margin = radius * (1 + b.jitter);
    std::array<double, 3> counts{};
    Vec3d origin;
    for (int i = 0; i < 3; ++i) {
      const double width = b.hi[i] - b.lo[i] - 2 * margin;
      if (width < 0) throw Error(fmt::format("the box is too small for one grain of radius {} m", radius));
      const double count = std::floor(width / step + 1e-9) + 1;
      counts[static_cast<std::size_t>(i)] = count;
      origin[i] = 0.5 * (b.lo[i] + b.hi[i]) - 0.5 * step * (count - 1);
    }
    return cubic_lattice(counts, origin, step, b.jitter * radius, seed);
  }
};

// --- targets -----------------------------------------------------------------------------------------------

/// x(t) = c + R(t) (x(0) - c) + T(t)
Target keyframed(const World& world, ObjectId object, const std::vector<std::uint32_t>& vertices,
                 const PinDescription& pin) {
  const std::span<const Vec3f> positions = world.positions(object);
  Vec3d middle{};
  for (const std::uint32_t vertex : vertices) middle += Vec3d(positions[vertex]);
  middle = pin.about ? *pin.about : middle / static_cast<double>(vertices.size());
  std::vector<Vec3d> start;
  for (const Vec3f& x : positions) start.push_back(Vec3d(x));
  return [motion = motion_of(pin.keyframes, pin.loop), start = std::move(start), middle](std::uint32_t vertex,
                                                                                         double time) {
    const Transform pose = motion.at(time);
    return middle + rotate(pose.rotation, start[vertex] - middle) + pose.translation;
  };
}

/// Reads the vertices of a mesh's file, or of one object in it.
AnimatedPoints::ReadMesh read_points(const std::string& node) {
  return [node](const std::filesystem::path& path) {
    const TriangleMesh mesh = read_triangle_mesh(path, {.node = node});
    return std::vector<Vec3f>(mesh.positions.begin(), mesh.positions.end());
  };
}

/// The import options of a sequence: its own, else those of the mesh.
MeshImport sequence_import(const SequenceDescription& sequence, const MeshImport& mesh) {
  return {sequence.scale.value_or(mesh.scale), sequence.up.value_or(mesh.up), mesh.node};
}

// --- the builder -------------------------------------------------------------------------------------------

class Builder {
 public:
  Builder(const SceneDescription& scene, World& world, const SceneLog& log)
      : scene_(scene), log_(log), world_(world) {}

  void build() {
    if (log_) world_.set_log(log_);
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) add_object(i);
    for (std::size_t i = 0; i < scene_.colliders.size(); ++i) {
      inside(fmt::format("colliders[{}]", i), [&] { add_collider(scene_.colliders[i]); });
    }
    for (std::size_t i = 0; i < scene_.pairs.size(); ++i) {
      const PairDescription& pair = scene_.pairs[i];
      const std::string &a = pair.between[0], &b = pair.between[1];
      inside(fmt::format("pairs[{}]", i), [&] {
        if (pair.friction) world_.set_pair(a, b, *pair.friction, pair.restitution, pair.kinetic_friction);
        world_.set_collide(a, b, pair.collide);
      });
    }
    for (std::size_t i = 0; i < scene_.connections.size(); ++i) {
      inside(fmt::format("connections[{}]", i), [&] { connect(scene_.connections[i]); });
    }
    for (std::size_t i = 0; i < scene_.joints.size(); ++i)
      inside(fmt::format("joints[{}]", i), [&] { add_joint(scene_.joints[i], world_); });
    for (std::size_t i = 0; i < scene_.ties.size(); ++i)
      inside(fmt::format("ties[{}]", i), [&] { add_tie(scene_.ties[i], world_); });
    for (std::size_t i = 0; i < scene_.drains.size(); ++i)
      inside(fmt::format("drains[{}]", i), [&] { add_drain(scene_.drains[i]); });
    world_.leave_out_covered();
    if (log_) world_.set_log({});
  }

  void add_object(std::size_t index) {
    const std::string path = fmt::format("objects[{}]", index);
    const ObjectDescription& shared = common(scene_.objects[index]);
    ObjectId object{};
    name_ = shared.name;
    mesh_.clear();
    inside(path, [&] {
      seed_ = scene_.settings.seed * 1000003u + index;
      object = std::visit([&](const auto& kind) { return add(kind); }, scene_.objects[index]);
    });
    for (std::size_t i = 0; i < shared.pins.size(); ++i) {
      inside(fmt::format("{}.pins[{}]", path, i), [&] {
        const PinDescription& pin = shared.pins[i];
        world_.pin(object, pin.where, target(object, pin, scene_.objects[index]));
      });
    }
    for (std::size_t i = 0; i < shared.attachments.size(); ++i) {
      inside(fmt::format("{}.attachments[{}]", path, i), [&] {
        const AttachmentDescription& attachment = shared.attachments[i];
        world_.attach(object, attachment.where, target(object, attachment, scene_.objects[index]),
                      attachment.compliance);
      });
    }
    world_.set_wind_exposure(object, shared.wind_exposure);
    // After the pins: tethers start at pins.
    inside(path, [&] { std::visit([&](const auto& kind) { finish(object, kind); }, scene_.objects[index]); });
    remark_on_size(object, scene_.objects[index]);
  }

 private:
  /// Prepends the path in the scene to an error.
  template <class F>
  void inside(const std::string& path, F f) {
    try {
      f();
    } catch (const Error& error) {
      throw Error(scene_.source + ": " + path + ": " + error.what());
    }
  }

  /// Most often, a file in centimeters or millimeters.
  void remark_on_size(ObjectId object, const AnyObjectDescription& description) const {
    constexpr double largest = 50, smallest = 1e-3;  // m
    if (!log_) return;
    // Points of the mesh rather than of an animation's first frame.
    std::vector<Vec3d> points = world_.mesh(object).positions;
    const std::span<const Vec3f> positions = world_.positions(object);
    if (points.empty()) points = std::vector<Vec3d>(positions.begin(), positions.end());
    if (points.size() < 2) return;
    const Vec3d sides = bounding_box(points).size();
    const double size = std::max({sides.x, sides.y, sides.z});
    if (size <= largest && size >= smallest) return;
    const bool is_file = std::visit([](const auto& kind) { return has_mesh_file(kind); }, description);
    log_(LogLevel::warning, fmt::format("{}: is {:.3g} m large; if it should not be, {}", name_, size,
                                        is_file ? "set \"scale\" of its mesh: meters per unit of the file"
                                                : "note that lengths are in meters"));
  }

  static bool is_file(const MeshDescription& mesh) { return std::holds_alternative<FileMesh>(mesh.source); }
  template <class Description>
  static bool has_mesh_file(const Description& description) {
    if constexpr (requires { description.mesh; }) return is_file(description.mesh);
    return false;
  }

  // --- objects

  ObjectOptions options_of(const ObjectDescription& object) const {
    ObjectOptions options;
    options.name = object.name;
    options.transform = transform_of(object.transform);
    options.velocity = object.velocity;
    options.angular_velocity = object.angular_velocity;
    options.self_collision = object.self_collision;
    options.layer = object.layer;
    options.collision_groups = object.collision.groups;
    options.collision_mask = object.collision.mask;
    return options;
  }

  void read_maps(const MapsDescription& maps, const TriangleMesh& mesh, ObjectOptions& options) {
    if (maps.stiffness) options.stiffness_map = map_values(*maps.stiffness, mesh);
    if (maps.thickness) options.thickness_map = map_values(*maps.thickness, mesh);
    pin_weights_.clear();
    if (maps.pin_weight) pin_weights_ = map_values(*maps.pin_weight, mesh);
  }

  ObjectId add(const ClothDescription& cloth) {
    const TriangleMesh mesh = surface_of(cloth.mesh, scene_.folder);
    mesh_ = mesh.positions;
    if (cloth.pattern && !cloth.pattern->file.empty() && mesh.uvs.empty())
      throw Error(
          "pattern: the mesh has no UVs, which place a picture on it; export the mesh with UVs, or name a "
          "pattern");
    ObjectOptions options = options_of(cloth);
    read_maps(cloth.maps, mesh, options);
    return world_.add_cloth(mesh, cloth.material, options);
  }

  ObjectId add(const SoftBodyDescription& body) {
    ObjectOptions options = options_of(body);
    if (is_tet_mesh(body.mesh)) {
      if (body.lattice) throw Error("lattice: is valid only for a surface mesh; this is a tet mesh");
      const TetMesh mesh = tets_of(body.mesh, scene_.folder);
      mesh_ = mesh.positions;
      read_maps(body.maps, only_groups(mesh), options);
      return world_.add_soft_body(mesh, body.material, options);
    }
    const TriangleMesh mesh = surface_of(body.mesh, scene_.folder);
    mesh_ = mesh.positions;
    read_maps(body.maps, mesh, options);
    return world_.add_soft_body(mesh, body.material, body.lattice.value_or(LatticeOptions{}), options);
  }

  ObjectId add(const RopeDescription& rope) {
    return world_.add_rope(rope.points, rope.segments, rope.material, options_of(rope));
  }

  ObjectId add(const GrainsDescription& grains) {
    const GrainMaker maker{scene_.folder, static_cast<double>(grains.material.radius), seed_};
    return world_.add_grains(std::visit(maker, grains.centers), grains.material, options_of(grains));
  }

  ObjectId add(const FluidDescription& fluid) {
    ObjectOptions options = options_of(fluid);
    options.max_particles = fluid.max_particles;
    if (const auto* mesh = std::get_if<MeshDescription>(&fluid.filling))
      return world_.add_fluid(surface_of(*mesh, scene_.folder), fluid.material, options);
    if (const auto* points = std::get_if<std::vector<Vec3d>>(&fluid.filling))
      return world_.add_fluid(*points, fluid.material, options);
    const auto& box = std::get<FluidBox>(fluid.filling);
    return world_.add_fluid(fill(box.lo, box.hi, static_cast<double>(fluid.material.spacing)), fluid.material,
                            options);
  }

  ObjectId add(const RigidBodyDescription& body) {
    ObjectOptions options = options_of(body);
    options.given_mass.mass = body.mass;
    options.given_mass.center = body.center_of_mass;
    if (body.inertia) options.given_mass.inertia = Mat3d::diagonal(*body.inertia);
    const ObjectId object = add_solid(body, options);
    if (!body.keyframes.empty()) {
      world_.set_motion(object, {.pose = motion_of(body.keyframes, body.loop)});
    } else if (body.kinematic) {
      world_.set_kinematic(object, true);
    }
    return object;
  }

  ObjectId add_solid(const RigidBodyDescription& body, const ObjectOptions& options) {
    const ShapeMaker maker{scene_.folder};
    if (const auto* mesh = std::get_if<MeshDescription>(&body.solid)) {
      const TriangleMesh surface = surface_of(*mesh, scene_.folder);
      mesh_ = surface.positions;
      return world_.add_rigid_body(surface, body.material, options);
    }
    if (const auto* shape = std::get_if<ShapeDescription>(&body.solid))
      return world_.add_rigid_body(std::visit(maker, *shape), body.material, options);
    std::vector<RigidPart> parts;
    for (const RigidPartDescription& part : std::get<std::vector<RigidPartDescription>>(body.solid))
      parts.push_back({std::visit(maker, part.shape), transform_of(part.transform), part.density});
    return world_.add_rigid_body(parts, body.material, options);
  }

  ObjectId add(const ObstacleDescription& obstacle) {
    ObstacleMotion motion;
    if (!obstacle.keyframes.empty()) motion.pose = motion_of(obstacle.keyframes, obstacle.loop);
    const TriangleMesh mesh = surface_of(obstacle.mesh, scene_.folder);
    mesh_ = mesh.positions;
    if (obstacle.sequence)
      motion.sequence =
          read_sequence(*obstacle.sequence, sequence_import(*obstacle.sequence, obstacle.mesh.import));
    return world_.add_obstacle(mesh, obstacle.material, std::move(motion), options_of(obstacle));
  }

  /// Warns if the first frame of an animation is the object's mesh in other axes or units.
  void compare_first_frame(AnimatedPoints& points, const std::string& file, const MeshImport& import) const {
    if (!log_ || points.points() != mesh_.size()) return;
    std::vector<Vec3f> frame(mesh_.size());
    points.evaluate(points.start_time(), frame);
    const std::string remark = first_frame_remark(mesh_, frame, import);
    if (!remark.empty())
      log_(LogLevel::warning, fmt::format("{}: the first frame of {} {}", name_, file, remark));
  }

  MeshSequence read_sequence(const SequenceDescription& description, const MeshImport& import) const {
    const std::size_t vertices = mesh_.size();
    try {
      AnimatedPoints points(
          scene_.folder / description.file,
          {.frame_rate = description.frame_rate, .animation = description.animation, .node = import.node},
          read_points(import.node));
      if (points.points() != vertices)
        throw Error(fmt::format("{} has {} vertices, but the mesh has {}", description.file, points.points(),
                                vertices));
      compare_first_frame(points, description.file, import);
      MeshSequence sequence{.start_time = description.start_time, .loop = description.loop};
      for (const double time : points.times()) {
        std::vector<Vec3f>& frame = sequence.frames.emplace_back(vertices);
        points.evaluate(time, frame);
        for (Vec3f& x : frame) x = Vec3f(imported(Vec3d(x), import));
        sequence.times.push_back(time);
      }
      return sequence;
    } catch (const Error& error) {
      throw Error(std::string("sequence: ") + error.what());
    }
  }

  void finish(ObjectId object, const FluidDescription& fluid) {
    for (const EmitterDescription& description : fluid.emitters) {
      Emitter emitter{.position = description.position,
                      .direction = description.direction,
                      .radius = description.radius,
                      .speed = description.speed,
                      .start = description.start};
      if (description.end) emitter.end = *description.end;
      if (!description.keyframes.empty()) emitter.motion = motion_of(description.keyframes, description.loop);
      world_.add_emitter(object, emitter);
    }
  }

  void finish(ObjectId object, const ClothDescription& cloth) {
    pin_by_weight(object, cloth.maps);
    if (cloth.tethers) world_.add_tethers(object, cloth.tethers->slack);
    if (cloth.pressure) world_.set_pressure(object, *cloth.pressure);
    if (cloth.enclosed_volume) {
      world_.set_enclosed_volume(object, cloth.enclosed_volume->factor, cloth.enclosed_volume->compliance);
    }
  }
  void finish(ObjectId object, const SoftBodyDescription& body) { pin_by_weight(object, body.maps); }
  void finish(ObjectId object, const RopeDescription& rope) {
    if (rope.tethers) world_.add_tethers(object, rope.tethers->slack);
  }
  template <class Description>
  void finish(ObjectId, const Description&) {}

  /// Weight 1 is a pin; w < 1 is a spring of compliance (1 - w) / w times that of weight 1/2. Weights are
  /// rounded to 255 steps, as in colors; vertices of one step share a projector.
  void pin_by_weight(ObjectId object, const MapsDescription& maps) {
    if (!maps.pin_weight) return;
    constexpr std::size_t steps = 255;
    std::vector<std::vector<std::uint32_t>> of_step(steps + 1);
    for (std::size_t vertex = 0; vertex < pin_weights_.size(); ++vertex) {
      const float weight = std::clamp(pin_weights_[vertex], 0.0f, 1.0f);
      const auto step = static_cast<std::size_t>(std::lround(weight * static_cast<float>(steps)));
      of_step[step].push_back(static_cast<std::uint32_t>(vertex));
    }
    if (!of_step[steps].empty()) world_.pin(object, vertices(of_step[steps]));
    for (std::size_t step = 1; step < steps; ++step) {
      if (of_step[step].empty()) continue;
      const float w = static_cast<float>(step) / static_cast<float>(steps);
      world_.attach(object, vertices(of_step[step]), {}, maps.pin_weight->compliance * (1 - w) / w);
    }
  }

  // --- pins

  /// Empty: the vertices stay at their start positions.
  Target target(ObjectId object, const PinDescription& pin, const AnyObjectDescription& description) const {
    if (pin.sequence) return sequence_target(object, pin, description);
    if (pin.keyframes.empty()) return {};
    return keyframed(world_, object, world_.select(object, pin.where), pin);
  }

  /// Index of each vertex among those that a run's files hold; empty if these are all. A pinned vertex must be
  /// one of them.
  std::vector<std::uint32_t> point_of_vertices(ObjectId object, const PinDescription& pin,
                                               std::size_t points) const {
    const std::size_t vertices = world_.positions(object).size();
    if (points == vertices) return {};
    const std::vector<std::uint32_t> recorded = recorded_vertices(world_, object);
    if (points != recorded.size()) {
      throw Error(fmt::format("sequence: {} has {} vertices, but the object has {}", pin.sequence->file,
                              points, vertices));
    }
    constexpr std::uint32_t none = ~std::uint32_t(0);
    std::vector<std::uint32_t> point_of(vertices, none);
    for (std::uint32_t i = 0; i < recorded.size(); ++i) point_of[recorded[i]] = i;
    for (const std::uint32_t vertex : world_.select(object, pin.where)) {
      if (point_of[vertex] != none) continue;
      throw Error(fmt::format("sequence: {} has the {} vertices on the surface, and vertex {} is inside",
                              pin.sequence->file, points, vertex));
    }
    return point_of;
  }

  Target sequence_target(ObjectId object, const PinDescription& pin,
                         const AnyObjectDescription& description) const {
    const SequenceDescription& sequence = *pin.sequence;
    const MeshImport import = sequence_import(sequence, import_of(description));
    const AnimatedPoints::Options options{sequence.frame_rate, sequence.start_time, sequence.animation,
                                          import.node, sequence.loop};
    AnimatedPoints points(scene_.folder / sequence.file, options, read_points(import.node));
    std::vector<std::uint32_t> point_of =
        point_of_vertices(object, pin, static_cast<std::size_t>(points.points()));
    compare_first_frame(points, sequence.file, import);
    return [target = animated_target(std::make_shared<AnimatedPoints>(std::move(points))),
            point_of = std::move(point_of), import,
            transform = transform_of(common(description).transform)](std::uint32_t vertex, double time) {
      const Vec3d x = target(point_of.empty() ? vertex : point_of[vertex], time);
      return transform.point(imported(x, import));
    };
  }

  static MeshImport import_of(const AnyObjectDescription& object) {
    if (const auto* cloth = std::get_if<ClothDescription>(&object)) return cloth->mesh.import;
    if (const auto* body = std::get_if<SoftBodyDescription>(&object)) return body->mesh.import;
    return {};
  }

  // --- colliders, connections, drains

  void add_collider(const ColliderDescription& collider) {
    ColliderOptions options;
    options.friction = collider.friction;
    options.kinetic_friction = collider.kinetic_friction;
    options.collision_groups = collider.collision.groups;
    options.collision_mask = collider.collision.mask;
    options.restitution = collider.restitution;
    options.sensor = collider.sensor;
    options.name = collider.name;
    options.motion = collider.keyframes.empty() ? ColliderMotion::fixed(transform_of(collider.transform))
                                                : motion_of(collider.keyframes, collider.loop);
    world_.add_collider(std::visit(ShapeMaker{scene_.folder}, collider.shape), options);
  }

  /// Vertices of one end; listed vertices keep the order of the list.
  std::vector<VertexRef> end(const EndDescription& description) const {
    const ObjectId object = world_.find_object(description.object);
    std::vector<std::uint32_t> chosen = world_.select(object, description.where);
    if (const auto* listed = std::get_if<Selector::Vertices>(&description.where.choice))
      chosen = listed->indices;
    std::vector<VertexRef> ends;
    ends.reserve(chosen.size());
    for (const std::uint32_t vertex : chosen) ends.push_back({object, vertex});
    return ends;
  }

  VertexRef nearest_of(const std::vector<VertexRef>& candidates, const VertexRef& to) const {
    const Vec3d x(world_.positions(to.object)[to.vertex]);
    VertexRef best = candidates.front();
    double least = std::numeric_limits<double>::infinity();
    for (const VertexRef& candidate : candidates) {
      const double d = length_squared(Vec3d(world_.positions(candidate.object)[candidate.vertex]) - x);
      const bool same = candidate.object == to.object && candidate.vertex == to.vertex;
      if (!same && d < least) least = d, best = candidate;
    }
    return best;
  }

  void add_drain(const DrainDescription& description) {
    Drain drain{.shape = std::visit(ShapeMaker{scene_.folder}, description.shape),
                .pose = transform_of(description.transform),
                .start = description.start};
    if (description.rate) drain.rate = *description.rate;
    if (description.end) drain.end = *description.end;
    world_.add_drain(drain);
  }

  void connect(const ConnectionDescription& connection) {
    const std::vector<VertexRef> from = end(connection.from), to = end(connection.to);
    const bool in_order = connection.pairing == Pairing::in_order;
    if (in_order && from.size() != to.size() && from.size() != 1 && to.size() != 1) {
      throw Error(
          fmt::format("\"from\" selects {} vertices and \"to\" {}; pairing \"in_order\" needs equal numbers, "
                      "or one vertex on one side; use pairing \"nearest\" otherwise",
                      from.size(), to.size()));
    }
    std::vector<std::pair<VertexRef, VertexRef>> pairs;
    const std::size_t count = in_order ? std::max(from.size(), to.size()) : from.size();
    for (std::size_t i = 0; i < count; ++i) {
      const VertexRef& a = from[from.size() == 1 ? 0 : i];
      pairs.emplace_back(a, in_order ? to[to.size() == 1 ? 0 : i] : nearest_of(to, a));
    }
    world_.connect(pairs, connection.rest_length.value_or(-1), connection.compliance, connection.until);
  }

  const SceneDescription& scene_;
  const SceneLog& log_;
  World& world_;
  std::uint64_t seed_ = 0;
  // Data of the current object:
  std::string name_;
  std::vector<Vec3d> mesh_;  ///< vertices in meters before the transform; empty without a mesh
  std::vector<float> pin_weights_;
};

}  // namespace

std::string_view shape_name(const ShapeDescription& shape) {
  if (std::holds_alternative<SignedDistanceFieldDescription>(shape)) return "signed_distance_field";
  return std::visit(
      [](const auto& one) -> std::string_view {
        if constexpr (std::is_constructible_v<Shape, decltype(one)>)
          return souple::shape_name(Shape(one));
        else
          return {};
      },
      shape);
}

World build_world(const SceneDescription& scene, const SceneLog& log) {
  World world(scene.settings);
  Builder(scene, world, log).build();
  return world;
}

void add_to_world(const SceneDescription& scene, std::size_t object, World& world) {
  Builder(scene, world, {}).add_object(object);
}

}  // namespace souple
