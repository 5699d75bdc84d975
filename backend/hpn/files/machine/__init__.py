"""A machine as files: its report and gear list, its axes as a table, and what differs between two of its revisions."""
