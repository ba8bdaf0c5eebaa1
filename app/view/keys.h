#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

// The viewer's only table of keys: it defines their actions, the list on screen, the output of `souple view
// --help` and the tables of docs/viewer.md.

namespace souple::viewer {

enum class Action {
  pause,
  step_frame,
  step_substep,
  step_back,
  reset,
  next_scene,
  previous_scene,
  throw_ball,
  add_object,
  frame_all,
  wireframe,
  constraints,
  display,
  screenshot,
  film,
  hide_panel,
  quit
};

struct Key {
  std::string_view key;    ///< name of the key
  std::string_view brief;  ///< one or two words for the list on screen
  std::string_view does;   ///< description
  Action action;
  char character = 0;  ///< character that the key types, in lower case: letters follow the keyboard's layout
  bool repeats = false;  ///< whether the key repeats while it is pressed
};

/// ASCII escape: the window passes each press of the key Esc as this character. So neither a press shorter than a frame
/// nor two presses within a frame are lost.
inline constexpr char escape = 27;

inline constexpr std::array<Key, 17> keys{{
    {"Space", "pause", "pause and resume", Action::pause, ' '},
    {".", "frame", "one frame", Action::step_frame, '.', true},
    {",", "substep", "one substep; in a recording, one frame back", Action::step_substep, ',', true},
    {"B", "back", "back in time, one frame", Action::step_back, 'b', true},
    {"R", "reset", "reset: back to the start", Action::reset, 'r'},
    {"N", "next", "next scene", Action::next_scene, 'n'},
    {"P", "previous", "previous scene", Action::previous_scene, 'p'},
    {"T", "throw", "throw a ball from the camera at what is under the cursor", Action::throw_ball, 't'},
    {"A", "add", "add an object at the cursor: cloth, soft ball, stiff box, rope or grains",
     Action::add_object, 'a'},
    {"F", "frame all", "frame all", Action::frame_all, 'f'},
    {"W", "wireframe", "wireframe on and off", Action::wireframe, 'w'},
    {"C", "constraints", "next display of constraints", Action::constraints, 'c'},
    {"1-9", "display", "display mode", Action::display},
    {"S", "screenshot", "screenshot", Action::screenshot, 's'},
    {"V", "film", "film on and off", Action::film, 'v'},
    {"H", "hide", "hide or show the panels", Action::hide_panel, 'h'},
    {"Esc", "quit", "twice: quit", Action::quit, escape, true},
}};

struct Gesture {
  std::string_view gesture, gesture_brief, brief, does;
};
inline constexpr std::array<Gesture, 5> gestures{{
    {"Left drag on an object", "drag", "grab", "grab it"},
    {"Left drag on empty space", "drag beside", "orbit", "orbit"},
    {"Right drag", "right drag", "pan", "pan"},
    {"Wheel", "wheel", "zoom", "zoom"},
    {"Double click", "double click", "pin", "pin or unpin a particle"},
}};

/// Both tables as text, one entry per line.
inline std::string keys_text() {
  constexpr std::size_t column = 28;
  std::string text = "Keys:\n";
  const auto add = [&](std::string_view name, std::string_view does) {
    std::string line = "  ";
    line += name;
    line.resize(column, ' ');
    line += does;
    text += line + "\n";
  };
  for (const Key& key : keys) add(key.key, key.does);
  text += "Mouse:\n";
  for (const Gesture& gesture : gestures) add(gesture.gesture, gesture.does);
  return text;
}

}  // namespace souple::viewer
