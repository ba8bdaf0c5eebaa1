#include "souple/mesh_files/mesh_faces.h"
#include "souple/mesh_files/mesh_groups.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/mesh_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/core.h>

namespace souple {

namespace {

using mesh_detail::FaceList;
using mesh_detail::most_groups_at_once;
using mesh_detail::quoted;
using mesh_detail::TextScanner;

/// Words of the OBJ specification that a surface does not need.
constexpr std::array<std::string_view, 33> skipped_words = {
    "vp",       "usemap",   "maplib",     "mg",        "lod",  "bevel", "cstype", "deg",   "bmat",
    "step",     "curv",     "curv2",      "surf",      "parm", "trim",  "hole",   "scrv",  "sp",
    "end",      "con",      "shadow_obj", "trace_obj", "call", "csh",   "ctech",  "stech", "res",
    "c_interp", "d_interp", "bsp",        "bzp",       "cdc",  "cdp"};

/// An index beyond what the file has listed so far. It is legal as long as the file lists it later.
struct LargestIndex {
  std::uint64_t count_needed = 0;
  std::size_t line = 0;
};

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& name)
      : scanner_(text, name, {.comments = true, .continuations = true}) {}

  TriangleMesh read() {
    do {
      read_line(scanner_.word());
    } while (scanner_.next_line());
    end_run();
    return finish();
  }

 private:
  void read_line(std::string_view keyword) {
    if (keyword.empty()) return;
    if (keyword == "v") return read_vertex();
    if (keyword == "f" || keyword == "fo") return read_face();
    if (keyword == "vt") return read_uv();
    if (keyword == "g") return read_group();
    if (keyword == "o") return read_name(object_, "");
    if (keyword == "usemtl") return read_material();
    if (keyword == "vn") return read_normal();
    if (keyword == "s") return read_smoothing();
    if (keyword == "mtllib") return read_material_file();
    if (keyword == "p" || keyword == "l") return read_loose();
    if (std::find(skipped_words.begin(), skipped_words.end(), keyword) == skipped_words.end()) {
      scanner_.fail(quoted(keyword), "a keyword of OBJ, such as v, vt, vn, f, g or o");
    }
  }

