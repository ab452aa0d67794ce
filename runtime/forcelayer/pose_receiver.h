// Receives the pose stream: for graphics on another core or machine.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "forcelayer/pose_datagram.h"
#include "formats/result.h"

namespace forcelayer {

class PoseReceiver {
 public:
  // Listens at UDP `port` of `address` (numeric; "0.0.0.0" or "::" for every interface); port 0
  // takes a free one. Errors: kUsage for no address, kReadFailed where it cannot be bound.
  static Result<PoseReceiver> open(std::uint16_t port, const std::string& address = "127.0.0.1");

  PoseReceiver(PoseReceiver&& other) noexcept;
  PoseReceiver& operator=(PoseReceiver&& other) noexcept;
  ~PoseReceiver();

  // Takes one of the datagrams that have arrived, without waiting: the next that is newer than what
  // was given before, or nothing.
  std::optional<PoseDatagram> next();

  // Takes everything that has arrived, without waiting. The newest datagram, or nothing where none
  // came that is newer than what was given before.
  std::optional<PoseDatagram> newest();

  // Waits for a datagram for at most `milliseconds`; whether one came.
  bool wait(int milliseconds) const;

  std::uint16_t port() const;
  std::uint64_t lost() const { return lost_; }        // gaps in the sequence
  std::uint64_t ignored() const { return ignored_; }  // that were no datagrams of ours, or older

 private:
  explicit PoseReceiver(int socket) : socket_(socket) {}
  bool accept(const PoseDatagram& datagram);

  int socket_ = -1;
  std::uint64_t session_ = 0, sequence_ = 0;
  std::uint64_t lost_ = 0, ignored_ = 0;
};

}  // namespace forcelayer
