#include "souple/io/usda_run.h"

#include "souple/io/split_mesh.h"
#include "souple/io/usda_text.h"
#include "souple/version.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

#include <fmt/core.h>

namespace souple {

namespace {

using usda::exact;
using usda::extent;
using usda::integers;
using usda::pairs;
using usda::PrimNames;
using usda::repeated;
using usda::rounded;
using usda::string_text;

constexpr const char* materials_name = "Materials";
constexpr float unknown_radius = 0.01f;  // of spheres whose scene is not known [m]

std::vector<std::uint32_t> face_sizes(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> sizes(mesh.faces.size());
  std::transform(mesh.faces.begin(), mesh.faces.end(), sizes.begin(),
                 [](const auto& face) { return static_cast<std::uint32_t>(face.size()); });
  if (mesh.faces.empty()) sizes.assign(mesh.triangles.size(), 3);
  return sizes;
}

std::vector<std::uint32_t> face_corners(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> corners;
  for (const auto& face : mesh.faces) corners.insert(corners.end(), face.begin(), face.end());
  if (mesh.faces.empty())
    for (const Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  return corners;
}

/// A face without UVs has the first one at its corners.
std::string uvs_text(const TriangleMesh& mesh) {
  if (mesh.uvs.empty()) return "";
  const bool of_corners = !mesh.face_uvs.empty();
  std::string text = fmt::format("texCoord2f[] primvars:st = {} (\n    interpolation = \"{}\"\n)\n",
                                 pairs(mesh.uvs), of_corners ? "faceVarying" : "vertex");
  if (!of_corners) return text;
  const std::vector<std::uint32_t> sizes = face_sizes(mesh);
  std::vector<std::uint32_t> indices;
  for (std::size_t face = 0; face < sizes.size(); ++face) {
    std::vector<std::uint32_t> of_face = mesh.face_uvs[face];
    of_face.resize(sizes[face]);
    indices.insert(indices.end(), of_face.begin(), of_face.end());
  }
  return text + "int[] primvars:st:indices = " + integers(indices) + "\n";
}

std::string color_text(const Vec3f& color) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", color.x, color.y, color.z);
}

/// The lines of a text, indented by four spaces more.
std::string indented(const std::string& text) {
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    if (end != begin) result += "    ";
    result.append(text, begin, end - begin + 1);
    begin = end + 1;
  }
  return result;
}

/// A file's path relative to the stage, as an asset.
std::string asset(const std::string& path) {
  const char* const mark = path.find('@') == std::string::npos ? "@" : "@@@";
  return fmt::format("{}./{}{}", mark, path, mark);
}

std::string block(const std::string& head, const std::string& body) {
  return head + "\n{\n" + indented(body) + "}\n";
}

std::string subset(const std::string& head, const char* family, const std::vector<std::uint32_t>& faces,
                   const std::string& more) {
  return block(head, fmt::format("uniform token elementType = \"face\"\nuniform token familyName = \"{}\"\n"
                                 "int[] indices = {}\n{}",
                                 family, integers(faces), more));
}

const char* prim_type(ExportShape shape) {
  switch (shape) {
    case ExportShape::surface:
      return "Mesh";
    case ExportShape::line:
      return "BasisCurves";
    case ExportShape::fluid:
      return "Points";
    case ExportShape::grains:
    case ExportShape::foam:
      break;
  }
  return "PointInstancer";
}

bool is_instancer(const ExportObject& object) {
  return object.shape == ExportShape::grains || object.shape == ExportShape::foam;
}

float radius_of(const ExportObject& object) {
  if (object.shape == ExportShape::surface) return 0;
  return object.look.radius > 0 || !is_instancer(object) ? object.look.radius : unknown_radius;
}

/// In parentheses after the declaration of a prim with a material.
constexpr const char* binding_schema = " (\n    prepend apiSchemas = [\"MaterialBindingAPI\"]\n)";

std::string velocities_text(const ExportObject& object) {
  constexpr int digits = 6;
  if (object.velocities.size() == object.positions.size()) return rounded(object.velocities, digits);
  return rounded(std::vector<Vec3f>(object.positions.size()), digits);
}

std::string prototypes_of_points(const ExportObject& object) {
  if (object.foam_kinds.empty()) return repeated(object.positions.size(), 0);
  return integers(std::vector<std::uint32_t>(object.foam_kinds.begin(), object.foam_kinds.end()));
}

}  // namespace

