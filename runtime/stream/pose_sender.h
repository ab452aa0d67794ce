// Sends the pose stream. Not for the loop's thread, though it never blocks.
#pragma once

#include <cstdint>
#include <string>

#include "forcelayer/frame.h"
#include "forcelayer/pose_datagram.h"
#include "formats/result.h"
#include "runtime/model/simulation.h"

namespace forcelayer::stream {

class PoseSender {
 public:
  static constexpr double kRateHz = 60;

  // `target` is PORT, HOST:PORT or [HOST]:PORT; without a host 127.0.0.1. `rate_hz`: datagrams a
  // second, above 0. `simulation` must outlive the sender. Errors: kUsage for anything that is no
  // address; kInternal where the system has no socket.
  static Result<PoseSender> create(const std::string& target, const model::Simulation& simulation,
                                   double rate_hz = kRateHz);

  PoseSender(PoseSender&& other) noexcept;
  PoseSender& operator=(PoseSender&& other) noexcept;
  ~PoseSender();

  // Offers a frame: it is sent if the last one went out a period ago. Losses are no errors.
  void offer(const Frame& frame) noexcept;

 private:
  PoseSender(int socket, const model::Simulation& simulation, double rate_hz);
  PoseDatagram datagram(const Frame& frame) noexcept;

  int socket_ = -1;
  const model::Simulation* simulation_;
  long long period_ns_;
  std::uint64_t session_;
  std::uint64_t sequence_ = 0;
  long long next_ns_ = 0;
};

}  // namespace forcelayer::stream
