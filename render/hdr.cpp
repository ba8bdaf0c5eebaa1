#include "render/hdr.h"

#include "souple/error.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

namespace souple::render {

namespace {

// The format: G. Ward, "Real Pixels", Graphics Gems II (1991), and the manual of Radiance, "Picture File Format".

constexpr int most_pixels = 16384;               // a side of the file
constexpr int most_columns = 2048;               // of the result
constexpr std::uintmax_t most_bytes = 1U << 30;  // of the file

using Rgbe = std::array<std::uint8_t, 4>;

/// The bytes of a file, from the front.
class Bytes {
 public:
  explicit Bytes(const std::filesystem::path& file) : name_(file.string()) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (!error && size > most_bytes)
      fail("is larger than a gigabyte; expected a panorama of at most 16384 x 8192");
    std::ifstream in(file, std::ios::binary);
    if (!in) fail("cannot be opened");
    bytes_.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  [[noreturn]] void fail(const std::string& what) const { throw Error(name_ + ": " + what); }

  std::size_t left() const { return bytes_.size() - at_; }
  std::uint8_t next() {
    if (at_ >= bytes_.size()) ended();
    return static_cast<std::uint8_t>(bytes_[at_++]);
  }
  Rgbe next_pixel() {
    Rgbe pixel{};
    if (left() < pixel.size()) ended();
    std::memcpy(pixel.data(), &bytes_[at_], pixel.size());
    at_ += pixel.size();
    return pixel;
  }
  void back(std::size_t count) { at_ -= count; }
  /// Up to the end of the line, which it skips.
  std::string_view line() {
    const std::string_view rest(&bytes_[0] + at_, left());
    const std::size_t end = rest.find('\n');
    if (end > 4096)  // also where there is none
      fail("has no complete header of a Radiance picture (.hdr)");
    at_ += end + 1;
    const std::string_view text = rest.substr(0, end);
    return text.empty() || text.back() != '\r' ? text : text.substr(0, end - 1);
  }
  [[noreturn]] void ended() const { fail("ends within its pixels; the file is incomplete"); }

 private:
  std::string name_, bytes_;
  std::size_t at_ = 0;
};

struct Header {
  int width = 0, height = 0;
  float exposure = 1;  ///< the file's values over radiance
};

/// A side in the line `-Y 512 +X 1024`: a number after this word.
int side_of(std::string_view& line, std::string_view word) {
  if (line.substr(0, word.size()) != word) return 0;
  line.remove_prefix(word.size());
  int value = 0;
  const auto read = std::from_chars(line.data(), line.data() + line.size(), value);
  if (read.ec == std::errc::result_out_of_range) return most_pixels + 1;
  if (read.ptr == line.data()) return 0;  // no number
  line.remove_prefix(static_cast<std::size_t>(read.ptr - line.data()));
  return value;
}

void read_size(Bytes& bytes, Header& header) {
  const std::string_view line = bytes.line();
  std::string_view rest = line;
  header.height = side_of(rest, "-Y ");
  header.width = header.height > 0 ? side_of(rest, " +X ") : 0;
  if (header.height > most_pixels || header.width > most_pixels)
    bytes.fail(fmt::format("has more than {} pixels along a side; expected a smaller panorama", most_pixels));
  if (header.height < 1 || header.width < 1)
    bytes.fail(
        fmt::format("expected the picture's size, as in -Y 512 +X 1024, found \"{}\"", line.substr(0, 60)));
}

Header read_header(Bytes& bytes) {
  if (bytes.left() < 2 || bytes.line().substr(0, 2) != "#?")
    bytes.fail("is not a Radiance picture (.hdr): it does not begin with #?RADIANCE");
  Header header;
  for (std::string_view line = bytes.line(); !line.empty(); line = bytes.line()) {
    if (line.substr(0, 7) == "FORMAT=" && line.substr(7) != "32-bit_rle_rgbe")
      bytes.fail(fmt::format("has the format \"{}\"; expected 32-bit_rle_rgbe", line.substr(7, 60)));
    if (line.substr(0, 9) != "EXPOSURE=") continue;
    const std::string number(line.substr(9));  // std::from_chars of some libraries has no floating point
    const float factor = std::strtof(number.c_str(), nullptr);
    if (!(factor > 0) || !std::isfinite(factor))
      bytes.fail(fmt::format("has EXPOSURE={}; expected a number above 0", number.substr(0, 60)));
    header.exposure *= factor;
  }
  if (!(header.exposure > 0) || !std::isfinite(header.exposure)) bytes.fail("has an EXPOSURE out of range");
  read_size(bytes, header);
  return header;
}

/// One channel of a row after another, each as runs and as counted bytes.
void read_channels(Bytes& bytes, std::vector<Rgbe>& row) {
  for (std::size_t channel = 0; channel < 4; ++channel) {
    for (std::size_t x = 0; x < row.size();) {
      const std::uint8_t count = bytes.next();
      const bool run = count > 128;
      const std::size_t length = run ? count - 128U : count;
      if (length == 0 || length > row.size() - x)
        bytes.fail("has run lengths beyond the end of a row; it is damaged");
      const std::uint8_t value = run ? bytes.next() : std::uint8_t{0};
      for (const std::size_t end = x + length; x < end; ++x) row[x][channel] = run ? value : bytes.next();
    }
  }
}

/// Pixels, of which (1, 1, 1, n) repeats the last n times; after another such pixel 256 n times, and so on.
void read_pixels(Bytes& bytes, std::vector<Rgbe>& row) {
  unsigned shift = 0;
  for (std::size_t x = 0; x < row.size();) {
    const Rgbe pixel = bytes.next_pixel();
    if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
      row[x++] = pixel;
      shift = 0;
      continue;
    }
    const std::size_t count = shift > 16 ? row.size() + 1 : std::size_t{pixel[3]} << shift;
    if (x == 0 || count > row.size() - x)
      bytes.fail("has run lengths beyond the end of a row; it is damaged");
    std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(x), count, row[x - 1]);
    x += count;
    shift += 8;
  }
}

