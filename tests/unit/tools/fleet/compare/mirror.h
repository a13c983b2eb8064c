#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "schema/judge.h"
#include "tools/uplink-fleet/compare/stored.h"
#include "tools/uplink-fleet/robot/account.h"
#include "tools/uplink-fleet/robot/script.h"

namespace uplink::synthetic {

inline constexpr const char* kRuri = "rcan://test/robot-0001";
inline constexpr const char* kSession = "07000000000000000000000000000000";
inline constexpr const char* kRun = "run1";
inline constexpr std::int64_t kStartMs = 1'763'683'200'000;

/// A robot that lives for some minutes, and what a server that does everything right shows of it.
class Mirror {
 public:
  /// 0.1 s a tick; everything is acked at the end.
  explicit Mirror(double malformed_share = 0.05, int ticks = 1800);

  RobotOutcome robot;
  StoredRobot stored;
  v1::Robot live;
  /// The clock at the end.
  std::int64_t now_ms = kStartMs;
  /// Messages sent, by variant.
  std::map<model::Variant, std::uint64_t> sent;

 private:
  void Take(const Outgoing& message);
  void Show(const model::Body& body);
  void ShowRow(const model::Body& body);
  void ShowLatest(const model::Body& body);
  void ShowLive(const model::Body& body);
  void Expire();

  schema::Judge judge_{schema::JudgeLimits()};
  model::Seq seq_ = 0;
  std::map<std::pair<std::string, std::string>, v1::Fault> active_;
  std::map<std::pair<std::string, std::string>, v1::MissionRun> runs_;
  std::map<std::string, v1::Shape> shapes_;
  std::map<std::string, v1::TrackedObject> objects_;
};

}  // namespace uplink::synthetic
