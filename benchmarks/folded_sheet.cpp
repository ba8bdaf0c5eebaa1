// A sheet that stands on its edge and falls into folds (the sheet of `souple bench heap`): what its motion costs
// in Souple, and the quality of any engine's motion of it. script/measure_blender runs it beside Blender.
//
//   folded_sheet start SIZE                      prints the sheet as it starts, an OBJ: SIZE x SIZE vertices
//   folded_sheet run SIZE FRAMES THREADS [FILE]  simulates FRAMES of 1/60 s with the default settings
//   folded_sheet count SIZE FILE                 reads the frames of another engine
//
// FILE holds positions, x y z as 32-bit floats in the machine's byte order, vertex by vertex, frame by frame; Y up.
//
// `run` and `count` print JSON. Per frame: the edges that pass through triangles (by the tests' own checker, which
// shares no code with the engine) and the mean height of the vertices. Of the last frame: mean and largest strain
// of the edges, and speed; of all frames: the lowest point. `run` adds the milliseconds of each frame, wall clock
// and processor time of all threads. It counts after the last frame, so that counting disturbs no timing.

#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"
#include "souple/mesh_files/mesh_write.h"
#include "tests/intersections/crossings.h"
#include "tests/physics/collision_cases.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace souple {
namespace {

constexpr double frame_time = 1.0 / 60;  // s

using Frame = std::vector<Vec3f>;

struct Strain {
  double mean = 0, largest = 0;  // of |l - l0| / l0 over the edges
};

Strain strain_of(const Frame& now, const Frame& start, const std::vector<Edge>& edges) {
  Strain strain;
  for (const Edge& e : edges) {
    const double rest = length(Vec3d(start[e[0]]) - Vec3d(start[e[1]]));
    const double relative = std::abs(length(Vec3d(now[e[0]]) - Vec3d(now[e[1]])) / rest - 1);
    strain.mean += relative / static_cast<double>(edges.size());
    strain.largest = std::max(strain.largest, relative);
  }
  return strain;
}

/// Root mean square of the vertices' speed between two frames [m/s].
double speed_between(const Frame& before, const Frame& after) {
  double sum = 0;
  for (std::size_t i = 0; i < after.size(); ++i)
    sum += length_squared((Vec3d(after[i]) - Vec3d(before[i])) / frame_time);
  return std::sqrt(sum / static_cast<double>(after.size()));
}

/// Of the vertices over the floor [m].
double mean_height(const Frame& frame) {
  double sum = 0;
  for (const Vec3f& x : frame) sum += x.y;
  return sum / static_cast<double>(frame.size());
}

/// Height of the lowest vertex, at most 0 [m]: how deep the sheet enters the floor.
double lowest(const std::vector<Frame>& frames) {
  float least = 0;
  for (const Frame& frame : frames)
    for (const Vec3f& x : frame) least = std::min(least, x.y);
  return static_cast<double>(least);
}

void print_list(const char* name, std::span<const double> values) {
  std::printf(" \"%s\": [", name);
  for (std::size_t i = 0; i < values.size(); ++i) std::printf("%s%.6g", i > 0 ? ", " : "", values[i]);
  std::printf("],\n");
}

void print_quality(const Frame& start, const std::vector<Frame>& frames,
                   std::span<const Triangle> triangles) {
  std::vector<double> crossings, heights;
  for (const Frame& frame : frames) {
    test::CrossingCounter counter;
    counter.add(frame, triangles);
    crossings.push_back(static_cast<double>(counter.crossings()));
    heights.push_back(mean_height(frame));
  }
  const Frame& end = frames.back();
  const Strain strain = strain_of(end, start, unique_edges(triangles));
  print_list("crossings", crossings);
  print_list("heights", heights);
  std::printf(
      " \"mean_strain\": %.4g, \"largest_strain\": %.4g, \"speed\": %.4g, \"lowest\": "
      "%.4g}\n",
      strain.mean, strain.largest, speed_between(frames[frames.size() - 2], end), lowest(frames));
}

int number(const char* text, int least, int most) {
  const int value = std::atoi(text);
  if (value >= least && value <= most) return value;
  throw Error(std::string(text) + ": expected a number from " + std::to_string(least) + " to " +
              std::to_string(most));
}

Frame positions_of(const test::Heap& heap) {
  const auto now = heap.world.positions(heap.cloth);
  return {now.begin(), now.end()};
}

void start(int size) {
  const test::Heap heap = test::sheet_on_edge(size);
  const TriangleMesh mesh = grid(size, size, 1);
  std::fputs(obj_text(mesh, heap.world.positions(heap.cloth)).c_str(), stdout);
}

void write(const std::vector<Frame>& frames, const std::string& file) {
  std::ofstream out(file, std::ios::binary);
  for (const Frame& frame : frames)
    out.write(reinterpret_cast<const char*>(frame.data()),
              static_cast<std::streamsize>(frame.size() * sizeof(Vec3f)));
  if (!out.flush()) throw Error(file + ": cannot be written");
}

void run(int size, int frame_count, int threads, const char* file) {
  test::Heap heap = test::sheet_on_edge(size);
  Settings settings = heap.world.settings();
  settings.threads = threads;
  heap.world.set_settings(settings);
  const Frame first = positions_of(heap);
  std::vector<Frame> frames;
  std::vector<double> ms, processor_ms;
  for (int k = 0; k < frame_count; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    const std::clock_t processor_begin = std::clock();
    heap.world.step(frame_time);
    ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    processor_ms.push_back(1e3 * static_cast<double>(std::clock() - processor_begin) / CLOCKS_PER_SEC);
    frames.push_back(positions_of(heap));
  }
  if (file) write(frames, file);
  std::printf("{\"size\": %d, \"threads\": %d,\n", size, threads);
  print_list("ms", ms);
  print_list("processor_ms", processor_ms);
  print_quality(first, frames, heap.world.triangles(heap.cloth));
}

void count(int size, const std::string& file) {
  const test::Heap heap = test::sheet_on_edge(size);
  const Frame first = positions_of(heap);
  std::ifstream in(file, std::ios::binary);
  std::vector<Frame> frames;
  for (Frame frame(first.size()); in.read(reinterpret_cast<char*>(frame.data()),
                                          static_cast<std::streamsize>(frame.size() * sizeof(Vec3f)));)
    frames.push_back(frame);
  if (frames.size() < 2)
    throw Error(file + ": expected at least two frames of " + std::to_string(first.size()) + " vertices");
  std::printf("{\"size\": %d,\n", size);
  print_quality(first, frames, heap.world.triangles(heap.cloth));
}

int main_of(std::span<char*> words) {
  const auto is = [&](const char* name, std::size_t words_of) {
    return words.size() == words_of && std::strcmp(words[1], name) == 0;
  };
  if (is("start", 3)) {
    start(number(words[2], 4, 1000));
  } else if (is("run", 5) || is("run", 6)) {
    run(number(words[2], 4, 1000), number(words[3], 2, 100000), number(words[4], 0, 1024),
        words.size() > 5 ? words[5] : nullptr);
  } else if (is("count", 4)) {
    count(number(words[2], 4, 1000), words[3]);
  } else {
    throw Error("expected start SIZE, run SIZE FRAMES THREADS [FILE], or count SIZE FILE");
  }
  return 0;
}

}  // namespace
}  // namespace souple

int main(int argc, char** argv) {
  try {
    return souple::main_of({argv, static_cast<std::size_t>(argc)});
  } catch (const souple::Error& error) {
    std::fprintf(stderr, "folded_sheet: %s\n", error.what());
    return 2;
  }
}