void read_row(Bytes& bytes, std::vector<Rgbe>& row) {
  const std::size_t width = row.size();
  if (width >= 8 && width < 32768 && bytes.left() >= 4) {
    const Rgbe start = bytes.next_pixel();
    if (start[0] == 2 && start[1] == 2 && start[2] < 128) {
      if (start[2] * std::size_t{256} + start[3] != width)
        bytes.fail("has a row of another length than its header states; it is damaged");
      return read_channels(bytes, row);
    }
    bytes.back(start.size());
  }
  read_pixels(bytes, row);
}

Vec3f radiance_of(const Rgbe& pixel, float scale) {
  if (pixel[3] == 0) return {};
  const float unit = std::ldexp(scale, static_cast<int>(pixel[3]) - (128 + 8));
  return Vec3f{static_cast<float>(pixel[0]), static_cast<float>(pixel[1]), static_cast<float>(pixel[2])} *
         unit;
}

}  // namespace

Panorama read_hdr(const std::filesystem::path& file) {
  Bytes bytes(file);
  const Header header = read_header(bytes);
  const int block = (std::max(header.width, 2 * header.height) + most_columns - 1) / most_columns;
  Panorama result{std::max(header.width / block, 1), std::max(header.height / block, 1), {}};
  // A complete row has at least two bytes for each 127 pixels of a channel, so a short file fails in its first rows.
  result.radiance.resize(static_cast<std::size_t>(result.width) * static_cast<std::size_t>(result.height));
  const float scale = 1 / (header.exposure * static_cast<float>(block) * static_cast<float>(block));
  std::vector<Rgbe> row(static_cast<std::size_t>(header.width));
  // Rows and columns that fill no whole block are left out: fewer than one in a hundred.
  for (int y = 0; y < header.height; ++y) {
    read_row(bytes, row);
    if (y / block >= result.height) continue;
    for (int x = 0; x < result.width * block; ++x) {
      const auto to = static_cast<std::size_t>(y / block) * static_cast<std::size_t>(result.width) +
                      static_cast<std::size_t>(x / block);
      result.radiance[to] = result.radiance[to] + radiance_of(row[static_cast<std::size_t>(x)], scale);
    }
  }
  for (Vec3f& light : result.radiance) {
    for (int c = 0; c < 3; ++c)
      light[c] = std::min(light[c], 60000.0f);  // the largest number of half a float
  }
  return result;
}

}  // namespace souple::render
