"""What is said of a selection, once: inputs, figures, checks and published figures as sections of lines."""
