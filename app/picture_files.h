#pragma once

#include "render/environment.h"
#include "render/image.h"
#include "souple/scene/scene.h"

#include <filesystem>
#include <memory>

// Pictures that a scene names. Each is read once, and again when its file has changed.

namespace souple::app {

/// A PNG that is printed on a cloth. Throws Error for a file that is none, or has a side above 4096 pixels.
std::shared_ptr<const render::Image> picture_of(const std::filesystem::path& file);

/// The sky of a scene in this folder. Throws Error as read_hdr.
std::shared_ptr<const render::Environment> sky_of(const SkyDescription& sky,
                                                  const std::filesystem::path& folder);

}  // namespace souple::app
