#include "app/picture_files.h"

#include "souple/error.h"

#include <map>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/core.h>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

constexpr int most_pixels = 4096;  // a side of a printed picture

/// Values made from files, by file and settings. A file that can no longer be read keeps its last value.
template <class Value>
class Kept {
 public:
  template <class Make>
  std::shared_ptr<const Value> get(const fs::path& file, const std::string& settings, Make make) {
    std::error_code error;
    const fs::file_time_type changed = fs::last_write_time(file, error);
    Entry& entry = entries_[{file.string(), settings}];
    if (entry.value && entry.changed == changed) return entry.value;
    try {
      entry.value = std::make_shared<const Value>(make());
    } catch (const Error&) {
      if (!entry.value) throw;
    }
    entry.changed = changed;
    return entry.value;
  }

 private:
  struct Entry {
    std::shared_ptr<const Value> value;
    fs::file_time_type changed;
  };
  std::map<std::pair<std::string, std::string>, Entry> entries_;
};

render::Image read_picture(const fs::path& file) {
  render::Image image = render::read_png(file);
  if (image.width > most_pixels || image.height > most_pixels)
    throw Error(fmt::format("{}: {} x {} pixels; expected at most {} a side", file.string(), image.width,
                            image.height, most_pixels));
  return image;
}

}  // namespace

std::shared_ptr<const render::Image> picture_of(const fs::path& file) {
  static Kept<render::Image> kept;
  return kept.get(file, {}, [&] { return read_picture(file); });
}

std::shared_ptr<const render::Environment> sky_of(const SkyDescription& sky, const fs::path& folder) {
  static Kept<render::Environment> kept;
  const fs::path file = folder / sky.file;
  const render::EnvironmentOptions options{.rotation = static_cast<float>(sky.rotation * pi / 180),
                                           .strength = static_cast<float>(sky.strength),
                                           .sun = static_cast<float>(sky.sun),
                                           .background = sky.background};
  const std::string settings =
      fmt::format("{} {} {} {}", sky.rotation, sky.strength, sky.sun, sky.background);
  return kept.get(file, settings, [&] { return render::Environment(render::read_hdr(file), options); });
}

}  // namespace souple::app
