-- oldest: 1
-- Names of tables and columns are those of PostgreSQL. Times are Unix milliseconds, UTC, of the
-- server's clock, if not said otherwise; those of robots (sampled_ms, expires_ms) are as they came, 0
-- where there is none. Enumerations are the numbers of the wire, unknown ones included.
-- Texts of JSON hold an object by the specification's names. `entry` numbers rows in the order of
-- writing, over all tables; it breaks ties between equal times. fleet: the robot's when the row was
-- written.

-- oldest: the schema of the oldest program that may use a store with the step.
CREATE TABLE schema_migrations (
  version INTEGER NOT NULL PRIMARY KEY,
  oldest INTEGER NOT NULL,
  name TEXT NOT NULL,
  sha256 TEXT NOT NULL
) STRICT;

CREATE TABLE entries (
  id INTEGER NOT NULL PRIMARY KEY CHECK (id = 0),
  next_entry INTEGER NOT NULL
) STRICT;
INSERT INTO entries (id, next_entry) VALUES (0, 1);

-- The last epoch that was given. Every epoch comes from here, whether a stream opens or a robot is
-- adopted: none is ever given twice, so that a robot whose row went and was made anew stands above
-- its former holder.
CREATE TABLE epochs (
  id INTEGER NOT NULL PRIMARY KEY CHECK (id = 0),
  last INTEGER NOT NULL
) STRICT;
INSERT INTO epochs (id, last) VALUES (0, 0);

-- A civil time at which the server's clock was vouched for: one that stands much later is not trusted
-- with deleting anything. No row until there was one.
CREATE TABLE clock_mark (
  id INTEGER NOT NULL PRIMARY KEY CHECK (id = 0),
  at INTEGER NOT NULL
) STRICT;

-- owner: the process that opened the robot's last stream; held_since: the epoch of its first stream
-- since another process had the robot; holder_silent: the robot's holder fell silent since its last
-- OpenStream.
CREATE TABLE robots (
  ruri TEXT NOT NULL PRIMARY KEY,
  fleet TEXT NOT NULL,
  epoch INTEGER NOT NULL,
  held_since INTEGER NOT NULL,
  owner BLOB NOT NULL,
  first_seen INTEGER NOT NULL,
  last_seen INTEGER NOT NULL,
  holder_silent INTEGER NOT NULL DEFAULT 0
) STRICT, WITHOUT ROWID;

-- cursor_seq: the last number that is committed. first_entry: quarantine rows below it belong to an
-- evicted session that had the same id. settled_seq: the highest Hello.settled_seq of the session:
-- no reader asks for quarantine rows at or below it.
CREATE TABLE sessions (
  ruri TEXT NOT NULL,
  session BLOB NOT NULL,
  cursor_seq INTEGER NOT NULL,
  last_used INTEGER NOT NULL,
  first_entry INTEGER NOT NULL,
  settled_seq INTEGER NOT NULL DEFAULT 0,
  PRIMARY KEY (ruri, session)
) STRICT, WITHOUT ROWID;

-- Histories: a row a report.

CREATE TABLE faults_history (
  ruri TEXT NOT NULL,
  received_at INTEGER NOT NULL,
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
  PRIMARY KEY (ruri, received_at, entry)
) STRICT;
CREATE INDEX faults_history_by_fleet ON faults_history (fleet, received_at, entry);
CREATE INDEX faults_history_by_time ON faults_history (received_at, entry);

CREATE TABLE events (
  ruri TEXT NOT NULL,
  received_at INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  session BLOB NOT NULL,
  seq INTEGER NOT NULL,
  sampled_ms INTEGER NOT NULL,
  kind TEXT NOT NULL,
  detail TEXT NOT NULL,
  PRIMARY KEY (ruri, received_at, entry)
) STRICT;
CREATE INDEX events_by_fleet ON events (fleet, received_at, entry);
CREATE INDEX events_by_time ON events (received_at, entry);

-- detail: what else the sender of a message said, as the JSON text of an object; empty if that is
-- nothing.
CREATE TABLE messages (
  ruri TEXT NOT NULL,
  received_at INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  session BLOB NOT NULL,
  seq INTEGER NOT NULL,
  sampled_ms INTEGER NOT NULL,
  level INTEGER NOT NULL,
  message TEXT NOT NULL,
  detail TEXT NOT NULL DEFAULT '',
  PRIMARY KEY (ruri, received_at, entry)
) STRICT;
CREATE INDEX messages_by_fleet ON messages (fleet, received_at, entry);
CREATE INDEX messages_by_time ON messages (received_at, entry);

