#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// The commands of the program. Each returns an ExitCode, or throws Error for bad input.

namespace souple::app {

struct RunOptions {
  std::string scene;  ///< a file or the name of a shipped scene; empty with `resume`
  std::optional<std::uint32_t> frames, substeps, iterations;
  /// Frames per second instead of the scene's; frames and substeps change along, so that the duration and the
  /// length of a substep stay.
  std::optional<double> fps;
  std::optional<int> threads;         ///< empty: Settings::threads = 0
  std::filesystem::path out;          ///< empty: out/NAME
  std::vector<std::string> formats;   ///< empty: pc2
  std::vector<std::string> settings;  ///< path=value
  std::filesystem::path resume;
  std::optional<std::uint32_t> checkpoint_every;
  std::filesystem::path picture;  ///< file for a picture of the last frame; empty: none
  std::string surface;            ///< method with which fluids are meshed during the run; empty: no meshes
  bool quiet = false;
};
int run(const RunOptions& options);

/// Arguments of `souple render` as written; empty: the default.
struct RenderRequest {
  std::string source;  ///< a scene, a run's folder, or its run.json
  std::filesystem::path out, sky;
  std::string frames, sheet, size, camera;
  std::string display = "shaded", constraints = "none";
  std::string liquid_splats = "ellipsoids", liquid_filter = "narrow-range";
  std::optional<std::uint32_t> samples, colors, liquid_steps;
  std::optional<double> focus, aperture, shutter;  ///< m, m, fraction of a frame
  std::optional<double> film_rate;                 ///< pictures per second
  std::optional<std::uint64_t> film_bytes;         ///< largest size of a .webp
  std::vector<std::string> settings;               ///< path=value
  bool caustics = false, quiet = false;
};
int render_frames(const RenderRequest& request);
/// Two lines for `souple info`: whether pictures and films can be made, and what is missing.
std::string picture_support();

struct ViewRequest {
  std::string source;  ///< a scene, a run's folder, or its run.json; empty: a shipped scene
  std::string size;    ///< "1280x720"; empty: the default
  std::optional<std::uint64_t> frames;
  bool paused = false, debug = false;
};
int view(const ViewRequest& request);
/// Whether the viewer was built in.
bool has_viewer();

/// Arguments of `souple surface`; empty: the default.
struct SurfaceRequest {
  std::filesystem::path cache;  ///< a run's folder, or its run.json
  std::filesystem::path out;    ///< empty: NAME_surface, beside the cache
  std::string method = "anisotropic", format = "obj", particles = "none";
  std::vector<std::string> objects;        ///< empty: all fluids, or all grains if there is no fluid
  std::optional<float> spacing, cell;      ///< m
  std::optional<std::uint32_t> smoothing;  ///< passes
  std::optional<int> threads;              ///< empty: Settings::threads = 0
  bool quiet = false;
};
int surface(const SurfaceRequest& request);

/// Arguments of `souple sweep`; empty: the default.
struct SweepRequest {
  std::string scene;                    ///< a file or the name of a shipped scene
  std::vector<std::string> settings;    ///< path=value, path=a:b:n, path=a:b:logn, path=a,b,c
  std::optional<std::uint32_t> frames;  ///< instead of the scene's
  std::filesystem::path out;            ///< empty: out/NAME_sweep
  std::vector<std::string> formats;     ///< of the caches of each run; empty: none
  std::optional<std::uint32_t> jobs;    ///< runs at a time; empty: as many as processors
  std::optional<std::uint64_t> only;    ///< simulate this run, counted from 1
  std::filesystem::path slurm;          ///< write an array job into this file
  bool sheet = true, table = false, dry_run = false, quiet = false;
};
int sweep(const SweepRequest& request);

/// Arguments of `souple convert`; empty: the default.
struct ConvertRequest {
  std::filesystem::path cache;       ///< a run's folder, or its run.json
  std::filesystem::path out;         ///< empty: NAME_converted, beside the cache
  std::vector<std::string> formats;  ///< glb, usda
  std::string layout = "auto";
  bool quiet = false;
};
int convert(const ConvertRequest& request);

/// Arguments of `souple bench`; empty: the default.
struct BenchRequest {
  std::string name;  ///< empty: list the benchmarks
  std::optional<std::uint32_t> size, threads, substeps, iterations, warm_up, runs, colors;
  std::string solver, sweep, mode, threading;
  std::optional<float> relaxation, chebyshev;
  std::optional<double> residual;
  std::filesystem::path compare;  ///< JSON of an earlier result
  bool json = false;
};
int bench(const BenchRequest& request);

int list(bool as_json);

int check(const std::string& scene, const std::vector<std::string>& settings);

enum class InfoPart { all, schema, scene_format };
int info(InfoPart part);
/// Prints the memory of a running scene, part by part.
int memory(const std::string& scene, const std::vector<std::string>& settings);

}  // namespace souple::app
