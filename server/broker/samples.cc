#include "server/broker/samples.h"

#include <cstddef>

#include "schema/model/rejection.h"

namespace uplink::broker {
namespace {

using enum metrics::MetricId;

void AddMessages(const metrics::Ledger::Page& ledger, metrics::Exposition& page) {
  const metrics::MessageCounts& counts = ledger.messages;
  page.Add(kMqttReceived, counts.received);
  for (const metrics::BecameColumn& column : metrics::kBecame) {
    page.Add(kMqttSettled, counts.*column.count, {column.name});
  }
  page.Add(kMqttInFlight, counts.in_flight);
  for (const model::RejectReason each : model::kAllRejectReasons) {
    const std::string_view reason = model::ToText(each);
    const auto place = static_cast<std::size_t>(each);
    page.Add(kMqttRejects, counts.rejects[place], {reason});
    page.Add(kMqttFieldsDropped, ledger.dropped[metrics::kUnknownKind][place], {reason});
  }
  page.Add(kMqttTimesUnknown, ledger.odd.times_unknown);
  page.Add(kMqttControlCharacters, ledger.odd.control_characters);
}

void AddTwins(const Broker& broker, metrics::Exposition& page) {
  const BrokerProbe& probe = broker.probe();
  const cyberwave::Twins& twins = broker.twins();
  for (std::size_t i = 0; i < probe.topics.size(); ++i) {
    page.Add(kMqttTopics, probe.topics[i],
             {cyberwave::ToText(static_cast<cyberwave::TopicKind>(i))});
  }
  page.Add(kMqttRecords, probe.records);
  page.Add(kMqttAckSeconds, probe.ack_seconds);
  page.Add(kMqttPongs, probe.pongs);
  page.Add(kMqttPongsWithheld, probe.pongs_withheld);
  page.Add(kMqttHeldBackTotal, probe.held_back_total);
  page.Add(kMqttHeldBack, probe.held_back);
  page.Add(kMqttUnread, probe.behind);
  page.Add(kMqttTwins, twins.size());
  page.Add(kMqttTwinsLimit, twins.twins_max());
  page.Add(kMqttTwinsRefused, probe.twins_refused);
  page.Add(kMqttTwinsBytes, twins.bytes());
  page.Add(kMqttTablesDropped, twins.tables_dropped());
  page.Add(kMqttStreams, probe.streams);
  page.Add(kMqttTwinsLost, probe.twins_lost);
  page.Add(kMqttLeaseHeld, probe.lease_held);
  page.Add(kMqttLeaseTaken, probe.lease_taken);
  page.Add(kMqttLeaseFailing, broker.lease_failing() ? 1 : 0);
}

void AddConnection(std::string_view name, const mqtt::ClientProbe& probe,
                   metrics::Exposition& page) {
  page.Add(kMqttConnected, probe.connected, {name});
  page.Add(kMqttConnections, probe.accepted, {name});
  for (std::size_t i = 0; i < probe.ended.size(); ++i) {
    page.Add(kMqttConnectionsEnded, probe.ended[i], {name, mqtt::kEndReasonNames[i]});
  }
  page.Add(kMqttPublishes, probe.messages[0], {name, "0"});
  page.Add(kMqttPublishes, probe.messages[1], {name, "1"});
  page.Add(kMqttDups, probe.dups, {name});
  page.Add(kMqttRetained, probe.retained, {name});
  page.Add(kMqttOversized, probe.oversized, {name});
  page.Add(kMqttBadTopics, probe.bad_topics, {name});
  page.Add(kMqttPayloadBytes, probe.payload_bytes, {name});
  page.Add(kMqttPubacks, probe.pubacks, {name});
  page.Add(kMqttUnacked, probe.unacked, {name});
  page.Add(kMqttReadingStopped, probe.stopped_by_window, {name, "window"});
  page.Add(kMqttReadingStopped, probe.stopped_by_output, {name, "output"});
  page.Add(kMqttReadingStopped, probe.stopped_by_core, {name, "journal"});
  page.Add(kMqttFiltersRefused, probe.filters_refused, {name});
  page.Add(kMqttFiltersLower, probe.filters_lower, {name});
  page.Add(kMqttIdTaken, probe.id_taken, {name});
}

}  // namespace

void AddSamples(const Broker& broker, metrics::Exposition& page) {
  AddMessages(broker.ledger().Read(), page);
  AddTwins(broker, page);
  for (const ConnectionStatus& each : broker.connections()) {
    AddConnection(Name(each.connection), broker.client_probe(each.connection), page);
  }
  const mqtt::ClientProbe& durable = broker.client_probe(Connection::kDurable);
  page.Add(kMqttUnackedLimit, broker.unacked_max());
  page.Add(kMqttSessionsLost, durable.sessions_lost);
  page.Add(kMqttSessionsShort, durable.sessions_short);
  page.Add(kMqttCertificateExpiry, broker.probe().certificate_expiry_s);
  page.Add(kMqttPublishesDropped, broker.client_probe(Connection::kLive).publishes_dropped);
}

}  // namespace uplink::broker
