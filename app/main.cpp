#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/view/keys.h"
#include "souple/error.h"
#include "souple/version.h"

#include <cstdio>
#include <exception>
#include <functional>
#include <new>

// The only file that sees CLI11: it costs seconds.
#include <CLI/CLI.hpp>

namespace {

using souple::app::bad_input;
using souple::app::BenchRequest;
using souple::app::failed;
using souple::app::fine;
using souple::app::InfoPart;
using souple::app::RenderRequest;
using souple::app::RunOptions;
using souple::app::SurfaceRequest;
using souple::app::ViewRequest;

constexpr const char* scene_help = "a scene file, or the name of a shipped scene (see `souple list`)";

constexpr const char* main_footer = R"(Examples:
  souple list                                  lists the shipped scenes
  souple run flag                              simulates a scene, writes out/flag
  souple run my/scene.json --frames 100 --write pc2,obj --out renders/a
  souple run --resume out/flag                 resumes an interrupted run
  souple render flag                           simulates a scene, renders its last frame, out/flag.png
  souple render out/flag --out flag.mp4        renders a film of a run
  souple view flag                             simulates a scene in an interactive window
  souple check my/scene.json                   validates a scene and prints a summary
  souple surface out/dam                       meshes the surface of a run's fluids, frame by frame
  souple bench cloth                           measures how fast this machine simulates

Exit codes: 0 success, 1 writing failed, 2 invalid input, 3 the simulation diverged, 130 interrupted.)";

constexpr const char* run_footer = R"(Examples:
  souple run flag --set objects.flag.material.bending_stiffness=1e-5 --set substeps=20
  souple run scene.json --frames 600 --checkpoint-every 100 --out renders/a
  souple run --resume renders/a
  souple run flag --picture flag.png
  souple run dam_break --surface anisotropic   also meshes the water, in out/dam_break_surface

Writes DIR/run.json and, for each object, a mesh with a cache (PC2, MDD) or a sequence (OBJ, PLY). Ctrl-C finishes
the frame, writes a checkpoint and prints how to resume; a second Ctrl-C ends the program immediately. --surface
writes the files that `souple surface` would write from DIR afterwards; --resume continues them.)";

constexpr const char* surface_footer = R"(Examples:
  souple surface out/dam
  souple surface out/dam --method isotropic --format ply --out meshes
  souple surface out/dam --particles bgeo --cell 0.005
  souple surface out/dam --format vdb --out volumes          signed distances, for renderers
  souple render out/dam_surface --out dam.mp4                a film of the surface

Writes DIR/NAME_0001.obj, ... with normals, and DIR/run.json, so that other commands can read the folder. A frame in
which a fluid has no particles has no file. --format vdb writes OpenVDB level sets DIR/NAME_0001.vdb, ..., which other
commands do not read. --particles writes DIR/NAME_particles_0001.bgeo, ... with velocities; if the cache has none, they
are the displacements since the previous frame divided by its time. Ctrl-C finishes the frame.)";

constexpr const char* render_footer = R"(Examples:
  souple render flag --out flag.png --frames 120 --size 1920x1080 --samples 64
  souple render out/flag --out flag.mp4                      a film of all frames of a run
  souple render flag --out flag.gif --frames 1-120 --size 320x180
  souple render jelly_armada --out pictures --frames 10-100/10
  souple render tablecloth --sheet 4x3 --display strain
  souple render flag --camera "from 3,2,4 to 0,1.5,0 fov 30" --set substeps=40

SOURCE is a scene, which is simulated first, or the folder of a run (or its run.json). The ending of --out selects the
output: a picture .png, a film .mp4 or .gif (encoded by the program ffmpeg), else a folder of pictures NAME_0001.png,
numbered by frame. Without --frames, --sheet and --out the output is a picture of the last frame. A .gif shows at most
50 pictures per second: of faster runs every second or third frame. Rendering needs EGL, but no screen. Equal frames
give equal files. Ctrl-C finishes the current picture and the film so far.

