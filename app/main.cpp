#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/out_of_memory.h"
#include "app/view/keys.h"
#include "souple/error.h"
#include "souple/files/write_error.h"
#include "souple/version.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <functional>
#include <iostream>
#include <iterator>
#include <new>
#include <string_view>
#include <system_error>

// The only file that includes CLI11, which costs seconds of compile time.
#include <CLI/CLI.hpp>

namespace {

using souple::app::bad_input;
using souple::app::BenchRequest;
using souple::app::ConvertRequest;
using souple::app::failed;
using souple::app::InfoPart;
using souple::app::RenderRequest;
using souple::app::RunOptions;
using souple::app::success;
using souple::app::SurfaceRequest;
using souple::app::SweepRequest;
using souple::app::ViewRequest;

constexpr const char* scene_help = "a scene file, or the name of a shipped scene (see `souple list`)";

constexpr const char* main_footer = R"(Examples:
  souple list                                  list the shipped scenes
  souple run flag                              simulate a scene, write out/flag
  souple run my/scene.json --frames 100 --write pc2,obj --out renders/a
  souple run --resume out/flag                 resume an interrupted run
  souple render flag                           simulate a scene, write a picture of its last frame, out/flag.png
  souple render out/flag --out flag.mp4        make a film of a run
  souple view flag                             simulate a scene and show it in a window
  souple check my/scene.json                   read a scene and report what it contains
  souple surface out/dam                       make a mesh of a fluid's particles, frame by frame
  souple convert out/flag --write glb,usda     write a run for other programs
  souple sweep flag --set substeps=5:20:4      simulate a scene with several values and compare the results
  souple bench cloth                           measure how fast this machine simulates

Exit codes: 0 success, 1 writing failed, 2 bad input or out of memory, 3 the simulation diverged, 130 interrupted.)";

constexpr const char* run_footer = R"(Examples:
  souple run flag --set objects.flag.material.bending_stiffness=1e-5 --set substeps=20
  souple run scene.json --frames 600 --checkpoint-every 100 --out renders/a
  souple run --resume renders/a
  souple run flag --picture flag.png
  souple run dam_break --surface anisotropic   also meshes of the water, in out/dam_break_surface

Writes DIR/run.json and, for each object, a mesh and its cache (PC2, MDD) or a sequence (OBJ, PLY). Ctrl-C finishes
the frame, writes a checkpoint and prints the command to resume; a second Ctrl-C ends the program immediately.
--surface writes the meshes that `souple surface` would make from DIR afterwards; --resume continues them.)";

constexpr const char* surface_footer = R"(Examples:
  souple surface out/dam
  souple surface out/dam --method isotropic --format ply --out meshes
  souple surface out/dam --particles bgeo --cell 0.005
  souple surface out/dam --format vdb --out volumes          signed distances, for renderers
  souple render out/dam_surface --out dam.mp4                a film of the surface

Writes DIR/NAME_0001.obj, ... with normals, and DIR/run.json, so that other commands read the folder. A frame in which
a fluid has no particles gets no file. --format vdb writes DIR/NAME_0001.vdb, ...: OpenVDB level sets, which other
commands do not read. --particles writes DIR/NAME_particles_0001.bgeo, ... with velocities (if the cache holds none:
displacement since the previous frame divided by its duration). Ctrl-C finishes the frame.)";

constexpr const char* sweep_footer = R"(Examples:
  souple sweep flag --set objects.flag.material.bending_stiffness=1e-6:1e-4:log5 --set wind.velocity.0=0:10:3 --out DIR
  souple sweep flag --set mode=small_steps,xpbd --set substeps=10,20,40 --set drag=0.1 --write pc2
  souple sweep flag --set substeps=5:20:4 --dry-run          list the runs
  souple sweep flag --set substeps=5:20:4 --slurm job.sh     then: sbatch job.sh

