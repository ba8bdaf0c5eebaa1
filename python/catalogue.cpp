#include "python/catalogue.h"

#include "python/bind.h"
#include "souple/constraints/all.h"
#include "souple/solver/custom_constraint.h"
#include "souple/solver/set_projector.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace souple::python {

namespace {

/// Properties of a kind, and its factory.
struct Entry {
  const char* kind;
  std::size_t arity, rows, parameters, compliances;
  std::unique_ptr<Projector> (*make)(const ConstraintArrays& arrays);
  /// The parameters of constraints whose particles are at rest at x: arity positions each. Null: none such.
  std::vector<float> (*from_rest)(std::span<const Vec3d> x);
};

template <class Kind>
std::unique_ptr<Projector> make(const ConstraintArrays& arrays) {
  using Set = ConstraintSet<Kind>;
  auto projector = std::make_unique<SetProjector<Kind>>();
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    typename Set::Indices indices;
    typename Set::Params params;
    typename Set::Compliance compliance;
    std::copy_n(&arrays.particles[i * Set::arity], Set::arity, indices.begin());
    std::memcpy(static_cast<void*>(&params), &arrays.parameters[i * Set::param_count], sizeof params);
    std::copy_n(&arrays.compliances[i * compliance.size()], compliance.size(), compliance.begin());
    projector->add(indices, params, compliance, arrays.damping_times[i], arrays.stiffnesses[i]);
  }
  return projector;
}

template <class Kind>
std::vector<float> from_rest(std::span<const Vec3d> x) {
  constexpr std::size_t arity = Kind::arity, count = ConstraintSet<Kind>::param_count;
  std::vector<float> parameters(x.size() / arity * count);
  for (std::size_t i = 0; i < x.size() / arity; ++i) {
    Vec3d corners[arity];
    std::copy_n(&x[i * arity], arity, corners);
    const auto params = Kind::from_rest(corners);
    std::memcpy(&parameters[i * count], &params, sizeof params);
  }
  return parameters;
}

template <class Kind>
Entry entry() {
  Entry e{Kind::name,
          Kind::arity,
          ConstraintSet<Kind>::rows,
          ConstraintSet<Kind>::param_count,
          std::tuple_size_v<typename ConstraintSet<Kind>::Compliance>,
          &make<Kind>,
          nullptr};
  if constexpr (requires(const Vec3d(&x)[Kind::arity]) { Kind::from_rest(x); })
    e.from_rest = &from_rest<Kind>;
  return e;
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = []<class... Kinds>(std::type_identity<std::tuple<Kinds...>>) {
    return std::vector<Entry>{entry<Kinds>()...};
  }(std::type_identity<EveryConstraint>{});
  return all;
}

const Entry& find(const std::string& kind) {
  std::string known;
  for (const Entry& e : entries()) {
    if (kind == e.kind) return e;
    known += (known.empty() ? "" : ", ") + std::string(e.kind);
  }
  throw Error("SetProjector: no kind of constraints is called \"" + kind + "\"; known: " + known);
}

/// One row for all, or a row each.
std::vector<float> rows_of(const std::string& what, const py::array& values, std::size_t count,
                           std::size_t columns) {
  const auto array = py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(values);
  if (!array) throw py::error_already_set();
  const auto size = static_cast<std::size_t>(array.size());
  const bool is_one = size == columns && array.ndim() <= 1, fits = is_one || size == count * columns;
  if (!fits)
    throw Error("SetProjector: expected " + std::string(py::str(py::int_(columns))) + " numbers of " + what +
                " for each of " + std::string(py::str(py::int_(count))) +
                " constraints, or once, found shape " + std::string(py::str(values.attr("shape"))));
  for (const float x : std::span(array.data(), size))
    if (!std::isfinite(x)) throw Error("SetProjector: a number of " + what + " is not finite");
  std::vector<float> rows;
  rows.reserve(count * columns);
  for (std::size_t i = 0; i < count; ++i) {
    const float* const from = array.data() + (is_one ? 0 : i * columns);
    rows.insert(rows.end(), from, from + columns);
  }
  return rows;
}

void require_range(const std::string& what, const std::vector<float>& values, float low, float high) {
  for (const float x : values)
    if (!(x >= low && x <= high))
      throw Error("SetProjector: " + what + " is " + std::string(py::str(py::float_(x))) + ", out of range");
}

