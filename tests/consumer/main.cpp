// An outside program: opens both files, puts the part into the middle of the scene and steps it.
#include <forcelayer/run.h>

#include <cstdio>

using namespace forcelayer;

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: consumer SCENE.vox PART.pshell\n");
    return 2;
  }
  RunRequest request = default_run_request(argv[1], argv[2]);
  request.without_guarantee = true;
  auto run = open_run(request);
  if (!run) {
    std::fprintf(stderr, "consumer: %s\n", to_line(run.error()).c_str());
    return exit_status(run.error().code);
  }
  const auto map = Voxmap::open(argv[1]);
  if (!map) return 1;
  DeviceSample reading;
  reading.present = reading.fresh = true;
  for (int axis = 0; axis < 3; ++axis) {
    reading.device_from_handle.position_m[axis] =
        (double(map->header().origin_voxel[axis]) + 0.5 * double(map->header().dims_voxels[axis])) *
        map->voxel_size_m();
  }
  if (const auto started = run->start({}, reading); !started) {
    std::fprintf(stderr, "consumer: %s\n", to_line(started.error()).c_str());
    return 1;
  }
  for (int frame = 0; frame < 10; ++frame) run->step(reading);
  const StepReport& report = run->frame().result.report;
  std::printf("model %s, %llu frames, %u points in the interior, %u in the force layer\n",
              std::string(to_text(run->parameters().model)).c_str(),
              static_cast<unsigned long long>(run->statistics().frames), report.interior,
              report.surface);
  return 0;
}
