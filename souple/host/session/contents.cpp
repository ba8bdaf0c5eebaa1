#include "souple/host/session/contents.h"

#include "souple/host/session/drive.h"
#include "souple/scene/scene.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace souple::host {

namespace {

ObjectId add_to(World& world, const Item& item) {
  const HostMesh& host = *item.mesh;
  const TriangleMesh mesh = host.weld.mesh(host.placement);
  ObjectOptions options;
  options.name = item.name;
  options.self_collision = host.self_collision ? SelfCollision::surfaces : SelfCollision::off;
  switch (item.kind) {
    case Kind::cloth:
      return world.add_cloth(mesh, std::get<ClothMaterial>(item.material), options);
    case Kind::soft_body:
      return world.add_soft_body(mesh, std::get<SoftBodyMaterial>(item.material),
                                 {.cells = host.lattice_tets}, options);
    case Kind::rigid_body:
      return world.add_rigid_body(mesh, std::get<RigidBodyMaterial>(item.material), options);
    default:
      break;
  }
  return world.add_obstacle(mesh, std::get<ObstacleMaterial>(item.material), {}, options);
}

void pin_in(World& world, ObjectId id, const Pin& pin) {
  if (pin.pinned)
    world.pin(id, vertices({pin.vertex}));
  else
    world.unpin(id, vertices({pin.vertex}));
}

/// Changes the material of the scene's object of that name.
void keep_in(SceneDescription& scene, const std::string& name, const AnyMaterial& material) {
  for (AnyObjectDescription& any : scene.objects) {
    if (common(any).name != name) continue;
    const auto take = [&](auto& description) {
      using Own = decltype(description.material);
      std::visit(
          [&](const auto& changed) {
            using Changed = std::decay_t<decltype(changed)>;
            if constexpr (std::is_base_of_v<Changed, Own>)
              static_cast<Changed&>(description.material) = changed;
          },
          material);
    };
    std::visit(take, any);
  }
}

Item item_of_scene(Handle handle, const World& world, ObjectId id, const SceneDescription& scene) {
  Item item;
  item.handle = handle;
  item.name = world.name(id);
  item.kind = static_cast<Kind>(world.kind(id));
  item.material = world.material(id);
  item.id = id;
  for (const AnyObjectDescription& any : scene.objects)
    if (common(any).name == item.name) item.color = common(any).color;
  return item;
}

}  // namespace

std::array<float, 3> channels_of(const std::optional<std::uint32_t>& color) {
  if (!color) return {};
  const auto channel = [&](int shift) { return static_cast<float>((*color >> shift) & 0xffu) / 255; };
  return {channel(16), channel(8), channel(0)};
}

Contents::Contents(Report report) : report_(std::move(report)), scene_(std::make_unique<SceneDescription>()) {
  listen();
}
Contents::~Contents() = default;

void Contents::listen() {
  // Warnings of steps are in the step's report; as messages they would repeat in each step.
  world_.set_log([this](LogLevel level, std::string_view text) {
    if (level == LogLevel::info) report_(std::string(text));
  });
}

Item* Contents::find(Handle handle) const {
  for (const auto& item : items_)
    if (item->handle == handle) return item.get();
  return nullptr;
}

Item* Contents::find(ObjectId id) const {
  for (const auto& item : items_)
    if (item->id == id) return item.get();
  return nullptr;
}

std::optional<std::uint32_t> Contents::collider_color(const std::string& name) const {
  for (const ColliderDescription& collider : scene_->colliders)
    if (collider.name == name) return collider.color;
  return std::nullopt;
}

Item& Contents::item(Handle handle) const {
  if (Item* found = find(handle)) return *found;
  const auto gone = gone_.find(handle);
  if (gone == gone_.end()) throw Error(fmt::format("there is no object {}", handle));
  throw Error(fmt::format("\"{}\" (object {}) is no longer there", gone->second, handle));
}

// --- objects -------------------------------------------------------------------------------------

void Contents::open(const std::string& file) {
  replace(load_scene(file), true);
}

void Contents::clear() {
  replace({}, false);
}

void Contents::replace(SceneDescription scene, bool has_scene) {
  std::vector<std::string> sentences;  // reported only if the scene opens
  const SceneLog log = [&](LogLevel, std::string_view text) { sentences.emplace_back(text); };
  World world = has_scene ? build_world(scene, log) : World();
  std::vector<std::unique_ptr<Item>> items;
  Handle last = last_;
  for (const ObjectId id : world.objects())
    items.push_back(std::make_unique<Item>(item_of_scene(++last, world, id, scene)));
  for (const auto& item : items_) gone_[item->handle] = item->name;
  colliders_.clear();
  connections_.clear();
  items_ = std::move(items);
  last_ = last;
  *scene_ = std::move(scene);
  has_scene_ = has_scene;
  removed_.clear();
  world_ = std::move(world);
  listen();
  for (std::string& sentence : sentences) report_(std::move(sentence));
}