UsdaRun::UsdaRun(const Options& options, std::span<const ExportObject> first) : options_(options) {
  root_ = PrimNames().add(options.run);
  PrimNames names;
  names.add(materials_name);
  for (const ExportObject& object : first) {
    Prim prim = prim_of(object);
    prim.name = names.add(object.name);
    if (is_instancer(object)) prim.constant += spheres_of(object, prim.name);
    for (Value& value : values_of(object)) prim.attributes.push_back({.declaration = value.declaration});
    prims_.push_back(std::move(prim));
  }
}

UsdaRun::Prim UsdaRun::prim_of(const ExportObject& object) {
  Prim prim;
  prim.type = prim_type(object.shape);
  prim.metadata = " (\n    displayName = " + string_text(object.name) +
                  "\n    prepend apiSchemas = [\"MaterialBindingAPI\"]\n)";
  prim.constant = bind(object, object.name, object.look);
  const TriangleMesh& mesh = *object.mesh;
  const bool per_vertex = !mesh.colors.empty() && object.constant;
  const std::string colors = per_vertex ? exact(mesh.colors) : "[" + color_text(object.look.color) + "]";
  prim.constant += fmt::format("color3f[] primvars:displayColor = {} (\n    interpolation = \"{}\"\n)\n",
                               colors, per_vertex ? "vertex" : "constant");
  if (object.shape == ExportShape::surface) {
    prim.constant += "uniform token subdivisionScheme = \"none\"\n";
    if (object.smooth) prim.constant += "normal3f[] normals (\n    interpolation = \"vertex\"\n)\n";
    if (object.constant) prim.constant += topology_of(object);
    return prim;
  }
  if (object.shape == ExportShape::line) {
    prim.constant += "uniform token type = \"linear\"\nuniform token wrap = \"nonperiodic\"\n";
    if (object.constant)
      prim.constant += fmt::format("int[] curveVertexCounts = [{}]\n", object.positions.size());
  }
  if (is_instancer(object)) {
    if (object.constant) prim.constant += "int[] protoIndices = " + prototypes_of_points(object) + "\n";
  } else if (object.look.radius > 0) {
    prim.constant +=
        fmt::format("float[] widths = [{}] (\n    interpolation = \"constant\"\n)\n", 2 * object.look.radius);
  }
  return prim;
}

std::string UsdaRun::topology_of(const ExportObject& object) {
  const TriangleMesh& mesh = *object.mesh;
  return "int[] faceVertexCounts = " + integers(face_sizes(mesh)) +
         "\nint[] faceVertexIndices = " + integers(face_corners(mesh)) + "\n" + uvs_text(mesh) +
         subsets_of(object);
}

std::string UsdaRun::subsets_of(const ExportObject& object) {
  const TriangleMesh& mesh = *object.mesh;
  std::string text, types;
  PrimNames names;
  std::map<std::uint32_t, std::vector<std::uint32_t>> faces;
  for (std::size_t face = 0; face < mesh.appearance.face_materials.size(); ++face)
    faces[mesh.appearance.face_materials[face]].push_back(static_cast<std::uint32_t>(face));
  faces.erase(FaceAppearance::no_material);
  for (const auto& [material, of_material] : faces) {
    const std::string& name = mesh.appearance.materials[material];
    text += subset("def GeomSubset " + string_text(names.add(name)) + binding_schema, "materialBind",
                   of_material, bind(object, name, object.material_looks[material]));
  }
  if (!faces.empty()) types += "uniform token subsetFamily:materialBind:familyType = \"nonOverlapping\"\n";
  for (const auto& [name, vertices] : mesh.groups) {
    const std::vector<std::uint32_t> inside = faces_of_group(mesh, vertices);
    if (inside.empty()) continue;
    text += subset("def GeomSubset " + string_text(names.add(name)), "group", inside, "");
  }
  if (!mesh.groups.empty()) types += "uniform token subsetFamily:group:familyType = \"unrestricted\"\n";
  return types + text;
}

