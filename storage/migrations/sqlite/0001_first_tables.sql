-- Times are Unix milliseconds, UTC, of the server's clock, if not said otherwise. `entry` numbers
-- rows in the order of writing, over all tables; it breaks ties between equal times.

CREATE TABLE schema_migrations (
  version INTEGER NOT NULL PRIMARY KEY,
  name TEXT NOT NULL,
  sha256 TEXT NOT NULL
) STRICT;

CREATE TABLE entries (
  id INTEGER NOT NULL PRIMARY KEY CHECK (id = 0),
  next_entry INTEGER NOT NULL
) STRICT;
INSERT INTO entries (id, next_entry) VALUES (0, 1);

-- owner: the process that opened the robot's last stream; held_since: the epoch of its first stream
-- since another process had the robot.
CREATE TABLE robots (
  ruri TEXT NOT NULL PRIMARY KEY,
  fleet TEXT NOT NULL,
  epoch INTEGER NOT NULL,
  held_since INTEGER NOT NULL,
  owner BLOB NOT NULL,
  first_seen_ms INTEGER NOT NULL,
  last_seen_ms INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- first_entry: quarantine rows below it belong to an evicted session that had the same id.
CREATE TABLE sessions (
  ruri TEXT NOT NULL,
  session BLOB NOT NULL,
  cursor INTEGER NOT NULL,
  last_used_ms INTEGER NOT NULL,
  first_entry INTEGER NOT NULL,
  PRIMARY KEY (ruri, session)
) STRICT, WITHOUT ROWID;

-- sampled_ms: the robot's clock; 0 if unknown. fleet: the robot's when the row was written.
CREATE TABLE faults_history (
  ruri TEXT NOT NULL,
  received_ms INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  session BLOB NOT NULL,
  seq INTEGER NOT NULL,
  sampled_ms INTEGER NOT NULL,
  fault_id TEXT NOT NULL,
  source TEXT NOT NULL,
  severity INTEGER NOT NULL,
  active INTEGER NOT NULL,
  category TEXT NOT NULL,
  description TEXT NOT NULL,
  suggested_action TEXT NOT NULL,
  PRIMARY KEY (ruri, received_ms, entry)
) STRICT;
CREATE INDEX faults_history_by_fleet ON faults_history (fleet, received_ms, entry);
CREATE INDEX faults_history_by_time ON faults_history (received_ms, entry);

-- raised_ms and entry are those of the raise that made the fault active, so that a page token stays
-- true while later raises change the rest.
CREATE TABLE faults_active (
  ruri TEXT NOT NULL,
  fault_id TEXT NOT NULL,
  source TEXT NOT NULL,
  fleet TEXT NOT NULL,
  raised_ms INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  received_ms INTEGER NOT NULL,
  sampled_ms INTEGER NOT NULL,
  severity INTEGER NOT NULL,
  category TEXT NOT NULL,
  description TEXT NOT NULL,
  suggested_action TEXT NOT NULL,
  PRIMARY KEY (ruri, fault_id, source)
) STRICT;
CREATE INDEX faults_active_by_robot ON faults_active (ruri, raised_ms, entry);
CREATE INDEX faults_active_by_fleet ON faults_active (fleet, raised_ms, entry);
CREATE INDEX faults_active_by_time ON faults_active (raised_ms, entry);

-- reason: RejectReason of the relay contract. payload: NULL where thinning dropped it.
CREATE TABLE quarantine (
  ruri TEXT NOT NULL,
  session BLOB NOT NULL,
  seq INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  received_ms INTEGER NOT NULL,
  reason INTEGER NOT NULL,
  field TEXT NOT NULL,
  detail TEXT NOT NULL,
  payload_bytes INTEGER NOT NULL,
  payload BLOB,
  PRIMARY KEY (ruri, session, seq, entry)
) STRICT;
CREATE INDEX quarantine_by_robot ON quarantine (ruri, received_ms, entry);
CREATE INDEX quarantine_by_fleet ON quarantine (fleet, received_ms, entry);
CREATE INDEX quarantine_by_time ON quarantine (received_ms, entry);
CREATE INDEX quarantine_payloads ON quarantine (ruri, entry) WHERE payload IS NOT NULL;

CREATE TABLE gaps (
  ruri TEXT NOT NULL,
  session BLOB NOT NULL,
  first INTEGER NOT NULL,
  last INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  seen_ms INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  PRIMARY KEY (ruri, session, first)
) STRICT;
CREATE INDEX gaps_by_robot ON gaps (ruri, seen_ms, entry);
CREATE INDEX gaps_by_fleet ON gaps (fleet, seen_ms, entry);
CREATE INDEX gaps_by_time ON gaps (seen_ms, entry);
