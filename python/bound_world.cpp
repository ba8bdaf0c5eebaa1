#include "python/bound_world.h"

#include <algorithm>
#include <atomic>
#include <set>

namespace souple::python {

namespace {

/// The world that this thread steps, innermost first.
thread_local BoundWorld* stepped = nullptr;

}  // namespace

// --- errors

thread_local PendingError* PendingError::outside_of_steps = nullptr;

void PendingError::keep(py::error_already_set& error) {
  if (value_) return;
  type_ = error.type();
  value_ = error.value();
  trace_ = error.trace();
}

void PendingError::raise() {
  if (!value_) return;
  PyErr_Restore(type_.release().ptr(), value_.release().ptr(), trace_.release().ptr());
  throw py::error_already_set();
}

// --- the world

std::uint64_t BoundWorld::next_number() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

BoundWorld::~BoundWorld() = default;

World& BoundWorld::use(const char* function) {
  if (busy_ == nullptr || thread_ == std::this_thread::get_id() || Callback::Inside::any(this)) return world_;
  throw Error(std::string(function) + ": another thread is in " + busy_ +
              " of this world; call it when that has returned, or in a function that the step calls");
}

BoundWorld::Busy::Busy(BoundWorld& world, const char* function)
    : world_(world), before_(world.busy_), thread_before_(world.thread_), outer_(stepped) {
  world.busy_ = function;
  world.thread_ = std::this_thread::get_id();
  stepped = &world;
}

BoundWorld::Busy::~Busy() {
  world_.busy_ = before_;
  world_.thread_ = thread_before_;
  stepped = outer_;
}

// --- functions of Python

thread_local const Callback::Inside* Callback::Inside::innermost = nullptr;

Callback::Inside::Inside(const BoundWorld* world) : world_(world), outer_(innermost) {
  innermost = this;
}

Callback::Inside::~Inside() {
  innermost = outer_;
}

bool Callback::Inside::any(const BoundWorld* world) {
  for (const Inside* inside = innermost; inside != nullptr; inside = inside->outer_)
    if (inside->world_ == world) return true;
  return false;
}

Callback::State::~State() {
  if (Py_IsInitialized() == 0) {
    function.release();  // too late
    return;
  }
  const py::gil_scoped_acquire gil;
  function = py::object();
}

Callback::Callback(BoundWorld* world, std::string what, py::object function)
    : state_(new State{world, std::move(what), std::move(function)}) {}

void Callback::fail(const State& state, py::error_already_set& error) {
  BoundWorld* const world = state.world ? state.world : stepped;
  PendingError* const pending = world ? &world->pending() : PendingError::outside_of_steps;
  const std::string words = error.what();
  if (pending) pending->keep(error);
  throw PythonFailure(words, error);
}

void Callback::fail(const State& state, const py::builtin_exception& error) {
  error.set_error();
  py::error_already_set python;
  fail(state, python);
}

const py::object& require_callable(const py::object& function, const char* what) {
  if (PyCallable_Check(function.ptr()) == 0) throw_wrong_type(what, "a function", function);
  return function;
}

Target target_of(BoundWorld& world, const py::object& function, const char* what) {
  if (function.is_none()) return {};
  const Callback callback(&world, what, require_callable(function, what));
  return [callback](std::uint32_t vertex, double time) { return callback.call<Vec3d>(vertex, time); };
}

ForceField force_field_of(BoundWorld& world, const py::object& function) {
  const Callback callback(&world, "force field", require_callable(function, "add_force_field"));
  return [callback](const Vec3f& x, const Vec3f& v, float mass, double time) {
    return callback.call<Vec3f>(x, v, mass, time);
  };
}

VertexForceField vertex_force_field_of(BoundWorld& world, const py::object& function) {
  const Callback callback(&world, "force field", require_callable(function, "add_vertex_force_field"));
  return [callback](const ForcePoint& point) { return callback.call<Vec3f>(point); };
}

ColliderMotion motion_of(const py::object& function) {
  const Callback callback(nullptr, "motion", require_callable(function, "ColliderMotion.callback"));
  return ColliderMotion::callback([callback](double time) { return callback.call<Transform>(time); });
}

std::string_view kept_text(std::string_view text) {
  static std::set<std::string, std::less<>> texts;  // with the GIL
  const auto known = texts.find(text);
  return known != texts.end() ? *known : *texts.emplace(text).first;
}

}  // namespace souple::python
