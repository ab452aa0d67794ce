// The three-dimensional things of a picture: scene, layers, part, contacts.
#pragma once

#include <vtkActor.h>
#include <vtkPlane.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "workbench/viewer/plan/arrows.h"
#include "workbench/viewer/plan/camera.h"
#include "workbench/viewer/plan/items.h"
#include "workbench/viewer/plan/picture_plan.h"
#include "workbench/viewer/plan/view_scene.h"
#include "workbench/viewer/run/contact_view.h"
#include "workbench/viewer/run/moment.h"
#include "workbench/viewer/surface/cut.h"
#include "workbench/viewer/surface/layer_change.h"
#include "workbench/viewer/surface/shown_voxels.h"

namespace forcelayer::viewer {

// Fills two renderers that share a camera: `world`, and above it `marks`, which is never hidden
// behind the world (contact points and forces). `scene` must outlive the stage.
class Stage {
 public:
  // The plan's change is drawn in place of the layers where there is one.
  Stage(const ViewScene& scene, const PicturePlan& plan, vtkRenderer* world, vtkRenderer* marks);
  ~Stage();

  std::uint64_t voxel_rectangles() const { return voxel_rectangles_; }  // of all layers
  void show(const ItemSet& shown);
  // Builds the coarse layers of draw_quickly(), where the layers have too many faces to turn
  // smoothly.
  void build_quick_layers();
  // Layers in cells of several voxels, until told otherwise: for frames that must not take long.
  void draw_quickly(bool quickly);
  // Hides these objects, and no others: their meshes, and the voxels that are nearest to them. Deep
  // in solids no object is known: while any is hidden, those voxels are, too.
  void hide(const std::vector<std::string>& objects);
  const std::vector<char>& hidden_meshes() const { return hidden_meshes_; }  // [meshes]
  const HiddenObjects& hidden_objects() const { return hidden_objects_; }
  void aim(const CameraView& camera);
  void cut(const std::optional<Cut>& cut);
  void make_plain();  // flat opaque colors without light or edges: a pixel's color names its item
  void place_part(const Pose& world_from_part);
  // Draws the part at the coupling's target as an outline, with a spring from there to the part;
  // nothing where no hand holds it.
  void place_target(const Pose& world_from_part, const std::optional<Pose>& world_from_target);
  // Points, and those forces that `arrows` names.
  void place_contacts(const ContactView& contacts, const Arrows& arrows, double dot_m);
  // The force on the hand as one arrow of `length_m` at the part's centroid; zero hides it.
  void place_net_force(const glm::dvec3& at_m, const glm::dvec3& direction, double length_m);
  // The line of a clearance: its two places in the world; none hides it.
  void place_clearance(const std::vector<glm::dvec3>& places_m);
  // Up to two places in the world, with a line between two of them.
  void place_measurement(const std::vector<glm::dvec3>& places_m);

 private:
  struct Actors;
  void build_scene(const PicturePlan& plan);
  void draw_meshes();
  void draw_sections();
  vtkSmartPointer<vtkPlane> cut_plane(double inwards_m) const;
  void build_layers();
  void build_change(const std::optional<LayerChange>& change);
  void build_part();
  vtkSmartPointer<vtkActor> add_missing_faces(std::span<const ViewMesh> cubes);
  QuadSurface cut_sheet(const Cut& cut, VoxelValue value) const;
  void face_camera();
  void show_layers();

  const ViewScene& scene_;
  vtkRenderer* world_;
  vtkRenderer* marks_;
  std::unique_ptr<Actors> actors_;
  double scale_;  // of the width of lines
  std::uint64_t voxel_rectangles_ = 0;
  std::uint64_t max_rectangles_ = 0;  // of one layer
  std::vector<char> hidden_meshes_;   // [meshes of the scene]
  std::vector<char> measured_;        // [meshes of the scene] drawn for themselves
  bool colors_objects_ = false;
  HiddenObjects hidden_objects_;  // [objects of the voxmap + 1]; empty: none
  std::optional<Cut> cut_;
  ItemSet shown_;
  bool has_quick_ = false, quickly_ = false;
  unsigned long observer_ = 0;  // of the start of a rendering
};

// Places all that a moment shows.
void place_moment(Stage& stage, const ViewScene& scene, const Moment& moment);

}  // namespace forcelayer::viewer
