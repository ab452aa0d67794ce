#include "runtime/viewer/vtk_stage.h"

#include <vtkActor.h>
#include <vtkActorCollection.h>
#include <vtkArrowSource.h>
#include <vtkCamera.h>
#include <vtkCubeSource.h>
#include <vtkGlyph3D.h>
#include <vtkLightKit.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkPlatonicSolidSource.h>
#include <vtkPolyDataAlgorithm.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkSphereSource.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "runtime/viewer/layer_surface.h"
#include "runtime/viewer/style.h"
#include "runtime/viewer/vtk_geometry.h"

namespace forcelayer {
namespace {

using Actor = vtkSmartPointer<vtkActor>;

Actor actor_of(const PolyData& data, const Colour& colour) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  mapper->ScalarVisibilityOff();
  auto actor = Actor::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
  actor->GetProperty()->SetInterpolationToFlat();
  return actor;
}

void replace_data(const Actor& actor, const PolyData& data) {
  vtkPolyDataMapper::SafeDownCast(actor->GetMapper())->SetInputData(data);
}

Actor surface_actor(const PolyData& data, const Colour& colour, double opacity = 1) {
  Actor actor = actor_of(data, colour);
  actor->GetProperty()->SetOpacity(opacity);
  actor->GetProperty()->SetAmbient(0.35);
  actor->GetProperty()->SetDiffuse(0.75);
  return actor;
}

Actor line_actor(const PolyData& data, const Colour& colour, double width) {
  Actor actor = actor_of(data, colour);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetLineWidth(static_cast<float>(width));
  return actor;
}

// A shape set at every point of the data that replace_glyphs() gives.
struct Glyphs {
  vtkSmartPointer<vtkGlyph3D> glyph = vtkSmartPointer<vtkGlyph3D>::New();
  Actor actor;

  Glyphs(vtkPolyDataAlgorithm* shape, const Colour& colour, bool by_vector) {
    glyph->SetSourceConnection(shape->GetOutputPort());
    glyph->SetVectorModeToUseVector();
    glyph->SetOrient(by_vector);
    if (by_vector) {
      glyph->SetScaleModeToScaleByVector();
    } else {
      glyph->SetScaleModeToDataScalingOff();
    }
    glyph->SetInputData(PolyData::New());
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(glyph->GetOutputPort());
    mapper->ScalarVisibilityOff();
    actor = Actor::New();
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
    actor->GetProperty()->SetAmbient(0.35);
  }

  void set(const std::vector<glm::dvec3>& places_m, const std::vector<glm::dvec3>& vectors,
           const glm::dvec3& origin_m, double size_m) {
    glyph->SetInputData(vectors_at(places_m, vectors, origin_m));
    glyph->SetScaleFactor(size_m);
  }
};

vtkSmartPointer<vtkSphereSource> sphere() {
  auto source = vtkSmartPointer<vtkSphereSource>::New();
  source->SetRadius(0.5);
  source->SetThetaResolution(12);
  source->SetPhiResolution(9);
  return source;
}

vtkSmartPointer<vtkArrowSource> arrow(double slenderness) {
  auto source = vtkSmartPointer<vtkArrowSource>::New();
  source->SetTipLength(2.7 / slenderness);
  source->SetTipRadius(0.8 / slenderness);
  source->SetShaftRadius(0.25 / slenderness);
  source->SetTipResolution(16);
  source->SetShaftResolution(12);
  return source;
}

vtkSmartPointer<vtkPlatonicSolidSource> octahedron() {
  auto source = vtkSmartPointer<vtkPlatonicSolidSource>::New();
  source->SetSolidTypeToOctahedron();
  return source;
}

vtkSmartPointer<vtkMatrix4x4> matrix_of(const Pose& a_from_b, const glm::dvec3& origin_m) {
  auto matrix = vtkSmartPointer<vtkMatrix4x4>::New();
  const glm::dmat3 rotation = glm::mat3_cast(a_from_b.orientation);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      matrix->SetElement(row, column, rotation[column][row]);
    }
    matrix->SetElement(row, 3, a_from_b.position_m[row] - origin_m[row]);
  }
  return matrix;
}

}  // namespace

