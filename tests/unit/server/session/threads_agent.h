#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "tests/support/fake_database.h"
#include "tests/unit/server/session/session_bench.h"

namespace uplink::session {

/// What the agent does when the server reads, and right after.
struct Move {
  enum class Kind : std::uint8_t { kWait, kSend, kHalfClose };
  enum class Then : std::uint8_t { kGoOn, kBreak, kTakeOver };
  Kind kind = Kind::kWait;
  v1::RelayRequest frame;
  Then then = Then::kGoOn;
};

/// An agent with one stream at a time, on whichever thread it connected last; frames of older
/// streams are not its own any more. It keeps durable messages until their Ack, and checks what the
/// protocol promises it.
///
/// Thread: thread-safe.
class ThreadsAgent final {
 public:
  /// It sends `messages_max` messages, those sent again not counted.
  ThreadsAgent(std::string ruri, std::uint64_t seed, std::size_t messages_max,
               const testing::FakeDatabase& database)
      : ruri_(std::move(ruri)), messages_max_(messages_max), database_(database), random_(seed) {}

  [[nodiscard]] const std::string& ruri() const { return ruri_; }

  /// The stream becomes the agent's; its Hello. Nothing once all is done.
  [[nodiscard]] std::optional<v1::RelayRequest> Connect(std::uint64_t stream);
  /// The server reads.
  [[nodiscard]] Move Ask(std::uint64_t stream);
  void OnFrame(std::uint64_t stream, const v1::RelayResponse& frame);
  /// Whether the agent connects again.
  [[nodiscard]] bool OnEnd(std::uint64_t stream, const absl::Status& status);

  /// Everything was sent and acked, and the last stream ended OK.
  [[nodiscard]] bool finished() const;
  /// Everything sent lies in the store once, and nothing else does.
  void CheckStore() const;
  /// One line, for a failure.
  [[nodiscard]] std::string State() const;

 private:
  /// One numbering as it would lie on the robot's disk.
  struct Numbering {
    model::SessionId id;
    model::Seq next = 1;
    model::Seq settled = 0;
    model::Seq judged = 0;
    /// The payloads that wait for an Ack.
    std::map<model::Seq, const std::string*> kept;
    std::set<model::Seq> good;
    std::set<model::Seq> bad;
    /// Bad and live: sent once, perhaps into a stream that broke.
    std::set<model::Seq> bad_live;
    std::set<model::Seq> told;
  };

  Numbering& Current() { return sessions_[session_]; }
  [[nodiscard]] bool KeepsNothing() const;
  bool Percent(std::uint64_t percent) { return random_() % 100 < percent; }
  void ChooseSession();
  Message Fresh();
  void OnWelcome(model::Seq committed);
  void OnAck(const v1::Ack& ack);

  const std::string ruri_;
  const std::size_t messages_max_;
  const testing::FakeDatabase& database_;
  mutable std::mutex mutex_;
  std::mt19937_64 random_;
  std::vector<Numbering> sessions_;
  std::size_t session_ = 0;
  std::size_t sent_ = 0;
  std::size_t connects_ = 0;
  std::uint64_t active_ = 0;
  bool welcomed_ = false;
  bool half_closed_ = false;
  bool finished_ = false;
  model::Seq through_ = 0;
  model::Seq judged_ = 0;
  std::set<model::Seq> resend_;
  /// Bad, sent first on this stream, and not rejected yet.
  std::set<model::Seq> unrejected_;
};

}  // namespace uplink::session
