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
#include <limits>
#include <utility>

#include <fmt/core.h>

namespace souple {

namespace {

class Pc2Frames final : public PointFrames {
 public:
  Pc2Frames(const std::filesystem::path& path, double frame_rate) : reader_(path), frame_rate_(frame_rate) {}
  std::uint64_t points() const override { return reader_.points(); }
  std::uint64_t frames() const override { return reader_.frames(); }
  double time(std::uint64_t frame) const override {
    return static_cast<double>(frame) * static_cast<double>(reader_.sample_rate()) / frame_rate_;
  }
  void read(std::uint64_t frame, std::span<Vec3f> positions) override { reader_.read(frame, positions); }

 private:
  Pc2Reader reader_;
  double frame_rate_;
};

class MddFrames final : public PointFrames {
 public:
  explicit MddFrames(const std::filesystem::path& path) : reader_(path) {}
  std::uint64_t points() const override { return reader_.points(); }
  std::uint64_t frames() const override { return reader_.frames(); }
  double time(std::uint64_t frame) const override {
    return static_cast<double>(reader_.times()[frame]) - static_cast<double>(reader_.times()[0]);
  }
  void read(std::uint64_t frame, std::span<Vec3f> positions) override { reader_.read(frame, positions); }

 private:
  MddReader reader_;
};

/// One mesh per file; a gap in the numbers is a gap in time.
class MeshFrames final : public PointFrames {
 public:
  MeshFrames(const std::filesystem::path& path, double frame_rate, AnimatedPoints::ReadMesh read_mesh)
      : files_(find_sequence(path)), frame_rate_(frame_rate), read_mesh_(std::move(read_mesh)) {
    points_ = read_mesh_(files_.front().path).size();
  }
  std::uint64_t points() const override { return points_; }
  std::uint64_t frames() const override { return files_.size(); }
  double time(std::uint64_t frame) const override {
    return static_cast<double>(files_[frame].number - files_.front().number) / frame_rate_;
  }
  void read(std::uint64_t frame, std::span<Vec3f> positions) override {
    const std::vector<Vec3f> mesh = read_mesh_(files_[frame].path);
    if (mesh.size() != points_)
      throw Error(
          fmt::format("{}: has {} vertices, {} has {}; all files of a sequence need the same vertices",
                      files_[frame].path.string(), mesh.size(), files_.front().path.string(), points_));
    std::copy(mesh.begin(), mesh.end(), positions.begin());
  }

 private:
  std::vector<SequenceFrame> files_;
  double frame_rate_;
  AnimatedPoints::ReadMesh read_mesh_;
  std::uint64_t points_;
};

/// Bones, shapes and nodes of a mesh file, evaluated when it is read.
class EvaluatedFrames final : public PointFrames {
 public:
  explicit EvaluatedFrames(MeshAnimation animation) : animation_(std::move(animation)) {}
  std::uint64_t points() const override { return animation_.points; }
  std::uint64_t frames() const override { return animation_.times.size(); }
  double time(std::uint64_t frame) const override { return animation_.times[frame]; }
  void read(std::uint64_t frame, std::span<Vec3f> positions) override {
    std::copy_n(animation_.positions.begin() + static_cast<std::ptrdiff_t>(frame * animation_.points),
                animation_.points, positions.begin());
  }

