#include "render/display.h"

#include "render/body_drawing.h"
#include "render/constraint_lines.h"
#include "render/joint_lines.h"
#include "render/legend.h"
#include "render/looks.h"
#include "render/rope_strain.h"
#include "souple/collision/collider_mesh.h"
#include "souple/math/fnv1a.h"
#include "souple/objects/kind_traits.h"
#include "souple/world/debug_draw.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <tuple>

#include <fmt/core.h>

namespace souple::render {
namespace {

constexpr std::array<std::string_view, display_count> display_names{
    "shaded", "plain", "wireframe", "strain", "speed", "particles", "lattice", "normals", "contacts"};
constexpr std::array<std::string_view, constraint_display_count> constraint_display_names{
    "none", "kind", "color", "strain", "residual"};
constexpr std::array<std::string_view, splat_shape_count> splat_shape_names{"spheres", "ellipsoids"};

const PackedColor against_collider = pack(srgb(0xd9480f)), against_object = pack(srgb(0x1864ab)),
                  lattice_ink = pack(srgb(0x37474f));

/// A unique range of keys for each drawing: one renderer may draw several subjects.
std::uint64_t next_key_base() {
  static std::atomic<std::uint64_t> drawings{0};
  return ++drawings << 32;
}

/// A collider and the mesh of its shape.
struct ColliderDrawing {
  std::uint64_t key = 0, topology = 0;
  Shape shape{};
  ColliderMesh mesh;
};

struct SameShape {
  const Shape& other;

  bool operator()(const Plane& a) const {
    const auto* b = std::get_if<Plane>(&other);
    return b && a.normal == b->normal && a.offset == b->offset;
  }
  bool operator()(const Sphere& a) const {
    const auto* b = std::get_if<Sphere>(&other);
    return b && a.center == b->center && a.radius == b->radius;
  }
  bool operator()(const Box& a) const {
    const auto* b = std::get_if<Box>(&other);
    return b && a.center == b->center && a.half_extents == b->half_extents;
  }
  bool operator()(const Capsule& a) const {
    const auto* b = std::get_if<Capsule>(&other);
    return b && a.center == b->center && a.radius == b->radius && a.half_height == b->half_height;
  }
  bool operator()(const Cylinder& a) const {
    const auto* b = std::get_if<Cylinder>(&other);
    return b && a.center == b->center && a.radius == b->radius && a.half_height == b->half_height;
  }
  bool operator()(const SignedDistanceField& a) const {
    const auto* b = std::get_if<SignedDistanceField>(&other);
    return b && a == *b;
  }
};

/// The height of a plane that is currently a level floor; empty otherwise.
std::optional<float> floor_height(const ColliderBody& collider) {
  const auto* plane = std::get_if<Plane>(collider.shape);
  if (!plane) return {};
  const Vec3d n(plane->normal);
  const Vec3d up = normalized(collider.pose.direction(n));
  if (up.y < 1 - 1e-9) return {};
  return static_cast<float>(
      collider.pose.point(n * (static_cast<double>(plane->offset) / length_squared(n))).y);
}

/// Edge of the floor's slabs: 1, 2 or 5 times a power of ten, so that it gives scale. Scenes of a few meters get 0.5 m.
float tile_for(float radius) {
  const float wanted = 0.3f * std::clamp(radius, 1e-3f, 1e4f);
  const float ten = std::pow(10.0f, std::floor(std::log10(wanted))), part = wanted / ten;
  return ten * (part < 1.5f ? 1.0f : (part < 3.5f ? 2.0f : (part < 7.5f ? 5.0f : 10.0f)));
}

}  // namespace

std::string_view display_name(Display display) {
  return display_names[static_cast<std::size_t>(display)];
}

std::string_view constraint_display_name(ConstraintDisplay display) {
  return constraint_display_names[static_cast<std::size_t>(display)];
}

std::string_view splat_shape_name(SplatShape shape) {
  return splat_shape_names[static_cast<std::size_t>(shape)];
}

struct SubjectDrawing::Impl {
  DrawList list;
  /// Workers start with the first task.
  std::unique_ptr<Threads> threads = make_threads(Threading::automatic, 0);
  HeatScale heat;
  Legend legend;
  std::uint64_t next_key = next_key_base();
  std::optional<std::uint64_t> topology;               ///< topology of the last subject
  std::uint32_t next_index = 0;                        ///< color index of the next object
  std::map<std::uint32_t, BodyDrawing> bodies;         ///< by Body::id
  std::map<std::uint32_t, ColliderDrawing> colliders;  ///< by ColliderBody::id
  Bounds scene;                                        ///< bounds when an object was last added or removed
  std::uint64_t pins_key = 0, pins_version = 0, contacts_key = 0, contacts_version = 0;
  std::vector<Vec3f> pins, contact_points;
  std::vector<float> pin_radii;
  std::vector<PackedColor> contact_colors;
  std::vector<std::vector<float>> rope_strain;  ///< per body, per point

