#include "runtime/viewer/vtk_picture.h"

#include <vtkAxesActor.h>
#include <vtkCamera.h>
#include <vtkCaptionActor2D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <cstddef>
#include <glm/geometric.hpp>
#include <span>

#include "formats/atomic_file.h"
#include "runtime/viewer/style.h"
#include "runtime/viewer/vtk_overlay.h"

namespace forcelayer {
namespace {

constexpr int kOversampling = 2;  // rendered larger and shrunk: smooth edges with depth peeling

// The directions of the world's axes, in a corner.
void add_triad(vtkRenderWindow* window, const CameraView& view) {
  vtkNew<vtkAxesActor> axes;
  axes->SetXAxisLabelText("x");
  axes->SetYAxisLabelText("y");
  axes->SetZAxisLabelText("z");
  for (vtkCaptionActor2D* caption : {axes->GetXAxisCaptionActor2D(), axes->GetYAxisCaptionActor2D(),
                                     axes->GetZAxisCaptionActor2D()}) {
    caption->GetCaptionTextProperty()->SetColor(kInk.data());
    caption->GetCaptionTextProperty()->ItalicOff();
    caption->GetCaptionTextProperty()->ShadowOff();
  }
  vtkNew<vtkRenderer> renderer;
  renderer->SetLayer(1);
  renderer->SetViewport(0, 0, 0.13, 0.2);
  renderer->AddActor(axes);
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetParallelProjection(1);
  camera->SetPosition(view.to_eye.x, view.to_eye.y, view.to_eye.z);
  camera->SetFocalPoint(0, 0, 0);
  camera->SetViewUp(view.up.x, view.up.y, view.up.z);
  renderer->ResetCamera(-1.2, 1.2, -1.2, 1.2, -1.2, 1.2);
  camera->SetParallelScale(1.5);
  window->AddRenderer(renderer);
}

std::vector<LegendEntry> legend_of(const ViewScene& scene, const std::optional<Moment>& moment,
                                   const ShownSet& shown) {
  const auto on = [&](Shown what) { return shown[static_cast<unsigned>(what)]; };
  std::vector<LegendEntry> legend;
  if (!scene.meshes.empty() && on(Shown::kMeshes)) {
    legend.push_back({Swatch::kSquare, kSceneColour, 1, "scene (mesh)"});
  }
  if (scene.voxmap && on(Shown::kInterior)) {
    legend.push_back({Swatch::kSquare, kInteriorColour, 1, "interior voxels"});
  }
  if (scene.voxmap && on(Shown::kForceLayer)) {
    legend.push_back({Swatch::kSquare, kForceLayerColour, 0.5, "force layer (value 2)"});
  }
  if (scene.voxmap && on(Shown::kProximity)) {
    legend.push_back({Swatch::kSquare, kProximityColour, 0.4, "proximity (value 3)"});
  }
  if (!moment) return legend;
  if (scene.part && on(Shown::kPart)) {
    legend.push_back({Swatch::kSquare, kPartColour, 1, "part (mesh)"});
  } else if (scene.shell && on(Shown::kShell)) {
    legend.push_back({Swatch::kSquare, kPartColour, 1, "part (point shell)"});
  }
  if (moment->world_from_target && on(Shown::kHandle)) {
    legend.push_back({Swatch::kLine, kGhostColour, 1, "where the hand holds it"});
    legend.push_back({Swatch::kCoil, kGhostColour, 1, "virtual coupling"});
  }
  if (scene.voxmap && scene.shell && on(Shown::kContacts)) {
    legend.push_back({Swatch::kArrow, kContactColour, 1, "contact: force on the part"});
    legend.push_back({Swatch::kDot, kForceLayerColour, 1, "point in the force layer, depth 0"});
    legend.push_back({Swatch::kSmallSquare, kProximityColour, 1, "point in proximity"});
    legend.push_back({Swatch::kDiamond, kPenetrationColour, 1, "point in interior"});
  }
  if (moment->on_hand && on(Shown::kContacts)) {
    legend.push_back({Swatch::kArrow, kNetForceColour, 1, "force on the hand"});
  }
  return legend;
}

void place(Stage& stage, const ViewScene& scene, const Moment& moment) {
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

// Every pixel the mean of a square of `factor` x `factor` pixels.
vtkSmartPointer<vtkImageData> shrunk(vtkImageData* image, int factor) {
  if (factor == 1) return image;
  int extent[3];
  image->GetDimensions(extent);
  const int width = extent[0] / factor, height = extent[1] / factor;
  auto result = vtkSmartPointer<vtkImageData>::New();
  result->SetDimensions(width, height, 1);
  result->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  const auto* from = static_cast<const unsigned char*>(image->GetScalarPointer());
  auto* to = static_cast<unsigned char*>(result->GetScalarPointer());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < 3 * width; ++x) {
      int sum = 0;
      for (int n = 0; n < factor * factor; ++n) {
        const int column = (x / 3) * factor + n % factor, row = y * factor + n / factor;
        sum += from[3 * (row * extent[0] + column) + x % 3];
      }
      *to++ = static_cast<unsigned char>(sum / (factor * factor));
    }
  }
  return result;
}

Status write_png(const std::filesystem::path& path, vtkImageData* image) {
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  const std::span<const unsigned char> content(bytes->GetPointer(0),
                                               static_cast<std::size_t>(bytes->GetDataSize()));
  if (Status written = file->write(std::as_bytes(content)); !written) return written;
  return file->commit();
}

}  // namespace

Status write_picture(const std::filesystem::path& path, const ViewScene& scene,
                     const std::optional<Moment>& moment, const PictureOptions& options) {
  const int sampling = options.plain ? 1 : kOversampling;
  const int width = options.width * sampling, height = options.height * sampling;
  vtkNew<vtkRenderer> world, marks, words;
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetAlphaBitPlanes(1);
  window->SetNumberOfLayers(3);
  window->SetSize(width, height);
  world->SetBackground(kPaper.data());
  world->SetUseDepthPeeling(1);
  world->SetMaximumNumberOfPeels(4);
  marks->SetLayer(1);
  words->SetLayer(2);
  for (vtkRenderer* renderer : {world.Get(), marks.Get(), words.Get()}) {
    window->AddRenderer(renderer);
  }
  Stage stage(scene, world, marks);
  ShownSet shown = options.shown;
  if (!moment) {
    for (const Shown what : {Shown::kPart, Shown::kShell, Shown::kContacts, Shown::kHandle}) {
      shown[static_cast<unsigned>(what)] = false;
    }
  }
  stage.show(shown);
  if (moment) place(stage, scene, *moment);
  if (options.plain) stage.make_plain();
  stage.aim(options.camera);
  Overlay overlay(words, sampling);
  if (!options.plain) {
    add_triad(window, options.camera);
    overlay.set_title(options.title);
    overlay.set_legend(legend_of(scene, moment, shown));
    overlay.lay_out(width, height, 2 * options.camera.half_height_m / height);
  }
  window->Render();
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window);
  grab->ReadFrontBufferOff();
  grab->SetInputBufferTypeToRGB();
  grab->Update();
  return write_png(path, shrunk(grab->GetOutput(), sampling));
}

}  // namespace forcelayer
