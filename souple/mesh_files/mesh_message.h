#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/mesh_files/mesh_animation.h"

#include <string>
#include <string_view>

/// The answer of souple-mesh-reader: a mesh or an animation, or why there is none. Little-endian numbers and counted lists between a
/// first line and a last one, by which an answer that breaks off is known.
namespace souple::mesh_detail {

std::string message_of_mesh(const TriangleMesh& mesh);
std::string message_of_animation(const MeshAnimation& animation);
std::string message_of_failure(std::string_view why);

/// The mesh in a message. All numbers and indices are checked, because the writer read an untrusted file. Throws Error
/// with the reason that the message gives. For a message that breaks off or makes no sense, the error begins with
/// `name`.
TriangleMesh mesh_of_message(std::string_view message, const std::string& name);
MeshAnimation animation_of_message(std::string_view message, const std::string& name);

/// Whether the message is whole.
bool is_whole_message(std::string_view message);

}  // namespace souple::mesh_detail
