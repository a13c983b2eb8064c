#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/admin/asker.h"
#include "server/admin/audit_rows.h"
#include "server/admin/audit_trail.h"
#include "server/admin/command_rate.h"
#include "server/admin/shared_store.h"
#include "storage/reader.h"
#include "uplink/v1/admin.pb.h"

namespace uplink::admin {

/// What became of a configuration that was read again. A value.
struct Reloaded {
  /// Keys that were taken over.
  std::vector<std::string> taken_over;
  /// Keys that changed and need a restart.
  std::vector<std::string> needs_restart;
  /// Why nothing was taken over; none: it was.
  std::vector<std::string> problems;
};
/// As the audit's detail: the keys that were taken over, or the problems.
[[nodiscard]] std::string DetailOf(const Reloaded& reloaded);

/// The service FleetAdmin, once for every transport: what operators decide, and the audit. The
/// transport has judged the caller's role by the table of rights; the commands judge its scope. A
/// robot that is out of scope is unknown, and a caller without all fleets decides only about robots
/// that are known.
///
/// Each command leaves an audit row and a line `audit`, also where it is refused; one that asks for
/// what is so already writes nothing, and leaves neither.
///
/// Errors: kInvalidArgument, whose message begins with the field's JSON name; kNotFound for what is
///         unknown; kResourceExhausted at a bound, with RetryAfterOf past CommandRate; those of the
///         store, kUnavailable above all: then it is unknown whether it was done, and asking again
///         is right.
/// Thread: thread-safe. All wait for the store, so never on a thread that serves others.
class Commands final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    SharedStore& store;
    AuditTrail& audit;
    /// storage::Reader::Audit.
    std::function<absl::StatusOr<storage::Page<storage::AuditRow>>(const storage::AuditQuery&)>
        rows_of_audit{};
    /// The fleet of a robot that is known; nothing: it is not. Any thread. Empty: every robot is
    /// unknown.
    std::function<std::optional<std::string>(std::string_view ruri)> fleet_of{};
    /// A robot that is known has no stream, only calls. Any thread. Empty: none is so.
    std::function<bool(std::string_view ruri)> only_calls{};
    /// The store has something new, which servers look for by themselves too. Any thread; may be
    /// empty.
    std::function<void()> changed{};
    /// Reads the configuration again, and waits for the outcome. kUnavailable: the server starts or
    /// stops. Empty: there is no server.
    std::function<absl::StatusOr<Reloaded>()> reload{};
  };
  explicit Commands(Context context);
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  // About one robot.
  [[nodiscard]] absl::StatusOr<v1::RobotSetting> BlockRobot(const Asker& asker,
                                                            const v1::BlockRobotRequest& request);
  [[nodiscard]] absl::StatusOr<v1::RobotSetting> UnblockRobot(
      const Asker& asker, const v1::UnblockRobotRequest& request);
  /// kFailedPrecondition for a twin, whose broker's connection is shared, and for a drone, whose
  /// calls end by themselves.
  [[nodiscard]] absl::StatusOr<v1::RobotSetting> DisconnectRobot(
      const Asker& asker, const v1::DisconnectRobotRequest& request);
  [[nodiscard]] absl::StatusOr<v1::RobotSetting> NoteRobot(const Asker& asker,
                                                           const v1::NoteRobotRequest& request);
  [[nodiscard]] absl::StatusOr<v1::RobotSetting> AddRobot(const Asker& asker,
                                                          const v1::AddRobotRequest& request);
  [[nodiscard]] absl::StatusOr<v1::FaultAcknowledgement> AcknowledgeFault(
      const Asker& asker, const v1::AcknowledgeFaultRequest& request);

  // About certificates and keys, of all robots.
  [[nodiscard]] absl::StatusOr<v1::Revocation> RevokeCertificate(
      const Asker& asker, const v1::RevokeCertificateRequest& request);
  [[nodiscard]] absl::StatusOr<v1::Revocation> UnrevokeCertificate(
      const Asker& asker, const v1::UnrevokeCertificateRequest& request);
  [[nodiscard]] absl::StatusOr<v1::ListRevocationsResponse> ListRevocations(
      const v1::ListRevocationsRequest& request);

  // About the whole server.
  [[nodiscard]] absl::StatusOr<v1::ListAuditResponse> ListAudit(
      const v1::ListAuditRequest& request);
  [[nodiscard]] absl::StatusOr<v1::ReloadResponse> Reload(const Asker& asker,
                                                          const v1::ReloadRequest& request);

  /// Something that its role or scope forbids was asked: `action` is that of the command, `target`
  /// what it was about, if that was read. Never waits.
  void NoteForbidden(const Asker& asker, std::string_view action, std::string_view target);

 private:
  /// Sets the fleet of the deed's robot. Errors: its RURI is none, or the caller must not know it.
  [[nodiscard]] absl::Status JudgeRobot(const Asker& asker, Deed& deed) const;
  /// What a command came to. A value.
  template <typename Answer>
  struct Done {
    Answer answer;
    /// False: it was so already.
    bool changed = true;
  };
  /// Writes by `write`, which returns a Done, unless the verdict or the rate forbids it; tells and
  /// notes what came of it.
  template <typename Answer, typename Write>
  [[nodiscard]] absl::StatusOr<Answer> Do(const Asker& asker, const Deed& deed,
                                          absl::Status verdict, const Write& write);
  /// The same of one robot's setting. `verdict` is that of the request's other fields.
  [[nodiscard]] absl::StatusOr<v1::RobotSetting> Change(const Asker& asker, Deed deed,
                                                        storage::SettingChange change,
                                                        absl::Status verdict = absl::OkStatus());
  [[nodiscard]] absl::StatusOr<v1::Revocation> Revoke(
      const Asker& asker, Deed deed, absl::StatusOr<storage::Revocation> revocation);

  const Context context_;
  CommandRate rate_;
};

}  // namespace uplink::admin
