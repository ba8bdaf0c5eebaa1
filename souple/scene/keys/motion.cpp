#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

CodecPtr<SequenceDescription> sequence_codec() {
  using S = SequenceDescription;
  auto keys = table<S>(
      "sequence",
      "Positions of all vertices of the object over time, in the coordinates of its mesh: the `transform` of "
      "the object applies. Linear between frames; constant before the first and after the last.");
  keys->required<&S::file>("file", file_or_folder(),
                           "a .pc2 or .mdd file, or a .glb, .gltf, .fbx or .dae file whose bones, shapes or "
                           "nodes move the mesh. Or a sequence of OBJ files: one of its files "
                           "(NAME_0001.obj), or the folder if it contains no other sequence")
      .key<&S::animation>(
          "animation", text(),
          "name of an animation in a .glb, .gltf, .fbx or .dae file; may be left out where the file has only "
          "one. Without it, NAME_0001.glb beside NAME_0002.glb is a sequence of meshes")
      .key<&S::frame_rate>(
          "frame_rate", number<double>(positive(1e4)),
          "frames per second; ignored for .mdd files, which store their own times; animations "
          "with bones, shapes or nodes are evaluated this often")
      .key<&S::start_time>("start_time", number<double>(signed_range(1e6)), "time of the first frame [s]")
      .key<&S::scale>("scale", maybe(number<double>(positive(1e6))),
                      "meters per unit of the file; if not given, the `scale` of the mesh")
      .key<&S::up>("up", maybe(up_codec()),
                   "the axis that points up in the file; if not given, the `up` of the mesh")
      .key<&S::loop>("loop", boolean(), "repeats the frames after the last, which should equal the first");
  return keys;
}

CodecPtr<TransformDescription> transform_codec() {
  using T = TransformDescription;
  auto keys =
      table<T>("transform", "Position, rotation and scale: scaled first, then rotated, then translated.");
  keys->key<&T::translate>("translate", vector3<double>(meters), "position of the origin [m]")
      .key<&T::rotate>("rotate", vector3<double>(signed_range(1e5)),
                       "rotation about the fixed axes X, then Y, then Z [degrees]")
      .key<&T::scale>("scale", number<double>(positive(1e4)), "scale factor");
  return keys;
}

CodecPtr<TransformDescription> pose_codec() {
  using T = TransformDescription;
  auto keys = table<T>("pose", "Position and rotation: rotated first, then translated.");
  keys->key<&T::translate>("translate", vector3<double>(meters), "position of the origin [m]")
      .key<&T::rotate>("rotate", vector3<double>(signed_range(1e5)),
                       "rotation about the fixed axes X, then Y, then Z [degrees]");
  return keys;
}

CodecPtr<std::vector<KeyframeDescription>> keyframes_codec() {
  using K = KeyframeDescription;
  auto keys = table<K>(
      "keyframe",
      "A pose at a given time. Between keyframes, translations are linear and rotations take the shorter arc "
      "at constant speed. Before the first and after the last keyframe the pose is constant.");
  keys->required<&K::time>("time", number<double>(from_zero(1e6)),
                           "time [s]; each keyframe must be later than the previous one")
      .key<&K::translate>("translate", vector3<double>(meters), "translation [m]")
      .key<&K::rotate>("rotate", vector3<double>(signed_range(1e5)),
                       "rotation about the fixed axes X, then Y, then Z [degrees]");
  return list<K>(keys, 0, 100000);
}

void check_times(const std::vector<KeyframeDescription>& keyframes, const JsonPath& path) {
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    if (keyframes[i].time > keyframes[i - 1].time) continue;
    const JsonPath list_path = path.key("keyframes");
    const JsonPath item = list_path.item(i);
    item.key("time").fail("must be later than the previous keyframe, at " +
                          number_text(keyframes[i - 1].time) + " s; found " + number_text(keyframes[i].time));
  }
}

}  // namespace souple::scene_format