 private:
  MeshAnimation animation_;
};

/// NAME_0001.glb beside NAME_0002.glb
bool is_one_of_a_sequence(const std::filesystem::path& path) {
  const std::string stem = path.stem().string();
  const bool numbered = !stem.empty() && stem.back() >= '0' && stem.back() <= '9';
  return numbered && find_sequence(path).size() > 1;
}

std::unique_ptr<PointFrames> open_frames(const std::filesystem::path& path,
                                         const AnimatedPoints::Options& options,
                                         const AnimatedPoints::ReadMesh& read_mesh) {
  if (!std::isfinite(options.frame_rate) || !(options.frame_rate > 0))
    throw Error(path.string() + ": the frame rate of an animation must be a number > 0");
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  const std::string extension = is_folder ? "" : lower_extension(path);
  if (extension == ".pc2") return std::make_unique<Pc2Frames>(path, options.frame_rate);
  if (extension == ".mdd") return std::make_unique<MddFrames>(path);
  if (!is_folder && may_hold_mesh_animation(path) &&
      (!options.animation.empty() || !is_one_of_a_sequence(path)))
    return std::make_unique<EvaluatedFrames>(
        read_mesh_animation(path, {options.animation, options.node, options.frame_rate}));
  if (!options.animation.empty())
    throw Error(path.string() +
                ": holds no animation with a name; expected a .gltf, .glb, .fbx or .dae file");
  if (!read_mesh)
    throw Error(path.string() +
                ": no animation can be read from it; expected a .pc2, a .mdd, a .gltf, .glb, .fbx or .dae");
  return std::make_unique<MeshFrames>(path, options.frame_rate, read_mesh);
}

constexpr std::uint64_t no_frame = std::numeric_limits<std::uint64_t>::max();

}  // namespace

AnimatedPoints::AnimatedPoints(const std::filesystem::path& path, const Options& options,
                               const ReadMesh& read_mesh)
    : AnimatedPoints(open_frames(path, options, read_mesh), path.string(), options.start_time, options.loop) {
}

AnimatedPoints::AnimatedPoints(std::unique_ptr<PointFrames> frames, std::string name, double start_time,
                               bool loop)
    : frames_(std::move(frames)), name_(std::move(name)), start_time_(start_time), loop_(loop) {
  if (!std::isfinite(start_time_))
    throw Error(name_ + ": the start time of an animation must be a finite number");
  if (frames_->frames() == 0) throw Error(name_ + ": holds no frame, so nothing can follow it");
  times_.reserve(frames_->frames());
  for (std::uint64_t frame = 0; frame < frames_->frames(); ++frame) {
    const double time = frames_->time(frame);
    if (!std::isfinite(time) || (frame > 0 && !(time > times_.back())))
      throw Error(fmt::format("{}: the time of frame {} is not later than that before it", name_, frame));
    times_.push_back(time);
  }
  for (Loaded& loaded : loaded_) loaded.frame = no_frame;
}

AnimatedPoints::AnimatedPoints(AnimatedPoints&&) noexcept = default;
AnimatedPoints& AnimatedPoints::operator=(AnimatedPoints&&) noexcept = default;
AnimatedPoints::~AnimatedPoints() = default;

std::uint64_t AnimatedPoints::points() const {
  return frames_->points();
}

double AnimatedPoints::start_time() const {
  return start_time_;
}

double AnimatedPoints::end_time() const {
  return start_time_ + times_.back();
}

const std::vector<Vec3f>& AnimatedPoints::load(std::uint64_t frame) {
  Loaded& loaded = loaded_[frame % 2];
  if (loaded.frame == frame) return loaded.positions;
  loaded.frame = no_frame;
  loaded.positions.resize(frames_->points());
  frames_->read(frame, loaded.positions);
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
  double t = time - start_time_;
  if (loop_ && times_.back() > 0) t -= std::floor(t / times_.back()) * times_.back();
  const auto later = std::upper_bound(times_.begin(), times_.end(), t);
  const auto after = static_cast<std::uint64_t>(later - times_.begin());
  if (after == 0 || after == times_.size()) {
    const auto& still = load(after == 0 ? 0 : after - 1);
    std::copy(still.begin(), still.end(), positions.begin());
    return;
  }
  const auto& a = load(after - 1);
  const auto& b = load(after);
  const float s = static_cast<float>((t - times_[after - 1]) / (times_[after] - times_[after - 1]));
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = (1 - s) * a[i] + s * b[i];
}

}  // namespace souple
