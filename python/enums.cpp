#include "python/enums.h"

#include "python/bind.h"
#include "python/docs.h"

#include <initializer_list>
#include <utility>

namespace souple::python {

namespace {

/// Makes an enum.IntEnum of C++'s words.
template <class E>
void enumeration(py::handle scope, const char* name, std::initializer_list<std::pair<const char*, E>> words,
                 const char* base = "IntEnum") {
  py::list members;
  for (const auto& [word, value] : words) members.append(py::make_tuple(word, static_cast<long>(value)));
  const py::object module = PyModule_Check(scope.ptr()) != 0 ? py::str("souple") : scope.attr("__module__");
  const py::object made = py::module_::import("enum").attr(base)(name, members, "module"_a = module,
                                                                 "qualname"_a = doc_name(scope, name));
  made.attr("__doc__") = doc(doc_name(scope, name));
  scope.attr(name) = made;
  enum_class<E> = py::object(made).release().ptr();
}

void bind_settings_enums(py::handle m) {
  enumeration<Integrator>(m, "Integrator",
                          {{"semi_implicit", Integrator::semi_implicit},
                           {"explicit_euler", Integrator::explicit_euler},
                           {"implicit_euler", Integrator::implicit_euler}});
  enumeration<Mode>(m, "Mode",
                    {{"small_steps", Mode::small_steps}, {"xpbd", Mode::xpbd}, {"pbd", Mode::pbd}});
  enumeration<SolverKind>(m, "SolverKind",
                          {{"automatic", SolverKind::automatic},
                           {"gauss_seidel", SolverKind::gauss_seidel},
                           {"jacobi", SolverKind::jacobi},
                           {"direct", SolverKind::direct},
                           {"conjugate_gradient", SolverKind::conjugate_gradient},
                           {"dense", SolverKind::dense},
                           {"hierarchical", SolverKind::hierarchical}});
  enumeration<Sweep>(m, "Sweep", {{"forward", Sweep::forward}, {"symmetric", Sweep::symmetric}});
  enumeration<Sense>(m, "Sense", {{"equality", Sense::equality}, {"non_negative", Sense::non_negative}});
  enumeration<SmoothingShape>(m, "SmoothingShape",
                              {{"wendland", SmoothingShape::wendland},
                               {"poly6_spiky", SmoothingShape::poly6_spiky},
                               {"cubic_spline", SmoothingShape::cubic_spline},
                               {"wide_wendland", SmoothingShape::wide_wendland}});
  enumeration<Detection>(m, "Detection",
                         {{"continuous", Detection::continuous}, {"discrete", Detection::discrete}});
  enumeration<SegmentTest>(m, "SegmentTest",
                           {{"plane_projection", SegmentTest::plane_projection},
                            {"signed_volumes", SegmentTest::signed_volumes},
                            {"inclusion", SegmentTest::inclusion},
                            {"moeller_trumbore", SegmentTest::moeller_trumbore},
                            {"watertight", SegmentTest::watertight}});
  enumeration<Threading>(m, "Threading",
                         {{"automatic", Threading::automatic},
                          {"serial", Threading::serial},
                          {"pool", Threading::pool},
                          {"tbb", Threading::tbb}});
}

void bind_material_enums(py::handle m) {
  enumeration<StretchModel>(m, "StretchModel",
                            {{"springs", StretchModel::springs}, {"membrane", StretchModel::membrane}});
  enumeration<BendingModel>(m, "BendingModel",
                            {{"isometric", BendingModel::isometric},
                             {"dihedral", BendingModel::dihedral},
                             {"distance", BendingModel::distance},
                             {"none", BendingModel::none}});
  enumeration<SoftBodyModel>(m, "SoftBodyModel",
                             {{"neo_hookean", SoftBodyModel::neo_hookean},
                              {"springs", SoftBodyModel::springs},
                              {"shape_matching", SoftBodyModel::shape_matching}});
  enumeration<ObjectKind>(m, "ObjectKind",
                          {{"cloth", ObjectKind::cloth},
                           {"soft_body", ObjectKind::soft_body},
                           {"rope", ObjectKind::rope},
                           {"grains", ObjectKind::grains},
                           {"obstacle", ObjectKind::obstacle},
                           {"fluid", ObjectKind::fluid},
                           {"rigid_body", ObjectKind::rigid_body}});
  enumeration<SelfCollision>(m, "SelfCollision",
                             {{"off", SelfCollision::off},
                              {"particles", SelfCollision::particles},
                              {"surfaces", SelfCollision::surfaces}});
}

void bind_file_enums(py::handle m) {
  enumeration<CacheFormat>(m, "CacheFormat",
                           {{"pc2", CacheFormat::pc2},
                            {"mdd", CacheFormat::mdd},
                            {"obj", CacheFormat::obj},
                            {"ply", CacheFormat::ply}});
  enumeration<Diagonals>(m, "Diagonals",
                         {{"alternating", Diagonals::alternating}, {"one_way", Diagonals::one_way}});
  enumeration<UpAxis>(m, "UpAxis", {{"x", UpAxis::x}, {"y", UpAxis::y}, {"z", UpAxis::z}});
  enumeration<SurfaceMethod>(
      m, "SurfaceMethod",
      {{"anisotropic", SurfaceMethod::anisotropic}, {"isotropic", SurfaceMethod::isotropic}});
}

void bind_report_enums(py::handle m) {
  enumeration<Stage>(m, "Stage",
                     {{"broad_phase", Stage::broad_phase},
                      {"integrate", Stage::integrate},
                      {"fluids", Stage::fluids},
                      {"contacts", Stage::contacts},
                      {"solve", Stage::solve},
                      {"finish", Stage::finish},
                      {"velocity", Stage::velocity},
                      {"foam", Stage::foam}});
  enumeration<Flag>(m, "Flag",
                    {{"non_finite", Flag::non_finite},
                     {"large_strain", Flag::large_strain},
                     {"deep_contact", Flag::deep_contact},
                     {"callback_failed", Flag::callback_failed},
                     {"intersecting", Flag::intersecting},
                     {"coarse_substeps", Flag::coarse_substeps},
                     {"not_converged", Flag::not_converged},
                     {"shortened_motion", Flag::shortened_motion},
                     {"out_of_range", Flag::out_of_range}},
                    "IntFlag");
  enumeration<LogLevel>(
      m, "LogLevel", {{"info", LogLevel::info}, {"warning", LogLevel::warning}, {"error", LogLevel::error}});
  enumeration<ContactPhase>(
      m, "ContactPhase",
      {{"begin", ContactPhase::begin}, {"persist", ContactPhase::persist}, {"end", ContactPhase::end}});
  enumeration<FoamKind>(m, "FoamKind",
                        {{"spray", FoamKind::spray}, {"foam", FoamKind::foam}, {"bubble", FoamKind::bubble}});
}

}  // namespace

void bind_enums(py::module_& m) {
  bind_settings_enums(m);
  bind_material_enums(m);
  bind_file_enums(m);
  bind_report_enums(m);
}

void bind_motor_target(py::handle motor) {
  enumeration<joint::Motor::Target>(
      motor, "Target",
      {{"velocity", joint::Motor::Target::velocity}, {"position", joint::Motor::Target::position}});
}

}  // namespace souple::python
