#include "souple/scene/keys/parts.h"
#include "souple/solver/solver_names.h"

namespace souple::scene_format {

namespace {

CodecPtr<Sleeping> sleeping_codec() {
  auto keys = table<Sleeping>("sleeping",
                              "Objects at rest fall asleep, touching objects together. They wake when "
                              "something moves them or moves near them.");
  keys->key<&Sleeping::enabled>("enabled", boolean(), "whether objects may fall asleep")
      .key<&Sleeping::speed>("speed", number<float>(from_zero(1000)),
                             "speed limit of a resting object's particles, from frame to frame [m/s]")
      .key<&Sleeping::seconds>("seconds", number<float>(positive(1e6)),
                               "time at rest before an object falls asleep [s]");
  return keys;
}

CodecPtr<FoamRange> foam_range_codec(const char* description) {
  auto keys = table<FoamRange>("foam_range", description);
  keys->key<&FoamRange::low>("low", number<float>(from_zero(1e6)), "values below count as nothing")
      .key<&FoamRange::high>("high", number<float>(from_zero(1e6)), "values above count in full");
  return keys;
}

CodecPtr<FoamParameters> foam_codec() {
  using F = FoamParameters;
  auto keys =
      table<F>("foam_settings", "Spray, foam and bubbles of fluids whose material has `foam` above 0.");
  const auto range = foam_range_codec("A ramp from nothing at `low` to all at `high`.");
  keys->key<&F::max_particles>("max_particles", number<std::size_t>(within(0, 1e8)),
                               "maximum number of foam particles; new ones beyond it are thinned evenly")
      .key<&F::trapped_air_rate>("trapped_air_rate", number<float>(from_zero(1e6)),
                                 "maximum emission of one fluid particle by trapped air [1/s]")
      .key<&F::wave_crest_rate>("wave_crest_rate", number<float>(from_zero(1e6)),
                                "maximum emission of one fluid particle at wave crests [1/s]")
      .key<&F::trapped_air>("trapped_air", range,
                            "closing speed of a fluid particle's neighbors, summed [m/s]")
      .key<&F::wave_crest>(
          "wave_crest", range,
          "bending of the surface: 1 - cos of the angle between normals, summed over neighbors")
      .key<&F::energy>("energy", range, "kinetic energy per mass, v^2 / 2 [m^2/s^2]")
      .key<&F::life>("life", range, "life of foam from the weakest and from the strongest emission [s]")
      .key<&F::longest_life>("longest_life", number<float>(from_zero(1e6)),
                             "maximum age of foam particles, spray and bubbles included [s]")
      .key<&F::buoyancy>("buoyancy", number<float>(from_zero(1e3)), "buoyancy of bubbles, over gravity")
      .key<&F::drag>("drag", number<float>(positive(1e6)),
                     "rate at which bubbles adopt the fluid's velocity [1/s]")
      .key<&F::spray_neighbors>("spray_neighbors", number<int>(within(0, 1000)),
                                "with fewer fluid particles around, a foam particle is spray")
      .key<&F::bubble_neighbors>("bubble_neighbors", number<int>(within(0, 1000)),
                                 "with more fluid particles around, a foam particle is a bubble");
  return keys;
}

CodecPtr<FluidSettings> fluid_settings_codec() {
  auto keys = table<FluidSettings>("fluid_settings", "The pressure solver of fluids.");
  keys->key<&FluidSettings::kernel>(
          "kernel",
          enumeration<SmoothingShape>({{"wendland", SmoothingShape::wendland},
                                       {"poly6_spiky", SmoothingShape::poly6_spiky},
                                       {"cubic_spline", SmoothingShape::cubic_spline},
                                       {"wide_wendland", SmoothingShape::wide_wendland}}),
          "smoothing kernel: the weight of a neighbor by its distance")
      .key<&FluidSettings::iterations>("iterations", number<int>(within(0, 100)),
                                       "Jacobi iterations after the coarse level; 0 is the cheapest")
      .key<&FluidSettings::tolerance>(
          "tolerance", number<float>(unit),
          "above 0: more iterations, up to 50, until the mean density error is below it")
      .key<&FluidSettings::foam>("foam", foam_codec(), "spray, foam and bubbles")
      .key<&FluidSettings::compressibility>("compressibility", number<float>(from_zero(1)),
                                            "relative increase of density per pressure [1/Pa]")
      .key<&FluidSettings::artificial_pressure>(
          "artificial_pressure", number<float>(from_zero(1e9)),
          "extra pressure between two particles 0.4 spacings apart, against clumping [Pa]");
  return keys;
}

}  // namespace

CodecPtr<Wind> wind_codec() {
  auto keys = table<Wind>("wind", "Air, still or moving.");
  keys->key<&Wind::velocity>("velocity", vector3<float>(signed_range(1000)), "velocity of the air [m/s]")
      .key<&Wind::gust>("gust", number<float>(unit), "variation of the wind's strength, as a fraction")
      .key<&Wind::gust_period>("gust_period", number<float>(positive(1e4)), "period of the slowest gusts [s]")
      .key<&Wind::air_density>("air_density", number<float>(from_zero(1e4)), "density of the air [kg/m^3]");
  return keys;
}

void add_setting_keys(Table<SceneDescription>& keys) {
  using S = SceneDescription;
  keys.foreign({{"form", "older versions; now the solver always moves displacements"}});
  keys.key<&S::settings, &Settings::substeps>("substeps", number<int>(within(1, 10000)), "substeps per frame")
      .key<&S::settings, &Settings::iterations>("iterations", number<int>(within(1, 10000)),
                                                "solver iterations per substep")
      .key<&S::settings, &Settings::mode>(
          "mode", enumeration<Mode>({std::begin(mode_names), std::end(mode_names)}),
          "how constraints are enforced: compliance with many substeps, compliance with stored multipliers, "
          "or classic PBD with a stiffness in [0, 1]")
      .key<&S::settings, &Settings::integrator>(
          "integrator",
          enumeration<Integrator>({{"semi_implicit", Integrator::semi_implicit},
                                   {"explicit_euler", Integrator::explicit_euler},
                                   {"implicit_euler", Integrator::implicit_euler}}),
          "time integration of velocities and positions")
      .key<&S::settings, &Settings::gravity>("gravity", vector3<float>(signed_range(1e4)),
                                             "gravitational acceleration [m/s^2]")
      .key<&S::settings, &Settings::drag>("drag", number<float>(from_zero(1e4)),
                                          "drag rate of all particles relative to the wind [1/s]")
      .key<&S::settings, &Settings::seed>("seed", number<std::uint64_t>(from_zero(9007199254740991.0)),
                                          "random seed of gusts, foam and the jitter of grains")
      .key<&S::settings, &Settings::measure_residuals>(
          "measure_residuals", boolean(), "report residuals and strain each frame; costs about one iteration")
      .key<&S::settings, &Settings::solver, &SolverSettings::kind>(
          "solver", enumeration<SolverKind>({std::begin(solver_names), std::end(solver_names)}),
          "solver for the constraints of a substep")
      .key<&S::settings, &Settings::solver, &SolverSettings::sweep>(
          "sweep", enumeration<Sweep>({std::begin(sweep_names), std::end(sweep_names)}),
          "order of colors within an iteration: forward, or forward and then backward")
      .key<&S::settings, &Settings::solver, &SolverSettings::relaxation>(
          "relaxation", number<float>(Range{0, 2, true, true}),
          "factor on every correction: over-relaxation above 1")
      .key<&S::settings, &Settings::solver, &SolverSettings::chebyshev>(
          "chebyshev", number<float>(below(1)),
          "Chebyshev acceleration of the iterations: assumed spectral radius; 0: off")
      .key<&S::settings, &Settings::solver, &SolverSettings::colors>(
          "colors", number<int>(within(0, 64)),
          "number of colors to which phantom particles limit the constraint graph; 0: no phantom particles")
      .key<&S::settings, &Settings::segment_test>(
          "segment_test",
          enumeration<SegmentTest>({std::begin(segment_test_names), std::end(segment_test_names)}),
          "intersection test with triangles: of picking rays, and of paths with `detection` discrete")
      .key<&S::settings, &Settings::detection>(
          "detection",
          enumeration<Detection>({{"continuous", Detection::continuous}, {"discrete", Detection::discrete}}),
          "how contacts between surfaces are found: discrete tests the paths of vertices alone and serves "
          "for "
          "comparison")
      .key<&S::settings, &Settings::fluid>("fluid", fluid_settings_codec(),
                                           "pressure solver and foam of fluids")
      .key<&S::settings, &Settings::sleeping>("sleeping", sleeping_codec(),
                                              "sleeping of resting objects, which saves time");
}

}  // namespace souple::scene_format
