-- SPDX-License-Identifier: MIT
-- The signed order of a switch, as its cells are told it; the number stands in it.  Switches of before have none, and are told
-- to nobody: their cells have them.
ALTER TABLE switches ALTER COLUMN number DROP IDENTITY;
ALTER TABLE switches ADD COLUMN order_text text NOT NULL DEFAULT '', ADD COLUMN order_signature bytea NOT NULL DEFAULT '';
-- The newest order that the cell knows.
ALTER TABLE cell_releases ADD COLUMN newest integer NOT NULL DEFAULT 0;