/// The spheres that a PointInstancer places; of foam one per kind.
std::string UsdaRun::spheres_of(const ExportObject& object, const std::string& prim) const {
  const bool foam = object.shape == ExportShape::foam;
  const std::vector<std::string> names =
      foam ? std::vector<std::string>{"Spray", "Foam", "Bubble"} : std::vector<std::string>{"Grain"};
  const float radius = radius_of(object);
  std::string text, paths;
  for (const std::string& name : names) {
    text += block("def Sphere " + string_text(name),
                  fmt::format("double radius = {}\nfloat3[] extent = {}\n"
                              "color3f[] primvars:displayColor = [{}]\n",
                              radius, extent({}, radius), color_text(object.look.color)));
    paths += fmt::format("{}</{}/{}/{}>", paths.empty() ? "" : ", ", root_, prim, name);
  }
  return "rel prototypes = [" + paths + "]\n" + text;
}

/// The line that binds a material, which it defines when it is new.
std::string UsdaRun::bind(const ExportObject& object, const std::string& name, const ExportLook& look) {
  std::string& prim = material_prims_[{object.name, name}];
  const bool is_new = prim.empty();
  if (is_new) prim = material_names_.add(PrimNames().add(object.name) + "_" + PrimNames().add(name));
  const std::string path = fmt::format("</{}/{}/{}", root_, materials_name, prim);
  if (is_new) {
    const std::string shader =
        block("def Shader \"Shader\"",
              fmt::format("uniform token info:id = \"UsdPreviewSurface\"\n"
                          "color3f inputs:diffuseColor = {}\nfloat inputs:opacity = {:.6g}\n"
                          "float inputs:roughness = {:.6g}\ntoken outputs:surface\n",
                          color_text(look.color), look.opacity, look.roughness));
    materials_.push_back(
        {prim,
         block(fmt::format("def Material \"{}\"", prim),
               fmt::format("token outputs:surface.connect = {}/Shader.outputs:surface>\n{}", path, shader))});
  }
  return "rel material:binding = " + path + ">\n";
}

std::vector<UsdaRun::Value> UsdaRun::values_of(const ExportObject& object) const {
  std::vector<Value> values;
  const bool surface = object.shape == ExportShape::surface;
  values.push_back(
      {is_instancer(object) ? "point3f[] positions" : "point3f[] points", exact(object.positions)});
  if (!surface || object.constant || object.velocities.size() == object.positions.size())
    values.push_back({"vector3f[] velocities", velocities_text(object)});
  values.push_back({"float3[] extent", extent(object.positions, radius_of(object))});
  if (surface && object.smooth) values.push_back({"normal3f[] normals", rounded(object.normals, 4)});
  if (object.constant) return values;
  if (surface) {
    const bool absent = object.positions.empty();
    values.push_back({"int[] faceVertexCounts", absent ? "[]" : integers(face_sizes(*object.mesh))});
    values.push_back({"int[] faceVertexIndices", absent ? "[]" : integers(face_corners(*object.mesh))});
  } else if (is_instancer(object)) {
    values.push_back({"int[] protoIndices", prototypes_of_points(object)});
  } else if (object.shape == ExportShape::line) {
    values.push_back({"int[] curveVertexCounts",
                      object.positions.empty() ? "[]" : fmt::format("[{}]", object.positions.size())});
  }
  return values;
}

