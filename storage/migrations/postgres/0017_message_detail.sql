-- What else the sender of a message said, as the JSON text of an object; empty if that is nothing.
ALTER TABLE messages ADD COLUMN detail text NOT NULL DEFAULT '';
