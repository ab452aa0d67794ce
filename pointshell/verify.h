// Proving a shell's covering radius again from the files alone.
#pragma once

#include "formats/pshell.h"
#include "pointshell/certificate/certificate.h"
#include "pointshell/part/part.h"

namespace forcelayer::pointshell {

// Proves that the points of `shell`, as the file stores them, cover `part` (in its own frame)
// within the radius of the file's header. Surface that lies inside another closed body of the part
// need not be covered.
certificate::CoveringProof verify_shell(const Pshell& shell, const part::Part& part);

}  // namespace forcelayer::pointshell
