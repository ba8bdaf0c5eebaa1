#include "souple/mesh_files/mesh_message.h"

#include "souple/error.h"
#include "souple/mesh_files/assimp_formats.h"
#include "souple/mesh_files/mesh_bytes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace souple::mesh_detail {

namespace {

constexpr std::string_view message_begin = "souple mesh 1\n", message_end = "end of mesh\n";
enum Kind : std::uint8_t { is_mesh, is_failure, is_animation };

using Indices = std::vector<std::uint32_t>;

class Writer {
 public:
  explicit Writer(Kind kind) : out_(message_begin) { number(std::uint8_t(kind)); }

  void reserve(std::size_t bytes) { out_.reserve(out_.size() + bytes); }

  template <class T>
  void number(T value) {
    append_binary<ByteOrder::little>(out_, value);
  }
  void text(std::string_view text) {
    number(std::uint64_t(text.size()));
    out_ += text;
  }
  template <class List, class Write>
  void list(const List& items, Write write) {
    number(std::uint64_t(items.size()));
    for (const auto& item : items) write(item);
  }
  void indices(const Indices& items) {
    list(items, [&](std::uint32_t i) { number(i); });
  }
  void lists(const std::vector<Indices>& items) {
    list(items, [&](const Indices& item) { indices(item); });
  }
  void vectors(const std::vector<Vec3f>& items) {
    list(items, [&](const Vec3f& v) { number(v.x), number(v.y), number(v.z); });
  }
  void texts(const std::vector<std::string>& items) {
    list(items, [&](const std::string& item) { text(item); });
  }
  std::string finish() {
    out_ += message_end;
    return std::move(out_);
  }

 private:
  std::string out_;
};

class Reader {
 public:
  Reader(std::string_view message, const std::string& name) : bytes_(message, name, false) {}

  template <class T>
  T number() {
    return bytes_.read<T>("number of a mesh");
  }
  std::size_t count(std::size_t bytes_each) {
    const auto count = number<std::uint64_t>();
    bytes_.require_room(count, bytes_each, "list of a mesh");
    return std::size_t(count);
  }
  std::string text() {
    std::string text(count(1), '\0');
    for (char& c : text) c = char(number<std::uint8_t>());
    return text;
  }
  template <class T, class Read>
  std::vector<T> list(std::size_t bytes_each, Read read) {
    std::vector<T> items(count(bytes_each));
    for (T& item : items) item = read();
    return items;
  }
  /// Indices below `limit`, or `none` where that is allowed.
  std::uint32_t index(std::size_t limit, bool or_none = false) {
    const auto i = number<std::uint32_t>();
    require(i < limit || (or_none && i == FaceAppearance::no_material));
    return i;
  }
  Indices indices(std::size_t limit, bool or_none = false) {
    return list<std::uint32_t>(4, [&] { return index(limit, or_none); });
  }
  std::vector<Indices> lists(std::size_t limit) {
    return list<Indices>(8, [&] { return indices(limit); });
  }
  float real() { return bytes_.real32("number of a mesh"); }
  double real64() { return bytes_.real64("time of a frame"); }
  Vec3f vector() {
    const float x = real(), y = real(), z = real();
    return {x, y, z};
  }
  Vec3d position() {
    const double x = bytes_.real64("coordinate"), y = bytes_.real64("coordinate"),
                 z = bytes_.real64("coordinate");
    return {x, y, z};
  }
  std::vector<Vec3f> vectors() {
    return list<Vec3f>(12, [&] { return vector(); });
  }
  std::vector<std::string> texts() {
    return list<std::string>(8, [&] { return text(); });
  }
  void require(bool sound) const {
    if (!sound) bytes_.fail("what no mesh holds", "an answer of souple-mesh-reader");
  }

