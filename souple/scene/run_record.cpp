#include "souple/scene/run_record.h"

#include "souple/scene/table.h"

#include <limits>

namespace souple {

namespace scene_format {

namespace {

CodecPtr<RunRecord> record_codec() {
  const CodecPtr<std::string> text = scene_format::text(std::numeric_limits<std::size_t>::max());
  auto keys = std::make_shared<Table<RunRecord>>("run", "A run that can go on.");
  keys->required<&RunRecord::name>("name", text, "name of the scene")
      .required<&RunRecord::source>("source", text, "its file")
      .required<&RunRecord::folder>("folder", text, "where its meshes are")
      .required<&RunRecord::scene>("scene", text, "its JSON")
      .required<&RunRecord::formats>("formats", list(enumeration(cache_formats()), 0, 4), "of its caches")
      .required<&RunRecord::checkpoint_every>("checkpoint_every", number<std::uint32_t>(from_zero(4e9)),
                                              "frames between checkpoints")
      .key<&RunRecord::surface>("surface", text, "method by which fluids are meshed meanwhile");
  return keys;
}

}  // namespace

}  // namespace scene_format

const std::vector<std::pair<std::string, CacheFormat>>& cache_formats() {
  static const std::vector<std::pair<std::string, CacheFormat>> formats{{"pc2", CacheFormat::pc2},
                                                                        {"mdd", CacheFormat::mdd},
                                                                        {"obj", CacheFormat::obj},
                                                                        {"ply", CacheFormat::ply}};
  return formats;
}

std::string run_record_text(const RunRecord& record) {
  return scene_format::dump_json(scene_format::record_codec()->write(record));
}

RunRecord parse_run_record(std::string_view text, std::string_view source) {
  const scene_format::Reading reading{std::string(source), {}};
  RunRecord record;
  scene_format::record_codec()->read(scene_format::parse_json(text, source), scene_format::JsonPath(reading),
                                     record);
  return record;
}

}  // namespace souple
