#pragma once

#include "python/bind.h"
#include "python/enums.h"
#include "python/gil.h"
#include "python/structs.h"
#include "souple/error.h"
#include "souple/world/world.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>
#include <type_traits>
#include <utility>

// A world as Python has it: calls are checked, and functions of Python that the world calls.

namespace souple::python {

class BoundWorld;

/// The first exception of Python's functions that a step called; the step raises it when it has ended.
class PendingError {
 public:
  /// With the GIL.
  void keep(py::error_already_set& error);
  /// Raises what was kept, and forgets it.
  void raise();
  /// The one of functions that no world owns, which this thread calls outside of steps; null: their exceptions pass on.
  static thread_local PendingError* outside_of_steps;

 private:
  py::object type_, value_, trace_;
};

/// A world, and what it does without the GIL.
class BoundWorld {
 public:
  explicit BoundWorld(const Settings& settings) : world_(settings) {}
  explicit BoundWorld(World&& world) : world_(std::move(world)) {}
  BoundWorld(const BoundWorld&) = delete;
  BoundWorld& operator=(const BoundWorld&) = delete;
  ~BoundWorld();

  /// The world, for a call of this function. Throws Error while another thread steps the world: only functions that the
  /// step calls may call it then, as the table of World says.
  World& use(const char* function);
  /// Calls `f` on the world without the GIL. Other threads are refused meanwhile; raises what Python's functions raised.
  template <class Function>
  auto without_gil(const char* function, const Function& f) {
    World& world = use(function);
    const Busy busy(*this, function);
    const Nested nested(pending_);
    if constexpr (std::is_void_v<decltype(f(world))>) {
      released(world, f);
      pending_.raise();
    } else {
      auto result = released(world, f);
      pending_.raise();
      return result;
    }
  }
  /// A number that no other world of the process has.
  std::uint64_t number() const { return number_; }
  PendingError& pending() { return pending_; }

 private:
  template <class Function>
  static auto released(World& world, const Function& f) {
    const ReleasedGil released;
    return f(world);
  }
  /// Errors of the outer call stay apart from those of the inner one.
  class Nested {
   public:
    explicit Nested(PendingError& pending) : pending_(pending), outer_(std::exchange(pending, {})) {}
    ~Nested() { pending_ = std::move(outer_); }
    Nested(const Nested&) = delete;
    Nested& operator=(const Nested&) = delete;

   private:
    PendingError& pending_;
    PendingError outer_;
  };
  /// While the world is busy on this thread.
  class Busy {
   public:
    Busy(BoundWorld& world, const char* function);
    ~Busy();
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;

   private:
    BoundWorld& world_;
    const char* before_;
    std::thread::id thread_before_;
    BoundWorld* outer_;  ///< that this thread steps too
  };

  World world_;
  std::uint64_t number_ = next_number();
  const char* busy_ = nullptr;  ///< the function that runs
  std::thread::id thread_;      ///< that runs it
  PendingError pending_;
  static std::uint64_t next_number();
};

/// An exception of a Python function, on its way through C++.
class PythonFailure : public std::runtime_error {
 public:
  PythonFailure(const std::string& words, const py::error_already_set& error)
      : std::runtime_error(words), error_(error) {}
  /// Makes it Python's current exception.
  void restore() { error_.restore(); }

 private:
  py::error_already_set error_;
};

/// An argument of a function of Python.
template <class T>
py::object to_python(const T& value) {
  if constexpr (std::is_base_of_v<py::object, T>)
    return value;
  else
    return py::cast(value);
}

/// A function of Python that a world calls, on any thread. Copies share it.
class Callback {
 public:
  /// `what` names it in messages: "target of pin". `world`: may be null, for motions that no world owns.
  Callback(BoundWorld* world, std::string what, py::object function);

