#include "souple/mesh_files/reader/assimp_file.h"

#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/mesh_files/reader/folder_files.h"

#include <cmath>
#include <cstdint>
#include <new>
#include <optional>
#include <sstream>
#include <string>

#include <assimp/BaseImporter.h>
#include <assimp/Importer.hpp>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

namespace souple::mesh_detail {

namespace {

/// Meters per unit of an FBX, which states the centimeters of its unit.
double unit_of(const aiMetadata& stated) {
  float centimeters = 0;
  const bool states_unit = stated.Get("UnitScaleFactor", centimeters);
  return states_unit && std::isfinite(centimeters) && centimeters > 0 ? 0.01 * double(centimeters) : 1;
}

/// An axis of the file (0, 1, 2: X, Y, Z) with its sign, as a unit vector; empty if it is not stated.
std::optional<Vec3d> stated_axis(const aiMetadata& stated, const char* axis_key, const char* sign_key) {
  std::int32_t axis = -1, sign = 1;
  if (!stated.Get(axis_key, axis) || axis < 0 || axis > 2) return {};
  stated.Get(sign_key, sign);
  Vec3d unit;
  unit[axis] = sign < 0 ? -1 : 1;
  return unit;
}

/// The rotation from the axes of an FBX to ours: up to Y, and front, which faces the viewer, to Z. A file without
/// a front that is perpendicular to its up is turned as MeshImport::up does. The third axis follows from
/// these two: a left-handed file is turned, never mirrored.
Mat3d axes_of(const aiMetadata& stated) {
  const Vec3d up = stated_axis(stated, "UpAxis", "UpAxisSign").value_or(Vec3d{0, 1, 0});
  Vec3d front = stated_axis(stated, "FrontAxis", "FrontAxisSign").value_or(up);
  if (dot(front, up) != 0) front = up.z != 0 ? Vec3d{0, -up.z, 0} : Vec3d{0, 0, 1};
  return transpose(Mat3d(cross(up, front), up, front));
}

/// Leaves only the readers of this extension (".fbx"): assimp would ask all others about a file of wrong content.
void keep_readers_of(const std::string& extension, Assimp::Importer& importer) {
  const auto reads = [&](std::size_t i) {
    std::istringstream words(importer.GetImporterInfo(i)->mFileExtensions);
    for (std::string word; words >> word;) {
      if ("." + lower_case(word) == extension) return true;
    }
    return false;
  };
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    if (reads(i)) continue;
    Assimp::BaseImporter* const unwanted = importer.GetImporter(i);
    importer.UnregisterLoader(unwanted);
    delete unwanted;
  }
}

}  // namespace

void with_assimp_scene(const std::filesystem::path& path, const SceneVisitor& visit) {
  const std::string name = path.string(), extension = lower_case(path.extension().string());
  try {
    Assimp::Importer importer;
    keep_readers_of(extension, importer);
    importer.SetIOHandler(files_of_folder(path));  // which the importer deletes
    // assimp 5.4 turns to the stated axes by itself, earlier versions do not know this property.
    importer.SetPropertyBool("AI_CONFIG_IMPORT_FBX_IGNORE_UP_DIRECTION", true);
    const aiScene* scene = importer.ReadFile(name, aiProcess_ValidateDataStructure);
    if (scene == nullptr || scene->mRootNode == nullptr) {
      throw Error(name + ": assimp cannot read it (" + importer.GetErrorString() + "), expected a " +
                  extension + " file, and all that it names in its folder or below");
    }
    if (extension == ".fbx" && scene->mMetaData != nullptr)
      visit(*scene, axes_of(*scene->mMetaData), unit_of(*scene->mMetaData));
    else
      visit(*scene, Mat3d::identity(), 1);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& failure) {
    throw Error(name + ": assimp cannot read it (" + failure.what() + ")");
  }
}

}  // namespace souple::mesh_detail
