-- SPDX-License-Identifier: MIT
-- A cell says which order it does not follow, so that the switch is withdrawn at once; and why it was withdrawn stays.
ALTER TABLE cell_releases ADD COLUMN refused integer NOT NULL DEFAULT 0;
ALTER TABLE switches ADD COLUMN words text NOT NULL DEFAULT '';
