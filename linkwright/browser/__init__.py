"""The same in a browser: what `linkwright serve` shows."""
