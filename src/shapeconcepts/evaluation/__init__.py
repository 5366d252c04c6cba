"""How well groups and features agree with labels, beside what the usual methods reach on the same objects."""
