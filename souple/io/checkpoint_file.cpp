#include "souple/io/checkpoint_file.h"

#include "souple/error.h"
#include "souple/files/atomic_file.h"
#include "souple/files/endian.h"
#include "souple/files/relative_path.h"
#include "souple/math/fnv1a.h"

#include <array>
#include <charconv>
#include <cstring>
#include <optional>
#include <span>

#include <fmt/core.h>

namespace souple {

namespace {

// The header, whose layout never changes:
//     0  char[8]   magic
//     8  uint32    format: layout of the rest
//    12  uint32    0
//    16  char[16]  version of the writing library, padded with zeros
//    32  uint64    bytes after the header
//    40  uint64    FNV-1a 64 of them
//    48  uint64    0
//    56  uint64    FNV-1a 64 of bytes 0 to 55
constexpr ByteOrder order = ByteOrder::little;
constexpr std::size_t header_size = 64;
constexpr std::string_view magic = "SOUPLECK";
constexpr std::uint32_t known_format = 1;
constexpr std::size_t version_size = 16;

using Version = std::array<std::uint32_t, 3>;

std::optional<Version> parse_version(std::string_view text) {
  Version version{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < version.size(); ++i) {
    if (i > 0 && (at == end || *at++ != '.')) return std::nullopt;
    const auto [next, error] = std::from_chars(at, end, version[i]);
    if (error != std::errc()) return std::nullopt;
    at = next;
  }
  return at == end ? std::optional(version) : std::nullopt;
}

class Writer {
 public:
  void number(std::uint64_t value) { append_binary<order>(bytes_, value); }
  void block(std::span<const std::byte> content) {
    number(content.size());
    raw(content);
  }
  void text(std::string_view content) { block(std::as_bytes(std::span(content.data(), content.size()))); }
  void raw(std::span<const std::byte> content) {
    bytes_.append(reinterpret_cast<const char*>(content.data()), content.size());
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads one value after another. A size larger than the rest of the file is an Error, never an allocation.
class Reader {
 public:
  Reader(std::span<const std::byte> bytes, const std::string& name) : left_(bytes), name_(name) {}

  std::span<const std::byte> take(std::uint64_t size, const char* what) {
    if (size > left_.size())
      throw Error(fmt::format("{}: is damaged: its {} is said to have {} bytes, but only {} are left", name_,
                              what, size, left_.size()));
    const auto taken = left_.first(size);
    left_ = left_.subspan(size);
    return taken;
  }
  std::uint64_t number(const char* what) { return load<order, std::uint64_t>(take(8, what).data()); }
  std::span<const std::byte> block(const char* what) { return take(number(what), what); }
  std::string text(const char* what) {
    const auto content = block(what);
    return {reinterpret_cast<const char*>(content.data()), content.size()};
  }
  std::uint64_t left() const { return left_.size(); }

 private:
  std::span<const std::byte> left_;
  const std::string& name_;
};

std::string encode_payload(const Checkpoint& checkpoint) {
  Writer payload;
  payload.number(checkpoint.frame);
  payload.text(checkpoint.scene);
  payload.number(checkpoint.caches.size());
  for (const CheckpointCache& cache : checkpoint.caches) {
    payload.text(cache.path);
    payload.number(cache.frames);
  }
  payload.block(checkpoint.state);
  return payload.bytes();
}

Checkpoint decode_payload(std::span<const std::byte> bytes, const std::string& name) {
  Reader reader(bytes, name);
  Checkpoint checkpoint;
  checkpoint.frame = reader.number("frame");
  checkpoint.scene = reader.text("scene");
  const std::uint64_t caches = reader.number("list of caches");
  for (std::uint64_t i = 0; i < caches; ++i) {
    CheckpointCache cache;
    cache.path = reader.text("path of a cache");
    cache.frames = reader.number("frames of a cache");
    if (!stays_inside_folder(cache.path))
      throw Error(name + ": names a cache outside its folder: " + cache.path);
    checkpoint.caches.push_back(std::move(cache));
  }
  const auto state = reader.block("state");
  checkpoint.state.assign(state.begin(), state.end());
  if (reader.left() != 0)
    throw Error(fmt::format("{}: is damaged: {} bytes follow its end", name, reader.left()));
  return checkpoint;
}

std::string version_in(std::span<const std::byte> header) {
  const char* text = reinterpret_cast<const char*>(header.data() + 16);
  return {text, strnlen(text, version_size)};
}

void check_version(const std::string& name, const std::string& written_by, const std::string& this_version,
                   std::uint32_t format) {
  const auto theirs = parse_version(written_by);
  const auto ours = parse_version(this_version);
  if (!theirs) throw Error(name + ": is damaged: it names no version of Souple");
  if (!ours) throw Error("\"" + this_version + "\" is not a version; expected three numbers such as 0.1.0");
  if (*theirs > *ours || format > known_format)
    throw Error(name + ": was written by Souple " + written_by + ", this is " + this_version +
                "; resume it with the version that wrote it");
  if (format != known_format)
    throw Error(fmt::format("{}: has format {}, which no version of Souple wrote", name, format));
}

/// Returns the payload.
std::span<const std::byte> check_container(std::span<const std::byte> bytes, const std::string& name,
                                           const std::string& this_version) {
  if (bytes.size() < magic.size() || std::memcmp(bytes.data(), magic.data(), magic.size()) != 0)
    throw Error(name + ": is not a checkpoint of Souple");
  if (bytes.size() < header_size)
    throw Error(fmt::format("{}: is cut short: it has {} bytes, not even a header", name, bytes.size()));
  if (load<order, std::uint64_t>(&bytes[56]) != fnv1a64(bytes.first(56)))
    throw Error(name + ": is damaged: the checksum of its header is wrong");
  check_version(name, version_in(bytes), this_version, load<order, std::uint32_t>(&bytes[8]));
  const auto payload = bytes.subspan(header_size);
  const auto size = load<order, std::uint64_t>(&bytes[32]);
  if (size != payload.size())
    throw Error(fmt::format("{}: {}: {} bytes should follow its header, there are {}", name,
                            size > payload.size() ? "is cut short" : "is damaged", size, payload.size()));
  if (load<order, std::uint64_t>(&bytes[40]) != fnv1a64(payload))
    throw Error(name +
                ": is damaged: its checksum is wrong; use an earlier checkpoint or start the run again");
  return payload;
}

}  // namespace

std::string checkpoint_bytes(const Checkpoint& checkpoint) {
  if (!parse_version(checkpoint.version) || checkpoint.version.size() >= version_size)
    throw Error("a checkpoint's version is \"" + checkpoint.version +
                "\"; expected three numbers such as 0.1.0");
  const std::string payload = encode_payload(checkpoint);
  std::array<std::byte, header_size> header{};
  std::memcpy(&header[0], magic.data(), magic.size());
  store<order>(&header[8], known_format);
  std::memcpy(&header[16], checkpoint.version.data(), checkpoint.version.size());
  store<order>(&header[32], std::uint64_t{payload.size()});
  store<order>(&header[40], fnv1a64(payload));
  store<order>(&header[56], fnv1a64(std::span(header).first(56)));
  return std::string(reinterpret_cast<const char*>(header.data()), header.size()) + payload;
}

Checkpoint parse_checkpoint(std::string_view bytes, const std::string& name,
                            const std::string& this_version) {
  const auto all = std::as_bytes(std::span(bytes.data(), bytes.size()));
  Checkpoint checkpoint = decode_payload(check_container(all, name, this_version), name);
  checkpoint.version = version_in(all);
  return checkpoint;
}

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  write_file_atomically(path, checkpoint_bytes(checkpoint), Sync::yes);
}

Checkpoint read_checkpoint(const std::filesystem::path& path, const std::string& this_version) {
  return parse_checkpoint(read_whole_file(path), path.string(), this_version);
}

}  // namespace souple
