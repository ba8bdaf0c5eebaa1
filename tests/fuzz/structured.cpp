#include "structured.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace souple::fuzz {

namespace {

/// Where the bytes are numbers: from `begin` on, in words of 4 bytes.
struct Numbers {
  std::size_t begin = 0;
  bool is_big_endian = false;
};

std::uint64_t read_number(const std::string& bytes, std::size_t at, std::size_t size, bool is_big_endian) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i) {
    const std::size_t place = is_big_endian ? size - 1 - i : i;
    value |= std::uint64_t(std::uint8_t(bytes[at + i])) << (8 * place);
  }
  return value;
}

void write_number(std::string& bytes, std::size_t at, std::size_t size, bool is_big_endian,
                  std::uint64_t value) {
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i) {
    const std::size_t place = is_big_endian ? size - 1 - i : i;
    bytes[at + i] = char((value >> (8 * place)) & 0xff);
  }
}

/// Floats that a user's file may hold, and those that it should not.
std::uint32_t odd_float(Random& random) {
  const float odd[] = {0.0f, -0.0f, 1.0f, -1.5f, 1e-45f, 1e-38f, 3.4e38f, 1e9f, 1e10f, 0.1f};
  std::uint32_t bits;
  std::memcpy(&bits, &odd[random.below(std::size(odd))], sizeof(bits));
  // One of sixteen is any number at all, NaN and infinity among them.
  return random.below(16) == 0 ? std::uint32_t(random.next()) : bits;
}

void change_number(std::string& bytes, Numbers numbers, Random& random) {
  if (bytes.size() < numbers.begin + 4) return;
  const std::size_t words = (bytes.size() - numbers.begin) / 4;
  const std::size_t at = numbers.begin + 4 * random.below(words),
                    from = numbers.begin + 4 * random.below(words);
  const std::uint64_t word = read_number(bytes, from, 4, numbers.is_big_endian);
  switch (random.below(4)) {
    case 0:  // the lowest bits of a number
      write_number(bytes, at, 4, numbers.is_big_endian,
                   read_number(bytes, at, 4, numbers.is_big_endian) ^ random.below(1 << 16));
      return;
    case 1:
      write_number(bytes, at, 4, numbers.is_big_endian, odd_float(random));
      return;
    default:
      write_number(bytes, at, 4, numbers.is_big_endian, word);
  }
}

/// Adds a copy of the last frame, or removes it.
void change_pc2(std::string& bytes, Random& random) {
  constexpr std::size_t header = 32, points_at = 16, frames_at = 28;
  if (bytes.size() < header) return;
  const std::size_t frame = 12 * std::size_t(read_number(bytes, points_at, 4, false) & 0xffff);
  const std::uint64_t frames = read_number(bytes, frames_at, 4, false);
  const bool adds = random.below(2) == 0;
  if (random.below(3) > 0 || bytes.size() < header + frame || frames == 0) {
    change_number(bytes, {header, false}, random);
  } else if (adds) {
    bytes += bytes.substr(bytes.size() - frame);
    write_number(bytes, frames_at, 4, false, frames + 1);
  } else {
    bytes.resize(bytes.size() - frame);
    write_number(bytes, frames_at, 4, false, frames - 1);
  }
}

/// The times stay as they are: they rise.
void change_mdd(std::string& bytes, Random& random) {
  const std::size_t frames = std::size_t(read_number(bytes, 0, 4, true) & 0xffff), times_end = 8 + 4 * frames;
  const std::size_t frame = 12 * std::size_t(read_number(bytes, 4, 4, true) & 0xffff);
  if (random.below(4) > 0 || frames < 2 || bytes.size() < times_end + frame) {
    change_number(bytes, {times_end, true}, random);
  } else {
    bytes.resize(bytes.size() - frame);
    bytes.erase(times_end - 4, 4);
    write_number(bytes, 0, 4, true, frames - 1);
  }
}