  std::uint64_t allocate_key() { return next_key += 2; }
  float size() const { return std::max(scene.radius(), 1e-3f); }

  void start(const Subject& subject);
  void update_bodies(const Subject& subject);
  void update_colliders(const Subject& subject);
  void gather_particles(const Subject& subject, const DrawContext& drawing);
  void draw_colliders(const Subject& subject, const DisplayOptions& options);
  void draw_collider(const ColliderBody& collider, std::uint32_t pick);
  void draw_pins(const Subject& subject);
  void draw_lattice(const World& world);
  void draw_contacts(const World& world);
  void explain(const Subject& subject, const DisplayOptions& options);
  void update(const Subject& subject, const DisplayOptions& options);
};

/// Starts with another world. The first color depends on the first object's name: otherwise the first cloth
/// of every scene would be blue.
void SubjectDrawing::Impl::start(const Subject& subject) {
  topology = subject.topology;
  bodies.clear();
  colliders.clear();
  scene = {};
  next_index =
      subject.bodies.empty() ? 0 : static_cast<std::uint32_t>(fnv1a64(subject.bodies[0].name) >> 16 & 7);
}

/// Creates drawings for new objects and removes those of deleted objects.
void SubjectDrawing::Impl::update_bodies(const Subject& subject) {
  bool changed = false;
  std::map<std::uint32_t, BodyDrawing> present;
  for (const Body& body : subject.bodies) {
    auto known = bodies.extract(body.id);
    if (known && known.mapped().fits(body)) {
      present.insert(std::move(known));
      continue;
    }
    changed = true;
    present.try_emplace(body.id, body, next_index++, allocate_key());
  }
  changed = changed || !bodies.empty();
  bodies = std::move(present);
  if (!changed) return;
  scene = {};
  for (const Body& body : subject.bodies) scene.add(bodies.at(body.id).bounds(body));
}

void SubjectDrawing::Impl::update_colliders(const Subject& subject) {
  std::map<std::uint32_t, ColliderDrawing> present;
  for (const ColliderBody& collider : subject.colliders) {
    auto known = colliders.extract(collider.id);
    ColliderDrawing drawing;
    if (known) drawing = std::move(known.mapped());
    if (drawing.key == 0) drawing.key = allocate_key();
    if (drawing.topology == 0 || !std::visit(SameShape{*collider.shape}, drawing.shape)) {
      drawing.shape = *collider.shape;
      const Vec3d center =
          rotate(conjugate(collider.pose.rotation),
                 Vec3d(scene.empty() ? Vec3f{} : scene.center()) - collider.pose.translation);
      drawing.mesh = collider_mesh(drawing.shape, center, std::max(4.0 * static_cast<double>(size()), 1.0));
      ++drawing.topology;
    }
    present.try_emplace(collider.id, std::move(drawing));
  }
  colliders = std::move(present);
}

/// The particles of a world are not the vertices; those of soft bodies lie inside.
void SubjectDrawing::Impl::gather_particles(const Subject& subject, const DrawContext& drawing) {
  const Display display = drawing.options.display;
  if (!subject.world || (display != Display::particles && display != Display::lattice)) return;
  for (auto& [id, body] : bodies) body.particles().clear();
  DebugDraw draw;
  draw.particle = [&](const DebugParticle& particle) {
    const auto found = bodies.find(particle.object);
    if (found == bodies.end() || !found->second.draws_particles(drawing)) return;
    ParticleCloud& cloud = found->second.particles();
    cloud.centers.push_back(particle.position);
    // Thin cloth would be hardly visible. Lattice nodes outside the embedded surface have negative radii: the
    // surface is in contact before they are.
    const float dot = 0.006f * size();
    const float least = particle.radius > 0 ? 0.12f * found->second.mean_edge() : dot;
    cloud.radii.push_back(display == Display::lattice ? dot : std::max(particle.radius, least));
  };
  subject.world->debug_draw(draw);
}

void SubjectDrawing::Impl::draw_collider(const ColliderBody& collider, std::uint32_t pick) {
  const ColliderDrawing& drawing = colliders.at(collider.id);
  Surface surface;
  surface.key = drawing.key;
  surface.topology = surface.version = drawing.topology;
  surface.positions = drawing.mesh.positions;
  surface.normals = drawing.mesh.normals;
  surface.triangles = drawing.mesh.triangles;
  surface.pose = collider.pose;
  surface.look = collider.glass ? glass_look(collider.color) : collider_look(collider.color);
  // A tank's walls are seen from inside only: the front walls do not hide its content.
  surface.one_sided = std::holds_alternative<Plane>(*collider.shape);
  surface.pick = pick;
  list.surfaces.push_back(surface);
}

/// The first level floor is drawn as the ground, every other collider as a mesh.
void SubjectDrawing::Impl::draw_colliders(const Subject& subject, const DisplayOptions& options) {
  list.ground = {};
  list.ground.shown = false;
  if (!options.colliders) return;
  auto pick = static_cast<std::uint32_t>(subject.bodies.size());
  for (const ColliderBody& collider : subject.colliders) {
    ++pick;
    const std::optional<float> height = floor_height(collider);
    if (!height || list.ground.shown) {
      draw_collider(collider, pick);
      continue;
    }
    list.ground.shown = true;
    list.ground.height = *height;
    std::tie(list.ground.color, list.ground.second) = floor_colors(collider.color);
    list.ground.tile = tile_for(size());
  }
}

void SubjectDrawing::Impl::draw_pins(const Subject& subject) {
  std::vector<Vec3f> centers;
  pin_radii.clear();
  for (const Body& body : subject.bodies) {
    const ObjectShape shape = traits_of(body.kind).shape;
    const bool balls = shape == ObjectShape::line || shape == ObjectShape::balls;
    const float radius =
        balls ? 1.5f * body.radius : std::min(0.3f * bodies.at(body.id).mean_edge(), 0.011f * size());
    for (const std::uint32_t v : subject.world->pinned({body.id})) {
      centers.push_back(body.positions[v]);
      pin_radii.push_back(radius);
    }
  }
  if (centers.empty()) return;
  if (pins_key == 0) pins_key = allocate_key();
  if (centers != pins) {
    pins = std::move(centers);
    ++pins_version;
  }
  list.spheres.push_back(
      {.key = pins_key, .version = pins_version, .centers = pins, .radii = pin_radii, .look = pin_look()});
}

void SubjectDrawing::Impl::draw_lattice(const World& world) {
  DebugDraw draw;
  draw.tet_edge = [&](const Vec3f& a, const Vec3f& b) { list.lines.push_back({a, b, lattice_ink, 1.2f}); };
  world.debug_draw(draw);
  legend.title(fmt::format("lattice: {} edges of tets", list.lines.size()));
}

/// Lines along the contact normals, of length proportional to the square root of the impulse, starting from a
/// small ball.
void SubjectDrawing::Impl::draw_contacts(const World& world) {
  float max_impulse = 0;
  std::array<std::size_t, 2> count{};
  for (const ContactEvent& event : world.contacts()) max_impulse = std::max(max_impulse, event.impulse);
  contact_points.clear();
  contact_colors.clear();
  for (const ContactEvent& event : world.contacts()) {
    const PackedColor color = event.other_is_collider ? against_collider : against_object;
    const float fraction = max_impulse > 0 ? std::sqrt(std::max(event.impulse, 0.0f) / max_impulse) : 0;
    const float reach = size() * (0.02f + 0.13f * fraction);
    list.top_lines.push_back({event.point, event.point + event.normal * reach, color, 2});
    contact_points.push_back(event.point);
    contact_colors.push_back(color);
    ++count[event.other_is_collider ? 0 : 1];
  }
  legend.title("contacts; longest line " + short_number(static_cast<double>(max_impulse)) + " N s");
  legend.entry(against_collider, fmt::format("with colliders  {}", count[0]));
  legend.entry(against_object, fmt::format("between objects  {}", count[1]));
  if (contact_points.empty()) return;
  if (contacts_key == 0) contacts_key = allocate_key();
  list.spheres.push_back({.key = contacts_key,
                          .version = ++contacts_version,
                          .centers = contact_points,
                          .radius = 0.006f * size(),
                          .colors = contact_colors,
                          .casts_shadow = false});
}

/// Adds the meaning of the surface colors to the legend, and a note on data that a cache lacks.
void SubjectDrawing::Impl::explain(const Subject& subject, const DisplayOptions& options) {
  const Display display = options.display;
  if (display == Display::strain) {
    legend.title("stretch of edges");
    legend.scale(heat, 100 * options.max_strain, "%");
  }
  if (display == Display::speed) {
    legend.title("speed");
    legend.scale(heat, options.max_speed, "m/s");
  }
  if (display == Display::particles) {
    std::size_t count = 0;
    for (const Spheres& spheres : list.spheres) count += spheres.centers.size();
    legend.title(fmt::format("particles: {}", count));
  }
  if (display == Display::normals) legend.title("normals: x red, y green, z blue");
  if (subject.world) return;
  if (display == Display::lattice) legend.title("a recorded run holds no lattice");
  if (display == Display::contacts) legend.title("a recorded run holds no contacts");
  if (options.constraints != ConstraintDisplay::none) legend.title("a recorded run holds no constraints");
}

void SubjectDrawing::Impl::update(const Subject& subject, const DisplayOptions& options) {
  if (subject.topology != topology) start(subject);
  update_bodies(subject);
  update_colliders(subject);

  list.surfaces.clear();
  list.spheres.clear();
  list.liquids.clear();
  list.foams.clear();
  list.lines.clear();
  list.top_lines.clear();
  list.labels.clear();
  legend.clear();

  const World* world = subject.world;
  const DrawContext drawing{options, heat, subject.frame, world != nullptr, *threads, list};
  gather_particles(subject, drawing);
  rope_strain.clear();
  if (world && options.display == Display::strain) rope_strain = rope_strains(subject);
  for (std::uint32_t i = 0; i < subject.bodies.size(); ++i)
    bodies.at(subject.bodies[i].id)
        .draw(subject.bodies[i], i + 1,
              rope_strain.empty() ? std::span<const float>{} : std::span<const float>(rope_strain[i]),
              drawing);
  draw_colliders(subject, options);
  explain(subject, options);
  if (world) draw_joints(*world, options.constraints != ConstraintDisplay::none, 0.06f * size(), list.lines);
  if (world && options.pins) draw_pins(subject);
  if (world && options.display == Display::lattice) draw_lattice(*world);
  if (world && options.display == Display::contacts) draw_contacts(*world);
  if (world) draw_constraints(*world, options, heat, 0.004f * size(), list.top_lines, legend);
  list.light.environment = subject.environment;
  list.light.caustics = std::any_of(subject.bodies.begin(), subject.bodies.end(),
                                    [](const Body& body) { return body.caustics; });
  list.labels = legend.labels();
}

SubjectDrawing::SubjectDrawing() : impl_(std::make_unique<Impl>()) {}
SubjectDrawing::~SubjectDrawing() = default;

const DrawList& SubjectDrawing::update(const Subject& subject, const DisplayOptions& options) {
  impl_->update(subject, options);
  return impl_->list;
}

DrawList& SubjectDrawing::list() {
  return impl_->list;
}

std::uint32_t SubjectDrawing::vertex_of(const Subject& subject, std::uint32_t pick,
                                        std::uint32_t element) const {
  if (pick == 0 || pick > subject.bodies.size()) return element;
  const Body& body = subject.bodies[pick - 1];
  const auto found = impl_->bodies.find(body.id);
  return found == impl_->bodies.end() ? element : found->second.vertex_of(body, element);
}

}  // namespace souple::render