ConstraintArrays arrays_of(const std::string& kind, const py::array& particles, const py::array& parameters,
                           const py::array& compliance, const py::array& damping_time,
                           const py::array& stiffness) {
  const Entry& e = find(kind);
  ConstraintArrays arrays{kind, {}, {}, {}, {}, {}};
  const std::span<const std::uint32_t> indices(static_cast<const std::uint32_t*>(particles.data()),
                                               static_cast<std::size_t>(particles.size()));
  const std::size_t count = indices.size() / e.arity;
  arrays.particles.assign(indices.begin(), indices.end());
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 1; k < e.arity; ++k)
      for (std::size_t j = 0; j < k; ++j)
        if (indices[i * e.arity + k] == indices[i * e.arity + j])
          throw Error("SetProjector: constraint " + std::string(py::str(py::int_(i))) +
                      " names a particle twice");
  arrays.parameters = rows_of("parameters", parameters, count, e.parameters);
  arrays.compliances = rows_of("compliance", compliance, count, e.compliances);
  arrays.damping_times = rows_of("damping_time", damping_time, count, 1);
  arrays.stiffnesses = rows_of("stiffness", stiffness, count, 1);
  require_range("damping_time", arrays.damping_times, 0, 1e30f);
  require_range("stiffness", arrays.stiffnesses, 0, 1);
  if (e.compliances == 1) require_range("compliance", arrays.compliances, 0, 1e30f);
  return arrays;
}

void bind_catalogue(py::module_& m) {
  py::class_<ConstraintArrays>(m, "_ConstraintArrays")
      .def_readonly("kind", &ConstraintArrays::kind)
      .def("__len__", &ConstraintArrays::size);
  m.def("_constraint_arrays", &arrays_of);
  m.def("_constraint_kinds", [] {
    py::dict kinds;
    for (const Entry& e : entries())
      kinds[e.kind] = py::make_tuple(e.arity, e.rows, e.parameters, e.compliances, e.from_rest != nullptr);
    return kinds;
  });
  m.def("_constraint_parameters", [](const std::string& kind, std::span<const Vec3d> x) {
    const Entry& e = find(kind);
    if (e.from_rest == nullptr || x.size() % e.arity != 0)
      throw Error("SetProjector: " + kind + " takes no rest positions");
    return e.from_rest(x);
  });
}

/// A function of Python as a constraint. The arrays that it gets are copies: it may keep them.
class PythonConstraint final : public CustomConstraint {
 public:
  PythonConstraint(BoundWorld& world, const CustomArguments::Item& item)
      : particles_(item.particles),
        callback_(&world, "custom constraint '" + item.name + "'", item.function),
        origin_(item.origin) {
    name = item.name;
    sense = item.sense;
    compliance = item.compliance;
    damping_time = item.damping_time;
    stiffness = item.stiffness;
  }
  std::span<const std::uint32_t> particles() const override { return particles_; }
  Vec3f origin() const override { return origin_; }
  float evaluate(std::span<const Vec3f> x, std::span<Vec3f> gradient) override {
    const HeldGil gil;
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(x.size()), 3};
    const py::array positions(py::dtype("f4"), shape, x.data()),
        gradients(py::dtype("f4"), shape, gradient.data());
    const float C = callback_.call<float>(positions, gradients);
    const auto* const filled = static_cast<const Vec3f*>(gradients.data());
    std::copy_n(filled, gradient.size(), gradient.begin());
    return C;
  }

 private:
  std::vector<std::uint32_t> particles_;
  Callback callback_;
  Vec3f origin_;
};

void add_item(CustomArguments& arguments, std::vector<std::uint32_t> particles, const py::object& evaluate,
              const std::string& name, Sense sense, float compliance, float damping_time, float stiffness,
              const Vec3f& origin) {
  require_callable(evaluate, "CustomProjector.add");
  CustomArguments::Item item{std::move(particles), evaluate,     name,      sense,
                             compliance,           damping_time, stiffness, origin};
  arguments.items.push_back(std::move(item));
}

void bind_custom(py::module_& m) {
  py::class_<CustomArguments>(
      m, "CustomProjector",
      "Constraints of your own: World.add_projector takes them. Slow: a call of Python for each of them "
      "in each substep. SetProjector takes arrays of a kind of the catalogue.")
      .def(py::init())
      .def("__len__", [](const CustomArguments& arguments) { return arguments.items.size(); })
      .def("add", &add_item, "particles"_a, "evaluate"_a, "name"_a = "custom",
           py::arg_v("sense", Sense::equality, "Sense.equality"), "compliance"_a = 0, "damping_time"_a = 0,
           "stiffness"_a = 1, "origin"_a = Vec3f{},
           "Adds a constraint on particles, of indices that World.particle gives. evaluate(x, gradient) gets "
           "their positions "
           "less `origin`, (n, 3) [m], writes dC/dx into gradient, which is zero at entry, and returns C.");
}

}  // namespace

std::unique_ptr<Projector> ConstraintArrays::make() const {
  return find(kind).make(*this);
}

std::unique_ptr<Projector> CustomArguments::make(BoundWorld& world) const {
  auto projector = std::make_unique<CustomProjector>();
  for (const Item& item : items) projector->add(std::make_shared<PythonConstraint>(world, item));
  return projector;
}

void bind_constraints(py::module_& m) {
  bind_catalogue(m);
  bind_custom(m);
}

}  // namespace souple::python