displays:     shaded, plain, wireframe, strain, speed, particles, lattice, normals, contacts
constraints:  none, kind, color, strain, residual)";

const std::string view_footer = R"(Examples:
  souple view flag
  souple view my/scene.json --paused
  souple view out/flag                         plays a finished run, with a time slider

)";

constexpr const char* check_footer = R"(Example:
  souple check flag --set objects.flag.mesh.grid.columns=100

Prints a summary of the scene and the repairs of its meshes. Exit code 2: the scene is invalid.)";

constexpr const char* list_footer = R"(Example:
  souple list --json)";

constexpr const char* bench_footer = R"(Examples:
  souple bench                                 lists the benchmarks
  souple bench cloth --threads 2
  souple bench cloth --json > before.json      then, after a change:
  souple bench cloth --compare before.json
  souple bench cloth --solver hierarchical --iterations 2
  souple bench cloth --residual 0.01 --json    also measures the time until the strain is 1 %

Steps of 1/60 s are timed by the wall clock: medians of --runs steps after --warm-up untimed ones. Projections per
second are those of one kind alone. Reports do not measure residuals meanwhile; the largest strain is that after the
last step. --residual removes gravity, stretches the cloth by 10 % and solves once, without steps. Measure on an idle
machine.

solvers: gauss_seidel, jacobi, direct, conjugate_gradient, dense, hierarchical)";

constexpr const char* info_footer = R"(Examples:
  souple info
  souple info --schema > scene.schema.json     for editors that validate JSON
  souple info --memory flag                    memory of a running scene, bytes by part)";

void add_settings(CLI::App& command, std::vector<std::string>& settings) {
  command
      .add_option("--set", settings,
                  "change a value of the scene: PATH=VALUE, such as substeps=20; repeatable")
      ->allow_extra_args(false)
      ->type_name("PATH=VALUE");
}