Values: A:B:N is N numbers from A to B in equal steps, A:B:logN in equal factors, A,B,C a list; others are one value.
Runs are all combinations; values of the last --set change first. Each run is a process with one thread and writes
DIR/0001/result.json at its end; DIR/table.csv and DIR/table.json have a row for each run, DIR/sheet.png its last
picture. The same command, after Ctrl-C, a crash or from another machine, does the runs that are missing. Another
version, scene or setting is refused. Exit code 3: runs diverged, 2: runs failed; the table is complete.)";

constexpr const char* convert_footer = R"(Examples:
  souple convert out/flag --write glb          out/flag_converted/flag.glb, with an animation
  souple convert out/dam --write usda --out dam_usd
  souple convert out/flag --write glb --layout frames

glb is binary glTF 2.0. A run of at most 600 frames and 64 MB whose meshes keep their triangles becomes DIR/NAME.glb with
a morph target a frame; others become DIR/NAME_0001.glb, ... with velocities. usda is the text form of USD: DIR/NAME.usda
with time samples; above 100 MB these are value clips, DIR/NAME_clips/NAME_0001.usda, ... --layout one or frames decides
instead. Where one format fails, the files of frames before it remain. docs/files.md lists what each file holds.)";

constexpr const char* render_footer = R"(Examples:
  souple render flag --out flag.png --frames 120 --size 1920x1080 --samples 64
  souple render out/flag --out flag.mp4                      a film of all frames of a run
  souple render flag --out flag.gif --frames 1-120 --size 320x180
  souple render flag --out flag.webp --frames 1-last/4 --film-bytes 500000
  souple render jelly_armada --out pictures --frames 10-100/10
  souple render tablecloth --sheet 4x3 --display strain
  souple render flag --camera "from 3,2,4 to 0,1.5,0 fov 30" --set substeps=40

A scene is simulated while it is rendered; the folder of a run (or its run.json) is read. --out selects the output: a
picture .png, a film .mp4, .gif or .webp (made by the program ffmpeg), or else a folder of pictures NAME_0001.png,
numbered by frame. The default is a picture of the last frame; --frames, --sheet or --out select more. A .gif and a
.webp repeat forever, and show at most 50 and 60 pictures a second: of faster runs every second or third frame.
Rendering needs EGL, but no screen; the same frame gives the same file each time. Ctrl-C finishes the picture and the
film so far.

displays:     shaded, plain, wireframe, strain, speed, particles, lattice, normals, contacts
constraints:  none, kind, color, strain, residual)";

const std::string view_footer = R"(Examples:
  souple view flag
  souple view my/scene.json --paused
  souple view out/flag                         play a finished run, with a time slider

)";

constexpr const char* check_footer = R"(Example:
  souple check flag --set objects.flag.mesh.grid.columns=100

Prints what the scene contains and which repairs its meshes needed; exit code 2 if the scene cannot be used.)";

constexpr const char* list_footer = R"(Example:
  souple list --json)";

constexpr const char* bench_footer = R"(Examples:
  souple bench                                 list the benchmarks
  souple bench cloth --threads 2
  souple bench cloth --json > before.json      then, after a change:
  souple bench cloth --compare before.json
  souple bench cloth --solver hierarchical --iterations 2
  souple bench cloth --residual 0.01 --json    also measure the time of a solve to a strain of 1 %

Steps of 1/60 s are timed by the wall clock: medians of --runs steps after --warm-up others. Projections per second
count each kind of constraint alone. Reports measure no residuals meanwhile; the largest strain is that after the last
step. --residual removes gravity, stretches the cloth by 10 % and solves once, without steps. For reliable numbers,
run nothing else on the machine.

solvers: automatic, gauss_seidel, jacobi, direct, conjugate_gradient, dense, hierarchical)";

constexpr const char* info_footer = R"(Examples:
  souple info
  souple info --schema > scene.schema.json     for editors that check JSON during typing
  souple info --memory flag                    memory of a running scene, in bytes per part)";

