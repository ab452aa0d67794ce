// Proving a shell's covering radius again from the files alone.
#pragma once

#include "formats/pshell.h"
#include "pointshell/certificate/certificate.h"
#include "pointshell/part/part.h"

namespace forcelayer {

// Proves that the points of `shell`, as the file stores them, cover `part` (in its own frame)
// within the radius that the file's header gives: all of its surface but for what lies inside
// another of its closed bodies.
CoveringProof verify_shell(const Pshell& shell, const Part& part);

}  // namespace forcelayer
