#include "python/enums.h"

#include "python/bind.h"
#include "python/structs.h"

namespace souple::python {

namespace {

/// Makes an enum.IntEnum of C++'s enumerators, under their names.
template <auto first, decltype(first)... others>
void enumeration(py::handle scope, const char* name, const char* base = "IntEnum") {
  py::list members;
  const auto add = [&](const char* word, auto value) {
    members.append(py::make_tuple(word, static_cast<long>(value)));
  };
  add(name_of<first>(), first);
  (add(name_of<others>(), others), ...);
  const py::object module = PyModule_Check(scope.ptr()) != 0 ? py::str("souple") : scope.attr("__module__");
  const py::object made = py::module_::import("enum").attr(base)(name, members, "module"_a = module,
                                                                 "qualname"_a = doc_name(scope, name));
  made.attr("__doc__") = doc(doc_name(scope, name));
  scope.attr(name) = made;
  enum_class<decltype(first)> = py::object(made).release().ptr();
}

void bind_settings_enums(py::handle m) {
  enumeration<Integrator::semi_implicit, Integrator::explicit_euler, Integrator::implicit_euler>(
      m, "Integrator");
  enumeration<Mode::small_steps, Mode::xpbd, Mode::pbd>(m, "Mode");
  enumeration<SolverKind::automatic, SolverKind::gauss_seidel, SolverKind::jacobi, SolverKind::direct,
              SolverKind::conjugate_gradient, SolverKind::dense, SolverKind::hierarchical>(m, "SolverKind");
  enumeration<Sweep::forward, Sweep::symmetric>(m, "Sweep");
  enumeration<Sense::equality, Sense::non_negative>(m, "Sense");
  enumeration<SmoothingShape::wendland, SmoothingShape::poly6_spiky, SmoothingShape::cubic_spline,
              SmoothingShape::wide_wendland>(m, "SmoothingShape");
  enumeration<Detection::continuous, Detection::discrete>(m, "Detection");
  enumeration<SegmentTest::plane_projection, SegmentTest::signed_volumes, SegmentTest::inclusion,
              SegmentTest::moeller_trumbore, SegmentTest::watertight>(m, "SegmentTest");
  enumeration<Threading::automatic, Threading::serial, Threading::pool, Threading::tbb>(m, "Threading");
}

void bind_material_enums(py::handle m) {
  enumeration<StretchModel::springs, StretchModel::membrane>(m, "StretchModel");
  enumeration<BendingModel::isometric, BendingModel::dihedral, BendingModel::distance, BendingModel::none>(
      m, "BendingModel");
  enumeration<SoftBodyModel::neo_hookean, SoftBodyModel::springs, SoftBodyModel::shape_matching>(
      m, "SoftBodyModel");
  enumeration<ObjectKind::cloth, ObjectKind::soft_body, ObjectKind::rope, ObjectKind::grains,
              ObjectKind::obstacle, ObjectKind::fluid, ObjectKind::rigid_body>(m, "ObjectKind");
  enumeration<SelfCollision::off, SelfCollision::particles, SelfCollision::surfaces>(m, "SelfCollision");
}

void bind_file_enums(py::handle m) {
  enumeration<CacheFormat::pc2, CacheFormat::mdd, CacheFormat::obj, CacheFormat::ply>(m, "CacheFormat");
  enumeration<Diagonals::alternating, Diagonals::one_way>(m, "Diagonals");
  enumeration<UpAxis::x, UpAxis::y, UpAxis::z>(m, "UpAxis");
  enumeration<SurfaceMethod::anisotropic, SurfaceMethod::isotropic>(m, "SurfaceMethod");
}

void bind_report_enums(py::handle m) {
  enumeration<Stage::broad_phase, Stage::integrate, Stage::fluids, Stage::contacts, Stage::solve,
              Stage::finish, Stage::velocity, Stage::foam>(m, "Stage");
  enumeration<Flag::non_finite, Flag::large_strain, Flag::deep_contact, Flag::callback_failed,
              Flag::intersecting, Flag::coarse_substeps, Flag::not_converged, Flag::shortened_motion,
              Flag::out_of_range, Flag::jumped>(m, "Flag", "IntFlag");
  enumeration<StepOutcome::done, StepOutcome::refused, StepOutcome::diverged, StepOutcome::abandoned>(
      m, "StepOutcome");
  enumeration<LogLevel::info, LogLevel::warning, LogLevel::error>(m, "LogLevel");
  enumeration<ContactPhase::begin, ContactPhase::persist, ContactPhase::end>(m, "ContactPhase");
  enumeration<FoamKind::spray, FoamKind::foam, FoamKind::bubble>(m, "FoamKind");
}

}  // namespace

void bind_enums(py::module_& m) {
  bind_settings_enums(m);
  bind_material_enums(m);
  bind_file_enums(m);
  bind_report_enums(m);
}

void bind_motor_target(py::handle motor) {
  enumeration<joint::Motor::Target::velocity, joint::Motor::Target::position>(motor, "Target");
}

}  // namespace souple::python
