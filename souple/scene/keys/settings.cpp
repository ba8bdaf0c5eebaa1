#include "souple/scene/keys/parts.h"
#include "souple/solver/solver_names.h"

namespace souple::scene_format {

namespace {

CodecPtr<Sleeping> sleeping_codec() {
  auto keys = table<Sleeping>("sleeping",
                              "Objects at rest fall asleep, those in touch together, and wake when something "
                              "moves them or near them.");
  keys->key<&Sleeping::enabled>("enabled", boolean(), "whether they do")
      .key<&Sleeping::speed>("speed", number<float>(from_zero(1000)),
                             "of an object at rest no particle moves faster, from frame to frame [m/s]")
      .key<&Sleeping::seconds>("seconds", number<float>(positive(1e6)), "of rest before it falls asleep [s]");
  return keys;
}

CodecPtr<FoamRange> foam_range_codec(const char* description) {
  auto keys = table<FoamRange>("foam_range", description);
  keys->key<&FoamRange::low>("low", number<float>(from_zero(1e6)), "what is below counts nothing")
      .key<&FoamRange::high>("high", number<float>(from_zero(1e6)), "what is above counts in full");
  return keys;
}

CodecPtr<FoamParameters> foam_codec() {
  using F = FoamParameters;
  auto keys =
      table<F>("foam_settings", "Spray, foam and bubbles of fluids whose material has `foam` above 0.");
  const auto range = foam_range_codec("Between which values a part grows from none to all.");
  keys->key<&F::max_particles>("max_particles", number<std::size_t>(within(0, 1e8)),
                               "particles; above, what is new is thinned out")
      .key<&F::trapped_air_rate>("trapped_air_rate", number<float>(from_zero(1e6)),
                                 "particles that one of the fluid makes at most by trapping air [1/s]")
      .key<&F::wave_crest_rate>("wave_crest_rate", number<float>(from_zero(1e6)),
                                "the same at the crest of a wave [1/s]")
      .key<&F::trapped_air>("trapped_air", range, "how fast its neighbors have to come closer, summed [m/s]")
      .key<&F::wave_crest>("wave_crest", range, "how much the surface has to be bent")
      .key<&F::energy>("energy", range, "v^2 / 2 that it needs [m^2/s^2]")
      .key<&F::life>("life", range, "of foam: of what little made it, and of what much did [s]")
      .key<&F::longest_life>("longest_life", number<float>(from_zero(1e6)), "of spray and bubbles too [s]")
      .key<&F::buoyancy>("buoyancy", number<float>(from_zero(1e3)), "of bubbles, over gravity")
      .key<&F::drag>("drag", number<float>(positive(1e6)),
                     "how quickly bubbles take the fluid's velocity [1/s]")
      .key<&F::spray_neighbors>("spray_neighbors", number<int>(within(0, 1000)),
                                "with fewer fluid particles around it is spray")
      .key<&F::bubble_neighbors>("bubble_neighbors", number<int>(within(0, 1000)),
                                 "with more it is a bubble");
  return keys;
}

CodecPtr<FluidSettings> fluid_settings_codec() {
  auto keys = table<FluidSettings>("fluid_settings", "How fluids are kept from being compressed.");
  keys->key<&FluidSettings::kernel>(
          "kernel",
          enumeration<SmoothingShape>({{"wendland", SmoothingShape::wendland},
                                       {"poly6_spiky", SmoothingShape::poly6_spiky},
                                       {"cubic_spline", SmoothingShape::cubic_spline},
                                       {"wide_wendland", SmoothingShape::wide_wendland}}),
          "how the weight of a neighbor falls with its distance")
      .key<&FluidSettings::iterations>("iterations", number<int>(within(0, 100)),
                                       "Jacobi iterations after the coarse level; 0 is the cheapest")
      .key<&FluidSettings::tolerance>(
          "tolerance", number<float>(unit),
          "above 0: more iterations, up to 50, until the mean density error is below it")
      .key<&FluidSettings::foam>("foam", foam_codec(), "spray, foam and bubbles")
      .key<&FluidSettings::compressibility>("compressibility", number<float>(from_zero(1)),
                                            "fluids are denser by this times their pressure [1/Pa]")
      .key<&FluidSettings::artificial_pressure>(
          "artificial_pressure", number<float>(from_zero(1e9)),
          "with which two particles push each other that are 0.4 spacings apart [Pa]");
  return keys;
}

}  // namespace

CodecPtr<Wind> wind_codec() {
  auto keys = table<Wind>("wind", "Moving air.");
  keys->key<&Wind::velocity>("velocity", vector3<float>(signed_range(1000)), "[m/s]")
      .key<&Wind::gust>("gust", number<float>(unit), "its strength varies by this fraction")
      .key<&Wind::gust_period>("gust_period", number<float>(positive(1e4)), "of the slowest of the gusts [s]")
      .key<&Wind::air_density>("air_density", number<float>(from_zero(1e4)), "[kg/m^3]");
  return keys;
}

void add_setting_keys(Table<SceneDescription>& keys) {
  using S = SceneDescription;
  keys.key<&S::settings, &Settings::substeps>("substeps", number<int>(within(1, 10000)),
                                              "parts a frame is cut into")
      .key<&S::settings, &Settings::iterations>("iterations", number<int>(within(1, 10000)),
                                                "of the solver in each substep")
      .key<&S::settings, &Settings::mode>(
          "mode", enumeration<Mode>({std::begin(mode_names), std::end(mode_names)}),
          "how constraints are enforced: compliance and many substeps, compliance with stored multipliers, "
          "or "
          "the stiffness in [0, 1] of classic PBD")
      .key<&S::settings, &Settings::form>(
          "form", enumeration<Form>({{"displacement", Form::displacement}, {"plain", Form::plain}}),
          "what the solver moves; plain loses digits and is there to compare with")
      .key<&S::settings, &Settings::integrator>(
          "integrator",
          enumeration<Integrator>({{"semi_implicit", Integrator::semi_implicit},
                                   {"explicit_euler", Integrator::explicit_euler},
                                   {"implicit_euler", Integrator::implicit_euler}}),
          "how forces become velocities and positions")
      .key<&S::settings, &Settings::gravity>("gravity", vector3<float>(signed_range(1e4)), "[m/s^2]")
      .key<&S::settings, &Settings::drag>("drag", number<float>(from_zero(1e4)),
                                          "slows everything relative to the wind [1/s]")
      .key<&S::settings, &Settings::seed>("seed", number<std::uint64_t>(from_zero(9007199254740991.0)),
                                          "of the gusts and of the jitter of grains")
      .key<&S::settings, &Settings::measure_residuals>(
          "measure_residuals", boolean(),
          "reports residuals and strain each frame: costs about one iteration")
      .key<&S::settings, &Settings::solver, &SolverSettings::kind>(
          "solver", enumeration<SolverKind>({std::begin(solver_names), std::end(solver_names)}),
          "how the constraints of a substep are solved")
      .key<&S::settings, &Settings::solver, &SolverSettings::sweep>(
          "sweep", enumeration<Sweep>({std::begin(sweep_names), std::end(sweep_names)}),
          "in which order colors are solved: the same every time, or forward and backward")
      .key<&S::settings, &Settings::solver, &SolverSettings::relaxation>(
          "relaxation", number<float>(Range{0, 2, true, true}),
          "factor on every correction: over-relaxation above 1")
      .key<&S::settings, &Settings::solver, &SolverSettings::chebyshev>(
          "chebyshev", number<float>(below(1)),
          "acceleration of the iterations: the spectral radius it assumes; 0: none")
      .key<&S::settings, &Settings::solver, &SolverSettings::colors>(
          "colors", number<int>(within(0, 64)),
          "to which phantom particles cut the constraint graph; 0: as many as it takes without")
      .key<&S::settings, &Settings::segment_test>(
          "segment_test",
          enumeration<SegmentTest>({std::begin(segment_test_names), std::end(segment_test_names)}),
          "how rays that pick are tested against triangles")
      .key<&S::settings, &Settings::fluid>("fluid", fluid_settings_codec(), "of fluids")
      .key<&S::settings, &Settings::sleeping>("sleeping", sleeping_codec(), "what lies still costs little");
}

}  // namespace souple::scene_format
