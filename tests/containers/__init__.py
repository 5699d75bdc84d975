"""`make containers`: the image and the compose file on a real engine; `python -m tests.containers`."""