  // v x y z, v x y z w (the weight of a rational curve, ignored), or v x y z r g b.
  void read_vertex() {
    std::array<double, 6> values{};
    std::size_t count = 0;
    for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word()) {
      if (count == values.size())
        scanner_.fail(quoted(word) + " as a seventh number", "3, 4 or 6 numbers after v");
      values[count++] = scanner_.coordinate_from(word, "coordinate or color of a vertex");
    }
    if (count != 3 && count != 4 && count != 6) {
      scanner_.fail(fmt::format("{} numbers", count),
                    "3, 4 or 6 numbers after v (x y z, x y z w or x y z r g b)");
    }
    const Vec3f white{1.0f, 1.0f, 1.0f};
    if (count == 6) {
      colors_.resize(positions_.size(), white);
      colors_.emplace_back(color(values[3]), color(values[4]), color(values[5]));
    } else if (!colors_.empty()) {
      colors_.push_back(white);
    }
    positions_.emplace_back(values[0], values[1], values[2]);
  }

  float color(double value) const {
    constexpr double rounding = 1e-3;
    if (value < -rounding || value > 1.0 + rounding) {
      scanner_.fail(fmt::format("the color {}", value), "a vertex color from 0 to 1");
    }
    return float(std::clamp(value, 0.0, 1.0));
  }

  void read_uv() {
    const double u = scanner_.coordinate_from(scanner_.word(), "u of vt");
    const std::string_view second = scanner_.word();
    const double v = second.empty() ? 0.0 : scanner_.coordinate_from(second, "v of vt");
    uvs_.push_back({float(u), float(v)});
  }

  // Normals, smoothing groups and material files are only repeated in caches, so a mistake in them is no error.
  void read_normal() {
    Vec3d normal{};
    for (int axis = 0; axis < 3; ++axis) {
      if (!mesh_detail::parse_real(scanner_.word(), normal[axis])) normal[axis] = 0;
    }
    const double l = length(normal);
    normals_.push_back(std::isfinite(l) && l > 0 ? Vec3f(normal / l) : Vec3f{});
  }

  void read_smoothing() {
    std::int64_t group = 0;
    const std::string_view word = scanner_.word();
    const bool is_group = mesh_detail::parse_integer(word, group) && group >= 0 && group <= 0x7fffffff;
    smoothing_ = is_group ? std::uint32_t(group) : (word == "on" ? 1u : 0u);
    states_smoothing_ = true;
  }

  void read_material_file() {
    const std::string file(scanner_.rest_of_line());
    std::vector<std::string>& files = appearance_.material_files;
    if (!file.empty() && std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  }

  void read_material() {
    read_name(material_, "material:");
    material_index_ = FaceAppearance::no_material;
    if (material_.empty()) return;
    const auto next = std::uint32_t(appearance_.materials.size());
    const auto [known, is_new] = material_indices_.try_emplace(material_, next);
    material_index_ = known->second;
    if (is_new) appearance_.materials.push_back(material_.substr(std::string_view("material:").size()));
  }

  void read_face() {
    const std::size_t begin = faces_.corners.size();
    for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word()) read_corner(word);
    const std::size_t count = faces_.corners.size() - begin;
    if (count < 3) scanner_.fail(fmt::format("{} corners", count), "at least 3 corners in a face");
    const auto has_no_uv = [](std::uint32_t uv) { return uv == FaceList::no_uv; };
    const auto without = std::size_t(
        std::count_if(faces_.corner_uvs.begin() + std::ptrdiff_t(begin), faces_.corner_uvs.end(), has_no_uv));
    if (without != 0 && without != count) {
      scanner_.fail("a face with UVs at some corners only", "a UV at each corner of a face or at none");
    }
    faces_.end_face();
    appearance_.face_materials.push_back(material_index_);
    appearance_.smoothing.push_back(smoothing_);
  }

  // v, v/vt, v//vn or v/vt/vn
  void read_corner(std::string_view word) {
    const std::size_t first = word.find('/');
    faces_.corners.push_back(index(word, word.substr(0, first), positions_.size(), largest_vertex_));
    std::uint32_t uv = FaceList::no_uv, normal = FaceList::no_normal;
    if (first != std::string_view::npos) {
      const std::string_view rest = word.substr(first + 1);
      const std::size_t second = rest.find('/');
      const std::string_view uv_text = rest.substr(0, second);
      if (!uv_text.empty()) uv = index(word, uv_text, uvs_.size(), largest_uv_);
      if (second == std::string_view::npos ? uv_text.empty() : !is_normal(rest.substr(second + 1), normal))
        fail_corner(word);
    }
    faces_.corner_uvs.push_back(uv);
    faces_.corner_normals.push_back(normal);
  }

  /// Whether the text is an index; `normal` stays no_normal if that is out of range.
  bool is_normal(std::string_view text, std::uint32_t& normal) const {
    std::int64_t value = 0;
    if (!mesh_detail::parse_integer(text, value) || value == 0) return false;
    if (value < 0) value += std::int64_t(normals_.size()) + 1;
    if (value > 0 && value < std::int64_t(FaceList::no_normal)) normal = std::uint32_t(value - 1);
    return true;
  }

  [[noreturn]] void fail_corner(std::string_view word) const {
    scanner_.fail(quoted(word), "a face corner such as 1, 1/2, 1//3 or 1/2/3");
  }

  /// Converts an index from 1 upward, or from -1 (the last listed so far) downward, to an index from 0.
  std::uint32_t index(std::string_view corner, std::string_view text, std::size_t listed,
                      LargestIndex& largest) const {
    std::int64_t value = 0;
    if (!mesh_detail::parse_integer(text, value)) fail_corner(corner);
    if (value == 0) scanner_.fail("index 0 in " + quoted(corner), "indices from 1, or negative ones");
    if (value < 0) {
      if (std::uint64_t(-(value + 1)) >= listed) fail_range(scanner_.line(), text, listed);
      return std::uint32_t(std::int64_t(listed) + value);
    }
    constexpr std::int64_t largest_storable = 0xfffffffe;
    if (value > largest_storable) fail_range(scanner_.line(), text, listed);
    if (std::uint64_t(value) > listed && std::uint64_t(value) > largest.count_needed) {
      largest = {std::uint64_t(value), scanner_.line()};
    }
    return std::uint32_t(value - 1);
  }

  [[noreturn]] void fail_range(std::size_t line, std::string_view index, std::size_t listed) const {
    scanner_.fail_at(line, "index " + std::string(index.substr(0, 24)),
                     fmt::format("at most {}, the number that the file lists", listed));
  }

  void read_group() {
    std::vector<std::string> names;
    for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word()) {
      if (names.size() == most_groups_at_once) scanner_.fail("more than 16 groups on a line", "at most 16");
      // The specification's name for "no group".
      if (word != "default") names.emplace_back(word);
    }
    end_run();
    groups_ = std::move(names);
  }

  void read_name(std::string& current, const char* prefix) {
    const std::string_view name = scanner_.rest_of_line();
    end_run();
    current = name.empty() ? std::string() : prefix + std::string(name);
  }

  // Points and lines are no surface, but their vertices belong to the groups.
  void read_loose() {
    for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word()) {
      loose_.push_back(index(word, word.substr(0, word.find('/')), positions_.size(), largest_vertex_));
    }
  }

  /// Adds the vertices read since the last change of groups to the previous groups.
  void end_run() {
    std::vector<std::uint32_t> vertices = std::move(loose_);
    loose_.clear();
    vertices.insert(vertices.end(), faces_.corners.begin() + std::ptrdiff_t(run_begin_),
                    faces_.corners.end());
    run_begin_ = faces_.corners.size();
    if (vertices.empty()) return;
    mesh_detail::GroupBuilder::sort_unique(vertices);
    const auto add = [&](const std::string& name) {
      std::vector<std::uint32_t>& group = built_groups_[name];
      group.insert(group.end(), vertices.begin(), vertices.end());
    };
    for (const std::string& name : groups_) add(name);
    if (!object_.empty()) add(object_);
    if (!material_.empty()) add(material_);
  }

  TriangleMesh finish() {
    if (positions_.empty()) scanner_.fail("no vertex in the whole file", "at least one line \"v x y z\"");
    check(largest_vertex_, positions_.size());
    check(largest_uv_, uvs_.size());
    for (std::uint32_t& normal : faces_.corner_normals)
      if (normal >= normals_.size() || normals_[normal] == Vec3f{}) normal = FaceList::no_normal;
    TriangleMesh mesh;
    mesh.appearance = appearance();
    faces_.store(mesh);
    mesh.positions = std::move(positions_);
    mesh.colors = std::move(colors_);
    mesh.uvs = std::move(uvs_);
    mesh.groups = built_groups_.finish();
    return mesh;
  }

  FaceAppearance appearance() {
    if (appearance_.materials.empty()) appearance_.face_materials.clear();
    if (!states_smoothing_) appearance_.smoothing.clear();
    const auto& used = faces_.corner_normals;
    const auto is_used = [](std::uint32_t normal) { return normal != FaceList::no_normal; };
    if (std::any_of(used.begin(), used.end(), is_used)) appearance_.normals = std::move(normals_);
    return std::move(appearance_);
  }

  void check(const LargestIndex& largest, std::size_t listed) const {
    if (largest.count_needed > listed)
      fail_range(largest.line, fmt::format("{}", largest.count_needed), listed);
  }

  TextScanner scanner_;
  std::vector<Vec3d> positions_;
  std::vector<Vec3f> colors_;
  std::vector<std::array<float, 2>> uvs_;
  FaceList faces_;
  LargestIndex largest_vertex_, largest_uv_;

  std::vector<Vec3f> normals_;
  FaceAppearance appearance_;  ///< its lists per face grow with the faces
  std::map<std::string, std::uint32_t> material_indices_;
  std::uint32_t material_index_ = FaceAppearance::no_material, smoothing_ = 0;
  bool states_smoothing_ = false;

  std::string object_, material_;
  std::vector<std::string> groups_;
  std::vector<std::uint32_t> loose_;
  std::size_t run_begin_ = 0;
  mesh_detail::GroupBuilder built_groups_;
};

}  // namespace

TriangleMesh parse_obj(std::string_view text, const std::string& name) {
  return ObjReader(text, name).read();
}

}  // namespace souple
