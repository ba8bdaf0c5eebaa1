#include "app/view/ui.h"

#include "render/font.h"
#include "souple/error.h"

#include <backends/imgui_impl_opengl3.h>
#include <cstdint>
#include <cstring>
#include <imgui.h>
#include <span>
#include <vector>

namespace souple::viewer {

namespace {

constexpr float font_size = 15;

std::string add_font(float scale, const std::vector<std::filesystem::path>& fonts) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  for (const std::filesystem::path& file : fonts) {
    const render::Font font(file);
    const std::span<const char> bytes = font.data();
    if (font.built_in()) continue;  // ImGui asserts on a file that is no TrueType font
    // The atlas frees this copy with its own allocator.
    void* copy = ImGui::MemAlloc(bytes.size());
    std::memcpy(copy, bytes.data(), bytes.size());
    atlas.AddFontFromMemoryTTF(copy, static_cast<int>(bytes.size()), font_size * scale);
    return file.string();
  }
  ImFontConfig config;
  config.SizePixels = 13 * scale;
  atlas.AddFontDefault(&config);
  return "built in";
}

ImVec4 color(unsigned hex, float alpha = 1) {
  const auto part = [&](unsigned shift) { return static_cast<float>((hex >> shift) & 255u) / 255; };
  return {part(16), part(8), part(0), alpha};
}

void set_colors(ImGuiStyle& style) {
  ImVec4* c = style.Colors;
  c[ImGuiCol_Text] = color(theme::text);
  c[ImGuiCol_TextDisabled] = color(theme::dim);
  c[ImGuiCol_WindowBg] = color(theme::background);
  c[ImGuiCol_PopupBg] = color(theme::raised, 0.98f);
  c[ImGuiCol_Border] = color(theme::line, 0.6f);
  c[ImGuiCol_FrameBg] = color(theme::field);
  c[ImGuiCol_FrameBgHovered] = color(0x343b48);
  c[ImGuiCol_FrameBgActive] = color(0x3a4250);
  c[ImGuiCol_ScrollbarBg] = color(theme::background, 0);
  c[ImGuiCol_ScrollbarGrab] = color(theme::line);
  c[ImGuiCol_ScrollbarGrabHovered] = color(0x454d5b);
  c[ImGuiCol_ScrollbarGrabActive] = color(0x545d6d);
  c[ImGuiCol_CheckMark] = color(theme::accent);
  c[ImGuiCol_SliderGrab] = color(theme::accent);
  c[ImGuiCol_SliderGrabActive] = color(0x73d6c8);
  c[ImGuiCol_Button] = color(theme::field);
  c[ImGuiCol_ButtonHovered] = color(0x3a4250);
  c[ImGuiCol_ButtonActive] = color(theme::accent, 0.7f);
  c[ImGuiCol_Header] = color(theme::raised);
  c[ImGuiCol_HeaderHovered] = color(0x2d3440);
  c[ImGuiCol_HeaderActive] = color(0x343b48);
  c[ImGuiCol_Separator] = color(theme::line, 0.6f);
  c[ImGuiCol_TextSelectedBg] = color(theme::accent, 0.35f);
}

void set_style(float scale) {
  ImGuiStyle& style = ImGui::GetStyle();
  ImGui::StyleColorsDark();
  style.WindowPadding = {14, 12};
  style.FramePadding = {8, 4};
  style.ItemSpacing = {8, 6};
  style.ItemInnerSpacing = {6, 4};
  style.WindowRounding = 0;
  style.PopupRounding = style.FrameRounding = style.GrabRounding = style.ScrollbarRounding = 4;
  style.WindowBorderSize = style.FrameBorderSize = 0;
  style.ScrollbarSize = 10;
  style.GrabMinSize = 8;
  set_colors(style);
  style.ScaleAllSizes(scale);
}

}  // namespace

std::vector<std::filesystem::path> Ui::default_fonts() {
  return {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans.ttf",
          "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf", "/usr/share/fonts/dejavu/DejaVuSans.ttf"};
}

Ui::Ui(float scale, const std::vector<std::filesystem::path>& fonts) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // write no settings into the working folder
  font_ = add_font(scale, fonts);
  set_style(scale);
  if (!ImGui_ImplOpenGL3_Init("#version 330")) {
    ImGui::DestroyContext();
    throw Error("the panels cannot be drawn with this OpenGL; expected OpenGL 3.3");
  }
}

Ui::~Ui() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
}

void Ui::begin() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
}

void Ui::draw() {
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

unsigned ui_color(unsigned hex, float alpha) {
  return ImGui::ColorConvertFloat4ToU32(color(hex, alpha));
}

}  // namespace souple::viewer
