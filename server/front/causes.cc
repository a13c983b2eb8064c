#include "server/front/causes.h"

namespace uplink::front {

using transport::TurnedAway;

TurnedAway CauseOf(TlsEngine::Failure failure) {
  switch (failure) {
    case TlsEngine::Failure::kNoTls:
      return TurnedAway::kNoTls;
    case TlsEngine::Failure::kNothingShared:
      return TurnedAway::kNothingShared;
    case TlsEngine::Failure::kNoCertificate:
      return TurnedAway::kNoCertificate;
    case TlsEngine::Failure::kUntrusted:
      return TurnedAway::kUntrusted;
    case TlsEngine::Failure::kCertificate:
      return TurnedAway::kCertificate;
    case TlsEngine::Failure::kNone:
    case TlsEngine::Failure::kOther:
      return TurnedAway::kHandshakeError;
  }
  return TurnedAway::kHandshakeError;
}

TurnedAway CauseOf(FrameKind kind) {
  switch (kind) {
    case FrameKind::kReset:
      return TurnedAway::kResets;
    case FrameKind::kPing:
      return TurnedAway::kPings;
    case FrameKind::kPong:
      return TurnedAway::kPongs;
    case FrameKind::kSettings:
      return TurnedAway::kSettings;
    case FrameKind::kEmptyData:
      return TurnedAway::kEmptyData;
    case FrameKind::kPriority:
      return TurnedAway::kPriorities;
    case FrameKind::kWindowUpdate:
      return TurnedAway::kWindowUpdates;
    case FrameKind::kUnknown:
      return TurnedAway::kUnknownFrames;
    case FrameKind::kHeaders:
      return TurnedAway::kHeaders;
    case FrameKind::kContinuation:
      return TurnedAway::kContinuations;
    case FrameKind::kKeyUpdate:
      return TurnedAway::kKeyUpdates;
  }
  return TurnedAway::kProtocol;
}

}  // namespace uplink::front
