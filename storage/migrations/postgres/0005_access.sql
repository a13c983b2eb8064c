-- oldest: 1
-- What operators decide about who may come in, what they note, and what they did. Applied as 0001.

-- One for all servers: which change of revocations and of robots' settings was the last; 0: none yet. Its row is
-- locked until the change is committed, so versions are seen in their order. By the database's clock in
-- milliseconds, and always more than before: a store that went back (a restore, a standby that lagged) gives none
-- a second time.
CREATE TABLE access_version (
  id integer NOT NULL PRIMARY KEY CHECK (id = 0),
  version bigint NOT NULL
) WITH (fillfactor = 50);
INSERT INTO access_version (id, version) VALUES (0, 0);

-- Certificates and keys that may not come in. kind: 0 issuer and serial, 1 SHA-256 of the certificate, 2 of its
-- public key. revoked: false where it was taken back; such a row stays for a while, so that all servers learn it.
CREATE TABLE revocations (
  kind integer NOT NULL,
  value text COLLATE "C" NOT NULL,
  revoked boolean NOT NULL,
  at timestamptz NOT NULL,
  who text NOT NULL,
  reason text NOT NULL,
  version bigint NOT NULL,
  PRIMARY KEY (kind, value)
);
CREATE INDEX revocations_by_version ON revocations (version);

-- What operators set of robots, known or not; it does not go with its robot. labels: the JSON text of an object.
-- changed_at: a row of which everything was taken back stays for a while after it.
CREATE TABLE robot_settings (
  ruri text COLLATE "C" NOT NULL PRIMARY KEY,
  blocked boolean NOT NULL,
  blocked_why text NOT NULL,
  blocked_by text NOT NULL,
  blocked_at timestamptz,
  registered boolean NOT NULL,
  labels text NOT NULL,
  note text NOT NULL,
  disconnect_at timestamptz,
  changed_at timestamptz NOT NULL,
  version bigint NOT NULL
);
CREATE INDEX robot_settings_by_version ON robot_settings (version);

-- What operators and servers changed, or tried to. proof: 0 local, 1 token, 2 certificate, 3 store, 4 server.
CREATE TABLE audit (
  at timestamptz NOT NULL,
  entry bigint NOT NULL,
  proof integer NOT NULL,
  who text COLLATE "C" NOT NULL,
  address text NOT NULL,
  action text COLLATE "C" NOT NULL,
  target text COLLATE "C" NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  outcome text NOT NULL,
  detail text NOT NULL,
  PRIMARY KEY (at, entry)
);
CREATE INDEX audit_by_fleet ON audit (fleet, at, entry);
CREATE INDEX audit_by_who ON audit (who, at, entry, fleet);
CREATE INDEX audit_by_action ON audit (action, at, entry, fleet);
CREATE INDEX audit_by_target ON audit (target, at, entry, fleet);

-- Which operator has seen the fault; NULL: none since it was raised last.
ALTER TABLE faults_active ADD COLUMN acknowledged_at timestamptz;
ALTER TABLE faults_active ADD COLUMN acknowledged_by text NOT NULL DEFAULT '';
ALTER TABLE faults_active ADD COLUMN acknowledged_note text NOT NULL DEFAULT '';

-- Raises every sequence above what rows name of it, where it is left behind: logical replication copies
-- rows and no sequences. An entry below its session's first hides a Reject, an epoch that was given before
-- has a holder, and a number of a request that is there already is refused. Returns whether anything was
-- behind. Runs as the owner, since the server's role may draw from a sequence and not set it. Called at each
-- connect, so of a table with an index of times it looks at the newest row alone; where these show that
-- `batches` is behind, it is raised by 2^30 more, for rows that are older by their times.
CREATE OR REPLACE FUNCTION raise_sequences()
RETURNS boolean LANGUAGE plpgsql SECURITY DEFINER SET search_path = uplinkd, pg_temp AS $$
DECLARE
  source record;
  seen bigint;
  batch bigint;
  epoch bigint;
  request bigint;
BEGIN
  -- Neither has an index of times.
  SELECT greatest((SELECT max(s.first_entry) FROM sessions AS s),
                  (SELECT max(k.entry) FROM kept_rejects AS k), 0) INTO batch;
  FOR source IN
    SELECT h.parent, h.arrival, 'entry' AS number FROM histories() AS h
    UNION ALL VALUES ('mission_runs', 'first_at', 'last_entry'), ('mission_runs', 'first_at', 'entry'),
      ('faults_active', 'raised_at', 'entry'), ('shapes', 'first_at', 'entry'),
      ('objects', 'first_at', 'entry'), ('gaps', 'seen_at', 'entry'),
      ('operator_requests', 'opened_at', 'entry'), ('connections', 'began_at', 'entry'),
      ('audit', 'at', 'entry')
  LOOP
    EXECUTE format('SELECT %I FROM %I ORDER BY %I DESC, entry DESC LIMIT 1',
                   source.number, source.parent, source.arrival) INTO seen;
    batch := greatest(batch, seen);
  END LOOP;
  batch := batch >> 20;
  SELECT greatest((SELECT max(r.epoch) FROM robots AS r), (SELECT max(l.held_since) FROM live AS l),
                  (SELECT max(c.epoch) FROM topic_clients AS c),
                  (SELECT max(d.epoch) FROM drone_claims AS d), 0) INTO epoch;
  SELECT coalesce(max(f.number), 0) INTO request FROM forget_requests AS f;
  -- What each gives next.
  IF batch < (SELECT last_value + is_called::int FROM batches)
    AND epoch < (SELECT last_value + is_called::int FROM epochs)
    AND request < (SELECT last_value + is_called::int FROM forget_requests_number_seq) THEN
    RETURN false;
  END IF;
  -- One at a time, so that no later call takes back what an earlier one gave.
  PERFORM pg_advisory_xact_lock(hashtext('uplinkd.sequences'));
  PERFORM setval('batches', batch + (1 << 30)) FROM batches WHERE last_value + is_called::int <= batch;
  PERFORM setval('epochs', epoch) FROM epochs WHERE last_value + is_called::int <= epoch;
  PERFORM setval('forget_requests_number_seq', request) FROM forget_requests_number_seq
    WHERE last_value + is_called::int <= request;
  RETURN true;
END $$;

-- An active fault belongs to the fleet that its robot has now, as its shapes and objects do.
CREATE OR REPLACE FUNCTION move_items() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  UPDATE uplinkd.shapes AS s SET fleet = NEW.fleet
    WHERE s.ruri = NEW.ruri AND s.fleet <> NEW.fleet;
  UPDATE uplinkd.objects AS o SET fleet = NEW.fleet
    WHERE o.ruri = NEW.ruri AND o.fleet <> NEW.fleet;
  UPDATE uplinkd.faults_active AS f SET fleet = NEW.fleet
    WHERE f.ruri = NEW.ruri AND f.fleet <> NEW.fleet;
  RETURN NULL;
END $$;
