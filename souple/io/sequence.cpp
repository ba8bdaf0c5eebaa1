#include "souple/io/sequence.h"

#include "souple/error.h"
#include "souple/files/atomic_file.h"

#include <algorithm>
#include <map>
#include <new>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/core.h>

namespace souple {

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// A file name split into NAME_, 0012 and .obj.
struct NumberedName {
  std::string prefix;
  std::string digits;
  std::string extension;
};

NumberedName cut(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  std::size_t at = stem.size();
  while (at > 0 && is_digit(stem[at - 1])) --at;
  return {stem.substr(0, at), stem.substr(at), file.extension().string()};
}

/// The number of a file in the sequence of `model`; nullopt for any other file, and for numbers beyond
/// 18 digits.
std::optional<std::uint64_t> number_like(const NumberedName& model, const std::filesystem::path& file) {
  const NumberedName name = cut(file);
  if (name.prefix != model.prefix || name.extension != model.extension) return std::nullopt;
  if (name.digits.empty() || name.digits.size() > 18) return std::nullopt;
  return std::stoull(name.digits);
}

[[noreturn]] void cannot_list(const std::filesystem::path& folder, const std::error_code& error) {
  if (error == std::errc::not_enough_memory) throw std::bad_alloc();
  throw Error(folder.string() + ": cannot be listed: " + error.message());
}

/// The files whose numbers are above `after`, or all.
std::vector<SequenceFrame> list_frames(const std::filesystem::path& folder, const NumberedName& model,
                                       std::optional<std::uint64_t> after = {}) {
  std::vector<SequenceFrame> frames;
  std::error_code error;
  std::filesystem::directory_iterator entry(folder.empty() ? "." : folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const auto file = entry->path().filename();
    const auto number = number_like(model, file);
    if (number && (!after || *number > *after)) frames.push_back({*number, folder / file});
  }
  if (error) cannot_list(folder, error);
  // Also by path, because the order of a folder's entries depends on the system.
  std::sort(frames.begin(), frames.end(), [](const SequenceFrame& a, const SequenceFrame& b) {
    return a.number != b.number ? a.number < b.number : a.path < b.path;
  });
  return frames;
}

/// The first file of each sequence of meshes in a folder.
std::vector<std::filesystem::path> list_sequences(const std::filesystem::path& folder) {
  std::map<std::pair<std::string, std::string>, std::string> first;  // file by prefix and extension
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const std::filesystem::path file = entry->path().filename();
    const NumberedName name = cut(file);
    const bool is_mesh = name.extension == ".obj" || name.extension == ".ply" || name.extension == ".stl";
    if (!is_mesh || name.digits.empty()) continue;
    std::string& known = first[{name.prefix, name.extension}];
    if (known.empty() || file.string() < known) known = file.string();
  }
  if (error) cannot_list(folder, error);
  std::vector<std::filesystem::path> result;
  result.reserve(first.size());
  for (const auto& [name, file] : first) result.push_back(folder / file);
  return result;
}

std::filesystem::path only_sequence(const std::filesystem::path& folder) {
  const std::vector<std::filesystem::path> sequences = list_sequences(folder);
  if (sequences.empty())
    throw Error(folder.string() +
                ": this folder holds no sequence of meshes; expected files like NAME_0001.obj");
  if (sequences.size() > 1)
    throw Error(folder.string() + ": this folder holds several sequences of meshes; name a file of one, " +
                sequences[0].filename().string() + " or " + sequences[1].filename().string());
  return sequences[0];
}

}  // namespace

std::string frame_file_name(const std::string& name, std::uint64_t frame, const std::string& extension) {
  return fmt::format("{}_{:04}.{}", name, frame, extension);
}

std::vector<SequenceFrame> find_sequence(const std::filesystem::path& any_frame) {
  std::error_code ignored;
  if (std::filesystem::is_directory(any_frame, ignored)) return find_sequence(only_sequence(any_frame));
  const NumberedName model = cut(any_frame);
  if (model.digits.empty())
    throw Error(
        any_frame.string() +
        ": is not a file of a sequence; expected a number at the end of its name, as in " +
        frame_file_name(model.prefix, 1, model.extension.empty() ? "obj" : model.extension.substr(1)));
  auto frames = list_frames(any_frame.parent_path(), model);
  if (frames.empty()) throw Error(any_frame.string() + ": there is no file of this sequence");
  const auto twin = std::adjacent_find(frames.begin(), frames.end(),
                                       [](const auto& a, const auto& b) { return a.number == b.number; });
  if (twin != frames.end())
    throw Error(twin->path.string() + ": has the same number as " + (twin + 1)->path.string() +
                "; remove one of them");
  return frames;
}

void remove_sequence(const std::filesystem::path& first, std::uint64_t count, std::uint64_t last_number) {
  const NumberedName model = cut(first);
  const std::optional<std::uint64_t> number = number_like(model, first);
  if (!number || !model.prefix.ends_with('_') || model.extension.size() < 2) return;
  const std::string name = model.prefix.substr(0, model.prefix.size() - 1);
  const auto file = [&](std::uint64_t frame) {
    return first.parent_path() / frame_file_name(name, frame, model.extension.substr(1));
  };
  if (file(*number) != first) return;
  for (std::uint64_t frame = *number, removed = 0; frame <= last_number && removed < count; ++frame) {
    std::error_code ignored;
    if (std::filesystem::remove(file(frame), ignored)) ++removed;
  }
}

SequenceWriter::SequenceWriter(std::filesystem::path folder, std::string name, std::string extension,
                               Bytes bytes, std::uint64_t keep_frames)
    : folder_(std::move(folder)),
      name_(std::move(name)),
      extension_(std::move(extension)),
      bytes_(std::move(bytes)),
      frames_(keep_frames) {
  for (std::uint64_t frame = 1; frame <= keep_frames; ++frame) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file(frame), ignored))
      throw Error(fmt::format("{}: is missing, and the checkpoint needs {} frames; start the run again",
                              file(frame).string(), keep_frames));
  }
}

std::filesystem::path SequenceWriter::file(std::uint64_t frame) const {
  return folder_ / frame_file_name(name_, frame, extension_);
}

void SequenceWriter::append(std::span<const Vec3f> positions, std::span<const Vec3f> velocities) {
  write_file_atomically(file(frames_ + 1), bytes_(positions, velocities));
  ++frames_;
}

void SequenceWriter::skip_to(std::uint64_t frame) {
  for (; frames_ + 1 < frame; ++frames_) {
    std::error_code ignored;
    std::filesystem::remove(file(frames_ + 1), ignored);
  }
}

void SequenceWriter::drop_after(std::uint64_t frame) {
  if (frame >= frames_) return;
  frames_ = frame;
  finish();
}

void SequenceWriter::finish() {
  const NumberedName model = cut(frame_file_name(name_, 1, extension_));
  for (const SequenceFrame& frame : list_frames(folder_, model, frames_)) {
    // Only names that the writer generates: NAME_7.obj is not one of them.
    if (frame.path != file(frame.number)) continue;
    std::error_code ignored;
    std::filesystem::remove(frame.path, ignored);
  }
}

}  // namespace souple
