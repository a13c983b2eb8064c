-- Applied with search_path = uplinkd by the owner of the schema. Times of the server's clock are
-- timestamptz; those of robots (sampled_ms, expires_ms) are Unix milliseconds as they came, 0 where
-- there is none. Enumerations are the numbers of the wire. Texts of JSON hold an object by the
-- specification's names. `entry` orders rows by their writing, over all tables: the number of the
-- transaction, times 2^20, plus the place in it. Every primary key begins with the robot.

CREATE TABLE schema_migrations (
  version integer NOT NULL PRIMARY KEY,
  name text NOT NULL,
  sha256 text NOT NULL,
  applied_at timestamptz NOT NULL DEFAULT now()
);

-- Drawn once a transaction, after its robots' rows are locked: so entries of one robot grow.
CREATE SEQUENCE batches;

-- owner: the process that opened the robot's last stream; held_since: the epoch of its first stream
-- since another process had the robot.
CREATE TABLE robots (
  ruri text COLLATE "C" NOT NULL PRIMARY KEY,
  fleet text COLLATE "C" NOT NULL,
  epoch bigint NOT NULL,
  held_since bigint NOT NULL,
  owner uuid NOT NULL,
  first_seen timestamptz NOT NULL,
  last_seen timestamptz NOT NULL
) WITH (fillfactor = 50);

-- cursor_seq: the last number that is committed. first_entry: quarantine rows below it belong to an
-- evicted session that had the same id.
CREATE TABLE sessions (
  ruri text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  cursor_seq bigint NOT NULL,
  last_used timestamptz NOT NULL,
  first_entry bigint NOT NULL,
  PRIMARY KEY (ruri, session)
) WITH (fillfactor = 50);

-- Histories: a row a report, partitioned by the day of arrival (UTC).

CREATE TABLE faults_history (
  ruri text COLLATE "C" NOT NULL,
  received_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  seq bigint NOT NULL,
  sampled_ms bigint NOT NULL,
  fault_id text COLLATE "C" NOT NULL,
  source text COLLATE "C" NOT NULL,
  severity integer NOT NULL,
  active boolean NOT NULL,
  category text NOT NULL,
  description text NOT NULL,
  suggested_action text NOT NULL,
  PRIMARY KEY (ruri, received_at, entry)
) PARTITION BY RANGE (received_at);
CREATE INDEX faults_history_by_time ON faults_history (received_at, entry);
CREATE TABLE faults_history_default PARTITION OF faults_history DEFAULT;

CREATE TABLE events (
  ruri text COLLATE "C" NOT NULL,
  received_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  seq bigint NOT NULL,
  sampled_ms bigint NOT NULL,
  kind text NOT NULL,
  detail text NOT NULL,
  PRIMARY KEY (ruri, received_at, entry)
) PARTITION BY RANGE (received_at);
CREATE INDEX events_by_time ON events (received_at, entry);
CREATE TABLE events_default PARTITION OF events DEFAULT;

CREATE TABLE messages (
  ruri text COLLATE "C" NOT NULL,
  received_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  seq bigint NOT NULL,
  sampled_ms bigint NOT NULL,
  level integer NOT NULL,
  message text NOT NULL,
  PRIMARY KEY (ruri, received_at, entry)
) PARTITION BY RANGE (received_at);
CREATE INDEX messages_by_time ON messages (received_at, entry);
CREATE TABLE messages_default PARTITION OF messages DEFAULT;

CREATE TABLE mission_reports (
  ruri text COLLATE "C" NOT NULL,
  received_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  seq bigint NOT NULL,
  mission_id text COLLATE "C" NOT NULL,
  run_id text COLLATE "C" NOT NULL,
  status integer NOT NULL,
  report text NOT NULL,
  PRIMARY KEY (ruri, received_at, entry)
) PARTITION BY RANGE (received_at);
CREATE INDEX mission_reports_by_time ON mission_reports (received_at, entry);
CREATE INDEX mission_reports_by_run ON mission_reports (run_id, received_at, entry);
CREATE TABLE mission_reports_default PARTITION OF mission_reports DEFAULT;

-- presence: 0 unknown, 1 online, 2 offline.
CREATE TABLE presence_changes (
  ruri text COLLATE "C" NOT NULL,
  changed_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  presence integer NOT NULL,
  PRIMARY KEY (ruri, changed_at, entry)
) PARTITION BY RANGE (changed_at);
CREATE INDEX presence_changes_by_time ON presence_changes (changed_at, entry);
CREATE TABLE presence_changes_default PARTITION OF presence_changes DEFAULT;