  /// Calls it with the GIL. An exception is kept for the step that is running, and throws PythonFailure.
  template <class R, class... A>
  R call(const A&... arguments) const {
    const HeldGil gil;
    const std::shared_ptr<State> state = state_;  // the function may destroy this callback
    const Inside inside(state->world);
    try {
      const py::object result = state->function(to_python(arguments)...);
      if constexpr (!std::is_void_v<R>) return from_python<R>(result, state->what + " returned");
    } catch (py::error_already_set& error) {
      fail(*state, error);
    } catch (const py::builtin_exception& error) {
      fail(*state, error);
    }
  }

 private:
  struct State {
    BoundWorld* world;
    std::string what;
    py::object function;
    ~State();
  };
  /// Marks this thread as one that the world called, so that the function may use the world.
  class Inside {
   public:
    explicit Inside(const BoundWorld* world);
    ~Inside();
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;
    static bool any(const BoundWorld* world);

   private:
    const BoundWorld* world_;
    const Inside* outer_;
    static thread_local const Inside* innermost;
  };
  friend class BoundWorld;

  [[noreturn]] static void fail(const State& state, py::error_already_set& error);
  [[noreturn]] static void fail(const State& state, const py::builtin_exception& error);

  std::shared_ptr<State> state_;
};

/// Throws TypeError unless it is callable.
const py::object& require_callable(const py::object& function, const char* what);

// The functions of C++ that are made of Python's.
Target target_of(BoundWorld& world, const py::object& function, const char* what);
ForceField force_field_of(BoundWorld& world, const py::object& function);
VertexForceField vertex_force_field_of(BoundWorld& world, const py::object& function);
ColliderMotion motion_of(const py::object& function);

/// A text that lives as long as the process: names of reports, of which there are few.
std::string_view kept_text(std::string_view text);

/// A member function of World, for py::class_::def, with the check of BoundWorld::use.
template <auto function, class R, class... A>
auto checked(R (World::*)(A...)) {
  return [](BoundWorld& world, A... arguments) -> std::decay_t<R> {
    return (world.use(name_of<function>()).*function)(std::forward<A>(arguments)...);
  };
}
template <auto function, class R, class... A>
auto checked(R (World::*)(A...) const) {
  return [](BoundWorld& world, A... arguments) -> std::decay_t<R> {
    return (world.use(name_of<function>()).*function)(std::forward<A>(arguments)...);
  };
}

/// Declares a member function of World under its name, with its comment and the check of BoundWorld::use. `extra`: names
/// of its parameters, and a text in place of the comment.
template <auto function, class... Extra>
void def(WorldClass& world, const Extra&... extra) {
  const char* const name = name_of<function>();
  world.def(name, checked<function>(function), doc(std::string("World.") + name), extra...);
}

template <auto function, class R, class... A>
auto checked_with_options(R (World::*)(A...)) {
  using All = std::tuple<A...>;
  return []<std::size_t... i>(std::index_sequence<i...>) {
    using Options = std::decay_t<std::tuple_element_t<sizeof...(i), All>>;
    return [](BoundWorld& world, std::tuple_element_t<i, All>... arguments,
              const std::optional<Options>& options, const py::kwargs& kwargs) -> R {
      const char* const name = name_of<function>();
      World& used = world.use(name);
      return (used.*function)(std::forward<std::tuple_element_t<i, All>>(arguments)...,
                              with_keywords(options, kwargs, name));
    };
  }
  (std::make_index_sequence<sizeof...(A) - 1>());
}

/// As def, for a function whose last parameter is a struct: keywords name its members.
template <auto function, class... Extra>
void def_with_options(WorldClass& world, const Extra&... extra) {
  const char* const name = name_of<function>();
  world.def(name, checked_with_options<function>(function), doc(std::string("World.") + name), extra...);
}

/// A parameter whose default is that of its type.
template <class T>
py::arg_v with_default(const char* name) {
  return py::arg_v(name, T{}, kept_text(python_type<T>() + "()").data());
}

}  // namespace souple::python
