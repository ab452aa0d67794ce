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
#include <vtkPlatonicSolidSource.h>
#include <vtkPolyDataAlgorithm.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkSphereSource.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

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
  actor->GetProperty()->SetAmbient(0.25);
  actor->GetProperty()->SetDiffuse(0.8);
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

vtkSmartPointer<vtkArrowSource> arrow() {
  auto source = vtkSmartPointer<vtkArrowSource>::New();
  source->SetTipLength(0.3);
  source->SetTipRadius(0.09);
  source->SetShaftRadius(0.03);
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

bool is_shown(const ShownSet& shown, Shown what) { return shown[static_cast<unsigned>(what)]; }

}  // namespace

struct Stage::Actors {
  std::vector<Actor> meshes;
  Actor interior, force_layer, proximity;
  std::vector<Actor> part, target;
  Actor shell, spring;
  Glyphs contact_points{sphere(), kContactColour, false};
  Glyphs contact_forces{arrow(), kContactColour, true};
  Glyphs layer_points{sphere(), kForceLayerColour, false};
  Glyphs proximity_points{vtkSmartPointer<vtkCubeSource>::New(), kProximityColour, false};
  Glyphs interior_points{octahedron(), kPenetrationColour, false};
  Glyphs net_force{arrow(), kNetForceColour, true};
};

ShownSet default_shown(const ViewScene& scene) {
  ShownSet shown{};
  const auto set = [&](Shown what, bool on) { shown[static_cast<unsigned>(what)] = on; };
  set(Shown::kMeshes, true);
  set(Shown::kInterior, scene.meshes.empty());
  set(Shown::kForceLayer, true);
  set(Shown::kPart, true);
  set(Shown::kShell, !scene.part);
  set(Shown::kContacts, true);
  set(Shown::kHandle, true);
  return shown;
}

Stage::Stage(const ViewScene& scene, vtkRenderer* world, vtkRenderer* marks)
    : scene_(scene), world_(world), marks_(marks), actors_(std::make_unique<Actors>()) {
  Actors& a = *actors_;
  for (const ViewMesh& mesh : scene.meshes) {
    const PolyData data = poly_data_of(mesh);
    a.meshes.push_back(surface_actor(data, kSceneColour));
    a.meshes.push_back(line_actor(feature_edges_of(data), kEdgeColour, 1.5));
  }
  const auto layer = [&](VoxelValue value, const Colour& colour, double opacity) {
    const PolyData data = scene.voxmap
                              ? poly_data_of(layer_surface(*scene.voxmap, value, scene.origin_m))
                              : PolyData::New();
    return surface_actor(data, colour, opacity);
  };
  a.interior = layer(VoxelValue::kInterior, kInteriorColour, 1);
  a.force_layer = layer(VoxelValue::kSurface, kForceLayerColour, kForceLayerOpacity);
  a.proximity = layer(VoxelValue::kProximity, kProximityColour, kProximityOpacity);
  a.force_layer->GetProperty()->BackfaceCullingOn();  // seen from outside, one sheet is enough
  a.proximity->GetProperty()->BackfaceCullingOn();
  if (scene.part) {
    const PolyData data = poly_data_of(*scene.part);
    const PolyData edges = feature_edges_of(data);
    a.part = {surface_actor(data, kPartColour, kPartOpacity), line_actor(edges, kInk, 1.5)};
    a.target = {line_actor(edges, kGhostColour, 2)};
  }
  if (scene.shell) {
    a.shell = surface_actor(discs_of(*scene.shell), kPartColour);
    a.shell->GetProperty()->SetPointSize(4);
  }
  a.spring = line_actor(PolyData::New(), kGhostColour, 3);
  for (const auto& list : {a.meshes, a.part, a.target}) {
    for (const Actor& actor : list) world_->AddActor(actor);
  }
  for (const Actor& actor : {a.interior, a.force_layer, a.proximity, a.shell, a.spring}) {
    if (actor != nullptr) world_->AddActor(actor);
  }
  for (const Glyphs* glyphs : {&a.contact_points, &a.contact_forces, &a.layer_points,
                               &a.proximity_points, &a.interior_points, &a.net_force}) {
    marks_->AddActor(glyphs->actor);
  }
  vtkNew<vtkLightKit> lights;
  lights->AddLightsToRenderer(world_);
  marks_->SetActiveCamera(world_->GetActiveCamera());
}

Stage::~Stage() = default;

void Stage::show(const ShownSet& shown) {
  Actors& a = *actors_;
  const auto set = [&](const Actor& actor, Shown what) {
    if (actor != nullptr) actor->SetVisibility(is_shown(shown, what));
  };
  for (const Actor& actor : a.meshes) set(actor, Shown::kMeshes);
  for (const Actor& actor : a.part) set(actor, Shown::kPart);
  for (const Actor& actor : a.target) set(actor, Shown::kHandle);
  set(a.interior, Shown::kInterior);
  set(a.force_layer, Shown::kForceLayer);
  set(a.proximity, Shown::kProximity);
  set(a.shell, Shown::kShell);
  set(a.spring, Shown::kHandle);
  for (const Glyphs* glyphs : {&a.contact_points, &a.contact_forces, &a.layer_points,
                               &a.proximity_points, &a.interior_points, &a.net_force}) {
    set(glyphs->actor, Shown::kContacts);
  }
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
  vtkActorCollection* all = world_->GetActors();
  all->InitTraversal();
  while (vtkActor* actor = all->GetNextActor()) {
    actor->GetProperty()->LightingOff();
    actor->GetProperty()->SetOpacity(1);
  }
}

void Stage::place_part(const Pose& world_from_part) {
  const auto matrix = matrix_of(world_from_part, scene_.origin_m);
  for (const Actor& actor : actors_->part) actor->SetUserMatrix(matrix);
  if (actors_->shell != nullptr) actors_->shell->SetUserMatrix(matrix);
}

void Stage::place_target(const Pose& world_from_part, const Pose& world_from_target) {
  const auto matrix = matrix_of(world_from_target, scene_.origin_m);
  for (const Actor& actor : actors_->target) actor->SetUserMatrix(matrix);
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

}  // namespace forcelayer
