"""Mutation testing of the modules that decide: each small change of them has to make a test fail."""
