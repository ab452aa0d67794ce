#include "runtime/viewer/run/live.h"

#include <charconv>

namespace forcelayer {

Result<PoseReceiver> listen_at(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  const std::string address = colon == std::string::npos ? "127.0.0.1" : text.substr(0, colon);
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  unsigned number = 0;
  const auto [end, code] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (code != std::errc{} || end != port.data() + port.size() || number > 65535) {
    return Error{ErrorCode::kUsage, "", "--listen", "'" + text + "' is no port",
                 "give PORT or ADDRESS:PORT, as 7000"};
  }
  return PoseReceiver::open(static_cast<std::uint16_t>(number), address);
}

TraceRow row_of(const PoseDatagram& datagram) {
  const auto& f = datagram.force_n;
  const auto& t = datagram.torque_nm;
  TraceRow row;
  row.time_s = datagram.time_s;
  row.world_from_part = pose_from_numbers(datagram.world_from_part);
  row.world_from_handle = pose_from_numbers(datagram.world_from_handle);
  row.world_from_target = pose_from_numbers(datagram.world_from_target);
  row.on_hand = {{f[0], f[1], f[2]}, {t[0], t[1], t[2]}};
  row.points_proximity = datagram.points_proximity;
  row.points_surface = datagram.points_surface;
  row.points_interior = datagram.points_interior;
  row.contacts = datagram.contacts;
  row.guard_cuts = (datagram.flags & kPoseGuardCut) != 0 ? 1 : 0;
  return row;
}

}  // namespace forcelayer