struct Stage::Actors {
  std::vector<Actor> meshes, mesh_edges;
  Actor interior, force_layer, proximity, added, removed;
  Actor part, part_edges, target, shell, spring;
  // Of a cut: the voxels that it opens, by value.
  Actor cut_interior = surface_actor(PolyData::New(), kInteriorColour);
  Actor cut_force_layer = surface_actor(PolyData::New(), kForceLayerColour);
  Actor cut_proximity = surface_actor(PolyData::New(), kProximityColour);
  Glyphs contact_points{sphere(), kContactColour, false};
  Glyphs contact_forces{arrow(9), kContactColour, true};
  Glyphs layer_points{sphere(), kForceLayerColour, false};
  Glyphs proximity_points{vtkSmartPointer<vtkCubeSource>::New(), kProximityColour, false};
  Glyphs interior_points{octahedron(), kPenetrationColour, false};
  Glyphs net_force{arrow(20), kNetForceColour, true};

  std::array<Glyphs*, 6> glyphs() {
    return {&contact_points,   &contact_forces,  &layer_points,
            &proximity_points, &interior_points, &net_force};
  }
  std::array<Actor*, 3> cuts() { return {&cut_interior, &cut_force_layer, &cut_proximity}; }
};

Stage::Stage(const ViewScene& scene, const std::optional<LayerChange>& change, vtkRenderer* world,
             vtkRenderer* marks)
    : scene_(scene), world_(world), marks_(marks), actors_(std::make_unique<Actors>()) {
  build_scene();
  build_layers(change);
  build_part();
  for (Glyphs* glyphs : actors_->glyphs()) marks_->AddActor(glyphs->actor);
  for (Actor* actor : actors_->cuts()) world_->AddActor(*actor);
  vtkNew<vtkLightKit> lights;
  lights->AddLightsToRenderer(world_);
  marks_->SetActiveCamera(world_->GetActiveCamera());
}

void Stage::build_scene() {
  for (const ViewMesh& mesh : scene_.meshes) {
    const PolyData data = poly_data_of(mesh);
    actors_->meshes.push_back(surface_actor(data, kSceneColour));
    actors_->mesh_edges.push_back(line_actor(feature_edges_of(data), kEdgeColour, 1.5));
    world_->AddActor(actors_->meshes.back());
    world_->AddActor(actors_->mesh_edges.back());
  }
}

void Stage::build_layers(const std::optional<LayerChange>& change) {
  if (!scene_.voxmap) return;
  const auto layer = [&](VoxelValue value, const Colour& colour, double opacity) {
    const PolyData data = poly_data_of(layer_surface(*scene_.voxmap, value, scene_.origin_m));
    Actor actor = surface_actor(data, colour, opacity);
    world_->AddActor(actor);
    return actor;
  };
  Actors& a = *actors_;
  a.interior = layer(VoxelValue::kInterior, kInteriorColour, 1);
  a.force_layer = layer(VoxelValue::kSurface, kForceLayerColour,
                        change ? kUnchangedOpacity : kForceLayerOpacity);
  a.proximity = layer(VoxelValue::kProximity, kProximityColour, kProximityOpacity);
  for (const Actor& actor : {a.force_layer, a.proximity}) {
    actor->GetProperty()->BackfaceCullingOn();  // seen from outside, one sheet is enough
  }
  if (!change) return;
  a.added = surface_actor(poly_data_of(change->added_surface), kAddedColour);
  a.removed = surface_actor(poly_data_of(change->removed_surface), kRemovedColour);
  // What is gone is drawn with its edges, so that the two differ in more than hue.
  a.removed->GetProperty()->EdgeVisibilityOn();
  a.removed->GetProperty()->SetEdgeColor(kInk[0], kInk[1], kInk[2]);
  world_->AddActor(a.added);
  world_->AddActor(a.removed);
}

