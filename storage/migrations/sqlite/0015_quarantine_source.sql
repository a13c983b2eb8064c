-- By which way a rejected message came: 0 a robot's stream, 1 Cyberwave; and the topic on which it was
-- published, empty for the first.
ALTER TABLE quarantine ADD COLUMN source INTEGER NOT NULL DEFAULT 0;
ALTER TABLE quarantine ADD COLUMN topic TEXT NOT NULL DEFAULT '';
CREATE INDEX quarantine_by_source ON quarantine (source, received_ms, entry) WHERE source <> 0;
