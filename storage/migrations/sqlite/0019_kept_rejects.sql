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
