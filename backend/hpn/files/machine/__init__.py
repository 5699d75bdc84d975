"""Files of a machine: its report and gear list, its axes as a table, and differences between two of its revisions."""