void Stage::build_part() {
  Actors& a = *actors_;
  if (scene_.part) {
    const PolyData data = poly_data_of(*scene_.part);
    const PolyData edges = feature_edges_of(data);
    a.part = surface_actor(data, kPartColour);
    a.part_edges = line_actor(edges, kInk, 1.5);
    a.target = line_actor(edges, kGhostColour, 2);
  }
  if (scene_.shell) {
    a.shell = surface_actor(discs_of(*scene_.shell), kPartColour);
    a.shell->GetProperty()->SetPointSize(4);
  }
  a.spring = line_actor(PolyData::New(), kGhostColour, 3);
  for (const Actor& actor : {a.part, a.part_edges, a.target, a.shell, a.spring}) {
    if (actor != nullptr) world_->AddActor(actor);
  }
}

Stage::~Stage() = default;

void Stage::show(const ShownSet& shown) {
  Actors& a = *actors_;
  const auto set = [&](const Actor& actor, Shown what) {
    if (actor != nullptr) actor->SetVisibility(shown[what]);
  };
  for (const Actor& actor : a.meshes) set(actor, Shown::kMeshes);
  for (const Actor& actor : a.mesh_edges) set(actor, Shown::kMeshes);
  for (const Actor& actor : {a.part, a.part_edges}) set(actor, Shown::kPart);
  for (const Actor& actor : {a.target, a.spring}) set(actor, Shown::kHandle);
  for (const Actor& actor : {a.interior, a.cut_interior}) set(actor, Shown::kInterior);
  for (const Actor& actor : {a.force_layer, a.cut_force_layer}) set(actor, Shown::kForceLayer);
  for (const Actor& actor : {a.proximity, a.cut_proximity}) set(actor, Shown::kProximity);
  set(a.shell, Shown::kShell);
  for (const Glyphs* glyphs : a.glyphs()) set(glyphs->actor, Shown::kContacts);
}

void Stage::cut(const std::optional<Cut>& cut) {
  Actors& a = *actors_;
  std::vector<Actor> bodies = {a.interior, a.force_layer, a.proximity, a.added, a.removed};
  bodies.insert(bodies.end(), a.meshes.begin(), a.meshes.end());
  bodies.insert(bodies.end(), a.mesh_edges.begin(), a.mesh_edges.end());
  vtkNew<vtkPlane> plane;
  if (cut) {
    double normal[3] = {0, 0, 0}, origin[3] = {0, 0, 0};
    normal[cut->axis] = cut->keep_low ? -1 : 1;
    origin[cut->axis] = cut->at_m - scene_.origin_m[cut->axis];
    plane->SetNormal(normal);
    plane->SetOrigin(origin);
  }
  for (const Actor& actor : bodies) {
    if (actor == nullptr) continue;
    actor->GetMapper()->RemoveAllClippingPlanes();
    if (cut) actor->GetMapper()->AddClippingPlane(plane);
  }
  const std::array<VoxelValue, 3> values = {VoxelValue::kInterior, VoxelValue::kSurface,
                                            VoxelValue::kProximity};
  for (std::size_t n = 0; n < values.size(); ++n) {
    const bool open = cut && scene_.voxmap;
    replace_data(*a.cuts()[n], open ? cut_sheet(*cut, values[n]) : PolyData::New());
  }
}

PolyData Stage::cut_sheet(const Cut& cut, VoxelValue value) const {
  // The voxels just on the side that stays.
  const double place = cut.at_m / scene_.voxmap->voxel_size_m();
  const auto index =
      static_cast<std::int64_t>(cut.keep_low ? std::ceil(place) - 1 : std::floor(place));
  return poly_data_of(slice_surface(*scene_.voxmap, value, cut.axis, index, cut.keep_low ? 1 : -1,
                                    scene_.origin_m));
}

void Stage::aim(const CameraView& view) {
  vtkCamera* camera = world_->GetActiveCamera();
  const glm::dvec3 target = view.target_m - scene_.origin_m;
  const double distance_m =
      10 * view.half_height_m + glm::length(scene_.bounds.high_m - scene_.bounds.low_m);
  const glm::dvec3 eye = target + distance_m * view.to_eye;
  camera->SetParallelProjection(1);
  camera->SetFocalPoint(target.x, target.y, target.z);
  camera->SetPosition(eye.x, eye.y, eye.z);
  camera->SetViewUp(view.up.x, view.up.y, view.up.z);
  camera->SetParallelScale(view.half_height_m);
  world_->ResetCameraClippingRange();
}

