#include "golden_file.h"

#include "souple/files/atomic_file.h"
#include "souple/files/file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace souple::test {

std::string hash_text(std::uint64_t hash) {
  return fmt::format("{:016x}", hash);
}

std::map<std::string, FrameHashes> read_golden(const std::filesystem::path& file) {
  std::map<std::string, FrameHashes> golden;
  if (!std::filesystem::exists(file)) return golden;
  const auto json = nlohmann::json::parse(read_whole_file(file));
  for (const auto& [scene, hashes] : json.items()) {
    for (const auto& [frame, hash] : hashes.items())
      golden[scene][std::stoi(frame)] = std::stoull(hash.get<std::string>(), nullptr, 16);
  }
  return golden;
}

void write_golden(const std::filesystem::path& file, const std::map<std::string, FrameHashes>& golden) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [scene, hashes] : golden) {
    for (const auto& [frame, hash] : hashes) json[scene][std::to_string(frame)] = hash_text(hash);
  }
  write_file_atomically(file, json.dump(2) + "\n");
}

}  // namespace souple::test
