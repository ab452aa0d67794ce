// The questions that python_bench.py asks from Python, asked by a plain loop in C++:
//   python_bench SCENE.vox PART.pshell FILE query|clearance|steps THREADS
// FILE holds poses as doubles, x y z qw qx qy qz each; for steps, of the hand. Asks once to warm up
// and once more, and prints the wall-clock and processor seconds of the second time.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "forcelayer/pose_datagram.h"
#include "forcelayer/run.h"
#include "runtime/field/surface_clearance.h"
#include "runtime/guard/pose_guard.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/machine/step_arithmetic.h"
#include "runtime/model/simulation.h"
#include "runtime/run/baked_files.h"
#include "tests/bench/bench_report.h"

namespace forcelayer::bench {
namespace {

template <typename T>
T value_of(Result<T> result) {
  if (!result) throw std::runtime_error(to_line(result.error()));
  return std::move(result).value();
}

std::vector<Pose> read_poses(const char* path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<Pose> poses;
  for (std::array<double, 7> n{}; file.read(reinterpret_cast<char*>(n.data()), sizeof n);) {
    poses.push_back(pose_from_numbers(n));
  }
  return poses;
}

// One thread's share of the poses.
struct Asker {
  Asker(const Voxmap& scene, const Pshell& part)
      : query(scene, part),
        field(value_of(field::make_force_field(Model::kDefault,
                                               field::usual_force(Model::kDefault, scene), scene))),
        surface(query) {
    const std::uint64_t count = part.view().point_count;
    points.reserve(count);
    samples.reserve(count);
    contacts.reserve(count);
    probe = std::make_unique<guard::PoseGuard>(query, *field, points, samples);
    const auto& c = part.header().center_m;
    part_from_center.position_m = {c[0], c[1], c[2]};
  }

  void count(std::span<const Pose> poses) {
    const machine::StepArithmetic arithmetic;
    for (const Pose& pose : poses) {
      query.run(pose * part_from_center, points);
      sum += points.surface_count;
    }
  }
  void prove(std::span<const Pose> poses) {
    const machine::StepArithmetic arithmetic;
    for (const Pose& pose : poses) {
      const Pose center = pose * part_from_center;
      probe->query_pose(center, contacts);
      auto least = field::point_clearance(contacts, center.position_m, *probe);
      surface.prove(least.kind, least.clearance_m);
      sum += least.clearance_m;
    }
  }

  query::ContactQuery query;
  std::unique_ptr<field::ForceField> field;
  field::SurfaceClearance surface;
  query::CollectedPoints points;
  field::FieldSamples samples;
  field::ContactSet contacts;
  std::unique_ptr<guard::PoseGuard> probe;
  Pose part_from_center;
  double sum = 0;  // so that nothing is left out
};

double ask(std::vector<std::unique_ptr<Asker>>& askers, std::span<const Pose> poses, bool prove) {
  std::vector<std::thread> threads;
  for (std::size_t n = 0; n < askers.size(); ++n) {
    const std::size_t begin = n * poses.size() / askers.size();
    const std::size_t end = (n + 1) * poses.size() / askers.size();
    threads.emplace_back([&asker = *askers[n], share = poses.subspan(begin, end - begin), prove] {
      prove ? asker.prove(share) : asker.count(share);
    });
  }
  for (std::thread& thread : threads) thread.join();
  double sum = 0;
  for (const auto& asker : askers) sum += asker->sum;
  return sum;
}

double step(Run& run, std::span<const Pose> handles) {
  model::Simulation& simulation = run.simulation();
  State state = simulation.registered(handles[0], handles[0]);
  const double dt_s = 1 / run.parameters().rate_hz;
  loop::HandleVelocity velocity;
  StepInput input;
  input.valid = kInputValid;
  double sum = 0;
  for (const Pose& handle : handles) {
    input.world_from_handle = handle;
    input.handle_velocity = velocity.update(handle, dt_s);
    sum += simulation.step(state, input, dt_s).report.clearance_m;
  }
  return sum;
}

int run(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr,
                 "usage: python_bench SCENE.vox PART.pshell FILE query|clearance|steps THREADS\n");
    return 2;
  }
  const std::string question = argv[4];
  const std::vector<Pose> poses = read_poses(argv[3]);
  const Voxmap scene = value_of(open_scene(argv[1]));
  const Pshell part = value_of(open_part(argv[2]));
  std::vector<std::unique_ptr<Asker>> askers;
  std::optional<Run> simulated;
  if (question == "steps") {
    simulated = value_of(open_run(default_run_request(argv[1], argv[2])));
  } else {
    for (int n = 0; n < std::atoi(argv[5]); ++n) {
      askers.push_back(std::make_unique<Asker>(scene, part));
    }
  }
  const auto once = [&] {
    return simulated ? step(*simulated, poses) : ask(askers, poses, question == "clearance");
  };
  double sum = once();
  const double wall_s = now_s(), used_s = cpu_s();
  sum += once();
  std::printf("%.9g %.9g %.17g\n", now_s() - wall_s, cpu_s() - used_s, sum);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("python_bench", forcelayer::bench::run, argc, argv);
}
