// The three-dimensional things of a picture: scene, layers, part, contacts.
#pragma once

#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <array>
#include <memory>

#include "runtime/viewer/camera.h"
#include "runtime/viewer/contact_view.h"
#include "runtime/viewer/view_scene.h"

namespace forcelayer {

// What can be switched on and off.
enum class Shown : unsigned {
  kMeshes,
  kInterior,
  kForceLayer,
  kProximity,
  kPart,
  kShell,
  kContacts,
  kHandle,
  kCount
};
using ShownSet = std::array<bool, static_cast<unsigned>(Shown::kCount)>;

// What is shown unless the user says otherwise: voxels' interior only where there is no mesh of the
// scene, shell points only where there is no mesh of the part; never proximity.
ShownSet default_shown(const ViewScene& scene);

// Fills two renderers that share a camera: `world`, and above it `marks`, which is never hidden
// behind the world (contact points and forces). `scene` must outlive the stage.
class Stage {
 public:
  Stage(const ViewScene& scene, vtkRenderer* world, vtkRenderer* marks);
  ~Stage();

  void show(const ShownSet& shown);
  void aim(const CameraView& camera);
  void make_plain();  // flat opaque colours without light: every pixel tells what it shows
  void place_part(const Pose& world_from_part);
  // Where the part would be without contact, as an outline, with a spring to where it is.
  void place_target(const Pose& world_from_part, const Pose& world_from_target);
  // Points and forces; the longest arrow, at the greatest depth, is `arrow_m` long.
  void place_contacts(const ContactView& contacts, double arrow_m);
  // The force on the hand as one arrow of `length_m` at the part's centroid; zero hides it.
  void place_net_force(const glm::dvec3& at_m, const glm::dvec3& direction, double length_m);

 private:
  struct Actors;
  const ViewScene& scene_;
  vtkRenderer* world_;
  vtkRenderer* marks_;
  std::unique_ptr<Actors> actors_;
};

}  // namespace forcelayer
