"""Tools for agents: a brief answer to an application, the reasons for or against one gear, and the catalogue."""
