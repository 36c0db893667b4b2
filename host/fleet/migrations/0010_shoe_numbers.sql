-- SPDX-License-Identifier: MIT
-- Whose shoe it was; cells of before say none of it.
ALTER TABLE shoes ADD COLUMN part text NOT NULL DEFAULT '';
ALTER TABLE shoes ADD COLUMN foot text NOT NULL DEFAULT '';
ALTER TABLE shoes ADD COLUMN size text NOT NULL DEFAULT '';
CREATE INDEX shoes_part ON shoes (part, id) WHERE part <> '';
