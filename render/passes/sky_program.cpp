#include "render/passes/sky_program.h"

namespace souple::render {

void SkyMap::bind(const std::shared_ptr<const Environment>& environment) {
  if (environment_ != environment) {
    const Panorama& panorama = environment->panorama();
    std::vector<float> texels;
    texels.reserve(4 * panorama.radiance.size());
    for (const Vec3f& light : panorama.radiance) texels.insert(texels.end(), {light.x, light.y, light.z, 1});
    texture_ = gl::Texture::panorama(panorama.width, panorama.height, texels.data());
    environment_ = environment;
  }
  texture_.bind(gl::Unit::sky);
}

}  // namespace souple::render
