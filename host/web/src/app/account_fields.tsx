// SPDX-License-Identifier: MIT
// Name and password of an account to be, within the bounds that the service sets.
import type { JSX } from 'preact';

type FieldProps = { label: string; value: string; set: (value: string) => void };

export function NewNameField({ label, value, set }: FieldProps): JSX.Element {
  return (
    <label>
      {label}{' '}
      <input
        required
        autocomplete="off"
        maxLength={64}
        pattern="[A-Za-z0-9][A-Za-z0-9._@\-]*"
        value={value}
        onInput={(e) => set(e.currentTarget.value)}
      />
    </label>
  );
}

export function NewPasswordField({ label, value, set }: FieldProps): JSX.Element {
  return (
    <label>
      {label}{' '}
      <input
        type="password"
        required
        minLength={8}
        maxLength={200}
        autocomplete="new-password"
        value={value}
        onInput={(e) => set(e.currentTarget.value)}
      />
    </label>
  );
}
