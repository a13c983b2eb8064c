#include "server/admin/commands.h"

#include <map>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <fmt/format.h>

#include "server/admin/actions.h"
#include "server/admin/checks.h"
#include "server/admin/messages.h"
#include "server/identity/ruri.h"
#include "server/view/timestamps.h"

namespace uplink::admin {
namespace {

using storage::AccessStore;
using storage::AuditRow;

/// `a=b, c removed, note: x`
std::string DetailOf(const v1::NoteRobotRequest& request) {
  const std::map<std::string, std::string> labels(request.labels().begin(), request.labels().end());
  std::string text;
  const auto add = [&text](const std::string& part) {
    if (!text.empty()) text += ", ";
    text += part;
  };
  for (const auto& [name, value] : labels) {
    add(value.empty() ? name + " removed" : fmt::format("{}={}", name, value));
  }
  if (request.has_note()) add("note: " + request.note());
  return text;
}

std::optional<SystemTime> TimeOf(bool has, const google::protobuf::Timestamp& time) {
  if (!has) return std::nullopt;
  return FromUnixMs(view::UnixMs(time));
}

}  // namespace

std::string DetailOf(const Reloaded& reloaded) {
  if (!reloaded.problems.empty()) return fmt::format("{}", fmt::join(reloaded.problems, "; "));
  return fmt::format("{}", fmt::join(reloaded.taken_over, ", "));
}

Commands::Commands(Context context) : context_(std::move(context)) {}

absl::Status Commands::JudgeRobot(const Asker& asker, Deed& deed) const {
  if (absl::Status checked = CheckRuri(deed.target); !checked.ok()) return checked;
  const std::optional<std::string> fleet =
      context_.fleet_of ? context_.fleet_of(deed.target) : std::nullopt;
  const identity::Scope& scope = asker.caller.scope;
  if (!scope.all() && !(fleet && scope.Has(*fleet))) {
    return absl::NotFoundError(
        fmt::format("this server has no robot with the RURI {} now", deed.target));
  }
  deed.fleet = fleet.value_or("");
  return absl::OkStatus();
}

template <typename Answer, typename Write>
absl::StatusOr<Answer> Commands::Do(const Asker& asker, const Deed& deed, absl::Status verdict,
                                    const Write& write) {
  const SystemTime now = context_.clock.System();
  if (verdict.ok()) verdict = rate_.Take(asker, deed.action, context_.clock.Steady());
  if (verdict.ok()) {
    const AuditRow row = RowOf(asker, deed, absl::OkStatus(), now);
    absl::StatusOr<Done<Answer>> done =
        context_.store.With([&](AccessStore& store) { return write(store, row); });
    if (done.ok()) {
      if (done->changed) {
        context_.audit.Tell(row);
        if (context_.changed) context_.changed();
      }
      return std::move(done->answer);
    }
    verdict = done.status();
  }
  context_.audit.NoteRefused(RowOf(asker, deed, verdict, now));
  return verdict;
}

absl::StatusOr<v1::RobotSetting> Commands::Change(const Asker& asker, Deed deed,
                                                  storage::SettingChange change,
                                                  absl::Status verdict) {
  change.ruri = deed.target;
  if (absl::Status judged = JudgeRobot(asker, deed); !judged.ok()) verdict = std::move(judged);
  return Do<v1::RobotSetting>(
      asker, deed, std::move(verdict),
      [&](AccessStore& store, const AuditRow& row) -> absl::StatusOr<Done<v1::RobotSetting>> {
        const absl::StatusOr<storage::ChangedSetting> done = store.Change(change, row);
        if (!done.ok()) return done.status();
        return Done<v1::RobotSetting>{ToMessage(done->setting), done->changed};
      });
}

absl::StatusOr<v1::RobotSetting> Commands::BlockRobot(const Asker& asker,
                                                      const v1::BlockRobotRequest& request) {
  storage::SettingChange change;
  change.blocked = true;
  change.blocked_why = request.reason();
  return Change(asker, {kRobotBlock, request.ruri(), {}, request.reason()}, std::move(change),
                CheckText("reason", request.reason(), storage::kReasonBytesMax));
}

absl::StatusOr<v1::RobotSetting> Commands::UnblockRobot(const Asker& asker,
                                                        const v1::UnblockRobotRequest& request) {
  storage::SettingChange change;
  change.blocked = false;
  return Change(asker, {kRobotUnblock, request.ruri()}, std::move(change));
}

absl::StatusOr<v1::RobotSetting> Commands::DisconnectRobot(
    const Asker& asker, const v1::DisconnectRobotRequest& request) {
  storage::SettingChange change;
  change.disconnect = true;
  absl::Status verdict;
  if (identity::NamesTwin(request.ruri()) ||
      (context_.only_calls && context_.only_calls(request.ruri()))) {
    verdict = absl::FailedPreconditionError(
        fmt::format("{} has no stream that could end: block it to keep it out", request.ruri()));
  }
  return Change(asker, {kRobotDisconnect, request.ruri()}, std::move(change), std::move(verdict));
}

absl::StatusOr<v1::RobotSetting> Commands::NoteRobot(const Asker& asker,
                                                     const v1::NoteRobotRequest& request) {
  storage::SettingChange change;
  change.labels = {request.labels().begin(), request.labels().end()};
  if (request.has_note()) change.note = request.note();
  absl::Status verdict = CheckText("note", request.note(), storage::kNoteBytesMax);
  if (absl::Status labels = CheckLabels(request.labels()); !labels.ok()) verdict = labels;
  if (request.labels().empty() && !request.has_note()) {
    verdict = absl::InvalidArgumentError("labels or note must be given");
  }
  return Change(asker, {kRobotNote, request.ruri(), {}, DetailOf(request)}, std::move(change),
                std::move(verdict));
}

absl::StatusOr<v1::RobotSetting> Commands::AddRobot(const Asker& asker,
                                                    const v1::AddRobotRequest& request) {
  storage::SettingChange change;
  change.registered = !request.remove();
  return Change(asker, {request.remove() ? kRobotRemove : kRobotAdd, request.ruri()},
                std::move(change));
}

absl::StatusOr<v1::FaultAcknowledgement> Commands::AcknowledgeFault(
    const Asker& asker, const v1::AcknowledgeFaultRequest& request) {
  Deed deed{kFaultAcknowledge,
            request.ruri(),
            {},
            request.note().empty() ? request.fault_id()
                                   : fmt::format("{}: {}", request.fault_id(), request.note())};
  absl::Status verdict = CheckText("note", request.note(), storage::kNoteBytesMax);
  if (request.fault_id().empty()) {
    verdict = absl::InvalidArgumentError("faultId is missing: name the fault");
  }
  if (absl::Status judged = JudgeRobot(asker, deed); !judged.ok()) verdict = std::move(judged);
  return Do<v1::FaultAcknowledgement>(
      asker, deed, std::move(verdict),
      [&](AccessStore& store,
          const AuditRow& row) -> absl::StatusOr<Done<v1::FaultAcknowledgement>> {
        if (absl::Status noted = store.Acknowledge(
                {.ruri = request.ruri(), .fault_id = request.fault_id(), .note = request.note()},
                row);
            !noted.ok()) {
          return noted;
        }
        Done<v1::FaultAcknowledgement> done;
        view::SetTime(done.answer, &v1::FaultAcknowledgement::mutable_at, row.at);
        done.answer.set_by(row.who);
        done.answer.set_note(request.note());
        return done;
      });
}

absl::StatusOr<v1::Revocation> Commands::Revoke(const Asker& asker, Deed deed,
                                                absl::StatusOr<storage::Revocation> revocation) {
  if (revocation.ok()) deed.target = revocation->value;
  return Do<v1::Revocation>(
      asker, deed, revocation.status(),
      [&](AccessStore& store, const AuditRow& row) -> absl::StatusOr<Done<v1::Revocation>> {
        const absl::StatusOr<bool> changed = store.Revoke(*revocation, row);
        if (!changed.ok()) return changed.status();
        revocation->at = row.at;
        revocation->who = row.who;
        return Done<v1::Revocation>{ToMessage(*revocation), *changed};
      });
}

absl::StatusOr<v1::Revocation> Commands::RevokeCertificate(
    const Asker& asker, const v1::RevokeCertificateRequest& request) {
  absl::StatusOr<storage::Revocation> revocation = RevocationOf(request);
  if (absl::Status checked = CheckText("reason", request.reason(), storage::kReasonBytesMax);
      revocation.ok() && !checked.ok()) {
    revocation = checked;
  }
  if (revocation.ok()) revocation->reason = request.reason();
  return Revoke(asker, {kCertificateRevoke, {}, {}, request.reason()}, std::move(revocation));
}

absl::StatusOr<v1::Revocation> Commands::UnrevokeCertificate(
    const Asker& asker, const v1::UnrevokeCertificateRequest& request) {
  absl::StatusOr<storage::Revocation> revocation = RevocationOf(request);
  if (revocation.ok()) revocation->revoked = false;
  return Revoke(asker, {kCertificateUnrevoke}, std::move(revocation));
}

absl::StatusOr<v1::ListRevocationsResponse> Commands::ListRevocations(
    const v1::ListRevocationsRequest& request) {
  const absl::StatusOr<std::uint32_t> size = PageSizeOf(request.page_size());
  if (!size.ok()) return size.status();
  const std::optional<storage::AccessVersion> begin = VersionOf(request.page_token());
  if (!begin) return absl::InvalidArgumentError("pageToken is none of ours");
  v1::ListRevocationsResponse response;
  storage::AccessVersion after = *begin;
  storage::AccessVersion last = after;
  for (bool more = true; more;) {
    const auto rows =
        context_.store.With([&](AccessStore& store) { return store.RevocationsAfter(after); });
    if (!rows.ok()) return rows.status();
    more = rows->size() == storage::kAccessPageMax;
    for (const storage::Revocation& row : *rows) {
      after = row.version;
      if (!row.revoked) continue;
      if (static_cast<std::uint32_t>(response.revocations_size()) == *size) {
        response.set_next_page_token(std::to_string(last));
        return response;
      }
      *response.add_revocations() = ToMessage(row);
      last = row.version;
    }
  }
  return response;
}

absl::StatusOr<v1::ListAuditResponse> Commands::ListAudit(const v1::ListAuditRequest& request) {
  const absl::StatusOr<std::uint32_t> size = PageSizeOf(request.page_size());
  if (!size.ok()) return size.status();
  storage::AuditQuery query{
      .rows = {}, .who = request.who(), .action = request.action(), .target = request.target()};
  query.rows.from = TimeOf(request.has_from(), request.from());
  query.rows.to = TimeOf(request.has_to(), request.to());
  if (request.order_by() == "oldest") {
    query.rows.order = storage::ListOrder::kOldestFirst;
  } else if (!request.order_by().empty() && request.order_by() != "newest") {
    return absl::InvalidArgumentError("orderBy must be oldest or newest");
  }
  query.rows.page_size = *size;
  query.rows.page_token = request.page_token();
  const absl::StatusOr<storage::Page<AuditRow>> page = context_.rows_of_audit(query);
  if (!page.ok()) return page.status();
  v1::ListAuditResponse response;
  for (const AuditRow& row : page->rows) *response.add_audit() = ToMessage(row);
  response.set_next_page_token(page->next_token);
  return response;
}

absl::StatusOr<v1::ReloadResponse> Commands::Reload(const Asker& asker,
                                                    const v1::ReloadRequest& /*request*/) {
  if (absl::Status over = rate_.Take(asker, kReload, context_.clock.Steady()); !over.ok()) {
    context_.audit.NoteRefused(RowOf(asker, {kReload}, over, context_.clock.System()));
    return over;
  }
  const absl::StatusOr<Reloaded> reloaded =
      context_.reload ? context_.reload() : absl::UnavailableError("no server runs here");
  absl::Status outcome = reloaded.status();
  if (reloaded.ok() && !reloaded->problems.empty()) {
    outcome = absl::FailedPreconditionError("");
  }
  Deed deed{kReload};
  if (reloaded.ok()) deed.detail = DetailOf(*reloaded);
  context_.audit.Note(RowOf(asker, deed, outcome, context_.clock.System()));
  if (!reloaded.ok()) return reloaded.status();
  v1::ReloadResponse response;
  response.mutable_taken_over()->Assign(reloaded->taken_over.begin(), reloaded->taken_over.end());
  response.mutable_needs_restart()->Assign(reloaded->needs_restart.begin(),
                                           reloaded->needs_restart.end());
  response.mutable_problems()->Assign(reloaded->problems.begin(), reloaded->problems.end());
  return response;
}

void Commands::NoteForbidden(const Asker& asker, std::string_view action, std::string_view target) {
  context_.audit.NoteRefused(RowOf(asker, {.action = action, .target = std::string(target)},
                                   absl::PermissionDeniedError(""), context_.clock.System()));
}

}  // namespace uplink::admin