void add_run(CLI::App& app, std::function<int()>& action) {
  auto options = std::make_shared<RunOptions>();
  CLI::App& command = *app.add_subcommand("run", "simulate a scene and write its caches");
  command.footer(run_footer);
  command.add_option("SCENE", options->scene, scene_help);
  command.add_option("--frames", options->frames, "number of frames to simulate, instead of the scene's")
      ->type_name("N");
  command.add_option("--out", options->out, "output folder [out/NAME]")->type_name("DIR");
  command.add_option("--write", options->formats, "caches to write: pc2, mdd, obj, ply [pc2]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"pc2", "mdd", "obj", "ply"}))
      ->type_name("FORMATS");
  command
      .add_option("--threads", options->threads,
                  "number of threads; results do not depend on it [SOUPLE_THREADS, else all processors]")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command.add_option("--substeps", options->substeps, "short for --set substeps=N")->type_name("N");
  command.add_option("--iterations", options->iterations, "short for --set iterations=N")->type_name("N");
  add_settings(command, options->settings);
  command.add_option("--resume", options->resume, "resume the interrupted run of this folder")
      ->type_name("DIR");
  command.add_option("--checkpoint-every", options->checkpoint_every, "write a checkpoint every N frames")
      ->type_name("N");
  command
      .add_option("--surface", options->surface,
                  "also write meshes of fluids, into DIR_surface: anisotropic, isotropic")
      ->type_name("METHOD");
  command.add_option("--picture", options->picture, "render the last frame into a picture, 1280x720")
      ->type_name("FILE.png");
  command.add_flag("--quiet", options->quiet, "print nothing but errors");
  command.callback([options, &action] { action = [options] { return souple::app::run(*options); }; });
}

void add_render(CLI::App& app, std::function<int()>& action) {
  auto request = std::make_shared<RenderRequest>();
  CLI::App& command = *app.add_subcommand("render", "render pictures and films of a scene or of a run");
  command.footer(render_footer);
  command
      .add_option("SOURCE", request->source,
                  "a scene file, the name of a shipped scene, or the folder of a run or its run.json")
      ->required();
  command
      .add_option("--out", request->out,
                  "a picture .png, a film .mp4 or .gif, or a folder [out/NAME.png; out/NAME.mp4 if --frames "
                  "selects several]")
      ->type_name("PATH");
  command
      .add_option("--frames", request->frames,
                  "frames to render: N, A-B, A-B/STEP, last, all; B may be last [a picture: last; else all]")
      ->type_name("FRAMES");
  command.add_option("--sheet", request->sheet, "arrange frames of the run on one page of this size")
      ->type_name("COLUMNSxROWS");
  command
      .add_option("--size", request->size,
                  "size of a picture in pixels [1280x720; .gif 640x360; each of a sheet 480x270]")
      ->type_name("WIDTHxHEIGHT");
  command
      .add_option("--samples", request->samples,
                  "number of pictures averaged into one [16; films and folders 4]")
      ->type_name("N");
  command
      .add_option("--colors", request->colors,
                  "reduce pictures to N colors, at most 256: a third of the file size")
      ->type_name("N");
  command
      .add_option(
          "--camera", request->camera,
          "\"from X,Y,Z to X,Y,Z fov DEGREES\" or a part of it, or auto: fit all objects into the picture "
          "[the scene's, else auto]")
      ->type_name("CAMERA");
  command.add_option("--display", request->display, "display of objects, see below [shaded]")
      ->type_name("DISPLAY");
  command.add_option("--constraints", request->constraints, "coloring of constraints, see below [none]")
      ->type_name("CONSTRAINTS");
  command
      .add_option("--liquid-splats", request->liquid_splats,
                  "shape of a fluid's particles: spheres, ellipsoids [ellipsoids]")
      ->type_name("SPLATS");
  command
      .add_option("--liquid-filter", request->liquid_filter,
                  "filter of fluid surfaces: narrow-range, curvature-flow or none [narrow-range]")
      ->type_name("FILTER");
  command
      .add_option("--liquid-steps", request->liquid_steps,
                  "steps of curvature flow or passes of the narrow-range filter [40; 2]")
      ->type_name("N");
  add_settings(command, request->settings);
  command.add_flag("--quiet", request->quiet, "print nothing but errors");
  command.callback(
      [request, &action] { action = [request] { return souple::app::render_frames(*request); }; });
}

void add_view(CLI::App& app, std::function<int()>& action) {
  auto request = std::make_shared<ViewRequest>();
  CLI::App& command = *app.add_subcommand("view", "simulate a scene, or play a finished run, in a window");
  command.footer(view_footer + souple::viewer::keys_text());
  command.add_option(
      "SOURCE", request->source,
      "a scene file, the name of a shipped scene, or the folder of a run or its run.json [curtain]");
  command.add_flag("--paused", request->paused, "do not start before Space is pressed");
  command.add_option("--size", request->size, "size of the window [1440x900]")->type_name("WIDTHxHEIGHT");
  command.add_option("--frames", request->frames, "quit after N frames of the window")->type_name("N");
  command.add_flag("--debug", request->debug, "quit with a message if OpenGL reports an error");
  command.callback([request, &action] { action = [request] { return souple::app::view(*request); }; });
}

void add_surface(CLI::App& app, std::function<int()>& action) {
  auto request = std::make_shared<SurfaceRequest>();
  CLI::App& command = *app.add_subcommand("surface", "mesh the surfaces of a run's fluids");
  command.footer(surface_footer);
  command.add_option("CACHE", request->cache, "the folder of a run, or its run.json")->required();
  command.add_option("--out", request->out, "output folder [CACHE_surface]")->type_name("DIR");
  command.add_option("--method", request->method, "kernels: anisotropic, isotropic [anisotropic]")
      ->type_name("METHOD");
  command.add_option("--format", request->format, "meshes: obj, ply; volumes: vdb [obj]")
      ->type_name("FORMAT");
  command
      .add_option("--particles", request->particles, "also write the particles: none, ply, vtk, bgeo [none]")
      ->type_name("FORMAT");
  command
      .add_option("--object", request->objects,
                  "mesh only this object; repeatable [all fluids, else all grains]")
      ->type_name("NAME");
  command.add_option("--cell", request->cell, "cell size of the meshing grid [half a spacing]")
      ->type_name("METERS");
  command.add_option("--spacing", request->spacing, "spacing of the particles [the scene's]")
      ->type_name("METERS");
  command.add_option("--smoothing", request->smoothing, "passes of Laplacian smoothing [0]")->type_name("N");
  command.add_option("--threads", request->threads, "threads; 0: one for each processor [0]")->type_name("N");
  command.add_flag("--quiet", request->quiet, "print nothing but errors");
  command.callback([request, &action] { action = [request] { return souple::app::surface(*request); }; });
}

void add_bench_solver(CLI::App& command, BenchRequest& request) {
  command.add_option("--solver", request.solver, "solver, see below [gauss_seidel]")->type_name("SOLVER");
  command.add_option("--sweep", request.sweep, "order of the colors: forward, symmetric [forward]")
      ->type_name("SWEEP");
  command.add_option("--relaxation", request.relaxation, "factor on corrections, between 0 and 2 [1]")
      ->type_name("FACTOR");
  command.add_option("--chebyshev", request.chebyshev, "acceleration: spectral radius, below 1 [0: none]")
      ->type_name("RHO");
  command
      .add_option("--colors", request.colors, "partition constraints into N colors [0: as many as necessary]")
      ->type_name("N");
}

void add_bench(CLI::App& app, std::function<int()>& action) {
  auto request = std::make_shared<BenchRequest>();
  CLI::App& command = *app.add_subcommand("bench", "measure how fast this machine simulates");
  command.footer(bench_footer);
  command.add_option("NAME", request->name, "name of the benchmark; without it, lists all benchmarks");
  command.add_option("--size", request->size, "size of the benchmark; the list gives its meaning")
      ->type_name("N");
  command.add_option("--threads", request->threads, "threads; 0: one for each processor [1]")->type_name("N");
  command.add_option("--threading", request->threading, "automatic, serial, pool, tbb [automatic]")
      ->type_name("KIND");
  command.add_option("--substeps", request->substeps, "substeps of a step [10]")->type_name("N");
  command.add_option("--iterations", request->iterations, "solver iterations in each substep [1]")
      ->type_name("N");
  add_bench_solver(command, *request);
  command.add_option("--mode", request->mode, "small_steps, xpbd, pbd [small_steps]")->type_name("MODE");
  command.add_option("--form", request->form, "displacement, plain [displacement]")->type_name("FORM");
  command.add_option("--warm-up", request->warm_up, "untimed steps before the measurement [5]")
      ->type_name("N");
  command.add_option("--runs", request->runs, "timed steps [30]")->type_name("N");
  command
      .add_option("--residual", request->residual,
                  "also measure the time to this mean strain, such as 0.01; cloths only")
      ->type_name("STRAIN");
  command.add_option("--compare", request->compare, "print ratios to the result in this file")
      ->type_name("FILE.json");
  command.add_flag("--json", request->json, "print JSON");
  command.callback([request, &action] { action = [request] { return souple::app::bench(*request); }; });
}

void add_list(CLI::App& app, std::function<int()>& action) {
  auto as_json = std::make_shared<bool>(false);
  CLI::App& command = *app.add_subcommand("list", "list the shipped scenes");
  command.footer(list_footer);
  command.add_flag("--json", *as_json, "as JSON: name, file, description");
  command.callback([as_json, &action] { action = [as_json] { return souple::app::list(*as_json); }; });
}

void add_check(CLI::App& app, std::function<int()>& action) {
  auto scene = std::make_shared<std::string>();
  auto settings = std::make_shared<std::vector<std::string>>();
  CLI::App& command = *app.add_subcommand("check", "validate a scene and its meshes, print a summary");
  command.footer(check_footer);
  command.add_option("SCENE", *scene, scene_help)->required();
  add_settings(command, *settings);
  command.callback([scene, settings, &action] {
    action = [scene, settings] { return souple::app::check(*scene, *settings); };
  });
}

void add_info(CLI::App& app, std::function<int()>& action) {
  auto part = std::make_shared<InfoPart>(InfoPart::all);
  auto scene = std::make_shared<std::string>();
  auto settings = std::make_shared<std::vector<std::string>>();
  CLI::App& command =
      *app.add_subcommand("info", "print version, compiler, optional parts, folders of scenes");
  command.footer(info_footer);
  auto* schema = command.add_flag_callback(
      "--schema", [part] { *part = InfoPart::schema; }, "print the JSON schema of scene files");
  command
      .add_flag_callback(
          "--scene-format", [part] { *part = InfoPart::scene_format; },
          "print the manual page of scene files")
      ->excludes(schema);
  command.add_option("--memory", *scene, "print the memory of this scene while it runs")
      ->excludes(schema)
      ->type_name("SCENE");
  add_settings(command, *settings);
  command.callback([part, scene, settings, &action] {
    action = [part, scene, settings] {
      return scene->empty() ? souple::app::info(*part) : souple::app::memory(*scene, *settings);
    };
  });
}

int perform(const std::function<int()>& action) {
  try {
    return action();
  } catch (const souple::Error& error) {
    std::fprintf(stderr, "souple: %s\n", error.what());
    return bad_input;
  } catch (const std::bad_alloc&) {
    std::fputs("souple: out of memory: the scene is too large for this machine\n", stderr);
    return bad_input;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "souple: %s\n", error.what());
    return failed;
  }
}

