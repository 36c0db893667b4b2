// SPDX-License-Identifier: MIT
/// JSON Schema, as far as processes use it.
export interface Schema {
  type?: string | string[];
  title?: string;
  description?: string;
  properties?: Record<string, Schema>;
  required?: string[];
  items?: Schema;
  minItems?: number;
  maxItems?: number;
  enum?: (string | number)[];
  minimum?: number;
  maximum?: number;
  default?: unknown;
  'x-unit'?: string;
}
