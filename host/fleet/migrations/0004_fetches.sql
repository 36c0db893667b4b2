-- SPDX-License-Identifier: MIT
-- Recordings that the centre has asked a cell for.  Asked: nothing has come.  Coming: `total` and `sha256` are known.
CREATE TABLE fetches (
  number integer GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  cell text NOT NULL,
  book text NOT NULL,
  scan text NOT NULL,
  asked timestamptz NOT NULL DEFAULT now(),
  state text NOT NULL DEFAULT 'asked' CHECK (state IN ('asked', 'coming', 'whole', 'refused')),
  have bigint NOT NULL DEFAULT 0,
  total bigint NOT NULL DEFAULT 0,
  sha256 text NOT NULL DEFAULT '',
  tries integer NOT NULL DEFAULT 0,
  words text NOT NULL DEFAULT ''
);
CREATE UNIQUE INDEX one_open_fetch ON fetches (cell, book, scan) WHERE state IN ('asked', 'coming');
