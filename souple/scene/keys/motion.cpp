#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

template <class S>
std::shared_ptr<Table<S>> sequence_table(const char* heading) {
  auto keys = table<S>(heading,
                       "Positions of all the object's vertices over time, in the coordinates of its "
                       "mesh (its `scale`, `up` and `transform` apply). Linear between frames; still "
                       "before the first and after the last.");
  keys->template required<&S::file>("file", file_or_folder(),
                                    "a .pc2, a .mdd, or a sequence of OBJ: one file of it (NAME_0001.obj) or "
                                    "the folder that holds it and no other")
      .template key<&S::frame_rate>("frame_rate", number<double>(positive(1e4)),
                                    "frames a second; a .mdd holds its own times")
      .template key<&S::start_time>("start_time", number<double>(signed_range(1e6)),
                                    "when its first frame plays [s]");
  return keys;
}

}  // namespace

CodecPtr<TransformDescription> transform_codec() {
  using T = TransformDescription;
  auto keys = table<T>("transform", "Where a thing stands: scaled first, then rotated, then moved.");
  keys->key<&T::translate>("translate", vector3<double>(meters), "where its origin goes [m]")
      .key<&T::rotate>("rotate", vector3<double>(signed_range(1e5)),
                       "degrees about X, then Y, then Z (axes that stay)")
      .key<&T::scale>("scale", number<double>(positive(1e4)), "factor");
  return keys;
}

CodecPtr<TransformDescription> pose_codec() {
  using T = TransformDescription;
  auto keys = table<T>("pose", "Where a collider stands: rotated first, then moved.");
  keys->key<&T::translate>("translate", vector3<double>(meters), "where its origin goes [m]")
      .key<&T::rotate>("rotate", vector3<double>(signed_range(1e5)),
                       "degrees about X, then Y, then Z (axes that stay)");
  return keys;
}

CodecPtr<std::vector<KeyframeDescription>> keyframes_codec() {
  using K = KeyframeDescription;
  auto keys = table<K>("keyframe",
                       "A pose at a moment. Between two, translations go straight and rotations the "
                       "shorter way round at constant speed; before the first and after the last "
                       "nothing moves.");
  keys->required<&K::time>("time", number<double>(from_zero(1e6)), "when [s]; each later than the one before")
      .key<&K::translate>("translate", vector3<double>(meters), "[m]")
      .key<&K::rotate>("rotate", vector3<double>(signed_range(1e5)), "degrees about X, then Y, then Z");
  return list<K>(keys, 0, 100000);
}

void check_times(const std::vector<KeyframeDescription>& keyframes, const JsonPath& path) {
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    if (keyframes[i].time > keyframes[i - 1].time) continue;
    const JsonPath list_path = path.key("keyframes");
    const JsonPath item = list_path.item(i);
    item.key("time").fail("must be later than the keyframe before, at " + number_text(keyframes[i - 1].time) +
                          " s; found " + number_text(keyframes[i].time));
  }
}

CodecPtr<SequenceDescription> sequence_codec() {
  return sequence_table<SequenceDescription>("sequence");
}

CodecPtr<ObstacleSequenceDescription> obstacle_sequence_codec() {
  using S = ObstacleSequenceDescription;
  auto keys = sequence_table<S>("obstacle_sequence");
  keys->key<&S::loop>("loop", boolean(),
                      "starts over after the last frame, which is best the same as the first");
  return keys;
}

}  // namespace souple::scene_format
