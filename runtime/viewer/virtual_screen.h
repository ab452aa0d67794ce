// Pictures where there is no screen.
#pragma once

#include "formats/result.h"

namespace forcelayer {

// Returns when there is a display to draw on (DISPLAY is set). Otherwise starts this program anew
// with the same arguments under xvfb-run, and returns only if that cannot be had: kDeviceNotFound
// with what to install.
Status ensure_screen(char** argv);

}  // namespace forcelayer
