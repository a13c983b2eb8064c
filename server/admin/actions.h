#pragma once

#include <array>
#include <cstdint>
#include <string_view>

// The words of AuditRow::action. docs/reference/audit.md lists them.
namespace uplink::admin {

inline constexpr std::string_view kRobotBlock = "robot_block";
inline constexpr std::string_view kRobotUnblock = "robot_unblock";
inline constexpr std::string_view kRobotDisconnect = "robot_disconnect";
inline constexpr std::string_view kRobotNote = "robot_note";
inline constexpr std::string_view kRobotAdd = "robot_add";
inline constexpr std::string_view kRobotRemove = "robot_remove";
inline constexpr std::string_view kFaultAcknowledge = "fault_acknowledge";
inline constexpr std::string_view kCertificateRevoke = "certificate_revoke";
inline constexpr std::string_view kCertificateUnrevoke = "certificate_unrevoke";
inline constexpr std::string_view kReload = "reload";
// What no command does.
inline constexpr std::string_view kServerStart = "server_start";
inline constexpr std::string_view kServerStop = "server_stop";
inline constexpr std::string_view kFirstUse = "first_use";
inline constexpr std::string_view kRobotForget = "robot_forget";
inline constexpr std::string_view kClockConfirm = "clock_confirm";
inline constexpr std::string_view kRobotMove = "robot_move";

/// Who may give the command. Closed.
enum class GivenBy : std::uint8_t {
  kOperators,
  kAdmins,
  /// No command of the API does it.
  kNone,
};

/// A word and its class. A value.
struct Action {
  std::string_view word;
  GivenBy given_by = GivenBy::kNone;
};

/// All of them.
inline constexpr auto kActions = std::to_array<Action>({
    {kRobotBlock, GivenBy::kOperators},
    {kRobotUnblock, GivenBy::kOperators},
    {kRobotDisconnect, GivenBy::kOperators},
    {kRobotNote, GivenBy::kOperators},
    {kRobotAdd, GivenBy::kOperators},
    {kRobotRemove, GivenBy::kOperators},
    {kFaultAcknowledge, GivenBy::kOperators},
    {kCertificateRevoke, GivenBy::kAdmins},
    {kCertificateUnrevoke, GivenBy::kAdmins},
    {kReload, GivenBy::kAdmins},
    {kServerStart, GivenBy::kNone},
    {kServerStop, GivenBy::kNone},
    {kFirstUse, GivenBy::kNone},
    {kRobotForget, GivenBy::kNone},
    {kClockConfirm, GivenBy::kNone},
    {kRobotMove, GivenBy::kNone},
});

/// kNone for a word that is none of them.
[[nodiscard]] constexpr GivenBy GivenByOf(std::string_view word) {
  for (const Action& each : kActions) {
    if (each.word == word) return each.given_by;
  }
  return GivenBy::kNone;
}

/// AuditRow::outcome of what was done.
inline constexpr std::string_view kOutcomeOk = "ok";

}  // namespace uplink::admin