/// Records of 50 bytes: 12 floats and 2 bytes.
void change_binary_stl(std::string& bytes, Random& random) {
  constexpr std::size_t header = 84, record = 50, count_at = 80;
  if (bytes.size() < header + record) return;
  const std::size_t records = (bytes.size() - header) / record;
  const std::size_t at = header + record * random.below(records),
                    from = header + record * random.below(records);
  const std::string copy = bytes.substr(from, record);
  switch (random.below(5)) {
    case 0:
      bytes.replace(at, record, copy);
      return;
    case 1:
      bytes.insert(at, copy);
      write_number(bytes, count_at, 4, false, records + 1);
      return;
    case 2:
      bytes.erase(at, record);
      write_number(bytes, count_at, 4, false, records - 1);
      return;
    default:
      write_number(bytes, at + 4 * random.below(12), 4, false, odd_float(random));
  }
}

/// The end of the text before the numbers of a PLY or VTK file; the size where all is text.
std::size_t text_end(const std::string& bytes, bool is_ply) {
  if (bytes.find(is_ply ? "format binary" : "\nBINARY\n") == std::string::npos) return bytes.size();
  const std::size_t mark = bytes.find(is_ply ? "end_header" : "POINTS");
  if (mark == std::string::npos) return bytes.size();
  return std::min(bytes.find('\n', mark), bytes.size() - 1) + 1;
}

void change_mesh(std::string& bytes, bool is_ply, Random& random) {
  const std::size_t end = text_end(bytes, is_ply);
  const bool is_big = !is_ply || bytes.find("big_endian") < end;
  if (end == bytes.size() || random.below(4) == 0) {
    change_text(bytes, end, random);
  } else {
    // Vertices come first, and most of what follows counts or indexes.
    std::string vertices = bytes.substr(0, end + (bytes.size() - end) * 3 / 5);
    const std::string rest = bytes.substr(vertices.size());
    change_number(vertices, {end, is_big}, random);
    bytes = vertices + rest;
  }
}

/// The blocks of a checkpoint after its header of 64 bytes and the frame: the scene, the caches, the state.
void change_checkpoint(std::string& bytes, Random& random) {
  constexpr std::size_t header = 64, frame_at = header, scene_at = header + 8;
  if (bytes.size() < scene_at + 8) return;
  const std::size_t scene = std::size_t(read_number(bytes, scene_at, 8, false) & 0xffff);
  const std::size_t scene_begin = scene_at + 8;
  switch (random.below(4)) {
    case 0:
      write_number(bytes, frame_at, 8, false, random.next() >> random.below(64));
      return;
    case 1: {  // the scene grows
      if (scene_begin + scene > bytes.size()) return;
      const std::string words(random.below(20), char('a' + random.below(26)));
      bytes.insert(scene_begin + random.below(scene + 1), words);
      write_number(bytes, scene_at, 8, false, scene + words.size());
      return;
    }
    case 2:
      if (scene > 0 && scene_begin + scene <= bytes.size())
        bytes[scene_begin + random.below(scene)] = char(random.next() & 0xff);
      return;
    default:  // the state comes last
      if (bytes.size() >= scene_begin + 24)
        bytes[bytes.size() - 1 - random.below(24)] = char(random.next() & 0xff);
  }
}

}  // namespace

void change_structure(std::string_view format, std::string& bytes, Random& random) {
  if (format == "pc2") return change_pc2(bytes, random);
  if (format == "mdd") return change_mdd(bytes, random);
  if (format == "checkpoint") return change_checkpoint(bytes, random);
  if (format == "scene" || format == "manifest") return change_json(bytes, random);
  if (format == "ply" || format == "vtk") return change_mesh(bytes, format == "ply", random);
  if (format == "stl" && bytes.compare(0, 5, "solid") == 0 && bytes.find("facet") != std::string::npos)
    return change_text(bytes, bytes.size(), random);
  if (format == "stl") return change_binary_stl(bytes, random);
  change_text(bytes, bytes.size(), random);
}

}  // namespace souple::fuzz