// A value that stays is written where it begins and where it ends, because readers interpolate between samples.
void UsdaRun::add(std::uint64_t frame, std::span<const ExportObject> objects) {
  const auto put = [](Attribute& attribute) {
    if (std::exchange(attribute.written, true)) return;
    fmt::format_to(std::back_inserter(attribute.samples), "    {}: {},\n", attribute.last_frame,
                   attribute.last);
  };
  for (std::size_t i = 0; i < objects.size(); ++i) {
    std::vector<Value> values = values_of(objects[i]);
    for (std::size_t k = 0; k < values.size(); ++k) {
      Attribute& attribute = prims_[i].attributes[k];
      const bool first = attribute.last_frame == 0, stays = attribute.last == values[k].text;
      if (!first && !stays) {
        put(attribute);
        attribute.changes = true;
      }
      attribute.last_frame = frame;
      attribute.written = false;
      if (first || !stays) {
        attribute.last = std::move(values[k].text);
        put(attribute);
      }
    }
  }
}

std::string UsdaRun::head() const {
  return fmt::format(
      "#usda 1.0\n(\n    defaultPrim = \"{}\"\n    doc = \"Written by Souple {}\"\n    endTimeCode = {}\n"
      "    framesPerSecond = {}\n    metersPerUnit = 1\n    startTimeCode = 1\n    timeCodesPerSecond = {}\n"
      "    upAxis = \"Y\"\n)\n\n",
      root_, version, options_.frames, options_.frame_rate, options_.frame_rate);
}

std::string UsdaRun::clip(std::uint64_t frame, std::span<const ExportObject> objects) {
  std::string body;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    std::string lines;
    for (const Value& value : values_of(objects[i]))
      lines += fmt::format("{}.timeSamples = {{\n    {}: {},\n}}\n", value.declaration, frame, value.text);
    body += block(fmt::format("over \"{}\"", prims_[i].name), lines);
  }
  return head() + block(fmt::format("over \"{}\"", root_), body);
}

std::string UsdaRun::clip_manifest() const {
  std::string body;
  for (const Prim& prim : prims_) {
    std::string lines;
    for (const Attribute& attribute : prim.attributes) lines += attribute.declaration + "\n";
    body += block(fmt::format("over \"{}\"", prim.name), lines);
  }
  return head() + block(fmt::format("over \"{}\"", root_), body);
}

std::string UsdaRun::clips_text(std::span<const std::string> clips) const {
  std::string active, paths;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const char* const between = i == 0 ? "" : ", ";
    active += fmt::format("{}({}, {})", between, i + 1, i);
    paths += between + asset(clips[i]);
  }
  return fmt::format(
      "    clips = {{\n        dictionary default = {{\n            double2[] active = [{}]\n"
      "            asset[] assetPaths = [{}]\n            asset manifestAssetPath = {}\n"
      "            string primPath = \"/{}\"\n            double2[] times = [(1, 1), ({}, {})]\n"
      "        }}\n    }}\n",
      active, paths, asset(manifest_name(options_.run)), root_, clips.size(), clips.size());
}

std::string UsdaRun::stage(std::span<const std::string> clips) const {
  std::string body;
  for (const Prim& prim : prims_) {
    std::string lines = prim.constant;
    for (const Attribute& attribute : prim.attributes) {
      if (options_.clips) continue;
      if (!attribute.changes) {
        lines += attribute.declaration + " = " + attribute.last + "\n";
        continue;
      }
      lines += attribute.declaration + ".timeSamples = {\n" + attribute.samples;
      if (!attribute.written) lines += fmt::format("    {}: {},\n", attribute.last_frame, attribute.last);
      lines += "}\n";
    }
    body += block(fmt::format("def {} \"{}\"{}", prim.type, prim.name, prim.metadata), lines);
  }
  std::string materials;
  for (const MaterialPrim& material : materials_) materials += material.text;
  body += block(fmt::format("def Scope \"{}\"", materials_name), materials);
  return head() + block(fmt::format("def Xform \"{}\" (\n    kind = \"component\"\n{})", root_,
                                    options_.clips ? clips_text(clips) : ""),
                        body);
}

std::uint64_t UsdaRun::frame_size(std::span<const ExportObject> objects) const {
  std::uint64_t size = 0;
  for (const ExportObject& object : objects)
    for (const Value& value : values_of(object)) size += value.text.size() + 16;
  return size;
}

}  // namespace souple
