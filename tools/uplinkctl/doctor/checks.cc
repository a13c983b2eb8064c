#include "tools/uplinkctl/doctor/checks.h"

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/config/authority_folder.h"
#include "server/identity/pem_file.h"
#include "server/identity/revocation_list.h"
#include "server/store/clock_judge.h"
#include "storage/postgres/admin.h"
#include "storage/sqlite/migrations.h"
#include "tools/link/http_client.h"
#include "tools/uplinkctl/ask/access.h"
#include "tools/uplinkctl/doctor/certificate_check.h"
#include "tools/uplinkctl/doctor/certificate_facts.h"
#include "tools/uplinkctl/doctor/config_check.h"
#include "tools/uplinkctl/doctor/disk_check.h"
#include "tools/uplinkctl/doctor/machine_check.h"
#include "tools/uplinkctl/doctor/postgres_check.h"
#include "tools/uplinkctl/doctor/server_check.h"
#include "tools/uplinkctl/doctor/socket_check.h"
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

/// Whether the lists are over; that they cannot be used is the configuration's finding.
Findings CheckLists(const NamedFile& file, const std::string& authorities, SystemTime now) {
  if (file.path.empty()) return {};
  const auto lists =
      identity::ReadRevocationLists(ReadOrNothing(file.path), ReadOrNothing(authorities));
  return lists.ok() ? ListFindings(file, *lists, now) : Findings();
}

Findings CheckAuthorities(const Config& config, SystemTime now) {
  const std::string& path = config.identity.authorities;
  const config::TlsConfig& tls = config.tls;
  Findings findings =
      CheckLists({"tls.client_crl_file", tls.client_crl_file}, tls.client_ca_file, now);
  Append(findings, CheckLists({"tls.operator_crl_file", tls.operator_crl_file},
                              config::OperatorCaFile(tls), now));
  if (path.empty()) return findings;
  const NamedFile named{"identity.authorities", path};
  const auto folder = config::ReadAuthorityFolder(path);
  if (!folder.ok()) return findings;
  Append(findings, AuthorityFindings(named, ReadFacts({path, folder->pems}), now));
  for (const config::AuthorityLists& each : folder->lists) {
    Append(findings, CheckLists({named.key, each.lists}, each.authority, now));
  }
  return findings;
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
  Append(findings, CheckAuthorities(config, now));
  if (const std::string& path = config.http.tls_certificate_file; !path.empty()) {
    Append(findings, ShownCertificateFindings({"http.tls.certificate_file", path},
                                              ReadFacts(ReadOrNothing(path)), now));
  }
  if (!config.mqtt.url.empty()) {
    const std::string& path = config.mqtt.client_certificate_file;
    Append(findings, ShownCertificateFindings({"mqtt.client_certificate_file", path},
                                              ReadFacts(ReadOrNothing(path)), now));
  }
  return findings;
}

/// The facts were read before the ports were tried: a server listens before it takes its store.
Findings CheckSqlite(const SqliteFacts& facts, const config::StoreConfig& store,
                     const PortUser& user, StoreHolder holder) {
  const auto needed = static_cast<std::int64_t>(storage::sqlite::Migrations().size());
  Findings findings = SqliteFindings(facts, store, needed, user.name);
  Append(findings, HolderFindings(facts, holder));
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

std::vector<PortFacts> TryPorts(const Config& config, const std::set<std::string>& at_fault) {
  std::vector<PortFacts> ports;
  for (Listener& listener : ListenersOf(config)) {
    if (at_fault.contains(listener.key)) continue;
    if (config::IsUnix(listener.address)) {
      const SocketTrial trial = TryToListenAt(listener.address.path);
      ports.push_back({std::move(listener), trial.error, trial.holder});
    } else {
      const int error = TryToBind(listener.address);
      ports.push_back({std::move(listener), error});
    }
  }
  return ports;
}

StoreHolder HolderOf(const PortUser& user, const std::vector<PortFacts>& ports) {
  if (user.running) return StoreHolder::kOwnServer;
  return FixesPort(ports) ? StoreHolder::kOther : StoreHolder::kUnknown;
}

absl::StatusOr<link::HttpAnswer> AskWhetherReady(const Config& config) {
  const absl::StatusOr<link::HttpServer> server = ServerToProbe(OwnUrl(config));
  if (!server.ok()) return server.status();
  link::HttpClient client(*server, {kProbeDeadline, kProbeBytesMax});
  return client.Ask(ProbePath(Probe::kReady));
}

/// Ports, and the server that has them.
Findings CheckServer(const Config& config, const std::vector<PortFacts>& ports,
                     const MachineFacts& machine, const PortUser& user) {
  Findings findings;
  for (const PortFacts& port : ports) findings.push_back(PortFinding(port, machine, user));
  if (user.running) {
    findings.push_back(ServerFinding(AskWhetherReady(config)));
  } else {
    // A running server says it itself, by its word `clock`.
    findings.push_back(ClockFinding(store::KernelClockSynchronised()));
  }
  findings.push_back(DescriptorsFinding(config, user.running, machine));
  return findings;
}

}  // namespace

Findings CheckAll(const CheckContext& context) {
  if (!context.configuration.readable) return {};
  const Config& config = *context.configuration.readable;
  const std::set<std::string> at_fault = KeysAtFault(context.configuration);
  const bool checks_store = !at_fault.contains("store.url");
  std::optional<SqliteFacts> file;
  if (checks_store && !config::IsPostgres(config.store)) {
    file = ReadSqliteFacts(config::SqlitePath(config.store));
  }
  const std::vector<PortFacts> ports = TryPorts(config, at_fault);
  // A server that starts meanwhile has ports that it did not have when the machine was read.
  const MachineFacts machine = WithServersOf(context.uid, HasUnknownHolder(ports, context.machine)
                                                              ? ReadMachineAgain(context.machine)
                                                              : context.machine);
  const PortUser user{context.user, OwnServer(ports, machine)};
  Findings findings = CheckCertificates(config, context.clock.System());
  if (file) {
    Append(findings, CheckSqlite(*file, config.store, user, HolderOf(user, ports)));
  } else if (checks_store) {
    Append(findings, CheckPostgres(config.store, context.clock));
  }
  Append(findings, CheckServer(config, ports, machine, user));
  return findings;
}

}  // namespace uplink::ctl
