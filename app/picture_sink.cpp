#include "app/picture_sink.h"

#include "app/interrupt.h"
#include "render/contact_sheet.h"
#include "render/film.h"
#include "souple/error.h"
#include "souple/files/atomic_file.h"
#include "souple/files/file.h"
#include "souple/io/sequence.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

/// Detects a full disk or a folder without write permission now, not after minutes of work.
void require_writable(const fs::path& file) {
  if (const fs::path folder = file.parent_path(); !folder.empty()) create_folder(folder);
  if (std::error_code error; fs::is_directory(file, error))
    throw Error(file.string() + ": is a folder; expected the name of a picture");
  const AtomicFile probe(file);  // never committed
}

class OnePicture : public PictureSink {
 public:
  OnePicture(fs::path file, int colors) : file_(std::move(file)), colors_(colors) { require_writable(file_); }
  void add(const render::Image& image, std::uint64_t) override { render::write_png(file_, image, colors_); }
  void finish() override {}

 private:
  fs::path file_;
  int colors_;
};

class Sheet : public PictureSink {
 public:
  Sheet(fs::path file, SheetShape shape, int colors)
      : file_(std::move(file)), shape_(shape), colors_(colors) {
    require_writable(file_);
  }
  void add(const render::Image& image, std::uint64_t) override { pictures_.push_back(image); }
  void finish() override {
    if (!pictures_.empty())
      render::write_png(file_, render::contact_sheet(pictures_, shape_.columns, shape_.rows), colors_);
  }

 private:
  fs::path file_;
  SheetShape shape_;
  int colors_;
  std::vector<render::Image> pictures_;
};

class FilmFile : public PictureSink {
 public:
  FilmFile(const fs::path& file, double rate, std::uint64_t max_bytes)
      : film_(file, rate, interrupt_requested, max_bytes) {}
  void add(const render::Image& image, std::uint64_t) override {
    film_.add(image);
    empty_ = false;
  }
  void finish() override {
    if (!empty_) film_.finish();
  }

 private:
  render::Film film_;
  bool empty_ = true;
};

/// Pictures are numbered by frame: a frame that is rendered again replaces its picture.
class Folder : public PictureSink {
 public:
  Folder(fs::path folder, std::string name, int colors)
      : folder_(std::move(folder)), name_(std::move(name)), colors_(colors) {
    require_writable(folder_ / frame_file_name(name_, 1, "png"));
  }
  void add(const render::Image& image, std::uint64_t frame) override {
    render::write_png(folder_ / frame_file_name(name_, frame, "png"), image, colors_);
  }
  void finish() override {}

 private:
  fs::path folder_;
  std::string name_;
  int colors_;
};

}  // namespace

OutputKind output_kind(const fs::path& out, bool sheet) {
  static const std::array<const char*, 13> foreign{".jpg", ".jpeg", ".bmp",  ".tga", ".tif", ".tiff", ".exr",
                                                   ".ppm", ".avi",  ".webm", ".mov", ".mkv", ".apng"};
  const std::string extension = lower_extension(out);
  const auto refuse = [&](const std::string& expected) {
    throw Error("--out " + out.string() + ": expected " + expected);
  };
  if (std::find(foreign.begin(), foreign.end(), extension) != foreign.end())
    refuse("a picture .png, a film .mp4, .gif or .webp, or a folder");
  if (sheet && extension != ".png") refuse("a picture .png, since --sheet makes one page");
  if (sheet) return OutputKind::sheet;
  if (extension == ".png") return OutputKind::picture;
  return render::is_film(out) ? OutputKind::film : OutputKind::folder;
}

std::unique_ptr<PictureSink> open_sink(const SinkRequest& request) {
  switch (request.kind) {
    case OutputKind::picture:
      return std::make_unique<OnePicture>(request.out, request.colors);
    case OutputKind::sheet:
      return std::make_unique<Sheet>(request.out, request.sheet, request.colors);
    case OutputKind::film:
      return std::make_unique<FilmFile>(request.out, request.film_rate, request.film_bytes);
    case OutputKind::folder:
      break;
  }
  return std::make_unique<Folder>(request.out, request.name, request.colors);
}

}  // namespace souple::app
