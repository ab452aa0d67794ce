// The portions of a part, whose points are made and proven by themselves: the bodies that it holds
// several times, as an original and its copies, and all others together.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "pointshell/certificate/certificate.h"
#include "pointshell/certificate/hidden_surface.h"
#include "pointshell/certificate/surface_losses.h"
#include "pointshell/part/copies.h"
#include "pointshell/part/triangle_tree.h"

namespace forcelayer::pointshell {

struct Portion {
  const part::Part* part = nullptr;  // of the original, relative to the whole part's centroid
  const part::TriangleTree* tree = nullptr;
  double radius = 0;  // m, to cover it with: the copies then are covered within the part's
  double slack = 0;   // m, part::CopiedGroup::slack_m
  std::vector<part::Motion> copies;

  std::vector<part::Vec3> points;
  certificate::CoveringProof proof;
  std::unique_ptr<certificate::HiddenSurface> hidden;

  // Where the part has several portions.
  std::unique_ptr<part::Part> own_part;
  std::unique_ptr<part::TriangleTree> own_tree;

  std::size_t times() const { return 1 + copies.size(); }
};

// `tree`: over the whole part relative to `center`, which must outlive the portions. Without groups
// one portion, which is the part.
std::vector<Portion> portions_of(const part::TriangleTree& tree, double radius,
                                 const part::Vec3& center,
                                 std::span<const part::CopiedGroup> groups);

// The points of all originals and copies, as the file stores them.
std::vector<part::Vec3> all_points(std::span<const Portion> portions);

// Adds to what is proven of other shares what is proven of one.
void unite(certificate::SurfaceLosses& all, const certificate::SurfaceLosses& own);

}  // namespace forcelayer::pointshell