 private:
  ByteScanner bytes_;
};

/// Lists per face: none at all, or one per face that is empty or has one entry per corner.
void check_shape(const Reader& reader, const std::vector<Indices>& lists, const TriangleMesh& mesh) {
  const bool polygons = !mesh.faces.empty();
  const std::size_t faces = polygons ? mesh.faces.size() : mesh.triangles.size();
  reader.require(lists.empty() || lists.size() == faces);
  for (std::size_t i = 0; i < lists.size(); ++i)
    reader.require(lists[i].empty() || lists[i].size() == (polygons ? mesh.faces[i].size() : 3));
}

void read_geometry(Reader& reader, TriangleMesh& mesh) {
  mesh.positions = reader.list<Vec3d>(24, [&] { return reader.position(); });
  const std::size_t vertices = mesh.positions.size();
  mesh.triangles = reader.list<Triangle>(12, [&] {
    const std::uint32_t a = reader.index(vertices), b = reader.index(vertices), c = reader.index(vertices);
    return Triangle{a, b, c};
  });
  mesh.uvs = reader.list<std::array<float, 2>>(8, [&] {
    const float u = reader.real(), v = reader.real();
    return std::array<float, 2>{u, v};
  });
  mesh.faces = reader.lists(vertices);
  for (const Indices& face : mesh.faces) reader.require(face.size() >= 3);
  mesh.face_uvs = reader.lists(mesh.uvs.size());
  check_shape(reader, mesh.face_uvs, mesh);
  mesh.colors = reader.vectors();
  reader.require(mesh.colors.empty() || mesh.colors.size() == vertices);
  for (std::size_t left = reader.count(16); left > 0; --left) {
    std::string group = reader.text();
    Indices members = reader.indices(vertices);
    reader.require(std::is_sorted(members.begin(), members.end(), std::less_equal<>()));
    mesh.groups[std::move(group)] = std::move(members);
  }
}

void read_appearance(Reader& reader, TriangleMesh& mesh) {
  FaceAppearance& look = mesh.appearance;
  const std::size_t faces = mesh.faces.empty() ? mesh.triangles.size() : mesh.faces.size();
  look.material_files = reader.texts();
  look.materials = reader.texts();
  look.face_materials = reader.indices(look.materials.size(), true);
  reader.require(look.face_materials.empty() || look.face_materials.size() == faces);
  look.smoothing = reader.list<std::uint32_t>(4, [&] { return reader.number<std::uint32_t>(); });
  reader.require(look.smoothing.empty() || look.smoothing.size() == faces);
  look.normals = reader.vectors();
  look.face_normals = reader.lists(look.normals.size());
  check_shape(reader, look.face_normals, mesh);
}

/// The text between the first and the last line.
std::string_view content_of(std::string_view message, const std::string& name) {
  if (!is_whole_message(message)) throw Error(name + ": the answer of souple-mesh-reader breaks off");
  message.remove_prefix(message_begin.size());
  message.remove_suffix(message_end.size());
  return message;
}

/// Throws Error for a failure, with its reason.
void check_kind(Reader& reader, Kind expected) {
  const auto kind = reader.number<std::uint8_t>();
  if (kind == expected) return;
  reader.require(kind == is_failure);
  std::string why = reader.text();
  std::replace_if(
      why.begin(), why.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
  throw Error(why);
}

}  // namespace

std::string message_of_mesh(const TriangleMesh& mesh) {
  Writer out(is_mesh);
  out.list(mesh.positions, [&](const Vec3d& p) { out.number(p.x), out.number(p.y), out.number(p.z); });
  out.list(mesh.triangles, [&](const Triangle& t) {
    for (const std::uint32_t i : t) out.number(i);
  });
  out.list(mesh.uvs, [&](const std::array<float, 2>& uv) { out.number(uv[0]), out.number(uv[1]); });
  out.lists(mesh.faces);
  out.lists(mesh.face_uvs);
  out.vectors(mesh.colors);
  out.list(mesh.groups, [&](const auto& group) { out.text(group.first), out.indices(group.second); });
  const FaceAppearance& look = mesh.appearance;
  out.texts(look.material_files);
  out.texts(look.materials);
  out.indices(look.face_materials);
  out.indices(look.smoothing);
  out.vectors(look.normals);
  out.lists(look.face_normals);
  return out.finish();
}

std::string message_of_animation(const MeshAnimation& animation) {
  Writer out(is_animation);
  constexpr std::size_t counts_and_end = 64;
  out.reserve(animation.times.size() * sizeof(double) + animation.positions.size() * 3 * sizeof(float) +
              counts_and_end);
  out.number(std::uint64_t(animation.points));
  out.list(animation.times, [&](double time) { out.number(time); });
  out.vectors(animation.positions);
  return out.finish();
}

std::string message_of_failure(std::string_view why) {
  Writer out(is_failure);
  out.text(why.substr(0, longest_reader_message));
  return out.finish();
}

bool is_whole_message(std::string_view message) {
  return message.size() > message_begin.size() + message_end.size() &&
         message.substr(0, message_begin.size()) == message_begin &&
         message.substr(message.size() - message_end.size()) == message_end;
}

TriangleMesh mesh_of_message(std::string_view message, const std::string& name) {
  Reader reader(content_of(message, name), name);
  check_kind(reader, is_mesh);
  TriangleMesh mesh;
  read_geometry(reader, mesh);
  read_appearance(reader, mesh);
  reader.require(!mesh.positions.empty());
  return mesh;
}

MeshAnimation animation_of_message(std::string_view message, const std::string& name) {
  Reader reader(content_of(message, name), name);
  check_kind(reader, is_animation);
  MeshAnimation animation;
  animation.points = std::size_t(reader.number<std::uint64_t>());
  animation.times = reader.list<double>(8, [&] { return reader.real64(); });
  animation.positions = reader.vectors();
  const std::size_t frames = animation.times.size();
  reader.require(frames > 0 && animation.times.front() == 0 && animation.positions.size() % frames == 0 &&
                 animation.positions.size() / frames == animation.points);
  for (std::size_t i = 1; i < frames; ++i) reader.require(animation.times[i] > animation.times[i - 1]);
  return animation;
}

}  // namespace souple::mesh_detail
