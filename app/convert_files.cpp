#include "app/convert_files.h"

#include "app/interrupt.h"
#include "app/progress.h"
#include "souple/error.h"
#include "souple/files/atomic_file.h"
#include "souple/io/glb_run.h"
#include "souple/io/sequence.h"
#include "souple/io/usda_run.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t largest_clip = 64'000'000, largest_stage = 100'000'000;  // bytes

void announce(const ConvertJob& job, const std::string& what, std::uint64_t bytes) {
  if (job.quiet) return;
  std::printf("%s: %s, about %s\n", job.out.string().c_str(), what.c_str(),
              bytes_text(static_cast<double>(bytes)).c_str());
  std::fflush(stdout);
}

/// Removes NAME.EXTENSION and NAME_0001.EXTENSION, ... of an earlier conversion.
void remove_earlier(const fs::path& folder, const std::string& name, const std::string& extension) {
  std::error_code error;
  fs::remove(folder / (name + "." + extension), error);
  if (fs::is_directory(folder, error)) SequenceWriter(folder, name, extension, nullptr).finish();
}

/// Reads frame by frame and calls `use`. Returns the number of frames before an interrupt.
std::uint64_t for_each_frame(const ConvertJob& job, const std::function<void(std::uint64_t frame)>& use) {
  const std::uint64_t frames = job.frames.playback().frames();
  Progress progress(job.cache.string(), frames, 0, job.quiet);
  for (std::uint64_t frame = 1; frame <= frames; ++frame) {
    if (interrupt_requested()) return frame - 1;
    job.frames.read(frame);
    use(frame);
    progress.frame_done(frame);
  }
  return frames;
}

/// Seconds at which a program with the run's frame rate shows the frame of this number.
double seconds_of(const ConvertJob& job, std::uint64_t frame) {
  return static_cast<double>(frame) / job.frames.playback().manifest().frame_rate;
}

bool takes_one_glb(const ConvertJob& job, std::uint64_t size) {
  const std::uint64_t frames = job.frames.playback().frames();
  if (job.layout == ConvertLayout::automatic)
    return job.constant && frames <= GlbClip::most_frames && size <= largest_clip;
  if (job.layout == ConvertLayout::one_file && !job.constant)
    throw Error(
        "--layout one: " + job.cache.string() +
        " has objects whose points or triangles change from frame to frame, which a .glb cannot hold; "
        "leave the option out to write a .glb per frame");
  if (job.layout == ConvertLayout::one_file && size > GlbClip::most_bytes)
    throw Error(fmt::format(
        "--layout one: {} frames would take {} MB, and a .glb holds at most 4 GiB; leave the option out "
        "to write a .glb per frame",
        frames, size / 1'000'000));
  return job.layout == ConvertLayout::one_file;
}

std::uint64_t glb_clip(const ConvertJob& job) {
  GlbClip clip(job.name);
  const std::uint64_t frames = for_each_frame(
      job, [&](std::uint64_t frame) { clip.add(seconds_of(job, frame), job.frames.objects()); });
  if (frames < job.frames.playback().frames()) return 0;  // no part of a clip is of use
  write_file_atomically(job.out / (job.name + ".glb"), std::move(clip).bytes());
  return frames;
}

/// The size of the frames' samples, of the first and the last frame, whichever is larger.
std::uint64_t usda_size(const ConvertJob& job, const UsdaRun& usda) {
  const std::uint64_t frames = job.frames.playback().frames();
  std::uint64_t largest = 0;
  for (const std::uint64_t frame : {std::uint64_t{1}, frames}) {
    job.frames.read(frame);
    largest = std::max(largest, usda.frame_size(job.frames.objects()));
  }
  return frames * largest;
}

std::uint64_t usda_clips(const ConvertJob& job, UsdaRun& usda) {
  const fs::path folder = job.name + "_clips";
  create_folder(job.out / folder);
  std::vector<std::string> clips;
  const std::uint64_t frames = for_each_frame(job, [&](std::uint64_t frame) {
    const fs::path clip = folder / frame_file_name(job.name, frame, "usda");
    write_file_atomically(job.out / clip, usda.clip(frame, job.frames.objects()));
    clips.push_back(clip.generic_string());
  });
  if (frames == 0) return 0;
  write_file_atomically(job.out / UsdaRun::manifest_name(job.name), usda.clip_manifest());
  write_file_atomically(job.out / (job.name + ".usda"), usda.stage(clips));
  return frames;
}

}  // namespace

std::uint64_t convert_to_glb(const ConvertJob& job) {
  job.frames.read(1);
  const std::uint64_t frames = job.frames.playback().frames();
  const std::uint64_t size = glb_clip_size(frames, job.frames.objects());
  const bool one = takes_one_glb(job, size);
  remove_earlier(job.out, job.name, "glb");
  if (one) {
    announce(job, fmt::format("{}.glb, an animation of {} frames", job.name, frames), size);
    return glb_clip(job);
  }
  const auto bytes = [&](std::uint64_t frame) {
    return glb_frame(job.name, frame, job.frames.playback().time(frame), job.frames.objects());
  };
  job.frames.read(frames);
  announce(job,
           fmt::format("{}, ..., a file for each of {} frames", frame_file_name(job.name, 1, "glb"), frames),
           frames * bytes(frames).size());
  return for_each_frame(job, [&](std::uint64_t frame) {
    write_file_atomically(job.out / frame_file_name(job.name, frame, "glb"), bytes(frame));
  });
}

std::uint64_t convert_to_usda(const ConvertJob& job) {
  const std::uint64_t frames = job.frames.playback().frames();
  UsdaRun::Options options{
      .run = job.name, .frame_rate = job.frames.playback().manifest().frame_rate, .frames = frames};
  job.frames.read(1);
  const std::uint64_t size = usda_size(job, UsdaRun(options, job.frames.objects()));
  options.clips = job.layout == ConvertLayout::file_per_frame ||
                  (job.layout == ConvertLayout::automatic && size > largest_stage);
  job.frames.read(1);
  UsdaRun usda(options, job.frames.objects());
  remove_earlier(job.out, job.name, "usda");
  std::error_code error;
  fs::remove(job.out / UsdaRun::manifest_name(job.name), error);
  remove_earlier(job.out / (job.name + "_clips"), job.name, "usda");
  fs::remove(job.out / (job.name + "_clips"), error);  // only if it is empty
  if (options.clips) {
    announce(job, fmt::format("{}.usda and a value clip for each of {} frames", job.name, frames), size);
    return usda_clips(job, usda);
  }
  announce(job, fmt::format("{}.usda, {} frames", job.name, frames), size);
  const std::uint64_t done =
      for_each_frame(job, [&](std::uint64_t frame) { usda.add(frame, job.frames.objects()); });
  if (done < frames) return 0;
  write_file_atomically(job.out / (job.name + ".usda"), usda.stage());
  return done;
}

}  // namespace souple::app
