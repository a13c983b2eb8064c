-- Updates of what is no robot. ruri: what stands in a robot's place, `cyberwave:` and the prefix of the
-- topic. fleet: whose viewers may see it. sampled_ms: the sender's clock, 0 if unknown. scope: 0 an
-- environment, 1 a workflow run; id: its UUID; type: what changed, of a workflow run its status;
-- detail: the JSON text of an object in the sender's own form.
CREATE TABLE scope_updates (
  ruri text COLLATE "C" NOT NULL,
  received_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  seq bigint NOT NULL,
  sampled_ms bigint NOT NULL,
  scope integer NOT NULL,
  id text COLLATE "C" NOT NULL,
  type text NOT NULL,
  detail text NOT NULL,
  PRIMARY KEY (ruri, received_at, entry)
) PARTITION BY RANGE (received_at);
CREATE INDEX scope_updates_by_time ON scope_updates (received_at, entry);
CREATE INDEX scope_updates_by_scope ON scope_updates (scope, received_at, entry);
CREATE INDEX scope_updates_by_id ON scope_updates (id, received_at, entry);
CREATE TABLE scope_updates_default PARTITION OF scope_updates DEFAULT;

-- As in 0002, and the table above.
CREATE OR REPLACE FUNCTION histories(OUT parent text, OUT arrival text)
RETURNS SETOF record LANGUAGE sql IMMUTABLE AS $$
  VALUES ('faults_history', 'received_at'), ('events', 'received_at'), ('messages', 'received_at'),
    ('mission_reports', 'received_at'), ('quarantine', 'received_at'),
    ('presence_changes', 'changed_at'), ('scope_updates', 'received_at')
$$;
