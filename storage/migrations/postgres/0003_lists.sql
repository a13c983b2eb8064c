-- oldest: 1
-- Lists over the whole fleet, as in SQLite's step, and what SQLite had before: histories by fleet and reports by
-- mission. Applied as 0001.

CREATE INDEX events_by_fleet ON events (fleet, received_at, entry);
CREATE INDEX events_by_kind ON events (kind, received_at, entry, fleet);

CREATE INDEX messages_by_fleet ON messages (fleet, received_at, entry);
-- level 0, info, is that of most messages: such rows are found by their time as quickly.
CREATE INDEX messages_by_level ON messages (level, received_at, entry, fleet) WHERE level <> 0;

CREATE INDEX faults_history_by_fleet ON faults_history (fleet, received_at, entry);
CREATE INDEX faults_history_by_severity ON faults_history (severity, received_at, entry, fleet);
CREATE INDEX faults_history_by_fault ON faults_history (fault_id, received_at, entry, fleet);
CREATE INDEX faults_history_by_source ON faults_history (source, received_at, entry, fleet);
CREATE INDEX faults_active_by_severity ON faults_active (severity, raised_at, entry, fleet);
CREATE INDEX faults_active_by_fault ON faults_active (fault_id, raised_at, entry, fleet);
CREATE INDEX faults_active_by_source ON faults_active (source, raised_at, entry, fleet);

CREATE INDEX mission_runs_by_status ON mission_runs (status, first_at, entry, fleet);
CREATE INDEX mission_reports_by_fleet ON mission_reports (fleet, received_at, entry);
CREATE INDEX mission_reports_by_status ON mission_reports (status, received_at, entry, fleet);
CREATE INDEX mission_reports_by_mission ON mission_reports (mission_id, received_at, entry);

CREATE INDEX presence_changes_by_fleet ON presence_changes (fleet, changed_at, entry);
CREATE INDEX quarantine_by_fleet ON quarantine (fleet, received_at, entry);
CREATE INDEX quarantine_by_reason ON quarantine (reason, received_at, entry, fleet);
CREATE INDEX scope_updates_by_fleet ON scope_updates (fleet, received_at, entry);
