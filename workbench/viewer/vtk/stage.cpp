#include "workbench/viewer/vtk/stage.h"

#include <vtkActor.h>
#include <vtkActorCollection.h>
#include <vtkAppendPolyData.h>
#include <vtkArrowSource.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkCubeSource.h>
#include <vtkGlyph3D.h>
#include <vtkLight.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
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

#include "workbench/viewer/plan/legend.h"
#include "workbench/viewer/plan/style.h"
#include "workbench/viewer/surface/coarse_layers.h"
#include "workbench/viewer/surface/layer_surface.h"
#include "workbench/viewer/vtk/geometry.h"
#include "workbench/viewer/vtk/section.h"
#include "workbench/viewer/vtk/voxel_faces.h"

namespace forcelayer::viewer {
namespace {

using Actor = vtkSmartPointer<vtkActor>;

// The order of everything that is kept per layer.
constexpr std::array<VoxelValue, 3> kLayers = {VoxelValue::kInterior, VoxelValue::kSurface,
                                               VoxelValue::kProximity};
// Rectangles of a layer that cost little beside filling the window without a graphics card.
constexpr std::uint64_t kQuickRectangles = 20000;

Actor actor_of(const PolyData& data, const Color& color) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  mapper->ScalarVisibilityOff();
  auto actor = Actor::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(color[0], color[1], color[2]);
  actor->GetProperty()->SetInterpolationToFlat();
  return actor;
}

void replace_data(const Actor& actor, const PolyData& data) {
  vtkPolyDataMapper::SafeDownCast(actor->GetMapper())->SetInputData(data);
}

// The color of surfaces in the plane of a cut.
Color darker(const Color& color) {
  constexpr double kShade = 0.8;
  return {kShade * color[0], kShade * color[1], kShade * color[2]};
}

Actor surface_actor(const PolyData& data, const Color& color) {
  Actor actor = actor_of(data, color);
  actor->GetProperty()->SetAmbient(0.45);
  actor->GetProperty()->SetDiffuse(0.6);
  return actor;
}

Actor line_actor(const PolyData& data, const Color& color, double width) {
  Actor actor = actor_of(data, color);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetLineWidth(static_cast<float>(width));
  return actor;
}

// For places_and_line().
Actor places_actor(const Color& color, double width, double scale) {
  Actor actor = line_actor(PolyData::New(), color, width * scale);
  actor->GetProperty()->SetPointSize(static_cast<float>(9 * scale));
  return actor;
}

// A shape set at every point of the data that replace_glyphs() gives.
struct Glyphs {
  vtkSmartPointer<vtkGlyph3D> glyph = vtkSmartPointer<vtkGlyph3D>::New();
  Actor actor;

