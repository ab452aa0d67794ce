#include "forcelayer/pose_receiver.h"

#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

namespace forcelayer {
namespace {

constexpr std::size_t kLargestDatagram = 2048;  // longer than any of ours

}  // namespace

Result<PoseReceiver> PoseReceiver::open(std::uint16_t port, const std::string& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  addrinfo* found = nullptr;
  if (getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) {
    return Error{ErrorCode::kUsage, "", "", "'" + address + "' is not a numeric address", ""};
  }
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> list(found, freeaddrinfo);
  const int descriptor = socket(found->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0 || bind(descriptor, found->ai_addr, found->ai_addrlen) != 0) {
    const int reason = errno;
    if (descriptor >= 0) close(descriptor);
    const bool elsewhere = reason == EADDRNOTAVAIL;
    return Error{ErrorCode::kReadFailed, "", "UDP " + address + " port " + std::to_string(port),
                 std::string("cannot be opened: ") + std::strerror(reason),
                 elsewhere ? "use an address of this machine" : "choose another port"};
  }
  return PoseReceiver(descriptor);
}

PoseReceiver::PoseReceiver(PoseReceiver&& other) noexcept { *this = std::move(other); }

PoseReceiver& PoseReceiver::operator=(PoseReceiver&& other) noexcept {
  std::swap(socket_, other.socket_);
  session_ = other.session_;
  sequence_ = other.sequence_;
  lost_ = other.lost_;
  ignored_ = other.ignored_;
  return *this;
}

PoseReceiver::~PoseReceiver() {
  if (socket_ >= 0) close(socket_);
}

bool PoseReceiver::accept(const PoseDatagram& d) {
  const bool newer_run = d.session > session_;
  if (!newer_run && (d.session < session_ || d.sequence <= sequence_)) return false;
  if (!newer_run) lost_ += d.sequence - sequence_ - 1;
  session_ = d.session;
  sequence_ = d.sequence;
  return true;
}

std::optional<PoseDatagram> PoseReceiver::next() {
  std::byte bytes[kLargestDatagram];
  for (;;) {
    const ssize_t size = recv(socket_, bytes, sizeof bytes, MSG_TRUNC);
    if (size < 0) return std::nullopt;
    const auto d = static_cast<std::size_t>(size) <= sizeof bytes
                       ? parse_pose_datagram({bytes, static_cast<std::size_t>(size)})
                       : std::nullopt;
    if (d && accept(*d)) return d;
    ++ignored_;
  }
}

std::optional<PoseDatagram> PoseReceiver::newest() {
  std::optional<PoseDatagram> newest;
  while (const auto d = next()) newest = d;
  return newest;
}

bool PoseReceiver::wait(int milliseconds) const {
  pollfd waiting{socket_, POLLIN, 0};
  return poll(&waiting, 1, milliseconds) > 0;
}

std::uint16_t PoseReceiver::port() const {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0) return 0;
  if (address.ss_family == AF_INET6) {
    return ntohs(reinterpret_cast<const sockaddr_in6*>(&address)->sin6_port);
  }
  return ntohs(reinterpret_cast<const sockaddr_in*>(&address)->sin_port);
}

}  // namespace forcelayer
