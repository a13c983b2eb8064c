#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/audit.h"

namespace uplink::storage {

/// Certificates and keys that are revoked at a time.
inline constexpr std::size_t kRevocationsMax = 100'000;
/// Robots for which operators have set something, at a time.
inline constexpr std::size_t kSettingsMax = 100'000;
/// Rows that one answer of the readers below names.
inline constexpr std::size_t kAccessPageMax = 10'000;
/// Rows that stay of revocations that were taken back, and as many of settings, so that every
/// server learns it: the newest, whatever any clock says. More than servers miss between two looks;
/// one that could not look, and one that starts, reads from version 0.
inline constexpr std::size_t kTakenBackKept = 1'000;
/// Labels of one robot, and bytes of each name and value.
inline constexpr std::size_t kLabelsMax = 16;
inline constexpr std::size_t kLabelBytesMax = 64;
inline constexpr std::size_t kNoteBytesMax = 1'024;
/// Bytes of a reason, and of what a revocation names.
inline constexpr std::size_t kReasonBytesMax = 512;
inline constexpr std::size_t kRevokedValueBytesMax = 2'048;

/// Ascends with the changes of what AccessStore keeps, over all of it. 0: nothing was ever changed.
/// One below what a server has seen: the store went back, and the server reads from 0.
using AccessVersion = std::uint64_t;

/// What a revocation names. Closed; stored by number.
enum class RevokedBy : std::uint8_t {
  /// Issuer and serial: `SERIAL ISSUER`, the serial in upper-case hexadecimal, the issuer as RFC
  /// 2253.
  kIssuerSerial = 0,
  /// SHA-256 of the certificate (DER), 64 lower-case hexadecimal digits.
  kCertificate = 1,
  /// SHA-256 of its public key (SPKI, DER, the point uncompressed), the same.
  kKey = 2,
};

/// Every kind, in number order.
inline constexpr std::array kAllRevokedBy = {RevokedBy::kIssuerSerial, RevokedBy::kCertificate,
                                             RevokedBy::kKey};

/// A certificate or key that may not come in, or that may again. A value.
struct Revocation {
  RevokedBy by = RevokedBy::kCertificate;
  std::string value;
  /// False: it was taken back.
  bool revoked = true;
  SystemTime at;
  std::string who;
  std::string reason;
  /// Of the change that made it so.
  AccessVersion version = 0;

  friend bool operator==(const Revocation&, const Revocation&) = default;
};

/// What operators set of one robot, known or not. A value; with nothing set, all was taken back.
struct RobotSetting {
  std::string ruri;
  bool blocked = false;
  std::string blocked_why{};
  std::string blocked_by{};
  std::optional<SystemTime> blocked_at{};
  /// An operator added it: it may come in where registration is closed.
  bool registered = false;
  std::map<std::string, std::string> labels{};
  std::string note{};
  /// An operator asked at this time that its streams end; they may come again.
  std::optional<SystemTime> disconnect_at{};
  AccessVersion version = 0;

  friend bool operator==(const RobotSetting&, const RobotSetting&) = default;
};

/// A change of one robot's setting: what is set here is changed, the rest stays.
struct SettingChange {
  std::string ruri;
  std::optional<bool> blocked{};
  std::string blocked_why{};
  std::optional<bool> registered{};
  /// Labels by name; an empty value removes the label.
  std::map<std::string, std::string> labels{};
  std::optional<std::string> note{};
  /// Its streams end (disconnect_at).
  bool disconnect = false;
};

/// What a change came to. A value.
struct ChangedSetting {
  /// As it is now.
  RobotSetting setting;
  /// False: it was so before.
  bool changed = false;
};

/// A fault that an operator has seen: all active rows of the robot with that id, of any source.
struct Acknowledgement {
  std::string ruri;
  std::string fault_id;
  std::string note;
};

/// What operators decide about who may come in, and what they note: the same for all servers that
/// share the store. Each change and its audit row are one transaction; `audit.at` is its time and
/// `audit.who` who made it. What is so already is not written
/// again, and leaves no audit row.
///
/// Errors: as in Store: a status means that nothing of the call is known. Calling again is right.
///         kResourceExhausted: a bound is reached. kInvalidArgument, naming the field: a text is
///         empty, too long, or no UTF-8. kNotFound: no such active fault. Of these three nothing is
///         kept, not even the audit row.
/// Thread: confined to one thread at a time, together with what shares its connection.
class AccessStore {
 public:
  virtual ~AccessStore() = default;

  // --- Servers ---

  /// Cheap: asked each half second. A version is seen only once all earlier ones are.
  [[nodiscard]] virtual absl::StatusOr<AccessVersion> Version() = 0;
  /// Those whose version is above `after`, ascending, at most kAccessPageMax; fewer: there are no
  /// more.
  [[nodiscard]] virtual absl::StatusOr<std::vector<Revocation>> RevocationsAfter(
      AccessVersion after) = 0;
  [[nodiscard]] virtual absl::StatusOr<std::vector<RobotSetting>> SettingsAfter(
      AccessVersion after) = 0;

  // --- Operators ---

  /// Sets or takes back (`revocation.revoked`); its `at`, `who` and `version` are not read. Returns
  /// whether it was not so before.
  [[nodiscard]] virtual absl::StatusOr<bool> Revoke(const Revocation& revocation,
                                                    const AuditRow& audit) = 0;
  [[nodiscard]] virtual absl::StatusOr<ChangedSetting> Change(const SettingChange& change,
                                                              const AuditRow& audit) = 0;
  /// Each one is new, with its time. The next raise of the fault clears it.
  [[nodiscard]] virtual absl::Status Acknowledge(const Acknowledgement& fault,
                                                 const AuditRow& audit) = 0;
  /// Of what happened elsewhere.
  [[nodiscard]] virtual absl::Status Append(const AuditRow& audit) = 0;
};

}  // namespace uplink::storage