void Stage::make_plain() {
  Actors& a = *actors_;
  vtkActorCollection* all = world_->GetActors();
  all->InitTraversal();
  while (vtkActor* actor = all->GetNextActor()) {
    actor->GetProperty()->LightingOff();
    actor->GetProperty()->SetAmbient(0);
    actor->GetProperty()->SetDiffuse(1);
    actor->GetProperty()->EdgeVisibilityOff();
    actor->GetProperty()->SetOpacity(1);
  }
  for (const Actor& actor : a.mesh_edges) actor->SetVisibility(0);
  if (a.part_edges != nullptr) a.part_edges->SetVisibility(0);
}

void Stage::place_part(const Pose& world_from_part) {
  const auto matrix = matrix_of(world_from_part, scene_.origin_m);
  for (const Actor& actor : {actors_->part, actors_->part_edges, actors_->shell}) {
    if (actor != nullptr) actor->SetUserMatrix(matrix);
  }
}

void Stage::place_target(const Pose& world_from_part, const Pose& world_from_target) {
  const auto matrix = matrix_of(world_from_target, scene_.origin_m);
  if (actors_->target != nullptr) actors_->target->SetUserMatrix(matrix);
  if (!scene_.shell) return;
  const double width_m = 0.25 * scene_.shell->header().bounding_radius_m;
  replace_data(actors_->spring,
               spring_between(world_from_center(world_from_part, *scene_.shell).position_m,
                              world_from_center(world_from_target, *scene_.shell).position_m,
                              width_m, scene_.origin_m));
}

void Stage::place_contacts(const ContactView& contacts, double arrow_m) {
  struct Places {
    std::vector<glm::dvec3> at, vector;
  } contact, layer, proximity, interior;
  for (const ViewPoint& point : contacts.points) {
    Places* kind = &proximity;
    if (point.value == VoxelValue::kInterior) kind = &interior;
    if (point.value == VoxelValue::kSurface) kind = point.depth_m > 0 ? &contact : &layer;
    kind->at.push_back(point.position_m);
    kind->vector.push_back(point.depth_m * point.direction);
  }
  const double dot_m = 0.06 * arrow_m, per_depth = arrow_m / std::max(contacts.deepest_m, 1e-12);
  Actors& a = *actors_;
  a.contact_points.set(contact.at, contact.vector, scene_.origin_m, dot_m);
  a.contact_forces.set(contact.at, contact.vector, scene_.origin_m, per_depth);
  a.layer_points.set(layer.at, layer.vector, scene_.origin_m, 0.7 * dot_m);
  a.proximity_points.set(proximity.at, proximity.vector, scene_.origin_m, 0.6 * dot_m);
  a.interior_points.set(interior.at, interior.vector, scene_.origin_m, 1.2 * dot_m);
}

void Stage::place_net_force(const glm::dvec3& at_m, const glm::dvec3& direction, double length_m) {
  if (length_m > 0) {
    actors_->net_force.set({at_m}, {glm::normalize(direction)}, scene_.origin_m, length_m);
  } else {
    actors_->net_force.set({}, {}, scene_.origin_m, 0);
  }
}

void place_moment(Stage& stage, const ViewScene& scene, const Moment& moment) {
  stage.place_part(moment.world_from_part);
  if (moment.world_from_target) {
    stage.place_target(moment.world_from_part, *moment.world_from_target);
  }
  if (!scene.shell) return;
  const double radius_m = scene.shell->header().bounding_radius_m;
  stage.place_contacts(moment.contacts, 0.5 * radius_m);
  if (moment.on_hand && glm::length(moment.on_hand->force_n) > 0) {
    stage.place_net_force(world_from_center(moment.world_from_part, *scene.shell).position_m,
                          moment.on_hand->force_n, 1.2 * radius_m);
  }
}

}  // namespace forcelayer
