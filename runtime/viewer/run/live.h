// Moments of a run that is going on elsewhere, from its pose stream.
#pragma once

#include <string>

#include "forcelayer/pose_receiver.h"
#include "formats/result.h"
#include "runtime/viewer/run/trace.h"

namespace forcelayer {

// Opens "PORT" or "ADDRESS:PORT". Errors: kUsage, kReadFailed.
Result<PoseReceiver> listen_at(const std::string& text);

// A datagram as a row of a trace.
TraceRow row_of(const PoseDatagram& datagram);

}  // namespace forcelayer