CREATE TABLE mission_reports (
  ruri TEXT NOT NULL,
  received_at INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  session BLOB NOT NULL,
  seq INTEGER NOT NULL,
  mission_id TEXT NOT NULL,
  run_id TEXT NOT NULL,
  status INTEGER NOT NULL,
  report TEXT NOT NULL,
  PRIMARY KEY (ruri, received_at, entry)
) STRICT;
CREATE INDEX mission_reports_by_fleet ON mission_reports (fleet, received_at, entry);
CREATE INDEX mission_reports_by_time ON mission_reports (received_at, entry);
CREATE INDEX mission_reports_by_run ON mission_reports (run_id, received_at, entry);
CREATE INDEX mission_reports_by_mission ON mission_reports (mission_id, received_at, entry);

-- Updates of what is no robot. ruri: what stands in a robot's place, `cyberwave:` and the prefix of the
-- topic. fleet: whose viewers may see it. sampled_ms: the sender's clock, 0 if unknown. scope: 0 an
-- environment, 1 a workflow run; id: its UUID; type: what changed, of a workflow run its status;
-- detail: the JSON text of an object in the sender's own form.
CREATE TABLE scope_updates (
  ruri TEXT NOT NULL,
  received_at INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  session BLOB NOT NULL,
  seq INTEGER NOT NULL,
  sampled_ms INTEGER NOT NULL,
  scope INTEGER NOT NULL,
  id TEXT NOT NULL,
  type TEXT NOT NULL,
  detail TEXT NOT NULL,
  PRIMARY KEY (ruri, received_at, entry)
) STRICT;
CREATE INDEX scope_updates_by_fleet ON scope_updates (fleet, received_at, entry);
CREATE INDEX scope_updates_by_time ON scope_updates (received_at, entry);
CREATE INDEX scope_updates_by_scope ON scope_updates (scope, received_at, entry);
CREATE INDEX scope_updates_by_id ON scope_updates (id, received_at, entry);

-- presence: 0 unknown, 1 online, 2 offline.
CREATE TABLE presence_changes (
  ruri TEXT NOT NULL,
  changed_at INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  presence INTEGER NOT NULL,
  PRIMARY KEY (ruri, changed_at, entry)
) STRICT;
CREATE INDEX presence_changes_by_fleet ON presence_changes (fleet, changed_at, entry);
CREATE INDEX presence_changes_by_time ON presence_changes (changed_at, entry);

-- reason: RejectReason of the relay contract. payload: NULL where thinning dropped it. source: by which
-- way the message came, 0 a robot's stream, 1 Cyberwave; topic: on which it was published, empty for
-- the first.
CREATE TABLE quarantine (
  ruri TEXT NOT NULL,
  session BLOB NOT NULL,
  seq INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  received_at INTEGER NOT NULL,
  reason INTEGER NOT NULL,
  field TEXT NOT NULL,
  detail TEXT NOT NULL,
  payload_bytes INTEGER NOT NULL,
  payload BLOB,
  source INTEGER NOT NULL DEFAULT 0,
  topic TEXT NOT NULL DEFAULT '',
  PRIMARY KEY (ruri, session, seq, entry)
) STRICT;
CREATE INDEX quarantine_by_robot ON quarantine (ruri, received_at, entry);
CREATE INDEX quarantine_by_fleet ON quarantine (fleet, received_at, entry);
CREATE INDEX quarantine_by_time ON quarantine (received_at, entry);
CREATE INDEX quarantine_by_source ON quarantine (source, received_at, entry) WHERE source <> 0;
CREATE INDEX quarantine_payloads ON quarantine (ruri, entry) WHERE payload IS NOT NULL;

-- How many rows of a robot's quarantine went for its bound.
CREATE TABLE quarantine_dropped (
  ruri TEXT NOT NULL,
  reason INTEGER NOT NULL,
  count INTEGER NOT NULL,
  PRIMARY KEY (ruri, reason)
) STRICT, WITHOUT ROWID;

