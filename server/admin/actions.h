#pragma once

#include <array>
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

/// All of them.
inline constexpr auto kActions = std::to_array<std::string_view>(
    {kRobotBlock, kRobotUnblock, kRobotDisconnect, kRobotNote, kRobotAdd, kRobotRemove,
     kFaultAcknowledge, kCertificateRevoke, kCertificateUnrevoke, kReload, kServerStart,
     kServerStop, kFirstUse, kRobotForget, kClockConfirm, kRobotMove});

/// AuditRow::outcome of what was done.
inline constexpr std::string_view kOutcomeOk = "ok";

}  // namespace uplink::admin
