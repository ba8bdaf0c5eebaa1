#include "plugins/radium/physics_system.h"

#include "plugins/radium/scene_entities.h"

#include <Core/Tasks/Task.hpp>
#include <Core/Tasks/TaskQueue.hpp>
#include <Engine/RadiumEngine.hpp>
#include <Engine/Scene/Component.hpp>
#include <Engine/Scene/Entity.hpp>
#include <Engine/Scene/EntityManager.hpp>
#include <Engine/Scene/SystemDisplay.hpp>
#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <souple/error.h>
#include <utility>

namespace souple::radium {

namespace {

using Ra::Core::Utils::Index;

/// Marks an entity in Radium's tree whose mesh is an object of the world. Deleting the mark removes the object.
class Mark : public Ra::Engine::Scene::Component {
 public:
  using Component::Component;
  void initialize() override {}
};

Vec3f vec3(const Ra::Core::Vector3& v) {
  return {v[0], v[1], v[2]};
}

host::Ray ray_of(const Ra::Core::Ray& ray) {
  return {vec3(ray.origin()), vec3(ray.direction())};
}

// Radium reuses the number of a deleted object.
bool shows(const RenderMesh& mesh, const Index& render_object) {
  return mesh.index().getValue() == render_object.getValue() && mesh.alive();
}

std::optional<std::uint32_t> drawn_vertex(const host::Drawable& drawable, const PickedVertex& picked) {
  const int corners = drawable.balls() ? 1 : 3;
  if (picked.triangle < 0 || picked.corner < 0 || picked.corner >= corners) return std::nullopt;
  const auto at = static_cast<std::size_t>(picked.triangle) * static_cast<std::size_t>(corners) +
                  static_cast<std::size_t>(picked.corner);
  if (drawable.balls())
    return at < drawable.vertex_count() ? std::optional(static_cast<std::uint32_t>(at)) : std::nullopt;
  return at < drawable.triangles().size() ? std::optional(drawable.triangles()[at]) : std::nullopt;
}

}  // namespace

PhysicsSystem* PhysicsSystem::add_to(Ra::Engine::RadiumEngine& engine) {
  if (engine.getSystem(system_name) != nullptr) return nullptr;
  auto system = std::make_unique<PhysicsSystem>(engine);
  engine.setEndTime(-1);
  engine.registerSystem(system_name, system.get());
  return system.release();  // the engine deletes it
}

PhysicsSystem::PhysicsSystem(Ra::Engine::RadiumEngine& engine) : engine_(engine) {
  begin_here();
}

std::vector<std::string> PhysicsSystem::take_messages() {
  std::vector<std::string> all = std::exchange(messages_, {});
  for (std::string& message : session_.take_messages()) all.push_back(std::move(message));
  return all;
}

// --- objects

void PhysicsSystem::open_scene(const std::string& file) {
  session_.open_scene(file);
  hide_all();
  begin_here();
  for (const host::ObjectInfo& info : session_.objects()) {
    host::Drawable drawable(session_, info.handle, host::Drawable::Sides::two);
    drawable.update(session_);
    RenderMesh mesh = show_object(engine_, info, drawable);
    show({info.name, std::move(drawable), std::move(mesh), true});
  }
  for (const host::ColliderShape& shape : session_.colliders())
    colliders_.push_back(show_collider(engine_, shape));
  draw();
}

void PhysicsSystem::clear() {
  session_.clear();
  hide_all();
  begin_here();
}

std::vector<LoadedMesh> PhysicsSystem::loaded_meshes() const {
  const auto of_scene = [&](const Index& index) {
    return std::any_of(bodies_.begin(), bodies_.end(),
                       [&](const Body& b) { return b.from_scene && shows(b.mesh, index); }) ||
           std::any_of(colliders_.begin(), colliders_.end(),
                       [&](const RenderMesh& mesh) { return shows(mesh, index); });
  };
  std::vector<LoadedMesh> meshes;
  for (auto* entity : engine_.getEntityManager()->getEntities()) {
    for (const auto& component : entity->getComponents()) {
      for (const Index& index : component->getRenderObjects()) {
        const RenderMesh mesh(engine_, index);
        if (!mesh.alive() || mesh.triangle_count() == 0 || of_scene(index)) continue;
        meshes.push_back({index, mesh.name(), mesh.triangle_count(), object_of(index)});
      }
    }
  }
  return meshes;
}

host::Handle PhysicsSystem::add(const Index& render_object, host::Kind kind, host::MeshOptions options) {
  RenderMesh mesh(engine_, render_object);
  if (!mesh.alive()) throw Error("what should become an object is not a mesh that Radium shows");
  if (options.name.empty()) options.name = mesh.name();
  if (object_of(render_object) != 0) throw Error(options.name + ": it is in the world already");
  const std::array<float, 16> transform = mesh.transform();
  options.transform = transform.data();
  std::vector<float> positions = mesh.positions();
  const std::vector<std::uint32_t> triangles = mesh.triangles();
  const host::TriangleSoup soup{positions.data(), mesh.vertex_count(), triangles.data(),
                                triangles.size() / 3};
  host::Handle object = 0;
  switch (kind) {
    case host::Kind::cloth:
      object = session_.add_cloth(soup, options);
      break;
    case host::Kind::soft_body:
      object = session_.add_soft_body(soup, options);
      break;
    case host::Kind::obstacle:
      object = session_.add_obstacle(soup, options);
      break;
    case host::Kind::rigid_body:
      object = session_.add_rigid_body(soup, options);
      break;
    case host::Kind::rope:
    case host::Kind::grains:
    case host::Kind::fluid:
      throw Error(options.name + ": a mesh becomes a cloth, a soft body, a rigid body or an obstacle");
  }
  std::vector<float> normals = mesh.normals();
  show({options.name, host::Drawable(session_, object), std::move(mesh), false, transform,
        std::move(positions), std::move(normals)});
  return object;
}

void PhysicsSystem::remove(host::Handle object) {
  session_.remove(object);
  const auto body = find(object);
  if (body == bodies_.end()) return;  // added to the session directly, without a mesh here
  hide(*body);
  bodies_.erase(body);
}

host::Handle PhysicsSystem::object_of(const Index& render_object) const {
  const auto body = std::find_if(bodies_.begin(), bodies_.end(),
                                 [&](const Body& b) { return shows(b.mesh, render_object); });
  return body == bodies_.end() ? 0 : body->object();
}

std::vector<Body>::iterator PhysicsSystem::find(host::Handle object) {
  return std::find_if(bodies_.begin(), bodies_.end(), [&](const Body& b) { return b.object() == object; });
}

void PhysicsSystem::show(Body body) {
  auto& entity = body.mesh.entity();
  body.mark = new Mark("Souple " + body.name, &entity);  // the entity's
  addComponent(&entity, body.mark);
  bodies_.push_back(std::move(body));
}

void PhysicsSystem::hide(Body& body) {
  if (auto* mark = std::exchange(body.mark, nullptr)) mark->getEntity()->removeComponent(mark->getName());
  if (!body.mesh.alive()) return;
  if (body.from_scene)
    engine_.getEntityManager()->removeEntity(&body.mesh.entity());
  else
    body.mesh.set_vertices(body.first_positions, body.first_normals);
}

void PhysicsSystem::hide_all() {
  for (Body& body : bodies_) hide(body);
  bodies_.clear();
  for (const RenderMesh& mesh : colliders_)
    if (mesh.alive()) engine_.getEntityManager()->removeEntity(&mesh.entity());
  colliders_.clear();
}

void PhysicsSystem::unregisterComponent(const Ra::Engine::Scene::Entity* entity,
                                        Ra::Engine::Scene::Component* component) {
  System::unregisterComponent(entity, component);
  // During Radium's deletion: the object of the mark is removed before the next frame.
  for (Body& body : bodies_)
    if (body.mark == component) body.mark = nullptr;
}

void PhysicsSystem::forget_deleted() {
  for (std::size_t i = bodies_.size(); i-- > 0;) {
    Body& body = bodies_[i];
    const bool in_world = session_.contains(body.object());
    if (in_world && body.mark != nullptr && body.mesh.alive()) continue;
    if (in_world) {
      messages_.push_back(body.name + " was deleted in Radium: it has left the world");
      session_.remove(body.object());
    }
    hide(body);
    bodies_.erase(bodies_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void PhysicsSystem::follow_transforms() {
  for (Body& body : bodies_) {
    if (body.from_scene) continue;
    const std::array<float, 16> transform = body.mesh.transform();
    if (transform == body.transform) continue;
    body.transform = transform;
    session_.set_transform(body.object(), transform.data());
  }
}

// --- time

void PhysicsSystem::begin_here() {
  session_.start_at(engine_.getTime());
  drawn_version_ = 0;
}

void PhysicsSystem::play() {
  session_.set_playing(true);
  engine_.play(true);
  playing_ = true;
  first_frame_ = false;
}

void PhysicsSystem::pause() {
  engine_.play(false);
  playing_ = false;
}

void PhysicsSystem::step() {
  session_.set_playing(true);
  engine_.play(false);
  engine_.step();
  playing_ = false;
  first_frame_ = false;
}

void PhysicsSystem::reset() {
  session_.reset();
  engine_.resetTime();
  playing_ = false;
  begin_here();
}

bool PhysicsSystem::playing() const {
  return playing_ && session_.playing();
}

void PhysicsSystem::mend_time_window() {
  // Radium 1.5 uses the time window of each loaded file. Without animation the window begins at the largest
  // float, and after Radium's reset time would not advance there.
  if (engine_.getStartTime() < engine_.getEndTime() || engine_.getEndTime() < 0) return;
  engine_.setStartTime(0);
  engine_.setEndTime(-1);
}

void PhysicsSystem::generateTasks(Ra::Core::TaskQueue* tasks, const Ra::Engine::FrameInfo& frame) {
  mend_time_window();
  try {
    forget_deleted();
    follow_transforms();
  } catch (const std::exception& error) {
    messages_.emplace_back(error.what());
  }
  const double time = frame.m_animationTime, dt = frame.m_dt;
  // Radium advances time in its first frame, even without a press of play.
  if (std::exchange(first_frame_, false)) session_.start_at(time);
  tasks->registerTask(
      std::make_unique<Ra::Core::FunctionTask>([this, time, dt] { run(time, dt); }, system_name));
}

void PhysicsSystem::run(double time, double dt) {
  session_.advance(time, dt);
  if (session_.version() == drawn_version_) return;
  try {
    draw();
  } catch (const std::exception& error) {
    messages_.emplace_back(error.what());  // an exception that leaves a task would end Radium
  }
}

void PhysicsSystem::draw() {
  drawn_version_ = session_.version();
  for (Body& body : bodies_) {
    body.drawable.update(session_);
    body.mesh.set_vertices(body.drawable.positions(), body.drawable.normals());
  }
  const std::vector<std::array<float, 16>> transforms = session_.collider_transforms();
  for (std::size_t i = 0; i < colliders_.size(); ++i)
    if (colliders_[i].alive()) colliders_[i].set_local_transform(transforms[i]);
}

// --- the mouse

template <class Action>
bool PhysicsSystem::with_vertex(const PickedVertex& picked, Action action) {
  const auto body = find(object_of(picked.render_object));
  if (body == bodies_.end()) return false;
  const std::optional<std::uint32_t> drawn = drawn_vertex(body->drawable, picked);
  return drawn && action(body->object(), body->drawable.vertex_of(*drawn));
}

bool PhysicsSystem::grab(const PickedVertex& picked, const Ra::Core::Ray& ray,
                         const Ra::Core::Vector3& facing) {
  return with_vertex(picked, [&](host::Handle object, std::uint32_t vertex) {
    return session_.grab_vertex(object, vertex, ray_of(ray), vec3(facing));
  });
}

bool PhysicsSystem::grab(const Ra::Core::Ray& ray, const Ra::Core::Vector3& facing) {
  return session_.grab(ray_of(ray), vec3(facing));
}

void PhysicsSystem::drag(const Ra::Core::Ray& ray) {
  session_.drag(ray_of(ray));
}

void PhysicsSystem::release() {
  session_.release();
}

bool PhysicsSystem::set_pinned(const PickedVertex& picked, bool pinned) {
  return with_vertex(picked, [&](host::Handle object, std::uint32_t vertex) {
    session_.set_pinned(object, vertex, pinned);
    return true;
  });
}

}  // namespace souple::radium