-- Rejects that are kept for their robot alone, until a Hello confirms them: ranges of numbers that were
-- over their rate, and what retention takes out of quarantine before that. entry: as of quarantine.
CREATE TABLE kept_rejects (
  ruri TEXT NOT NULL,
  session BLOB NOT NULL,
  last INTEGER NOT NULL,
  first INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  reason INTEGER NOT NULL,
  field TEXT NOT NULL,
  detail TEXT NOT NULL,
  PRIMARY KEY (ruri, session, last)
) STRICT, WITHOUT ROWID;

CREATE TABLE gaps (
  ruri TEXT NOT NULL,
  session BLOB NOT NULL,
  first INTEGER NOT NULL,
  last INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  seen_at INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  PRIMARY KEY (ruri, session, first)
) STRICT;
CREATE INDEX gaps_by_robot ON gaps (ruri, seen_at, entry);
CREATE INDEX gaps_by_fleet ON gaps (fleet, seen_at, entry);
CREATE INDEX gaps_by_time ON gaps (seen_at, entry);

-- What is present or latest: a row a key.

-- raised_at and entry are those of the raise that made the fault active, so that a page token stays
-- true while later raises change the rest.
CREATE TABLE faults_active (
  ruri TEXT NOT NULL,
  fault_id TEXT NOT NULL,
  source TEXT NOT NULL,
  fleet TEXT NOT NULL,
  raised_at INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  received_at INTEGER NOT NULL,
  sampled_ms INTEGER NOT NULL,
  severity INTEGER NOT NULL,
  category TEXT NOT NULL,
  description TEXT NOT NULL,
  suggested_action TEXT NOT NULL,
  PRIMARY KEY (ruri, fault_id, source)
) STRICT;
CREATE INDEX faults_active_by_robot ON faults_active (ruri, raised_at, entry);
CREATE INDEX faults_active_by_fleet ON faults_active (fleet, raised_at, entry);
CREATE INDEX faults_active_by_time ON faults_active (raised_at, entry);

-- first_at and entry are those of a run's first report, so that a page token stays true while later
-- reports change the rest. name: NULL until a report names the run. is_open: the latest status is not
-- terminal, and the server did not close the run. closed_why: 0 it did not, 1 the robot had too many
-- open, 2 the run was not reported for too long; closed_at: when; the next report undoes it.
-- last_entry: that of the latest report, so that runs stand in the order of their commits whatever the
-- clock did.
CREATE TABLE mission_runs (
  ruri TEXT NOT NULL,
  mission_id TEXT NOT NULL,
  run_id TEXT NOT NULL,
  fleet TEXT NOT NULL,
  first_at INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  last_at INTEGER NOT NULL,
  name TEXT,
  status INTEGER NOT NULL,
  is_open INTEGER NOT NULL,
  updates INTEGER NOT NULL,
  latest TEXT NOT NULL,
  last_entry INTEGER NOT NULL,
  closed_why INTEGER NOT NULL,
  closed_at INTEGER NOT NULL,
  PRIMARY KEY (ruri, mission_id, run_id)
) STRICT;
CREATE INDEX mission_runs_by_robot ON mission_runs (ruri, first_at, entry);
CREATE INDEX mission_runs_by_fleet ON mission_runs (fleet, first_at, entry);
CREATE INDEX mission_runs_by_time ON mission_runs (first_at, entry);
CREATE INDEX mission_runs_by_run ON mission_runs (run_id, first_at, entry);
CREATE INDEX mission_runs_by_mission ON mission_runs (mission_id, first_at, entry);
CREATE INDEX mission_runs_open_by_robot ON mission_runs (ruri, first_at, entry) WHERE is_open;
CREATE INDEX mission_runs_open_by_fleet ON mission_runs (fleet, first_at, entry) WHERE is_open;
CREATE INDEX mission_runs_open_by_time ON mission_runs (first_at, entry) WHERE is_open;