/// "run, list, check or info"
std::string command_names(const CLI::App& app) {
  std::string names;
  const std::vector<const CLI::App*> commands = app.get_subcommands([](const CLI::App*) { return true; });
  for (std::size_t i = 0; i < commands.size(); ++i) {
    if (i > 0) names += i + 1 == commands.size() ? " or " : ", ";
    names += commands[i]->get_name();
  }
  return names;
}

/// Error message for the command line, on one line.
std::string complaint(CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && app.get_subcommands().empty()) {
    const std::string commands = command_names(app);
    if (argc < 2) return "expected a command: " + commands;
    const bool option = argv[1][0] == '-';
    return std::string(argv[1]) + ": there is no such " + (option ? "option" : "command") + "; expected " +
           commands;
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    for (const std::string& argument : app.remaining(true)) {
      if (argument.rfind('-', 0) == 0) return argument + ": there is no such option";
    }
    for (const std::string& argument : app.remaining(true)) return argument + ": one argument too many";
  }
  std::string what = error.what(), conversion = "Could not convert: ";
  if (what.rfind(conversion, 0) == 0)
    return what.substr(conversion.size()) + ": expected a whole number, 0 or more";
  return what;
}

}  // namespace

int main(int argc, char** argv) {
  std::function<int()> action;
  CLI::App app(
      "Souple simulates cloth, soft bodies, ropes, grains and fluids from scene files, and writes caches "
      "that Blender and Houdini open.",
      "souple");
  app.footer(main_footer);
  app.set_version_flag("--version", std::string("souple ") + souple::version, "print the version");
  app.require_subcommand(1);
  add_run(app, action);
  add_render(app, action);
  add_view(app, action);
  add_list(app, action);
  add_check(app, action);
  add_surface(app, action);
  add_bench(app, action);
  add_info(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error) == 0 ? fine : bad_input;  // --help, --version
    std::fprintf(stderr, "souple: %s; see `souple --help` and `souple run --help`\n",
                 complaint(app, error, argc, argv).c_str());
    return bad_input;
  }
  return perform(action);
}
