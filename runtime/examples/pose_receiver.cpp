// A tiny receiver of the pose stream: example_pose_receiver PORT [SECONDS] prints where the part
// is, and how near to what.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "forcelayer/pose_receiver.h"

int main(int argc, char** argv) {
  const int port = argc > 1 ? std::atoi(argv[1]) : 0;
  if (port <= 0 || port > 65535) {
    std::fprintf(stderr, "usage: example_pose_receiver PORT [SECONDS]\n");
    return 2;
  }
  auto receiver = forcelayer::PoseReceiver::open(static_cast<std::uint16_t>(port));
  if (!receiver) {
    std::fprintf(stderr, "example_pose_receiver: %s\n", to_line(receiver.error()).c_str());
    return 1;
  }
  const double seconds = argc > 2 ? std::atof(argv[2]) : 1e9;
  const auto begin = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - begin < std::chrono::duration<double>(seconds)) {
    receiver->wait(100);
    const auto newest = receiver->newest();
    if (!newest) continue;
    const auto& part = newest->world_from_part;
    const char* const known[] = {"no clearance is known", "clearance at least", "clearance"};
    std::printf("%8.3f s  part %8.4f %8.4f %8.4f m  force %6.2f %6.2f %6.2f N  lost %llu  %s",
                newest->time_s, part[0], part[1], part[2], newest->force_n[0], newest->force_n[1],
                newest->force_n[2], static_cast<unsigned long long>(receiver->lost()),
                known[newest->clearance_kind]);
    if (newest->clearance_kind > 0) std::printf(" %.3f mm", 1e3 * newest->clearance_m);
    // Whoever made the scene chose the name: it must not command the terminal.
    const std::string name = forcelayer::escaped(object_name_of(*newest));
    std::printf("%s%s\n", name.empty() ? "" : " to ", name.c_str());
    std::fflush(stdout);
  }
  return 0;
}
