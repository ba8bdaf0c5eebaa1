#pragma once

#include <array>
#include <cstdint>
#include <string_view>

/// Formats and limits that the library and the program souple-mesh-reader share.
namespace souple::mesh_detail {

/// The formats that are read with assimp, by their extensions. assimp knows some forty more, which are refused:
/// most of its readers were never meant for files from strangers.
constexpr std::array<std::string_view, 8> assimp_formats = {".gltf", ".glb",   ".fbx", ".dae",
                                                            ".3ds",  ".blend", ".off", ".x3d"};

/// Address space of the reader. [bytes]
constexpr std::uint64_t reader_memory = std::uint64_t(4) << 30;

/// Processor time of the reader for a file of `size` bytes: 10 s, 1 s for each MiB, and 30 s to evaluate an animation. [s]
constexpr std::uint64_t reader_seconds(std::uint64_t size, bool animation) {
  return 10 + (size >> 20) + (animation ? 30 : 0);
}

/// The longest message of the reader. [bytes]
constexpr std::size_t longest_reader_message = 2000;

}  // namespace souple::mesh_detail