-- first_at and entry are those of the upsert that made the id present; received_at is that of the
-- latest. expires_ms: 0 is never. geometry: GeoJSON.
CREATE TABLE shapes (
  ruri TEXT NOT NULL,
  id TEXT NOT NULL,
  fleet TEXT NOT NULL,
  first_at INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  received_at INTEGER NOT NULL,
  expires_ms INTEGER NOT NULL,
  name TEXT NOT NULL,
  rev INTEGER NOT NULL,
  hash TEXT NOT NULL,
  area_type INTEGER NOT NULL,
  scope INTEGER NOT NULL,
  min_z_m REAL NOT NULL,
  max_z_m REAL NOT NULL,
  level_id INTEGER NOT NULL,
  geometry TEXT NOT NULL,
  PRIMARY KEY (ruri, id)
) STRICT;
CREATE INDEX shapes_by_robot ON shapes (ruri, first_at, entry);
CREATE INDEX shapes_by_fleet ON shapes (fleet, first_at, entry);
CREATE INDEX shapes_by_time ON shapes (first_at, entry);
CREATE INDEX shapes_by_expiry ON shapes (expires_ms) WHERE expires_ms != 0;
CREATE INDEX shapes_by_robot_and_expiry ON shapes (ruri, expires_ms) WHERE expires_ms != 0;

-- As shapes. trajectory: NULL if there is none.
CREATE TABLE objects (
  ruri TEXT NOT NULL,
  id TEXT NOT NULL,
  fleet TEXT NOT NULL,
  first_at INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  received_at INTEGER NOT NULL,
  expires_ms INTEGER NOT NULL,
  name TEXT NOT NULL,
  sampled_ms INTEGER NOT NULL,
  object_type INTEGER NOT NULL,
  scope INTEGER NOT NULL,
  radius_m REAL NOT NULL,
  location TEXT NOT NULL,
  trajectory TEXT,
  PRIMARY KEY (ruri, id)
) STRICT;
CREATE INDEX objects_by_robot ON objects (ruri, first_at, entry);
CREATE INDEX objects_by_fleet ON objects (fleet, first_at, entry);
CREATE INDEX objects_by_time ON objects (first_at, entry);
CREATE INDEX objects_by_expiry ON objects (expires_ms) WHERE expires_ms != 0;
CREATE INDEX objects_by_robot_and_expiry ON objects (ruri, expires_ms) WHERE expires_ms != 0;

-- kind: 0 agent info, 1 settings, 2 UI capabilities.
CREATE TABLE latest (
  ruri TEXT NOT NULL,
  kind INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  received_at INTEGER NOT NULL,
  body TEXT NOT NULL,
  PRIMARY KEY (ruri, kind)
) STRICT;

