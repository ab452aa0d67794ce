#include "runtime/viewer/vtk/picture.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <cstddef>
#include <glm/geometric.hpp>
#include <optional>
#include <span>

#include "formats/file/atomic_file.h"
#include "runtime/viewer/plan/style.h"
#include "runtime/viewer/vtk/overlay.h"
#include "runtime/viewer/vtk/stage.h"
#include "runtime/viewer/vtk/triad.h"

namespace forcelayer::viewer {
namespace {

constexpr int kOversampling = 2;  // rendered larger and shrunk: smooth edges with depth peeling

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

// Where a measure lies on a picture of that many pixels.
DrawnMeasure drawn(const Measure& measure, const PicturePlan& plan, int width, int height) {
  const CameraView& view = plan.camera;
  const glm::dvec3 right = glm::cross(view.up, view.to_eye);
  const double pixels_per_m = height / (2 * view.half_height_m);
  const auto x = [&](const glm::dvec3& p) {
    return width / 2.0 + pixels_per_m * glm::dot(p - view.target_m, right);
  };
  const auto y = [&](const glm::dvec3& p) {
    return height / 2.0 + pixels_per_m * glm::dot(p - view.target_m, view.up);
  };
  return {x(measure.part_m),   y(measure.part_m),      x(measure.object_m),
          y(measure.object_m), escaped(measure.words), escaped(measure.object)};
}

// The renderers of a picture: the world, marks over it, words over both.
struct Layers {
  vtkNew<vtkRenderer> world, marks, words;
  vtkNew<vtkRenderWindow> window;

  Layers(int width, int height) {
    window->SetOffScreenRendering(1);
    window->SetMultiSamples(0);
    window->SetAlphaBitPlanes(1);
    window->SetNumberOfLayers(3);
    window->SetSize(width, height);
    world->SetBackground(kBackground[0], kBackground[1], kBackground[2]);
    world->SetUseDepthPeeling(1);
    world->SetMaximumNumberOfPeels(4);  // two sheets a peel; more cannot be told apart
    marks->SetLayer(1);
    words->SetLayer(2);
    for (vtkRenderer* renderer : {world.Get(), marks.Get(), words.Get()}) {
      window->AddRenderer(renderer);
    }
  }
};

}  // namespace

Status write_picture(const std::filesystem::path& path, const ViewScene& scene,
                     const PicturePlan& plan) {
  const int sampling = plan.plain ? 1 : kOversampling;
  const int width = plan.width * sampling, height = plan.height * sampling;
  const Layers layers(width, height);
  Stage stage(scene, plan, layers.world, layers.marks);
  const bool placed = plan.moment || scene.bounds.empty;  // a shell alone stands where it is
  stage.show(placed ? plan.shown : without_moment(plan.shown));
  stage.hide(plan.hidden);
  if (plan.moment) place_moment(stage, scene, *plan.moment);
  stage.cut(plan.cut);
  if (plan.plain) stage.make_plain();
  stage.aim(plan.camera);
  std::optional<Triad> triad;
  Overlay overlay(layers.words, sampling);
  if (!plan.plain) {
    triad.emplace(layers.window, 1);
    triad->aim(plan.camera.to_eye, plan.camera.up, width, height, 150 * sampling);
    overlay.set_title(plan.title);
    if (plan.measure) {
      overlay.set_measure(drawn(*plan.measure, plan, width, height));
    } else if (plan.moment && !plan.own_title) {
      overlay.set_state(plan.moment->kind());
    }
    overlay.set_legend(legend_of(plan, scene));
    overlay.lay_out(width, height, plan.meters_per_pixel() / sampling);
  }
  layers.window->Render();
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(layers.window);
  grab->ReadFrontBufferOff();
  grab->SetInputBufferTypeToRGB();
  grab->Update();
  return write_png(path, shrunk(grab->GetOutput(), sampling));
}

}  // namespace forcelayer::viewer
