-- oldest: 1
-- What operators decide about who may come in, what they note, and what they did. Names, times and numbers as in
-- 0001.

-- Which change of revocations and of robots' settings was the last; 0: none yet. By the machine's clock in
-- milliseconds, and always more than before: a store that went back (a restore) gives none a second time.
CREATE TABLE access_version (
  id INTEGER NOT NULL PRIMARY KEY CHECK (id = 0),
  version INTEGER NOT NULL
) STRICT;
INSERT INTO access_version (id, version) VALUES (0, 0);

-- Certificates and keys that may not come in. kind: 0 issuer and serial, 1 SHA-256 of the certificate, 2 of its
-- public key. revoked: 0 where it was taken back; such a row stays for a while, so that the server learns it.
CREATE TABLE revocations (
  kind INTEGER NOT NULL,
  value TEXT NOT NULL,
  revoked INTEGER NOT NULL,
  at INTEGER NOT NULL,
  who TEXT NOT NULL,
  reason TEXT NOT NULL,
  version INTEGER NOT NULL,
  PRIMARY KEY (kind, value)
) STRICT;
CREATE INDEX revocations_by_version ON revocations (version);

-- What operators set of robots, known or not; it does not go with its robot. labels: the JSON text of an object.
-- changed_at: a row of which everything was taken back stays for a while after it.
CREATE TABLE robot_settings (
  ruri TEXT NOT NULL PRIMARY KEY,
  blocked INTEGER NOT NULL,
  blocked_why TEXT NOT NULL,
  blocked_by TEXT NOT NULL,
  blocked_at INTEGER,
  registered INTEGER NOT NULL,
  labels TEXT NOT NULL,
  note TEXT NOT NULL,
  disconnect_at INTEGER,
  changed_at INTEGER NOT NULL,
  version INTEGER NOT NULL
) STRICT;
CREATE INDEX robot_settings_by_version ON robot_settings (version);

-- What operators and servers changed, or tried to. proof: 0 local, 1 token, 2 certificate, 3 store, 4 server.
CREATE TABLE audit (
  entry INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT,
  at INTEGER NOT NULL,
  proof INTEGER NOT NULL,
  who TEXT NOT NULL,
  address TEXT NOT NULL,
  action TEXT NOT NULL,
  target TEXT NOT NULL,
  fleet TEXT NOT NULL,
  outcome TEXT NOT NULL,
  detail TEXT NOT NULL
) STRICT;
CREATE INDEX audit_by_time ON audit (at, entry);
CREATE INDEX audit_by_fleet ON audit (fleet, at, entry);
CREATE INDEX audit_by_who ON audit (who, at, entry, fleet);
CREATE INDEX audit_by_action ON audit (action, at, entry, fleet);
CREATE INDEX audit_by_target ON audit (target, at, entry, fleet);

-- Which operator has seen the fault; NULL: none since it was raised last.
ALTER TABLE faults_active ADD COLUMN acknowledged_at INTEGER;
ALTER TABLE faults_active ADD COLUMN acknowledged_by TEXT NOT NULL DEFAULT '';
ALTER TABLE faults_active ADD COLUMN acknowledged_note TEXT NOT NULL DEFAULT '';

-- An active fault belongs to the fleet that its robot has now, as its shapes and objects do.
CREATE TRIGGER robots_moved_faults AFTER UPDATE OF fleet ON robots WHEN OLD.fleet <> NEW.fleet
BEGIN
  UPDATE faults_active SET fleet = NEW.fleet WHERE ruri = NEW.ruri AND fleet <> NEW.fleet;
END;