template <class T>
CLI::Option* option(CLI::App& command, const char* name, T& value, const char* type, const char* help) {
  return command.add_option(name, value, help)->type_name(type);
}

void add_settings(CLI::App& command, std::vector<std::string>& settings) {
  option(command, "--set", settings, "PATH=VALUE",
         "change a value of the scene: PATH=VALUE, such as substeps=20; repeatable")
      ->allow_extra_args(false);
}

void add_run(CLI::App& app, std::function<int()>& action) {
  auto options = std::make_shared<RunOptions>();
  CLI::App& command = *app.add_subcommand("run", "simulate a scene and write its caches");
  command.footer(run_footer);
  command.add_option("SCENE", options->scene, scene_help);
  option(command, "--frames", options->frames, "N", "number of frames to simulate, instead of the scene's");
  option(command, "--fps", options->fps, "RATE",
         "frames per second, instead of the scene's, over its duration and with its length of a "
         "substep; Blender plays 24");
  option(command, "--out", options->out, "DIR", "the folder to write to [out/NAME]");
  option(command, "--write", options->formats, "FORMATS", "caches to write: pc2, mdd, obj, ply [pc2]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"pc2", "mdd", "obj", "ply"}));
  option(command, "--threads", options->threads, "N",
         "number of threads; results do not depend on it [SOUPLE_THREADS, else all processors]")
      ->check(CLI::Range(1, 1024));
  option(command, "--substeps", options->substeps, "N", "the same as --set substeps=N");
  option(command, "--iterations", options->iterations, "N", "the same as --set iterations=N");
  add_settings(command, options->settings);
  option(command, "--resume", options->resume, "DIR", "resume the interrupted run of this folder");
  option(command, "--checkpoint-every", options->checkpoint_every, "N", "write a checkpoint every N frames");
  option(command, "--surface", options->surface, "METHOD",
         "also write meshes of fluids, into DIR_surface: anisotropic, isotropic");
  option(command, "--picture", options->picture, "FILE.png", "render the last frame to a picture, 1280x720");
  command.add_flag("--quiet", options->quiet, "print nothing but errors");
  command.callback([options, &action] { action = [options] { return souple::app::run(*options); }; });
}

void add_film_options(CLI::App& command, RenderRequest& request) {
  option(command, "--film-rate", request.film_rate, "RATE",
         "pictures a second of a film [those of the run: at the speed of the simulation]");
  option(command, "--film-bytes", request.film_bytes, "BYTES",
         "largest size of a .webp: its quality is chosen to fit [quality 75, any size]");
}

void add_liquid_options(CLI::App& command, RenderRequest& request) {
  option(command, "--liquid-splats", request.liquid_splats, "SPLATS",
         "shape of each particle of a fluid: spheres, ellipsoids [ellipsoids]");
  option(command, "--liquid-filter", request.liquid_filter, "FILTER",
         "how the surface of fluids is smoothed: narrow-range, curvature-flow or none [narrow-range]");
  option(command, "--liquid-steps", request.liquid_steps, "N",
         "steps of curvature flow or passes of the narrow-range filter [40; 2]");
}

void add_render(CLI::App& app, std::function<int()>& action) {
  auto request = std::make_shared<RenderRequest>();
  CLI::App& command = *app.add_subcommand("render", "make pictures and films of a scene or of a run");
  command.footer(render_footer);
  command
      .add_option("SOURCE", request->source,
                  "a scene file, the name of a shipped scene, or the folder of a run or its run.json")
      ->required();
  option(command, "--out", request->out, "PATH",
         "a picture .png, a film .mp4, .gif or .webp, or a folder [out/NAME.png; out/NAME.mp4 if "
         "--frames selects several]");
  option(command, "--frames", request->frames, "FRAMES",
         "which frames: N, A-B, A-B/STEP, last, all; B may be last [a picture: last; else all]");
  option(command, "--sheet", request->sheet, "COLUMNSxROWS", "frames of the run on one page: columns x rows");
  option(command, "--size", request->size, "WIDTHxHEIGHT",
         "of a picture, in pixels [1280x720; .gif and .webp 640x360; each of a sheet 480x270]");
  option(command, "--samples", request->samples, "N",
         "pictures averaged into one [16; films and folders 4; with a lens or a "
         "shutter four times as many]");
  option(command, "--colors", request->colors, "N",
         "reduce pictures to this number of colors, at most 256: a third of the size");
  add_film_options(command, *request);
  option(command, "--camera", request->camera, "CAMERA",
         "\"from X,Y,Z to X,Y,Z fov DEGREES\" or a part of it, or auto: frame all objects [the "
         "scene's, else auto]");
  option(command, "--focus", request->focus, "METERS",
         "depth of field: distance from the camera at which objects are sharp, in m");
  option(command, "--aperture", request->aperture, "METERS",
         "diameter of the lens, in m [a fortieth of the distance in focus]");
  option(command, "--shutter", request->shutter, "FRACTION",
         "motion blur: fraction of a frame during which the shutter is open, at most 1");
  command.add_flag("--caustics", request->caustics,
                   "fluids refract sunlight onto the floor: bright lines under waves");
  option(command, "--sky", request->sky, "FILE",
         "light from a panorama .hdr instead of the scene's sky, without the sun");
  option(command, "--display", request->display, "DISPLAY", "how objects are shown, see below [shaded]");
  option(command, "--constraints", request->constraints, "CONSTRAINTS",
         "how constraints are colored, see below [none]");
  add_liquid_options(command, *request);
  add_settings(command, request->settings);
  command.add_flag("--quiet", request->quiet, "print nothing but errors");
  command.callback(
      [request, &action] { action = [request] { return souple::app::render_frames(*request); }; });
}

void add_view(CLI::App& app, std::function<int()>& action) {
  auto request = std::make_shared<ViewRequest>();
  CLI::App& command = *app.add_subcommand("view", "show a running scene or a finished run in a window");
  command.footer(view_footer + souple::viewer::keys_text());
  command.add_option(
      "SOURCE", request->source,
      "a scene file, the name of a shipped scene, or the folder of a run or its run.json [curtain]");
  command.add_flag("--paused", request->paused, "start paused; Space starts");
  option(command, "--size", request->size, "WIDTHxHEIGHT", "size of the window [1440x900]");
  option(command, "--frames", request->frames, "N", "quit after this number of frames drawn");
  command.add_flag("--debug", request->debug, "end with a message when OpenGL reports an error");
  command.callback([request, &action] { action = [request] { return souple::app::view(*request); }; });
}

void add_surface(CLI::App& app, std::function<int()>& action) {
  auto request = std::make_shared<SurfaceRequest>();
  CLI::App& command = *app.add_subcommand("surface", "make meshes of a run's fluids");
  command.footer(surface_footer);
  command.add_option("CACHE", request->cache, "the folder of a run, or its run.json")->required();
  option(command, "--out", request->out, "DIR", "folder to write [CACHE_surface]");
  option(command, "--method", request->method, "METHOD", "anisotropic, isotropic [anisotropic]");
  option(command, "--format", request->format, "FORMAT", "meshes: obj, ply; volumes: vdb [obj]");
  option(command, "--particles", request->particles, "FORMAT",
         "write the particles as well: none, ply, vtk, bgeo [none]");
  option(command, "--object", request->objects, "NAME",
         "only of this object; repeatable [all fluids, else all grains]");
  option(command, "--cell", request->cell, "METERS",
         "cell of the grid the mesh is extracted from, in meters [half a spacing]");
  option(command, "--spacing", request->spacing, "METERS",
         "spacing of the particles, in meters [the scene's]");
  option(command, "--smoothing", request->smoothing, "N", "passes of Laplacian smoothing [0]");
  option(command, "--threads", request->threads, "N", "threads; 0: one for each processor [0]");
  command.add_flag("--quiet", request->quiet, "print nothing but errors");
  command.callback([request, &action] { action = [request] { return souple::app::surface(*request); }; });
}

void add_sweep_parts(CLI::App& command, SweepRequest& request) {
  CLI::Option* const only =
      option(command, "--only", request.only, "N", "simulate one run, counted from 1, and write no table");
  CLI::Option* const table = command.add_flag(
      "--table", request.table, "write table and sheet of the runs that are done, and simulate none");
  CLI::Option* const dry_run =
      command.add_flag("--dry-run", request.dry_run, "list the runs, and write nothing");
  CLI::Option* const slurm = option(command, "--slurm", request.slurm, "FILE",
                                    "write a script of Slurm with a task for each run, and simulate none");
  only->excludes(table)->excludes(dry_run)->excludes(slurm);
  table->excludes(dry_run)->excludes(slurm);
  dry_run->excludes(slurm);
}

void add_convert(CLI::App& app, std::function<int()>& action) {
  auto request = std::make_shared<ConvertRequest>();
  CLI::App& command = *app.add_subcommand("convert", "write a run for other programs: glTF, USD");
  command.footer(convert_footer);
  command.add_option("CACHE", request->cache, "the folder of a run, or its run.json")->required();
  option(command, "--write", request->formats, "FORMATS", "formats to write: glb, usda")
      ->delimiter(',')
      ->allow_extra_args(false);
  option(command, "--out", request->out, "DIR", "folder to write [CACHE_converted]");
  option(command, "--layout", request->layout, "LAYOUT",
         "one: a file with all frames; frames: a file per frame; auto: by size [auto]");
  command.add_flag("--quiet", request->quiet, "print nothing but errors");
  command.callback([request, &action] { action = [request] { return souple::app::convert(*request); }; });
}

void add_sweep(CLI::App& app, std::function<int()>& action) {
  auto request = std::make_shared<SweepRequest>();
  CLI::App& command = *app.add_subcommand("sweep", "simulate a scene with all combinations of some values");
  command.footer(sweep_footer);
  command.add_option("SCENE", request->scene, scene_help)->required();
  option(command, "--set", request->settings, "PATH=VALUES",
         "a value of the scene as in `souple run`, or several values, see below; repeatable")
      ->allow_extra_args(false);
  option(command, "--frames", request->frames, "N", "number of frames to simulate, instead of the scene's");
  option(command, "--out", request->out, "DIR", "the folder to write to [out/NAME_sweep]");
  option(command, "--write", request->formats, "FORMATS", "caches of each run: pc2, mdd, obj, ply [none]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"pc2", "mdd", "obj", "ply"}));
  option(command, "--jobs", request->jobs, "N", "runs at a time [one for each processor]")
      ->check(CLI::Range(1, 1024));
  command.add_flag_callback(
      "--no-sheet", [request] { request->sheet = false; }, "render no pictures");
  add_sweep_parts(command, *request);
  command.add_flag("--quiet", request->quiet, "print nothing but errors");
  command.callback([request, &action] { action = [request] { return souple::app::sweep(*request); }; });
}

void add_bench_solver(CLI::App& command, BenchRequest& request) {
  option(command, "--solver", request.solver, "SOLVER", "how constraints are solved, see below [automatic]");
  option(command, "--sweep", request.sweep, "SWEEP", "order of the colors: forward, symmetric [forward]");
  option(command, "--relaxation", request.relaxation, "FACTOR", "factor on corrections, between 0 and 2 [1]");
  option(command, "--chebyshev", request.chebyshev, "RHO",
         "acceleration: spectral radius, below 1 [0: none]");
  option(command, "--colors", request.colors, "N",
         "partition the constraint graph for this number of colors [0: do not]");
}

void add_bench(CLI::App& app, std::function<int()>& action) {
  auto request = std::make_shared<BenchRequest>();
  CLI::App& command = *app.add_subcommand("bench", "measure how fast this machine simulates");
  command.footer(bench_footer);
  command.add_option("NAME", request->name, "name of the benchmark; without it, all are listed");
  option(command, "--size", request->size, "N", "size; the list shows its unit");
  option(command, "--threads", request->threads, "N", "threads; 0: one for each processor [1]");
  option(command, "--threading", request->threading, "KIND", "automatic, serial, pool, tbb [automatic]");
  option(command, "--substeps", request->substeps, "N", "substeps of a step [10]");
  option(command, "--iterations", request->iterations, "N", "iterations of the solver in each substep [1]");
  add_bench_solver(command, *request);
  option(command, "--mode", request->mode, "MODE", "small_steps, xpbd, pbd [small_steps]");
  option(command, "--warm-up", request->warm_up, "N", "number of steps before the measurement [5]");
  option(command, "--runs", request->runs, "N", "number of measured steps [30]");
  option(command, "--residual", request->residual, "STRAIN",
         "also measure the time to this mean strain, such as 0.01; cloths only");
  option(command, "--compare", request->compare, "FILE.json", "show ratios to the result in this file");
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
  CLI::App& command = *app.add_subcommand("check", "read a scene and its meshes and report their contents");
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
  option(command, "--memory", *scene, "SCENE", "print the memory of this scene while it runs")
      ->excludes(schema);
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
  } catch (const souple::WriteError& error) {
    std::fprintf(stderr, "souple: %s\n", error.what());
    return failed;
  } catch (const souple::Error& error) {
    std::fprintf(stderr, "souple: %s\n", error.what());
    return bad_input;
  } catch (const std::bad_alloc&) {
    souple::app::say_out_of_memory();
    return bad_input;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "souple: %s\n", error.what());
    return failed;
  }
}

