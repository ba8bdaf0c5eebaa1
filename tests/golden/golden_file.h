#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace souple::test {

/// Hashes of a scene by frame.
using FrameHashes = std::map<int, std::uint64_t>;

/// tests/golden.json: for each scene, the hashes of its first frames. Throws std::runtime_error.
std::map<std::string, FrameHashes> read_golden(const std::filesystem::path& file);
void write_golden(const std::filesystem::path& file, const std::map<std::string, FrameHashes>& golden);

/// 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

}  // namespace souple::test
