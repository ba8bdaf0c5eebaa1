#include "souple/io/mdd.h"

#include "souple/error.h"
#include "souple/files/atomic_file.h"
#include "souple/files/endian.h"
#include "souple/io/point_cache_checks.h"

#include <algorithm>
#include <array>

#include <fmt/core.h>

namespace souple {

namespace {

constexpr ByteOrder mdd_order = ByteOrder::big;
constexpr std::uint64_t mdd_header_size = 8;
constexpr std::uint64_t copy_size = 1u << 20;

struct MddHeader {
  std::uint64_t frames;
  std::uint64_t points;
};

std::array<std::byte, mdd_header_size> encode_mdd(const MddHeader& header) {
  std::array<std::byte, mdd_header_size> bytes{};
  store<mdd_order>(&bytes[0], static_cast<std::uint32_t>(header.frames));
  store<mdd_order>(&bytes[4], static_cast<std::uint32_t>(header.points));
  return bytes;
}

/// Rejects headers that are impossible for an MDD, and a table of times longer than the file.
MddHeader read_mdd_header(ByteSource& source) {
  if (source.size() < mdd_header_size)
    throw Error(source.name() + ": is not an MDD file: it has less than 8 bytes");
  std::array<std::byte, mdd_header_size> bytes{};
  source.read(0, bytes);
  const MddHeader header{load<mdd_order, std::uint32_t>(&bytes[0]),
                         load<mdd_order, std::uint32_t>(&bytes[4])};
  point_cache::check_header(source.name(), {header.points, header.frames});
  if (4 * header.frames > source.size() - mdd_header_size)
    throw Error(fmt::format(
        "{}: its header says {} frames, more than its size of {} bytes allows; it is cut short or damaged",
        source.name(), header.frames, source.size()));
  return header;
}

/// A .part has a table for the planned frames: the file's length determines the number of actual frames.
std::uint64_t frames_within(const MddHeader& header, std::uint64_t size) {
  const std::uint64_t data = size - mdd_header_size - 4 * header.frames;
  return std::min(header.frames, data / (12 * header.points));
}

std::vector<float> read_times(ByteSource& source, std::uint64_t count) {
  std::vector<std::byte> bytes(4 * count);
  source.read(mdd_header_size, bytes);
  std::vector<float> times(count);
  for (std::uint64_t i = 0; i < count; ++i) times[i] = load<mdd_order, float>(&bytes[4 * i]);
  return times;
}

/// Capacity of the table of times, limited because a plan of a million frames may mean "until stopped".
std::uint64_t room_for(std::uint64_t planned_frames) {
  return planned_frames == 0 ? 256 : std::min<std::uint64_t>(planned_frames, 1u << 20);
}

}  // namespace

MddWriter::MddWriter(std::filesystem::path path, std::uint64_t points, std::uint64_t planned_frames)
    : points_(point_cache::check_points(path.string(), points)),
      path_(std::move(path)),
      file_(part_path(path_), File::Mode::create),
      capacity_(room_for(planned_frames)) {
  file_.write(0, encode_mdd({capacity_, points_}));
  file_.write(mdd_header_size, std::vector<std::byte>(4 * capacity_));
  file_.flush();
}

MddWriter::MddWriter(std::filesystem::path path, File file, std::uint64_t points, std::uint64_t capacity,
                     std::vector<float> times)
    : points_(points),
      path_(std::move(path)),
      file_(std::move(file)),
      capacity_(capacity),
      times_(std::move(times)) {}

MddWriter MddWriter::resume(const std::filesystem::path& path, std::uint64_t points,
                            std::uint64_t keep_frames, std::uint64_t planned_frames) {
  const auto part = part_path(path);
  const auto& existing = std::filesystem::exists(part) ? part : path;
  MddHeader header{};
  std::vector<float> times;
  {
    ByteSource source(existing);
    header = read_mdd_header(source);
    const std::uint64_t frames = frames_within(header, source.size());
    point_cache::check_resume(source.name(), {header.points, frames}, points, keep_frames);
    times = read_times(source, keep_frames);
  }
  if (existing == path) rename_file(path, part);
  MddWriter writer(path, File(part, File::Mode::update), points, header.frames, std::move(times));
  writer.file_.truncate(writer.frame_offset(keep_frames));
  const std::uint64_t wanted = std::max(keep_frames, room_for(planned_frames));
  if (wanted != writer.capacity_) writer.change_capacity(wanted);
  return writer;
}

std::uint64_t MddWriter::frame_offset(std::uint64_t frame) const {
  return mdd_header_size + 4 * capacity_ + 12 * points_ * frame;
}

/// Rewrites NAME.part with a table of another length, into a new file that replaces the old one when
/// complete.
void MddWriter::change_capacity(std::uint64_t capacity) {
  AtomicFile copy(file_.path());
  copy.write(encode_mdd({capacity, points_}));
  std::vector<std::byte> bytes(4 * capacity);
  for (std::size_t i = 0; i < times_.size(); ++i) store<mdd_order>(&bytes[4 * i], times_[i]);
  copy.write(bytes);
  bytes.resize(copy_size);
  const std::uint64_t end = frame_offset(frames());
  for (std::uint64_t at = frame_offset(0); at < end; at += copy_size) {
    const auto piece = std::span(bytes).first(std::min(copy_size, end - at));
    file_.read(at, piece);
    copy.write(piece);
  }
  copy.commit();
  const auto part = file_.path();
  file_ = File(part, File::Mode::update);
  capacity_ = capacity;
}

/// Moves the frames toward the beginning of NAME.part, over the unused end of the table. For a full disk, on which
/// no copy fits; a program that is killed meanwhile leaves a damaged file.
void MddWriter::shrink_capacity() {
  std::vector<std::byte> bytes(copy_size);
  const std::uint64_t from = frame_offset(0), size = frame_offset(frames()) - from;
  capacity_ = frames();
  const std::uint64_t to = frame_offset(0);
  for (std::uint64_t at = 0; at < size; at += copy_size) {
    const auto piece = std::span(bytes).first(std::min(copy_size, size - at));
    file_.read(from + at, piece);
    file_.write(to + at, piece);
  }
  file_.write(0, encode_mdd({capacity_, points_}));
  file_.truncate(to + size);
}

void MddWriter::append(double time, std::span<const Vec3f> positions) {
  point_cache::check_append(path_.string(), {points_, frames()}, open_, positions.size());
  if (frames() == capacity_)
    change_capacity(std::min(point_cache::largest_count, std::max<std::uint64_t>(16, 2 * capacity_)));
  std::array<std::byte, 4> time_bytes;
  store<mdd_order>(time_bytes.data(), static_cast<float>(time));
  file_.write(mdd_header_size + 4 * frames(), time_bytes);
  buffer_.resize(12 * positions.size());
  const auto bytes = std::as_writable_bytes(std::span(buffer_));
  store_points<mdd_order>(bytes.data(), positions);
  // The frame follows its time, because the length of a .part determines its number of frames.
  file_.write(frame_offset(frames()), bytes);
  file_.flush();
  times_.push_back(static_cast<float>(time));
}

void MddWriter::finish() {
  if (!open_) return;
  file_.truncate(frame_offset(frames()));  // removes the part of a failed frame
  if (capacity_ != frames()) {
    try {
      change_capacity(frames());
    } catch (const Error&) {
      shrink_capacity();
    }
  }
  file_.close();
  rename_file(file_.path(), path_);
  open_ = false;
}

void MddWriter::discard() {
  if (!open_) return;
  open_ = false;
  file_.abandon();
  std::error_code ignored;
  std::filesystem::remove(file_.path(), ignored);
}

MddReader::MddReader(ByteSource source) : MddReader(std::move(source), false) {}

MddReader MddReader::of_part(ByteSource source) {
  return {std::move(source), true};
}

MddReader::MddReader(ByteSource source, bool is_part) : source_(std::move(source)) {
  const MddHeader header = read_mdd_header(source_);
  first_frame_ = mdd_header_size + 4 * header.frames;
  if (!is_part)
    point_cache::check_size(source_.name(), {header.points, header.frames}, source_.size() - first_frame_);
  points_ = header.points;
  times_ = read_times(source_, frames_within(header, source_.size()));
}

void MddReader::read(std::uint64_t frame, std::span<Vec3f> positions) {
  point_cache::check_read(source_.name(), {points_, frames()}, frame, positions.size());
  buffer_.resize(12 * positions.size());
  const auto bytes = std::as_writable_bytes(std::span(buffer_));
  source_.read(first_frame_ + frame * bytes.size(), bytes);
  load_points<mdd_order>(bytes.data(), positions);
}

}  // namespace souple
