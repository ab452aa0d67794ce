// Adding points where the proof of a covering fails, until it succeeds.
#pragma once

#include <span>
#include <vector>

#include "pointshell/certificate/certificate.h"
#include "pointshell/certificate/surface_losses.h"
#include "pointshell/part/parallel.h"
#include "pointshell/part/part.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::sample {

// The deepest holes, at least `separation` (m) apart from each other, as stored positions.
std::vector<part::Vec3> deepest_holes(std::span<const certificate::Hole> holes, double separation);

// Appends points on the surface to `points` until prove_covering succeeds at `radius`; returns the
// proof. It ends, because every point added is about `radius` away from all others.
certificate::CoveringProof fill_holes(const part::Part& part, double radius,
                                      std::vector<part::Vec3>& points);

// Appends points on the surface to `points` until every place of it has a combination of points of
// little loss: sharp corners, tips and creases that the points' convex hull cuts off. Ends, because
// every point added is farther than that loss from all others. Returns the number added.
std::size_t fill_lossy_places(certificate::CoveredPart covered, std::vector<part::Vec3>& points,
                              const part::Progress& progress);

}  // namespace forcelayer::sample
