// The contacts of one pose, computed again from the two files, for a picture.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "forcelayer/parameters.h"
#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/guard/pose_guard.h"

namespace forcelayer::viewer {

// One shell point that lies in value 1, 2 or 3.
struct ViewPoint {
  glm::dvec3 position_m;  // world
  glm::dvec3 normal;      // inward, world axes
  VoxelValue value;
  double depth_m = 0;       // > 0: a contact
  glm::dvec3 direction{0};  // of its force on the part, unit, world axes; zero without a contact
};

// The most telling thing about a frame, in ascending order of weight.
enum class FrameKind { kFree, kProximity, kForceLayer, kContact, kGuardCut, kPenetration };

// Its name in the legend.
const char* frame_kind_name(FrameKind kind);

struct ContactView {
  std::vector<ViewPoint> points;
  std::uint32_t proximity = 0, surface = 0, interior = 0, contacts = 0;
  double deepest_m = 0;

  // The clearance that is proven of this pose, as voxrun proves it; none where nothing is known.
  std::optional<double> clearance_m;
  bool at_least = false;          // nothing was near enough to be measured
  std::string nearest_object;     // to which it is, by name; empty where none is known
  glm::dvec3 nearest_m{0};        // the shell point that is nearest, world
  glm::dvec3 nearest_scene_m{0};  // the scene's place nearest to it, by the stored distances

  // The objects of the seat, by name, where the part is in it.
  std::vector<std::string> seated_on;

  FrameKind kind() const;  // never kGuardCut: that is known to the run alone
};

// Computes ContactViews for one map and one shell, both of which must outlive it: the contacts that
// the loop's `model` would feel.
class ContactViewSource {
 public:
  ContactViewSource(const Voxmap& voxmap, const Pshell& shell, Model model,
                    std::unique_ptr<field::ForceField> field);

  // Finds the seat of a run whose part starts at `world_from_part`, as Simulation::begin() does
  // without a seat of its own. There is none where the part touches nothing there.
  void find_seat(const Pose& world_from_part);

  // The contacts at a pose, the seat open where one was found; its clearance as without a seat.
  ContactView at(const Pose& world_from_part);

  // The contacts at a pose of a run that counted `counted` there: with the seat open where that is
  // nearer to the counts. Rows do not tell whether the seat was open.
  ContactView as_counted(const Pose& world_from_part, const ContactView& counted);

 private:
  ContactView look_up(const Pose& world_from_part, bool seat_open);
  void prove_clearance(const Pose& pose, ContactView& view) const;

  const Voxmap& voxmap_;
  const Pshell& shell_;
  Model model_;
  query::ContactQuery query_;
  std::unique_ptr<field::ForceField> field_;
  query::CollectedPoints points_;
  field::FieldSamples samples_;
  guard::PoseGuard probe_;
  field::ContactSet contacts_;
};

// The part's centroid frame in the world (PshellHeader::center_m is its place in the part's).
Pose world_from_center(const Pose& world_from_part, const Pshell& shell);

}  // namespace forcelayer::viewer
