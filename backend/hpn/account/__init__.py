"""The account of a selection: inputs, figures, checks and published figures as sections of lines."""
