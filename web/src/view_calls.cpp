#include "souple/error.h"
#include "web/src/calls.h"
#include "web/src/page_view.h"

#include <emscripten/html5.h>
#include <filesystem>

// The functions behind View in souple.js: a world on a canvas.

namespace souple::web {

namespace {

constexpr float radians_per_pixel = 0.008f;

}  // namespace

SOUPLE_CALL PageView* souple_view(const char* canvas) {
  return guarded([&] {
    EmscriptenWebGLContextAttributes attributes;
    emscripten_webgl_init_context_attributes(&attributes);
    attributes.majorVersion = 2;
    attributes.alpha = attributes.depth = attributes.antialias = EM_FALSE;
    const EMSCRIPTEN_WEBGL_CONTEXT_HANDLE context = emscripten_webgl_create_context(canvas, &attributes);
    if (context <= 0 || emscripten_webgl_make_context_current(context) != EMSCRIPTEN_RESULT_SUCCESS)
      throw Error("this browser shows no WebGL 2: turn on hardware acceleration, or use a newer browser");
    return new PageView;
  });
}
SOUPLE_CALL void souple_view_show(PageView* view, HeldWorld* world, int width, int height) {
  guarded([&] { view->show(world, width, height); });
}
SOUPLE_CALL void souple_view_draw(PageView* view, int width, int height) {
  guarded([&] { view->draw(width, height); });
}
SOUPLE_CALL void souple_view_advance(PageView* view, double seconds) {
  guarded([&] { view->advance(seconds); });
}
SOUPLE_CALL void souple_view_display(PageView* view, int display, int constraints, int wireframe) {
  view->display().display = static_cast<render::Display>(display);
  view->display().constraints = static_cast<render::ConstraintDisplay>(constraints);
  view->display().wireframe = wireframe != 0;
}
SOUPLE_CALL void souple_view_quality(PageView* view, int shadows, int occlusion) {
  view->rendering().shadows = shadows != 0;
  view->rendering().ambient_occlusion = occlusion != 0;
}

// --- the camera
SOUPLE_CALL void souple_view_orbit(PageView* view, float dx, float dy) {
  view->camera().orbit(-dx * radians_per_pixel, dy * radians_per_pixel);
}
SOUPLE_CALL void souple_view_pan(PageView* view, float dx, float dy) {
  view->camera().pan(dx, dy, view->height());
}
SOUPLE_CALL void souple_view_zoom(PageView* view, float factor) {
  view->camera().zoom(factor);
}
SOUPLE_CALL void souple_view_frame_all(PageView* view) {
  guarded([&] { view->frame_all(); });
}

// --- the user's hand
SOUPLE_CALL int souple_view_grab(PageView* view, float x, float y) {
  return guarded([&] { return view->grab(x, y) ? 1 : 0; });
}
SOUPLE_CALL void souple_view_drag(PageView* view, float x, float y) {
  guarded([&] { view->drag(x, y); });
}
SOUPLE_CALL int souple_view_pin(PageView* view, float x, float y) {
  return guarded([&] { return view->toggle_pin(x, y) ? 1 : 0; });
}
SOUPLE_CALL void souple_view_throw(PageView* view, float x, float y) {
  guarded([&] { view->throw_ball(x, y); });
}
SOUPLE_CALL void souple_view_add(PageView* view, int addition, float x, float y) {
  guarded([&] { view->add(viewer::all_additions.at(static_cast<std::size_t>(addition)), x, y); });
}
SOUPLE_CALL void souple_view_add_mesh(PageView* view, const char* file) {
  guarded([&] { view->add(std::filesystem::path(file)); });
}

// --- the simulation that the view shows
SOUPLE_CALL void souple_play(HeldWorld* world, int playing) {
  world->simulation().set_playing(playing != 0);
}
SOUPLE_CALL int souple_playing(HeldWorld* world) {
  return world->simulation().playing() ? 1 : 0;
}
SOUPLE_CALL double souple_speed(HeldWorld* world) {
  return world->simulation().speed();
}
SOUPLE_CALL void souple_step_frame(HeldWorld* world) {
  guarded([&] { world->simulation().step_frame(); });
}
SOUPLE_CALL void souple_step_substep(HeldWorld* world) {
  guarded([&] { world->simulation().step_fine(); });
}
SOUPLE_CALL void souple_step_back(HeldWorld* world) {
  guarded([&] {
    world->release();
    world->simulation().step_back();
  });
}

}  // namespace souple::web
