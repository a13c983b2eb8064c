#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schema/model/record.h"
#include "schema/nexus_command/command.h"
#include "tests/support/certificates.h"
#include "tests/support/test_agent.h"

// Robots that share shapes and objects with each other over a real server, and what they hold.
namespace uplink::testing {

/// The RURI of a robot that `name` tells apart.
[[nodiscard]] std::string SharingRuri(std::string_view name);

[[nodiscard]] model::ReportedShape SharedShape(const std::string& id,
                                               model::ScopeType scope = model::ScopeType::kFleet);
[[nodiscard]] model::Object SharedObject(const std::string& id, double lat_deg = 1);

/// One robot: an agent that reports, and the table that it keeps of what others share.
class SharingRobot final {
 public:
  /// Connects and is welcomed; `session` continues one.
  SharingRobot(const std::shared_ptr<grpc::Channel>& channel, std::uint8_t session = 1,
               bool declines = false);

  /// Reports and waits until the server has stored it.
  void Report(const model::Body& body);
  /// Reports without waiting: some go out together, the rest with Settle.
  void Queue(const model::Body& body);

  /// Reads frames until the table holds these ids and nothing else; false if the stream ends before
  /// or its patience does. Of shapes and objects alike, as `<id>@<origin>`.
  [[nodiscard]] bool ReadUntilHolds(std::vector<std::string> ids);
  /// Reads up to the end of the next snapshot, or of the first.
  [[nodiscard]] bool ReadSnapshot();
  /// The next command; marks and other frames are passed over.
  [[nodiscard]] std::optional<nexus_command::Command> ReadCommand();
  /// Sends what is queued and reads until the server acks it; what is forwarded meanwhile is
  /// applied.
  [[nodiscard]] bool Settle();

  [[nodiscard]] std::vector<std::string> held() const;
  /// What is held under the id; null if nothing is.
  [[nodiscard]] const nexus_command::Command* At(const std::string& id) const;
  /// Whose it is, as the frame said.
  [[nodiscard]] std::string OriginOf(const std::string& id) const { return origins_.at(id); }
  [[nodiscard]] std::size_t snapshots() const { return snapshots_; }
  [[nodiscard]] bool declined_nothing() const { return forwards_ > 0; }
  [[nodiscard]] TestAgent& agent() { return agent_; }

 private:
  void Flush();
  /// One frame; false once the stream is over.
  bool ReadOne();
  void Apply(const v1::Forward& forward);

  TestAgent agent_;
  /// Reports that go out with the next batch.
  std::vector<Sent> queued_;
  model::Seq last_seq_ = 0;
  model::Seq settled_ = 0;
  std::size_t forwards_ = 0;
  std::size_t snapshots_ = 0;
  /// Seen since SNAPSHOT_BEGIN; nothing outside a snapshot.
  std::optional<std::map<std::string, nexus_command::Command>> snapshot_;
  std::map<std::string, nexus_command::Command> table_;
  std::map<std::string, std::string> origins_;
  std::optional<nexus_command::Command> last_;
};

}  // namespace uplink::testing
