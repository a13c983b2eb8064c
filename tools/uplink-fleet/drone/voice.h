#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <google/protobuf/message.h>

#include "tools/uplink-fleet/drone/account.h"
#include "tools/uplink-fleet/drone/call.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

/// A request in the making. Its number and time are in no other of its drone.
struct AvatarDraft {
  std::unique_ptr<google::protobuf::Message> request;
  AvatarCall call;
  std::int64_t time_us = 0;

  [[nodiscard]] std::int64_t time_ms() const { return time_us / 1000; }
};

/// How a drone's requests begin: numbers, metadata, names.
///
/// Units:  times are Unix microseconds; no two drafts have the same millisecond.
/// Thread: confined to one thread.
class DroneVoice final {
 public:
  explicit DroneVoice(const DroneOptions& options) : options_(options) {}

  /// Time never goes back, whatever the clock does.
  void SetNow(std::int64_t now_us);

  /// A request of this type with its metadata, and what `json` says; in its texts `1..9` becomes a
  /// number between, `a|b` one of both (twin/filling.h), `{number}` its number, `{key}` the key.
  [[nodiscard]] AvatarDraft Begin(std::string_view type, std::size_t line, std::string_view json,
                                  Seeded& chance, std::uint32_t key = 0);
  /// The call of the finished draft.
  [[nodiscard]] static AvatarCall Finish(AvatarDraft draft);

  [[nodiscard]] const DroneOptions& options() const { return options_; }
  /// A name that no other run, and nothing else of this drone, has.
  [[nodiscard]] std::string IdOf(std::string_view what, const AvatarDraft& draft) const;
  [[nodiscard]] Seeded ChanceOf(std::uint64_t salt) const {
    return Seeded(Seeded(options_.seed ^ (salt << 32U)).Next() + options_.index);
  }

 private:
  const DroneOptions options_;
  std::uint64_t last_number_ = 0;
  std::int64_t now_us_ = 0;
  std::int64_t boot_us_ = 0;
};

/// What the parts of a drone's script speak with; both outlive them.
struct DroneSpeech {
  DroneVoice& voice;
  DroneAccount& account;
};

}  // namespace uplink::synthetic
