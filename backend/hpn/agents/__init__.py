"""Tools for agents: the answer to an application in brief, the reason for one gear, and the catalogue."""
