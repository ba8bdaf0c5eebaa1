// look FILE.png [width height samples [wireframe]]: draws the studio for visual inspection and prints the
// time.
#include "render/context.h"
#include "render/renderer.h"
#include "studio.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>

namespace {

using namespace souple;          // NOLINT(google-build-using-namespace)
using namespace souple::render;  // NOLINT(google-build-using-namespace)

int look(int count, char** arguments) {
  const auto number = [&](int i, int otherwise) { return count > i ? std::atoi(arguments[i]) : otherwise; };
  const int width = number(2, 1280), height = number(3, 720);
  RenderOptions options;
  options.samples = number(4, 1);
  const Studio studio(110);
  DrawList list = studio.list();
  if (number(5, 0) != 0) list.surfaces[0].wireframe = true;
  const OffscreenContext context;
  watch_gl_errors();
  std::printf("%s\n", context_description().c_str());
  Renderer renderer;
  Image image;
  for (int i = 0; i < 5; ++i) {
    list.surfaces[0].version = std::uint64_t(i);
    const auto begin = std::chrono::steady_clock::now();
    image = renderer.picture(list, Studio::camera(), options, width, height);
    const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begin;
    std::printf("%.1f ms\n", taken.count());
  }
  throw_gl_errors();
  write_png(arguments[1], image);
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) return 2;
  try {
    return look(count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
