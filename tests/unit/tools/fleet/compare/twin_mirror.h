#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/cyberwave/twin_state.h"
#include "tools/uplink-fleet/compare/stored.h"
#include "tools/uplink-fleet/twin/script.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

inline constexpr std::int64_t kTwinStartUs = 1'763'683'200'000'000;

/// A twin that lives for some minutes, and what the server's own rules make of what it publishes:
/// what a server that does everything right shows. Confined to one test.
class TwinMirror {
 public:
  /// 50 ms a message; everything is acked at the end.
  explicit TwinMirror(const TwinOptions& options, int messages = 6000);

  TwinScript twin;
  TwinLook look;
  StoredTwin stored;
  std::vector<v1::Quarantined> nobody;
  std::vector<Publication> published;
  /// Fields that live messages had to go without.
  std::uint64_t dropped = 0;

 private:
  struct Applier;
  void Take(const Publication& publication);
  void Reject(const Publication& publication, const cyberwave::Judgement& judgement);
  void Show(Side side);
  [[nodiscard]] StoredRobot& Of(Side side) {
    return stored.robots.at(static_cast<std::size_t>(side));
  }

  std::string prefix_;
  std::int64_t now_us_ = kTwinStartUs;
  std::array<std::unique_ptr<cyberwave::TwinState>, kSides> states_;
  std::map<std::string, v1::MissionRun> runs_;
};

}  // namespace uplink::synthetic
