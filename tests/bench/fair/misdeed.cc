#include "tests/bench/fair/misdeed.h"

namespace uplink::bench {

std::string NameOf(Misdeed misdeed) {
  switch (misdeed) {
    case Misdeed::kShapes:
      return "shapes";
    case Misdeed::kTexts:
      return "texts";
    case Misdeed::kControls:
      return "controls";
    case Misdeed::kMalformed:
      return "malformed";
    case Misdeed::kRejects:
      return "rejects";
    case Misdeed::kTakeover:
      return "takeover";
    case Misdeed::kExtras:
      return "extras";
    case Misdeed::kJoints:
      return "joints";
    case Misdeed::kGaps:
      return "gaps";
    case Misdeed::kMute:
      return "mute";
    case Misdeed::kGateway:
      return "gateway";
  }
  return "";
}

std::string_view AboutOf(Misdeed misdeed) {
  switch (misdeed) {
    case Misdeed::kShapes:
      return "shapes of 256 KiB, as fast as they are read";
    case Misdeed::kTexts:
      return "10 Mbit/s of messages for people";
    case Misdeed::kControls:
      return "10 Mbit/s of control characters in messages and settings";
    case Misdeed::kMalformed:
      return "malformed payloads, as fast as they are read";
    case Misdeed::kRejects:
      return "reconnects without a pause, thousands of Rejects unconfirmed";
    case Misdeed::kTakeover:
      return "two connections that take over from each other without a pause";
    case Misdeed::kExtras:
      return "256 faulty readings per extras message, as fast as they are read";
    case Misdeed::kJoints:
      return "an RCAN state of 256 new joints every 100 ms, while robots are scraped";
    case Misdeed::kGaps:
      return "every number skips some, every other one 2^32";
    case Misdeed::kMute:
      return "malformed payloads and events, and no Ack or Reject is read";
    case Misdeed::kGateway:
      return "50 streams of events through one gateway, as fast as they are read";
  }
  return "";
}

std::optional<Misdeed> MisdeedOf(std::string_view name) {
  for (const Misdeed misdeed : kMisdeeds) {
    if (NameOf(misdeed) == name) return misdeed;
  }
  return std::nullopt;
}

}  // namespace uplink::bench