-- reason: RejectReason of the relay contract. payload: NULL where thinning dropped it.
CREATE TABLE quarantine (
  ruri text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  seq bigint NOT NULL,
  entry bigint NOT NULL,
  received_at timestamptz NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  reason integer NOT NULL,
  field text NOT NULL,
  detail text NOT NULL,
  payload_bytes bigint NOT NULL,
  payload bytea,
  PRIMARY KEY (ruri, session, seq, entry, received_at)
) PARTITION BY RANGE (received_at);
CREATE INDEX quarantine_by_robot ON quarantine (ruri, received_at, entry);
CREATE INDEX quarantine_by_time ON quarantine (received_at, entry);
CREATE INDEX quarantine_payloads ON quarantine (ruri, entry) WHERE payload IS NOT NULL;
CREATE TABLE quarantine_default PARTITION OF quarantine DEFAULT;

-- What is present or latest: a row a key, written at most once a transaction, with room on the page
-- for its next version.

-- raised_at and entry are those of the raise that made the fault active.
CREATE TABLE faults_active (
  ruri text COLLATE "C" NOT NULL,
  fault_id text COLLATE "C" NOT NULL,
  source text COLLATE "C" NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  raised_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  received_at timestamptz NOT NULL,
  sampled_ms bigint NOT NULL,
  severity integer NOT NULL,
  category text NOT NULL,
  description text NOT NULL,
  suggested_action text NOT NULL,
  PRIMARY KEY (ruri, fault_id, source)
) WITH (fillfactor = 75);
CREATE INDEX faults_active_by_robot ON faults_active (ruri, raised_at, entry);
CREATE INDEX faults_active_by_fleet ON faults_active (fleet, raised_at, entry);
CREATE INDEX faults_active_by_time ON faults_active (raised_at, entry);

-- first_at and entry are those of a run's first report. is_open: the latest status is not terminal;
-- a column of its own, so that a report that leaves it as it was changes no index.
CREATE TABLE mission_runs (
  ruri text COLLATE "C" NOT NULL,
  mission_id text COLLATE "C" NOT NULL,
  run_id text COLLATE "C" NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  first_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  last_at timestamptz NOT NULL,
  name text NOT NULL,
  status integer NOT NULL,
  is_open boolean NOT NULL,
  updates bigint NOT NULL,
  latest text NOT NULL,
  PRIMARY KEY (ruri, mission_id, run_id)
) WITH (fillfactor = 75);
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
  ruri text COLLATE "C" NOT NULL,
  id text COLLATE "C" NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  first_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  received_at timestamptz NOT NULL,
  expires_ms bigint NOT NULL,
  name text NOT NULL,
  rev bigint NOT NULL,
  hash text NOT NULL,
  area_type integer NOT NULL,
  scope integer NOT NULL,
  min_z_m double precision NOT NULL,
  max_z_m double precision NOT NULL,
  level_id integer NOT NULL,
  geometry text NOT NULL,
  PRIMARY KEY (ruri, id)
) WITH (fillfactor = 75);
CREATE INDEX shapes_by_robot ON shapes (ruri, first_at, entry);
CREATE INDEX shapes_by_fleet ON shapes (fleet, first_at, entry);
CREATE INDEX shapes_by_time ON shapes (first_at, entry);
CREATE INDEX shapes_by_expiry ON shapes (expires_ms) WHERE expires_ms <> 0;

-- As shapes. trajectory: NULL if there is none.
CREATE TABLE objects (
  ruri text COLLATE "C" NOT NULL,
  id text COLLATE "C" NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  first_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  received_at timestamptz NOT NULL,
  expires_ms bigint NOT NULL,
  name text NOT NULL,
  sampled_ms bigint NOT NULL,
  object_type integer NOT NULL,
  scope integer NOT NULL,
  radius_m double precision NOT NULL,
  location text NOT NULL,
  trajectory text,
  PRIMARY KEY (ruri, id)
) WITH (fillfactor = 75);
CREATE INDEX objects_by_robot ON objects (ruri, first_at, entry);
CREATE INDEX objects_by_fleet ON objects (fleet, first_at, entry);
CREATE INDEX objects_by_time ON objects (first_at, entry);
CREATE INDEX objects_by_expiry ON objects (expires_ms) WHERE expires_ms <> 0;

-- kind: 0 agent info, 1 settings, 2 UI capabilities.
CREATE TABLE latest (
  ruri text COLLATE "C" NOT NULL,
  kind integer NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  received_at timestamptz NOT NULL,
  body text NOT NULL,
  PRIMARY KEY (ruri, kind)
) WITH (fillfactor = 75);

-- The last row of presence_changes of each robot.
CREATE TABLE presence_latest (
  ruri text COLLATE "C" NOT NULL PRIMARY KEY,
  presence integer NOT NULL,
  changed_at timestamptz NOT NULL
) WITH (fillfactor = 75);

CREATE TABLE gaps (
  ruri text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  first bigint NOT NULL,
  last bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  seen_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  PRIMARY KEY (ruri, session, first)
) WITH (fillfactor = 75);
CREATE INDEX gaps_by_robot ON gaps (ruri, seen_at, entry);
CREATE INDEX gaps_by_fleet ON gaps (fleet, seen_at, entry);
CREATE INDEX gaps_by_time ON gaps (seen_at, entry);