-- The last row of presence_changes of each robot, which outlives it: histories are kept to their age.
CREATE TABLE presence_latest (
  ruri TEXT NOT NULL PRIMARY KEY,
  presence INTEGER NOT NULL,
  changed_at INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- What a checkpoint keeps of each robot's live state; each part is written only when it changed. The
-- parts' bytes are messages of the robot, each behind its length; rcan: the Robot State of RCAN, as
-- JSON behind its length. settled_seq: how far the robot's session was settled at the checkpoint, live
-- messages included. held_since: under which hold the robot's state was written last.
CREATE TABLE live (
  ruri TEXT NOT NULL PRIMARY KEY,
  last_sign_at INTEGER,
  clock_skew_ms INTEGER,
  motion BLOB,
  status BLOB,
  extras BLOB,
  health BLOB,
  usage BLOB,
  consumables BLOB,
  directives BLOB,
  rcan BLOB,
  session BLOB,
  settled_seq INTEGER,
  held_since INTEGER NOT NULL DEFAULT 0
) STRICT;

-- Robots that an operator wants to be forgotten, and what the server answers. touched_s: Unix seconds.
CREATE TABLE forget_requests (
  number INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT,
  ruri TEXT NOT NULL CHECK (length(CAST(ruri AS BLOB)) <= 1024),
  end_stream INTEGER NOT NULL,
  touched_s INTEGER NOT NULL,
  answer INTEGER NOT NULL DEFAULT 0,
  epoch INTEGER NOT NULL DEFAULT 0,
  finished INTEGER NOT NULL DEFAULT 0
) STRICT;

-- Which process subscribes to which topics at a broker, by client id. released: given up, or another
-- took one of its prefixes.
CREATE TABLE topic_clients (
  client_id TEXT NOT NULL PRIMARY KEY,
  process BLOB NOT NULL,
  epoch INTEGER NOT NULL,
  released INTEGER NOT NULL,
  taken_at INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- Under which prefixes; none of a client id that was released.
CREATE TABLE topic_prefixes (
  prefix TEXT NOT NULL PRIMARY KEY,
  client_id TEXT NOT NULL
) STRICT, WITHOUT ROWID;

-- The last messages that a broker delivered to a client id and whose rows are committed, so that they
-- are known when they come again. number: counts them, over all processes. digest: of topic and
-- content; NULL where the packet id was used anew. Not called by its packet id: a row is never changed.
-- That a broker lost a session is a row with packet id 0: all with lower numbers have ended.
CREATE TABLE deliveries (
  client_id TEXT NOT NULL,
  number INTEGER NOT NULL,
  packet_id INTEGER NOT NULL,
  digest BLOB,
  PRIMARY KEY (client_id, number)
) STRICT, WITHOUT ROWID;

-- Which shapes and objects of scope fleet (1) or world (2) changed, for the server, which hands them on
-- to other robots: upserts, deletes, what is swept, what goes with its robot, and what is narrowed to
-- another scope. Triggers note each write. A change names its item alone; what became of that is read
-- from the item's own table.
--
-- The numbers are those of the commits, without a hole: one transaction writes at a time, and a
-- rollback takes them back. kind: 1 shape, 2 object. origin: the RURI of the robot whose item it is.
-- The column is not called ruri, as those of rows that go with their robot are: a change outlives it,
-- so that others learn that its items are gone.
CREATE TABLE changes (
  number INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT,
  kind INTEGER NOT NULL,
  origin TEXT NOT NULL,
  id TEXT NOT NULL
) STRICT;

CREATE TRIGGER shapes_added AFTER INSERT ON shapes WHEN NEW.scope IN (1, 2)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (1, NEW.ruri, NEW.id);
END;
CREATE TRIGGER shapes_changed AFTER UPDATE ON shapes WHEN OLD.scope IN (1, 2) OR NEW.scope IN (1, 2)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (1, NEW.ruri, NEW.id);
END;
CREATE TRIGGER shapes_removed AFTER DELETE ON shapes WHEN OLD.scope IN (1, 2)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (1, OLD.ruri, OLD.id);
END;
CREATE TRIGGER objects_added AFTER INSERT ON objects WHEN NEW.scope IN (1, 2)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (2, NEW.ruri, NEW.id);
END;
CREATE TRIGGER objects_changed AFTER UPDATE ON objects WHEN OLD.scope IN (1, 2) OR NEW.scope IN (1, 2)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (2, NEW.ruri, NEW.id);
END;
CREATE TRIGGER objects_removed AFTER DELETE ON objects WHEN OLD.scope IN (1, 2)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (2, OLD.ruri, OLD.id);
END;

-- A row that an operator gives another key has ended under the old one.
CREATE TRIGGER shapes_renamed AFTER UPDATE OF ruri, id ON shapes
  WHEN OLD.scope IN (1, 2) AND (OLD.ruri <> NEW.ruri OR OLD.id <> NEW.id)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (1, OLD.ruri, OLD.id);
END;
CREATE TRIGGER objects_renamed AFTER UPDATE OF ruri, id ON objects
  WHEN OLD.scope IN (1, 2) AND (OLD.ruri <> NEW.ruri OR OLD.id <> NEW.id)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (2, OLD.ruri, OLD.id);
END;

-- The items that are there, by their keys.
CREATE INDEX shapes_shared ON shapes (ruri, id) WHERE scope IN (1, 2);
CREATE INDEX objects_shared ON objects (ruri, id) WHERE scope IN (1, 2);

-- A robot that a certificate moves to another fleet takes its shapes and objects with it: they belong
-- to the fleet of their robot, for those who list them and for the robots that they are handed on to.
CREATE TRIGGER robots_moved AFTER UPDATE OF fleet ON robots WHEN OLD.fleet <> NEW.fleet
BEGIN
  UPDATE shapes SET fleet = NEW.fleet WHERE ruri = NEW.ruri AND fleet <> NEW.fleet;
  UPDATE objects SET fleet = NEW.fleet WHERE ruri = NEW.ruri AND fleet <> NEW.fleet;
END;
