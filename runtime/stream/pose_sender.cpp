#include "runtime/stream/pose_sender.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <memory>
#include <utility>

#include "runtime/machine/real_time.h"

namespace forcelayer::stream {
namespace {

struct HostAndPort {
  std::string host = "127.0.0.1", port;
};

HostAndPort split_target(const std::string& target) {
  const auto colon = target.rfind(':');
  if (colon == std::string::npos) return {.port = target};
  std::string host = target.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  return {host, target.substr(colon + 1)};
}

bool is_port(const std::string& text) {
  std::uint16_t port = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), port);
  return failure == std::errc{} && end == text.data() + text.size() && port > 0;
}

Error address_error(const std::string& target, const char* what) {
  return {ErrorCode::kUsage, "", "--udp", "'" + target + "' is not an address: " + what,
          "write it like 127.0.0.1:7000"};
}

std::uint64_t now_us() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(
                                        std::chrono::system_clock::now().time_since_epoch())
                                        .count());
}

}  // namespace

Result<PoseSender> PoseSender::create(const std::string& target,
                                      const model::Simulation& simulation, double rate_hz) {
  const HostAndPort address = split_target(target);
  if (!is_port(address.port)) return address_error(target, "the port is not between 1 and 65535");
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int failure = getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &found);
      failure != 0) {
    return address_error(target, gai_strerror(failure));
  }
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> list(found, freeaddrinfo);
  const int descriptor = socket(found->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0 || connect(descriptor, found->ai_addr, found->ai_addrlen) != 0) {
    const std::string reason = std::strerror(errno);
    if (descriptor >= 0) close(descriptor);
    return Error{ErrorCode::kInternal, "", "--udp",
                 "cannot open a socket to '" + target + "': " + reason, ""};
  }
  return PoseSender(descriptor, simulation, rate_hz);
}

PoseSender::PoseSender(int socket, const model::Simulation& simulation, double rate_hz)
    : socket_(socket),
      simulation_(&simulation),
      period_ns_(static_cast<long long>(1e9 / rate_hz)),
      session_(now_us()) {}

PoseSender::PoseSender(PoseSender&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      simulation_(other.simulation_),
      period_ns_(other.period_ns_),
      session_(other.session_),
      sequence_(other.sequence_),
      next_ns_(other.next_ns_) {}

PoseSender& PoseSender::operator=(PoseSender&& other) noexcept {
  std::swap(socket_, other.socket_);
  simulation_ = other.simulation_;
  period_ns_ = other.period_ns_;
  session_ = other.session_;
  sequence_ = other.sequence_;
  next_ns_ = other.next_ns_;
  return *this;
}

PoseSender::~PoseSender() {
  if (socket_ >= 0) close(socket_);
}

PoseDatagram PoseSender::datagram(const Frame& frame) noexcept {
  const StepReport& report = frame.result.report;
  const Wrench& wrench = frame.result.wrench;
  PoseDatagram d{};
  d.magic = kPoseMagic;
  d.version = kPoseVersion;
  d.bytes = sizeof d;
  d.session = session_;
  d.sequence = ++sequence_;
  d.frame = frame.number;
  d.time_s = frame.time_s;
  d.world_from_part = pose_numbers(simulation_->world_from_part(report.world_from_center));
  d.world_from_handle = pose_numbers(frame.input.world_from_handle);
  d.world_from_target = pose_numbers(simulation_->world_from_part(frame.world_from_target));
  for (int axis = 0; axis < 3; ++axis) {
    d.force_n[static_cast<std::size_t>(axis)] = wrench.force_n[axis];
    d.torque_nm[static_cast<std::size_t>(axis)] = wrench.torque_nm[axis];
  }
  d.points_proximity = report.proximity;
  d.points_surface = report.surface;
  d.points_interior = report.interior;
  d.contacts = report.contacts;
  d.output = static_cast<std::uint32_t>(frame.output);
  d.flags = (report.guard_cuts > 0 ? kPoseGuardCut : 0u) |
            (report.outside_map != 0 ? kPoseOutsideMap : 0u) |
            (report.faults != 0 ? kPoseFaulty : 0u) | (report.saturated != 0 ? kPoseSaturated : 0u);
  d.clearance_m = report.clearance_m;
  d.clearance_kind = static_cast<std::uint32_t>(report.clearance_kind);
  d.nearest_object = report.nearest_object;
  for (int axis = 0; axis < 3; ++axis) {
    d.nearest_point_m[static_cast<std::size_t>(axis)] = report.nearest_point_m[axis];
  }
  set_object_name(d, simulation_->voxmap().object_name(report.nearest_object));
  return d;
}

void PoseSender::offer(const Frame& frame) noexcept {
  const long long now_ns = machine::monotonic_ns();
  if (now_ns < next_ns_) return;
  // In step with the clock, but never two at once to make up for a pause.
  next_ns_ += period_ns_;
  if (next_ns_ <= now_ns) next_ns_ = now_ns + period_ns_;
  const PoseDatagram d = datagram(frame);
  // Nobody listening, a full buffer: the next datagram replaces this one anyway.
  static_cast<void>(send(socket_, &d, sizeof d, MSG_NOSIGNAL));
}

}  // namespace forcelayer::stream
