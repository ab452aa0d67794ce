// Whether there is a screen to draw on.
#pragma once

#include <optional>

#include "formats/result.h"

namespace forcelayer::viewer {

// Returns when there is a display to draw on: DISPLAY names one that opens. Without DISPLAY, starts
// this program anew with the same arguments under xvfb-run, and returns only if that cannot be had.
// Error: kDeviceNotFound with the remedy.
Status ensure_screen(char** argv);

// Whether DISPLAY names a display, be it one that opens or not.
bool display_is_set();

struct Screen {
  // Pixels per pixel of a usual display, of 96 an inch: what the resource Xft.dpi says, to a
  // quarter; 1 where it says nothing.
  double scale = 1;
  int width = 0, height = 0;  // pixels
};

// That of DISPLAY; none where it does not open.
std::optional<Screen> screen();

}  // namespace forcelayer::viewer