/// The exit code, after the output is written: a full disk behind a redirection is a failed write.
int finish_output(int code) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good()) return code;
  std::fprintf(stderr, "souple: the standard output cannot be written: %s\n",
               std::generic_category().message(errno).c_str());
  return code == success ? failed : code;
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

/// Whether an option of the command that was given is a number with a fraction.
bool takes_fractions(const CLI::App& app, const std::string& option) {
  for (const CLI::App* const command : app.get_subcommands()) {
    const CLI::Option* const found = command->get_option_no_throw(option);
    if (found == nullptr) continue;
    constexpr std::string_view types[] = {"METERS", "FRACTION", "RATE", "FACTOR", "RHO", "STRAIN"};
    return std::find(std::begin(types), std::end(types), found->get_type_name()) != std::end(types);
  }
  return false;
}

/// The error of the command line, in one line.
std::string usage_error(CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
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
    for (const std::string& argument : app.remaining(true)) return argument + ": unexpected argument";
  }
  std::string what = error.what(), conversion = "Could not convert: ";
  if (what.rfind(conversion, 0) != 0) return what;
  what = what.substr(conversion.size());
  return what + (takes_fractions(app, what.substr(0, what.find(" = ")))
                     ? ": expected a number"
                     : ": expected a whole number, 0 or more");
}

}  // namespace

int main(int argc, char** argv) {
  souple::app::end_when_out_of_memory();
  std::function<int()> action;
  CLI::App app(
      "Souple simulates cloth, soft bodies, ropes, rigid bodies, grains and fluids from scene files, and "
      "writes caches "
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
  add_convert(app, action);
  add_sweep(app, action);
  add_bench(app, action);
  add_info(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0)  // --help, --version
      return finish_output(app.exit(error) == 0 ? success : bad_input);
    std::fprintf(stderr, "souple: %s; see `souple --help` and `souple run --help`\n",
                 usage_error(app, error, argc, argv).c_str());
    return bad_input;
  }
  const int code = finish_output(perform(action));
  souple::app::expect_return();
  return code;
}
