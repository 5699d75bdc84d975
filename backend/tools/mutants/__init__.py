"""Mutation testing of the modules that decide: each small change of them must make a test fail."""