  Glyphs(vtkPolyDataAlgorithm* shape, const Color& color, bool by_vector) {
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
    actor->GetProperty()->SetColor(color[0], color[1], color[2]);
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
  // Drawn in this order, inner ones first: without depth peeling, translucent faces are blended in
  // the order in which they come.
  VoxelFaces cut_interior, interior, added, removed;
  VoxelFaces quick_interior;
  VoxelFaces cut_force_layer, cut_proximity, force_layer, proximity;
  VoxelFaces quick_force_layer, quick_proximity;
  std::vector<PolyData> mesh_data, mesh_edge_data;  // [meshes of the scene]
  PolyData target_data;
  Actor meshes, mesh_edges, missing_faces, measured, measured_edges;
  Actor sections, section_edges;
  Actor part, part_edges, part_missing_faces, target, shell, spring, clearance, measurement;
  Glyphs contact_points{sphere(), kContactColor, false};
  Glyphs contact_forces{arrow(9), kContactColor, true};
  Glyphs layer_points{sphere(), kForceLayerColor, false};
  Glyphs proximity_points{vtkSmartPointer<vtkCubeSource>::New(), kProximityColor, false};
  Glyphs interior_points{octahedron(), kPenetrationColor, false};
  Glyphs net_force{arrow(20), kNetForceColor, true};

  std::array<Glyphs*, 6> glyphs() {
    return {&contact_points,   &contact_forces,  &layer_points,
            &proximity_points, &interior_points, &net_force};
  }
  std::array<VoxelFaces*, 3> cuts() { return {&cut_interior, &cut_force_layer, &cut_proximity}; }
  std::array<VoxelFaces*, 3> layers() { return {&interior, &force_layer, &proximity}; }
  std::array<VoxelFaces*, 3> quick_layers() {
    return {&quick_interior, &quick_force_layer, &quick_proximity};
  }
  std::array<VoxelFaces*, 8> bodies() {
    return {&interior, &force_layer,    &proximity,         &added,
            &removed,  &quick_interior, &quick_force_layer, &quick_proximity};
  }

  Actors(vtkRenderer* world, bool change)
      : cut_interior(world, kInteriorColor, 1),
        interior(world, kInteriorColor, 1),
        added(world, kAddedColor, 1),
        removed(world, kRemovedColor, 1),
        quick_interior(world, kInteriorColor, 1),
        cut_force_layer(world, kForceLayerColor, 1),
        cut_proximity(world, kProximityColor, 1),
        force_layer(world, kForceLayerColor, change ? kUnchangedOpacity : kForceLayerOpacity),
        proximity(world, kProximityColor, kProximityOpacity),
        quick_force_layer(world, kForceLayerColor, change ? kUnchangedOpacity : kForceLayerOpacity),
        quick_proximity(world, kProximityColor, kProximityOpacity) {}
};

Stage::Stage(const ViewScene& scene, const PicturePlan& plan, vtkRenderer* world,
             vtkRenderer* marks)
    : scene_(scene),
      world_(world),
      marks_(marks),
      actors_(std::make_unique<Actors>(world, plan.change.has_value())),
      scale_(plan.scale),
      hidden_meshes_(scene.meshes.size(), 0),
      measured_(scene.meshes.size(), 0) {
  build_scene(plan);
  build_layers();
  build_change(plan.change);
  build_part();
  if (plan.measure && actors_->part != nullptr) {
    actors_->part->GetProperty()->SetOpacity(kMeasuredPartOpacity);
  }
  for (Glyphs* glyphs : actors_->glyphs()) marks_->AddActor(glyphs->actor);
  actors_->clearance = places_actor(kClearanceColor, 4, scale_);
  actors_->measurement = places_actor(kMeasureColor, 2.5, scale_);
  if (!plan.path_m.empty()) {
    marks_->AddActor(
        line_actor(places_and_line(plan.path_m, scene.origin_m), kPathColor, 3 * scale_));
  }
  for (const Actor& actor : {actors_->clearance, actors_->measurement}) marks_->AddActor(actor);
  for (vtkRenderer* renderer : {world_, marks_}) {
    vtkNew<vtkLight> light;
    light->SetLightTypeToCameraLight();
    light->SetPosition(kToLight[0], kToLight[1], kToLight[2]);
    light->SetFocalPoint(0, 0, 0);
    renderer->AddLight(light);
  }
  marks_->SetActiveCamera(world_->GetActiveCamera());
  vtkNew<vtkCallbackCommand> start;
  start->SetClientData(this);
  start->SetCallback([](vtkObject*, unsigned long, void* self, void*) {
    static_cast<Stage*>(self)->face_camera();
  });
  observer_ = world_->AddObserver(vtkCommand::StartEvent, start);
}

void Stage::build_scene(const PicturePlan& plan) {
  const bool color_objects = colors_objects_ = plan.color_objects;
  if (scene_.meshes.empty()) return;
  for (std::size_t n = 0; n < scene_.meshes.size(); ++n) {
    const PolyData& data = actors_->mesh_data.emplace_back(poly_data_of(scene_.meshes[n]));
    if (color_objects) color_cells(data, color_of_mesh(n));
    actors_->mesh_edge_data.push_back(feature_edges_of(data));
  }
  actors_->meshes = surface_actor(PolyData::New(), kSceneColor);
  actors_->meshes->GetMapper()->SetScalarModeToUseCellData();
  actors_->meshes->GetMapper()->SetScalarVisibility(color_objects);
  actors_->mesh_edges = line_actor(PolyData::New(), kEdgeColor, scale_);
  actors_->sections = surface_actor(PolyData::New(), kSceneColor);
  actors_->sections->GetMapper()->SetScalarModeToUseCellData();
  actors_->sections->GetMapper()->ScalarVisibilityOn();
  actors_->section_edges = line_actor(PolyData::New(), kInk, scale_);
  if (plan.measure) {
    for (std::size_t n = 0; n < scene_.meshes.size(); ++n) {
      measured_[n] = scene_.meshes[n].name == plan.measure->object ? 1 : 0;
    }
    actors_->meshes->GetProperty()->SetOpacity(kOthersOpacity);
    actors_->mesh_edges->GetProperty()->SetOpacity(kOthersOpacity);
    actors_->sections->GetProperty()->SetOpacity(kOthersOpacity);
    actors_->section_edges->GetProperty()->SetOpacity(kOthersOpacity);
  }
  actors_->measured = surface_actor(PolyData::New(), kMeasuredColor);
  actors_->measured_edges = line_actor(PolyData::New(), kInk, scale_);
  draw_meshes();
  world_->AddActor(actors_->measured);
  world_->AddActor(actors_->measured_edges);
  world_->AddActor(actors_->meshes);
  world_->AddActor(actors_->mesh_edges);
  world_->AddActor(actors_->sections);
  world_->AddActor(actors_->section_edges);
  actors_->missing_faces = add_missing_faces(scene_.missing_faces);
}

// The edges of a cube around each, seen through all else; null without cubes.
Actor Stage::add_missing_faces(std::span<const ViewMesh> cubes) {
  if (cubes.empty()) return nullptr;
  vtkNew<vtkAppendPolyData> frames;
  for (const ViewMesh& cube : cubes) frames->AddInputData(feature_edges_of(poly_data_of(cube)));
  frames->Update();
  const Actor actor = line_actor(frames->GetOutput(), kMissingFaceColor, 3 * scale_);
  marks_->AddActor(actor);
  return actor;
}

// One actor for all: an assembly of hundreds of parts turns as fast as one part. Edges mesh by
// mesh: where two parts touch, both keep theirs.
void Stage::draw_meshes() {
  const auto draw = [&](const Actor& actor, const std::vector<PolyData>& data, bool measured) {
    vtkNew<vtkAppendPolyData> all;
    for (std::size_t n = 0; n < data.size(); ++n) {
      if (hidden_meshes_[n] == 0 && (measured_[n] != 0) == measured) all->AddInputData(data[n]);
    }
    const bool any = all->GetNumberOfInputConnections(0) > 0;
    if (any) all->Update();
    replace_data(actor, any ? PolyData(all->GetOutput()) : PolyData::New());
  };
  draw(actors_->meshes, actors_->mesh_data, false);
  draw(actors_->mesh_edges, actors_->mesh_edge_data, false);
  draw(actors_->measured, actors_->mesh_data, true);
  draw(actors_->measured_edges, actors_->mesh_edge_data, true);
  draw_sections();
}

// The plane of the cut, moved into the side that stays; none without a cut.
vtkSmartPointer<vtkPlane> Stage::cut_plane(double inwards_m) const {
  if (!cut_) return nullptr;
  const double inwards = cut_->keep_low ? -1 : 1;
  double normal[3] = {0, 0, 0}, origin[3] = {0, 0, 0};
  normal[cut_->axis] = inwards;
  origin[cut_->axis] = cut_->at_m - scene_.origin_m[cut_->axis] + inwards * inwards_m;
  auto plane = vtkSmartPointer<vtkPlane>::New();
  plane->SetNormal(normal);
  plane->SetOrigin(origin);
  return plane;
}

// Fills the meshes where the cut goes through them. Not in a plane of their own faces, which cuts
// are often laid in: a little inwards, where voxels that are cut hide it too.
void Stage::draw_sections() {
  if (actors_->sections == nullptr) return;
  constexpr double kInwards = 1e-5;  // of the scene; ten times the rounding of its floats
  const auto plane = cut_plane(kInwards * glm::length(scene_.bounds.high_m - scene_.bounds.low_m));
  vtkNew<vtkAppendPolyData> faces, edges;
  for (std::size_t n = 0; plane != nullptr && n < scene_.meshes.size(); ++n) {
    if (hidden_meshes_[n] != 0) continue;
    const Section section = section_of(actors_->mesh_data[n], plane);
    if (section.faces->GetNumberOfCells() == 0) continue;
    const Color color = measured_[n] != 0 ? kMeasuredColor
                        : colors_objects_ ? color_of_mesh(n)
                                          : kSceneColor;
    color_cells(section.faces, darker(color));
    faces->AddInputData(section.faces);
    edges->AddInputData(section.outline);
  }
  const auto replace = [](const Actor& actor, vtkAppendPolyData* all) {
    const bool any = all->GetNumberOfInputConnections(0) > 0;
    if (any) all->Update();
    replace_data(actor, any ? PolyData(all->GetOutput()) : PolyData::New());
  };
  replace(actors_->sections, faces);
  replace(actors_->section_edges, edges);
}

void Stage::build_layers() {
  if (!scene_.voxmap) return;
  voxel_rectangles_ = max_rectangles_ = 0;
  for (std::size_t n = 0; n < kLayers.size(); ++n) {
    const QuadSurface surface =
        layer_surface(*scene_.voxmap, kLayers[n], scene_.origin_m, Faces::kMerged, hidden_objects_);
    voxel_rectangles_ += surface.quad_count();
    max_rectangles_ = std::max(max_rectangles_, surface.quad_count());
    actors_->layers()[n]->set(surface);
  }
}

void Stage::hide(const std::vector<std::string>& objects) {
  const auto is_hidden = [&](std::string_view name) {
    return std::find(objects.begin(), objects.end(), name) != objects.end();
  };
  for (std::size_t n = 0; n < hidden_meshes_.size(); ++n) {
    hidden_meshes_[n] = is_hidden(scene_.meshes[n].name) ? 1 : 0;
  }
  if (!scene_.meshes.empty()) draw_meshes();
  if (!scene_.voxmap) return;
  const std::uint32_t count = scene_.voxmap->header().object_count;
  HiddenObjects hidden(count + 1, 0);
  for (std::uint32_t n = 1; n <= count; ++n) {
    hidden[n] = is_hidden(scene_.voxmap->object_name(n)) ? 1 : 0;
    hidden[0] |= hidden[n];
  }
  if (hidden[0] == 0) hidden.clear();
  if (hidden == hidden_objects_) return;
  hidden_objects_ = std::move(hidden);
  build_layers();
  has_quick_ = false;  // the coarse layers have all objects
  if (hidden_objects_.empty()) build_quick_layers();
  cut(cut_);
  show_layers();
}

void Stage::build_change(const std::optional<LayerChange>& change) {
  if (!change) return;
  Actors& a = *actors_;
  a.added.set(change->added_surface);
  a.removed.set(change->removed_surface);
  a.removed.draw_edges(kInk);  // so that the two differ in more than hue
}

void Stage::build_quick_layers() {
  if (!scene_.voxmap || max_rectangles_ <= kQuickRectangles) return;
  int edge = 2;  // each doubling leaves about a quarter of the faces
  while (edge < CoarseLayers::kLargestEdge &&
         max_rectangles_ > kQuickRectangles * static_cast<std::uint64_t>(edge * edge)) {
    edge *= 2;
  }
  const CoarseLayers coarse(*scene_.voxmap, edge);
  for (std::size_t n = 0; n < kLayers.size(); ++n) {
    actors_->quick_layers()[n]->set(coarse.surface(kLayers[n], scene_.origin_m));
  }
  has_quick_ = true;
}

void Stage::draw_quickly(bool quickly) {
  quickly_ = quickly;
  show_layers();
}

void Stage::build_part() {
  Actors& a = *actors_;
  if (scene_.part) {
    const PolyData data = poly_data_of(*scene_.part);
    const PolyData edges = feature_edges_of(data);
    a.part = surface_actor(data, kPartColor);
    a.part_edges = line_actor(edges, kInk, 1.5 * scale_);
    a.target_data = edges;
    a.target = line_actor(PolyData::New(), kGhostColor, 2 * scale_);
  }
  if (scene_.shell) {
    a.shell = surface_actor(discs_of(*scene_.shell), kPartColor);
    a.shell->GetProperty()->SetPointSize(4);
  }
  a.part_missing_faces = add_missing_faces(scene_.part_missing_faces);
  a.spring = line_actor(PolyData::New(), kGhostColor, 3 * scale_);
  for (const Actor& actor : {a.part, a.part_edges, a.target, a.shell, a.spring}) {
    if (actor != nullptr) world_->AddActor(actor);
  }
}

Stage::~Stage() { world_->RemoveObserver(observer_); }

void Stage::show(const ItemSet& shown) {
  Actors& a = *actors_;
  const auto set = [&](const Actor& actor, Item what) {
    if (actor != nullptr) actor->SetVisibility(shown[what]);
  };
  for (const Actor& actor : {a.meshes, a.mesh_edges, a.missing_faces, a.measured, a.measured_edges,
                             a.sections, a.section_edges}) {
    set(actor, Item::kMeshes);
  }
  for (const Actor& actor : {a.part, a.part_edges}) set(actor, Item::kPart);
  if (a.part_missing_faces != nullptr) {
    a.part_missing_faces->SetVisibility(shown[Item::kPart] || shown[Item::kShell]);
  }
  for (const Actor& actor : {a.target, a.spring}) set(actor, Item::kHandle);
  shown_ = shown;
  show_layers();
  set(a.shell, Item::kShell);
  set(a.clearance, Item::kContacts);
  for (const Glyphs* glyphs : a.glyphs()) set(glyphs->actor, Item::kContacts);
}

void Stage::show_layers() {
  constexpr std::array<Item, 3> kNames = {Item::kInterior, Item::kForceLayer, Item::kProximity};
  const bool quickly = quickly_ && has_quick_;
  for (std::size_t n = 0; n < kNames.size(); ++n) {
    const bool shown = shown_[kNames[n]];
    actors_->cuts()[n]->show(shown);
    actors_->layers()[n]->show(shown && !quickly);
    actors_->quick_layers()[n]->show(shown && quickly);
  }
}

void Stage::cut(const std::optional<Cut>& cut) {
  cut_ = cut;
  Actors& a = *actors_;
  const auto plane = cut_plane(0);
  draw_sections();
  for (const Actor& actor : {a.meshes, a.mesh_edges, a.measured, a.measured_edges}) {
    if (actor == nullptr) continue;
    actor->GetMapper()->RemoveAllClippingPlanes();
    if (cut) actor->GetMapper()->AddClippingPlane(plane);
  }
  for (VoxelFaces* faces : a.bodies()) faces->cut(plane);
  for (std::size_t n = 0; n < kLayers.size(); ++n) {
    const bool open = cut && scene_.voxmap;
    a.cuts()[n]->set(open ? cut_sheet(*cut, kLayers[n]) : QuadSurface{});
  }
}

QuadSurface Stage::cut_sheet(const Cut& cut, VoxelValue value) const {
  // The voxels just on the side that stays.
  const double place = cut.at_m / scene_.voxmap->voxel_size_m();
  const auto index =
      static_cast<std::int64_t>(cut.keep_low ? std::ceil(place) - 1 : std::floor(place));
  return slice_surface(*scene_.voxmap, value, cut.axis, index, cut.keep_low ? 1 : -1,
                       scene_.origin_m, hidden_objects_);
}

void Stage::face_camera() {
  vtkCamera* camera = world_->GetActiveCamera();
  const double* along = camera->GetDirectionOfProjection();
  double up[3];
  camera->GetViewUp(up);
  const glm::dvec3 to_eye = -glm::dvec3(along[0], along[1], along[2]);
  const glm::dvec3 sky(up[0], up[1], up[2]);
  const glm::dvec3 across = glm::normalize(sky - glm::dot(sky, to_eye) * to_eye);
  for (VoxelFaces* faces : actors_->bodies()) faces->face_camera(to_eye, across);
  for (VoxelFaces* faces : actors_->cuts()) faces->face_camera(to_eye, across);
  world_->ResetCameraClippingRange();  // to the actors that are visible now
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
  for (VoxelFaces* faces : a.bodies()) faces->make_plain();
  for (VoxelFaces* faces : a.cuts()) faces->make_plain();
  for (const Actor& actor : {a.mesh_edges, a.part_edges, a.section_edges}) {
    if (actor != nullptr) actor->SetVisibility(0);
  }
}

void Stage::place_part(const Pose& world_from_part) {
  const auto matrix = matrix_of(world_from_part, scene_.origin_m);
  for (const Actor& actor :
       {actors_->part, actors_->part_edges, actors_->part_missing_faces, actors_->shell}) {
    if (actor != nullptr) actor->SetUserMatrix(matrix);
  }
}

void Stage::place_target(const Pose& world_from_part,
                         const std::optional<Pose>& world_from_target) {
  if (actors_->target != nullptr) {
    replace_data(actors_->target, world_from_target ? actors_->target_data : PolyData::New());
  }
  if (!world_from_target) {
    replace_data(actors_->spring, PolyData::New());
    return;
  }
  if (actors_->target != nullptr) {
    actors_->target->SetUserMatrix(matrix_of(*world_from_target, scene_.origin_m));
  }
  if (!scene_.shell) return;
  const double width_m = 0.25 * scene_.shell->header().bounding_radius_m;
  replace_data(actors_->spring,
               spring_between(world_from_center(world_from_part, *scene_.shell).position_m,
                              world_from_center(*world_from_target, *scene_.shell).position_m,
                              width_m, scene_.origin_m));
}

void Stage::place_contacts(const ContactView& contacts, const Arrows& arrows, double dot_m) {
  struct Places {
    std::vector<glm::dvec3> at, vector;
  } contact, layer, proximity, interior, force;
  for (const ViewPoint& point : contacts.points) {
    Places* kind = point.value == VoxelValue::kSurface ? &layer : &proximity;
    if (point.depth_m > 0) kind = &contact;
    if (point.value == VoxelValue::kInterior) kind = &interior;
    kind->at.push_back(point.position_m);
    kind->vector.push_back(point.depth_m * point.direction);
  }
  for (const std::size_t n : arrows.points) {
    const ViewPoint& point = contacts.points[n];
    force.at.push_back(point.position_m);
    force.vector.push_back(point.depth_m * point.direction);
  }
  Actors& a = *actors_;
  a.contact_points.set(contact.at, contact.vector, scene_.origin_m, dot_m);
  a.contact_forces.set(force.at, force.vector, scene_.origin_m, arrows.per_depth);
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

void Stage::place_clearance(const std::vector<glm::dvec3>& places_m) {
  replace_data(actors_->clearance, places_and_line(places_m, scene_.origin_m));
}

void Stage::place_measurement(const std::vector<glm::dvec3>& places_m) {
  replace_data(actors_->measurement, places_and_line(places_m, scene_.origin_m));
}

void place_moment(Stage& stage, const ViewScene& scene, const Moment& moment) {
  stage.place_part(moment.world_from_part);
  stage.place_target(moment.world_from_part, moment.world_from_target);
  if (!scene.shell) return;
  const double radius_m = scene.shell->header().bounding_radius_m;
  const ContactView& contacts = moment.contacts;
  stage.place_contacts(contacts, arrows_of(scene, contacts), 0.03 * radius_m);
  const bool measured = contacts.clearance_m && !contacts.at_least;
  stage.place_clearance(measured ? std::vector{contacts.nearest_m, contacts.nearest_scene_m}
                                 : std::vector<glm::dvec3>());
  const glm::dvec3 force_n = moment.on_hand ? moment.on_hand->force_n : glm::dvec3(0);
  constexpr double kMinForceN = 0.005;  // less is said as 0.00 N
  stage.place_net_force(world_from_center(moment.world_from_part, *scene.shell).position_m, force_n,
                        glm::length(force_n) >= kMinForceN ? 1.2 * radius_m : 0);
}

}  // namespace forcelayer::viewer