Handle Contents::add(Kind kind, const TriangleSoup& soup, const MeshOptions& options) {
  const std::string name = options.name.empty() ? kind_name(kind) : options.name;
  if (kind == Kind::soft_body && options.lattice_tets == 0) throw Error(name + ": lattice_tets is 0");
  const Placement placement = Placement::of(options.transform, (name + ": transform").c_str());
  auto item = std::make_unique<Item>();
  item->name = options.name;
  item->kind = kind;
  item->material = make_material(kind, options.preset);
  item->mesh = HostMesh{VertexWelder(soup, options.weld_tolerance, name), placement, placement};
  item->mesh->self_collision = kind == Kind::cloth && options.self_collision;
  item->mesh->lattice_tets = options.lattice_tets;
  if (kind == Kind::obstacle)
    for (const Vec3d& x : item->mesh->weld.mesh().positions) item->mesh->rest.emplace_back(x);
  item->id = add_to(world_, *item);
  item->name = world_.name(item->id);
  item->handle = ++last_;
  items_.push_back(std::move(item));
  return last_;
}

void Contents::remove(Handle handle) {
  const Item& gone = item(handle);
  for (std::size_t k = connections_.size(); k-- > 0;)
    if (connections_[k].object[0] == handle || connections_[k].object[1] == handle)
      disconnect(connections_[k].handle);
  world_.remove(gone.id);
  gone_[handle] = gone.name;
  if (!gone.mesh) removed_.push_back(gone.name);
  items_.erase(
      std::find_if(items_.begin(), items_.end(), [&](const auto& i) { return i->handle == handle; }));
}

void Contents::rebuild() {
  World world = has_scene_ ? build_world(*scene_) : World(world_.settings());
  for (const std::string& name : removed_) world.remove(world.find_object(name));
  std::vector<ObjectId> ids;
  for (const auto& item : items_) {
    const ObjectId id = item->mesh ? add_to(world, *item) : world.find_object(item->name);
    for (const Pin& pin : item->pins) pin_in(world, id, pin);
    world.set_wind_exposure(id, item->wind_exposure);
    ids.push_back(id);
  }
  std::vector<ColliderId> colliders;
  for (const HostCollider& collider : colliders_) colliders.push_back(add_collider_to(world, collider));
  std::vector<ProjectorId> connections;
  for (const Connection& connection : connections_)
    connections.push_back(connect_in(world, connection, [&](Handle handle) {
      for (std::size_t i = 0; i < ids.size(); ++i)
        if (items_[i]->handle == handle) return ids[i];
      throw Error("a connection's object is gone");
    }));
  for (std::size_t i = 0; i < colliders.size(); ++i) colliders_[i].id = colliders[i];
  for (std::size_t i = 0; i < connections.size(); ++i) connections_[i].id = connections[i];
  for (std::size_t i = 0; i < ids.size(); ++i) {
    items_[i]->id = ids[i];
    if (!items_[i]->mesh) continue;
    items_[i]->mesh->added = items_[i]->mesh->placement;
    items_[i]->mesh->drive.reset();
  }
  world_ = std::move(world);
  listen();
}

// --- changes -------------------------------------------------------------------------------------

void Contents::set_settings(const Settings& settings) {
  world_.set_settings(settings);
  scene_->settings = settings;
}

void Contents::set_material(Handle handle, const AnyMaterial& material) {
  Item& changed = item(handle);
  world_.set_material(changed.id, material);
  changed.material = material;
  if (!changed.mesh) keep_in(*scene_, changed.name, material);
}

void Contents::set_pinned(Handle handle, std::uint32_t vertex, bool pinned) {
  Item& held = item(handle);
  if (held.kind == Kind::obstacle)
    throw Error(held.name + ": it is an obstacle, which nothing moves but the host; it needs no pins");
  const Pin said{vertex, pinned};
  pin_in(world_, held.id, said);
  std::vector<Pin>& pins = held.pins;
  pins.erase(std::remove_if(pins.begin(), pins.end(), [&](const Pin& pin) { return pin.vertex == vertex; }),
             pins.end());
  pins.push_back(said);
}

void Contents::set_transform(Handle handle, const float* transform) {
  Item& moved = item(handle);
  if (!moved.mesh) throw Error(moved.name + ": it is of the scene, and has no mesh of the host");
  HostMesh& mesh = *moved.mesh;
  const Placement placement = Placement::of(transform, (moved.name + ": transform").c_str());
  if (moved.kind == Kind::obstacle) {
    const Transform motion = rigid_motion(mesh.added, placement, moved.name);
    if (!mesh.drive) {
      const auto drive = std::make_shared<Drive>();
      world_.set_motion(moved.id,
                        {.pose = ColliderMotion::callback([drive](double time) { return drive->at(time); })});
      mesh.drive = drive;
    }
    mesh.drive->to = motion;
  }
  mesh.placement = placement;
}

void Contents::begin_step(double dt) {
  for (const auto& item : items_)
    if (item->mesh && item->mesh->drive) item->mesh->drive->begin_step(world_.time(), dt);
}

void Contents::end_step(bool made) {
  for (const auto& item : items_)
    if (item->mesh && item->mesh->drive) item->mesh->drive->end_step(made);
}

}  // namespace souple::host
