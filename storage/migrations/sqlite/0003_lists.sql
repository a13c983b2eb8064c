-- oldest: 1
-- Lists over the whole fleet: what they filter by is answered from an index. Each has the fleet behind the
-- order, so that both restrictions together look at the index alone.

CREATE INDEX events_by_kind ON events (kind, received_at, entry, fleet);

-- level 0, info, is that of most messages: such rows are found by their time as quickly.
CREATE INDEX messages_by_level ON messages (level, received_at, entry, fleet) WHERE level <> 0;

CREATE INDEX faults_history_by_severity ON faults_history (severity, received_at, entry, fleet);
CREATE INDEX faults_history_by_fault ON faults_history (fault_id, received_at, entry, fleet);
CREATE INDEX faults_history_by_source ON faults_history (source, received_at, entry, fleet);
CREATE INDEX faults_active_by_severity ON faults_active (severity, raised_at, entry, fleet);
CREATE INDEX faults_active_by_fault ON faults_active (fault_id, raised_at, entry, fleet);
CREATE INDEX faults_active_by_source ON faults_active (source, raised_at, entry, fleet);

CREATE INDEX mission_runs_by_status ON mission_runs (status, first_at, entry, fleet);
CREATE INDEX mission_reports_by_status ON mission_reports (status, received_at, entry, fleet);

CREATE INDEX quarantine_by_reason ON quarantine (reason, received_at, entry, fleet);
