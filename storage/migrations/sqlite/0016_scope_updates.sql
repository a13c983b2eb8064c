-- Updates of what is no robot. ruri: what stands in a robot's place, `cyberwave:` and the prefix of the
-- topic. fleet: whose viewers may see it. sampled_ms: the sender's clock, 0 if unknown. scope: 0 an
-- environment, 1 a workflow run; id: its UUID; type: what changed, of a workflow run its status;
-- detail: the JSON text of an object in the sender's own form.
CREATE TABLE scope_updates (
  ruri TEXT NOT NULL,
  received_ms INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  session BLOB NOT NULL,
  seq INTEGER NOT NULL,
  sampled_ms INTEGER NOT NULL,
  scope INTEGER NOT NULL,
  id TEXT NOT NULL,
  type TEXT NOT NULL,
  detail TEXT NOT NULL,
  PRIMARY KEY (ruri, received_ms, entry)
) STRICT;
CREATE INDEX scope_updates_by_fleet ON scope_updates (fleet, received_ms, entry);
CREATE INDEX scope_updates_by_time ON scope_updates (received_ms, entry);
CREATE INDEX scope_updates_by_scope ON scope_updates (scope, received_ms, entry);
CREATE INDEX scope_updates_by_id ON scope_updates (id, received_ms, entry);
