-- The Robot State of RCAN, as JSON behind its length.
ALTER TABLE live ADD COLUMN rcan BLOB;
