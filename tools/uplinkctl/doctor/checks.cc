#include "tools/uplinkctl/doctor/checks.h"

#include <cerrno>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/identity/pem_file.h"
#include "server/store/clock_judge.h"
#include "storage/postgres/admin.h"
#include "storage/sqlite/migrations.h"
#include "tools/link/http_client.h"
#include "tools/uplinkctl/doctor/certificate_check.h"
#include "tools/uplinkctl/doctor/certificate_facts.h"
#include "tools/uplinkctl/doctor/config_check.h"
#include "tools/uplinkctl/doctor/disk_check.h"
#include "tools/uplinkctl/doctor/machine_check.h"
#include "tools/uplinkctl/doctor/postgres_check.h"
#include "tools/uplinkctl/doctor/server_check.h"
#include "tools/uplinkctl/doctor/sqlite_check.h"
#include "tools/uplinkctl/doctor/sqlite_facts.h"
#include "tools/uplinkctl/listeners.h"
#include "tools/uplinkctl/probe.h"

namespace uplink::ctl {
namespace {

using config::Config;

/// A file that cannot be read is the configuration's finding.
identity::NamedPem ReadOrNothing(const std::string& path) {
  if (path.empty()) return {};
  auto pem = identity::ReadPem(path);
  return pem.ok() ? *std::move(pem) : identity::NamedPem{path, {}};
}

Findings CheckCertificates(const Config& config, SystemTime now) {
  Findings findings;
  const identity::NamedPem authorities = ReadOrNothing(config.tls.client_ca_file);
  const identity::NamedPem own = ReadOrNothing(config.tls.certificate_file);
  if (auto chain = ReadChain(own, authorities)) {
    const ServerCertificate certificate{
        .file = {"tls.certificate_file", config.tls.certificate_file},
        .facts = *std::move(chain),
        .serves_others = !config::IsLoopback(config.listen.relay)};
    Append(findings, ServerCertificateFindings(certificate, now));
  }
  Append(findings, AuthorityFindings({"tls.client_ca_file", config.tls.client_ca_file},
                                     ReadFacts(authorities), now));
  if (!config.mqtt.url.empty()) {
    const std::string& path = config.mqtt.client_certificate_file;
    Append(findings, ClientCertificateFindings({"mqtt.client_certificate_file", path},
                                               ReadFacts(ReadOrNothing(path)), now));
  }
  return findings;
}

Findings CheckSqlite(const config::StoreConfig& store, const std::string& user) {
  const SqliteFacts facts = ReadSqliteFacts(config::SqlitePath(store));
  const auto needed = static_cast<std::int64_t>(storage::sqlite::Migrations().size());
  Findings findings = SqliteFindings(facts, store, needed, user);
  if (facts.space) findings.push_back(DiskFinding(facts.folder, *facts.space, store.free_min));
  return findings;
}

Findings CheckPostgres(const config::StoreConfig& store, const Clock& clock) {
  const auto state = storage::postgres::ReadState(
      {store.url, store.password_file, kDatabaseConnectMax, kDatabaseCallMax}, clock);
  Findings findings = PostgresFindings(state, store);
  if (!state.ok() || state->data_folder.empty()) return findings;
  if (const auto space = storage::DiskSpaceOf(state->data_folder); space.ok()) {
    findings.push_back(DiskFinding(state->data_folder, *space, store.free_min));
  }
  return findings;
}

/// Ports, and the server that has them.
Findings CheckServer(const Config& config, const CheckContext& context,
                     const std::set<std::string>& at_fault) {
  Findings findings;
  std::optional<ServerProcess> server;
  for (Listener& listener : ListenersOf(config)) {
    if (at_fault.contains(listener.key)) continue;
    const int error = TryToBind(listener.address);
    if (error == EADDRINUSE && !server) server = ServerAt(listener.address, context.machine);
    findings.push_back(PortFinding({std::move(listener), error}, context.machine, context.user));
  }
  if (server) {
    link::HttpClient client(config::ToText(ProbeAddress(config)), {kProbeDeadline, kProbeBytesMax});
    findings.push_back(ServerFinding(client.Ask(ProbePath(Probe::kReady))));
  } else {
    // A running server says it itself, by its word `clock`.
    findings.push_back(ClockFinding(store::KernelClockSynchronised()));
  }
  findings.push_back(DescriptorsFinding(config, server, context.machine));
  return findings;
}

}  // namespace

Findings CheckAll(const CheckContext& context) {
  if (!context.configuration.readable) return {};
  const Config& config = *context.configuration.readable;
  const std::set<std::string> at_fault = KeysAtFault(context.configuration);
  Findings findings = CheckCertificates(config, context.clock.System());
  if (!at_fault.contains("store.url")) {
    Append(findings, config::IsPostgres(config.store) ? CheckPostgres(config.store, context.clock)
                                                      : CheckSqlite(config.store, context.user));
  }
  Append(findings, CheckServer(config, context, at_fault));
  return findings;
}

}  // namespace uplink::ctl
