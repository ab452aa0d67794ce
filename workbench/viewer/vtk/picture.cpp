#include "workbench/viewer/vtk/picture.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <optional>
#include <span>
#include <vector>

#include "formats/file/atomic_file.h"
#include "workbench/viewer/plan/style.h"
#include "workbench/viewer/vtk/animated_png.h"
#include "workbench/viewer/vtk/overlay.h"
#include "workbench/viewer/vtk/stage.h"
#include "workbench/viewer/vtk/triad.h"

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

std::vector<std::byte> png_of(vtkImageData* image) {
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  const auto* begin = reinterpret_cast<const std::byte*>(bytes->GetPointer(0));
  return {begin, begin + bytes->GetDataSize()};
}

Status write_file(const std::filesystem::path& path, std::span<const std::byte> content) {
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  if (Status written = file->write(content); !written) return written;
  return file->commit();
}

// Where a measure lies on a picture of that many pixels.
DrawnMeasure drawn(const Measure& measure, const CameraView& view, int width, int height) {
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
    world->SetMaximumNumberOfPeels(4);  // two sheets a peel; more look alike
    marks->SetLayer(1);
    words->SetLayer(2);
    for (vtkRenderer* renderer : {world.Get(), marks.Get(), words.Get()}) {
      window->AddRenderer(renderer);
    }
  }
};

// A planned picture, drawn from one place or from several.
class Drawing {
 public:
  Drawing(const ViewScene& scene, const PicturePlan& plan)
      : plan_(plan),
        sampling_(plan.plain ? 1 : kOversampling),
        layers_(plan.width * sampling_, plan.height * sampling_),
        stage_(scene, plan, layers_.world, layers_.marks),
        overlay_(layers_.words, sampling_ * plan.scale) {
    const bool placed = plan.moment || scene.bounds.empty;  // a shell alone stands where it is
    stage_.show(placed ? plan.shown : without_moment(plan.shown));
    stage_.hide(plan.hidden);
    if (plan.moment) place_moment(stage_, scene, *plan.moment);
    stage_.cut(plan.cut);
    if (plan.plain) {
      stage_.make_plain();
      return;
    }
    triad_.emplace(layers_.window, 1);
    overlay_.set_title(plan.title);
    if (plan.moment && !plan.measure && !plan.own_title) overlay_.set_state(plan.moment->kind());
    overlay_.set_legend(legend_of(plan, scene));
  }

  std::vector<std::byte> png_from(const CameraView& camera) {
    stage_.aim(camera);
    if (triad_) lay_out(camera);
    layers_.window->Render();
    vtkNew<vtkWindowToImageFilter> grab;
    grab->SetInput(layers_.window);
    grab->ReadFrontBufferOff();
    grab->SetInputBufferTypeToRGB();
    grab->Update();
    return png_of(shrunk(grab->GetOutput(), sampling_));
  }

 private:
  void lay_out(const CameraView& camera) {
    const int width = plan_.width * sampling_, height = plan_.height * sampling_;
    triad_->aim(camera.to_eye, camera.up, width, height,
                static_cast<int>(std::lround(150 * sampling_ * plan_.scale)));
    if (plan_.measure) overlay_.set_measure(drawn(*plan_.measure, camera, width, height));
    overlay_.lay_out(width, height, 2 * camera.half_height_m / height);
  }

  const PicturePlan& plan_;
  int sampling_;
  Layers layers_;
  Stage stage_;
  Overlay overlay_;
  std::optional<Triad> triad_;
};

}  // namespace

Status write_picture(const std::filesystem::path& path, const ViewScene& scene,
                     const PicturePlan& plan) {
  return write_file(path, Drawing(scene, plan).png_from(plan.camera));
}

Status write_turntable(const std::filesystem::path& path, const ViewScene& scene,
                       const PicturePlan& plan) {
  constexpr int kPictures = 72;
  constexpr std::uint16_t kDelayMs = 80;
  Drawing drawing(scene, plan);
  AnimatedPng movie(kPictures, kDelayMs);
  for (const CameraView& camera : turntable_of(plan, scene, kPictures)) {
    movie.add(drawing.png_from(camera));
  }
  return write_file(path, movie.finish());
}

}  // namespace forcelayer::viewer
