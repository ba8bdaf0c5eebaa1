#include "souple/io/animated_points.h"

#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/io/mdd.h"
#include "souple/io/pc2.h"
#include "souple/io/sequence.h"
#include "souple/mesh_files/mesh_animation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include <fmt/core.h>

namespace souple {

namespace {

/// The readers of PC2 and MDD read frames in the same way.
template <class Reader>
PointFrames frames_of(const std::shared_ptr<Reader>& reader) {
  return {reader->points(), {}, [reader](std::uint64_t frame, std::span<Vec3f> positions) {
            reader->read(frame, positions);
          }};
}

PointFrames pc2_frames(const std::filesystem::path& path, double frame_rate) {
  const auto reader = std::make_shared<Pc2Reader>(path);
  PointFrames frames = frames_of(reader);
  for (std::uint64_t frame = 0; frame < reader->frames(); ++frame)
    frames.times.push_back(static_cast<double>(frame) * static_cast<double>(reader->sample_rate()) /
                           frame_rate);
  return frames;
}

PointFrames mdd_frames(const std::filesystem::path& path) {
  const auto reader = std::make_shared<MddReader>(path);
  PointFrames frames = frames_of(reader);
  for (const float time : reader->times())
    frames.times.push_back(static_cast<double>(time) - static_cast<double>(reader->times()[0]));
  return frames;
}

/// One mesh per file; a gap in the numbers is a gap in time.
PointFrames mesh_frames(const std::filesystem::path& path, double frame_rate,
                        const AnimatedPoints::ReadMesh& read_mesh) {
  const std::vector<SequenceFrame> files = find_sequence(path);
  PointFrames frames{read_mesh(files.front().path).size()};
  for (const SequenceFrame& file : files)
    frames.times.push_back(static_cast<double>(file.number - files.front().number) / frame_rate);
  frames.read = [files, read_mesh](std::uint64_t frame, std::span<Vec3f> positions) {
    const std::vector<Vec3f> mesh = read_mesh(files[frame].path);
    if (mesh.size() != positions.size())
      throw Error(fmt::format(
          "{}: has {} vertices, {} has {}; all files of a sequence need the same vertices",
          files[frame].path.string(), mesh.size(), files.front().path.string(), positions.size()));
    std::copy(mesh.begin(), mesh.end(), positions.begin());
  };
  return frames;
}

/// Bones, shapes and nodes of a mesh file, evaluated when it is read.
PointFrames evaluated_frames(MeshAnimation animation) {
  return {animation.points, std::move(animation.times),
          [all = std::move(animation.positions)](std::uint64_t frame, std::span<Vec3f> positions) {
            std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(frame * positions.size()), positions.size(),
                        positions.begin());
          }};
}

/// NAME_0001.glb beside NAME_0002.glb
bool is_one_of_a_sequence(const std::filesystem::path& path) {
  const std::string stem = path.stem().string();
  const bool numbered = !stem.empty() && stem.back() >= '0' && stem.back() <= '9';
  return numbered && find_sequence(path).size() > 1;
}

PointFrames open_frames(const std::filesystem::path& path, const AnimatedPoints::Options& options,
                        const AnimatedPoints::ReadMesh& read_mesh) {
  if (!std::isfinite(options.frame_rate) || !(options.frame_rate > 0))
    throw Error(path.string() + ": the frame rate of an animation must be a number > 0");
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  const std::string extension = is_folder ? "" : lower_extension(path);
  if (extension == ".pc2") return pc2_frames(path, options.frame_rate);
  if (extension == ".mdd") return mdd_frames(path);
  if (!is_folder && may_hold_mesh_animation(path) &&
      (!options.animation.empty() || !is_one_of_a_sequence(path)))
    return evaluated_frames(read_mesh_animation(path, {options.animation, options.node, options.frame_rate}));
  if (!options.animation.empty())
    throw Error(path.string() +
                ": holds no animation with a name; expected a .gltf, .glb, .fbx or .dae file");
  if (!read_mesh)
    throw Error(path.string() +
                ": no animation can be read from it; expected a .pc2, a .mdd, a .gltf, .glb, .fbx or .dae");
  return mesh_frames(path, options.frame_rate, read_mesh);
}

}  // namespace

AnimatedPoints::AnimatedPoints(const std::filesystem::path& path, const Options& options,
                               const ReadMesh& read_mesh)
    : frames_(open_frames(path, options, read_mesh)),
      name_(path.string()),
      start_time_(options.start_time),
      loop_(options.loop) {
  const std::vector<double>& times = frames_.times;
  if (!std::isfinite(start_time_))
    throw Error(name_ + ": the start time of an animation must be a finite number");
  if (times.empty()) throw Error(name_ + ": holds no frame, so nothing can follow it");
  for (std::size_t frame = 0; frame < times.size(); ++frame)
    if (!std::isfinite(times[frame]) || (frame > 0 && !(times[frame] > times[frame - 1])))
      throw Error(fmt::format("{}: the time of frame {} is not later than that before it", name_, frame));
}

const std::vector<Vec3f>& AnimatedPoints::load(std::uint64_t frame) {
  Loaded& loaded = loaded_[frame % 2];
  if (loaded.frame == frame) return loaded.positions;
  loaded.frame = Loaded().frame;
  loaded.positions.resize(frames_.points);
  frames_.read(frame, loaded.positions);
  for (std::size_t i = 0; i < loaded.positions.size(); ++i) {
    if (!is_finite(loaded.positions[i]))
      throw Error(fmt::format("{}: point {} of frame {} is not finite", name_, i, frame));
  }
  loaded.frame = frame;
  return loaded.positions;
}

void AnimatedPoints::evaluate(double time, std::span<Vec3f> positions) {
  if (!std::isfinite(time)) throw Error(name_ + ": was asked for its positions at a time that is not finite");
  if (positions.size() != points())
    throw Error(fmt::format("{}: has {} points, {} were asked for", name_, points(), positions.size()));
  const std::vector<double>& times = frames_.times;
  double t = time - start_time_;
  if (loop_ && times.back() > 0) t -= std::floor(t / times.back()) * times.back();
  const auto later = std::upper_bound(times.begin(), times.end(), t);
  const auto after = static_cast<std::uint64_t>(later - times.begin());
  if (after == 0 || after == times.size()) {
    const auto& still = load(after == 0 ? 0 : after - 1);
    std::copy(still.begin(), still.end(), positions.begin());
    return;
  }
  const auto& a = load(after - 1);
  const auto& b = load(after);
  const float s = static_cast<float>((t - times[after - 1]) / (times[after] - times[after - 1]));
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = (1 - s) * a[i] + s * b[i];
}

}  // namespace souple
