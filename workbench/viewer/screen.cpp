#include "workbench/viewer/screen.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "formats/command/program.h"
#include "formats/file/temporary_files.h"

// Last, for its macros.
#include <X11/Xlib.h>
#undef Status

namespace forcelayer::viewer {
namespace {

// Runs a command, from $2 on, on a virtual screen $1. The folder for the screen's cookie is this
// script's own: xvfb-run ends with status 5 where it cannot remove its own, as happens on a busy
// machine, whatever the command did.
constexpr const char* kUnderXvfb =
    "screen=$1; shift; folder=$(mktemp -d) && touch \"$folder/cookie\" || exit 1; "
    "trap 'rm -rf \"$folder\"' EXIT; trap 'exit 130' INT; trap 'exit 143' TERM; "
    "xvfb-run -a -f \"$folder/cookie\" -s \"$screen\" \"$@\"";

// The window was killed (xkill) or its server ended. Xlib ends the program after this whatever it
// does, with words and a status of its own.
int end_without_display(Display*) {
  const Error error{ErrorCode::kDeviceFailed, "", "", "the display closed the connection",
                    "the window was killed, or its X server ended; the run itself goes on"};
  std::fprintf(stderr, "voxview: %s\n", to_line(error).c_str());
  remove_temporary_files();
  _exit(exit_status(error.code));
}

}  // namespace

bool display_is_set() {
  const char* display = std::getenv("DISPLAY");
  return display != nullptr && *display != '\0';
}

std::optional<Screen> screen() {
  Display* display = XOpenDisplay(nullptr);
  if (display == nullptr) return std::nullopt;
  const int number = DefaultScreen(display);
  Screen screen{1, DisplayWidth(display, number), DisplayHeight(display, number)};
  const char* resources = XResourceManagerString(display);
  const char* found = resources == nullptr ? nullptr : std::strstr(resources, "Xft.dpi:");
  if (found != nullptr) {
    const double wanted = std::strtod(found + std::strlen("Xft.dpi:"), nullptr) / 96;
    if (wanted > 0) screen.scale = std::clamp(std::round(4 * wanted) / 4, 1.0, 4.0);
  }
  XCloseDisplay(display);
  return screen;
}

Status ensure_screen(char** argv) {
  if (display_is_set()) {
    // VTK aborts the program where this fails.
    if (Display* display = XOpenDisplay(nullptr); display != nullptr) {
      XCloseDisplay(display);
      XSetIOErrorHandler(end_without_display);
      return {};
    }
    return Error{ErrorCode::kDeviceNotFound, "", "",
                 "the display '" + std::string(std::getenv("DISPLAY")) + "' cannot be opened",
                 "set DISPLAY to another display, or unset it and add --screenshot FILE"};
  }
  std::string self = "/proc/self/exe", screen = "-screen 0 1280x1024x24";
  if (char* path = realpath("/proc/self/exe", nullptr); path != nullptr) {
    self = path;
    std::free(path);
  }
  if (command::program_path("xvfb-run").empty()) {
    return Error{ErrorCode::kDeviceNotFound, "", "",
                 "there is no display, and xvfb-run is not installed to make one",
                 "install the packages xvfb and xauth, or set DISPLAY"};
  }
  std::vector<std::string> words = {"sh", "-c", kUnderXvfb, self, screen, self};
  for (char** argument = argv + 1; *argument != nullptr; ++argument) words.push_back(*argument);
  std::vector<char*> command;
  for (std::string& word : words) command.push_back(word.data());
  command.push_back(nullptr);
  execvp(command[0], command.data());
  return Error{ErrorCode::kInternal, "", "",
               std::string("sh cannot be started: ") + strerror(errno), ""};
}

}  // namespace forcelayer::viewer
