// Proving a shell's covering radius and losses again from the files alone.
#pragma once

#include "formats/pshell.h"
#include "pointshell/certificate/certificate.h"
#include "pointshell/certificate/surface_losses.h"
#include "pointshell/part/part.h"

namespace forcelayer::pointshell {

// Proves that the points of `shell`, as the file stores them, cover `part` (in its own frame)
// within the radius of the file's header. Surface that lies inside another closed body of the part
// need not be covered.
certificate::CoveringProof verify_shell(const Pshell& shell, const part::Part& part);

// Proves the convex radius and gap and the table of losses that `shell` claims. Its covering radius
// must have been proven.
certificate::LossProof verify_losses(const Pshell& shell, const part::Part& part);

}  // namespace forcelayer::pointshell
