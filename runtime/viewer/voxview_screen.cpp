#include "runtime/viewer/voxview_screen.h"

#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

// Last, for its macros.
#include <X11/Xlib.h>
#undef Status

namespace forcelayer {

bool display_is_set() {
  const char* display = std::getenv("DISPLAY");
  return display != nullptr && *display != '\0';
}

Status ensure_screen(char** argv) {
  if (display_is_set()) {
    // VTK aborts the program where this fails.
    if (Display* display = XOpenDisplay(nullptr); display != nullptr) {
      XCloseDisplay(display);
      return {};
    }
    return Error{ErrorCode::kDeviceNotFound, "", "",
                 "the display '" + std::string(std::getenv("DISPLAY")) + "' does not open",
                 "set DISPLAY to one that does, or unset it and give --screenshot FILE"};
  }
  std::string self = "/proc/self/exe", screen = "-screen 0 1280x1024x24";
  if (char* path = realpath("/proc/self/exe", nullptr); path != nullptr) {
    self = path;
    std::free(path);
  }
  std::vector<std::string> words = {"xvfb-run", "-a", "-s", screen, self};
  for (char** argument = argv + 1; *argument != nullptr; ++argument) words.push_back(*argument);
  std::vector<char*> command;
  for (std::string& word : words) command.push_back(word.data());
  command.push_back(nullptr);
  execvp(command[0], command.data());
  return Error{ErrorCode::kDeviceNotFound, "", "",
               "no display to draw on, and no xvfb-run to make one",
               "install the packages xvfb and xauth, or set DISPLAY"};
}

}  // namespace forcelayer
